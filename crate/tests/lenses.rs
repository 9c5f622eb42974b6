//! Walls as lenses: closed forms of geometrical optics, and Fermat's principle on a free form. No law of
//! refraction is traced in the expected values.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::{Random, assert_close, direction, off_line, ray};
use nalgebra::{Vector2, Vector3};
use snellius::geometry::{Plane, Point, Ray, World};
use snellius::optics::{Base, Cylinder, Freeform, Grid, Media, Sheet, Sphere, Stack, Surface};
use snellius::scan::InsideMedium;
use snellius::vessel::Wall;

const MEDIA: Media = Media {
    outside: 1.0,
    wall: 1.5,
    liquid: 1.33,
};
const RADIUS: f64 = 60.0;
const THICKNESS: f64 = 4.0;

fn stack(outer: Surface) -> Stack {
    let wall = Wall::exact(outer, THICKNESS, None);
    wall.stack(&MEDIA, InsideMedium::Liquid).unwrap()
}

fn ball() -> Surface {
    Surface::Sphere(Sphere {
        centre: Point::origin(),
        radius: RADIUS,
    })
}

fn jar() -> Surface {
    Surface::Cylinder(Cylinder {
        point: Point::origin(),
        axis: direction([0.0, 1.0, 0.0]),
        radius: RADIUS,
    })
}

/// By how much light at the height `h` turns on its way in. At each face n r sin(angle) keeps its value
/// n1 h (Bouguer's invariant), with r the face's radius.
fn turn(h: f64, n: [f64; 3]) -> f64 {
    let angle = |index: f64, radius: f64| (n[0] * h / (index * radius)).asin();
    let inner = RADIUS - THICKNESS;
    angle(n[0], RADIUS) - angle(n[1], RADIUS) + angle(n[1], inner) - angle(n[2], inner)
}

/// Parallel light into a hollow ball full of water, and into a jar across its axis, at any height: where it
/// passes the middle, and by how much it has turned.
#[test]
fn a_ball_and_a_jar_bend_light_as_bouguers_invariant_says() {
    for outer in [ball(), jar()] {
        let stack = stack(outer);
        for step in 1..=28 {
            let h = 2.0 * f64::from(step);
            let light = stack
                .trace(&ray([h, 0.0, -300.0], [0.0, 0.0, 1.0]))
                .unwrap();
            let passes = off_line(Point::origin(), &light);
            assert_close(passes, MEDIA.outside * h / MEDIA.liquid, 1e-10);
            let turned = (-light.direction.vector().x).asin();
            assert_close(
                turned,
                turn(h, [MEDIA.outside, MEDIA.wall, MEDIA.liquid]),
                1e-12,
            );
        }
    }
}

/// Light askew to a jar's axis: n times the cosine to the axis never changes, and what is across the axis
/// bends as in the plane with the index sqrt(n^2 - that^2).
#[test]
fn a_jar_bends_light_askew_by_the_indices_across_its_axis() {
    let stack = stack(jar());
    for (h, rise) in [(10.0, 0.2), (25.0, 0.5), (40.0, -0.7)] {
        let light = ray([h, 0.0, -300.0], [0.0, rise, 1.0]);
        let along = light.direction.vector().y;
        let bent = stack.trace(&light).unwrap();
        assert_close(bent.direction.vector().y, along / MEDIA.liquid, 1e-13);
        let across = |n: f64| (n * n - along * along).sqrt();
        let n = [MEDIA.outside, MEDIA.wall, MEDIA.liquid].map(across);
        let d = bent.direction.vector();
        assert_close((-d.x).atan2(d.z), turn(h, n), 1e-12);
    }
}

/// Paraxial light meets where the thick-lens equation says: with the powers P1 = (n2 - n1) / R1 and
/// P2 = (n3 - n2) / R2 of the faces, their distance t and P = P1 + P2 - P1 P2 t / n2, the focus lies
/// n3 (1 - P1 t / n2) / P behind the inner face.
#[test]
fn a_thick_wall_focuses_paraxial_light_where_the_lens_equation_says() {
    let (n1, n2, n3) = (MEDIA.outside, MEDIA.wall, MEDIA.liquid);
    let (p1, p2) = ((n2 - n1) / RADIUS, (n3 - n2) / (RADIUS - THICKNESS));
    let power = p1 + p2 - p1 * p2 * THICKNESS / n2;
    let focus = n3 * (1.0 - p1 * THICKNESS / n2) / power - (RADIUS - THICKNESS);
    for outer in [ball(), jar()] {
        let light = stack(outer)
            .trace(&ray([1e-3, 0.0, -300.0], [0.0, 0.0, 1.0]))
            .unwrap();
        let reach = -light.origin.coords.x / light.direction.vector().x;
        assert_close(light.at(reach).coords.z, focus, 1e-5);
    }
}

/// A gentle bulge over a plane across z.
fn bulge(random: &mut Random) -> Sheet {
    let plane = Plane::new(Point::origin(), direction::<World>([0.02, -0.03, -1.0]));
    let edge = 9;
    Sheet {
        base: Base::on_plane(&plane),
        grid: Grid {
            start: Vector2::repeat(-90.0),
            step: Vector2::repeat(30.0),
            columns: edge,
            rows: edge,
        },
        heights: (0..edge * edge)
            .map(|_| random.between(-3.0, 3.0))
            .collect(),
        patch: vec![
            Vector2::new(-90.0, -90.0),
            Vector2::new(90.0, -90.0),
            Vector2::new(90.0, 90.0),
            Vector2::new(-90.0, 90.0),
        ],
    }
}

/// Fermat: moving a crossing along its face changes the optical path to second order only.
#[test]
fn light_through_a_free_form_takes_a_path_of_stationary_time() {
    const H: f64 = 1e-4;
    let mut random = Random::seeded(61);
    for _ in 0..50 {
        let sheet = bulge(&mut random);
        let outer = Freeform::new(sheet.clone());
        let stack = stack(Surface::Freeform(outer));
        let from = Point::from_coords(random.vector(40.0) + Vector3::new(0.0, 0.0, -350.0));
        let light = Ray::new(from, direction(random.vector(40.0) - from.coords));
        let path = stack.path(&light).unwrap();
        let end = path.last.at(30.0).coords;
        let inner = path.vertices[2];
        let normal = stack.interfaces[1].surface.normal_at(inner).unwrap();
        let above = inner + normal * THICKNESS;
        let places = [sheet.base.place(path.vertices[1]).0, sheet.base.place(above).0];
        let time = |places: [Vector2<f64>; 2]| {
            let (outer, _) = sheet.at(places[0]);
            let (above, normal) = sheet.at(places[1]);
            let inner = above + normal * -THICKNESS;
            MEDIA.outside * outer.distance(from)
                + MEDIA.wall * inner.distance(outer)
                + MEDIA.liquid * (end - inner.coords).norm()
        };
        let slope = |face: usize, axis: usize, off: f64| {
            let at = |h: f64| {
                let mut moved = places;
                moved[face][axis] += off + h;
                time(moved)
            };
            (at(H) - at(-H)) / (2.0 * H)
        };
        for (face, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert!(slope(face, axis, 0.0).abs() < 1e-7, "face {face}");
            // A crossing a hundredth of a millimetre elsewhere would show.
            assert!(slope(face, axis, 0.01).abs() > 1e-6, "face {face}");
        }
    }
}
