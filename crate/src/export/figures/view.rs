//! Which way one looks at vessel and object from above.

use nalgebra::Vector3;

use super::super::ReconstructionResult;
use crate::geometry::{Direction, Point, World};
use crate::optics::Surface;
use crate::plot::PlotError;

/// Three axes across each other: along the scan lines, upwards, and behind the wall, mm.
pub(super) struct View {
    pub(super) origin: Vector3<f64>,
    pub(super) across: Vector3<f64>,
    pub(super) up: Vector3<f64>,
    pub(super) behind: Vector3<f64>,
}

impl View {
    /// Down along the scan lines' common perpendicular; down the axis of a round vessel.
    pub(super) fn of(result: &ReconstructionResult) -> Result<Self, PlotError> {
        Self::try_of(result).ok_or(PlotError::Nothing)
    }

    fn try_of(result: &ReconstructionResult) -> Option<Self> {
        let points: Vec<Vector3<f64>> = result.vessel_points().map(Vector3::from).collect();
        let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
        let surface = result.vessel.surface()?;
        let towards_rig = surface.normal_at(Point::from_coords(middle));
        let towards_rig = towards_rig.map_or(Vector3::z(), Direction::vector);
        let (origin, behind, along) = match surface {
            Surface::Cylinder(cylinder) => {
                let axis = cylinder.axis.vector();
                let flat = towards_rig - axis * towards_rig.dot(&axis);
                (cylinder.point.coords, -flat, axis.cross(&flat))
            }
            Surface::Sphere(sphere) => (sphere.centre.coords, -towards_rig, along(result)),
            _ => (middle, -towards_rig, along(result)),
        };
        let behind = behind.try_normalize(1e-9)?;
        let across = along - behind * along.dot(&behind);
        let fallback = || Some(Direction::<World>::new(behind).ok()?.tangents().0);
        let across = across.try_normalize(1e-9).or_else(fallback)?;
        Some(Self {
            origin,
            across,
            up: behind.cross(&across),
            behind,
        })
    }

    /// Along the scan lines, and behind the wall.
    pub(super) fn top_down(&self, point: [f64; 3]) -> [f64; 2] {
        let [across, _, behind] = self.place(point);
        [across, behind]
    }

    /// Along the scan lines, upwards, and behind the wall.
    pub(super) fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let d = Vector3::from(point) - self.origin;
        [d.dot(&self.across), d.dot(&self.up), d.dot(&self.behind)]
    }
}

/// The direction in which a sweep goes from view to view along the wall.
fn along(result: &ReconstructionResult) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for pair in result.views.windows(2) {
        let places = (pair[0].vessel.first(), pair[1].vessel.first());
        if let (Some(from), Some(to), true) = (places.0, places.1, pair[0].sweep == pair[1].sweep) {
            let step = Vector3::from(to) - Vector3::from(from);
            // A rig that sweeps there and back counts both ways.
            sum += if step.dot(&sum) < 0.0 { -step } else { step };
        }
    }
    sum
}
