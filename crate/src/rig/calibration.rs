use nalgebra::Vector3;

use super::Rig;

/// One standard deviation of what calibration gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationSigma {
    /// Laser origin, each coordinate, mm.
    pub laser_origin: f64,
    /// Laser direction, or the normal of a sheet, each of two tilts, radians.
    pub laser_direction: f64,
    /// Focal lengths, px.
    pub focal_length: f64,
    /// Principal point, px.
    pub principal_point: f64,
    /// Hand-eye rotation, about each axis, radians.
    pub hand_eye_rotation: f64,
    /// Hand-eye translation, along each axis, mm.
    pub hand_eye_translation: f64,
}

impl Default for CalibrationSigma {
    fn default() -> Self {
        Self {
            laser_origin: 0.3,
            laser_direction: 0.1_f64.to_radians(),
            focal_length: 0.5,
            principal_point: 0.5,
            hand_eye_rotation: 0.1_f64.to_radians(),
            hand_eye_translation: 0.3,
        }
    }
}

/// The numbers that calibration gave, as small steps away from what it gave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Calibration {
    /// Laser origin along a camera axis, mm.
    LaserOrigin(usize),
    /// Laser direction, or the normal of a sheet, towards one of its two tangents, radians.
    LaserDirection(usize),
    /// Focal length across or down the picture, px.
    FocalLength(usize),
    /// Principal point across or down the picture, px.
    PrincipalPoint(usize),
    /// Hand-eye rotation about a camera axis, radians.
    HandEyeRotation(usize),
    /// Hand-eye translation along a camera axis, mm.
    HandEyeTranslation(usize),
}

impl Calibration {
    /// Every one of them.
    pub const ALL: [Self; 15] = [
        Self::LaserOrigin(0),
        Self::LaserOrigin(1),
        Self::LaserOrigin(2),
        Self::LaserDirection(0),
        Self::LaserDirection(1),
        Self::FocalLength(0),
        Self::FocalLength(1),
        Self::PrincipalPoint(0),
        Self::PrincipalPoint(1),
        Self::HandEyeRotation(0),
        Self::HandEyeRotation(1),
        Self::HandEyeRotation(2),
        Self::HandEyeTranslation(0),
        Self::HandEyeTranslation(1),
        Self::HandEyeTranslation(2),
    ];

    /// One standard deviation, in the unit of the step.
    pub const fn sigma(self, sigma: &CalibrationSigma) -> f64 {
        match self {
            Self::LaserOrigin(_) => sigma.laser_origin,
            Self::LaserDirection(_) => sigma.laser_direction,
            Self::FocalLength(_) => sigma.focal_length,
            Self::PrincipalPoint(_) => sigma.principal_point,
            Self::HandEyeRotation(_) => sigma.hand_eye_rotation,
            Self::HandEyeTranslation(_) => sigma.hand_eye_translation,
        }
    }

    /// The range finder with this number off by `step`.
    pub fn nudge(self, rig: &Rig, step: f64) -> Rig {
        let mut rig = *rig;
        match self {
            Self::LaserOrigin(axis) => rig.laser = rig.laser.moved(unit(axis) * step),
            Self::LaserDirection(0) => rig.laser = rig.laser.tilted(step, 0.0),
            Self::LaserDirection(_) => rig.laser = rig.laser.tilted(0.0, step),
            Self::FocalLength(side) => rig.camera.focal[side] += step,
            Self::PrincipalPoint(0) => rig.camera.centre.u += step,
            Self::PrincipalPoint(_) => rig.camera.centre.v += step,
            Self::HandEyeRotation(axis) => {
                rig.flange_from_camera = rig
                    .flange_from_camera
                    .nudged(unit(axis) * step, Vector3::zeros());
            }
            Self::HandEyeTranslation(axis) => {
                rig.flange_from_camera = rig
                    .flange_from_camera
                    .nudged(Vector3::zeros(), unit(axis) * step);
            }
        }
        rig
    }
}

fn unit(axis: usize) -> Vector3<f64> {
    let mut unit = Vector3::zeros();
    unit[axis] = 1.0;
    unit
}
