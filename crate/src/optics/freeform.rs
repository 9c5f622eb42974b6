use std::sync::Arc;

use nalgebra::Vector2;

use super::{Base, Hit};
use crate::geometry::{Direction, Plane, Point, Ray, World, unit};
use crate::robust::sort_stably;

/// A smooth wall of any form: heights over a simple surface, as a uniform bicubic B-spline, within the
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
    /// What the heights stand on.
    pub base: Base,
    /// The control points' grid.
    pub grid: Grid,
    /// The control points' heights, mm, row by row.
    pub heights: Vec<f64>,
    /// The corners of the measured patch, counter-clockwise, in the base's coordinates.
    pub patch: Vec<Vector2<f64>>,
}

/// A grid of control points over the base's two coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where the first cell of the patch begins, mm.
    pub start: Vector2<f64>,
    /// The cells' edges, mm.
    pub step: Vector2<f64>,
    /// Control points along the first coordinate; three more than cells.
    pub columns: usize,
    /// Control points along the second coordinate.
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
    /// Index of the control point, weight, derivatives by both coordinates.
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

    /// The sheet's point at a place and its unit normal there. With e the base's axes, a its stretch and
    /// h the height, the normal is along `e3 - (h_s / a1) e1 - (h_t / a2) e2`.
    pub fn at(&self, place: Vector2<f64>) -> (Point<World>, Direction<World>) {
        let height = self.height(place);
        let here = self.base.span(place, height.value);
        let slope = height.slope.component_div(&here.stretch);
        let [along, across, out] = here.axes;
        let normal = out - along * slope.x - across * slope.y;
        (here.point, Direction::assume_unit(unit(normal)))
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

    /// `None` where a round base has no room for it.
    pub(super) fn behind(&self, distance: f64) -> Option<Self> {
        let behind = self.behind + distance;
        self.sheet.base.surface().behind(behind)?;
        Some(Self {
            sheet: Arc::clone(&self.sheet),
            behind,
        })
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
        let (on_sheet, normal) = self.sheet.at(self.foot(point));
        (point - on_sheet).dot(&normal.vector()) + self.behind
    }

    /// How much shorter the way from a point to the face is than its height over it: the cosine of the
    /// face's slope against its base.
    pub fn cosine(&self, point: Point<World>) -> f64 {
        let place = self.foot(point);
        let [.., out] = self.sheet.base.span(place, 0.0).axes;
        self.sheet.at(place).1.vector().dot(&out)
    }

    /// How the distance of a point from the face changes with the control heights: the 16 that matter.
    pub fn distance_slopes(&self, point: Point<World>) -> [(usize, f64); 16] {
        let cosine = self.cosine(point);
        let support = self.sheet.grid.support(self.foot(point));
        // Raising a control point lowers the distances of the points over it.
        support
            .terms
            .map(|(index, weight, _)| (index, -weight * cosine))
    }

    /// The place of the sheet from which the normal leads to a point of the face.
    fn foot(&self, point: Point<World>) -> Vector2<f64> {
        let (mut place, _) = self.sheet.base.place(point);
        if self.behind == 0.0 {
            return place;
        }
        for _ in 0..SETTLING {
            let (_, normal) = self.sheet.at(place);
            let next = self.sheet.base.place(point + normal * self.behind).0;
            let moved = (next - place).amax();
            place = next;
            if moved < SETTLED {
                break;
            }
        }
        place
    }

    pub(super) fn normal_at(&self, point: Point<World>) -> Direction<World> {
        self.sheet.at(self.foot(point)).1
    }

    /// The control points that move the face at a point of it.
    pub(super) fn support_at(&self, point: Point<World>) -> impl Iterator<Item = usize> {
        let support = self.sheet.grid.support(self.foot(point));
        support.terms.into_iter().map(|(index, ..)| index)
    }

    /// Where a ray meets the face from its front, within the measured patch: tangent planes, each at the
    /// place where the ray met the one before (Newton's method).
    pub(super) fn hit(&self, ray: &Ray<World>) -> Option<Hit> {
        let mut distance = self.first_guess(ray)?;
        let (mut place, _) = self.sheet.base.place(ray.at(distance));
        for _ in 0..SETTLING {
            let (point, normal) = self.sheet.at(place);
            let tangent = Plane::new(point + normal * -self.behind, normal);
            if ray.direction.dot(normal) >= 0.0 {
                return None;
            }
            let next = tangent.distance_along(ray)?;
            place = self.sheet.base.place(ray.at(next) + normal * self.behind).0;
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

    /// How far along a ray the base is met, or the plane that touches it in its origin.
    fn first_guess(&self, ray: &Ray<World>) -> Option<f64> {
        let base = &self.sheet.base;
        let met = base.surface().behind(self.behind)?.hit(ray);
        let touching = Plane::new(base.origin, base.normal).offset(-self.behind);
        met.map_or_else(|| touching.distance_along(ray), |hit| Some(hit.distance))
    }
}

const SETTLING: usize = 50;
const SETTLED: f64 = 1e-11;

/// The corners of the smallest convex polygon around places, counter-clockwise (Andrew's monotone chain).
pub fn convex_hull(places: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut sorted = places.to_vec();
    sort_stably(&mut sorted, |a, b| {
        a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
    });
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
