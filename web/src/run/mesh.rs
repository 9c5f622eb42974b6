//! A free-form wall as a mesh.

use serde::{Deserialize, Serialize};
use snellius::optics::Freeform;

use super::report::Place;

/// A place of the outer face, and the one behind it on the inner face.
pub(crate) type Through = [Place; 2];

/// The measured patch of a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mesh {
    /// Rows of places; none where nothing was measured.
    pub(crate) rows: Vec<Vec<Option<Through>>>,
    /// Once round the patch.
    pub(crate) rim: Vec<Through>,
}

impl Mesh {
    pub(super) fn of(freeform: &Freeform, thickness: f64) -> Self {
        const CELLS: usize = 32;
        let steps = |axis: usize| {
            let values = freeform.sheet().patch.iter().map(|corner| corner[axis]);
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            (0..=CELLS).map(move |i| low + (high - low) * i as f64 / CELLS as f64)
        };
        Self {
            rows: steps(1)
                .map(|y| {
                    steps(0)
                        .map(|x| through(freeform, thickness, [x, y]))
                        .collect()
                })
                .collect(),
            rim: rim(freeform, thickness),
        }
    }
}

/// The patch's edges, a hair within it, so that rounding does not put them beyond it.
fn rim(freeform: &Freeform, thickness: f64) -> Vec<Through> {
    const WITHIN: f64 = 0.999;
    const PIECES: usize = 12;
    let corners = &freeform.sheet().patch;
    let count = corners.len() as f64;
    let mean = |axis: usize| corners.iter().map(|c| c[axis]).sum::<f64>() / count;
    let centre = [mean(0), mean(1)];
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let places = edges.flat_map(|(from, to)| {
        (0..PIECES).map(move |i| from + (to - from) * (i as f64 / PIECES as f64))
    });
    let pulled =
        places.map(|p| [0, 1].map(|axis| centre[axis] + (p[axis] - centre[axis]) * WITHIN));
    let mut rim: Vec<Through> = pulled
        .filter_map(|place| through(freeform, thickness, place))
        .collect();
    rim.extend(rim.first().copied());
    rim
}

/// The wall at a place of its base; none where it was not measured.
fn through(freeform: &Freeform, thickness: f64, place: [f64; 2]) -> Option<Through> {
    let (outer, normal) = freeform.at(place.into())?;
    let inner = outer + normal * -thickness;
    Some([outer.to_array(), inner.to_array()])
}
