//! Snellius in the browser: drop a scan, see the object.
//!
//! Three programs are made of this: the page (`main.rs`), which keeps the state in [`state`] and shows it; what
//! computes in its workers (`bin/snellius-worker.rs`), which is loaded when the first scan is opened; and the
//! refraction lab (`bin/snellius-lab.rs`), which is loaded when the address first means it. What page and workers
//! say to each other is in [`run`]; the picture in 3-D is [`scene`].

// `#[component]` makes a public item of a component's properties, whatever its own visibility.
#![allow(unreachable_pub)]

mod app;
mod broken;
mod clipboard;
mod colours;
mod files;
mod history;
mod in_sight;
mod lab;
mod launch;
mod legend;
mod making;
mod measuring;
mod number;
mod paint;
mod pictures;
mod plots;
mod problem_note;
mod progress;
mod result;
mod run;
mod scene;
mod sessions;
mod share;
mod shortcuts;
mod stages;
mod start;
mod state;
mod strip;
mod table;

use wasm_bindgen::JsCast;
use web_sys::DedicatedWorkerGlobalScope;

/// Shows the page.
pub fn page() {
    broken::tell_of_panics();
    app::start();
}

/// Shows the refraction lab whenever the address means it.
pub fn lab() {
    broken::tell_of_panics();
    lab::start();
}

/// Answers the page's questions, in a worker.
pub fn worker() {
    let scope = js_sys::global().unchecked_into::<DedicatedWorkerGlobalScope>();
    run::worker::start(&scope);
}
