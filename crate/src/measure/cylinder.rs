use nalgebra::{SMatrix, SVector, Vector3};

use super::{MeasureError, Measured, Sample};
use crate::geometry::{Direction, World};

/// A cylinder has five: two of the axis' direction, two of its place, the radius.
const PARAMETERS: usize = 5;

type Information = SMatrix<f64, PARAMETERS, PARAMETERS>;
type Step = SVector<f64, PARAMETERS>;

/// The radius of the cylinder through points, mm.
///
/// With d the way from a point c of the axis, of direction a, and q = d - (d . a) a, the least squares of
/// `(|q| - r) / sigma` by Gauss and Newton, from the best of a bundle of axes: the sum has more than one
/// minimum. The standard deviation is that of the fit, scaled up where the residuals are larger than the
/// points' noise.
pub fn cylinder_radius(samples: &[Sample]) -> Result<Measured, MeasureError> {
    const STEPS: usize = 60;
    let needed = PARAMETERS + 1;
    if samples.len() < needed {
        return Err(MeasureError::TooFewPoints {
            found: samples.len(),
            needed,
        });
    }
    let mut rod = start(samples).ok_or(MeasureError::NoRadius)?;
    for _ in 0..STEPS {
        let (information, gradient) = normal_equations(samples, &rod);
        let step = information.lu().solve(&gradient);
        let step = step.ok_or(MeasureError::NoRadius)?;
        let Some(better) = downhill(samples, &rod, &step) else {
            break;
        };
        rod = better;
        if step.norm() < 1e-10 {
            break;
        }
    }
    let (information, _) = normal_equations(samples, &rod);
    let covariance = information.try_inverse().ok_or(MeasureError::NoRadius)?;
    let freedom = (samples.len() - PARAMETERS) as f64;
    let chi = rod.chi(samples);
    let sigma = (covariance[(4, 4)] * (chi / freedom).max(1.0)).sqrt();
    if rod.radius > 0.0 && sigma < rod.radius {
        Ok(Measured {
            value: rod.radius,
            sigma,
        })
    } else {
        Err(MeasureError::NoRadius)
    }
}

#[derive(Clone, Copy)]
struct Cylinder {
    place: Vector3<f64>,
    axis: Direction<World>,
    radius: f64,
}

impl Cylinder {
    /// Along the axis, and across it.
    fn parts(&self, sample: &Sample) -> (f64, Vector3<f64>) {
        let axis = self.axis.vector();
        let way = sample.point.coords - self.place;
        let along = way.dot(&axis);
        (along, way - axis * along)
    }

    /// Distance from the cylinder in standard deviations.
    fn residual(&self, sample: &Sample) -> f64 {
        let (_, out) = self.parts(sample);
        (out.norm() - self.radius) / sample.sigma_along(outwards(out))
    }

    fn chi(&self, samples: &[Sample]) -> f64 {
        let residuals = samples.iter().map(|sample| self.residual(sample));
        residuals.map(|r| r * r).sum()
    }

    fn moved(&self, step: &Step, share: f64) -> Option<Self> {
        let (u, v) = self.axis.tangents();
        let tilted = self.axis.vector() + (u * step[0] + v * step[1]) * share;
        Some(Self {
            place: self.place + (u * step[2] + v * step[3]) * share,
            axis: Direction::new(tilted).ok()?,
            radius: self.radius + step[4] * share,
        })
    }
}

fn outwards(out: Vector3<f64>) -> Vector3<f64> {
    out.try_normalize(0.0).unwrap_or_else(Vector3::x)
}

/// The step, or half of it, or a quarter...: as much as does not lead uphill.
fn downhill(samples: &[Sample], rod: &Cylinder, step: &Step) -> Option<Cylinder> {
    const HALVINGS: i32 = 12;
    let before = rod.chi(samples);
    let shares = (0..HALVINGS).map(|k| libm::scalbn(1.0, -k));
    let moved = shares.filter_map(|share| rod.moved(step, share));
    moved.into_iter().find(|rod| rod.chi(samples) <= before)
}

fn normal_equations(samples: &[Sample], rod: &Cylinder) -> (Information, Step) {
    let (u, v) = rod.axis.tangents();
    let mut information = Information::zeros();
    let mut gradient = Step::zeros();
    for sample in samples {
        let (along, out) = rod.parts(sample);
        let o = outwards(out);
        let sigma = sample.sigma_along(o);
        // How axis, place and radius take the residual away: a tilt moves the axis by its lever.
        let row = Step::from([
            along * o.dot(&u),
            along * o.dot(&v),
            o.dot(&u),
            o.dot(&v),
            1.0,
        ]) / sigma;
        information += row * row.transpose();
        gradient += row * rod.residual(sample);
    }
    (information, gradient)
}

/// Of axes all over a half-sphere the one about which the points lie most nearly on a circle.
fn start(samples: &[Sample]) -> Option<Cylinder> {
    const AXES: u32 = 400;
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let axis = |k: u32| {
        // Evenly by a spiral of equal areas.
        let height = (f64::from(k) + 0.5) / f64::from(AXES);
        let (sine, cosine) = libm::sincos(GOLDEN_ANGLE * f64::from(k));
        let flat = (1.0 - height * height).sqrt();
        Direction::new(Vector3::new(flat * cosine, flat * sine, height)).ok()
    };
    let rods = (0..AXES).filter_map(|k| circle(samples, axis(k)?));
    let rated = rods.map(|rod| (rod.chi(samples), rod));
    let best = rated.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, rod)| rod)
}

/// The circle about an axis through the points, from `|p|^2 = 2 c . p + k` in the plane across it.
fn circle(samples: &[Sample], axis: Direction<World>) -> Option<Cylinder> {
    let count = samples.len() as f64;
    let middle = samples.iter().map(|s| s.point.coords).sum::<Vector3<f64>>() / count;
    let (u, v) = axis.tangents();
    let mut matrix = SMatrix::<f64, 3, 3>::zeros();
    let mut right = Vector3::zeros();
    for sample in samples {
        let way = sample.point.coords - middle;
        let (x, y) = (way.dot(&u), way.dot(&v));
        let row = Vector3::new(2.0 * x, 2.0 * y, 1.0);
        matrix += row * row.transpose();
        right += row * (x * x + y * y);
    }
    let solved = matrix.lu().solve(&right)?;
    let square = solved[2] + solved[0] * solved[0] + solved[1] * solved[1];
    (square > 0.0 && square.is_finite()).then(|| Cylinder {
        place: middle + u * solved[0] + v * solved[1],
        axis,
        radius: square.sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::geometry::Point;

    /// Points of the side of a rod of 20 mm that a rig sees, askew in space.
    fn side(wobble: f64) -> Vec<Sample> {
        let axis = Vector3::new(0.3, 1.0, 0.2).normalize();
        let u = axis.cross(&Vector3::z()).normalize();
        let v = axis.cross(&u);
        let place = |i: i32| {
            let turn = 1.1 * (f64::from(i % 9) / 4.0 - 1.0);
            let along = f64::from(i / 9) * 6.0 - 18.0;
            let off = 20.0 + wobble * (f64::from(i * 7 % 5) - 2.0) / 1.5;
            let out = u * libm::sin(turn) + v * libm::cos(turn);
            Point::from_coords(Vector3::new(8.0, -3.0, 120.0) + axis * along + out * off)
        };
        (0..63)
            .map(|i| Sample {
                point: place(i),
                covariance: Matrix3::identity() * 0.0025,
            })
            .collect()
    }

    #[test]
    fn a_rod_has_its_radius() {
        let exact = cylinder_radius(&side(0.0)).unwrap();
        assert!((exact.value - 20.0).abs() < 1e-7, "{exact:?}");
        let noisy = cylinder_radius(&side(0.05)).unwrap();
        assert!((noisy.value - 20.0).abs() < 2.0 * noisy.sigma, "{noisy:?}");
        assert!(noisy.sigma < 0.2, "{noisy:?}");
    }

    #[test]
    fn a_flat_face_and_a_handful_of_points_have_none() {
        let flat: Vec<Sample> = (0..25)
            .map(|i| Sample {
                point: Point::new(f64::from(i % 5), f64::from(i / 5), 0.01 * f64::from(i % 2)),
                covariance: Matrix3::identity() * 0.01,
            })
            .collect();
        assert_eq!(cylinder_radius(&flat), Err(MeasureError::NoRadius));
        assert_eq!(
            cylinder_radius(&flat[..5]),
            Err(MeasureError::TooFewPoints {
                found: 5,
                needed: 6
            })
        );
    }
}
