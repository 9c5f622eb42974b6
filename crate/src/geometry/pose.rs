use std::marker::PhantomData;
use std::ops::Mul;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::{Direction, Frame, Point, Ray, ZeroLength};

/// A rigid motion that maps coordinates in `B` to coordinates in `A`: name it `a_from_b`.
///
/// ```
/// use snellius::geometry::{Camera, Flange, Point, Pose, World};
///
/// let world_from_flange = Pose::<World, Flange>::new([1.0, 0.0, 0.0, 0.0], [10.0, 0.0, 0.0])?;
/// let flange_from_camera = Pose::<Flange, Camera>::new([0.0, 0.0, 0.0, 1.0], [0.0, 5.0, 0.0])?;
/// let world_from_camera = world_from_flange * flange_from_camera;
/// assert_eq!(world_from_camera.point(Point::new(1.0, 0.0, 0.0)), Point::new(9.0, 5.0, 0.0));
/// # Ok::<(), snellius::geometry::ZeroLength>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<A: Frame, B: Frame> {
    rotation: UnitQuaternion<f64>,
    translation: Vector3<f64>,
    frames: PhantomData<(A, B)>,
}

impl<A: Frame, B: Frame> Pose<A, B> {
    /// From a quaternion `[w, x, y, z]` of any length but zero and a translation in millimetres.
    pub fn new(rotation: [f64; 4], translation: [f64; 3]) -> Result<Self, ZeroLength> {
        let [w, x, y, z] = rotation;
        let quaternion = Quaternion::new(w, x, y, z);
        let norm = quaternion.norm();
        if !(norm > 0.0 && norm.is_finite()) {
            return Err(ZeroLength);
        }
        Ok(Self::from_parts(
            UnitQuaternion::new_normalize(quaternion),
            translation.into(),
        ))
    }

    /// From a rotation and a translation.
    pub const fn from_parts(rotation: UnitQuaternion<f64>, translation: Vector3<f64>) -> Self {
        Self {
            rotation,
            translation,
            frames: PhantomData,
        }
    }

    /// The pose that changes nothing.
    pub fn identity() -> Self {
        Self::from_parts(UnitQuaternion::identity(), Vector3::zeros())
    }

    /// The rotation, A from B.
    pub const fn rotation(&self) -> UnitQuaternion<f64> {
        self.rotation
    }

    /// The origin of `B` in `A`, millimetres.
    pub const fn translation(&self) -> Vector3<f64> {
        self.translation
    }

    /// `[w, x, y, z]`, as files carry it.
    pub fn quaternion(&self) -> [f64; 4] {
        [
            self.rotation.w,
            self.rotation.i,
            self.rotation.j,
            self.rotation.k,
        ]
    }

    /// The same motion read the other way.
    pub fn inverse(&self) -> Pose<B, A> {
        let rotation = self.rotation.inverse();
        Pose::from_parts(rotation, -(rotation * self.translation))
    }

    /// Maps a point.
    pub fn point(&self, point: Point<B>) -> Point<A> {
        Point::from_coords(self.rotation * point.coords + self.translation)
    }

    /// Maps a direction.
    pub fn direction(&self, direction: Direction<B>) -> Direction<A> {
        Direction::assume_unit(self.rotation * direction.vector())
    }

    /// Maps a ray.
    pub fn ray(&self, ray: &Ray<B>) -> Ray<A> {
        Ray::new(self.point(ray.origin), self.direction(ray.direction))
    }

    /// This pose followed, on the `B` side, by a small rotation vector (radians) and a shift (mm).
    pub fn nudged(&self, rotation: Vector3<f64>, shift: Vector3<f64>) -> Self {
        Self::from_parts(
            self.rotation * UnitQuaternion::from_scaled_axis(rotation),
            self.translation + self.rotation * shift,
        )
    }
}

impl<A: Frame, B: Frame, C: Frame> Mul<Pose<B, C>> for Pose<A, B> {
    type Output = Pose<A, C>;

    fn mul(self, other: Pose<B, C>) -> Pose<A, C> {
        Pose::from_parts(
            self.rotation * other.rotation,
            self.rotation * other.translation + self.translation,
        )
    }
}
