//! The view through the wall: where the eye is, how large the vessel is, and what stands in it.
//!
//! The graphics card traces the light of every pixel by the same laws; its rays are held against those
//! of the core by [`Sight::off_by`].

use nalgebra::{Matrix2, UnitQuaternion, Vector2, Vector3};

use super::{Bench, WallShape};
use crate::camera::{Pixel, Slope};
use crate::geometry::{Camera, Direction, Plane, Point, Pose, Ray, World};
use crate::optics::{AimError, Stack, aim_through};

/// The eye looks from so far away, mm.
const EYE_DISTANCE: f64 = 460.0;
/// Half the vessel's height, mm.
const HALF_HEIGHT: f64 = 90.0;
/// Half the tank's width, mm.
const TANK_HALF_WIDTH: f64 = 140.0;
/// From the tank's outer front face to its back, mm.
const TANK_DEPTH: f64 = 170.0;
/// The focal length, in heights of the picture.
const FOCAL_PER_HEIGHT: f64 = 1.6;

/// How high the liquid stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The vessel's upper rim, y.
    pub rim: f64,
    /// The liquid's surface, y.
    pub surface: f64,
    /// The vessel's floor, y.
    pub floor: f64,
}

/// The view through the wall.
#[derive(Clone, Debug)]
pub struct Sight {
    /// The eye, looking at the middle of the vessel.
    pub world_from_eye: Pose<World, Camera>,
    /// Focal length, px.
    pub focal: f64,
    /// The picture's middle, px.
    pub centre: Pixel,
    /// The light's way in where the vessel is filled.
    pub stack: Stack,
    /// How high the liquid stands.
    pub level: Level,
    /// Half the width of a flat tank, and its depth, mm.
    pub tank: [f64; 2],
    /// Middle of the vessel.
    pub middle: Point<World>,
    /// What the object must fit into: half a width, mm.
    pub reach: f64,
}

impl Sight {
    /// The view that a bench gives in a picture of `width` by `height` pixels.
    pub fn new(bench: &Bench, width: f64, height: f64) -> Self {
        let depth = match bench.wall {
            WallShape::Plane => 0.5 * TANK_DEPTH,
            _ => bench.radius,
        };
        let reach = match bench.wall {
            WallShape::Plane => 60.0,
            _ => 0.62 * (bench.radius - bench.thickness),
        };
        let half_height = match bench.wall {
            WallShape::Sphere => bench.radius,
            _ => HALF_HEIGHT,
        };
        let middle = Point::new(0.0, 0.0, depth);
        let about = |axis: Vector3<f64>, degrees: f64| {
            UnitQuaternion::from_scaled_axis(axis * degrees.to_radians())
        };
        let rotation =
            about(Vector3::y(), -bench.eye_round) * about(Vector3::x(), -bench.eye_above);
        let eye = middle.coords - rotation * Vector3::new(0.0, 0.0, EYE_DISTANCE);
        Self {
            world_from_eye: Pose::from_parts(rotation, eye),
            focal: FOCAL_PER_HEIGHT * height.min(0.8 * width),
            // (0, 0) is the centre of the top-left pixel.
            centre: Pixel::new(0.5 * width - 0.5, 0.5 * height - 0.5),
            stack: bench.stack(),
            level: Level {
                rim: -half_height,
                surface: half_height * (1.0 - 0.02 * bench.fill),
                floor: half_height,
            },
            tank: [TANK_HALF_WIDTH, TANK_DEPTH],
            middle,
            reach,
        }
    }

    /// The ray of a pixel, before it meets the wall.
    pub fn ray(&self, pixel: Pixel) -> Ray<World> {
        let slope = Slope {
            x: (pixel.u - self.centre.u) / self.focal,
            y: (pixel.v - self.centre.v) / self.focal,
        };
        let ray = Ray::new(Point::origin(), slope.direction());
        self.world_from_eye.ray(&ray)
    }

    /// The pixel at which the eye sees a place behind the wall, in the liquid.
    pub fn pixel(&self, place: Point<World>) -> Result<Pixel, AimError> {
        let eye = Point::from_coords(self.world_from_eye.translation());
        let aim: Direction<World> = aim_through(&self.stack, eye, place)?;
        let ahead = self.world_from_eye.inverse().direction(aim).vector();
        Ok(Pixel::new(
            self.focal * ahead.x / ahead.z + self.centre.u,
            self.focal * ahead.y / ahead.z + self.centre.v,
        ))
    }

    /// How many pixels somebody else's ray of `pixel` is off, by the place that it has reached in the
    /// liquid; `None` where the core's ray does not get in.
    ///
    /// The core's rays of this pixel and of its neighbours pass the place at points of one plane. How
    /// these points move with the pixel tells what their distance from the place is in pixels. (To seek
    /// the pixel that sees the place would not do: through a round vessel there may be several.)
    pub fn off_by(&self, pixel: Pixel, reached: Point<World>) -> Option<f64> {
        const STEP: f64 = 1e-3;
        let inside = |pixel| self.stack.trace(&self.ray(pixel)).ok();
        let screen = Plane::new(reached, -inside(pixel)?.direction);
        let (u, v) = screen.normal.tangents();
        let passes = |right: f64, down: f64| {
            let ray = inside(Pixel::new(pixel.u + right, pixel.v + down))?;
            let off = ray.at(screen.distance_along(&ray)?) - reached;
            Some(Vector2::new(off.dot(&u), off.dot(&v)))
        };
        let along = |right: f64, down: f64| {
            let way = passes(right * STEP, down * STEP)? - passes(-right * STEP, -down * STEP)?;
            Some(way / (2.0 * STEP))
        };
        let per_px = Matrix2::from_columns(&[along(1.0, 0.0)?, along(0.0, 1.0)?]);
        Some((per_px.try_inverse()? * passes(0.0, 0.0)?).norm())
    }
}
