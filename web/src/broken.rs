//! A fault of the page's own: it is told where everybody sees it, for no program goes on after one.

use leptos::prelude::document;

/// Shows a panic's message, with the version, in the place that the page has for it.
pub(crate) fn tell_of_panics() {
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&panic.to_string().into());
        if let Some(root) = document().document_element() {
            let _ = root.set_attribute("data-state", "failed");
            let _ = root.set_attribute("data-broken", "");
        }
        if let Some(details) = document().get_element_by_id("broken-details") {
            details.set_text_content(Some(&format!("Snellius {}\n{panic}", snellius::VERSION)));
        }
    }));
}
