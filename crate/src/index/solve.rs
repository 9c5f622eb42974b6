//! Robust least squares over all unknowns at once, with the full covariance.

use nalgebra::{DMatrix, DVector, Matrix2xX, Vector2};

use super::model::{Hypothesis, Kind, Model, State, Unknown, Whitened};
use crate::rig::Calibration;
use crate::robust::{biweight, robust_scale};

/// An unknown of the estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moved {
    pub(super) unknown: Unknown,
    /// What it moved by from where it started.
    pub(super) by: f64,
    /// Its standard deviation beforehand; infinite where nothing was known of it.
    pub(super) prior: f64,
}

impl Moved {
    pub(super) const fn new(unknown: Unknown, prior: f64) -> Self {
        Self {
            unknown,
            by: 0.0,
            prior,
        }
    }
}

/// Which of the unknowns move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    All,
    AllButIndex,
    IndexAndFaces,
}

impl Which {
    fn moves(self, unknown: Unknown) -> bool {
        match self {
            Self::All => true,
            Self::AllButIndex => unknown != Unknown::Index,
            Self::IndexAndFaces => matches!(unknown, Unknown::Index | Unknown::Face { .. }),
        }
    }
}

/// What the unknowns came to.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub(super) state: State,
    pub(super) unknowns: Vec<Moved>,
    /// In the order of the unknowns.
    pub(super) covariance: DMatrix<f64>,
    pub(super) rows: Vec<Row>,
    normal: Normal,
}

/// The residuals of one source and how they change with the unknowns.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) whitened: Whitened,
    pub(super) residual: Vector2<f64>,
    /// Robust weight over the square of its kind's scale, of each residual.
    pub(super) weight: Vector2<f64>,
    pub(super) jacobian: Matrix2xX<f64>,
}

impl Row {
    /// Takes each residual at the standard deviation that noise explains.
    pub(super) fn count_fully(&mut self) {
        let counts = |kind: Option<Kind>| if kind.is_some() { 1.0 } else { 0.0 };
        self.weight = self.whitened.kinds.map(counts).into();
    }
}

const STEPS: usize = 40;

impl Model<'_> {
    /// Moves the unknowns to where priors and residuals agree best, from a state near there: Gauss-Newton
    /// steps with Tukey's biweight at each kind's own scale, which is never taken below what noise
    /// explains. `None` where the light gets through in no view.
    pub(super) fn solve(&self, start: State, which: Which) -> Option<Solution> {
        let mut state = start;
        let free = self.unknowns(&state).into_iter();
        let mut unknowns: Vec<Moved> = free
            .filter(|(unknown, _)| which.moves(*unknown))
            .map(|(unknown, prior)| Moved::new(unknown, prior))
            .collect();
        for _ in 0..STEPS {
            let (_, normal) = self.linearise(&state, &unknowns)?;
            let step = within_trust(&normal.solve(&normal.right)?, &unknowns);
            for (moved, by) in unknowns.iter_mut().zip(&step) {
                state = self.moved(&state, moved.unknown, *by);
                moved.by += by;
            }
            state.index = state.index.clamp(LEAST_INDEX, GREATEST_INDEX);
            if normal.length(&step) < 1e-4 {
                break;
            }
        }
        let (rows, normal) = self.linearise(&state, &unknowns)?;
        Some(Solution {
            covariance: normal.inverse()?,
            state,
            unknowns,
            rows,
            normal,
        })
    }

    /// The least standard deviation of the index that any unbiased estimator can reach at a state, with
    /// the centroids' noise and the priors as they are: the Cramer-Rao bound.
    pub(super) fn floor(&self, state: &State) -> Option<f64> {
        let free = self.unknowns(state).into_iter();
        let unknowns: Vec<Moved> = free.map(|(u, prior)| Moved::new(u, prior)).collect();
        let (mut rows, _) = self.linearise(state, &unknowns)?;
        for row in &mut rows {
            row.count_fully();
        }
        let covariance = Normal::new(&rows, &unknowns).inverse()?;
        let index = unknowns.iter().position(|m| m.unknown == Unknown::Index)?;
        Some(covariance[(index, index)].sqrt())
    }

    /// Residuals, weights and normal equations at a state.
    pub(super) fn linearise(
        &self,
        state: &State,
        unknowns: &[Moved],
    ) -> Option<(Vec<Row>, Normal)> {
        let here = Hypothesis::new(self, state.clone())?;
        let sources = self.sources(state).into_iter();
        let mut rows: Vec<Row> = sources
            .filter_map(|source| self.whiten(&here, source))
            .filter_map(|whitened| {
                Some(Row {
                    residual: self.residual(&here, &whitened)?,
                    whitened,
                    weight: Vector2::zeros(),
                    jacobian: Matrix2xX::zeros(unknowns.len()),
                })
            })
            .collect();
        if rows.is_empty() {
            return None;
        }
        for (column, moved) in unknowns.iter().enumerate() {
            let h = derivative_step(moved.unknown);
            let ahead = Hypothesis::new(self, self.moved(state, moved.unknown, h))?;
            let back = Hypothesis::new(self, self.moved(state, moved.unknown, -h))?;
            for row in &mut rows {
                let ends = self
                    .residual(&ahead, &row.whitened)
                    .zip(self.residual(&back, &row.whitened));
                let slope =
                    ends.map_or_else(Vector2::zeros, |(ahead, back)| (ahead - back) / (2.0 * h));
                row.jacobian.set_column(column, &slope);
            }
        }
        weigh(&mut rows);
        let normal = Normal::new(&rows, unknowns);
        Some((rows, normal))
    }
}

/// No liquid lies beyond these.
pub(super) const LEAST_INDEX: f64 = 1.0;
pub(super) const GREATEST_INDEX: f64 = 2.5;

/// Far above rounding, far below where light paths bend noticeably.
const fn derivative_step(unknown: Unknown) -> f64 {
    match unknown {
        Unknown::Index | Unknown::Glow => 1e-5,
        Unknown::Wall(_) | Unknown::Face { .. } => 1e-5,
        Unknown::Calibration(Calibration::LaserDirection(_) | Calibration::HandEyeRotation(_)) => {
            1e-6
        }
        Unknown::Calibration(_) => 1e-4,
    }
}

/// Shortens a step that goes farther than the linearisation can be trusted.
fn within_trust(step: &DVector<f64>, unknowns: &[Moved]) -> DVector<f64> {
    let trusted = |moved: &Moved| match moved.unknown {
        Unknown::Index => 0.1,
        Unknown::Calibration(_) | Unknown::Glow => 3.0 * moved.prior,
        Unknown::Wall(_) | Unknown::Face { .. } => 20.0,
    };
    let excess = unknowns
        .iter()
        .zip(step)
        .map(|(moved, by)| by.abs() / trusted(moved))
        .fold(1.0, f64::max);
    step / excess
}

/// Gives each residual its weight: Tukey's biweight, at its kind's scale.
fn weigh(rows: &mut [Row]) {
    let scales = Kind::ALL.map(|kind| scale_of(kind, rows));
    for row in rows {
        let scale = |kind: Kind| scales[Kind::ALL.iter().position(|k| *k == kind).unwrap_or(0)];
        let (mut sum, mut count) = (0.0, 0.0);
        for (kind, z) in row.whitened.kinds.iter().zip(&row.residual) {
            if let Some(kind) = kind {
                sum += (z / scale(*kind)) * (z / scale(*kind));
                count += 1.0;
            }
        }
        let known = row.whitened.kinds[0] == Some(Kind::Known);
        let keep = if known {
            1.0
        } else {
            biweight((sum / f64::max(count, 1.0)).sqrt())
        };
        for (kind, weight) in row.whitened.kinds.iter().zip(row.weight.iter_mut()) {
            *weight = kind.map_or(0.0, |kind| keep / (scale(kind) * scale(kind)));
        }
    }
}

fn scale_of(kind: Kind, rows: &[Row]) -> f64 {
    let residuals = rows.iter().flat_map(|row| {
        let pairs = row.whitened.kinds.iter().zip(&row.residual);
        pairs.filter_map(|(k, z)| (*k == Some(kind)).then_some(*z))
    });
    let residuals: Vec<f64> = residuals.collect();
    // What is known is held to its own tolerance, not to how well it fits.
    if residuals.is_empty() || kind == Kind::Known {
        return 1.0;
    }
    robust_scale(&residuals).max(1.0)
}

/// Normal equations H x = g with the priors in them, scaled to a unit diagonal: radians, mm and an index
/// compare.
#[derive(Clone, Debug)]
pub(super) struct Normal {
    pub(super) information: DMatrix<f64>,
    pub(super) right: DVector<f64>,
}

impl Normal {
    pub(super) fn new<'r>(rows: impl IntoIterator<Item = &'r Row>, unknowns: &[Moved]) -> Self {
        let n = unknowns.len();
        let mut normal = Self {
            information: DMatrix::zeros(n, n),
            right: DVector::zeros(n),
        };
        rows.into_iter().for_each(|row| normal.add(row, 1.0));
        for (i, moved) in unknowns.iter().enumerate() {
            let prior = 1.0 / (moved.prior * moved.prior);
            normal.information[(i, i)] += prior;
            normal.right[i] -= moved.by * prior;
        }
        normal
    }

    fn add(&mut self, row: &Row, sign: f64) {
        for k in 0..2 {
            let weight = sign * row.weight[k];
            if weight == 0.0 {
                continue;
            }
            for i in 0..self.right.len() {
                let scaled = weight * row.jacobian[(k, i)];
                if scaled == 0.0 {
                    continue;
                }
                self.right[i] -= scaled * row.residual[k];
                for j in 0..self.right.len() {
                    self.information[(i, j)] += scaled * row.jacobian[(k, j)];
                }
            }
        }
    }

    /// The same without some of the rows.
    fn without<'r>(&self, rows: impl IntoIterator<Item = &'r Row>) -> Self {
        let mut rest = self.clone();
        rows.into_iter().for_each(|row| rest.add(row, -1.0));
        rest
    }

    pub(super) fn inverse(&self) -> Option<DMatrix<f64>> {
        /// Of the unit diagonal: what no residual and no prior holds stays finite.
        const RIDGE: f64 = 1e-12;
        let n = self.right.len();
        let scale = self
            .information
            .diagonal()
            .map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
        let unit = DMatrix::from_fn(n, n, |i, j| {
            let ridge = if i == j { RIDGE } else { 0.0 };
            self.information[(i, j)] * scale[i] * scale[j] + ridge
        });
        let inverse = unit.cholesky()?.inverse();
        let inverse = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        inverse.iter().all(|x| x.is_finite()).then_some(inverse)
    }

    fn solve(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        Some(self.inverse()? * right)
    }

    /// How long a step is, in standard deviations.
    fn length(&self, step: &DVector<f64>) -> f64 {
        step.dot(&(&self.information * step)).max(0.0).sqrt()
    }
}

impl Solution {
    /// One standard deviation of the index: pictures' noise and calibration, propagated.
    pub(super) fn sigma(&self) -> f64 {
        self.position(Unknown::Index)
            .map_or(0.0, |i| self.covariance[(i, i)].sqrt())
    }

    pub(super) fn position(&self, unknown: Unknown) -> Option<usize> {
        self.unknowns.iter().position(|m| m.unknown == unknown)
    }

    /// By how much groups of views disagree on the index more than their noise explains, as a factor on
    /// its standard deviation: each group is left out in turn, and with d its shift of the index,
    ///
    /// ```text
    /// factor^2 = mean over the groups of d^2 / (sigma_without^2 - sigma^2)
    /// ```
    ///
    /// as the variance of a shift is the difference of the two variances (J. Hausman, 1978). 1 on average
    /// where the model is right. `None` for fewer than two groups.
    pub(super) fn disagreement(
        &self,
        group_of: impl Fn(&Row) -> Option<usize>,
    ) -> Option<Disagreement> {
        let index = self.position(Unknown::Index)?;
        let sigma2 = self.covariance[(index, index)];
        let groups = self
            .rows
            .iter()
            .filter_map(&group_of)
            .max()
            .map_or(0, |last| last + 1);
        let mut ratios = Vec::new();
        for group in 0..groups {
            let rows = self.rows.iter().filter(|r| group_of(r) == Some(group));
            let rest = self.normal.without(rows);
            let Some(covariance) = rest.inverse() else {
                continue;
            };
            let shift = (&covariance * &rest.right)[index];
            let gained = covariance[(index, index)] - sigma2;
            if gained > 1e-6 * sigma2 {
                ratios.push(shift * shift / gained);
            }
        }
        Disagreement::of(&ratios)
    }
}

/// By how much groups of views disagree on the index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disagreement {
    /// The factor on its standard deviation.
    pub(super) factor: f64,
    /// Whether chance would hardly make it as large.
    pub(super) significant: bool,
}

impl Disagreement {
    /// From each group's squared shift over what is expected of it. The mean of G such has a standard
    /// deviation of sqrt(2/G) about 1 where the model is right; twice that is no chance.
    pub(super) fn of(ratios: &[f64]) -> Option<Self> {
        let count = ratios.len() as f64;
        if ratios.len() < 2 {
            return None;
        }
        let mean = ratios.iter().sum::<f64>() / count;
        Some(Self {
            factor: mean.sqrt(),
            significant: mean > 1.0 + 2.0 * (2.0 / count).sqrt(),
        })
    }
}
