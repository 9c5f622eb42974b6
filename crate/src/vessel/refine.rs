//! Fitting any surface to points of which some may be wrong.

use nalgebra::{DMatrix, DVector};

use super::evidence::Alternative;
use crate::geometry::{WeightedPoint, World};
use crate::optics::Surface;
use crate::robust::{self, robust_scale};

/// A surface fitted to points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SurfaceFit {
    pub(super) surface: Surface,
    /// The final weight of each point, 1/mm^2; 0 for those that do not support the surface.
    pub(super) weights: Vec<f64>,
    /// How far each point lies in front of the surface, mm.
    pub(super) residuals: DVector<f64>,
    /// How the points' distances from the surface change with its parameters, a row a point.
    pub(super) jacobian: DMatrix<f64>,
    /// What turns weighted distances into a step of the parameters: the inverse of J^T W J, with the
    /// penalty of a free form in it.
    pub(super) inverse_information: DMatrix<f64>,
    /// How many numbers the points had to give: fewer than there are where a penalty holds some.
    pub(super) effective_freedom: f64,
    /// Covariance of the parameters, in the order and units of [`Surface::nudged`].
    pub(super) covariance: DMatrix<f64>,
    /// Where it is left open what kind of surface it is: what the covariance is made of.
    pub(super) alternatives: Vec<Alternative>,
    /// Root mean square distance of the supporting points, mm.
    pub(super) rms: f64,
    /// Robust standard deviation of all points' distances, mm.
    pub(super) scale: f64,
}

const STEPS: usize = 60;
/// Parameters are radians and mm alike: small against both, large against rounding.
const DERIVATIVE_STEP: f64 = 1e-5;

/// Refines a surface by iteratively reweighted least squares: Gauss-Newton steps on the distances, with
/// Tukey's biweight at the points' own robust scale. `None` where the points leave a parameter open.
///
/// The covariance is that of the weighted fit, scaled up where the residuals are larger than the
/// points' sigmas.
pub(super) fn refine(points: &[WeightedPoint<World>], start: &Surface) -> Option<SurfaceFit> {
    let mut surface = start.clone();
    for _ in 0..STEPS {
        let weights = biweights(points, &surface);
        let jacobian = jacobian(points, &surface);
        let distances = distances(points, &surface);
        let step = -solve(&jacobian, &weights, &distances)?;
        // Far from the solution a full step can overshoot; radians and mm are both halved to be safe.
        let damped = &step * (20.0 / step.amax().max(20.0));
        surface = surface.nudged(&damped);
        let moved = (&jacobian * &damped).amax();
        if !moved.is_finite() {
            return None;
        }
        if moved < 1e-10 {
            break;
        }
    }
    summarise(points, surface)
}

/// A surface that is known: the points are held against it, and it does not move.
pub(super) fn hold(points: &[WeightedPoint<World>], surface: Surface) -> SurfaceFit {
    let jacobian = DMatrix::zeros(points.len(), surface.freedom());
    let distances = distances(points, &surface);
    let weights = biweights(points, &surface);
    let freedom = surface.freedom();
    SurfaceFit {
        rms: supported_rms(&distances, &weights),
        scale: robust_scale(distances.as_slice()),
        covariance: DMatrix::zeros(freedom, freedom),
        inverse_information: DMatrix::zeros(freedom, freedom),
        effective_freedom: 0.0,
        alternatives: Vec::new(),
        surface,
        weights,
        residuals: distances,
        jacobian,
    }
}

pub(super) fn supported_rms(distances: &DVector<f64>, weights: &[f64]) -> f64 {
    let supporting = distances.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    let (count, squares) = supporting.fold((0.0, 0.0), |(n, s), (d, _)| (n + 1.0, s + d * d));
    (squares / f64::max(count, 1.0)).sqrt()
}

impl SurfaceFit {
    /// Counts an error that would move the parameters by `step`.
    pub(super) fn add_error(&mut self, step: &DVector<f64>) {
        self.covariance += step * step.transpose();
        for alternative in &mut self.alternatives {
            let last = alternative.root.ncols();
            let root = std::mem::take(&mut alternative.root);
            alternative.root = root.insert_column(last, 0.0);
            alternative.root.set_column(last, step);
        }
    }

    /// The step of the parameters that follows points which move across the surface by `shifts` (mm):
    /// the weighted fit, linearised.
    pub(super) fn response(&self, shifts: &DVector<f64>) -> Option<DVector<f64>> {
        let weighted = DVector::from_iterator(
            shifts.len(),
            shifts
                .iter()
                .zip(&self.weights)
                .map(|(shift, weight)| shift * weight),
        );
        let step = -(&self.inverse_information * self.jacobian.tr_mul(&weighted));
        step.iter().all(|x| x.is_finite()).then_some(step)
    }
}

/// Solves the weighted least-squares problem J x = d.
fn solve(jacobian: &DMatrix<f64>, weights: &[f64], d: &DVector<f64>) -> Option<DVector<f64>> {
    let (information, right) = normal_equations(jacobian, weights, d);
    Some(inverse(information)? * right)
}

fn normal_equations(
    jacobian: &DMatrix<f64>,
    weights: &[f64],
    d: &DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let n = jacobian.ncols();
    let mut information = DMatrix::zeros(n, n);
    let mut right = DVector::zeros(n);
    for (row, weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        for i in 0..n {
            let scaled = weight * jacobian[(row, i)];
            right[i] += scaled * d[row];
            for j in 0..n {
                information[(i, j)] += scaled * jacobian[(row, j)];
            }
        }
    }
    (information, right)
}

/// Inverts an information matrix; `None` where it is singular for its size.
fn inverse(information: DMatrix<f64>) -> Option<DMatrix<f64>> {
    // Scaled to a unit diagonal, so that radians and mm compare.
    let scale = information.diagonal().map(|d| 1.0 / d.sqrt());
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    let n = scale.len();
    let unit = DMatrix::from_fn(n, n, |i, j| information[(i, j)] * scale[i] * scale[j]);
    let least = unit.clone().symmetric_eigenvalues().min();
    if least.is_nan() || least < 1e-10 {
        return None;
    }
    let inverse = unit.cholesky()?.inverse();
    Some(DMatrix::from_fn(n, n, |i, j| {
        inverse[(i, j)] * scale[i] * scale[j]
    }))
}

fn distances(points: &[WeightedPoint<World>], surface: &Surface) -> DVector<f64> {
    DVector::from_iterator(
        points.len(),
        points.iter().map(|p| surface.signed_distance(p.point)),
    )
}

fn jacobian(points: &[WeightedPoint<World>], surface: &Surface) -> DMatrix<f64> {
    let n = surface.freedom();
    let mut jacobian = DMatrix::zeros(points.len(), n);
    for parameter in 0..n {
        let mut step = DVector::zeros(n);
        step[parameter] = DERIVATIVE_STEP;
        let (ahead, back) = (surface.nudged(&step), surface.nudged(&-step));
        for (row, p) in points.iter().enumerate() {
            let rise = ahead.signed_distance(p.point) - back.signed_distance(p.point);
            jacobian[(row, parameter)] = rise / (2.0 * DERIVATIVE_STEP);
        }
    }
    jacobian
}

pub(super) fn biweights(points: &[WeightedPoint<World>], surface: &Surface) -> Vec<f64> {
    let normalised: Vec<f64> = points
        .iter()
        .map(|p| surface.signed_distance(p.point) / p.sigma)
        .collect();
    let weights = robust::biweights(&normalised).zip(points);
    weights
        .map(|(weight, p)| weight / (p.sigma * p.sigma))
        .collect()
}

fn summarise(points: &[WeightedPoint<World>], surface: Surface) -> Option<SurfaceFit> {
    let weights = biweights(points, &surface);
    let jacobian = jacobian(points, &surface);
    let distances = distances(points, &surface);
    let supporting: Vec<usize> = (0..points.len()).filter(|i| weights[*i] > 0.0).collect();
    let mut chi = 0.0;
    for &i in &supporting {
        let z = distances[i] / points[i].sigma;
        chi += z * z;
    }
    let freedom = supporting.len().saturating_sub(surface.freedom()).max(1) as f64;
    let plain: Vec<f64> = points
        .iter()
        .zip(&weights)
        .map(|(p, w)| {
            if *w > 0.0 {
                1.0 / (p.sigma * p.sigma)
            } else {
                0.0
            }
        })
        .collect();
    let (information, _) = normal_equations(&jacobian, &plain, &distances);
    let (weighted, _) = normal_equations(&jacobian, &weights, &distances);
    Some(SurfaceFit {
        covariance: inverse(information)? * (chi / freedom).max(1.0),
        inverse_information: inverse(weighted)?,
        effective_freedom: surface.freedom() as f64,
        alternatives: Vec::new(),
        surface,
        rms: supported_rms(&distances, &weights),
        scale: robust_scale(distances.as_slice()),
        weights,
        residuals: distances,
        jacobian,
    })
}
