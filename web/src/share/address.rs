//! What the page's address means: a link's reconstruction, an archive elsewhere, or nothing of either.

use leptos::ev;
use leptos::prelude::*;
use snellius::share::is_link;

use super::source;
use crate::state::Workbench;

/// Opens what the address holds, now and whenever it changes.
pub(crate) fn follow(workbench: Workbench) {
    read(workbench);
    let listener = window_event_listener(ev::hashchange, move |_| read(workbench));
    on_cleanup(move || listener.remove());
}

fn read(workbench: Workbench) {
    let fragment = fragment();
    let fragment = fragment.as_str();
    if holds_a_scan(fragment) {
        workbench.comes_by_address(true);
    }
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

fn fragment() -> String {
    let hash = window().location().hash().unwrap_or_default();
    hash.strip_prefix('#').unwrap_or(&hash).to_owned()
}

fn holds_a_scan(fragment: &str) -> bool {
    fragment.starts_with("src=") || is_link(fragment)
}

/// Takes the scan out of the address: another one is shown, and loading the page again shall not bring back
/// the first.
pub(crate) fn forget() {
    if !holds_a_scan(&fragment()) {
        return;
    }
    let href = window().location().href().unwrap_or_default();
    let page = href.split('#').next().unwrap_or_default();
    let history = window().history();
    let forgotten = history.and_then(|history| {
        history.replace_state_with_url(&wasm_bindgen::JsValue::NULL, "", Some(page))
    });
    if let Err(error) = forgotten {
        web_sys::console::info_2(&"The address stays:".into(), &error);
    }
}

/// The page's address with a fragment.
pub(super) fn page_address(fragment: &str) -> String {
    let href = window().location().href().unwrap_or_default();
    let page = href.split(['#', '?']).next().unwrap_or_default();
    format!("{page}#{fragment}")
}
