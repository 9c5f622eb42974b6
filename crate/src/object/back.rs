//! Light that passed the object and landed on the vessel's back.
//!
//! That is a surface as good as the object's: ray distance, brightness and neighbours all speak for it.
//! What tells it is where it lies. A round vessel's back is where its shape has it. Of a tank only the
//! front is measured; but its back is a flat surface parallel to the front that lies behind everything
//! else, with a clear space between, as the object has a rear half too.

use super::{Choice, ObjectPoint, Refusal, Setup};
use crate::optics::Surface;
use crate::vessel::Wall;

/// Points that are measured to lie less far apart than this may lie on the same face, mm.
const SAME_FACE: f64 = 3.0;
/// With fewer points there is no saying what is the object.
const LEAST_OBJECT: usize = 3;

/// Takes back the points that lie on the vessel's back.
pub(super) fn refuse(setup: &Setup, choices: &mut [Choice]) {
    let wall = &setup.vessel.wall;
    let points = || choices.iter().flat_map(|choice| &choice.points);
    let back = match &wall.outer {
        Surface::Plane(_) if wall.far.is_none() => {
            flat_back(points().map(|point| behind_front(wall, point)).collect())
        }
        Surface::Cylinder(_) | Surface::Sphere(_) => round_back(
            points()
                .filter_map(|point| before_back(wall, point))
                .collect(),
        ),
        Surface::Plane(_) | Surface::Freeform(_) => None,
    };
    let Some(back) = back else {
        return;
    };
    for choice in choices {
        let (on_back, on_object) = choice.points.drain(..).partition(|point| match back {
            Back::Flat { depth, .. } => behind_front(wall, point) >= depth,
            Back::Round => before_back(wall, point).is_some_and(|way| way <= SAME_FACE),
        });
        choice.points = on_object;
        let on_back: Vec<ObjectPoint> = on_back;
        choice.refused.extend(on_back.iter().map(|point| {
            let refusal = match back {
                Back::Flat { space, .. } => Refusal::BackWall {
                    depth: behind_front(wall, point),
                    space,
                },
                Back::Round => Refusal::FarSide,
            };
            (point.spot, refusal)
        }));
    }
}

#[derive(Clone, Copy)]
enum Back {
    /// From this depth behind the inner face on, after an empty space; both mm.
    Flat {
        depth: f64,
        space: f64,
    },
    Round,
}

fn behind_front(wall: &Wall, point: &ObjectPoint) -> f64 {
    -wall.outer.signed_distance(point.meeting.point()) - wall.thickness
}

/// How far a point lies before the far side of a round wall's inner face, mm; `None` for those of the
/// front half.
fn before_back(wall: &Wall, point: &ObjectPoint) -> Option<f64> {
    let inner = wall.outer.behind(wall.thickness)?;
    let radius = match &inner {
        Surface::Cylinder(cylinder) => cylinder.radius,
        Surface::Sphere(sphere) => sphere.radius,
        Surface::Plane(_) | Surface::Freeform(_) => return None,
    };
    let way = inner.signed_distance(point.meeting.point()).abs();
    (point.meeting.depth() > radius).then_some(way)
}

/// The tank's back among points at these depths, if there is one.
fn flat_back(mut depths: Vec<f64>) -> Option<Back> {
    /// A smaller space is a step of the object, mm.
    const LEAST_SPACE: f64 = 25.0;
    /// The object's rear half may be a little shallower than its front.
    const REAR: f64 = 0.8;
    depths.sort_by(f64::total_cmp);
    let spaces = depths.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
    let (last, space) = spaces.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (object, back) = depths.split_at(last + 1);
    let extent = |depths: &[f64]| depths[depths.len() - 1] - depths[0];
    let is_back = object.len() >= LEAST_OBJECT
        && extent(back) <= SAME_FACE
        && space >= LEAST_SPACE.max(REAR * extent(object));
    is_back.then_some(Back::Flat {
        depth: back[0],
        space,
    })
}

/// The back of a round vessel among points at these distances before it, if any lie on it and the others
/// keep clear of it.
fn round_back(mut before: Vec<f64>) -> Option<Back> {
    const CLEAR: f64 = 10.0;
    before.sort_by(f64::total_cmp);
    let on_back = before.iter().filter(|way| **way <= SAME_FACE).count();
    let next = before.get(on_back);
    let is_clear = next.is_none_or(|way| *way >= CLEAR);
    (on_back > 0 && is_clear).then_some(Back::Round)
}
