//! The calibration table of a rig that never moves against its window.
//!
//! Camera, laser and wall stand still against one another, so each pixel's light meets the laser's light
//! in one and the same place for ever. It is worked out once on a grid of pixels, and between the grid's
//! nodes it is interpolated; no ray is traced while measuring. (Such a table is how the laboratory of the
//! paper's authors measured through one flat window before: references [10] and [13] of the paper.)

mod build;
mod grid;
mod measure;

pub use build::{Reach, TableError, build};
pub use grid::Grid;
pub use measure::{MeasureError, measure};

use serde::{Deserialize, Serialize};

use crate::camera::Pixel;
use crate::export::{MediaResult, VesselResult};
use crate::geometry::{Camera, Point};
use crate::scan::{CameraEntry, LaserEntry, LengthUnit, PoseEntry};

/// The format's name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TableFormat {
    /// `refractive-table`
    #[default]
    #[serde(rename = "refractive-table")]
    RefractiveTable,
}

/// A table pixel -> point, as its file states it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// `refractive-table`.
    pub format: TableFormat,
    /// The format's version: 1.
    pub version: u32,
    /// The scan that the wall was measured with.
    pub scan: String,
    /// The view of it whose pose against the wall the table stands for.
    pub view: String,
    /// `mm`.
    pub length_unit: LengthUnit,
    /// The lens, as in the scan.
    pub camera: CameraEntry,
    /// The laser, as in the scan.
    pub laser: LaserEntry,
    /// The indices that light was traced with.
    pub media: MediaResult,
    /// The wall, in that scan's world.
    pub vessel: VesselResult,
    /// The camera's pose there: the axes of the standard deviations are this world's.
    pub world_from_camera: PoseEntry,
    /// What the table covers.
    pub reach: Reach,
    /// How exact it is.
    pub accuracy: Accuracy,
    /// The pixels of the nodes.
    pub grid: Grid,
    /// The nodes, row by row; `null` where light does not get through.
    pub nodes: Vec<Option<Node>>,
}

/// How far the interpolated points lie from the traced ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// The largest distance, mm.
    pub largest_error: f64,
    /// The largest distance in standard deviations of the point, for a spot located to `pixel_sigma`.
    pub largest_share: f64,
    /// One standard deviation of the finest spot of the scan, px: a coarser one makes the share smaller.
    pub pixel_sigma: f64,
    /// How many places between the nodes were compared.
    pub places: usize,
}

/// What the table knows at a pixel.
///
/// Along a beam 1/z is all but linear in the pixel, while z runs off to infinity; so everything is kept
/// over z. The point is in the camera's frame, the standard deviations are along the world's axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// x/z, y/z, 1/z of the point where line of sight and laser light meet; its signed ray distance and
    /// its depth behind the last face, both over z.
    pub meeting: [f64; 5],
    /// One standard deviation of x, y, z and of the ray distance that the wall's fit makes, mm.
    pub of_wall: [f64; 4],
    /// The same of what calibration makes, mm.
    pub of_calibration: [f64; 4],
}

/// What a pixel shows, by look-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The point.
    pub point: Point<Camera>,
    /// The signed ray distance, mm; 0 for a sheet of light.
    pub gap: f64,
    /// How far behind the last face, mm along the light.
    pub depth: f64,
    /// One standard deviation of x, y, z (of the table's world) and of the gap that the wall's fit makes,
    /// mm.
    pub of_wall: [f64; 4],
    /// The same of what calibration makes, mm.
    pub of_calibration: [f64; 4],
}

impl Table {
    /// Looks a pixel up; `None` outside what the table covers.
    ///
    /// Cubic Lagrange interpolation through the 4 x 4 nodes around, so the error falls with the fourth
    /// power of the nodes' distance.
    pub fn look_up(&self, pixel: Pixel) -> Option<Seen> {
        let stencil = self
            .grid
            .stencil(pixel, |node| self.nodes[node].is_some())?;
        let mut values = [0.0; 13];
        for (node, weight) in stencil {
            let node = self.nodes[node].as_ref()?;
            let parts = [&node.meeting[..], &node.of_wall, &node.of_calibration];
            let all = parts.into_iter().flatten();
            values
                .iter_mut()
                .zip(all)
                .for_each(|(sum, value)| *sum += weight * value);
        }
        let [x, y, inverse, gap, depth, wall @ .., c0, c1, c2, c3] = values;
        let z = 1.0 / inverse;
        z.is_finite().then_some(Seen {
            point: Point::new(x * z, y * z, z),
            gap: gap * z,
            depth: depth * z,
            of_wall: wall.map(|sigma| sigma.max(0.0)),
            of_calibration: [c0, c1, c2, c3].map(|sigma| sigma.max(0.0)),
        })
    }

    /// The table as a JSON file.
    pub fn to_json(&self) -> String {
        let mut json = serde_json::to_string(self)
            .expect("strings and numbers alone, with string keys, always serialise");
        json.push('\n');
        json
    }
}
