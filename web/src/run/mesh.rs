//! A free-form wall as a mesh over its measured patch.

use serde::{Deserialize, Serialize};
use snellius::geometry::Point;
use snellius::optics::{Freeform, Sheet};

use super::report::Place;

/// A place of the outer face, and the one behind it on the inner face.
pub(crate) type Through = [Place; 2];

/// The measured patch of a wall, as rings about its middle: the last is the patch's edge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mesh {
    /// Rings of equally many places, each closed: its last place is its first.
    pub(crate) rings: Vec<Vec<Through>>,
}

impl Mesh {
    /// The patch is convex, so every place between its middle and its edge belongs to it.
    pub(super) fn of(freeform: &Freeform, thickness: f64) -> Self {
        const RINGS: usize = 24;
        let sheet = freeform.sheet();
        let edge = edge(sheet);
        let count = edge.len().max(1) as f64;
        let middle = [0, 1].map(|axis| edge.iter().map(|p| p[axis]).sum::<f64>() / count);
        let ring = |ring: usize| {
            let way = ring as f64 / RINGS as f64;
            let place = |p: &[f64; 2]| {
                through(
                    sheet,
                    thickness,
                    [0, 1].map(|i| middle[i] + (p[i] - middle[i]) * way),
                )
            };
            edge.iter().map(place).collect()
        };
        Self {
            rings: (0..=RINGS).map(ring).collect(),
        }
    }
}

/// Once round the patch, in steps of about a hundredth of the way, and back at the start.
fn edge(sheet: &Sheet) -> Vec<[f64; 2]> {
    const STEPS: f64 = 100.0;
    let corners = &sheet.patch;
    let next = corners.iter().cycle().skip(1);
    let sides = || corners.iter().zip(next.clone());
    let length: f64 = sides().map(|(from, to)| (to - from).norm()).sum();
    let places = sides().flat_map(|(from, to)| {
        let pieces = ((to - from).norm() / length * STEPS).ceil().max(1.0);
        (0..pieces as usize).map(move |i| (from + (to - from) * (i as f64 / pieces)).into())
    });
    let mut edge: Vec<[f64; 2]> = places.collect();
    edge.extend(edge.first().copied());
    edge
}

fn through(sheet: &Sheet, thickness: f64, place: [f64; 2]) -> Through {
    let (point, normal) = sheet.at(place.into());
    [point, point + normal * -thickness].map(Point::to_array)
}
