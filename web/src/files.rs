//! Files on their way into the page and out of it.

use js_sys::{Array, Uint8Array};
use leptos::html;
use leptos::prelude::*;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, BlobPropertyBag, HtmlAnchorElement, HtmlElement, Response, Url};

/// The id of the page's file input.
pub(crate) const FILE_INPUT: &str = "file-input";

/// Shows the browser's file chooser.
pub(crate) fn ask_for_one() {
    let input = document().get_element_by_id(FILE_INPUT);
    if let Some(input) = input.and_then(|input| input.dyn_into::<HtmlElement>().ok()) {
        input.click();
    }
}

/// Shows the file chooser of an input.
pub(crate) fn click(input: NodeRef<html::Input>) {
    if let Some(input) = input.get_untracked() {
        input.click();
    }
}

/// Fetches a file that lies beside the page.
pub(crate) async fn fetch(address: &str) -> Result<Response, String> {
    let window = web_sys::window().ok_or("no window")?;
    let answer = JsFuture::from(window.fetch_with_str(address)).await;
    let response: Response = answer.map_err(|_| "no connection")?.unchecked_into();
    if response.ok() {
        Ok(response)
    } else {
        Err(format!(
            "the server says {} {}",
            response.status(),
            response.status_text()
        ))
    }
}

/// Fetches a file whole.
pub(crate) async fn fetch_blob(address: &str) -> Result<Blob, String> {
    let broken = |_| "the connection broke off";
    let whole = fetch(address).await?.blob().map_err(broken)?;
    let blob = JsFuture::from(whole).await.map_err(broken)?;
    Ok(blob.unchecked_into())
}

/// Fetches a text.
pub(crate) async fn fetch_json(address: &str) -> Result<JsValue, String> {
    let broken = |_| "it is no JSON";
    let json = fetch(address).await?.json().map_err(broken)?;
    JsFuture::from(json)
        .await
        .map_err(|_| "it is no JSON".to_owned())
}

/// Saves bytes as a file, as the browser saves downloads.
pub(crate) fn save(bytes: &Uint8Array, name: &str, kind: &str) -> Result<(), JsValue> {
    let options = BlobPropertyBag::new();
    options.set_type(kind);
    let blob = Blob::new_with_u8_array_sequence_and_options(&Array::of1(bytes), &options)?;
    save_blob(&blob, name)
}

/// Likewise, of what need not be in memory.
pub(crate) fn save_blob(blob: &Blob, name: &str) -> Result<(), JsValue> {
    let address = Url::create_object_url_with_blob(blob)?;
    let link: HtmlAnchorElement = document().create_element("a")?.unchecked_into();
    link.set_href(&address);
    link.set_download(name);
    link.click();
    revoke_later(address);
    Ok(())
}

/// Saves a text likewise.
pub(crate) fn save_text(text: &str, name: &str, kind: &str) -> Result<(), JsValue> {
    save(&Uint8Array::from(text.as_bytes()), name, kind)
}

/// The browser needs the address until it has begun to save.
fn revoke_later(address: String) {
    const MILLISECONDS: i32 = 60_000;
    let revoke = Closure::once_into_js(move || {
        let _ = Url::revoke_object_url(&address);
    });
    if let Some(window) = web_sys::window() {
        let _ = window.set_timeout_with_callback_and_timeout_and_arguments_0(
            revoke.unchecked_ref(),
            MILLISECONDS,
        );
    }
}
