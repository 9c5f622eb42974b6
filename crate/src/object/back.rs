//! Light that passed the object and landed on the vessel's back.
//!
//! That is a surface as good as the object's: ray distance, brightness and neighbours all speak for it.
//! What tells it is where it lies. A round vessel's back is where its shape has it. Of a tank only the
//! front is measured; but its back is a flat surface parallel to the front that lies behind everything
//! else, with a clear space between, as the object has a rear half too.

use super::{Meeting, Refusal};
use crate::geometry::{Ray, World};
use crate::optics::Surface;
use crate::robust::{median, sort_by_number};
use crate::vessel::Wall;

/// Points that are measured to lie less far apart than this may lie on the same face, mm.
const SAME_FACE: f64 = 4.0;
/// A round vessel's object keeps as far from its far side, mm.
const CLEAR: f64 = 6.0;
/// With fewer points there is no saying what is the object.
const LEAST_OBJECT: usize = 3;
/// So few points, for each of the back's, may be ghosts that seem to lie in the clear space before it.
const GHOSTS: f64 = 0.1;

/// The lit back of a vessel.
#[derive(Clone, Copy, Debug)]
pub(super) enum Back<'a> {
    /// Of a tank: from this depth behind the inner face on, after a clear space; both mm.
    Flat {
        wall: &'a Wall,
        depth: f64,
        space: f64,
    },
    /// Of a round vessel.
    Round(&'a Wall),
}

impl<'a> Back<'a> {
    /// Looks for it among the likeliest points of the views, which lie on those beams.
    pub(super) fn find(wall: &'a Wall, points: &[(Meeting, Ray<World>)]) -> Option<Self> {
        match &wall.outer {
            Surface::Plane(_) if wall.far.is_none() => {
                let depths = points
                    .iter()
                    .map(|(meeting, _)| behind_front(wall, meeting));
                let (depth, space) = flat_back(depths.collect())?;
                Some(Self::Flat { wall, depth, space })
            }
            Surface::Cylinder(_) | Surface::Sphere(_) => {
                let ways = points.iter();
                let ways = ways.filter_map(|(meeting, beam)| before_back(wall, meeting, beam));
                has_round_back(&ways.collect::<Vec<f64>>()).then_some(Self::Round(wall))
            }
            Surface::Plane(_) | Surface::Freeform(_) => None,
        }
    }

    /// Whether it may be a back, if that many points stand before it. Of a tank's face nothing else tells
    /// that it is no object; where a round vessel's far side lies is known.
    pub(super) const fn is_behind(&self, points: usize) -> bool {
        match self {
            Self::Flat { .. } => points >= LEAST_OBJECT,
            Self::Round(_) => true,
        }
    }

    /// Why a point is none of the object's, if it lies on the back.
    pub(super) fn refuse(&self, meeting: &Meeting, beam: &Ray<World>) -> Option<Refusal> {
        match *self {
            Self::Flat { wall, depth, space } => {
                let behind = behind_front(wall, meeting);
                (behind >= depth).then_some(Refusal::BackWall {
                    depth: behind,
                    space,
                })
            }
            Self::Round(wall) => {
                let way = before_back(wall, meeting, beam)?;
                (way <= SAME_FACE).then_some(Refusal::FarSide)
            }
        }
    }
}

fn behind_front(wall: &Wall, meeting: &Meeting) -> f64 {
    -wall.outer.signed_distance(meeting.point()) - wall.thickness
}

/// How far a point lies before the far side of a round wall's inner face, mm; `None` for those on the near
/// side, where the beam still runs inwards.
fn before_back(wall: &Wall, meeting: &Meeting, beam: &Ray<World>) -> Option<f64> {
    const STEP: f64 = 1e-3;
    let inner = wall.outer.behind(wall.thickness)?;
    let way = inner.signed_distance(meeting.point());
    let farther_on = meeting.point() + beam.direction * STEP;
    (inner.signed_distance(farther_on) > way).then_some(way.abs())
}

/// The tank's back among points at these depths: the depth from which on they lie on it, and the clear space
/// before it, mm.
///
/// Of all faces parallel to the front with a clear space before them it is the one that has the most points.
fn flat_back(mut depths: Vec<f64>) -> Option<(f64, f64)> {
    sort_by_number(&mut depths, |depth| *depth);
    let starts = 0..depths.len();
    let backs = starts.filter_map(|start| back_from(&depths, start));
    let most = backs.max_by_key(|(count, ..)| *count)?;
    Some((most.1, most.2))
}

/// Whether a back begins with that point, how many points it has, its depth, and the space before it.
fn back_from(depths: &[f64], start: usize) -> Option<(usize, f64, f64)> {
    /// A smaller space is a step of the object, mm.
    const LEAST_SPACE: f64 = 25.0;
    /// The object's rear half may be a little shallower than its front.
    const REAR: f64 = 0.8;
    let depth = depths[start];
    let before = |depth: f64| depths.partition_point(|other| *other < depth);
    let count = before(depth + SAME_FACE) - start;
    let behind = depths.len() - start - count;
    let ghosts = (GHOSTS * count as f64) as usize;
    // The ghosts that seem to lie in the clear space are left out.
    let object = (0..=ghosts.min(start)).map(|left_out| &depths[..start - left_out]);
    let space = object.map(|object| {
        let space = depth - object.last()?;
        let clear = space >= LEAST_SPACE.max(REAR * extent(object));
        (clear && object.len() >= LEAST_OBJECT).then_some(space)
    });
    let space = space.flatten().next()?;
    (behind <= ghosts).then_some((count, depth, space))
}

/// How far depths reach, if they are evenly spread but for a few.
fn extent(depths: &[f64]) -> f64 {
    let middle = median(depths.to_vec());
    4.0 * median(depths.iter().map(|depth| (depth - middle).abs()).collect())
}

/// Whether points at these distances before the far side show that it is lit: some lie on it, and the others
/// keep clear of it.
fn has_round_back(before: &[f64]) -> bool {
    let within = |way: f64| before.iter().filter(|other| **other <= way).count();
    let on_back = within(SAME_FACE);
    let near = within(SAME_FACE + CLEAR) - on_back;
    on_back > 0 && near as f64 <= GHOSTS * on_back as f64
}
