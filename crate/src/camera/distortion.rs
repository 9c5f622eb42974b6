use crate::geometry::length;
use nalgebra::{Matrix2, Vector2};

/// OpenCV's distortion coefficients; those a camera does not have are 0.
///
/// With r^2 = x^2 + y^2 the slopes (x, y) of a line of sight are moved to
///
/// ```text
/// q  = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
/// x' = x q + 2 p1 x y + p2 (r^2 + 2 x^2)
/// y' = y q + p1 (r^2 + 2 y^2) + 2 p2 x y
/// ```
///
/// (OpenCV, *Camera Calibration and 3D Reconstruction*).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distortion {
    /// Radial, numerator: k1, k2, k3.
    pub numerator: [f64; 3],
    /// Radial, denominator: k4, k5, k6.
    pub denominator: [f64; 3],
    /// Tangential: p1, p2.
    pub tangential: [f64; 2],
}

impl Distortion {
    /// From OpenCV's order `k1 k2 p1 p2 [k3 [k4 k5 k6]]`; 0, 4, 5 or 8 numbers.
    pub fn from_opencv(coefficients: &[f64]) -> Option<Self> {
        if !matches!(coefficients.len(), 0 | 4 | 5 | 8) {
            return None;
        }
        let k = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
        Some(Self {
            numerator: [k(0), k(1), k(4)],
            denominator: [k(5), k(6), k(7)],
            tangential: [k(2), k(3)],
        })
    }

    /// Moves undistorted slopes to where the lens puts them.
    pub fn apply(&self, ideal: Vector2<f64>) -> Vector2<f64> {
        self.apply_with_derivative(ideal).0
    }

    /// The slopes that the lens moves to `distorted`: Newton's method to the last bits. `None` beyond the
    /// radius at which the model folds back on itself.
    pub fn remove(&self, distorted: Vector2<f64>) -> Option<Vector2<f64>> {
        let mut ideal = distorted;
        for _ in 0..50 {
            let (image, derivative) = self.apply_with_derivative(ideal);
            let error = distorted - image;
            let settled = length(&error) < 1e-13;
            ideal += derivative.try_inverse()? * error;
            if settled {
                // Past a fold there are solutions too, but they are other rays'.
                return self.rises_up_to(ideal).then_some(ideal);
            }
            let far = ideal.norm_squared();
            if far.is_nan() || far > 100.0 {
                return None;
            }
        }
        None
    }

    /// Whether the lens moves lines of sight the farther out the farther out they are, all the way to
    /// `ideal`: d(r q)/dr > 0. The tangential part is too small to fold the picture.
    fn rises_up_to(&self, ideal: Vector2<f64>) -> bool {
        const STEPS: i32 = 16;
        let rises = |r2: f64| {
            let (up, up_slope) = polynomial(self.numerator, r2);
            let (down, down_slope) = polynomial(self.denominator, r2);
            let slope = (up_slope * down - up * down_slope) / (down * down);
            up / down + 2.0 * r2 * slope > 0.0
        };
        let outermost = ideal.norm_squared();
        (1..=STEPS).all(|step| rises(outermost * f64::from(step) / f64::from(STEPS)))
    }

    /// As [`Distortion::apply`], with the derivative by the ideal slopes.
    pub fn apply_with_derivative(&self, ideal: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let (x, y) = (ideal.x, ideal.y);
        let r2 = x * x + y * y;
        let [p1, p2] = self.tangential;
        let (up, up_slope) = polynomial(self.numerator, r2);
        let (down, down_slope) = polynomial(self.denominator, r2);
        let q = up / down;
        let q_slope = (up_slope * down - up * down_slope) / (down * down);
        let image = Vector2::new(
            x * q + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * q + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let cross = 2.0 * x * y * q_slope + 2.0 * p1 * x + 2.0 * p2 * y;
        let derivative = Matrix2::new(
            q + 2.0 * x * x * q_slope + 2.0 * p1 * y + 6.0 * p2 * x,
            cross,
            cross,
            q + 2.0 * y * y * q_slope + 6.0 * p1 * y + 2.0 * p2 * x,
        );
        (image, derivative)
    }
}

/// 1 + c0 r^2 + c1 r^4 + c2 r^6 and its derivative by r^2.
fn polynomial([c0, c1, c2]: [f64; 3], r2: f64) -> (f64, f64) {
    (
        1.0 + r2 * (c0 + r2 * (c1 + r2 * c2)),
        c0 + r2 * (2.0 * c1 + r2 * 3.0 * c2),
    )
}
