use nalgebra::DVector;

use crate::geometry::{Direction, Plane, Point, Ray, World};

/// A surface that parts two media.
///
/// To add a shape: give it a variant here, `hit`, `offset` and `nudged`, a fit in the `vessel` room,
/// and a line in each of the tests that every shape passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// A flat face; its normal points towards the rig.
    Plane(Plane<World>),
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The place.
    pub point: Point<World>,
    /// The unit normal there, towards the rig.
    pub normal: Direction<World>,
    /// How far along the ray, mm.
    pub distance: f64,
}

/// A face this close behind the ray's origin (mm) still counts as met: the origin lies on the face
/// before, and two faces may touch.
const TOUCHING: f64 = 1e-9;

impl Surface {
    /// Where `ray` first meets the surface from its front, if it does.
    pub fn hit(&self, ray: &Ray<World>) -> Option<Hit> {
        match self {
            Self::Plane(plane) => {
                if ray.direction.dot(plane.normal) >= 0.0 {
                    return None;
                }
                let distance = plane.distance_along(ray).filter(|d| *d >= -TOUCHING)?;
                Some(Hit {
                    point: ray.at(distance),
                    normal: plane.normal,
                    distance,
                })
            }
        }
    }

    /// The surface a `distance` behind this one along its normals, away from the rig: a wall's inner
    /// face from its outer one.
    pub fn behind(&self, distance: f64) -> Self {
        match self {
            Self::Plane(plane) => Self::Plane(plane.offset(-distance)),
        }
    }

    /// How far in front of the surface (towards the rig) a point lies, mm.
    pub fn signed_distance(&self, point: Point<World>) -> f64 {
        match self {
            Self::Plane(plane) => plane.signed_distance(point),
        }
    }

    /// How many numbers move the surface: the length of what [`Surface::nudged`] takes.
    pub const fn freedom(&self) -> usize {
        match self {
            Self::Plane(_) => 3,
        }
    }

    /// The surface moved by a small step in its own parameters.
    ///
    /// A plane: tilts towards its normal's two tangents (radians) about its point, then a shift along
    /// the normal (mm).
    pub fn nudged(&self, step: &DVector<f64>) -> Self {
        match self {
            Self::Plane(plane) => Self::Plane(Plane::new(
                plane.point + plane.normal * step[2],
                plane.normal.tilted(step[0], step[1]),
            )),
        }
    }
}
