//! What the page's address means: a link's reconstruction, an archive elsewhere, or nothing of either.

use leptos::ev;
use leptos::prelude::*;
use snellius::share::{self, Document, LinkError, Shared};
use wasm_bindgen_futures::JsFuture;

use super::{Guest, source};
use crate::run::Problem;
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
    match share::decode(fragment) {
        Ok(Shared {
            settings,
            result: Some(result),
            rounding,
        }) => workbench.receive(Guest {
            document: Document::new(None, String::new(), settings, None, result).into(),
            rounding,
        }),
        Ok(_) => workbench.fail(Problem::input(
            "This link holds settings, but no reconstruction.",
            "Ask whoever sent it for a link made from a measured scan.",
        )),
        // The lab's links, and anchors.
        Err(LinkError::NotOurs) => {}
        Err(error) => workbench.fail(Problem::input(
            format!("{}.", capitalised(&error.to_string())),
            "Copy the whole link and open it again, or ask whoever sent it for a file.",
        )),
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
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
