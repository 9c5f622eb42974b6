//! The browser's graphics, started before they are wanted. For a page's first WebGL context the browser starts
//! its graphics process and driver, and whoever asks waits: with graphics in software (SwiftShader) for half a
//! second. A worker can wait that long; contexts after the first take the page some 20 ms.

use std::cell::OnceCell;

use js_sys::{Array, Promise};
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, BlobPropertyBag, Url, Worker};

/// Without graphics, or without a canvas in workers, the page finds out by itself.
const SCRIPT: &str = "
    try { new OffscreenCanvas(1, 1).getContext('webgl2'); } catch {}
    postMessage(null);
    close();
";

thread_local! {
    static STARTED: OnceCell<Promise> = const { OnceCell::new() };
}

/// Begins to start them, once in the page's life.
pub(crate) fn start_graphics() {
    drop(started());
}

/// Ends when they are started.
pub(crate) async fn graphics_started() {
    let _ = JsFuture::from(started()).await;
}

fn started() -> Promise {
    let begin = || {
        Promise::new(&mut |done, _| {
            let Ok(worker) = worker() else {
                let _ = done.call0(&JsValue::NULL);
                return;
            };
            worker.set_onmessage(Some(&done));
            worker.set_onerror(Some(&done));
        })
    };
    STARTED.with(|started| started.get_or_init(begin).clone())
}

fn worker() -> Result<Worker, JsValue> {
    let kind = BlobPropertyBag::new();
    kind.set_type("text/javascript");
    let script = Blob::new_with_str_sequence_and_options(&Array::of1(&SCRIPT.into()), &kind)?;
    Worker::new(&Url::create_object_url_with_blob(&script)?)
}
