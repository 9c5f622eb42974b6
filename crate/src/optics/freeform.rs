use std::sync::Arc;

use nalgebra::Vector2;

use super::Hit;
use crate::geometry::{Direction, Plane, Point, Ray, World};

/// A smooth wall of any form: heights over a reference plane, as a uniform bicubic B-spline, within the
/// patch in which it was measured.
///
/// The spline is twice continuously differentiable, so its normals are exact and smooth. A face behind
/// it is its offset along these normals.
#[derive(Clone, Debug, PartialEq)]
pub struct Freeform {
    sheet: Arc<Sheet>,
    /// How far behind the sheet, along its normals, this face lies, mm.
    behind: f64,
}

/// The spline itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Origin and normal of the heights; the normal points towards the rig.
    pub reference: Plane<World>,
    /// The control points' grid.
    pub grid: Grid,
    /// The control points' heights, mm, row by row.
    pub heights: Vec<f64>,
    /// The corners of the measured patch, counter-clockwise, in the reference plane's tangents, mm.
    pub patch: Vec<Vector2<f64>>,
}

/// A grid of control points in the reference plane's two tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where the first cell of the patch begins, mm.
    pub start: Vector2<f64>,
    /// The cells' edges, mm.
    pub step: Vector2<f64>,
    /// Control points along the first tangent; three more than cells.
    pub columns: usize,
    /// Control points along the second tangent.
    pub rows: usize,
}

/// The spline at a place: height, mm, and slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Height {
    value: f64,
    slope: Vector2<f64>,
}

/// The 16 control points that matter at a place, with their weights and the weights' derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Support {
    /// Index of the control point, weight, derivative by both tangents.
    pub terms: [(usize, f64, Vector2<f64>); 16],
}

impl Grid {
    /// How many control points.
    pub const fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The control points that matter at a place. Beyond the grid the outermost cell goes on.
    pub fn support(&self, place: Vector2<f64>) -> Support {
        let (column, across) = cell(place.x, self.start.x, self.step.x, self.columns);
        let (row, down) = cell(place.y, self.start.y, self.step.y, self.rows);
        let mut terms = [(0, 0.0, Vector2::zeros()); 16];
        for j in 0..4 {
            for i in 0..4 {
                let slope = Vector2::new(
                    across.1[i] * down.0[j] / self.step.x,
                    across.0[i] * down.1[j] / self.step.y,
                );
                let index = (row + j) * self.columns + column + i;
                terms[4 * j + i] = (index, across.0[i] * down.0[j], slope);
            }
        }
        Support { terms }
    }
}

/// The first of the four control points of a place, their weights and derivatives (per cell).
fn cell(at: f64, start: f64, step: f64, points: usize) -> (usize, ([f64; 4], [f64; 4])) {
    let position = (at - start) / step;
    let first = position.floor().clamp(0.0, (points - 4) as f64);
    let t = position - first;
    let s = 1.0 - t;
    let weights = [
        s * s * s / 6.0,
        (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
        (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
        t * t * t / 6.0,
    ];
    let slopes = [
        -0.5 * s * s,
        1.5 * t * t - 2.0 * t,
        -1.5 * s * s + 2.0 * s,
        0.5 * t * t,
    ];
    (first as usize, (weights, slopes))
}

impl Sheet {
    /// A point's place in the reference plane's tangents, and its height over the plane.
    pub fn place(&self, point: Point<World>) -> (Vector2<f64>, f64) {
        let (u, v) = self.reference.normal.tangents();
        let d = point - self.reference.point;
        (
            Vector2::new(d.dot(&u), d.dot(&v)),
            d.dot(&self.reference.normal.vector()),
        )
    }

    fn height(&self, place: Vector2<f64>) -> Height {
        let mut height = Height {
            value: 0.0,
            slope: Vector2::zeros(),
        };
        for (index, weight, slope) in self.grid.support(place).terms {
            height.value += weight * self.heights[index];
            height.slope += slope * self.heights[index];
        }
        height
    }

    /// The sheet's point at a place and its unit normal there.
    pub fn at(&self, place: Vector2<f64>) -> (Point<World>, Direction<World>) {
        let height = self.height(place);
        let (u, v) = self.reference.normal.tangents();
        let n = self.reference.normal.vector();
        let point = self.reference.point + (u * place.x + v * place.y + n * height.value);
        let normal = n - u * height.slope.x - v * height.slope.y;
        (point, Direction::assume_unit(normal.normalize()))
    }

    /// Whether a place lies within the measured patch.
    fn measured(&self, place: Vector2<f64>) -> bool {
        let corners = self.patch.iter().zip(self.patch.iter().cycle().skip(1));
        corners.into_iter().all(|(a, b)| {
            let (edge, to) = (b - a, place - a);
            edge.x * to.y - edge.y * to.x >= 0.0
        })
    }
}

impl Freeform {
    /// The face that a sheet makes.
    pub fn new(sheet: Sheet) -> Self {
        Self {
            sheet: Arc::new(sheet),
            behind: 0.0,
        }
    }

    /// The sheet that the face lies behind.
    pub fn sheet(&self) -> &Sheet {
        &self.sheet
    }

    pub(super) fn behind(&self, distance: f64) -> Self {
        Self {
            sheet: Arc::clone(&self.sheet),
            behind: self.behind + distance,
        }
    }

    pub(super) fn raised(&self, by: impl Iterator<Item = f64>) -> Self {
        let mut sheet = Sheet::clone(&self.sheet);
        sheet
            .heights
            .iter_mut()
            .zip(by)
            .for_each(|(height, step)| *height += step);
        Self {
            sheet: Arc::new(sheet),
            behind: self.behind,
        }
    }

    /// To first order in the distance, which is exact on the face.
    pub(super) fn signed_distance(&self, point: Point<World>) -> f64 {
        let (place, height) = self.sheet.place(point);
        let here = self.sheet.height(place);
        (height - here.value) / (1.0 + here.slope.norm_squared()).sqrt() + self.behind
    }

    pub(super) fn normal_at(&self, point: Point<World>) -> Direction<World> {
        let (mut place, _) = self.sheet.place(point);
        // A point behind the sheet belongs to the place from which the normal leads to it.
        for _ in 0..SETTLING {
            let (_, normal) = self.sheet.at(place);
            place = self.sheet.place(point + normal * self.behind).0;
        }
        self.sheet.at(place).1
    }

    /// Where a ray meets the face from its front, within the measured patch: tangent planes, each at the
    /// place where the ray met the one before (Newton's method).
    pub(super) fn hit(&self, ray: &Ray<World>) -> Option<Hit> {
        let middle = self.sheet.reference.offset(-self.behind);
        let mut distance = middle.distance_along(ray)?;
        let (mut place, _) = self.sheet.place(ray.at(distance));
        for _ in 0..SETTLING {
            let (point, normal) = self.sheet.at(place);
            let tangent = Plane::new(point + normal * -self.behind, normal);
            if ray.direction.dot(normal) >= 0.0 {
                return None;
            }
            let next = tangent.distance_along(ray)?;
            place = self.sheet.place(ray.at(next) + normal * self.behind).0;
            let moved = (next - distance).abs();
            distance = next;
            if moved < SETTLED {
                return (self.sheet.measured(place) && distance >= -SETTLED).then(|| Hit {
                    point: ray.at(distance),
                    normal: self.sheet.at(place).1,
                    distance,
                });
            }
        }
        None
    }
}

const SETTLING: usize = 50;
const SETTLED: f64 = 1e-11;

/// The corners of the smallest convex polygon around places, counter-clockwise (Andrew's monotone chain).
pub fn convex_hull(places: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = places.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |places: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for place in places {
            while chain.len() >= 2 {
                let (a, b) = (chain[chain.len() - 2], chain[chain.len() - 1]);
                if (b - a).perp(&(place - a)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(*place);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter());
    hull.extend(half(&mut sorted.iter().rev()));
    hull
}
