//! The light on the bench.

use super::Bench;
use crate::camera::{OutsideLens, Pixel, Slope};
use crate::geometry::{Direction, Point, Pose, Ray, World};
use crate::object::{Meeting, MeetingError, meet, meet_unrefracted};
use crate::optics::{AimError, Stack, TotalReflection, aim_through, refract};
use crate::rig::{Laser, Rig};

/// Light where it crosses a face, or fails to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// The place.
    pub at: Point<World>,
    /// The face's normal there, towards the rig.
    pub normal: Direction<World>,
    /// The light that comes.
    pub before: Direction<World>,
    /// The light that goes on: bent, or thrown back.
    pub after: Direction<World>,
    /// Index of the medium it comes from.
    pub index_before: f64,
    /// Index of the medium behind the face.
    pub index_behind: f64,
    /// What throws it back, if anything does.
    pub thrown_back: Option<TotalReflection>,
}

impl Bend {
    fn new(ray: &Ray<World>, at: Point<World>, normal: Direction<World>, n1: f64, n2: f64) -> Self {
        let before = ray.direction;
        let bent = refract(before, normal, n1, n2);
        Self {
            at,
            normal,
            before,
            after: bent.unwrap_or_else(|_| mirrored(before, normal)),
            index_before: n1,
            index_behind: n2,
            thrown_back: bent.err(),
        }
    }

    /// |d x N| of the light that comes: the sine of its angle.
    pub fn sine_before(&self) -> f64 {
        self.before.vector().cross(&self.normal.vector()).norm()
    }

    /// |d x N| of the light that goes on.
    pub fn sine_after(&self) -> f64 {
        self.after.vector().cross(&self.normal.vector()).norm()
    }

    /// The angle between the light that comes and the normal, radians.
    pub fn angle_before(&self) -> f64 {
        angle(self.before, self.normal)
    }

    /// The angle between the light that goes on and the normal, radians.
    pub fn angle_after(&self) -> f64 {
        angle(self.after, self.normal)
    }

    /// The angle from which on this face throws light back, if it can: asin(n2/n1), radians.
    pub fn critical(&self) -> Option<f64> {
        let ratio = self.index_behind / self.index_before;
        (ratio < 1.0).then(|| libm::asin(ratio))
    }
}

/// The angle to the normal's line, exact for small angles as well: 0 to 90 degrees.
fn angle(light: Direction<World>, normal: Direction<World>) -> f64 {
    let sine = light.vector().cross(&normal.vector()).norm();
    libm::atan2(sine, light.dot(normal).abs())
}

fn mirrored(light: Direction<World>, normal: Direction<World>) -> Direction<World> {
    let back = light.vector() - normal * (2.0 * light.dot(normal));
    Direction::assume_unit(back.normalize())
}

/// How light ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It is behind the wall.
    Inside,
    /// A face throws it back.
    ThrownBack {
        /// Which face, from 0 at the rig.
        face: usize,
    },
    /// It never meets a face.
    Misses {
        /// Which face, from 0 at the rig.
        face: usize,
    },
}

/// Light from the rig, face by face.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPath {
    /// Where it starts, and where to.
    pub start: Ray<World>,
    /// Where it meets the wall's faces.
    pub bends: Vec<Bend>,
    /// How it ends.
    pub end: End,
}

impl LightPath {
    /// Follows a ray through the stack, as [`Stack::trace`] does, and keeps what happens at each face.
    pub fn of(stack: &Stack, start: Ray<World>) -> Self {
        let mut path = Self {
            start,
            bends: Vec::with_capacity(stack.interfaces.len()),
            end: End::Inside,
        };
        for (face, interface) in stack.interfaces.iter().enumerate() {
            let light = path.last();
            let Some(hit) = interface.surface.hit(&light) else {
                path.end = End::Misses { face };
                return path;
            };
            let before = path
                .bends
                .last()
                .map_or(stack.outside, |bend| bend.index_behind);
            let bend = Bend::new(
                &light,
                hit.point,
                hit.normal,
                before,
                interface.index_behind,
            );
            path.bends.push(bend);
            if bend.thrown_back.is_some() {
                path.end = End::ThrownBack { face };
                return path;
            }
        }
        path
    }

    /// The light after the last face that it met.
    pub fn last(&self) -> Ray<World> {
        self.bends
            .last()
            .map_or(self.start, |bend| Ray::new(bend.at, bend.after))
    }

    /// Whether it gets in.
    pub fn is_inside(&self) -> bool {
        self.end == End::Inside
    }
}

/// What the range finder makes of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Where the camera sees the spot.
    pub pixel: Pixel,
    /// Where the two rays meet at the assumed index.
    pub meeting: Meeting,
    /// Where they would meet if light went straight: the apparent point.
    pub apparent: Option<Point<World>>,
}

/// Why there is no measurement.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMeasurement {
    /// The beam never gets in.
    #[error("the beam does not get into the vessel, so there is no spot to see")]
    NoSpot,
    /// No light from the spot gets to the camera.
    #[error("no light from the spot reaches the camera: {0}")]
    Unseen(AimError),
    /// The spot is not before the camera.
    #[error("the spot is not in the camera's picture")]
    OutOfPicture,
    /// The spot's pixel gives no point at the assumed index.
    #[error("at the assumed index there is no point: {0}")]
    NoPoint(MeetingError),
}

impl From<OutsideLens> for NoMeasurement {
    fn from(_: OutsideLens) -> Self {
        Self::OutOfPicture
    }
}

/// Everything that light does on the bench.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The laser beam.
    pub beam: LightPath,
    /// The line of sight, from the camera to the spot; towards it, where no light gets through.
    pub sight: LightPath,
    /// Where the beam lights the object; `None` if it does not get in.
    pub spot: Option<Point<World>>,
    /// What is measured.
    pub measurement: Result<Measurement, NoMeasurement>,
}

impl Light {
    /// Traces the light of a bench.
    pub fn of(bench: &Bench) -> Self {
        let stack = bench.stack();
        let beam = LightPath::of(
            &stack,
            Ray::new(bench.on_rig(bench.laser), beam_aim(bench, &stack)),
        );
        let spot = spot(bench, &beam);
        let camera = bench.on_rig(bench.camera);
        let target = spot.unwrap_or_else(|| bench.object_point());
        let aimed = aim_through(&stack, camera, target);
        let sight_aim = aimed.unwrap_or_else(|_| straight(camera, target));
        let sight = LightPath::of(&stack, Ray::new(camera, sight_aim));
        let measurement = match (spot, aimed) {
            (None, _) => Err(NoMeasurement::NoSpot),
            (_, Err(error)) => Err(NoMeasurement::Unseen(error)),
            (_, Ok(aim)) => measure(bench, &beam, aim),
        };
        Self {
            beam,
            sight,
            spot,
            measurement,
        }
    }

    /// The ray distance l, mm, if there is a measurement.
    pub fn ray_distance(&self) -> Option<f64> {
        let measurement = self.measurement.as_ref().ok()?;
        Some(measurement.meeting.gap().abs())
    }

    /// How far the measured point lies from the true one, mm.
    pub fn error(&self) -> Option<f64> {
        let measurement = self.measurement.as_ref().ok()?;
        Some(measurement.meeting.point().distance(self.spot?))
    }
}

/// The beam's direction: as set, or such that it meets the object point.
fn beam_aim(bench: &Bench, stack: &Stack) -> Direction<World> {
    let laser = bench.on_rig(bench.laser);
    if let Some(degrees) = bench.aim {
        let (sine, cosine) = libm::sincos(degrees.to_radians());
        let aim = bench.rig_rotation() * nalgebra::Vector3::new(sine, 0.0, cosine);
        return Direction::assume_unit(aim);
    }
    let target = bench.object_point();
    aim_through(stack, laser, target).unwrap_or_else(|_| straight(laser, target))
}

/// Straight from one place to another (or anywhere, if they are the same).
fn straight(from: Point<World>, to: Point<World>) -> Direction<World> {
    Direction::new(to - from).unwrap_or(Direction::assume_unit(nalgebra::Vector3::z()))
}

/// Where the beam lights the object: the object point if it was aimed at it, or else the place along
/// the beam that is nearest to it.
fn spot(bench: &Bench, beam: &LightPath) -> Option<Point<World>> {
    if !beam.is_inside() {
        return None;
    }
    let last = beam.last();
    let along = (bench.object_point() - last.origin).dot(&last.direction.vector());
    Some(last.at(along.max(1.0)))
}

fn measure(
    bench: &Bench,
    beam: &LightPath,
    sight: Direction<World>,
) -> Result<Measurement, NoMeasurement> {
    let world_from_camera = bench.world_from_camera();
    let camera_from_world = world_from_camera.inverse();
    let intrinsics = Bench::intrinsics();
    let ahead = Point::origin() + camera_from_world.direction(sight).vector();
    let pixel = Slope::of(ahead)
        .map(|slope| intrinsics.pixel(slope))
        .ok_or(NoMeasurement::OutOfPicture)?;
    let rig = Rig {
        camera: intrinsics,
        laser: Laser::Beam(camera_from_world.ray(&beam.start)),
        flange_from_camera: Pose::identity(),
    };
    let index = bench.assumed.unwrap_or_else(|| bench.liquid.index());
    let meeting = meet(&rig, &world_from_camera, &bench.stack_with(index), pixel)
        .map_err(NoMeasurement::NoPoint)?;
    let apparent = meet_unrefracted(&rig, &world_from_camera, pixel).ok();
    Ok(Measurement {
        pixel,
        meeting,
        apparent: apparent
            .filter(|meeting| meeting.depth() > 0.0)
            .map(|meeting| meeting.point()),
    })
}

/// What a person is told of light that does not get in.
impl LightPath {
    /// The words; `None` for light that gets in.
    pub fn trouble(&self) -> Option<String> {
        let name = |face: usize| if face == 0 { "outer" } else { "inner" };
        match self.end {
            End::Inside => None,
            End::Misses { face } => Some(format!("The light passes by the {} face.", name(face))),
            End::ThrownBack { face } => {
                let thrown_back = self.bends.last()?.thrown_back?;
                Some(format!(
                    "Total internal reflection at the {} face: the light comes at {:.1}\u{b0}, and the \
                     critical angle is {:.1}\u{b0}.",
                    name(face),
                    thrown_back.incidence.to_degrees(),
                    thrown_back.critical.to_degrees()
                ))
            }
        }
    }
}
