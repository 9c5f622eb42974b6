use nalgebra::{DMatrix, DVector, Matrix4, Vector3, Vector4};

use super::{MeasureError, Measured, Sample};

/// The radius of the sphere through points, mm.
///
/// A linear start from `|p|^2 = 2 c . p + k`, then the least squares of `(|p - c| - r) / sigma` by Gauss
/// and Newton; the standard deviation is that of the fit, scaled up where the residuals are larger than
/// the points' noise.
pub fn sphere_radius(samples: &[Sample]) -> Result<Measured, MeasureError> {
    const STEPS: usize = 50;
    if samples.len() < 4 {
        return Err(MeasureError::TooFewPoints {
            found: samples.len(),
            needed: 4,
        });
    }
    let mut ball = start(samples)?;
    let mut information = Matrix4::zeros();
    for _ in 0..STEPS {
        let (normal_matrix, gradient) = normal_equations(samples, &ball);
        information = normal_matrix;
        let step = information.lu().solve(&gradient);
        let step = step.ok_or(MeasureError::NoRadius)?;
        ball.centre += Vector3::new(step[0], step[1], step[2]);
        ball.radius += step[3];
        if step.norm() < 1e-10 {
            break;
        }
    }
    let freedom = (samples.len() - 4).max(1) as f64;
    let residuals = samples.iter().map(|sample| residual(sample, &ball));
    let chi: f64 = residuals.map(|r| r * r).sum();
    let covariance = information.try_inverse().ok_or(MeasureError::NoRadius)?;
    let sigma = (covariance[(3, 3)] * (chi / freedom).max(1.0)).sqrt();
    if ball.radius > 0.0 && sigma < ball.radius {
        Ok(Measured {
            value: ball.radius,
            sigma,
        })
    } else {
        Err(MeasureError::NoRadius)
    }
}

struct Ball {
    centre: Vector3<f64>,
    radius: f64,
}

fn start(samples: &[Sample]) -> Result<Ball, MeasureError> {
    let count = samples.len() as f64;
    let middle = samples.iter().map(|s| s.point.coords).sum::<Vector3<f64>>() / count;
    let places = || samples.iter().map(|s| s.point.coords - middle);
    let rows: Vec<f64> = places()
        .flat_map(|p| [2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0])
        .collect();
    let rows = DMatrix::from_row_slice(samples.len(), 4, &rows);
    let squares = DVector::from_iterator(samples.len(), places().map(|p| p.norm_squared()));
    let solved = (rows.transpose() * &rows)
        .lu()
        .solve(&(rows.transpose() * squares));
    let solved = solved.ok_or(MeasureError::NoRadius)?;
    let centre = Vector3::new(solved[0], solved[1], solved[2]);
    let square = solved[3] + centre.norm_squared();
    if !(square > 0.0 && square.is_finite()) {
        return Err(MeasureError::NoRadius);
    }
    Ok(Ball {
        centre: centre + middle,
        radius: square.sqrt(),
    })
}

/// Distance from the sphere in standard deviations.
fn residual(sample: &Sample, ball: &Ball) -> f64 {
    let out = sample.point.coords - ball.centre;
    let outwards = out.try_normalize(0.0).unwrap_or_else(Vector3::x);
    (out.norm() - ball.radius) / sample.sigma_along(outwards)
}

fn normal_equations(samples: &[Sample], ball: &Ball) -> (Matrix4<f64>, Vector4<f64>) {
    let mut information = Matrix4::zeros();
    let mut gradient = Vector4::zeros();
    for sample in samples {
        let out = sample.point.coords - ball.centre;
        let outwards = out.try_normalize(0.0).unwrap_or_else(Vector3::x);
        let sigma = sample.sigma_along(outwards);
        // How centre and radius take the residual away.
        let row = Vector4::new(outwards.x, outwards.y, outwards.z, 1.0) / sigma;
        information += row * row.transpose();
        gradient += row * residual(sample, ball);
    }
    (information, gradient)
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::geometry::Point;

    /// Points of a cap of a sphere of 27 mm about (3, -2, 90), as a rig sees a ball.
    fn cap(wobble: f64) -> Vec<Sample> {
        let place = |i: i32| {
            let turn = f64::from(i) * 2.399963;
            let fall = 0.9 * (f64::from(i) / 60.0).sqrt();
            let outwards = Vector3::new(
                libm::sin(fall) * libm::cos(turn),
                libm::sin(fall) * libm::sin(turn),
                -libm::cos(fall),
            );
            let off = wobble * f64::from(i % 3 - 1);
            Point::from_coords(Vector3::new(3.0, -2.0, 90.0) + outwards * (27.0 + off))
        };
        (0..60)
            .map(|i| Sample {
                point: place(i),
                covariance: Matrix3::identity() * 0.0025,
            })
            .collect()
    }

    #[test]
    fn a_ball_has_its_radius() {
        let exact = sphere_radius(&cap(0.0)).unwrap();
        assert!((exact.value - 27.0).abs() < 1e-8);
        let noisy = sphere_radius(&cap(0.05)).unwrap();
        assert!((noisy.value - 27.0).abs() < 2.0 * noisy.sigma, "{noisy:?}");
    }

    #[test]
    fn a_flat_face_has_none() {
        let flat: Vec<Sample> = (0..25)
            .map(|i| Sample {
                point: Point::new(f64::from(i % 5), f64::from(i / 5), 0.01 * f64::from(i % 2)),
                covariance: Matrix3::identity() * 0.01,
            })
            .collect();
        assert_eq!(sphere_radius(&flat), Err(MeasureError::NoRadius));
        assert_eq!(
            sphere_radius(&flat[..3]),
            Err(MeasureError::TooFewPoints {
                found: 3,
                needed: 4
            })
        );
    }
}
