use nalgebra::DVector;

use super::Freeform;
use crate::geometry::{Direction, Plane, Point, Ray, World, length};

/// A surface that parts two media.
///
/// To add a shape: give it a variant here and a line in each method below, a start for its fit in the
/// `vessel` room, and a line in each of the tests that every shape passes.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// A flat face; its normal points towards the rig.
    Plane(Plane<World>),
    /// A round face seen from outside; its normals point away from the axis.
    Cylinder(Cylinder),
    /// A ball's face seen from outside; its normals point away from the centre.
    Sphere(Sphere),
    /// Any smooth face, within the patch in which it was measured.
    Freeform(Freeform),
}

/// A circular cylinder without end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// A point of the axis.
    pub point: Point<World>,
    /// Along the axis.
    pub axis: Direction<World>,
    /// Millimetres.
    pub radius: f64,
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle.
    pub centre: Point<World>,
    /// Millimetres.
    pub radius: f64,
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
        let distance = match self {
            Self::Plane(plane) if ray.direction.dot(plane.normal) < 0.0 => {
                plane.distance_along(ray)?
            }
            Self::Plane(_) => return None,
            Self::Cylinder(cylinder) => cylinder.distance_along(ray)?,
            Self::Sphere(sphere) => sphere.distance_along(ray)?,
            Self::Freeform(freeform) => return freeform.hit(ray),
        };
        if distance.is_nan() || distance < -TOUCHING {
            return None;
        }
        let point = ray.at(distance);
        Some(Hit {
            point,
            normal: self.normal_at(point)?,
            distance,
        })
    }

    /// The unit normal towards the rig at a point of the surface; `None` on an axis or in a centre.
    pub fn normal_at(&self, point: Point<World>) -> Option<Direction<World>> {
        match self {
            Self::Plane(plane) => Some(plane.normal),
            Self::Cylinder(cylinder) => Direction::new(cylinder.away_from_axis(point)).ok(),
            Self::Sphere(sphere) => Direction::new(point - sphere.centre).ok(),
            Self::Freeform(freeform) => Some(freeform.normal_at(point)),
        }
    }

    /// The surface a `distance` behind this one along its normals, away from the rig: a wall's inner
    /// face from its outer one. `None` where a round surface has no room for it.
    pub fn behind(&self, distance: f64) -> Option<Self> {
        let smaller = |radius: f64| Some(radius - distance).filter(|r| *r > 0.0);
        Some(match self {
            Self::Plane(plane) => Self::Plane(plane.offset(-distance)),
            Self::Cylinder(cylinder) => Self::Cylinder(Cylinder {
                radius: smaller(cylinder.radius)?,
                ..*cylinder
            }),
            Self::Sphere(sphere) => Self::Sphere(Sphere {
                radius: smaller(sphere.radius)?,
                ..*sphere
            }),
            Self::Freeform(freeform) => Self::Freeform(freeform.behind(distance)?),
        })
    }

    /// How far in front of the surface (towards the rig) a point lies, mm.
    pub fn signed_distance(&self, point: Point<World>) -> f64 {
        match self {
            Self::Plane(plane) => plane.signed_distance(point),
            Self::Cylinder(cylinder) => length(&cylinder.away_from_axis(point)) - cylinder.radius,
            Self::Sphere(sphere) => length(&(point - sphere.centre)) - sphere.radius,
            Self::Freeform(freeform) => freeform.signed_distance(point),
        }
    }

    /// How many numbers move the surface: the length of what [`Surface::nudged`] takes.
    pub fn freedom(&self) -> usize {
        match self {
            Self::Plane(_) => 3,
            Self::Cylinder(_) => 5,
            Self::Sphere(_) => 4,
            Self::Freeform(freeform) => freeform.sheet().heights.len(),
        }
    }

    /// Which of these numbers move the surface at some points of it.
    pub fn movers(&self, points: &[Point<World>]) -> Vec<usize> {
        let Self::Freeform(freeform) = self else {
            return (0..self.freedom()).collect();
        };
        let mut movers: Vec<usize> = points
            .iter()
            .flat_map(|point| freeform.support_at(*point))
            .collect();
        movers.sort_unstable();
        movers.dedup();
        movers
    }

    /// The surface moved by a small step in its own parameters.
    ///
    /// * A plane: tilts towards its normal's two tangents (radians) about its point, a shift along the
    ///   normal (mm).
    /// * A cylinder: tilts of the axis towards its two tangents (radians) about its point, shifts along
    ///   these tangents (mm), the radius (mm).
    /// * A sphere: shifts along x, y and z (mm), the radius (mm).
    /// * A free form: its control points' heights (mm).
    pub fn nudged(&self, step: &DVector<f64>) -> Self {
        match self {
            Self::Plane(plane) => Self::Plane(Plane::new(
                plane.point + plane.normal * step[2],
                plane.normal.tilted(step[0], step[1]),
            )),
            Self::Cylinder(cylinder) => {
                let (u, v) = cylinder.axis.tangents();
                Self::Cylinder(Cylinder {
                    point: cylinder.point + (u * step[2] + v * step[3]),
                    axis: cylinder.axis.tilted(step[0], step[1]),
                    radius: cylinder.radius + step[4],
                })
            }
            Self::Sphere(sphere) => Self::Sphere(Sphere {
                centre: sphere.centre + step.fixed_rows::<3>(0).into_owned(),
                radius: sphere.radius + step[3],
            }),
            Self::Freeform(freeform) => Self::Freeform(freeform.raised(step.iter().copied())),
        }
    }
}

impl Cylinder {
    /// From the nearest point of the axis to a point.
    fn away_from_axis(&self, point: Point<World>) -> nalgebra::Vector3<f64> {
        across(point - self.point, self.axis)
    }

    fn distance_along(&self, ray: &Ray<World>) -> Option<f64> {
        let along = across(ray.direction.vector(), self.axis);
        nearer_root(self.away_from_axis(ray.origin), along, self.radius)
    }
}

impl Sphere {
    fn distance_along(&self, ray: &Ray<World>) -> Option<f64> {
        nearer_root(
            ray.origin - self.centre,
            ray.direction.vector(),
            self.radius,
        )
    }
}

/// The part of a vector across an axis.
fn across(vector: nalgebra::Vector3<f64>, axis: Direction<World>) -> nalgebra::Vector3<f64> {
    vector - axis * vector.dot(&axis.vector())
}

/// The smaller t with |origin + t along| = radius: where a ray from outside goes in.
fn nearer_root(
    origin: nalgebra::Vector3<f64>,
    along: nalgebra::Vector3<f64>,
    radius: f64,
) -> Option<f64> {
    let a = along.norm_squared();
    let half = origin.dot(&along);
    let c = origin.norm_squared() - radius * radius;
    let discriminant = half * half - a * c;
    if half >= 0.0 || discriminant < 0.0 {
        return None;
    }
    // c over the larger root's numerator: no cancellation where the origin lies on the surface.
    Some(c / (discriminant.sqrt() - half))
}
