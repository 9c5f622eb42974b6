//! Curves over the index as files: a table, and a drawing.

use std::fmt::Write as _;

use crate::export::IndexFigure;
use crate::index::IndexCurve;
use crate::plot::{Axis, PlotError};

/// A curve and what to say of it.
pub(super) struct Drawn<'a> {
    pub(super) name: String,
    /// What the vertical axis shows.
    pub(super) quantity: String,
    pub(super) curve: &'a IndexCurve,
    /// A value of the quantity that is known.
    pub(super) level: Option<f64>,
    /// The interval in which the index lies 95 times in 100.
    pub(super) interval: Option<[f64; 2]>,
}

/// The curve as a table.
pub(super) fn csv(drawn: &Drawn) -> String {
    let mut text = format!("index,{}\n", drawn.quantity);
    for (index, value) in drawn.curve.index.iter().zip(&drawn.curve.value) {
        let value = value.map_or_else(String::new, |value| value.to_string());
        let _ = writeln!(text, "{index},{value}");
    }
    text
}

/// The curve as a drawing.
pub(super) fn svg(drawn: &Drawn) -> Result<String, PlotError> {
    const SIZE: [u32; 2] = [640, 400];
    let values = drawn.curve.index.iter().zip(&drawn.curve.value);
    let minimum = drawn.curve.minimum().filter(|minimum| !minimum.at_bound);
    let figure = IndexFigure {
        title: drawn.quantity.clone(),
        quantity: Axis::new(drawn.quantity.clone(), "", 3),
        points: values
            .filter_map(|(n, value)| Some([*n, (*value)?]))
            .collect(),
        known: drawn.level,
        interval: drawn.interval,
        minimum: minimum
            .filter(|_| drawn.level.is_none())
            .map(|minimum| [minimum.index, minimum.value]),
    };
    Ok(figure.figure().draw(SIZE)?.svg)
}
