//! A wall that the manifest knows beforehand.

use super::check::positive;
use super::{Place, ScanError, VesselEntry, VesselShape};
use crate::geometry::{Direction, Plane, Point, World};
use crate::optics::{Cylinder, Sphere, Surface};

/// The outer face that a vessel entry states, if it states one; every key it needs must be there.
pub(super) fn of(vessel: &VesselEntry) -> Result<Option<Surface>, ScanError> {
    match vessel.shape {
        VesselShape::Plane if vessel.point.is_some() || vessel.normal.is_some() => {
            let point = needed(vessel.point, "point", "a plane")?;
            let normal = direction(vessel.normal, "normal", "a plane")?;
            Ok(Some(Surface::Plane(Plane::new(point.into(), normal))))
        }
        VesselShape::Cylinder if vessel.axis_point.is_some() || vessel.axis.is_some() => {
            Ok(Some(Surface::Cylinder(Cylinder {
                point: Point::from(needed(vessel.axis_point, "axis_point", "a cylinder")?),
                axis: direction(vessel.axis, "axis", "a cylinder")?,
                radius: radius(vessel, "a cylinder")?,
            })))
        }
        VesselShape::Sphere if vessel.center.is_some() => Ok(Some(Surface::Sphere(Sphere {
            centre: Point::from(needed(vessel.center, "center", "a sphere")?),
            radius: radius(vessel, "a sphere")?,
        }))),
        _ => Ok(None),
    }
}

fn radius(vessel: &VesselEntry, what: &str) -> Result<f64, ScanError> {
    let radius = needed(vessel.radius, "radius", what)?;
    positive(radius, "vessel.radius")?;
    if radius <= vessel.wall_thickness {
        return Err(ScanError::value(
            Place::key("vessel.wall_thickness"),
            format!(
                "{} mm is more than the vessel's radius, {radius} mm",
                vessel.wall_thickness
            ),
        ));
    }
    Ok(radius)
}

fn direction(
    vector: Option<[f64; 3]>,
    key: &str,
    what: &str,
) -> Result<Direction<World>, ScanError> {
    Direction::new(needed(vector, key, what)?.into())
        .map_err(|e| ScanError::value(Place::key(format!("vessel.{key}")), e.to_string()))
}

fn needed<T>(value: Option<T>, key: &str, what: &str) -> Result<T, ScanError> {
    value.ok_or_else(|| {
        ScanError::value(
            Place::key(format!("vessel.{key}")),
            format!("missing; {what} that is known beforehand needs it"),
        )
    })
}
