//! Fitting each shape, and choosing the simplest that the points support.

use super::VesselError;
use super::freeform;
use super::refine::{SurfaceFit, refine};
use super::start;
use crate::geometry::{FitError, Point, WeightedPoint, World, fit_plane};
use crate::optics::Surface;
use crate::robust::tukey_loss;
use crate::scan::VesselShape;

/// What `auto` decided between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeChoice {
    /// The shape that was chosen.
    pub chosen: VesselShape,
    /// The next best.
    pub runner_up: VesselShape,
    /// By how much the chosen one's information criterion is lower; above 10 the matter is settled.
    pub margin: f64,
}

/// Fits the wall's outer face; the points are those of the views, `front` is where the rig is.
pub(super) fn fit(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: VesselShape,
) -> Result<(SurfaceFit, Option<ShapeChoice>), VesselError> {
    match shape {
        VesselShape::Auto => choose(points, front),
        one => fit_one(points, front, one).map(|fit| (fit, None)),
    }
}

/// The surface of a shape through points of which more than half lie on it; `None` where there is none.
pub fn fit_shape(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: VesselShape,
) -> Option<Surface> {
    fit(points, front, shape).ok().map(|(fit, _)| fit.surface)
}

/// A surface fitted to points once more, from near where it is.
pub fn refit_shape(points: &[WeightedPoint<World>], near: &Surface) -> Option<Surface> {
    refit(points, near).map(|fit| fit.surface)
}

fn fit_one(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: VesselShape,
) -> Result<SurfaceFit, VesselError> {
    let places: Vec<Point<World>> = points.iter().map(|p| p.point).collect();
    let (starts, name, needed) = match shape {
        VesselShape::Cylinder => (start::cylinders(&places, front), "cylinder", 5),
        VesselShape::Sphere => (
            start::sphere(&places, front).into_iter().collect(),
            "sphere",
            4,
        ),
        VesselShape::Freeform => (
            start::freeform(points, front).into_iter().collect(),
            "free-form wall",
            12,
        ),
        _ => (
            vec![Surface::Plane(fit_plane(points, front)?.plane)],
            "plane",
            3,
        ),
    };
    if points.len() < needed {
        return Err(VesselError::TooFewPoints {
            shape: name,
            needed,
            found: points.len(),
        });
    }
    let fits = starts.into_iter().filter_map(|start| refit(points, &start));
    let fit = fits
        .filter(|fit| fit.surface.signed_distance(front) > 0.0)
        .min_by(|a, b| a.scale.total_cmp(&b.scale))
        .ok_or(VesselError::Undetermined { shape: name })?;
    let supporting = fit.weights.iter().filter(|w| **w > 0.0).count();
    if 2 * supporting <= points.len() {
        return Err(VesselError::Fit(FitError::NoConsensus {
            inliers: supporting,
            points: points.len(),
        }));
    }
    Ok(fit)
}

/// Fits a surface anew, from where it is.
pub(super) fn refit(points: &[WeightedPoint<World>], start: &Surface) -> Option<SurfaceFit> {
    match start {
        Surface::Freeform(freeform) => freeform::fit(points, freeform.sheet().reference),
        of_few_numbers => refine(points, of_few_numbers),
    }
}

/// Takes the shape of the least Bayesian information criterion,
///
/// ```text
/// BIC = sum rho(r_i / s) + k ln N,   rho Tukey's loss, s the robust scale of the closest fit
/// ```
///
/// with k the numbers that move the shape: a shape with more of them must earn them. (G. Schwarz, 1978;
/// with a robust loss in place of the squares.)
fn choose(
    points: &[WeightedPoint<World>],
    front: Point<World>,
) -> Result<(SurfaceFit, Option<ShapeChoice>), VesselError> {
    let shapes = [
        VesselShape::Plane,
        VesselShape::Sphere,
        VesselShape::Cylinder,
        VesselShape::Freeform,
    ];
    let mut fits = Vec::new();
    let mut first_error = None;
    for shape in shapes {
        match fit_one(points, front, shape) {
            // A free form that the noise has smoothed flat is the plane once more.
            Ok(fit) if shape == VesselShape::Freeform && fit.effective_freedom < 4.0 => {}
            Ok(fit) => fits.push((shape, fit)),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    let scale = |fit: &SurfaceFit| {
        let count = points.len() as f64;
        fit.scale * (count / (count - fit.effective_freedom).max(1.0)).sqrt()
    };
    let closest = fits
        .iter()
        .map(|(_, fit)| scale(fit))
        .fold(f64::INFINITY, f64::min);
    let noise = closest.max(1e-9);
    let criterion = |fit: &SurfaceFit| {
        let loss =
            |p: &WeightedPoint<World>| tukey_loss(fit.surface.signed_distance(p.point) / noise);
        let k = fit.effective_freedom;
        points.iter().map(loss).sum::<f64>() + k * libm::log(points.len() as f64)
    };
    let mut ranked: Vec<_> = fits
        .into_iter()
        .map(|(s, fit)| (criterion(&fit), s, fit))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ranked = ranked.into_iter();
    let Some((least, chosen, fit)) = ranked.next() else {
        return Err(first_error.unwrap_or(VesselError::Undetermined { shape: "auto" }));
    };
    let choice = ranked.next().map(|(next, runner_up, _)| ShapeChoice {
        chosen,
        runner_up,
        margin: next - least,
    });
    Ok((fit, choice))
}
