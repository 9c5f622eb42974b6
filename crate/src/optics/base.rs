use nalgebra::{Vector2, Vector3};

use super::{Cylinder, Sphere, Surface};
use crate::geometry::{Direction, Plane, Point, World};

/// The simple surface that a free form's heights stand on, and coordinates on it: lengths (mm) from a
/// point of it along two tangents, around a round one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Where both coordinates are 0.
    pub origin: Point<World>,
    /// The normal there, towards the rig.
    pub normal: Direction<World>,
    /// The tangents there, along which the coordinates are counted. A cylinder's axis runs along the
    /// second one, and a sphere's poles lie that way.
    pub tangents: [Vector3<f64>; 2],
    /// What it is.
    pub shape: BaseShape,
}

/// The shape of a [`Base`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseShape {
    /// Flat.
    Plane,
    /// Round about an axis.
    Cylinder {
        /// Millimetres.
        radius: f64,
    },
    /// Round about a centre.
    Sphere {
        /// Millimetres.
        radius: f64,
    },
}

/// A place of the base, with what its coordinates mean there.
pub(super) struct Spanned {
    /// Along the first coordinate, the second, and across, towards the rig: unit vectors.
    pub(super) axes: [Vector3<f64>; 3],
    /// The point at the height that was asked for.
    pub(super) point: Point<World>,
    /// How far the point at that height moves, along the first two axes, for a step of the coordinates.
    pub(super) stretch: Vector2<f64>,
}

impl Base {
    /// A base on a plane.
    pub fn on_plane(plane: &Plane<World>) -> Self {
        let (u, v) = plane.normal.tangents();
        Self {
            origin: plane.point,
            normal: plane.normal,
            tangents: [u, v],
            shape: BaseShape::Plane,
        }
    }

    /// A base on a cylinder, whose coordinates start where it is nearest to `middle`. `None` for a middle
    /// on the axis.
    pub fn on_cylinder(cylinder: &Cylinder, middle: Point<World>) -> Option<Self> {
        let axis = cylinder.axis.vector();
        let surface = Surface::Cylinder(*cylinder);
        let normal = surface.normal_at(middle)?;
        Some(Self {
            origin: middle + normal * -surface.signed_distance(middle),
            normal,
            tangents: [axis.cross(&normal.vector()), axis],
            shape: BaseShape::Cylinder {
                radius: cylinder.radius,
            },
        })
    }

    /// A base on a sphere, whose coordinates start where it is nearest to `middle`. `None` for a middle in
    /// the centre.
    pub fn on_sphere(sphere: &Sphere, middle: Point<World>) -> Option<Self> {
        let normal = Direction::new(middle - sphere.centre).ok()?;
        let (u, v) = normal.tangents();
        Some(Self {
            origin: sphere.centre + normal * sphere.radius,
            normal,
            tangents: [u, v],
            shape: BaseShape::Sphere {
                radius: sphere.radius,
            },
        })
    }

    /// The simple surface itself.
    pub fn surface(&self) -> Surface {
        let inwards = |radius: f64| self.origin + self.normal * -radius;
        match self.shape {
            BaseShape::Plane => Surface::Plane(Plane::new(self.origin, self.normal)),
            BaseShape::Cylinder { radius } => Surface::Cylinder(Cylinder {
                point: inwards(radius),
                axis: Direction::assume_unit(self.tangents[1]),
                radius,
            }),
            BaseShape::Sphere { radius } => Surface::Sphere(Sphere {
                centre: inwards(radius),
                radius,
            }),
        }
    }

    /// The coordinates of a point's foot on the base, and the point's height over it.
    pub fn place(&self, point: Point<World>) -> (Vector2<f64>, f64) {
        let from = point - self.origin;
        let [x, y] = self.tangents.map(|tangent| from.dot(&tangent));
        let z = from.dot(&self.normal.vector());
        match self.shape {
            BaseShape::Plane => (Vector2::new(x, y), z),
            BaseShape::Cylinder { radius } => {
                let turn = libm::atan2(x, radius + z);
                let height = libm::hypot(x, radius + z) - radius;
                (Vector2::new(radius * turn, y), height)
            }
            BaseShape::Sphere { radius } => {
                let level = libm::hypot(x, radius + z);
                let turn = Vector2::new(libm::atan2(x, radius + z), libm::atan2(y, level));
                (turn * radius, libm::hypot(level, y) - radius)
            }
        }
    }

    /// The point at a height over a place, and the coordinates' axes there.
    pub(super) fn span(&self, place: Vector2<f64>, height: f64) -> Spanned {
        let [u, v] = self.tangents;
        let n = self.normal.vector();
        match self.shape {
            BaseShape::Plane => Spanned {
                axes: [u, v, n],
                point: self.origin + (u * place.x + v * place.y + n * height),
                stretch: Vector2::new(1.0, 1.0),
            },
            BaseShape::Cylinder { radius } => {
                let (sin, cos) = libm::sincos(place.x / radius);
                let out = u * sin + n * cos;
                Spanned {
                    axes: [u * cos - n * sin, v, out],
                    point: self.origin + (v * place.y - n * radius + out * (radius + height)),
                    stretch: Vector2::new(1.0 + height / radius, 1.0),
                }
            }
            BaseShape::Sphere { radius } => {
                let (sin, cos) = libm::sincos(place.x / radius);
                let (rise, level) = libm::sincos(place.y / radius);
                let around = u * sin + n * cos;
                let out = around * level + v * rise;
                let grown = 1.0 + height / radius;
                Spanned {
                    axes: [u * cos - n * sin, v * level - around * rise, out],
                    point: self.origin + (out * (radius + height) - n * radius),
                    stretch: Vector2::new(grown * level, grown),
                }
            }
        }
    }
}
