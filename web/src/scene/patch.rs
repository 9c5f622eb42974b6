//! The piece of the vessel's wall that was seen: a slab as thick as the wall, a little larger than the
//! vessel points on it, along the wall's shape.

use std::f32::consts::PI;

use three_d::{InnerSpace, Vec3, vec3};

use super::content::vector;
use super::faces::Face as Triangle;
use super::lines::{Line, chain};
use crate::run::{Face, Wall};

/// A slab of wall: rows of places on each face, the same on both.
pub(super) struct Patch {
    outer: Vec<Vec<Vec3>>,
    inner: Vec<Vec<Vec3>>,
}

impl Patch {
    /// The slab over the vessel `points`, its rows one above the other as far as the shape allows.
    pub(super) fn new(wall: &Wall, points: &[Vec3], up: Vec3) -> Self {
        let sheet = Sheet::of(&wall.face, middle(points), up);
        let places: Vec<_> = points
            .iter()
            .map(|point| sheet.coordinates(*point))
            .collect();
        let (columns, rows) = sheet.cells();
        let across = steps(places.iter().map(|place| place.0), sheet.margin(), columns);
        let along = steps(places.iter().map(|place| place.1), sheet.margin(), rows);
        let face = |depth: f32| {
            let row = |v: &f32| across.iter().map(|u| sheet.place(*u, *v, depth)).collect();
            along.iter().map(row).collect()
        };
        Self {
            outer: face(0.0),
            inner: face(wall.thickness as f32),
        }
    }

    pub(super) fn places(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.outer.iter().chain(&self.inner).flatten().copied()
    }

    pub(super) fn faces(&self, colour: [f32; 4]) -> Vec<Triangle> {
        let mut quads = Vec::new();
        for face in [&self.outer, &self.inner] {
            for rows in face.windows(2) {
                let cells = rows[0].windows(2).zip(rows[1].windows(2));
                quads.extend(cells.map(|(low, high)| [low[0], low[1], high[1], high[0]]));
            }
        }
        let (outer, inner) = (rim(&self.outer), rim(&self.inner));
        let sides = outer.windows(2).zip(inner.windows(2));
        quads.extend(sides.map(|(out, within)| [out[0], out[1], within[1], within[0]]));
        let halves = |[a, b, c, d]: [Vec3; 4]| [[a, b, c], [a, c, d]];
        let corners = quads.into_iter().flat_map(halves);
        corners
            .map(|corners| Triangle { corners, colour })
            .collect()
    }

    pub(super) fn edges(&self, colour: [f32; 4]) -> Vec<Line> {
        let (outer, inner) = (rim(&self.outer), rim(&self.inner));
        let mut edges: Vec<Line> = chain(&outer, colour).collect();
        edges.extend(chain(&inner, colour));
        let ends = corners(&self.outer).into_iter().zip(corners(&self.inner));
        edges.extend(ends.map(|(out, within)| Line::new(out, within, colour)));
        edges
    }
}

/// A wall's outer face with coordinates: across and along, mm or radians. Those of a round wall start in
/// the middle of what was seen.
struct Sheet {
    face: Face,
    /// A point of the plane or the axis, or the centre.
    origin: Vec3,
    right: Vec3,
    along: Vec3,
    outwards: Vec3,
    radius: f32,
}

impl Sheet {
    fn of(face: &Face, seen: Vec3, up: Vec3) -> Self {
        let (origin, along, outwards, radius) = match *face {
            Face::Plane { point, normal } => {
                let normal = vector(normal);
                (vector(point), upright(normal, up), normal, 0.0)
            }
            Face::Cylinder {
                point,
                axis,
                radius,
            } => {
                let axis = vector(axis);
                (
                    vector(point),
                    axis,
                    upright(axis, seen - vector(point)),
                    radius as f32,
                )
            }
            Face::Sphere { centre, radius } => (
                vector(centre),
                up,
                upright(up, seen - vector(centre)),
                radius as f32,
            ),
        };
        Self {
            face: *face,
            origin,
            right: along.cross(outwards),
            along,
            outwards,
            radius,
        }
    }

    fn coordinates(&self, point: Vec3) -> (f32, f32) {
        let from = point - self.origin;
        let (right, along) = (from.dot(self.right), from.dot(self.along));
        let out = from.dot(self.outwards);
        match self.face {
            Face::Plane { .. } => (right, along),
            Face::Cylinder { .. } => (right.atan2(out), along),
            Face::Sphere { .. } => (right.atan2(out), along.atan2(right.hypot(out))),
        }
    }

    /// The place at some coordinates, `depth` behind the outer face.
    fn place(&self, u: f32, v: f32, depth: f32) -> Vec3 {
        let out = self.outwards * u.cos() + self.right * u.sin();
        let radius = self.radius - depth;
        let from = match self.face {
            Face::Plane { .. } => self.right * u + self.along * v - self.outwards * depth,
            Face::Cylinder { .. } => out * radius + self.along * v,
            Face::Sphere { .. } => (out * v.cos() + self.along * v.sin()) * radius,
        };
        self.origin + from
    }

    /// How many cells look smooth, across and along.
    const fn cells(&self) -> (usize, usize) {
        match self.face {
            Face::Plane { .. } => (1, 1),
            Face::Cylinder { .. } => (40, 1),
            Face::Sphere { .. } => (40, 24),
        }
    }

    /// How far the slab reaches beyond the points, of its size.
    const fn margin(&self) -> f32 {
        0.07
    }
}

fn middle(points: &[Vec3]) -> Vec3 {
    let sum = points
        .iter()
        .fold(vec3(0.0, 0.0, 0.0), |sum, point| sum + *point);
    sum / points.len().max(1) as f32
}

/// From a little below the least to a little above the greatest value, in equal steps.
fn steps(values: impl Iterator<Item = f32>, margin: f32, count: usize) -> Vec<f32> {
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let (low, high) = if low <= high { (low, high) } else { (-PI, PI) };
    let beyond = margin * (high - low).max(1e-3);
    let (low, size) = (low - beyond, high - low + 2.0 * beyond);
    (0..=count)
        .map(|i| low + size * i as f32 / count as f32)
        .collect()
}

/// Once round a face.
fn rim(face: &[Vec<Vec3>]) -> Vec<Vec3> {
    let (Some(first), Some(last)) = (face.first(), face.last()) else {
        return Vec::new();
    };
    let right = face.iter().filter_map(|row| row.last());
    let left = face.iter().rev().filter_map(|row| row.first());
    let round = first
        .iter()
        .chain(right)
        .chain(last.iter().rev())
        .chain(left);
    round.copied().collect()
}

fn corners(face: &[Vec<Vec3>]) -> Vec<Vec3> {
    let rows = face.first().into_iter().chain(face.last());
    let ends = rows.flat_map(|row| row.first().into_iter().chain(row.last()));
    ends.copied().collect()
}

/// The direction across `axis` that is nearest to `wish`.
fn upright(axis: Vec3, wish: Vec3) -> Vec3 {
    let across = wish - axis * wish.dot(axis);
    if across.magnitude() > 1e-3 {
        across.normalize()
    } else {
        axis.cross(vec3(0.0, 0.6, 0.8)).normalize()
    }
}
