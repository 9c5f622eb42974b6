//! What the tests share: seeded random numbers, a small scene, and archives taken apart and put together.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each test file uses its own part"
)]
#![allow(
    clippy::disallowed_methods,
    reason = "a test's expectations may come from the platform"
)]

#[cfg(feature = "simulate")]
pub mod archives;
pub mod errors;
pub mod pictures;
#[cfg(feature = "simulate")]
pub mod synthetic;
#[cfg(feature = "simulate")]
pub mod walls;

use nalgebra::{UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use snellius::camera::{Distortion, Intrinsics, Pixel};
use snellius::geometry::{Camera, Direction, Frame, Plane, Point, Pose, Ray, World};
use snellius::optics::{Interface, Stack, Surface};

/// Random numbers that are the same in every run.
pub struct Random(ChaCha8Rng);

impl Random {
    pub fn seeded(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// Mean 0, standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    pub fn vector(&mut self, half: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-half, half))
    }

    /// Anywhere on the unit sphere.
    pub fn direction<F: Frame>(&mut self) -> Direction<F> {
        direction(Vector3::from_fn(|_, _| self.normal()))
    }

    /// Within `degrees` of the z axis.
    pub fn forward<F: Frame>(&mut self, degrees: f64) -> Direction<F> {
        let (tilt, turn) = (
            self.between(0.0, degrees.to_radians()),
            self.between(0.0, std::f64::consts::TAU),
        );
        direction(Vector3::new(
            tilt.sin() * turn.cos(),
            tilt.sin() * turn.sin(),
            tilt.cos(),
        ))
    }

    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector(2.0))
    }

    pub fn pose<A: Frame, B: Frame>(&mut self) -> Pose<A, B> {
        Pose::from_parts(self.rotation(), self.vector(300.0))
    }
}

pub fn direction<F: Frame>(vector: impl Into<Vector3<f64>>) -> Direction<F> {
    Direction::new(vector.into()).expect("a vector with a length")
}

/// A face across `normal` (which points towards the rig) through `point`.
pub fn face(point: [f64; 3], normal: impl Into<Vector3<f64>>, index_behind: f64) -> Interface {
    Interface {
        surface: Surface::Plane(Plane::new(Point::from(point), direction(normal))),
        index_behind,
    }
}

/// Parallel layers before and behind z = 0; the rig looks along +z. `layers`: thickness and index of
/// every medium behind the first face, the last one without end.
pub fn parallel_layers(outside: f64, layers: &[(f64, f64)]) -> Stack {
    let mut depth = 0.0;
    let interfaces = layers.iter().map(|(thickness, index)| {
        let interface = face([0.0, 0.0, depth], [0.0, 0.0, -1.0], *index);
        depth += thickness;
        interface
    });
    Stack {
        outside,
        interfaces: interfaces.collect(),
    }
}

/// A lens with the distortion of the development scans.
pub fn lens() -> Intrinsics {
    Intrinsics {
        width: 800,
        height: 600,
        focal: [1102.5, 1101.8],
        centre: Pixel::new(403.2, 296.4),
        distortion: Distortion::from_opencv(&[-0.112, 0.061, 0.0006, -0.0004, 0.0]).unwrap(),
    }
}

pub fn ray<F: Frame>(origin: [f64; 3], along: impl Into<Vector3<f64>>) -> Ray<F> {
    Ray::new(Point::from(origin), direction(along))
}

/// The distance of a point from the line that carries a ray.
pub fn off_line(point: Point<World>, ray: &Ray<World>) -> f64 {
    (point - ray.origin).cross(&ray.direction.vector()).norm()
}

pub type SeenFrom = Pose<World, Camera>;

#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(
        off <= tolerance,
        "{found} should be {expected}: {off:.3e} off, {tolerance:.0e} allowed"
    );
}
