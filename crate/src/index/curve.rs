//! Curves over the index, from light that is traced once.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::last_bend::{BendPair, LastBend};
use super::solve::{GREATEST_INDEX, LEAST_INDEX};
use crate::camera::Pixel;
use crate::geometry::{Camera, Point, Pose, Ray, World};
use crate::object::{Setup, line_of_sight, meet};
use crate::optics::Media;
use crate::rig::{Laser, Rig};
use crate::robust::tukey_loss;
use crate::scan::{InsideMedium, Station};
use crate::vessel::Wall;

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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    sights: Vec<Option<PreparedSight>>,
    wall_index: f64,
}

#[derive(Clone, Debug)]
enum PreparedSight {
    /// A beam's.
    Beam(Box<BendPair>),
    /// A sheet's: which of its rays meets the line of sight depends on the index, so the place is
    /// interpolated.
    Sheet(Box<PlaceCurve>),
}

/// A place as a polynomial of the index, through places at Chebyshev's nodes.
#[derive(Clone, Debug)]
struct PlaceCurve([Point<World>; NODES]);

const NODES: usize = 9;

/// Chebyshev's nodes (of the second kind) between the least and the greatest index of a liquid.
fn node(i: usize) -> f64 {
    let part = libm::cos(std::f64::consts::PI * i as f64 / (NODES - 1) as f64);
    0.5 * (LEAST_INDEX + GREATEST_INDEX) + 0.5 * (GREATEST_INDEX - LEAST_INDEX) * part
}

impl PlaceCurve {
    /// Barycentric interpolation (J.-P. Berrut and L. N. Trefethen, SIAM Review 46, 2004).
    fn at(&self, index: f64) -> Point<World> {
        let (mut above, mut below) = (Vector3::zeros(), 0.0);
        for (i, place) in self.0.iter().enumerate() {
            let off = index - node(i);
            if off == 0.0 {
                return *place;
            }
            let end = if i == 0 || i == NODES - 1 { 0.5 } else { 1.0 };
            let weight = if i % 2 == 0 { end } else { -end } / off;
            above += place.coords * weight;
            below += weight;
        }
        Point::from_coords(above / below)
    }
}

impl PreparedSight {
    fn gap(&self, ratio: f64) -> f64 {
        match self {
            Self::Beam(pair) => pair.gap(ratio),
            Self::Sheet(_) => 0.0,
        }
    }
}

impl PreparedSights {
    /// Traces the light of spots, each given by its view and pixel. The liquid's index in `setup.media`
    /// does not matter.
    pub fn new(setup: &Setup, sights: &[(usize, Pixel)]) -> Self {
        let wall = &setup.vessel.wall;
        Self::behind(setup.rig, wall, &setup.media, setup.stations, sights)
    }

    /// As [`PreparedSights::new`], for a range finder and a wall other than the setup's.
    pub(super) fn behind(
        rig: &Rig,
        wall: &Wall,
        media: &Media,
        stations: &[Station],
        sights: &[(usize, Pixel)],
    ) -> Self {
        let poses: Vec<_> = stations
            .iter()
            .map(|station| rig.station(&station.world_from_flange))
            .collect();
        let prepare = |(view, pixel): &(usize, Pixel)| match &rig.laser {
            Laser::Beam(beam) => beam_sight(rig, wall, media, beam, &poses[*view], *pixel),
            Laser::Sheet(_) => sheet_sight(rig, wall, media, &poses[*view], *pixel),
        };
        Self {
            sights: sights.iter().map(prepare).collect(),
            wall_index: media.wall,
        }
    }

    /// How many sights there are.
    pub fn len(&self) -> usize {
        self.sights.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sights.is_empty()
    }

    /// Each sight's object point if the index is `index`; `None` where its light does not get through.
    pub fn points(&self, index: f64) -> impl Iterator<Item = Option<Point<World>>> + '_ {
        let ratio = self.wall_index / index;
        self.sights.iter().map(move |sight| match sight.as_ref()? {
            PreparedSight::Beam(pair) => Some(pair.approach(ratio)?.midpoint()),
            PreparedSight::Sheet(curve) => Some(curve.at(index)),
        })
    }

    /// The signed ray distance of each sight; not a number where a ray does not get through.
    pub fn gaps(&self, index: f64) -> impl Iterator<Item = f64> + '_ {
        let ratio = self.wall_index / index;
        self.sights
            .iter()
            .map(move |sight| sight.as_ref().map_or(f64::NAN, |sight| sight.gap(ratio)))
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
        for (number, sight) in self.sights.iter().enumerate() {
            let Some(sight) = sight else { continue };
            for (one, ratio) in losses.iter_mut().zip(&ratios) {
                *one = loss(number, sight.gap(*ratio));
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

fn beam_sight(
    rig: &Rig,
    wall: &Wall,
    media: &Media,
    beam: &Ray<Camera>,
    pose: &Pose<World, Camera>,
    pixel: Pixel,
) -> Option<PreparedSight> {
    let stack = wall.stack(media, InsideMedium::Liquid).ok()?;
    let far = wall.far.map(|far| far.distance);
    let light = LastBend::new(&stack, far, &pose.ray(beam))?;
    let line = line_of_sight(rig, pose, pixel).ok()?;
    let line = LastBend::new(&stack, far, &line)?;
    Some(PreparedSight::Beam(Box::new(BendPair::new(light, line)?)))
}

fn sheet_sight(
    rig: &Rig,
    wall: &Wall,
    media: &Media,
    pose: &Pose<World, Camera>,
    pixel: Pixel,
) -> Option<PreparedSight> {
    let mut places = [Point::origin(); NODES];
    for (i, place) in places.iter_mut().enumerate() {
        let media = Media {
            liquid: node(i),
            ..*media
        };
        let stack = wall.stack(&media, InsideMedium::Liquid).ok()?;
        *place = meet(rig, pose, &stack, pixel).ok()?.point();
    }
    Some(PreparedSight::Sheet(Box::new(PlaceCurve(places))))
}
