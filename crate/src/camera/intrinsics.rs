use nalgebra::{Vector2, Vector3};

use super::Distortion;
use crate::geometry::{Camera, Direction, Point, unit};

/// A place in the picture; `(0, 0)` is the centre of the top-left pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// To the right.
    pub u: f64,
    /// Downwards.
    pub v: f64,
}

impl Pixel {
    /// The place `(u, v)`.
    pub const fn new(u: f64, v: f64) -> Self {
        Self { u, v }
    }

    /// The distance to another place, px.
    pub fn distance(self, other: Self) -> f64 {
        Vector2::new(self.u - other.u, self.v - other.v).norm()
    }
}

/// An undistorted line of sight: the slopes x/z and y/z of a point before the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// x/z.
    pub x: f64,
    /// y/z.
    pub y: f64,
}

impl Slope {
    /// The slopes of a point; `None` unless it lies before the camera.
    pub fn of(point: Point<Camera>) -> Option<Self> {
        let p = point.coords;
        (p.z > 0.0).then(|| Self {
            x: p.x / p.z,
            y: p.y / p.z,
        })
    }

    /// `(x, y, 1)`.
    pub fn homogeneous(self) -> Vector3<f64> {
        Vector3::new(self.x, self.y, 1.0)
    }

    /// The unit vector of the line of sight.
    pub fn direction(self) -> Direction<Camera> {
        Direction::assume_unit(unit(self.homogeneous()))
    }
}

/// A pixel beyond the radius at which the distortion model folds back on itself has no line of sight.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("pixel ({:.1}, {:.1}) lies beyond the range of the lens model", .0.u, .0.v)]
pub struct OutsideLens(pub Pixel);

/// A calibrated camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Picture width, px.
    pub width: u32,
    /// Picture height, px.
    pub height: u32,
    /// Focal lengths, px.
    pub focal: [f64; 2],
    /// Principal point, px.
    pub centre: Pixel,
    /// What the lens bends.
    pub distortion: Distortion,
}

impl Intrinsics {
    /// The pixel at which a point before the camera is seen in air; `None` behind the camera.
    pub fn project(&self, point: Point<Camera>) -> Option<Pixel> {
        Slope::of(point).map(|slope| self.pixel(slope))
    }

    /// The mean focal length, px: what small slopes count in the picture.
    pub fn mean_focal(&self) -> f64 {
        0.5 * (self.focal[0] + self.focal[1])
    }

    /// The pixel of a line of sight.
    pub fn pixel(&self, slope: Slope) -> Pixel {
        let image = self.distortion.apply(Vector2::new(slope.x, slope.y));
        Pixel::new(
            self.focal[0] * image.x + self.centre.u,
            self.focal[1] * image.y + self.centre.v,
        )
    }

    /// The undistorted line of sight of a pixel: the inverse of [`Intrinsics::pixel`].
    ///
    /// ```
    /// use snellius::camera::{Distortion, Intrinsics, Pixel};
    ///
    /// let camera = Intrinsics {
    ///     width: 800, height: 600, focal: [1100.0, 1100.0], centre: Pixel::new(400.0, 300.0),
    ///     distortion: Distortion::from_opencv(&[-0.112, 0.061, 0.0006, -0.0004, 0.0]).unwrap(),
    /// };
    /// let corner = Pixel::new(0.0, 0.0);
    /// assert!(camera.pixel(camera.slope(corner)?).distance(corner) < 1e-10);
    /// # Ok::<(), snellius::camera::OutsideLens>(())
    /// ```
    pub fn slope(&self, pixel: Pixel) -> Result<Slope, OutsideLens> {
        let image = Vector2::new(
            (pixel.u - self.centre.u) / self.focal[0],
            (pixel.v - self.centre.v) / self.focal[1],
        );
        let ideal = self.distortion.remove(image).ok_or(OutsideLens(pixel))?;
        Ok(Slope {
            x: ideal.x,
            y: ideal.y,
        })
    }
}
