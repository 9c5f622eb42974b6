//! How far the two light paths of each object point miss each other.

use super::super::ReconstructionResult;
use super::radius;
use crate::plot::{Axis, Bar, Dot, Figure, Ink, Layer, PlotError};
use crate::robust::sort_by_number;

/// The sheet of a line laser meets every line of sight, to the last bits of the numbers.
const NOTHING: f64 = 1e-9;

/// A ray distance and the view it is of.
type Distance = (f64, usize);

/// View by view.
pub(super) fn by_view(result: &ReconstructionResult) -> Result<Figure, PlotError> {
    distances(result)?;
    let mut dots = Vec::new();
    for (number, of) in result.numbered() {
        dots.extend(of.ray_distance.iter().map(|distance| Dot {
            at: [number as f64, *distance],
            ink: Ink::Sweep(of.sweep),
            value: None,
            view: Some(number),
        }));
    }
    let mut figure = Figure::new(
        "Ray distances",
        Axis::new("Views in their order", "", 0),
        Axis::new("Ray distance", "mm", 3),
    );
    figure.within = vec![[0.0, 0.0]];
    figure.views = result.view_names();
    Ok(figure.with(Layer::Dots {
        series: "object",
        radius: radius(dots.len()),
        dots,
    }))
}

/// How often which one occurs.
pub(super) fn histogram(result: &ReconstructionResult) -> Result<Figure, PlotError> {
    let mut distances = distances(result)?;
    sort_by_number(&mut distances, |distance| distance.0);
    let greatest = distances.last().map_or(0.0, |last| last.0);
    let count = bins(distances.len());
    let width = greatest / count as f64;
    let mut bins: Vec<Vec<Distance>> = vec![Vec::new(); count];
    for distance in distances {
        let bin = (distance.0 / width) as usize;
        bins[bin.min(count - 1)].push(distance);
    }
    let bar = |(number, bin): (usize, &Vec<Distance>)| Bar {
        across: [number as f64, number as f64 + 1.0].map(|edge| edge * width),
        height: bin.len() as f64,
        // The one in the middle stands for its bar.
        view: bin.get(bin.len() / 2).map(|(_, view)| *view),
    };
    let mut figure = Figure::new(
        "Histogram of the ray distances",
        Axis::new("Ray distance", "mm", 3),
        Axis::new("Points", "", 0),
    );
    figure.within = vec![[0.0, 0.0]];
    Ok(figure.with(Layer::Bars(bins.iter().enumerate().map(bar).collect())))
}

/// By Sturges' rule, within what a figure shows well.
fn bins(values: usize) -> usize {
    const LEAST: usize = 6;
    const MOST: usize = 40;
    (1 + values.max(1).ilog2() as usize * 2).clamp(LEAST, MOST)
}

fn distances(result: &ReconstructionResult) -> Result<Vec<Distance>, PlotError> {
    let distances = result.numbered();
    let distances =
        distances.flat_map(|(number, of)| of.ray_distance.iter().map(move |d| (*d, number)));
    let distances: Vec<Distance> = distances.collect();
    let tells = distances.iter().any(|(distance, _)| *distance > NOTHING);
    if tells {
        Ok(distances)
    } else {
        Err(PlotError::Nothing)
    }
}
