//! Everything that takes time runs in workers: this room starts them, asks them, and answers as one.

mod blob_reader;
mod develop;
mod hand;
mod job;
mod mesh;
mod messages;
mod problem;
mod report;
pub(crate) mod worker;

pub(crate) use hand::Hand;
pub(crate) use job::{Progress, Run, run};
pub(crate) use mesh::{Mesh, Through};
pub(crate) use messages::PictureSet;
pub(crate) use problem::{Problem, ProblemKind};
pub(crate) use report::{Face, Facts, Outcome, Place, StationFacts, ViewOutcome, Wall};

fn window() -> web_sys::Window {
    web_sys::window().expect("a run is started by the page")
}

/// Milliseconds since the page was loaded.
fn now() -> f64 {
    window().performance().map_or(0.0, |clock| clock.now())
}
