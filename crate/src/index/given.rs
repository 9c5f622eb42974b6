//! The index with calibration and wall as the vessel's spots leave them: eqs. (3) and (4).
//!
//! The laser is first brought to where the vessel's spots, which must lie on the epipolar line in air and
//! on the wall, say that it is: neither the index nor the object enters there. Then the index is sought
//! with all that held. What calibration may still be off by is carried to it as a part of its standard
//! deviation: with J the slopes of the residuals by the index and the object's faces, J_c those by
//! calibration and wall, W the weights and C_c the covariance that the vessel's spots leave,
//!
//! ```text
//! C = H^-1 + B C_c B^T,   H = J^T W J,   B = H^-1 J^T W J_c
//! ```

use nalgebra::{DMatrix, DVector};

use super::model::{Model, State, Unknown};
use super::solve::{Disagreement, Moved, Normal, Row, Solution, Which};

/// The index found with calibration held.
pub(super) struct Given {
    pub(super) state: State,
    rows: Vec<Row>,
    /// How many of the rows' columns are index and faces; the rest are calibration's and the wall's.
    own: usize,
    /// Covariance of the latter.
    common: DMatrix<f64>,
    unknowns: Vec<Moved>,
}

/// What is held, and how the index follows it.
struct Response {
    /// Variance of the index by the spots' noise.
    noise: f64,
    /// The index's row of B.
    by_common: DVector<f64>,
    /// The step of the index that is left to make.
    step: f64,
}

impl Given {
    /// Seeks the index from a state near it; `vessel` is the solution of the vessel's spots alone.
    pub(super) fn solve(model: &Model, start: State, vessel: &Solution) -> Option<Self> {
        let solution = model.solve(start, Which::IndexAndFaces)?;
        let own = solution.unknowns.len();
        let mut unknowns = solution.unknowns;
        unknowns.extend(
            vessel
                .unknowns
                .iter()
                .map(|m| Moved::new(m.unknown, m.prior)),
        );
        let (rows, _) = model.linearise(&solution.state, &unknowns)?;
        Some(Self {
            state: solution.state,
            rows,
            own,
            common: vessel.covariance.clone(),
            unknowns,
        })
    }

    /// How the index follows, where only some of the rows count.
    fn response(&self, counts: impl Fn(&Row) -> bool) -> Option<Response> {
        let rows = self.rows.iter().filter(|row| counts(row));
        let normal = Normal::new(rows, &self.without_priors());
        let own = self.own;
        let inverse = Normal {
            information: normal.information.view((0, 0), (own, own)).into_owned(),
            right: normal.right.rows(0, own).into_owned(),
        };
        let step = &inverse.right;
        let covariance = inverse.inverse()?;
        let cross = normal
            .information
            .view((0, own), (own, self.unknowns.len() - own));
        Some(Response {
            noise: covariance[(0, 0)],
            by_common: (covariance.row(0) * cross).transpose(),
            step: (covariance.row(0) * step).x,
        })
    }

    fn without_priors(&self) -> Vec<Moved> {
        let free = |m: &Moved| Moved::new(m.unknown, f64::INFINITY);
        self.unknowns.iter().map(free).collect()
    }

    fn common_variance(&self, by_common: &DVector<f64>) -> f64 {
        by_common.dot(&(&self.common * by_common))
    }

    /// One standard deviation of the index.
    pub(super) fn sigma(&self) -> f64 {
        self.response(|_| true).map_or(f64::INFINITY, |all| {
            (all.noise + self.common_variance(&all.by_common)).sqrt()
        })
    }

    /// As [`Solution::disagreement`].
    pub(super) fn disagreement(
        &self,
        group_of: impl Fn(&Row) -> Option<usize>,
    ) -> Option<Disagreement> {
        let all = self.response(|_| true)?;
        let variance = all.noise + self.common_variance(&all.by_common);
        let last = self.rows.iter().filter_map(&group_of).max()?;
        let ratio = |group: usize| {
            let rest = self.response(|row| group_of(row) != Some(group))?;
            let shift = rest.step - all.step;
            let change = rest.by_common - &all.by_common;
            let expected = (rest.noise - all.noise).max(0.0) + self.common_variance(&change);
            (expected > 1e-6 * variance).then(|| shift * shift / expected)
        };
        let ratios: Vec<f64> = (0..=last).filter_map(ratio).collect();
        Disagreement::of(&ratios)
    }

    /// The held unknown that goes most with the index, and its correlation with it.
    pub(super) fn most_entangled(&self) -> Option<(Unknown, f64)> {
        let together = &self.common * self.response(|_| true)?.by_common;
        let sigma = self.sigma();
        let correlation = |i: usize| -together[i] / (self.common[(i, i)].sqrt() * sigma);
        let held = self.unknowns[self.own..].iter().enumerate();
        held.filter(|(_, m)| matches!(m.unknown, Unknown::Calibration(_) | Unknown::Glow))
            .map(|(i, moved)| (moved.unknown, correlation(i)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}
