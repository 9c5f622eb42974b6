//! A free-form wall through scattered points: a penalised spline whose smoothness the noise decides.

use nalgebra::{DMatrix, DVector, Vector2};

use super::refine::{SurfaceFit, biweights, supported_rms};
use crate::geometry::{WeightedPoint, World};
use crate::optics::{Base, BaseShape, Freeform, Grid, Sheet, Surface, convex_hull};
use crate::robust::robust_scale;

/// Fits heights over a simple surface (P-splines after P. Eilers and B. Marx, 1996).
///
/// With B the B-spline's values at the points, W their weights, P the sum of squared second differences of
/// the control heights c (a discrete bending energy) and, times the square of the patch's extent, of
/// squared third ones, which keeps short waves down,
///
/// ```text
/// c = argmin (h - B c)^T W (h - B c) + lambda c^T P c
/// ```
///
/// What would merely move the base (another radius, an axis that turns) bends the heights too, and costs
/// nothing: so where the points say little, the wall is the base. Lambda is that of the greatest restricted
/// likelihood (G. Wahba, 1985; S. Wood, 2011), less one standard deviation, so nobody has to choose it. Outliers lose
/// weight by Tukey's biweight. The covariance is the posterior's, (B^T W B + lambda P)^-1, scaled up where
/// the residuals are larger than the points' sigmas.
pub(super) fn fit(points: &[WeightedPoint<World>], base: Base) -> Option<SurfaceFit> {
    let mut sheet = flat_sheet(points, base);
    let problem = Problem::new(points, &sheet);
    // The first round takes all points alike: a flat start would cast out a bulge's flanks.
    let mut weights: Vec<f64> = points.iter().map(|p| 1.0 / (p.sigma * p.sigma)).collect();
    let mut smoothness = None;
    let mut solution = None;
    for round in 0..REWEIGHTINGS {
        if round > 0 {
            weights = biweights(points, &Surface::Freeform(Freeform::new(sheet.clone())));
        }
        let normal = problem.normal(&over_base(points, &sheet, &weights));
        if round < SMOOTHINGS {
            smoothness = Some(normal.likeliest_smoothness()?);
        }
        let factor = normal.penalised(smoothness?).cholesky()?;
        sheet.heights = factor.solve(&normal.right).iter().copied().collect();
        if round + 1 == REWEIGHTINGS {
            solution = normal.solution(smoothness?);
        }
    }
    let solution = solution?;
    sheet.patch = measured_patch(points, &weights, &sheet, &solution.inverse);
    let surface = Surface::Freeform(Freeform::new(sheet));
    Some(summarise(points, surface, weights, solution))
}

const REWEIGHTINGS: usize = 8;
/// After so many rounds the smoothness is settled, and only the weights still change.
const SMOOTHINGS: usize = 3;
const MOST_CELLS: f64 = 12.0;
/// A smoothness whose -2 l is larger by so much is one standard deviation away.
const HARDLY_WORSE: f64 = 1.0;
/// How far beyond the outermost points a wall may count as measured, in spacings of the points: from
/// that of a place amid them to what the fit may support at best.
const MARGINS: [f64; 5] = [1.5, 1.25, 1.0, 0.75, 0.5];

fn flat_sheet(points: &[WeightedPoint<World>], base: Base) -> Sheet {
    let places: Vec<Vector2<f64>> = points.iter().map(|p| base.place(p.point).0).collect();
    let patch = patch(&places, MARGINS[0]);
    let grid = grid(&patch, points.len());
    Sheet {
        base,
        heights: vec![0.0; grid.len()],
        grid,
        patch,
    }
}

/// A grid over the patch with about half as many cells, nearly square, as there are points: smoothness is
/// the penalty's business.
fn grid(patch: &[Vector2<f64>], points: usize) -> Grid {
    let first = Vector2::repeat(f64::INFINITY);
    let low = patch.iter().fold(first, |low, corner| low.inf(corner));
    let high = patch.iter().fold(-first, |high, corner| high.sup(corner));
    let extent = (high - low).add_scalar(1e-6);
    let edge = (2.0 * extent.x * extent.y / points as f64).sqrt();
    let cells = extent.map(|length| (length / edge).ceil().clamp(2.0, MOST_CELLS));
    Grid {
        start: low,
        step: extent.component_div(&cells),
        columns: cells.x as usize + 3,
        rows: cells.y as usize + 3,
    }
}

/// The widest patch around the supporting points whose rim the fit determines as well as one point alone
/// does its own place.
fn measured_patch(
    points: &[WeightedPoint<World>],
    weights: &[f64],
    sheet: &Sheet,
    covariance: &DMatrix<f64>,
) -> Vec<Vector2<f64>> {
    let supporting = points.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    let places: Vec<_> = supporting
        .map(|(p, _)| sheet.base.place(p.point).0)
        .collect();
    // In units of the weights, as the covariance is.
    let one_point = places.len() as f64 / weights.iter().sum::<f64>();
    let variance = |place: Vector2<f64>| {
        let terms = sheet.grid.support(place).terms;
        let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
        let part = |((i, a, _), (j, b, _)): (&Term, &Term)| a * b * covariance[(*i, *j)];
        pairs.map(part).sum::<f64>()
    };
    let determined = |patch: &Vec<Vector2<f64>>| {
        let sides = patch.iter().zip(patch.iter().cycle().skip(1));
        let mut rim = sides.flat_map(|(a, b)| [0.0, 0.25, 0.5, 0.75].map(|t| a + (b - a) * t));
        rim.all(|place| variance(place) <= one_point)
    };
    let patches = MARGINS.map(|margin| patch(&places, margin));
    let found = patches.iter().find(|patch| determined(patch));
    found.unwrap_or(&patches[MARGINS.len() - 1]).clone()
}

/// The convex hull of places, and `margin` spacings around it.
fn patch(places: &[Vector2<f64>], margin: f64) -> Vec<Vector2<f64>> {
    const SIDES: usize = 16;
    let hull = convex_hull(places);
    let sides = hull.iter().zip(hull.iter().cycle().skip(1));
    let area = 0.5 * sides.map(|(a, b)| a.perp(b)).sum::<f64>();
    let margin = margin * (area / places.len() as f64).sqrt();
    let around = |place: &Vector2<f64>| {
        let place = *place;
        (0..SIDES).map(move |side| {
            let (sin, cos) = libm::sincos(core::f64::consts::TAU * side as f64 / SIDES as f64);
            place + Vector2::new(cos, sin) * margin
        })
    };
    convex_hull(&hull.iter().flat_map(around).collect::<Vec<_>>())
}

/// A control point that matters, with its weight and the weight's derivatives.
type Term = (usize, f64, Vector2<f64>);

/// What does not change while weights and smoothness are sought.
struct Problem {
    /// The control points that matter to each point, with their weights.
    rows: Vec<[Term; 16]>,
    /// The points' heights over the base, mm.
    heights: Vec<f64>,
    penalty: DMatrix<f64>,
    /// How many motions of the sheet the penalty does not see.
    free: usize,
}

/// The normal equations for one set of weights.
struct Normal<'a> {
    information: DMatrix<f64>,
    right: DVector<f64>,
    /// The weighted sum of the heights' squares.
    squares: f64,
    /// How many points have any weight.
    count: f64,
    problem: &'a Problem,
}

/// What is left to know once the smoothness is settled.
struct Solution {
    /// Inverse of the penalised information.
    inverse: DMatrix<f64>,
    /// The effective degrees of freedom, the trace of what turns the points into the sheet's.
    freedom: f64,
}

impl Problem {
    fn new(points: &[WeightedPoint<World>], sheet: &Sheet) -> Self {
        let placed: Vec<_> = points.iter().map(|p| sheet.base.place(p.point)).collect();
        let extent = Vector2::new(
            sheet.grid.columns as f64 - 3.0,
            sheet.grid.rows as f64 - 3.0,
        )
        .component_mul(&sheet.grid.step)
        .norm();
        let mut penalty = energy(&sheet.grid, 2) + energy(&sheet.grid, 3) * (extent * extent);
        let motions = motions(&sheet.base, &sheet.grid);
        for motion in &motions {
            forgive(&mut penalty, motion);
        }
        Self {
            rows: placed
                .iter()
                .map(|(place, _)| sheet.grid.support(*place).terms)
                .collect(),
            heights: placed.iter().map(|(_, height)| *height).collect(),
            penalty,
            free: 3 + motions.len(),
        }
    }

    fn normal(&self, weights: &[f64]) -> Normal<'_> {
        let n = self.penalty.nrows();
        let mut information = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
        let (mut squares, mut count) = (0.0, 0.0);
        for ((row, height), weight) in self.rows.iter().zip(&self.heights).zip(weights) {
            for (i, a, _) in row {
                right[*i] += weight * a * height;
                for (j, b, _) in row {
                    information[(*i, *j)] += weight * a * b;
                }
            }
            squares += weight * height * height;
            count += f64::from(*weight > 0.0);
        }
        Normal {
            information,
            right,
            squares,
            count,
            problem: self,
        }
    }
}

/// Weights for heights over the base from weights for distances from the sheet: a height is longer,
/// by the slope between the two.
fn over_base(points: &[WeightedPoint<World>], sheet: &Sheet, weights: &[f64]) -> Vec<f64> {
    let freeform = Freeform::new(sheet.clone());
    let one = |(p, weight): (&WeightedPoint<World>, &f64)| {
        let cosine = freeform.cosine(p.point);
        weight * cosine * cosine
    };
    points.iter().zip(weights).map(one).collect()
}

impl Normal<'_> {
    fn penalised(&self, smoothness: f64) -> DMatrix<f64> {
        // A breath of ridge keeps the control points that no datum and no bending reaches in place.
        let ridge = 1e-12 * self.information.trace();
        let mut penalised = &self.problem.penalty * smoothness + &self.information;
        for i in 0..penalised.nrows() {
            penalised[(i, i)] += ridge;
        }
        penalised
    }

    /// The smoothness of the greatest restricted likelihood, the noise's variance v times the weights'
    /// unknown but never below 1:
    ///
    /// ```text
    /// -2 l = (N - m) ln v + (h^T W h - b^T c) / v + ln |A + lambda P| - (n - m) ln lambda
    /// ```
    ///
    /// with A c + lambda P c = b the penalised normal equations, n control heights, and m motions that
    /// cost nothing. Sought in steps of a hundred, then between them.
    fn likeliest_smoothness(&self) -> Option<f64> {
        let unit = self.information.trace() / self.problem.penalty.trace();
        let scored = |power: f64| {
            let smoothness = unit * libm::exp10(power);
            Some((self.unlikeliness(smoothness)?, power, smoothness))
        };
        let likeliest = |powers: &mut dyn Iterator<Item = f64>| {
            let scored = powers.filter_map(scored);
            scored.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let mut best = likeliest(&mut (-4..=4).map(|i| 2.0 * f64::from(i)))?;
        for step in [1.0, 0.5, 0.25] {
            let either_side = likeliest(&mut [best.1 - step, best.1 + step].into_iter());
            best = either_side.filter(|next| next.0 < best.0).unwrap_or(best);
        }
        // Where the likelihood hardly tells a stiff sheet from a supple one, the supple one is honest about
        // what the noise may hide.
        let mut supple = best;
        while let Some(next) = scored(supple.1 - 0.5).filter(|next| next.0 <= best.0 + HARDLY_WORSE)
        {
            supple = next;
        }
        Some(supple.2)
    }

    fn unlikeliness(&self, smoothness: f64) -> Option<f64> {
        let factor = self.penalised(smoothness).cholesky()?;
        let explained = self.right.dot(&factor.solve(&self.right));
        let left = (self.squares - explained).max(0.0);
        let free = self.problem.free as f64;
        let stiff = self.right.len() as f64 - free;
        let diagonal = factor.l_dirty().diagonal();
        let volume: f64 = diagonal.iter().map(|d| 2.0 * libm::log(*d)).sum();
        let spare = (self.count - free).max(1.0);
        let variance = (left / spare).max(1.0);
        let misfit = spare * libm::log(variance) + left / variance;
        Some(misfit + volume - stiff * libm::log(smoothness))
    }

    fn solution(&self, smoothness: f64) -> Option<Solution> {
        let factor = self.penalised(smoothness).cholesky()?;
        let inverse = factor.inverse();
        Some(Solution {
            freedom: inverse.component_mul(&self.information).sum(),
            inverse,
        })
    }
}

fn summarise(
    points: &[WeightedPoint<World>],
    surface: Surface,
    weights: Vec<f64>,
    solution: Solution,
) -> SurfaceFit {
    let distance = |p: &WeightedPoint<World>| surface.signed_distance(p.point);
    let residuals = DVector::from_iterator(points.len(), points.iter().map(distance));
    let supporting = points.iter().zip(&weights).zip(residuals.iter());
    let (count, chi) = supporting
        .filter(|((_, weight), _)| **weight > 0.0)
        .fold((0.0, 0.0), |(n, chi), ((p, _), r)| {
            (n + 1.0, chi + (r / p.sigma) * (r / p.sigma))
        });
    let inflation = (chi / f64::max(count - solution.freedom, 1.0)).max(1.0);
    let mut jacobian = DMatrix::zeros(points.len(), surface.freedom());
    if let Surface::Freeform(freeform) = &surface {
        for (row, p) in points.iter().enumerate() {
            for (index, slope) in freeform.distance_slopes(p.point) {
                jacobian[(row, index)] = slope;
            }
        }
    }
    SurfaceFit {
        rms: supported_rms(&residuals, &weights),
        scale: robust_scale(residuals.as_slice()),
        covariance: &solution.inverse * inflation,
        jacobian,
        inverse_information: solution.inverse,
        effective_freedom: solution.freedom,
        surface,
        weights,
        residuals,
    }
}

/// The control heights of what a base does to first order when its radius or its axis changes, beyond
/// shifts and tilts, which bend nothing: with s and t the coordinates, s^2 + t^2 for a sphere, s^2 and
/// s t for a cylinder.
fn motions(base: &Base, grid: &Grid) -> Vec<DVector<f64>> {
    let control = |height: fn(f64, f64) -> f64| {
        let places = (0..grid.len()).map(|index| {
            let (column, row) = (index % grid.columns, index / grid.columns);
            let s = grid.start.x + (column as f64 - 1.0) * grid.step.x;
            let t = grid.start.y + (row as f64 - 1.0) * grid.step.y;
            height(s, t)
        });
        DVector::from_iterator(grid.len(), places)
    };
    match base.shape {
        BaseShape::Plane => vec![],
        BaseShape::Cylinder { .. } => vec![control(|s, _| s * s), control(|s, t| s * t)],
        BaseShape::Sphere { .. } => vec![control(|s, t| s * s + t * t)],
    }
}

/// Makes a motion cost nothing: P - (P m)(P m)^T / (m^T P m).
fn forgive(penalty: &mut DMatrix<f64>, motion: &DVector<f64>) {
    let force = &*penalty * motion;
    let energy = motion.dot(&force);
    *penalty -= &force * (force.transpose() / energy);
}

/// The energy of a sheet's derivatives of one order, as a quadratic form P of its control heights: with
/// D_u and D_v the differences along the two coordinates per length, the sum over a + b = order of
/// `binomial(order, a) |D_u^a D_v^b c|^2`. Order 2 is the energy of a thin plate that is bent.
fn energy(grid: &Grid, order: usize) -> DMatrix<f64> {
    let mut energy = DMatrix::zeros(grid.len(), grid.len());
    for across in 0..=order {
        let down = order - across;
        let (along_row, along_column) = (differences(across), differences(down));
        let scale = libm::pow(grid.step.x, across as f64) * libm::pow(grid.step.y, down as f64);
        let factor = binomial(order, across) / (scale * scale);
        for row in 0..grid.rows - down {
            for column in 0..grid.columns - across {
                let mut terms = Vec::with_capacity((across + 1) * (down + 1));
                for (j, b) in along_column.iter().enumerate() {
                    for (i, a) in along_row.iter().enumerate() {
                        terms.push(((row + j) * grid.columns + column + i, a * b));
                    }
                }
                for (i, a) in &terms {
                    for (j, b) in &terms {
                        energy[(*i, *j)] += factor * a * b;
                    }
                }
            }
        }
    }
    energy
}

/// The weights of an n-th difference: 1; -1, 1; 1, -2, 1; ...
fn differences(order: usize) -> Vec<f64> {
    let sign = |i: usize| {
        if (order - i).is_multiple_of(2) {
            1.0
        } else {
            -1.0
        }
    };
    (0..=order).map(|i| sign(i) * binomial(order, i)).collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}
