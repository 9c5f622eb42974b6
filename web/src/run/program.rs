//! What the workers run: a program of its own beside the page's, fetched and compiled once, when the first
//! worker is wanted.

use std::cell::RefCell;

use js_sys::{Array, JsString, WebAssembly};
use leptos::prelude::document;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, BlobPropertyBag, Url, Worker, WorkerOptions, WorkerType};

use super::problem::Problem;
use crate::files;

/// The element of the page that names the program.
const NAME: &str = "meta[name='snellius-worker']";

thread_local! {
    static PROGRAM: RefCell<Option<Program>> = const { RefCell::new(None) };
}

/// The workers' program, ready to be started any number of times.
#[derive(Clone)]
pub(super) struct Program {
    /// The address of the script that goes with the module.
    script: String,
    module: WebAssembly::Module,
}

impl Program {
    /// The program; fetched now if it is not at hand.
    pub(super) async fn get() -> Result<Self, Problem> {
        if let Some(program) = PROGRAM.with_borrow(Clone::clone) {
            return Ok(program);
        }
        let program = Self::fetch().await.map_err(|cause| {
            Problem::input(
                format!("The part of the page that measures could not be loaded: {cause}."),
                "Check the connection and open the scan again.",
            )
        })?;
        PROGRAM.set(Some(program.clone()));
        Ok(program)
    }

    async fn fetch() -> Result<Self, String> {
        let name = name().ok_or("the page does not name it")?;
        let code = files::fetch(&format!("{name}_bg.wasm")).await?;
        let broken = |_| "the connection broke off";
        let code = JsFuture::from(code.array_buffer().map_err(broken)?);
        // Not while it streams: that asks for a media type, which not every host sends.
        let module = WebAssembly::compile(&code.await.map_err(broken)?);
        let module = JsFuture::from(module).await.map_err(|e| format!("{e:?}"))?;
        Ok(Self {
            script: absolute(&format!("{name}.js")).ok_or("the page has no address")?,
            module: module.unchecked_into(),
        })
    }

    /// Starts it in a worker: a small module imports the program's script and gives it what was compiled
    /// here, so nothing is fetched or compiled again. The module's address, as long as it is needed, comes
    /// with the worker.
    pub(super) fn start(&self) -> Result<(Worker, String), JsValue> {
        let script = js_sys::JSON::stringify(&JsString::from(self.script.as_str()))?;
        let source = format!(
            "import init from {script};\n\
             onmessage = ({{ data }}) => {{ onmessage = null; init({{ module_or_path: data }}); }};\n"
        );
        let kind = BlobPropertyBag::new();
        kind.set_type("text/javascript");
        let module = Blob::new_with_str_sequence_and_options(&Array::of1(&source.into()), &kind)?;
        let address = Url::create_object_url_with_blob(&module)?;
        let options = WorkerOptions::new();
        options.set_type(WorkerType::Module);
        let worker = Worker::new_with_options(&address, &options)?;
        worker.post_message(&self.module)?;
        Ok((worker, address))
    }
}

/// What tells this build of the program from others.
pub(crate) fn build() -> String {
    name().unwrap_or_default()
}

/// The program's name, relative to the page.
fn name() -> Option<String> {
    let element = document().query_selector(NAME).ok()??;
    element.get_attribute("content")
}

/// An address relative to the page, in full: a worker's module has none of its own.
fn absolute(address: &str) -> Option<String> {
    let base = document().base_uri().ok()??;
    Some(Url::new_with_base(address, &base).ok()?.href())
}
