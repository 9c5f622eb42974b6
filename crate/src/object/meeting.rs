use super::fan::Fan;
use crate::camera::{OutsideLens, Pixel};
use crate::geometry::{Approach, Camera, ParallelRays, Point, Pose, Ray, World, closest_approach};
use crate::optics::{Stack, TraceError};
use crate::rig::{Laser, Rig};
use crate::vessel::NoRoom;

/// Where the refracted beam and the refracted line of sight come closest (Fig. 7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The beam first, the line of sight second, both behind the last face.
    pub approach: Approach<World>,
}

impl Meeting {
    /// The object point P: the midpoint of the shortest segment.
    pub fn point(&self) -> Point<World> {
        self.approach.midpoint()
    }

    /// The ray distance with a sign; its size is l.
    pub const fn gap(&self) -> f64 {
        self.approach.gap
    }

    /// How far behind the last face the nearer of the two feet lies, mm, along the light; negative if
    /// the rays would have to run backwards.
    pub fn depth(&self) -> f64 {
        self.approach.along_first.min(self.approach.along_second)
    }
}

/// Why a spot gives no point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeetingError {
    /// The laser beam does not get through the wall.
    #[error("the laser beam does not get in: {0}")]
    Beam(TraceError),
    /// No ray of the laser's sheet meets the line of sight.
    #[error("no ray of the laser's sheet meets the line of sight")]
    NoRayOfSheet,
    /// The line of sight does not get through the wall.
    #[error("the line of sight does not get in: {0}")]
    Sight(TraceError),
    /// The wall does not fit into the vessel.
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
    /// The two rays are parallel.
    #[error(transparent)]
    Parallel(#[from] ParallelRays),
    /// The pixel has no line of sight.
    #[error(transparent)]
    OutsideLens(#[from] OutsideLens),
}

/// Traces the laser's light and the line of sight of `pixel` through `stack` and finds where they meet.
///
/// Of a sheet the ray is taken that meets the line of sight; the gap is 0 then, and says nothing.
pub fn meet(
    rig: &Rig,
    world_from_camera: &Pose<World, Camera>,
    stack: &Stack,
    pixel: Pixel,
) -> Result<Meeting, MeetingError> {
    let light = laser_ray(rig, world_from_camera, stack, pixel)?;
    let light = stack.trace(&light).map_err(MeetingError::Beam)?;
    let sight = refracted_sight(rig, world_from_camera, stack, pixel)?;
    Ok(Meeting {
        approach: closest_approach(&light, &sight)?,
    })
}

/// The laser's ray that lights what `pixel` shows behind `stack`: the beam, or the ray of the sheet that
/// meets the line of sight. Before the first face, in the world.
pub fn laser_ray(
    rig: &Rig,
    world_from_camera: &Pose<World, Camera>,
    stack: &Stack,
    pixel: Pixel,
) -> Result<Ray<World>, MeetingError> {
    let ray = match &rig.laser {
        Laser::Beam(beam) => *beam,
        Laser::Sheet(sheet) => {
            let fan = Fan {
                sheet,
                world_from_camera,
                stack,
            };
            let sight = refracted_sight(rig, world_from_camera, stack, pixel)?;
            let in_air = rig.triangulate(rig.camera.slope(pixel)?);
            let in_air = in_air.ok_or(MeetingError::NoRayOfSheet)?;
            sheet.ray_at(fan.angle_to(&sight, sheet.angle_of(in_air.point))?)
        }
    };
    Ok(world_from_camera.ray(&ray))
}

fn refracted_sight(
    rig: &Rig,
    world_from_camera: &Pose<World, Camera>,
    stack: &Stack,
    pixel: Pixel,
) -> Result<Ray<World>, MeetingError> {
    stack
        .trace(&line_of_sight(rig, world_from_camera, pixel)?)
        .map_err(MeetingError::Sight)
}

/// As [`meet`], as if there were neither wall nor liquid: Fig. 11 (b).
pub fn meet_unrefracted(
    rig: &Rig,
    world_from_camera: &Pose<World, Camera>,
    pixel: Pixel,
) -> Result<Meeting, MeetingError> {
    let air = Stack {
        outside: 1.0,
        interfaces: Vec::new(),
    };
    meet(rig, world_from_camera, &air, pixel)
}

/// The line of sight of a pixel, in the world.
pub fn line_of_sight(
    rig: &Rig,
    world_from_camera: &Pose<World, Camera>,
    pixel: Pixel,
) -> Result<Ray<World>, OutsideLens> {
    let direction = rig.camera.slope(pixel)?.direction();
    Ok(world_from_camera.ray(&Ray::new(Point::origin(), direction)))
}
