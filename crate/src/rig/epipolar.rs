use nalgebra::{Vector2, Vector3};

use super::LitPoint;
use crate::camera::{Intrinsics, Pixel, Slope};
use crate::geometry::{Camera, Ray};

/// The image of the laser beam in air: every spot the beam makes before it is bent lies on it.
///
/// In undistorted slopes it is the straight line in which the plane of the beam and the camera's centre
/// cuts the image plane; through the lens it is slightly bent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpipolarLine {
    beam: Ray<Camera>,
    /// a, b, c of `a x + b y + c = 0` in slopes, with `a^2 + b^2 = 1`.
    line: Vector3<f64>,
}

impl EpipolarLine {
    pub(super) fn new(beam: &Ray<Camera>) -> Self {
        let plane = beam.origin.coords.cross(&beam.direction.vector());
        let scale = (plane.x * plane.x + plane.y * plane.y).sqrt();
        Self {
            beam: *beam,
            line: plane / scale,
        }
    }

    /// The unit vector across the line, in the picture.
    pub fn normal(&self) -> Vector2<f64> {
        self.line.xy()
    }

    /// How far off the line a line of sight passes, in slopes, with a sign.
    pub fn distance(&self, sight: Slope) -> f64 {
        self.line.dot(&sight.homogeneous())
    }

    /// Triangulates in air: moves the line of sight onto the epipolar line (the shortest way) and
    /// intersects it with the beam. `None` if that meets the beam behind the laser or the camera.
    ///
    /// For a sight m on the line, O + s D || m gives s = -(m x O) . (m x D) / |m x D|^2.
    pub fn triangulate(&self, sight: Slope) -> Option<LitPoint> {
        let off_line = self.distance(sight);
        let foot = Vector3::new(
            sight.x - off_line * self.line.x,
            sight.y - off_line * self.line.y,
            1.0,
        );
        let across = foot.cross(&self.beam.direction.vector());
        let along = -foot.cross(&self.beam.origin.coords).dot(&across) / across.norm_squared();
        let point = self.beam.at(along);
        (along > 0.0 && point.coords.z > 0.0).then_some(LitPoint {
            along,
            point,
            off_line: Some(off_line),
        })
    }

    /// The line as the picture shows it: pixels along the beam, from the laser outwards, as far as they
    /// fall into the picture.
    pub fn polyline(&self, camera: &Intrinsics) -> Vec<Pixel> {
        const STEPS: i32 = 400;
        // From 1 mm to 10^6 mm along the beam in equal ratios.
        let reach = |step: i32| libm::exp(f64::from(step) / f64::from(STEPS) * 13.8);
        (0..=STEPS)
            .filter_map(|step| Slope::of(self.beam.at(reach(step))))
            .map(|slope| (slope, camera.pixel(slope)))
            .filter(|(slope, pixel)| {
                let inside = (-0.5..f64::from(camera.width)).contains(&pixel.u)
                    && (-0.5..f64::from(camera.height)).contains(&pixel.v);
                // Beyond its range the lens model folds far-off rays back into the picture.
                let same = |s: Slope| (s.x - slope.x).abs() + (s.y - slope.y).abs() < 1e-6;
                inside && camera.slope(*pixel).is_ok_and(same)
            })
            .map(|(_, pixel)| pixel)
            .collect()
    }
}
