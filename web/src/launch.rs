//! Files that the system hands over: the manifest says that the installed page opens archives.

use js_sys::{Array, Function, Reflect};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{File, FileSystemFileHandle};

use crate::run::Problem;
use crate::share::open_file;
use crate::state::Workbench;

/// Opens whatever file the page is launched with, now and later. A browser without a launch queue hands none
/// over.
pub(crate) fn accept(workbench: Workbench) {
    let consume = Closure::<dyn FnMut(JsValue)>::new(move |launch: JsValue| {
        spawn_local(async move {
            match launched(&launch).await {
                Ok(files) => {
                    for file in files {
                        workbench.comes_by_address(false);
                        let name = file.name();
                        open_file(workbench, file.into(), name);
                    }
                }
                Err(_) => workbench.fail(Problem::input(
                    "The system does not hand the file over.",
                    "Drop it here, or choose it.",
                )),
            }
        });
    });
    let set = |window: web_sys::Window| {
        let queue = Reflect::get(&window, &"launchQueue".into())?;
        if queue.is_undefined() {
            return Ok(());
        }
        let set: Function = Reflect::get(&queue, &"setConsumer".into())?.dyn_into()?;
        set.call1(&queue, consume.as_ref()).map(drop)
    };
    let listens: Result<(), JsValue> = web_sys::window().map_or(Ok(()), set);
    if listens.is_ok() {
        // The queue owns it from here on.
        consume.forget();
    }
}

async fn launched(launch: &JsValue) -> Result<Vec<File>, JsValue> {
    let handles: Array = Reflect::get(launch, &"files".into())?.dyn_into()?;
    let mut files = Vec::new();
    for handle in handles.iter() {
        let handle: FileSystemFileHandle = handle.unchecked_into();
        files.push(JsFuture::from(handle.get_file()).await?.dyn_into()?);
    }
    Ok(files)
}
