use nalgebra::Vector2;

use super::Wall;
use crate::geometry::{Direction, Point, Ray, World};

/// The part of a wall that was measured, for drawing: a grid of points on its outer face, row by row,
/// and the points of the inner face behind them. `None` where the wall does not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct WallMesh {
    /// Points in a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Outer point, inner point and normal of each grid point.
    pub nodes: Vec<Option<MeshNode>>,
}

/// A grid point of a [`WallMesh`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshNode {
    /// On the face towards the rig.
    pub outer: Point<World>,
    /// On the face towards the liquid.
    pub inner: Point<World>,
    /// Towards the rig.
    pub normal: Direction<World>,
}

impl Wall {
    /// A mesh of the wall that covers the given vessel points and `margin` (mm) around them.
    pub fn mesh(&self, points: &[Point<World>], margin: f64) -> Option<WallMesh> {
        const NODES: usize = 25;
        let middle = points
            .iter()
            .map(|p| p.coords)
            .sum::<nalgebra::Vector3<f64>>();
        let middle = Point::from_coords(middle / points.len() as f64);
        let normal = self.outer.normal_at(middle)?;
        let (u, v) = normal.tangents();
        let mut low = Vector2::repeat(f64::INFINITY);
        let mut high = Vector2::repeat(f64::NEG_INFINITY);
        for point in points {
            let d = *point - middle;
            let place = Vector2::new(d.dot(&u), d.dot(&v));
            low = low.inf(&place);
            high = high.sup(&place);
        }
        let low = low.add_scalar(-margin);
        let step = (high.add_scalar(margin) - low) / (NODES - 1) as f64;
        // Parallel light onto the patch: where it lands is the wall.
        let far = 1000.0 + (high - low).norm();
        let node = |index: usize| {
            let (column, row) = ((index % NODES) as f64, (index / NODES) as f64);
            let place = low + Vector2::new(step.x * column, step.y * row);
            let start = middle + (u * place.x + v * place.y + normal * far);
            let hit = self.outer.hit(&Ray::new(start, -normal))?;
            Some(MeshNode {
                outer: hit.point,
                inner: hit.point + hit.normal * -self.thickness,
                normal: hit.normal,
            })
        };
        Some(WallMesh {
            columns: NODES,
            rows: NODES,
            nodes: (0..NODES * NODES).map(node).collect(),
        })
    }
}
