//! Eq. (3): the index at which the rays of all views come closest to meeting.
//!
//! The laser is first brought to where the vessel's spots, which must lie on the epipolar line in air, say
//! that it is: neither the index nor the object enters there. Then each view's gap over its standard
//! deviation is summed, robustly, and the index of the least sum taken. What calibration may still be off
//! by is carried to the index as a part of its standard deviation.

use nalgebra::{DMatrix, DVector};

use super::model::{Kind, Model, Source, State, Unknown};
use super::solve::{Disagreement, Moved, Solution};

/// The minimum of the curve, linearised: n = n0 - gains . residuals.
pub(super) struct RayDistance {
    /// The view and the whitened gap of each sight that counts.
    gaps: Vec<(usize, f64)>,
    /// How each gap changes with the index, in standard deviations.
    slopes: DVector<f64>,
    weights: DVector<f64>,
    /// Covariance of the gaps: noise, and what calibration and wall may be off by.
    covariance: DMatrix<f64>,
}

impl RayDistance {
    /// Linearises at the state of the least sum; `vessel` is the solution of the vessel's spots alone.
    pub(super) fn new(model: &Model, state: &State, vessel: &Solution) -> Option<Self> {
        let mut unknowns = vec![Moved::new(Unknown::Index, f64::INFINITY)];
        unknowns.extend(vessel.unknowns.iter().copied());
        let (rows, _) = model.linearise(state, &unknowns)?;
        let rows: Vec<_> = rows
            .into_iter()
            .filter(|row| row.whitened.kinds[0] == Some(Kind::Gap))
            .collect();
        let gaps: Vec<(usize, f64)> = rows
            .iter()
            .filter_map(|row| match row.whitened.source {
                Source::Object { .. } => Some((model.view(row.whitened.source)?, row.residual.x)),
                _ => None,
            })
            .collect();
        let count = gaps.len();
        let slope = |column: usize| rows.iter().map(move |row| row.jacobian[(0, column)]);
        let common = DMatrix::from_iterator(
            count,
            unknowns.len() - 1,
            (1..unknowns.len()).flat_map(slope),
        );
        let scale = rows.iter().map(|row| row.weight.x).fold(0.0, f64::max);
        // The greatest weight is that of a residual near zero: one over the square of the scale.
        let noise = DMatrix::identity(count, count) / f64::max(scale, 1e-12);
        Some(Self {
            slopes: DVector::from_iterator(count, slope(0)),
            weights: DVector::from_iterator(count, rows.iter().map(|row| row.weight.x)),
            covariance: noise + &common * &vessel.covariance * common.transpose(),
            gaps,
        })
    }

    /// How each gap moves the index, where only some views count.
    fn gains(&self, counts: impl Fn(usize) -> bool) -> Option<DVector<f64>> {
        let weight = |i: usize| {
            let counts = counts(self.gaps[i].0);
            self.weights[i] * self.slopes[i] * f64::from(u8::from(counts))
        };
        let gains = DVector::from_fn(self.gaps.len(), |i, _| weight(i));
        let information = gains.dot(&self.slopes);
        (information > 0.0).then(|| gains / information)
    }

    fn variance(&self, gains: &DVector<f64>) -> f64 {
        gains.dot(&(&self.covariance * gains))
    }

    /// One standard deviation of the index.
    pub(super) fn sigma(&self) -> f64 {
        let gains = self.gains(|_| true);
        gains.map_or(f64::INFINITY, |gains| self.variance(&gains).sqrt())
    }

    /// As [`Solution::disagreement`].
    pub(super) fn disagreement(&self, groups: &[usize]) -> Option<Disagreement> {
        let all = self.gains(|_| true)?;
        let last = groups.iter().max()?;
        let ratios: Vec<f64> = (0..=*last)
            .filter_map(|group| {
                let change = self.gains(|view| groups[view] != group)? - &all;
                let shifts = change.iter().zip(&self.gaps);
                let shift: f64 = shifts.map(|(gain, (_, gap))| gain * gap).sum();
                let expected = self.variance(&change);
                (expected > 1e-6 * self.variance(&all)).then(|| shift * shift / expected)
            })
            .collect();
        Disagreement::of(&ratios)
    }
}
