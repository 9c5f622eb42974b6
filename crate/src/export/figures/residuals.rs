//! How far the wall's points lie off the fitted wall, over the wall.

use super::super::{ReconstructionResult, WallResult};
use super::radius;
use super::view::View;
use crate::geometry::Point;
use crate::plot::{Axis, Dot, Figure, Ink, Layer, PlotError};
use crate::robust::sort_by_number;

/// A round wall is unrolled; any other is seen from the rig.
pub(super) fn figure(result: &ReconstructionResult) -> Result<Figure, PlotError> {
    let view = View::of(result)?;
    let surface = result.vessel.surface().ok_or(PlotError::Nothing)?;
    let unrolled = match result.vessel.wall {
        WallResult::Cylinder { radius, .. } => Some(radius),
        _ => None,
    };
    let mut points = Vec::new();
    for (number, of) in result.numbered() {
        points.extend(of.vessel.iter().map(|point| {
            let residual = surface.signed_distance(Point::from(*point));
            (number, on_wall(&view, unrolled, *point), residual)
        }));
    }
    let full = usual_most(points.iter().map(|(.., residual)| residual.abs()));
    let dots: Vec<Dot> = points
        .into_iter()
        .map(|(number, at, residual)| Dot {
            at,
            ink: Ink::Signed(residual / full),
            value: Some(residual),
            view: Some(number),
        })
        .collect();
    let mut figure = Figure::new(
        format!(
            "Wall residuals: orange towards the rig, purple away from it, full colour at {full:.3} mm"
        ),
        Axis::new("Along the wall", "mm", 1),
        Axis::new("Across it", "mm", 1),
    );
    figure.equal = true;
    figure.value = Some(Axis::new("Off the wall", "mm", 3));
    figure.views = result.view_names();
    Ok(figure.with(Layer::Dots {
        series: "wall",
        radius: 1.3 * radius(dots.len()),
        dots,
    }))
}

fn on_wall(view: &View, unrolled: Option<f64>, point: [f64; 3]) -> [f64; 2] {
    let [across, up, behind] = view.place(point);
    match unrolled {
        Some(radius) => [radius * libm::atan2(across, -behind), up],
        None => [across, up],
    }
}

/// One wild point shall not take the colours from all others: they end a little beyond nine tenths.
fn usual_most(sizes: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = sizes.collect();
    sort_by_number(&mut sizes, |size| *size);
    let ninth = sizes.get(sizes.len() * 9 / 10).copied();
    (1.5 * ninth.unwrap_or_default()).max(1e-6)
}
