//! Vessel and object from above, with refraction and without: the paper's Fig. 11.

use super::super::{ReconstructionResult, WallResult};
use super::radius;
use super::view::View;
use crate::geometry::{Direction, Point, Ray};
use crate::plot::{Axis, Dot, Figure, Ink, Layer, PlotError};

/// The object by bent or by straight rays. Both have the same axes, so that they compare.
pub(super) fn figure(result: &ReconstructionResult, refracted: bool) -> Result<Figure, PlotError> {
    let view = View::of(result)?;
    let (bent, straight) = (dots(result, &view, true), dots(result, &view, false));
    let (shown, other, title) = if refracted {
        (bent, straight, "Top view, with refraction")
    } else {
        (straight, bent, "Top view, without refraction")
    };
    let wall: Vec<Dot> = wall_dots(result, &view);
    let places = shown.iter().chain(&other).chain(&wall).map(|dot| dot.at);
    let within: Vec<[f64; 2]> = places.collect();
    if within.is_empty() {
        return Err(PlotError::Nothing);
    }
    let mut figure = Figure::new(
        title,
        Axis::new("Along the scan", "mm", 2),
        Axis::new("Behind the wall", "mm", 2),
    );
    figure.equal = true;
    figure.views = result.view_names();
    for points in wall_lines(result, &view, &within) {
        figure = figure.with(Layer::Line {
            ink: Ink::Wall,
            series: None,
            points,
        });
    }
    figure.within = within;
    Ok(figure
        .with(Layer::Dots {
            series: "wall",
            radius: 0.6 * radius(wall.len()),
            dots: wall,
        })
        .with(Layer::Dots {
            series: "object",
            radius: radius(shown.len()),
            dots: shown,
        }))
}

fn dots(result: &ReconstructionResult, view: &View, refracted: bool) -> Vec<Dot> {
    let mut dots = Vec::new();
    for (number, of) in result.numbered() {
        let points: Vec<[f64; 3]> = if refracted {
            of.object.iter().copied().collect()
        } else {
            of.object_unrefracted.iter().copied().flatten().collect()
        };
        dots.extend(points.into_iter().map(|point| Dot {
            at: view.top_down(point),
            ink: Ink::Sweep(of.sweep),
            value: None,
            view: Some(number),
        }));
    }
    dots
}

fn wall_dots(result: &ReconstructionResult, view: &View) -> Vec<Dot> {
    let views = result.numbered();
    let dots = views.flat_map(|(number, of)| {
        of.vessel.iter().map(move |point| Dot {
            at: view.top_down(*point),
            ink: Ink::Wall,
            value: None,
            view: Some(number),
        })
    });
    dots.collect()
}

/// Both faces of the wall: circles of a round vessel, else a section through the middle.
fn wall_lines(
    result: &ReconstructionResult,
    view: &View,
    within: &[[f64; 2]],
) -> Vec<Vec<[f64; 2]>> {
    let thickness = result.vessel.wall_thickness;
    match &result.vessel.wall {
        WallResult::Cylinder { radius, .. } | WallResult::Sphere { radius, .. } => {
            let radii = [*radius, radius - thickness].into_iter();
            radii.filter(|r| *r > 0.0).map(circle).collect()
        }
        _ => [0.0, thickness]
            .map(|depth| section(result, view, within, depth))
            .into(),
    }
}

/// A circle about the origin.
fn circle(radius: f64) -> Vec<[f64; 2]> {
    const STEPS: u32 = 1440;
    let at = |k| std::f64::consts::TAU * f64::from(k) / f64::from(STEPS);
    (0..=STEPS)
        .map(at)
        .map(|angle| [radius * libm::cos(angle), radius * libm::sin(angle)])
        .collect()
}

/// A face of the wall as light from the rig meets it, all along the drawing.
fn section(
    result: &ReconstructionResult,
    view: &View,
    within: &[[f64; 2]],
    depth: f64,
) -> Vec<[f64; 2]> {
    const STEPS: u32 = 240;
    let Some(face) = result.vessel.surface().and_then(|s| s.behind(depth)) else {
        return Vec::new();
    };
    let Ok(into) = Direction::new(view.behind) else {
        return Vec::new();
    };
    let size = within
        .iter()
        .flatten()
        .fold(0.0, |most: f64, x| most.max(x.abs()));
    let places = (0..=STEPS).filter_map(|k| {
        // Twice as far as the points: the axes may be longer than they need.
        let across = 2.0 * size * (2.0 * f64::from(k) / f64::from(STEPS) - 1.0);
        let start = view.origin + view.across * across - view.behind * (2.0 * size + 1000.0);
        let hit = face.hit(&Ray::new(Point::from_coords(start), into))?;
        Some(view.top_down(hit.point.to_array()))
    });
    places.collect()
}
