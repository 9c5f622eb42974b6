//! A free-form wall as a mesh: places where rays across its reference plane meet it.

use serde::{Deserialize, Serialize};
use snellius::geometry::Ray;
use snellius::optics::{Freeform, Surface};

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
        let probe = Probe::new(freeform, thickness);
        let steps = |axis: usize| {
            let values = freeform.sheet().patch.iter().map(|corner| corner[axis]);
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            (0..=CELLS).map(move |i| low + (high - low) * i as f64 / CELLS as f64)
        };
        Self {
            rows: steps(1)
                .map(|y| steps(0).map(|x| probe.at(x, y)).collect())
                .collect(),
            rim: rim(freeform, &probe),
        }
    }
}

/// The patch's edges, a hair within it, so that rays still meet the wall there.
fn rim(freeform: &Freeform, probe: &Probe) -> Vec<Through> {
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
    let mut rim: Vec<Through> = pulled.filter_map(|[x, y]| probe.at(x, y)).collect();
    rim.extend(rim.first().copied());
    rim
}

/// Rays across the reference plane.
struct Probe<'a> {
    freeform: &'a Freeform,
    face: Surface,
    thickness: f64,
    /// In front of every height, mm.
    reach: f64,
}

impl<'a> Probe<'a> {
    fn new(freeform: &'a Freeform, thickness: f64) -> Self {
        let heights = freeform.sheet().heights.iter();
        Self {
            freeform,
            face: Surface::Freeform(freeform.clone()),
            thickness,
            reach: heights.fold(0.0, |most, height| height.abs().max(most)) + 1.0,
        }
    }

    fn at(&self, x: f64, y: f64) -> Option<Through> {
        let reference = &self.freeform.sheet().reference;
        let (u, v) = reference.normal.tangents();
        let start = reference.point + (u * x + v * y + reference.normal * self.reach);
        let hit = self.face.hit(&Ray::new(start, -reference.normal))?;
        let behind = hit.point + hit.normal * -self.thickness;
        Some([hit.point.to_array(), behind.to_array()])
    }
}
