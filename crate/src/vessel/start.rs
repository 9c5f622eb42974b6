//! A surface of each shape near points of which fewer than half may be wrong: the start of its fit.
//!
//! Each is a least-median-of-squares search: surfaces through as few points as make one, and of these
//! the one from which the median point lies least far. The choice of points is pseudo-random but always
//! the same, so that the same points give the same surface everywhere.

use nalgebra::{Matrix4, Vector2, Vector3, Vector4};

use crate::geometry::{Direction, Plane, Point, World};
use crate::optics::{Base, Cylinder, Sphere, Surface};
use crate::robust::{Choice, robust_scale, sort_by_number};

/// Points looked at by the search: enough for a median, few enough for thousands of trials.
const MOST_POINTS: usize = 120;

/// The best few cylinders, best first.
pub(super) fn cylinders(points: &[Point<World>], front: Point<World>) -> Vec<Surface> {
    const DIRECTIONS: usize = 250;
    const TRIALS: usize = 20;
    const KEPT: usize = 4;
    let points = thinned(points);
    let mut choice = Choice::new();
    let mut found: Vec<(f64, Surface)> = Vec::new();
    for axis in (0..DIRECTIONS).map(|i| half_sphere(i, DIRECTIONS)) {
        let (u, v) = axis.tangents();
        let flat: Vec<Vector2<f64>> = points
            .iter()
            .map(|p| Vector2::new(p.coords.dot(&u), p.coords.dot(&v)))
            .collect();
        let circles = (0..TRIALS).filter_map(|_| {
            let [a, b, c] = choice.distinct(flat.len())?;
            circle_through(flat[a], flat[b], flat[c])
        });
        let best = circles
            .map(|(centre, radius)| {
                Surface::Cylinder(Cylinder {
                    point: Point::from_coords(u * centre.x + v * centre.y),
                    axis,
                    radius,
                })
            })
            .filter(|s| s.signed_distance(front) > 0.0)
            .map(|s| (spread(&points, &s), s))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        found.extend(best);
    }
    sort_by_number(&mut found, |start| start.0);
    let middle = mean(&points);
    found
        .into_iter()
        .take(KEPT)
        .map(|(_, s)| with_point_near(s, middle))
        .collect()
}

/// The best sphere.
pub(super) fn sphere(points: &[Point<World>], front: Point<World>) -> Option<Surface> {
    const TRIALS: usize = 1500;
    let points = thinned(points);
    let mut choice = Choice::new();
    (0..TRIALS)
        .filter_map(|_| {
            let four: [usize; 4] = choice.distinct(points.len())?;
            sphere_through(four.map(|i| points[i]))
        })
        .map(Surface::Sphere)
        .filter(|s| s.signed_distance(front) > 0.0)
        .map(|s| (spread(&points, &s), s))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, s)| s)
}

/// A plane through the middle of the points, across the rig's line of sight.
pub(super) fn across_view(points: &[Point<World>], front: Point<World>) -> Option<Plane<World>> {
    let middle = mean(points);
    let towards_rig = Direction::new(front - middle).ok()?;
    Some(Plane::new(middle, towards_rig))
}

/// What a free form can stand on, with coordinates that start in the middle of the points.
pub(super) fn base(simple: &Surface, points: &[Point<World>]) -> Option<Base> {
    let middle = mean(points);
    match simple {
        Surface::Plane(plane) => {
            let foot = middle + plane.normal * -plane.signed_distance(middle);
            Some(Base::on_plane(&Plane::new(foot, plane.normal)))
        }
        Surface::Cylinder(cylinder) => Base::on_cylinder(cylinder, middle),
        Surface::Sphere(sphere) => Base::on_sphere(sphere, middle),
        Surface::Freeform(freeform) => Some(freeform.sheet().base),
    }
}

fn spread(points: &[Point<World>], surface: &Surface) -> f64 {
    let distances: Vec<f64> = points.iter().map(|p| surface.signed_distance(*p)).collect();
    robust_scale(&distances)
}

fn thinned(points: &[Point<World>]) -> Vec<Point<World>> {
    let stride = points.len().div_ceil(MOST_POINTS).max(1);
    points.iter().step_by(stride).copied().collect()
}

fn mean(points: &[Point<World>]) -> Point<World> {
    let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
    Point::from_coords(sum / points.len() as f64)
}

/// A cylinder whose point on the axis lies beside the measured points: its tilts and shifts are then
/// hardly correlated.
fn with_point_near(surface: Surface, middle: Point<World>) -> Surface {
    let Surface::Cylinder(cylinder) = surface else {
        return surface;
    };
    let along = (middle - cylinder.point).dot(&cylinder.axis.vector());
    Surface::Cylinder(Cylinder {
        point: cylinder.point + cylinder.axis * along,
        ..cylinder
    })
}

/// The i-th of n directions spread evenly over half a sphere (a Fibonacci lattice).
fn half_sphere(i: usize, n: usize) -> Direction<World> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let z = (i as f64 + 0.5) / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let angle = GOLDEN_ANGLE * i as f64;
    let vector = Vector3::new(radius * libm::cos(angle), radius * libm::sin(angle), z);
    Direction::assume_unit(vector.normalize())
}

fn circle_through(
    a: Vector2<f64>,
    b: Vector2<f64>,
    c: Vector2<f64>,
) -> Option<(Vector2<f64>, f64)> {
    let (b, c) = (b - a, c - a);
    let twice_area = 2.0 * (b.x * c.y - b.y * c.x);
    let (b2, c2) = (b.norm_squared(), c.norm_squared());
    let from_a = Vector2::new(c.y * b2 - b.y * c2, b.x * c2 - c.x * b2) / twice_area;
    let radius = from_a.norm();
    // Three points nearly on a line make a circle too large to be told from a plane.
    (radius < 100.0 * (b2 + c2).sqrt()).then_some((a + from_a, radius))
}

fn sphere_through(points: [Point<World>; 4]) -> Option<Sphere> {
    let rows = points.map(|p| p.coords.push(1.0).transpose());
    let right = Vector4::from(points.map(|p| -p.coords.norm_squared()));
    let solution = Matrix4::from_rows(&rows).try_inverse()? * right;
    let centre = -0.5 * solution.xyz();
    let squared = centre.norm_squared() - solution.w;
    let extent = (points[0] - points[1]).norm() + (points[2] - points[3]).norm();
    let radius = squared.sqrt();
    (radius < 100.0 * extent).then_some(Sphere {
        centre: Point::from_coords(centre),
        radius,
    })
}
