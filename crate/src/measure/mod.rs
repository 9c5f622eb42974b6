//! Measuring on the object: lengths, angles, radii and flatness, each with its standard deviation from the
//! noise of its points. Errors of calibration and index are common to all points and come on top.

mod cylinder;
mod plane;
mod sphere;

pub use cylinder::cylinder_radius;
pub use plane::{flatness, plane_angle};
pub use sphere::sphere_radius;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::{FitError, Point, World};

/// A point to measure with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Where it is, mm.
    pub point: Point<World>,
    /// Its covariance, mm^2.
    pub covariance: Matrix3<f64>,
}

impl Sample {
    /// A point with its covariance xx, xy, xz, yy, yz, zz, mm^2.
    pub fn new(place: [f64; 3], [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Self {
        Self {
            point: place.into(),
            covariance: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }

    /// One standard deviation along a unit vector, mm; never 0, as a weight divides by it.
    fn sigma_along(&self, axis: Vector3<f64>) -> f64 {
        const LEAST: f64 = 1e-6;
        axis.dot(&(self.covariance * axis))
            .max(0.0)
            .sqrt()
            .max(LEAST)
    }
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value: mm or radians.
    pub value: f64,
    /// One standard deviation, in the same unit.
    pub sigma: f64,
}

/// Why something cannot be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// No plane goes through the points.
    #[error(transparent)]
    Plane(#[from] FitError),
    /// A sphere or a cylinder needs more points.
    #[error("{found} points, and at least {needed} are needed")]
    TooFewPoints {
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// The points lie too flat for a radius.
    #[error("the points do not determine a radius: they lie on a plane to within their noise")]
    NoRadius,
}

/// The distance d of two points; with u the unit vector from one to the other,
///
/// ```text
/// sigma^2 = u^T (C_a + C_b) u
/// ```
pub fn distance(a: &Sample, b: &Sample) -> Measured {
    let way = b.point - a.point;
    let value = way.norm();
    // Where the points fall together any direction is as good.
    let axis = way.try_normalize(0.0).unwrap_or_else(Vector3::x);
    let (a, b) = (a.sigma_along(axis), b.sigma_along(axis));
    Measured {
        value,
        sigma: (a * a + b * b).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_is_as_uncertain_as_its_ends_along_it() {
        let at = |x: f64| Sample {
            point: Point::new(x, 2.0, -1.0),
            covariance: Matrix3::from_diagonal(&Vector3::new(0.09, 25.0, 25.0)),
        };
        let measured = distance(&at(1.0), &at(4.0));
        assert!((measured.value - 3.0).abs() < 1e-12);
        assert!((measured.sigma - 0.18_f64.sqrt()).abs() < 1e-12);
    }
}
