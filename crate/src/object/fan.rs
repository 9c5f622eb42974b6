//! Which ray of a sheet of light meets a line of sight behind the wall.

use super::MeetingError;
use crate::geometry::{Camera, Pose, Ray, World, closest_approach};
use crate::optics::Stack;
use crate::rig::Sheet;

/// A sheet of light before a wall.
pub(super) struct Fan<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) world_from_camera: &'a Pose<World, Camera>,
    pub(super) stack: &'a Stack,
}

/// Near enough: two lines this far apart meet, mm.
const CLOSE_ENOUGH: f64 = 1e-10;

impl Fan<'_> {
    /// The angle (see [`Sheet::ray_at`]) of the ray that meets a (refracted) line of sight.
    ///
    /// Refracted, the sheet is no plane any more, but each of its rays is still a line: the angle is sought
    /// at which the gap of the two lines is 0, by the secant method from the angle that would be right in
    /// air. A step that leads to where no light gets through is halved.
    pub(super) fn angle_to(&self, sight: &Ray<World>, in_air: f64) -> Result<f64, MeetingError> {
        const FIRST_STEP: f64 = 1e-3;
        const STEPS: usize = 40;
        let (mut before, mut gap_before) = (in_air, self.gap(in_air, sight)?);
        let mut angle = in_air + FIRST_STEP;
        for _ in 0..STEPS {
            let gap = match self.gap(angle, sight) {
                Ok(gap) => gap,
                Err(error) if (angle - before).abs() < 1e-6 => return Err(error),
                Err(_) => {
                    angle = 0.5 * (angle + before);
                    continue;
                }
            };
            if gap.abs() < CLOSE_ENOUGH {
                return Ok(angle);
            }
            let step = -gap * (angle - before) / (gap - gap_before);
            if !step.is_finite() {
                break;
            }
            (before, gap_before) = (angle, gap);
            angle += step.clamp(-0.3, 0.3);
        }
        Err(MeetingError::NoRayOfSheet)
    }

    fn gap(&self, angle: f64, sight: &Ray<World>) -> Result<f64, MeetingError> {
        let ray = self.sheet.ray_at(angle);
        let light = self
            .stack
            .trace(&self.world_from_camera.ray(&ray))
            .map_err(MeetingError::Beam)?;
        Ok(closest_approach(&light, sight)?.gap)
    }
}
