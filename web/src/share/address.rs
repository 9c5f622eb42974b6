//! What the page's address means: a link's reconstruction, an archive elsewhere, or nothing of either.

use leptos::ev;
use leptos::prelude::*;
use snellius::share::is_link;
use wasm_bindgen_futures::JsFuture;

use super::source;
use crate::state::Workbench;

/// Opens what the address holds, now and whenever it changes.
pub(crate) fn follow(workbench: Workbench) {
    read(workbench);
    let listener = window_event_listener(ev::hashchange, move |_| read(workbench));
    on_cleanup(move || listener.remove());
}

fn read(workbench: Workbench) {
    let hash = window().location().hash().unwrap_or_default();
    let fragment = hash.strip_prefix('#').unwrap_or(&hash);
    if let Some(address) = fragment.strip_prefix("src=") {
        return source::open(workbench, address);
    }
    // Anything else is an anchor, or the lab's.
    if is_link(fragment) {
        let fragment = fragment.to_owned();
        workbench.receive("a link".to_owned(), async move |hand| {
            hand.open_link(fragment).await
        });
    }
}

/// The page's address with a fragment.
pub(super) fn page_address(fragment: &str) -> String {
    let href = window().location().href().unwrap_or_default();
    let page = href.split(['#', '?']).next().unwrap_or_default();
    format!("{page}#{fragment}")
}

/// `None` where the browser has no clipboard for this page, or forbids it.
pub(super) async fn write_to_clipboard(text: &str) -> Option<()> {
    let navigator = window().navigator();
    let clipboard = js_sys::Reflect::get(&navigator, &"clipboard".into()).ok()?;
    // Missing where the page is not served securely.
    if clipboard.is_undefined() {
        return None;
    }
    let copied = JsFuture::from(navigator.clipboard().write_text(text)).await;
    copied.ok().map(drop)
}
