//! Coordinate frames as types: a point of the camera and a point of the world cannot be mixed up.

use std::marker::PhantomData;
use std::ops::{Add, Mul, Neg, Sub};

use nalgebra::{SVector, Vector3};

/// A right-handed coordinate frame, millimetres.
pub trait Frame: Copy + PartialEq + std::fmt::Debug + Send + Sync + 'static {}

/// The camera: x right, y down, z forward, origin at the centre of projection (as in OpenCV).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Camera;

/// The manipulator's hand, to which camera and laser are bolted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flange;

/// The frame in which vessel and object rest and in which results are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct World;

impl Frame for Camera {}
impl Frame for Flange {}
impl Frame for World {}

/// A point in frame `F`, millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<F: Frame> {
    /// The coordinates in `F`.
    pub coords: Vector3<f64>,
    frame: PhantomData<F>,
}

impl<F: Frame> Point<F> {
    /// The point at `(x, y, z)`.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self::from_coords(Vector3::new(x, y, z))
    }

    /// The frame's origin.
    pub const fn origin() -> Self {
        Self::new(0.0, 0.0, 0.0)
    }

    /// The point with the given coordinates.
    pub const fn from_coords(coords: Vector3<f64>) -> Self {
        Self {
            coords,
            frame: PhantomData,
        }
    }

    /// The point halfway to `other`.
    pub fn midpoint(self, other: Self) -> Self {
        Self::from_coords((self.coords + other.coords) * 0.5)
    }

    /// The distance to `other`.
    pub fn distance(self, other: Self) -> f64 {
        length(&(self - other))
    }

    /// `[x, y, z]`, as files carry it.
    pub fn to_array(self) -> [f64; 3] {
        self.coords.into()
    }
}

impl<F: Frame> From<[f64; 3]> for Point<F> {
    fn from(xyz: [f64; 3]) -> Self {
        Self::from_coords(xyz.into())
    }
}

impl<F: Frame> Sub for Point<F> {
    type Output = Vector3<f64>;

    fn sub(self, other: Self) -> Vector3<f64> {
        self.coords - other.coords
    }
}

impl<F: Frame> Add<Vector3<f64>> for Point<F> {
    type Output = Self;

    fn add(self, displacement: Vector3<f64>) -> Self {
        Self::from_coords(self.coords + displacement)
    }
}

/// A unit vector in frame `F`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction<F: Frame> {
    vector: Vector3<f64>,
    frame: PhantomData<F>,
}

/// A vector's length. To the last bit it is what nalgebra's `norm` gives, but that takes the square root step by step
/// (libm's, in WebAssembly), where every processor has an instruction for it.
pub(crate) fn length<const N: usize>(vector: &SVector<f64, N>) -> f64 {
    vector.norm_squared().sqrt()
}

/// A vector's direction, for vectors that have one; likewise as nalgebra's `normalize`.
pub(crate) fn unit<const N: usize>(vector: SVector<f64, N>) -> SVector<f64, N> {
    vector / length(&vector)
}

/// A vector of length zero (or one that is not a number) has no direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a vector of length zero has no direction")]
pub struct ZeroLength;

impl<F: Frame> Direction<F> {
    /// The direction of `vector`, whatever its length.
    pub fn new(vector: Vector3<f64>) -> Result<Self, ZeroLength> {
        let length = length(&vector);
        if length > 0.0 && length.is_finite() {
            Ok(Self::assume_unit(vector / length))
        } else {
            Err(ZeroLength)
        }
    }

    /// Takes a vector that is of unit length by construction.
    pub(crate) const fn assume_unit(vector: Vector3<f64>) -> Self {
        Self {
            vector,
            frame: PhantomData,
        }
    }

    /// The unit vector.
    pub const fn vector(self) -> Vector3<f64> {
        self.vector
    }

    /// The cosine of the angle to `other`.
    pub fn dot(self, other: Self) -> f64 {
        self.vector.dot(&other.vector)
    }

    /// Two unit vectors that make a right-handed orthogonal triad `(u, v, self)`.
    pub fn tangents(self) -> (Vector3<f64>, Vector3<f64>) {
        let smallest = self.vector.iamin();
        let mut axis = Vector3::zeros();
        axis[smallest] = 1.0;
        let u = unit(axis.cross(&self.vector));
        (u, self.vector.cross(&u))
    }

    /// This direction tilted by the small angles `a`, `b` (radians) towards its two tangents.
    pub fn tilted(self, a: f64, b: f64) -> Self {
        let (u, v) = self.tangents();
        Self::assume_unit(unit(self.vector + u * a + v * b))
    }
}

impl<F: Frame> Neg for Direction<F> {
    type Output = Self;

    fn neg(self) -> Self {
        Self::assume_unit(-self.vector)
    }
}

impl<F: Frame> Mul<f64> for Direction<F> {
    type Output = Vector3<f64>;

    fn mul(self, length: f64) -> Vector3<f64> {
        self.vector * length
    }
}
