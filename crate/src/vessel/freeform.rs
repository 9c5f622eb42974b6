//! A free-form wall through scattered points: a spline whose smoothness the points themselves decide.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector2};

use super::evidence::{Alternative, covariance};
use super::refine::{SurfaceFit, biweights, supported_rms};
use crate::geometry::{WeightedPoint, World};
use crate::optics::{Base, BaseShape, Freeform, Grid, Sheet, Surface, convex_hull};
use crate::robust::robust_scale;

/// Fits heights over a simple surface: a Gaussian process (C. Rasmussen and C. Williams, 2006), whose
/// samples are the control heights of a spline.
///
/// With B the spline's values at the points and W their weights, the control heights c = M b + F u are sums
/// of motions M, which merely move the base (shift, tilt, another radius, an axis that turns) and cost
/// nothing, and of forms F with F F^T the correlations exp(-d^2 / 2 reach^2) of heights d apart:
///
/// ```text
/// c = argmin (h - B c)^T W (h - B c) + |u|^2 / amplitude^2
/// ```
///
/// So where the points say little, the wall is the base. Nobody has to choose reach and amplitude: all pairs
/// of them count by their restricted likelihood (G. Wahba, 1985), and the wall is their mean. Outliers lose
/// weight by Tukey's biweight. The covariance is the posterior's, scaled up where the residuals are larger
/// than the points' sigmas, and with what the pairs differ by.
pub(super) fn fit(points: &[WeightedPoint<World>], base: Base) -> Option<SurfaceFit> {
    let mut sheet = flat_sheet(points, base);
    let problem = Problem::new(points, &sheet);
    // The first round takes all points alike: a flat start would cast out a bulge's flanks.
    let mut weights: Vec<f64> = points.iter().map(|p| 1.0 / (p.sigma * p.sigma)).collect();
    let mut likely = Vec::new();
    for round in 0..REWEIGHTINGS {
        let normal = problem.normal(&over_base(points, &sheet, &weights));
        if round < WEIGHINGS {
            likely = normal.likely();
        }
        sheet.heights = normal.heights(&likely)?.iter().copied().collect();
        weights = biweights(points, &Surface::Freeform(Freeform::new(sheet.clone())));
    }
    let normal = problem.normal(&over_base(points, &sheet, &weights));
    let solution = normal.solution(&likely)?;
    sheet.heights = solution.heights.iter().copied().collect();
    sheet.patch = measured_patch(
        points,
        &weights,
        &sheet,
        &covariance(&solution.alternatives),
    );
    let surface = Surface::Freeform(Freeform::new(sheet));
    Some(summarise(points, surface, weights, solution))
}

const REWEIGHTINGS: usize = 8;
/// After so many rounds it is settled what counts, and only the points' weights still change.
const WEIGHINGS: usize = 3;
const MOST_CELLS: f64 = 12.0;
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

/// What does not change while the points' weights do.
struct Problem {
    /// The control points that matter to each point, with their weights.
    rows: Vec<[Term; 16]>,
    /// The points' heights over the base, mm.
    heights: Vec<f64>,
    /// How many motions of the sheet cost nothing.
    free: usize,
    /// For each reach, motions and then forms, a column each.
    bases: Vec<DMatrix<f64>>,
}

/// The normal equations for one set of weights, for the control heights.
struct Normal<'a> {
    information: DMatrix<f64>,
    right: DVector<f64>,
    /// The weighted sum of the heights' squares.
    squares: f64,
    /// How many points have any weight.
    count: f64,
    problem: &'a Problem,
}

/// The same for the amounts of motions and forms of one reach.
struct Reduced<'a> {
    information: DMatrix<f64>,
    right: DVector<f64>,
    normal: &'a Normal<'a>,
}

/// A reach, and the stiffnesses (one over the amplitude's square, mm^-2) that count, each with its weight.
struct Likely {
    reach: usize,
    stiffnesses: Vec<(f64, f64)>,
}

/// What the points make of all that is likely.
struct Solution {
    /// The control heights, mm.
    heights: DVector<f64>,
    /// Of each reach and amplitude.
    alternatives: Vec<Alternative>,
    /// What turns weighted points into heights.
    inverse: DMatrix<f64>,
    /// The effective degrees of freedom, the trace of what turns the points into the sheet's.
    freedom: f64,
}

impl Problem {
    fn new(points: &[WeightedPoint<World>], sheet: &Sheet) -> Self {
        let placed: Vec<_> = points.iter().map(|p| sheet.base.place(p.point)).collect();
        let motions = motions(&sheet.base, &sheet.grid);
        Self {
            rows: placed
                .iter()
                .map(|(place, _)| sheet.grid.support(*place).terms)
                .collect(),
            heights: placed.iter().map(|(_, height)| *height).collect(),
            free: motions.ncols(),
            bases: bases(&sheet.grid, &motions),
        }
    }

    fn normal(&self, weights: &[f64]) -> Normal<'_> {
        let n = self.bases[0].nrows();
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

/// Motions and forms for reaches from that of the whole patch down to a cell's.
fn bases(grid: &Grid, motions: &DMatrix<f64>) -> Vec<DMatrix<f64>> {
    const FINER: f64 = 1.5;
    let cells = |points: usize, step: f64| (points - 3) as f64 * step;
    let across = cells(grid.columns, grid.step.x);
    let extent = Vector2::new(across, cells(grid.rows, grid.step.y)).norm();
    let reaches = std::iter::successors(Some(extent), |reach| Some(reach / FINER));
    let with_forms = |reach: f64| {
        let forms = forms(grid, reach);
        let columns = motions.column_iter().chain(forms.column_iter());
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    };
    reaches
        .take_while(|reach| *reach > grid.step.min())
        .map(with_forms)
        .collect()
}

/// The root of the correlations exp(-d^2 / 2 reach^2) of the control heights. They are products of one along
/// each coordinate, and so is their root; what is next to nothing of it is left out.
fn forms(grid: &Grid, reach: f64) -> DMatrix<f64> {
    const LEAST: f64 = 1e-9;
    let along = |points: usize, step: f64| {
        let correlation = DMatrix::from_fn(points, points, |i, j| {
            let apart = (i as f64 - j as f64) * step / reach;
            libm::exp(-0.5 * apart * apart)
        });
        SymmetricEigen::new(correlation)
    };
    let (across, down) = (
        along(grid.columns, grid.step.x),
        along(grid.rows, grid.step.y),
    );
    let mut columns = Vec::new();
    for (i, a) in across.eigenvalues.iter().enumerate() {
        for (j, b) in down.eigenvalues.iter().enumerate() {
            if a * b > LEAST {
                let (across, down) = (across.eigenvectors.column(i), down.eigenvectors.column(j));
                columns.push(down.kronecker(&across) * (a * b).sqrt());
            }
        }
    }
    DMatrix::from_columns(&columns)
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

/// Walls whose free form is less are none, and more is no wall: one over the amplitude's square, mm^-2.
const STIFFEST: f64 = 1e3;
const STIFFNESSES: usize = 13;

impl Normal<'_> {
    fn reduced(&self, reach: usize) -> Reduced<'_> {
        let basis = &self.problem.bases[reach];
        Reduced {
            information: basis.tr_mul(&(&self.information * basis)),
            right: basis.tr_mul(&self.right),
            normal: self,
        }
    }

    /// The reaches and stiffnesses that count. Beforehand all do alike.
    fn likely(&self) -> Vec<Likely> {
        const LEAST: f64 = 0.01;
        let score = |reach: usize| {
            let reduced = self.reduced(reach);
            let stiffnesses = (0..STIFFNESSES).map(|i| STIFFEST * libm::exp10(-0.5 * i as f64));
            let scored = stiffnesses.map(|stiffness| (stiffness, reduced.unlikeliness(stiffness)));
            scored
                .filter_map(|(stiffness, score)| Some((stiffness, score?)))
                .collect()
        };
        let scored: Vec<Vec<(f64, f64)>> = (0..self.problem.bases.len()).map(score).collect();
        let least = scored
            .iter()
            .flatten()
            .map(|(_, score)| *score)
            .fold(f64::INFINITY, f64::min);
        let weigh = |(stiffness, score): (f64, f64)| (stiffness, libm::exp(0.5 * (least - score)));
        let likely = scored
            .into_iter()
            .enumerate()
            .map(|(reach, scored)| Likely {
                reach,
                stiffnesses: scored
                    .into_iter()
                    .map(weigh)
                    .filter(|(_, weight)| *weight > LEAST)
                    .collect(),
            });
        let mut likely: Vec<Likely> = likely.filter(|one| !one.stiffnesses.is_empty()).collect();
        let sum: f64 = likely
            .iter()
            .flat_map(|one| &one.stiffnesses)
            .map(|(_, weight)| weight)
            .sum();
        for (_, weight) in likely.iter_mut().flat_map(|one| &mut one.stiffnesses) {
            *weight /= sum;
        }
        likely
    }

    /// The mean of what is likely.
    fn heights(&self, likely: &[Likely]) -> Option<DVector<f64>> {
        let mut heights = DVector::zeros(self.right.len());
        for one in likely {
            let reduced = self.reduced(one.reach);
            for (stiffness, weight) in &one.stiffnesses {
                let factor = reduced.penalised(*stiffness).cholesky()?;
                heights += &self.problem.bases[one.reach] * factor.solve(&reduced.right) * *weight;
            }
        }
        Some(heights)
    }

    fn solution(&self, likely: &[Likely]) -> Option<Solution> {
        let heights = self.heights(likely)?;
        let size = heights.len();
        let mut solution = Solution {
            alternatives: Vec::new(),
            inverse: DMatrix::zeros(size, size),
            freedom: 0.0,
            heights,
        };
        for one in likely {
            let basis = &self.problem.bases[one.reach];
            let reduced = self.reduced(one.reach);
            for (stiffness, weight) in &one.stiffnesses {
                let factor = reduced.penalised(*stiffness).cholesky()?;
                let inverse = factor.inverse();
                let root = basis * inverse.clone().cholesky()?.unpack();
                solution.inverse += &root * root.transpose() * *weight;
                solution.freedom += inverse.component_mul(&reduced.information).sum() * weight;
                solution.alternatives.push(Alternative {
                    weight: *weight,
                    step: basis * factor.solve(&reduced.right) - &solution.heights,
                    root,
                });
            }
        }
        Some(solution)
    }
}

impl Reduced<'_> {
    fn penalised(&self, stiffness: f64) -> DMatrix<f64> {
        let mut penalised = self.information.clone();
        for form in self.normal.problem.free..penalised.nrows() {
            penalised[(form, form)] += stiffness;
        }
        penalised
    }

    /// The restricted likelihood, the noise's variance v times the weights' unknown but never below 1:
    ///
    /// ```text
    /// -2 l = (N - m) ln v + (h^T W h - b^T a) / v + ln |A + k D| - n ln k
    /// ```
    ///
    /// with (A + k D) a = b the penalised normal equations, k the stiffness, D one for each of the n forms and
    /// zero for the m motions. `None` where the points leave a motion open.
    fn unlikeliness(&self, stiffness: f64) -> Option<f64> {
        let factor = self.penalised(stiffness).cholesky()?;
        let explained = self.right.dot(&factor.solve(&self.right));
        let left = (self.normal.squares - explained).max(0.0);
        let free = self.normal.problem.free;
        let diagonal = factor.l_dirty().diagonal();
        let volume: f64 = diagonal.iter().map(|d| 2.0 * libm::log(*d)).sum();
        let spare = (self.normal.count - free as f64).max(1.0);
        let variance = (left / spare).max(1.0);
        let misfit = spare * libm::log(variance) + left / variance;
        Some(misfit + volume - (self.right.len() - free) as f64 * libm::log(stiffness))
    }
}

fn summarise(
    points: &[WeightedPoint<World>],
    surface: Surface,
    weights: Vec<f64>,
    mut solution: Solution,
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
    for alternative in &mut solution.alternatives {
        alternative.root *= inflation.sqrt();
    }
    SurfaceFit {
        rms: supported_rms(&residuals, &weights),
        scale: robust_scale(residuals.as_slice()),
        covariance: covariance(&solution.alternatives),
        alternatives: solution.alternatives,
        jacobian,
        inverse_information: solution.inverse,
        effective_freedom: solution.freedom,
        surface,
        weights,
        residuals,
    }
}

/// The control heights of what a base does to first order when it moves, its radius or its axis changes,
/// with s and t the coordinates: shifts and tilts; s^2 + t^2 for a sphere; s^2 and s t for a cylinder.
fn motions(base: &Base, grid: &Grid) -> DMatrix<f64> {
    type Height = fn(f64, f64) -> f64;
    let rigid: [Height; 3] = [|_, _| 1.0, |s, _| s, |_, t| t];
    let round: &[Height] = match base.shape {
        BaseShape::Plane => &[],
        BaseShape::Cylinder { .. } => &[|s, _| s * s, |s, t| s * t],
        BaseShape::Sphere { .. } => &[|s, t| s * s + t * t],
    };
    // From the middle and in cells, so that all columns are of one size.
    let middle = |points: usize| (points as f64 - 1.0) / 2.0;
    let size = grid.step.max();
    let control = |height: &Height| {
        let places = (0..grid.len()).map(|index| {
            let (column, row) = (index % grid.columns, index / grid.columns);
            let s = (column as f64 - middle(grid.columns)) * grid.step.x / size;
            let t = (row as f64 - middle(grid.rows)) * grid.step.y / size;
            height(s, t)
        });
        DVector::from_iterator(grid.len(), places)
    };
    let columns: Vec<_> = rigid.iter().chain(round).map(control).collect();
    DMatrix::from_columns(&columns)
}
