//! A free-form wall through scattered points: a penalised spline whose smoothness the noise decides.

use nalgebra::{DMatrix, DVector, Vector2};

use super::refine::{SurfaceFit, biweights, supported_rms};
use crate::geometry::{Plane, WeightedPoint, World};
use crate::optics::{Freeform, Grid, Sheet, Surface, convex_hull};
use crate::robust::robust_scale;

/// Fits heights over a reference plane (P-splines after P. Eilers and B. Marx, 1996).
///
/// With B the B-spline's values at the points, W their weights, P the sum of squared second differences
/// of the control heights c (a discrete bending energy),
///
/// ```text
/// c = argmin (h - B c)^T W (h - B c) + lambda c^T P c
/// ```
///
/// and lambda minimises the generalised cross-validation score N |r|_W^2 / (N - 1.4 tr H)^2, so nobody
/// has to choose it (the 1.4 keeps small samples from being interpolated: C. Gu, 2002). Outliers lose weight by Tukey's biweight. The covariance is the posterior's,
/// (B^T W B + lambda P)^-1, scaled up where the residuals are larger than the points' sigmas.
pub(super) fn fit(points: &[WeightedPoint<World>], reference: Plane<World>) -> Option<SurfaceFit> {
    let grid = grid(points, &reference);
    let sheet = Sheet {
        patch: patch(points, &reference),
        heights: vec![0.0; grid.len()],
        reference,
        grid,
    };
    let problem = Problem::new(points, &sheet);
    let mut surface = Surface::Freeform(Freeform::new(sheet));
    let mut smoothness = problem.smoothest();
    let mut solved = None;
    for _ in 0..REWEIGHTINGS {
        // The first round takes all points alike: a flat start would cast out a curved wall's flanks.
        let weights = match solved {
            None => points.iter().map(|p| 1.0 / (p.sigma * p.sigma)).collect(),
            Some(_) => biweights(points, &surface),
        };
        let normal = problem.normal(&weights);
        smoothness = problem
            .choose_smoothness(&normal, &weights)
            .unwrap_or(smoothness);
        let (heights, inverse, freedom) = normal.solve(smoothness)?;
        let Surface::Freeform(freeform) = &surface else {
            return None;
        };
        let mut sheet = freeform.sheet().clone();
        sheet.heights = heights.iter().copied().collect();
        surface = Surface::Freeform(Freeform::new(sheet));
        solved = Some((inverse, freedom, weights));
    }
    let (inverse, freedom, weights) = solved?;
    Some(problem.summarise(points, surface, inverse, freedom, weights))
}

const REWEIGHTINGS: usize = 6;
const CAUTION: f64 = 1.4;
const MOST_CELLS: f64 = 14.0;

/// The points' places and heights over the reference plane.
fn places(
    points: &[WeightedPoint<World>],
    reference: &Plane<World>,
) -> impl Iterator<Item = (Vector2<f64>, f64)> {
    let (u, v) = reference.normal.tangents();
    points.iter().map(move |p| {
        let d = p.point - reference.point;
        (
            Vector2::new(d.dot(&u), d.dot(&v)),
            reference.signed_distance(p.point),
        )
    })
}

/// A grid over the points with about as many cells as the points can fill.
fn grid(points: &[WeightedPoint<World>], reference: &Plane<World>) -> Grid {
    let mut low = Vector2::repeat(f64::INFINITY);
    let mut high = Vector2::repeat(f64::NEG_INFINITY);
    for (place, _) in places(points, reference) {
        low = low.inf(&place);
        high = high.sup(&place);
    }
    let extent = (high - low).add_scalar(1e-6);
    // As many cells as points, about square; smoothness is the penalty's business.
    let edge = (extent.x * extent.y / points.len() as f64).sqrt();
    let cells = extent.map(|length| (length / edge).ceil().clamp(2.0, MOST_CELLS));
    Grid {
        start: low,
        step: extent.component_div(&cells),
        columns: cells.x as usize + 3,
        rows: cells.y as usize + 3,
    }
}

/// The convex hull of the points and a margin of half their usual distance.
fn patch(points: &[WeightedPoint<World>], reference: &Plane<World>) -> Vec<Vector2<f64>> {
    let places: Vec<Vector2<f64>> = places(points, reference).map(|(place, _)| place).collect();
    let hull = convex_hull(&places);
    let middle = hull.iter().sum::<Vector2<f64>>() / hull.len() as f64;
    let extent = hull
        .iter()
        .map(|corner| (corner - middle).norm())
        .fold(0.0, f64::max);
    let margin = 0.5 * extent / (places.len() as f64).sqrt();
    hull.iter()
        .map(|corner| corner + (corner - middle).normalize() * margin)
        .collect()
}

/// What does not change while weights and smoothness are sought.
struct Problem {
    basis: DMatrix<f64>,
    penalty: DMatrix<f64>,
    heights: DVector<f64>,
}

/// The normal equations for one set of weights.
struct Normal<'a> {
    information: DMatrix<f64>,
    right: DVector<f64>,
    penalty: &'a DMatrix<f64>,
}

impl Problem {
    fn new(points: &[WeightedPoint<World>], sheet: &Sheet) -> Self {
        let mut basis = DMatrix::zeros(points.len(), sheet.grid.len());
        let mut heights = DVector::zeros(points.len());
        for (row, (place, height)) in places(points, &sheet.reference).enumerate() {
            heights[row] = height;
            for (index, weight, _) in sheet.grid.support(place).terms {
                basis[(row, index)] = weight;
            }
        }
        Self {
            basis,
            penalty: bending(&sheet.grid),
            heights,
        }
    }

    fn smoothest(&self) -> f64 {
        1e6
    }

    fn normal(&self, weights: &[f64]) -> Normal<'_> {
        let mut weighted = self.basis.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
            row *= *weight;
        }
        Normal {
            information: self.basis.tr_mul(&weighted),
            right: weighted.tr_mul(&self.heights),
            penalty: &self.penalty,
        }
    }

    /// The smoothness of least generalised cross-validation score, among powers of 10^(1/2).
    fn choose_smoothness(&self, normal: &Normal, weights: &[f64]) -> Option<f64> {
        let scale = normal.information.trace() / self.penalty.trace();
        let candidates = (-16..=12).map(|power| scale * libm::exp10(0.5 * f64::from(power)));
        let scored = candidates.filter_map(|smoothness| {
            let (heights, _, freedom) = normal.solve(smoothness)?;
            let residuals = &self.heights - &self.basis * heights;
            let squares = residuals.iter().zip(weights).map(|(r, w)| r * r * w);
            let count = weights.iter().filter(|w| **w > 0.0).count() as f64;
            let left = count - CAUTION * freedom;
            (freedom < 0.5 * count && left > 0.0)
                .then(|| (squares.sum::<f64>() * count / (left * left), smoothness))
        });
        scored
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, smoothness)| smoothness)
    }

    fn summarise(
        &self,
        points: &[WeightedPoint<World>],
        surface: Surface,
        inverse: DMatrix<f64>,
        freedom: f64,
        weights: Vec<f64>,
    ) -> SurfaceFit {
        let distance = |p: &WeightedPoint<World>| surface.signed_distance(p.point);
        let residuals = DVector::from_iterator(points.len(), points.iter().map(distance));
        let supporting = points.iter().zip(&weights).zip(residuals.iter());
        let (count, chi) = supporting
            .filter(|((_, weight), _)| **weight > 0.0)
            .fold((0.0, 0.0), |(n, chi), ((p, _), r)| {
                (n + 1.0, chi + (r / p.sigma) * (r / p.sigma))
            });
        let inflation = (chi / f64::max(count - freedom, 1.0)).max(1.0);
        SurfaceFit {
            rms: supported_rms(&residuals, &weights),
            scale: robust_scale(residuals.as_slice()),
            covariance: &inverse * inflation,
            // Raising a control point lowers the distances of the points under it.
            jacobian: -&self.basis,
            inverse_information: inverse,
            effective_freedom: freedom,
            surface,
            weights,
            residuals,
        }
    }
}

impl Normal<'_> {
    /// Control heights, inverse of the penalised information, and the effective degrees of freedom tr H.
    fn solve(&self, smoothness: f64) -> Option<(DVector<f64>, DMatrix<f64>, f64)> {
        // A breath of ridge keeps the control points that no datum and no bending reaches in place.
        let ridge = 1e-12 * self.information.trace();
        let n = self.right.len();
        let penalised =
            &self.information + self.penalty * smoothness + DMatrix::identity(n, n) * ridge;
        let inverse = penalised.cholesky()?.inverse();
        let freedom = inverse.component_mul(&self.information).sum();
        Some((&inverse * &self.right, inverse, freedom))
    }
}

/// Sum of squared second differences along both tangents and across: the matrix P. Planes cost nothing.
fn bending(grid: &Grid) -> DMatrix<f64> {
    let mut penalty = DMatrix::zeros(grid.len(), grid.len());
    let at = |column: usize, row: usize| row * grid.columns + column;
    let mut add = |terms: &[(usize, f64)], factor: f64| {
        for (i, a) in terms {
            for (j, b) in terms {
                penalty[(*i, *j)] += factor * a * b;
            }
        }
    };
    let (per_u, per_v) = (
        1.0 / (grid.step.x * grid.step.x),
        1.0 / (grid.step.y * grid.step.y),
    );
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            if column + 2 < grid.columns {
                let along = [
                    (at(column, row), 1.0),
                    (at(column + 1, row), -2.0),
                    (at(column + 2, row), 1.0),
                ];
                add(&along, per_u * per_u);
            }
            if row + 2 < grid.rows {
                let along = [
                    (at(column, row), 1.0),
                    (at(column, row + 1), -2.0),
                    (at(column, row + 2), 1.0),
                ];
                add(&along, per_v * per_v);
            }
            if column + 1 < grid.columns && row + 1 < grid.rows {
                let twist = [
                    (at(column, row), 1.0),
                    (at(column + 1, row), -1.0),
                    (at(column, row + 1), -1.0),
                    (at(column + 1, row + 1), 1.0),
                ];
                add(&twist, 2.0 * per_u * per_v);
            }
        }
    }
    penalty
}
