use serde::{Deserialize, Serialize};

use super::Reconstruction;
use crate::rig::Laser;

/// A reconstruction in a few numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// How many views have an object point.
    pub used: usize,
    /// Mean ray distance of these, mm; of a sheet of light it says nothing.
    pub mean_ray_distance: Option<f64>,
    /// Median distance of the vessel's spots from the epipolar line, px, with its sign.
    pub median_off_line: Option<f64>,
}

impl Reconstruction<'_> {
    /// The reconstruction in a few numbers.
    pub fn summary(&self) -> Summary {
        let points = self.object.iter().flat_map(|choice| &choice.points);
        let distances: Vec<f64> = match self.scan.rig.laser {
            Laser::Beam(_) => points.map(|p| p.meeting.gap().abs()).collect(),
            Laser::Sheet(_) => Vec::new(),
        };
        let mean = || distances.iter().sum::<f64>() / distances.len() as f64;
        Summary {
            used: self.object.iter().filter(|c| !c.points.is_empty()).count(),
            mean_ray_distance: (!distances.is_empty()).then(mean),
            median_off_line: self.vessel.median_off_line(),
        }
    }
}
