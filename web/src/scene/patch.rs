//! The piece of the vessel's wall that was seen: a slab as thick as the wall, a little larger than the
//! vessel points on it, along the wall's shape.

use std::f32::consts::PI;

use three_d::{InnerSpace, Vec3, vec3};

use super::content::vector;
use super::faces::Face as Triangle;
use super::lines::{Line, chain};
use crate::run::{Face, Mesh, Place, Through, Wall};

/// A slab of wall.
pub(super) struct Patch {
    /// Four places of the outer face at a time, and the four behind them.
    cells: Vec<[Pair; 4]>,
    /// Once round the slab.
    rim: Vec<Pair>,
    /// Where the two faces' rims are joined by a line.
    corners: Vec<Pair>,
}

/// A place of the outer face and the one behind it.
type Pair = [Vec3; 2];

impl Patch {
    /// The slab over the vessel `points`, its rows one above the other as far as the shape allows.
    pub(super) fn new(wall: &Wall, points: &[Vec3], up: Vec3) -> Self {
        let seen = middle(points);
        let sheet = match &wall.face {
            Face::Plane { point, normal } => {
                let normal = vector(*normal);
                Sheet::new(Kind::Flat, *point, upright(normal, up), normal, 0.0)
            }
            Face::Cylinder {
                point,
                axis,
                radius,
            } => {
                let axis = vector(*axis);
                let outwards = upright(axis, seen - vector(*point));
                Sheet::new(Kind::AboutAxis, *point, axis, outwards, *radius)
            }
            Face::Sphere { centre, radius } => {
                let outwards = upright(up, seen - vector(*centre));
                Sheet::new(Kind::AboutCentre, *centre, up, outwards, *radius)
            }
            Face::Freeform(mesh) => return Self::of_mesh(mesh),
        };
        Self::of_sheet(&sheet, wall.thickness as f32, points)
    }

    fn of_mesh(mesh: &Mesh) -> Self {
        let pair = |through: &Through| through.map(vector);
        let rings = mesh.rings.iter();
        let rings: Vec<Vec<Pair>> = rings.map(|ring| ring.iter().map(pair).collect()).collect();
        Self {
            cells: cells(&rings),
            rim: rings.last().cloned().unwrap_or_default(),
            corners: Vec::new(),
        }
    }

    fn of_sheet(sheet: &Sheet, thickness: f32, points: &[Vec3]) -> Self {
        let places: Vec<_> = points
            .iter()
            .map(|point| sheet.coordinates(*point))
            .collect();
        let (columns, rows) = sheet.cells();
        let across = steps(places.iter().map(|place| place.0), columns);
        let along = steps(places.iter().map(|place| place.1), rows);
        let pair = |u: f32, v: f32| [sheet.place(u, v, 0.0), sheet.place(u, v, thickness)];
        let row = |v: &f32| across.iter().map(|u| pair(*u, *v)).collect();
        let rows: Vec<Vec<Pair>> = along.iter().map(row).collect();
        Self {
            cells: cells(&rows),
            rim: rim(&rows),
            corners: corners(&rows),
        }
    }

    pub(super) fn places(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.cells.iter().flatten().flatten().copied()
    }

    pub(super) fn faces(&self, colour: [f32; 4]) -> Vec<Triangle> {
        let faces = [0, 1].into_iter().flat_map(|side| {
            self.cells
                .iter()
                .map(move |cell| cell.map(|pair| pair[side]))
        });
        let sides = self.rim.windows(2).map(|pair| {
            let ([out, within], [next_out, next_within]) = (pair[0], pair[1]);
            [out, next_out, next_within, within]
        });
        let halves = |[a, b, c, d]: [Vec3; 4]| [[a, b, c], [a, c, d]];
        let corners = faces.chain(sides).flat_map(halves);
        corners
            .map(|corners| Triangle { corners, colour })
            .collect()
    }

    pub(super) fn edges(&self, colour: [f32; 4]) -> Vec<Line> {
        let side = |side: usize| self.rim.iter().map(|pair| pair[side]).collect::<Vec<_>>();
        let mut edges: Vec<Line> = chain(&side(0), colour).collect();
        edges.extend(chain(&side(1), colour));
        let ends = self.corners.iter();
        edges.extend(ends.map(|[out, within]| Line::new(*out, *within, colour)));
        edges
    }
}

/// The cells between neighbouring rows.
fn cells(rows: &[Vec<Pair>]) -> Vec<[Pair; 4]> {
    let bands = rows.windows(2);
    let corners = bands.flat_map(|band| band[0].windows(2).zip(band[1].windows(2)));
    corners
        .map(|(low, high)| [low[0], low[1], high[1], high[0]])
        .collect()
}

/// A plane's or round wall's outer face with coordinates: across and along, mm or radians. Those of a
/// round wall start in the middle of what was seen.
struct Sheet {
    kind: Kind,
    /// A point of the plane or the axis, or the centre.
    origin: Vec3,
    right: Vec3,
    along: Vec3,
    outwards: Vec3,
    radius: f32,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Flat,
    AboutAxis,
    AboutCentre,
}

impl Sheet {
    fn new(kind: Kind, origin: Place, along: Vec3, outwards: Vec3, radius: f64) -> Self {
        Self {
            kind,
            origin: vector(origin),
            right: along.cross(outwards),
            along,
            outwards,
            radius: radius as f32,
        }
    }

    fn coordinates(&self, point: Vec3) -> (f32, f32) {
        let from = point - self.origin;
        let (right, along) = (from.dot(self.right), from.dot(self.along));
        let out = from.dot(self.outwards);
        match self.kind {
            Kind::Flat => (right, along),
            Kind::AboutAxis => (right.atan2(out), along),
            Kind::AboutCentre => (right.atan2(out), along.atan2(right.hypot(out))),
        }
    }

    /// The place at some coordinates, `depth` behind the outer face.
    fn place(&self, u: f32, v: f32, depth: f32) -> Vec3 {
        let out = self.outwards * u.cos() + self.right * u.sin();
        let radius = self.radius - depth;
        let from = match self.kind {
            Kind::Flat => self.right * u + self.along * v - self.outwards * depth,
            Kind::AboutAxis => out * radius + self.along * v,
            Kind::AboutCentre => (out * v.cos() + self.along * v.sin()) * radius,
        };
        self.origin + from
    }

    /// How many cells look smooth, across and along.
    const fn cells(&self) -> (usize, usize) {
        match self.kind {
            Kind::Flat => (1, 1),
            Kind::AboutAxis => (40, 1),
            Kind::AboutCentre => (40, 24),
        }
    }
}

fn middle(points: &[Vec3]) -> Vec3 {
    let sum = points
        .iter()
        .fold(vec3(0.0, 0.0, 0.0), |sum, point| sum + *point);
    sum / points.len().max(1) as f32
}

/// From a little below the least to a little above the greatest value, in equal steps.
fn steps(values: impl Iterator<Item = f32>, count: usize) -> Vec<f32> {
    const MARGIN: f32 = 0.07;
    let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let (low, high) = if low <= high { (low, high) } else { (-PI, PI) };
    let beyond = MARGIN * (high - low).max(1e-3);
    let (low, size) = (low - beyond, high - low + 2.0 * beyond);
    (0..=count)
        .map(|i| low + size * i as f32 / count as f32)
        .collect()
}

/// Once round a face.
fn rim(face: &[Vec<Pair>]) -> Vec<Pair> {
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

fn corners(face: &[Vec<Pair>]) -> Vec<Pair> {
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
