//! A surface through the object's points, from the order in which they were scanned.

use nalgebra::Vector3;

use super::{OneOrMany, ReconstructionResult};
use crate::geometry::Point;
use crate::robust::median;

/// A surface of triangles. Millimetres, world frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners.
    pub vertices: Vec<[f64; 3]>,
    /// Three corners each, counter-clockwise as seen from the rig.
    pub triangles: Vec<[u32; 3]>,
}

/// An edge along a scan line may be this many usual steps long. Longer ones bridge a gap or lead from one
/// thing to the next behind it.
const LONGEST_ALONG: f64 = 3.0;
/// An edge between scan lines may be this many usual diagonals long.
const LONGEST_ACROSS: f64 = 2.0;

/// The object's surface between neighbouring scan lines: the points of a sweep of a spot laser, the profile
/// of a view of a line laser. Each line is joined to the next one by triangles, and the last to the first
/// if they are as near (a full turn of a turntable); triangles with long edges are left out. `None` where
/// the points allow no triangle.
pub fn object_mesh(result: &ReconstructionResult) -> Option<Mesh> {
    let mut vertices = Vec::new();
    let profiles = profiles(result, &mut vertices);
    let steps = Steps::of(&profiles, &vertices)?;
    let mut triangles = Vec::new();
    for pair in profiles.windows(2) {
        stitch(&pair[0], &pair[1], &vertices, &mut triangles);
    }
    if let ([first, .., last], true) = (&profiles[..], profiles.len() > 2)
        && way_across(last, first, &vertices) < 1.5 * steps.across
    {
        stitch(last, first, &vertices, &mut triangles);
    }
    triangles.retain(|triangle| steps.allow(triangle, &vertices));
    for triangle in &mut triangles {
        face_the_rig(triangle, &vertices, result);
    }
    let triangles: Vec<_> = triangles.iter().map(|t| t.map(|c| c.vertex)).collect();
    (!triangles.is_empty()).then_some(Mesh {
        vertices,
        triangles,
    })
}

/// A point of a profile.
#[derive(Clone, Copy, Debug)]
struct Corner {
    vertex: u32,
    profile: usize,
}

type Triangle = [Corner; 3];

/// The scan lines in the order in which they were taken, each point in its own order.
fn profiles(result: &ReconstructionResult, vertices: &mut Vec<[f64; 3]>) -> Vec<Vec<Corner>> {
    let mut profiles: Vec<Vec<Corner>> = Vec::new();
    let mut profile_of_sweep: Vec<(u32, usize)> = Vec::new();
    for view in &result.views {
        let profile = match (
            &view.object,
            profile_of_sweep.iter().find(|s| s.0 == view.sweep),
        ) {
            (OneOrMany::One(_), Some((_, profile))) => *profile,
            _ => {
                profile_of_sweep.push((view.sweep, profiles.len()));
                profiles.push(Vec::new());
                profiles.len() - 1
            }
        };
        for point in view.object.iter() {
            profiles[profile].push(Corner {
                vertex: vertices.len() as u32,
                profile,
            });
            vertices.push(*point);
        }
    }
    profiles.retain(|profile| !profile.is_empty());
    profiles
}

/// How far apart points usually are, mm.
struct Steps {
    along: f64,
    across: f64,
}

impl Steps {
    /// `None` if there are no two scan lines, or none of two points.
    fn of(profiles: &[Vec<Corner>], vertices: &[[f64; 3]]) -> Option<Self> {
        let along = profiles.iter().flat_map(|profile| {
            let pairs = profile.windows(2);
            pairs.map(|pair| distance(pair[0], pair[1], vertices))
        });
        let along: Vec<f64> = along.collect();
        let across = profiles.windows(2);
        let across: Vec<f64> = across
            .map(|pair| way_across(&pair[0], &pair[1], vertices))
            .collect();
        (!along.is_empty() && !across.is_empty()).then(|| Self {
            along: median(along),
            across: median(across),
        })
    }

    fn allow(&self, triangle: &Triangle, vertices: &[[f64; 3]]) -> bool {
        let diagonal = (self.along * self.along + self.across * self.across).sqrt();
        let [a, b, c] = *triangle;
        [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
            let longest = if from.profile == to.profile {
                LONGEST_ALONG * self.along
            } else {
                LONGEST_ACROSS * diagonal
            };
            distance(from, to, vertices) <= longest
        })
    }
}

fn place(corner: Corner, vertices: &[[f64; 3]]) -> Vector3<f64> {
    vertices[corner.vertex as usize].into()
}

fn distance(a: Corner, b: Corner, vertices: &[[f64; 3]]) -> f64 {
    (place(a, vertices) - place(b, vertices)).norm()
}

/// The median way from a point of one scan line to the nearest of the other.
fn way_across(from: &[Corner], to: &[Corner], vertices: &[[f64; 3]]) -> f64 {
    // A few points tell as much as all of a long profile.
    const SAMPLES: usize = 25;
    let every = from.len().div_ceil(SAMPLES);
    let nearest = from.iter().step_by(every).map(|a| {
        let ways = to.iter().map(|b| distance(*a, *b, vertices));
        ways.fold(f64::INFINITY, f64::min)
    });
    median(nearest.collect())
}

/// Joins two scan lines by triangles: from one end on, whichever next edge between the lines is shorter.
fn stitch(
    first: &[Corner],
    second: &[Corner],
    vertices: &[[f64; 3]],
    triangles: &mut Vec<Triangle>,
) {
    let second = alike(first, second, vertices);
    let (mut i, mut j) = (0, 0);
    while i + 1 < first.len() || j + 1 < second.len() {
        let on_first = first
            .get(i + 1)
            .map(|next| distance(*next, second[j], vertices));
        let on_second = second
            .get(j + 1)
            .map(|next| distance(first[i], *next, vertices));
        let (here, there) = (first[i], second[j]);
        let goes_on_first = match (on_first, on_second) {
            (Some(on_first), Some(on_second)) => on_first <= on_second,
            (on_first, _) => on_first.is_some(),
        };
        if goes_on_first {
            i += 1;
            triangles.push([here, there, first[i]]);
        } else {
            j += 1;
            triangles.push([here, there, second[j]]);
        }
    }
}

/// The second scan line in the first one's direction: a rig may sweep there and back.
fn alike(first: &[Corner], second: &[Corner], vertices: &[[f64; 3]]) -> Vec<Corner> {
    let mut second = second.to_vec();
    let along = |line: &[Corner]| {
        let ends = line.first().zip(line.last());
        ends.map_or(Vector3::zeros(), |(from, to)| {
            place(*to, vertices) - place(*from, vertices)
        })
    };
    if along(first).dot(&along(&second)) < 0.0 {
        second.reverse();
    }
    second
}

/// Orders the corners so that the triangle faces the wall, which is where the rig is.
fn face_the_rig(triangle: &mut Triangle, vertices: &[[f64; 3]], result: &ReconstructionResult) {
    let [a, b, c] = triangle.map(|corner| place(corner, vertices));
    let middle = Point::from_coords((a + b + c) / 3.0);
    let surface = result.vessel.surface();
    let towards_rig = surface.and_then(|surface| surface.normal_at(middle));
    if towards_rig.is_some_and(|rig| (b - a).cross(&(c - a)).dot(&rig.vector()) < 0.0) {
        triangle.swap(1, 2);
    }
}
