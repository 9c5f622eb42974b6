use nalgebra::{UnitQuaternion, Vector3};

use super::{SceneError, SceneObject, rotation_from_degrees};
use crate::geometry::{Direction, Point, Ray, World};

/// A solid that light lands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A box.
    Box {
        /// Its middle.
        centre: Point<World>,
        /// Half its edges, mm.
        half: Vector3<f64>,
        /// World from box.
        rotation: UnitQuaternion<f64>,
    },
    /// A ball.
    Sphere {
        /// Its middle.
        centre: Point<World>,
        /// Millimetres.
        radius: f64,
    },
}

/// Where light lands on a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landed {
    /// How far along the ray, mm.
    pub distance: f64,
    /// The place.
    pub point: Point<World>,
    /// The outward unit normal.
    pub normal: Direction<World>,
}

impl Solid {
    pub(super) fn new(object: &SceneObject) -> Result<Self, SceneError> {
        let size = |value: f64, key| {
            let problem = "must be greater than 0";
            if value > 0.0 {
                Ok(())
            } else {
                Err(SceneError::Value { key, problem })
            }
        };
        match *object {
            SceneObject::Box {
                centre,
                half,
                rotation,
            } => {
                half.iter().try_for_each(|h| size(*h, "object.half"))?;
                Ok(Self::Box {
                    centre: centre.into(),
                    half: half.into(),
                    rotation: rotation_from_degrees(rotation),
                })
            }
            SceneObject::Sphere { centre, radius } => {
                size(radius, "object.radius")?;
                Ok(Self::Sphere {
                    centre: centre.into(),
                    radius,
                })
            }
        }
    }

    /// Where a ray from outside first meets the solid.
    pub fn hit(&self, ray: &Ray<World>) -> Option<Landed> {
        match self {
            Self::Box {
                centre,
                half,
                rotation,
            } => hit_box(*centre, *half, *rotation, ray),
            Self::Sphere { centre, radius } => hit_sphere(*centre, *radius, ray),
        }
    }
}

/// The first solid that a ray meets.
pub(super) fn nearest(solids: &[Solid], ray: &Ray<World>) -> Option<Landed> {
    let hits = solids.iter().filter_map(|solid| solid.hit(ray));
    hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// The box as the overlap of three slabs.
fn hit_box(
    centre: Point<World>,
    half: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    ray: &Ray<World>,
) -> Option<Landed> {
    let origin = rotation.inverse() * (ray.origin - centre);
    let along = rotation.inverse() * ray.direction.vector();
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut face = Vector3::zeros();
    for axis in 0..3 {
        let near = (-half[axis] * along[axis].signum() - origin[axis]) / along[axis];
        let far = (half[axis] * along[axis].signum() - origin[axis]) / along[axis];
        if near > enter {
            enter = near;
            face = Vector3::zeros();
            face[axis] = -along[axis].signum();
        }
        leave = leave.min(far);
    }
    (enter > 0.0 && enter <= leave).then(|| Landed {
        distance: enter,
        point: ray.at(enter),
        normal: Direction::assume_unit(rotation * face),
    })
}

fn hit_sphere(centre: Point<World>, radius: f64, ray: &Ray<World>) -> Option<Landed> {
    let to_ray = ray.origin - centre;
    let half = to_ray.dot(&ray.direction.vector());
    let discriminant = half * half - to_ray.norm_squared() + radius * radius;
    if discriminant < 0.0 {
        return None;
    }
    let distance = -half - discriminant.sqrt();
    let point = ray.at(distance);
    (distance > 0.0).then(|| Landed {
        distance,
        point,
        normal: Direction::assume_unit((point - centre) / radius),
    })
}
