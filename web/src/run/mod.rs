//! Everything that takes time runs in workers: this room starts them, asks them, and answers as one.

mod blob_reader;
mod columns;
mod develop;
mod figure;
mod graphics;
mod guest;
mod hand;

mod making;
mod mesh;
mod messages;
mod packed;
mod passing;
mod plan;
mod problem;
mod program;
mod report;
mod study;
pub(crate) mod worker;
mod workers;

pub(crate) use figure::{Drawn, FigureForm, FigureOf, Figured, MarkAt};
pub(crate) use graphics::{graphics_started, start_graphics};
pub(crate) use guest::{About, Guest};
pub(crate) use hand::{Hand, unexpected};
pub(crate) use making::{Drafted, MakeReply, MakeRequest, PartShown, QuestionShown, ViewShown};
pub(crate) use mesh::{Mesh, Through};
pub(crate) use messages::{PictureSet, Thumbnail, WrittenSpots};
pub(crate) use passing::{LinkMade, PageWish};
pub(crate) use plan::Plan;
pub(crate) use problem::{Problem, ProblemKind};
pub(crate) use program::build;
pub(crate) use report::{
    Face, Facts, Index, ObjectPoint, Outcome, Place, Shown, Spot, Stand, VesselPoint, Wall,
};
pub(crate) use study::{CurveKind, MethodReport, Study, StudyCurve};
pub(crate) use workers::{Progress, Workers, with_note};

/// Waits so many milliseconds.
pub(crate) async fn sleep(milliseconds: i32) {
    let promise = js_sys::Promise::new(&mut |done, _| {
        let _ = window().set_timeout_with_callback_and_timeout_and_arguments_0(&done, milliseconds);
    });
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}

fn window() -> web_sys::Window {
    web_sys::window().expect("a run is started by the page")
}

/// Milliseconds since the page was loaded.
pub(crate) fn now() -> f64 {
    window().performance().map_or(0.0, |clock| clock.now())
}
