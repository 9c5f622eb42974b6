use nalgebra::Vector2;

use super::{MeasureError, Measured, Sample};
use crate::geometry::{PlaneFit, Point, WeightedPoint, World, fit_plane};

/// How flat the points lie: the root mean square of their distances from the plane through them, mm.
///
/// Its standard deviation is that of a root mean square of n - 3 free values: `rms / sqrt(2 (n - 3))`.
pub fn flatness(samples: &[Sample]) -> Result<Measured, MeasureError> {
    let fit = plane(samples)?;
    let squares = samples.iter().map(|sample| {
        let off = fit.plane.signed_distance(sample.point);
        off * off
    });
    // Three of the values go into the plane.
    let freedom = samples.len().saturating_sub(3).max(1) as f64;
    let rms = (squares.sum::<f64>() / freedom).sqrt();
    Ok(Measured {
        value: rms,
        sigma: rms / (2.0 * freedom).sqrt(),
    })
}

/// The angle at which the planes through two sets of points meet, radians, at most a right angle.
///
/// With n, m the unit normals, `cos phi = |n . m|`. A tilt of n by a small a towards its tangent t changes
/// phi by `a t . m / sin phi`; the tilts' covariances are those of the fits.
pub fn plane_angle(one: &[Sample], other: &[Sample]) -> Result<Measured, MeasureError> {
    let (one, other) = (plane(one)?, plane(other)?);
    let cosine = one.plane.normal.dot(other.plane.normal).abs().min(1.0);
    let variance = tilt_towards(&one, &other) + tilt_towards(&other, &one);
    Ok(Measured {
        value: libm::acos(cosine),
        sigma: variance.sqrt(),
    })
}

/// Variance of a plane's tilt in the direction in which it changes the angle to another.
fn tilt_towards(plane: &PlaneFit<World>, other: &PlaneFit<World>) -> f64 {
    let (u, v) = plane.plane.normal.tangents();
    let towards = other.plane.normal.vector();
    let tilts = plane.covariance.fixed_view::<2, 2>(0, 0).into_owned();
    // Parallel planes tilt apart in any direction.
    let axis = Vector2::new(u.dot(&towards), v.dot(&towards)).try_normalize(1e-9);
    axis.map_or(tilts.trace(), |axis| axis.dot(&(tilts * axis)))
}

/// The plane through samples, each weighted by its noise across it.
fn plane(samples: &[Sample]) -> Result<PlaneFit<World>, MeasureError> {
    let weighted = |sigma: &dyn Fn(&Sample) -> f64| -> Vec<WeightedPoint<World>> {
        let weigh = |sample: &Sample| WeightedPoint {
            point: sample.point,
            sigma: sigma(sample),
        };
        samples.iter().map(weigh).collect()
    };
    // Which way the normal points is of no matter here.
    let front = Point::origin();
    let mean = |s: &Sample| (s.covariance.trace() / 3.0).max(1e-12).sqrt();
    let first = fit_plane(&weighted(&mean), front)?;
    let normal = first.plane.normal.vector();
    Ok(fit_plane(&weighted(&|s| s.sigma_along(normal)), front)?)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    const SIGMA: f64 = 0.05;

    /// A 9 x 9 grid of 5 mm over the plane of two directions, with deterministic noise across it.
    fn face(u: Vector3<f64>, v: Vector3<f64>, seed: u64) -> Vec<Sample> {
        let normal = u.cross(&v).normalize();
        let mut state = seed;
        let mut noise = || {
            // The sum of twelve uniform numbers has a variance of 1.
            let uniform = |state: &mut u64| {
                *state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (*state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform(&mut state)).sum::<f64>() - 6.0
        };
        let places = (0..81).map(|i| (f64::from(i % 9) * 5.0, f64::from(i / 9) * 5.0));
        places
            .map(|(a, b)| Sample {
                point: Point::from_coords(u * a + v * b + normal * (SIGMA * noise())),
                covariance: Matrix3::identity() * (SIGMA * SIGMA),
            })
            .collect()
    }

    #[test]
    fn the_angle_of_two_faces_is_met_to_its_standard_deviation() {
        let angle: f64 = 0.6;
        let turned = Vector3::new(libm::cos(angle), libm::sin(angle), 0.0);
        let mut hits = 0;
        for seed in 0..200 {
            let one = face(Vector3::x(), Vector3::z(), 2 * seed + 1);
            let other = face(turned, Vector3::z(), 2 * seed + 2);
            let measured = plane_angle(&one, &other).unwrap();
            hits += usize::from((measured.value - angle).abs() < 2.0 * measured.sigma);
        }
        assert!((180..=199).contains(&hits), "{hits} of 200 within 2 sigma");
    }

    #[test]
    fn flatness_is_the_points_noise() {
        let measured = flatness(&face(Vector3::x(), Vector3::y(), 7)).unwrap();
        assert!(
            (measured.value - SIGMA).abs() < 3.0 * measured.sigma,
            "{measured:?}"
        );
    }

    #[test]
    fn points_on_a_line_make_no_face() {
        let line: Vec<Sample> = (0..9)
            .map(|i| Sample {
                point: Point::new(f64::from(i), 0.0, 0.0),
                covariance: Matrix3::identity() * 1e-4,
            })
            .collect();
        assert!(matches!(flatness(&line), Err(MeasureError::Plane(_))));
    }
}
