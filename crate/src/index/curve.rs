//! Curves over the index, from light that is traced once.

use serde::{Deserialize, Serialize};

use super::last_bend::{BendPair, LastBend};
use super::model::{Hypothesis, Model};
use super::sights::ObjectSight;
use crate::geometry::{Approach, World};
use crate::object::line_of_sight;
use crate::robust::tukey_loss;

/// A quantity over the refractive index.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IndexCurve {
    /// The indices.
    pub index: Vec<f64>,
    /// The quantity at each; `null` where it cannot be had.
    pub value: Vec<Option<f64>>,
}

impl IndexCurve {
    /// The index of the least value, by a parabola through the three lowest neighbours.
    pub fn minimum(&self) -> Option<CurveMinimum> {
        let values = self.value.iter().enumerate();
        let known = values.filter_map(|(i, v)| Some((i, (*v)?)));
        let (at, least) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let neighbours = |i: usize| *self.value.get(i)?;
        let sides = at
            .checked_sub(1)
            .and_then(neighbours)
            .zip(neighbours(at + 1));
        let Some((before, after)) = sides else {
            return Some(CurveMinimum {
                index: self.index[at],
                value: least,
                at_bound: true,
            });
        };
        let bend = before - 2.0 * least + after;
        let step = self.index[at + 1] - self.index[at];
        let off = if bend > 0.0 {
            0.5 * (before - after) / bend
        } else {
            0.0
        };
        Some(CurveMinimum {
            index: self.index[at] + off * step,
            value: least,
            at_bound: false,
        })
    }
}

/// Where a curve is lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveMinimum {
    /// The index.
    pub index: f64,
    /// The value there.
    pub value: f64,
    /// Whether that is an end of the curve, so that the true minimum may lie beyond.
    pub at_bound: bool,
}

/// Evenly spaced indices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct IndexRange {
    /// The least.
    pub from: f64,
    /// The greatest.
    pub to: f64,
    /// How many.
    pub count: usize,
}

impl Default for IndexRange {
    fn default() -> Self {
        Self {
            from: 1.0,
            to: 1.8,
            count: 201,
        }
    }
}

impl IndexRange {
    /// The indices.
    pub fn values(&self) -> Vec<f64> {
        let last = self.count.saturating_sub(1).max(1) as f64;
        (0..self.count)
            .map(|i| self.from + (self.to - self.from) * (i as f64 / last))
            .collect()
    }
}

/// The light of the object's sights, traced as far as it does not depend on the liquid's index. Another
/// index costs the last refraction alone.
#[derive(Clone, Debug)]
pub struct PreparedSights {
    pairs: Vec<Option<BendPair>>,
    wall_index: f64,
}

impl PreparedSights {
    pub(super) fn new(model: &Model, here: &Hypothesis, sights: &[ObjectSight]) -> Self {
        let far = here.state.wall.far.map(|far| far.distance);
        let rig = &here.state.rig;
        let pair = |sight: &ObjectSight| {
            let station = &model.setup.stations[sight.view];
            let pose = rig.station(&station.world_from_flange);
            let beam = LastBend::new(&here.stack, far, &pose.ray(&rig.laser.axis()))?;
            let line = line_of_sight(rig, &pose, sight.pixel).ok()?;
            BendPair::new(beam, LastBend::new(&here.stack, far, &line)?)
        };
        Self {
            pairs: sights.iter().map(pair).collect(),
            wall_index: model.setup.media.wall,
        }
    }

    /// How many sights there are.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Where each sight's two rays come closest if the index is `index`; `None` where one of them does not
    /// get through.
    pub fn approaches(&self, index: f64) -> impl Iterator<Item = Option<Approach<World>>> + '_ {
        let ratio = self.wall_index / index;
        self.pairs
            .iter()
            .map(move |pair| pair.as_ref()?.approach(ratio))
    }

    /// The signed ray distance of each sight; not a number where a ray does not get through.
    pub fn gaps(&self, index: f64) -> impl Iterator<Item = f64> + '_ {
        let ratio = self.wall_index / index;
        self.pairs
            .iter()
            .map(move |pair| pair.as_ref().map_or(f64::NAN, |pair| pair.gap(ratio)))
    }

    /// Eq. (3) as printed: the mean ray distance, mm.
    pub fn plain_curve(&self, range: &IndexRange) -> IndexCurve {
        self.curve(range, |_, gap| gap.abs())
    }

    /// The mean over the sights of Tukey's loss of gap over standard deviation.
    pub fn robust_curve(&self, range: &IndexRange, sigmas: &[f64]) -> IndexCurve {
        self.curve(range, |sight, gap| tukey_loss(gap / sigmas[sight]))
    }

    /// The mean of a loss over the sights, for each index. A sight that some index throws back counts for
    /// none of them, so that the sums compare.
    fn curve(&self, range: &IndexRange, loss: impl Fn(usize, f64) -> f64) -> IndexCurve {
        let index = range.values();
        let ratios: Vec<f64> = index.iter().map(|n| self.wall_index / n).collect();
        let mut sums = vec![0.0; ratios.len()];
        let mut count = 0.0;
        let mut losses = vec![0.0; ratios.len()];
        for (sight, pair) in self.pairs.iter().enumerate() {
            let Some(pair) = pair else { continue };
            for (one, ratio) in losses.iter_mut().zip(&ratios) {
                *one = loss(sight, pair.gap(*ratio));
            }
            if losses.iter().all(|one| one.is_finite()) {
                sums.iter_mut()
                    .zip(&losses)
                    .for_each(|(sum, one)| *sum += one);
                count += 1.0;
            }
        }
        let mean = |sum: f64| (count > 0.0).then(|| sum / count);
        IndexCurve {
            index,
            value: sums.into_iter().map(mean).collect(),
        }
    }
}
