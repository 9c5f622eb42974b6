//! Snellius in the browser: drop a scan, see the object.
//!
//! The same program runs as the page and, in its workers, as what computes. The page keeps the state in
//! [`state`] and shows it; everything that takes time is in [`run`]; the picture in 3-D is [`scene`].

// `#[component]` makes a public item of a component's properties, whatever its own visibility.
#![allow(unreachable_pub)]

mod app;
mod colours;
mod files;
mod history;
mod lab;
mod legend;
mod measuring;
mod number;
mod pictures;
mod progress;
mod result;
mod run;
mod scene;
mod share;
mod shortcuts;
mod stages;
mod start;
mod state;
mod strip;
mod table;

use wasm_bindgen::JsCast;
use web_sys::DedicatedWorkerGlobalScope;

fn main() {
    match js_sys::global().dyn_into::<DedicatedWorkerGlobalScope>() {
        Ok(worker) => run::worker::start(&worker),
        Err(_) => app::start(),
    }
}
