//! Fitting each shape, and choosing the simplest that the points support.

use super::VesselError;
use super::freeform;
use super::refine::{SurfaceFit, refine};
use super::start;
use crate::geometry::{FitError, Point, WeightedPoint, World, fit_plane, spread_out};
use crate::optics::{Base, Surface};
use crate::robust::{robust_scale, sort_by_number, tukey_loss};
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

const SIMPLE: [VesselShape; 3] = [
    VesselShape::Plane,
    VesselShape::Sphere,
    VesselShape::Cylinder,
];

fn fit_one(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: VesselShape,
) -> Result<SurfaceFit, VesselError> {
    if shape != VesselShape::Freeform {
        return fit_simple(points, front, shape);
    }
    let simple: Vec<SurfaceFit> = SIMPLE
        .iter()
        .filter_map(|shape| fit_simple(points, front, *shape).ok())
        .collect();
    fit_freeform(points, front, &simple)
}

fn fit_simple(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: VesselShape,
) -> Result<SurfaceFit, VesselError> {
    let (name, needed) = match shape {
        VesselShape::Cylinder => ("cylinder", 5),
        VesselShape::Sphere => ("sphere", 4),
        _ => ("plane", 3),
    };
    enough(points, needed, name)?;
    let places: Vec<Point<World>> = points.iter().map(|p| p.point).collect();
    let starts = match shape {
        VesselShape::Cylinder => start::cylinders(&places, front),
        VesselShape::Sphere => start::sphere(&places, front).into_iter().collect(),
        _ => vec![Surface::Plane(fit_plane(points, front)?.plane)],
    };
    let fits = starts
        .into_iter()
        .filter_map(|start| refine(points, &start));
    best_supported(fits, points, front, name)
}

/// Fits free forms over each of the simple shapes and over a plane across the rig's view, over which
/// every point of the wall that the rig saw has one height; takes the one of the least information
/// criterion.
fn fit_freeform(
    points: &[WeightedPoint<World>],
    front: Point<World>,
    simple: &[SurfaceFit],
) -> Result<SurfaceFit, VesselError> {
    const NAME: &str = "free-form wall";
    enough(points, 12, NAME)?;
    let places: Vec<Point<World>> = points.iter().map(|p| p.point).collect();
    let across = start::across_view(&places, front).map(|plane| Base::on_plane(&plane));
    let bases = simple
        .iter()
        .filter_map(|fit| start::base(&fit.surface, &places));
    let fits: Vec<SurfaceFit> = across
        .into_iter()
        .chain(bases)
        .filter_map(|base| freeform::fit(points, base))
        .collect();
    let noise = noise(points, &fits);
    let ranked = fits
        .into_iter()
        .min_by(|a, b| criterion(points, a, noise).total_cmp(&criterion(points, b, noise)));
    best_supported(ranked.into_iter(), points, front, NAME)
}

/// Refuses fewer points than a shape needs, and points on a straight line, which determine none.
fn enough(
    points: &[WeightedPoint<World>],
    needed: usize,
    shape: &'static str,
) -> Result<(), VesselError> {
    if points.len() < needed {
        return Err(VesselError::TooFewPoints {
            shape,
            needed,
            found: points.len(),
        });
    }
    Ok(spread_out(points)?)
}

/// The closest of some fits, if more than half of the points support it.
fn best_supported(
    fits: impl Iterator<Item = SurfaceFit>,
    points: &[WeightedPoint<World>],
    front: Point<World>,
    shape: &'static str,
) -> Result<SurfaceFit, VesselError> {
    let fit = fits
        .filter(|fit| fit.surface.signed_distance(front) > 0.0)
        .min_by(|a, b| a.scale.total_cmp(&b.scale))
        .ok_or(VesselError::Undetermined { shape })?;
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
        Surface::Freeform(freeform) => freeform::fit(points, freeform.sheet().base),
        of_few_numbers => refine(points, of_few_numbers),
    }
}

/// Takes the shape of the least Bayesian information criterion.
fn choose(
    points: &[WeightedPoint<World>],
    front: Point<World>,
) -> Result<(SurfaceFit, Option<ShapeChoice>), VesselError> {
    let mut fits = Vec::new();
    let mut first_error = None;
    for shape in SIMPLE {
        match fit_simple(points, front, shape) {
            Ok(fit) => fits.push((shape, fit)),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    let simple: Vec<SurfaceFit> = fits.iter().map(|(_, fit)| fit.clone()).collect();
    match fit_freeform(points, front, &simple) {
        Ok(fit) => fits.push((VesselShape::Freeform, fit)),
        Err(error) => first_error = first_error.or(Some(error)),
    }
    let all: Vec<SurfaceFit> = fits.iter().map(|(_, fit)| fit.clone()).collect();
    let noise = noise(points, &all);
    let mut ranked: Vec<_> = fits
        .into_iter()
        .map(|(shape, fit)| (criterion(points, &fit, noise), shape, fit))
        .collect();
    sort_by_number(&mut ranked, |fit| fit.0);
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

/// The Bayesian information criterion
///
/// ```text
/// BIC = sum rho(r_i / s sigma_i) + k ln N,   rho Tukey's loss, s the robust scale of the closest fit
/// ```
///
/// with k the numbers that the points gave to the shape, a free form's smoothness among them: a shape with
/// more of them must earn them. (G. Schwarz, 1978; with a robust loss in place of the squares.)
fn criterion(points: &[WeightedPoint<World>], fit: &SurfaceFit, noise: f64) -> f64 {
    let losses = normalised(points, fit).map(|z| tukey_loss(z / noise));
    let smoothness = f64::from(matches!(fit.surface, Surface::Freeform(_)));
    let numbers = fit.effective_freedom + smoothness;
    losses.sum::<f64>() + numbers * libm::log(points.len() as f64)
}

/// The points' distances from a fit in units of their standard deviations.
fn normalised(points: &[WeightedPoint<World>], fit: &SurfaceFit) -> impl Iterator<Item = f64> {
    let pairs = fit.residuals.iter().zip(points);
    pairs.map(|(residual, p)| residual / p.sigma)
}

/// By how much the noise of the points exceeds their standard deviations, as the closest fit shows it.
fn noise(points: &[WeightedPoint<World>], fits: &[SurfaceFit]) -> f64 {
    let count = points.len() as f64;
    let scale = |fit: &SurfaceFit| {
        let spared = count / (count - fit.effective_freedom).max(1.0);
        robust_scale(&normalised(points, fit).collect::<Vec<_>>()) * spared.sqrt()
    };
    fits.iter()
        .map(scale)
        .fold(f64::INFINITY, f64::min)
        .max(1.0)
}
