use nalgebra::{Vector2, Vector3};

use super::{BaseResult, ReconstructionResult, VesselResult, WallResult};
use crate::geometry::{Direction, Plane, Point, World};
use crate::optics::{Base, BaseShape, Cylinder, Freeform, Grid, Sheet, Sphere, Surface};
use crate::vessel::{Wall, WallMesh};

/// How far beyond the measured points a wall is drawn, mm.
const MARGIN: f64 = 10.0;

impl VesselResult {
    /// The wall's outer face; `None` if the numbers describe none, as a file from elsewhere may have it.
    pub fn surface(&self) -> Option<Surface> {
        Some(match &self.wall {
            WallResult::Plane { point, normal } => Surface::Plane(plane(*point, *normal)?),
            WallResult::Cylinder {
                axis_point,
                axis,
                radius,
            } => Surface::Cylinder(Cylinder {
                point: (*axis_point).into(),
                axis: direction(*axis)?,
                radius: positive(*radius)?,
            }),
            WallResult::Sphere { center, radius } => Surface::Sphere(Sphere {
                centre: (*center).into(),
                radius: positive(*radius)?,
            }),
            WallResult::Freeform { .. } => Surface::Freeform(freeform(&self.wall)?),
        })
    }
}

impl ReconstructionResult {
    /// The measured part of the wall as a mesh, for drawing; `None` without vessel points.
    pub fn wall_mesh(&self) -> Option<WallMesh> {
        let points: Vec<Point<World>> = self.vessel_points().map(Point::from).collect();
        let wall = Wall::exact(self.vessel.surface()?, self.vessel.wall_thickness, None);
        (!points.is_empty())
            .then(|| wall.mesh(&points, MARGIN))
            .flatten()
    }

    /// The vessel points of all views.
    pub fn vessel_points(&self) -> impl Iterator<Item = [f64; 3]> + Clone + '_ {
        self.views
            .iter()
            .flat_map(|view| view.vessel.iter())
            .copied()
    }
}

fn direction(vector: [f64; 3]) -> Option<Direction<World>> {
    Direction::new(vector.into()).ok()
}

fn plane(point: [f64; 3], normal: [f64; 3]) -> Option<Plane<World>> {
    Some(Plane::new(point.into(), direction(normal)?))
}

fn positive(length: f64) -> Option<f64> {
    Some(length).filter(|length| *length > 0.0)
}

fn freeform(wall: &WallResult) -> Option<Freeform> {
    let WallResult::Freeform {
        base,
        radius,
        origin,
        normal,
        tangents,
        start,
        step,
        columns,
        rows,
        heights,
        patch,
    } = wall
    else {
        return None;
    };
    // A bicubic spline has four control points a cell along each tangent, and a step to divide by.
    let is_grid = *columns >= 4 && *rows >= 4 && columns.checked_mul(*rows) == Some(heights.len());
    positive(step[0].min(step[1]))?;
    let radius = radius.and_then(positive);
    let shape = match base {
        BaseResult::Plane => BaseShape::Plane,
        BaseResult::Cylinder => BaseShape::Cylinder { radius: radius? },
        BaseResult::Sphere => BaseShape::Sphere { radius: radius? },
    };
    is_grid.then(|| {
        Some(Freeform::new(Sheet {
            base: Base {
                origin: (*origin).into(),
                normal: direction(*normal)?,
                tangents: tangents.map(Vector3::from),
                shape,
            },
            grid: Grid {
                start: (*start).into(),
                step: (*step).into(),
                columns: *columns,
                rows: *rows,
            },
            heights: heights.clone(),
            patch: patch.iter().copied().map(Vector2::from).collect(),
        }))
    })?
}
