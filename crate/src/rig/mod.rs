//! The laser range finder: a camera and a laser fixed to each other on a manipulator's hand.

mod calibration;
mod epipolar;

pub use calibration::{Calibration, CalibrationSigma};
pub use epipolar::{EpipolarLine, OnBeam};

use crate::camera::Intrinsics;
use crate::geometry::{Camera, Flange, Pose, Ray, World};

/// The calibrated range finder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The lens.
    pub camera: Intrinsics,
    /// The laser beam.
    pub beam: Ray<Camera>,
    /// The hand-eye calibration.
    pub flange_from_camera: Pose<Flange, Camera>,
}

impl Rig {
    /// The camera's pose when the manipulator's hand is at `world_from_flange`.
    pub fn station(&self, world_from_flange: &Pose<World, Flange>) -> Pose<World, Camera> {
        *world_from_flange * self.flange_from_camera
    }

    /// The beam's image in air.
    pub fn epipolar_line(&self) -> EpipolarLine {
        EpipolarLine::new(&self.beam)
    }
}
