//! The object's surface: both light paths traced through the wall, their midpoint, the ray distance,
//! standard deviations, and which of several spots is real (section II-D of the paper).

mod arcs;
mod back;
mod choice;
mod fan;
mod grain;
mod line;
mod media;
mod meeting;
mod neighbours;
mod select;
mod settle;
mod uncertainty;

pub use choice::{
    Choice, Neighbourhood, ObjectPoint, ObjectSettings, Refusal, find_object, object_grain,
};
pub use media::propose_media;
pub use meeting::{Meeting, MeetingError, laser_ray, line_of_sight, meet, meet_unrefracted};
pub use settle::settle_wall;
pub use uncertainty::{CommonSigma, Noise, calibration_sigmas, index_sigmas, noise};

use crate::optics::Media;
use crate::rig::{CalibrationSigma, Rig};
use crate::scan::Station;
use crate::vessel::VesselFit;

/// Everything that stands between the spots and the object's points.
#[derive(Clone, Copy, Debug)]
pub struct Setup<'a> {
    /// The range finder.
    pub rig: &'a Rig,
    /// How well it is calibrated.
    pub calibration_sigma: &'a CalibrationSigma,
    /// Where it stood.
    pub stations: &'a [Station],
    /// The wall it looked through.
    pub vessel: &'a VesselFit,
    /// The media.
    pub media: Media,
}
