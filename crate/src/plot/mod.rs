//! Plots: figures with axes, units and values, drawn as SVG by [plotters] or written as a table.
//!
//! The report, the companion program and the page all draw by this room. A drawing looks right by itself,
//! as a file; each shape also names what it is in a class, so that a page's style sheet can give it the
//! page's colours.

mod canvas;
mod csv;
mod figure;
mod flat;
mod paint;
mod scale;
mod space;
mod ticks;

pub use figure::{Axis, Bar, Dot, Figure, Layer, Plot, SpaceDot, SpaceFigure};
pub use paint::{Ink, SWEEP_COLOURS, sweep_colour};

use plotters::drawing::DrawingAreaErrorKind;
use serde::{Deserialize, Serialize};

/// A figure as it is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawing {
    /// What it shows.
    pub title: String,
    /// A whole SVG file.
    pub svg: String,
    /// Width and height, px.
    pub size: [u32; 2],
    /// Where values stand in it, so that a pointer finds them.
    pub marks: Vec<Mark>,
}

/// A value in a drawing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Its place, px from top left.
    pub at: [f32; 2],
    /// The view it comes from, if it is one view's.
    pub view: Option<usize>,
    /// What it says.
    pub words: String,
}

/// Why there is no drawing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
pub enum PlotError {
    /// There are no values.
    #[error("there is nothing to draw")]
    Nothing,
    /// There is no room.
    #[error("{0}")]
    Room(String),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for PlotError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Room(error.to_string())
    }
}
