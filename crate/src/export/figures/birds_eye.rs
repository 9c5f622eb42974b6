//! Vessel and object from above and aside: the paper's Fig. 10.

use super::super::ReconstructionResult;
use super::view::View;
use crate::plot::{Axis, Ink, PlotError, SpaceDot, SpaceFigure};

/// All points in a box.
pub(super) fn figure(result: &ReconstructionResult) -> Result<SpaceFigure, PlotError> {
    let view = View::of(result)?;
    let mut dots = Vec::new();
    for (number, of) in result.numbered() {
        let dot = |point: &[f64; 3], series, ink| SpaceDot {
            at: view.place(*point),
            series,
            ink,
            view: Some(number),
        };
        let wall = of.vessel.iter();
        dots.extend(wall.map(|p| dot(p, "wall", Ink::Wall)));
        let object = of.object.iter();
        dots.extend(object.map(|p| dot(p, "object", Ink::Sweep(of.sweep))));
    }
    Ok(SpaceFigure {
        title: "Bird's-eye view".to_owned(),
        axes: [
            Axis::new("Along the scan", "mm", 2),
            Axis::new("Across it", "mm", 2),
            Axis::new("Behind the wall", "mm", 2),
        ],
        views: result.view_names(),
        dots,
    })
}
