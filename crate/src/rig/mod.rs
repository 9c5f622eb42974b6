//! The laser range finder: a camera and a laser fixed to each other on a manipulator's hand.

mod calibration;
mod epipolar;
mod laser;

pub use calibration::{Calibration, CalibrationSigma};
pub use epipolar::EpipolarLine;
pub use laser::{Laser, Profiles, Sheet};

use crate::camera::{Intrinsics, Slope};
use crate::geometry::{Camera, Flange, Point, Pose, Ray, World};

/// The calibrated range finder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The lens.
    pub camera: Intrinsics,
    /// The laser.
    pub laser: Laser,
    /// The hand-eye calibration.
    pub flange_from_camera: Pose<Flange, Camera>,
}

impl Rig {
    /// The camera's pose when the manipulator's hand is at `world_from_flange`.
    pub fn station(&self, world_from_flange: &Pose<World, Flange>) -> Pose<World, Camera> {
        *world_from_flange * self.flange_from_camera
    }

    /// The beam's image in air; a sheet has none.
    pub fn epipolar_line(&self) -> Option<EpipolarLine> {
        match &self.laser {
            Laser::Beam(beam) => Some(EpipolarLine::new(beam)),
            Laser::Sheet(_) => None,
        }
    }

    /// Takes what a line of sight shows for a point of the laser's light in air. `None` if that lies
    /// behind the laser or the camera.
    pub fn triangulate(&self, sight: Slope) -> Option<LitPoint> {
        match &self.laser {
            Laser::Beam(beam) => EpipolarLine::new(beam).triangulate(sight),
            Laser::Sheet(sheet) => in_sheet(sheet, sight),
        }
    }
}

/// A point of the laser's light in air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPoint {
    /// How far from the laser, mm: its order along the light, whichever side the laser is on.
    pub along: f64,
    /// The point.
    pub point: Point<Camera>,
    /// How far it is seen off the beam's epipolar line, in slopes; times the focal length, pixels. A sheet
    /// has no such line: every line of sight meets it.
    pub off_line: Option<f64>,
}

/// Where a line of sight meets the sheet.
fn in_sheet(sheet: &Sheet, sight: Slope) -> Option<LitPoint> {
    let sight = Ray::new(Point::origin(), sight.direction());
    let away = sheet.plane().distance_along(&sight)?;
    let point = sight.at(away);
    (away > 0.0).then_some(LitPoint {
        along: point.distance(sheet.apex),
        point,
        off_line: None,
    })
}
