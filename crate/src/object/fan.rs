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

impl Fan<'_> {
    /// The ray of the sheet that meets a (refracted) line of sight.
    ///
    /// Refracted, the sheet is no plane any more, but each of its rays is still a line: the angle
    /// within the sheet is sought at which the gap of the two lines is 0, by the secant method from
    /// the ray that would be right in air.
    pub(super) fn ray_to(
        &self,
        sight: &Ray<World>,
        in_air: &Ray<Camera>,
    ) -> Result<Ray<Camera>, MeetingError> {
        const FIRST_STEP: f64 = 1e-3;
        const CLOSE_ENOUGH: f64 = 1e-10;
        const STEPS: usize = 30;
        let gap = |angle: f64| self.gap(&self.sheet.turned(in_air, angle), sight);
        let (mut before, mut angle) = (0.0, FIRST_STEP);
        let (mut gap_before, mut gap_here) = (gap(before)?, gap(angle)?);
        for _ in 0..STEPS {
            if gap_here.abs() < CLOSE_ENOUGH {
                return Ok(self.sheet.turned(in_air, angle));
            }
            let slope = (gap_here - gap_before) / (angle - before);
            (before, gap_before) = (angle, gap_here);
            angle -= gap_here / slope;
            if !angle.is_finite() {
                break;
            }
            gap_here = gap(angle)?;
        }
        Err(MeetingError::NoRayOfSheet)
    }

    fn gap(&self, ray: &Ray<Camera>, sight: &Ray<World>) -> Result<f64, MeetingError> {
        let light = self
            .stack
            .trace(&self.world_from_camera.ray(ray))
            .map_err(MeetingError::Beam)?;
        Ok(closest_approach(&light, sight)?.gap)
    }
}
