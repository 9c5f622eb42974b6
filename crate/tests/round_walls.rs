//! Light through round walls: the same laws as through flat ones, with normals that turn.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::{Random, off_line};
use nalgebra::{Vector2, Vector3};
use snellius::geometry::{Direction, Point, Ray, World};
use snellius::optics::{
    Base, Cylinder, Freeform, Grid, Interface, Media, Path, Sheet, Sphere, Stack, Surface,
    TraceProblem, aim_through,
};
use snellius::scan::InsideMedium;
use snellius::vessel::Wall;

const MEDIA: Media = Media {
    outside: 1.0,
    wall: 1.5,
    liquid: 1.33,
};

/// A jar and a bowl around (0, 0, 0), seen from z = -350.
fn vessels() -> [(Surface, &'static str); 2] {
    let axis = Direction::new(Vector3::new(0.05, 1.0, -0.1)).unwrap();
    let jar = Cylinder {
        point: Point::origin(),
        axis,
        radius: 70.0,
    };
    let bowl = Sphere {
        centre: Point::origin(),
        radius: 80.0,
    };
    [
        (Surface::Cylinder(jar), "cylinder"),
        (Surface::Sphere(bowl), "sphere"),
    ]
}

fn stack(outer: Surface, media: &Media) -> Stack {
    Wall::exact(outer, 3.0, None)
        .stack(media, InsideMedium::Liquid)
        .unwrap()
}

/// From the axis or the centre to a point: the direction of the normal, straight from the shape.
fn outwards(surface: &Surface, at: Point<World>) -> Vector3<f64> {
    match surface {
        Surface::Cylinder(c) => {
            let axis = c.axis.vector();
            let from = at - c.point;
            (from - axis * from.dot(&axis)).normalize()
        }
        Surface::Sphere(s) => (at - s.centre).normalize(),
        flat => panic!("{flat:?} is not round"),
    }
}

fn radius(surface: &Surface) -> f64 {
    match surface {
        Surface::Cylinder(c) => c.radius,
        Surface::Sphere(s) => s.radius,
        flat => panic!("{flat:?} is not round"),
    }
}

/// Puts a point that was moved along a tangent back on its surface.
fn onto(surface: &Surface, at: Vector3<f64>) -> Vector3<f64> {
    let point = Point::from_coords(at);
    at - outwards(surface, point) * surface.signed_distance(point)
}

fn light(random: &mut Random) -> Ray<World> {
    let from = Point::from_coords(random.vector(60.0) + Vector3::new(0.0, 0.0, -350.0));
    let towards = random.vector(40.0);
    Ray::new(from, Direction::new(towards - from.coords).unwrap())
}

fn legs(path: &Path) -> Vec<Vector3<f64>> {
    let mut legs: Vec<_> = path
        .vertices
        .windows(2)
        .map(|v| (v[1] - v[0]).normalize())
        .collect();
    legs.push(path.last.direction.vector());
    legs
}

#[test]
fn light_bends_by_snells_law_about_the_normal_at_its_crossing() {
    let mut random = Random::seeded(51);
    for (outer, shape) in vessels() {
        let stack = stack(outer, &MEDIA);
        for _ in 0..300 {
            let light = light(&mut random);
            let path = stack.path(&light).unwrap();
            let n = [MEDIA.outside, MEDIA.wall, MEDIA.liquid];
            for (face, legs) in legs(&path).windows(2).enumerate() {
                let surface = &stack.interfaces[face].surface;
                let crossing = path.vertices[face + 1];
                assert!(
                    surface.signed_distance(crossing).abs() < 1e-11,
                    "{shape}: on the face"
                );
                let normal = outwards(surface, crossing);
                assert!(legs[0].dot(&normal) < 0.0, "{shape}: from outside");
                let change =
                    legs[0].cross(&normal) * n[face] - legs[1].cross(&normal) * n[face + 1];
                assert!(change.norm() < 1e-12, "{shape}, face {face}");
            }
        }
    }
}

/// Fermat: moving a crossing along its face changes the optical path to second order only.
#[test]
fn light_takes_a_path_of_stationary_time() {
    const H: f64 = 1e-4;
    let mut random = Random::seeded(52);
    for (outer, shape) in vessels() {
        let stack = stack(outer, &MEDIA);
        for _ in 0..100 {
            let path = stack.path(&light(&mut random)).unwrap();
            let end = path.last.at(30.0).coords;
            let optical_path = |a: Vector3<f64>, b: Vector3<f64>| {
                (a - path.vertices[0].coords).norm()
                    + 1.5 * (b - a).norm()
                    + 1.33 * (end - b).norm()
            };
            let (a, b) = (path.vertices[1].coords, path.vertices[2].coords);
            for (face, at) in [a, b].into_iter().enumerate() {
                let surface = &stack.interfaces[face].surface;
                let (u, v) = Direction::<World>::new(outwards(surface, Point::from_coords(at)))
                    .unwrap()
                    .tangents();
                for along in [u, v] {
                    let moved = |h: f64| {
                        let at = onto(surface, at + along * h);
                        if face == 0 {
                            optical_path(at, b)
                        } else {
                            optical_path(a, at)
                        }
                    };
                    let slope = (moved(H) - moved(-H)) / (2.0 * H);
                    assert!(slope.abs() < 1e-8, "{shape}, face {face}: {slope:e}");
                    // A path that is bent by a hundredth of a millimetre too much would show.
                    let elsewhere = (moved(0.01 + H) - moved(0.01 - H)) / (2.0 * H);
                    assert!(
                        elsewhere.abs() > 1e-5,
                        "{shape}, face {face}: {elsewhere:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn where_all_media_are_the_same_light_goes_straight() {
    let mut random = Random::seeded(53);
    let water = Media {
        outside: 1.33,
        wall: 1.33,
        liquid: 1.33,
    };
    for (outer, shape) in vessels() {
        for _ in 0..100 {
            let light = light(&mut random);
            let path = stack(outer.clone(), &water).path(&light).unwrap();
            assert!(
                (path.last.direction.vector() - light.direction.vector()).norm() < 1e-13,
                "{shape}"
            );
            assert!(
                path.vertices.iter().all(|v| off_line(*v, &light) < 1e-10),
                "{shape}"
            );
        }
    }
}

/// Light back out leaves a vessel from within, through faces that bulge the other way. The last face's law
/// is checked by hand: the light that went in is what comes out.
#[test]
fn light_returns_the_way_it_came() {
    let mut random = Random::seeded(54);
    for (outer, shape) in vessels() {
        let stack = stack(outer, &MEDIA);
        for _ in 0..200 {
            let path = stack.path(&light(&mut random)).unwrap();
            let mut back = -path.last.direction;
            for (face, index) in [(1, MEDIA.wall), (0, MEDIA.outside)] {
                let Interface {
                    surface,
                    index_behind,
                } = &stack.interfaces[face];
                let normal = outwards(surface, path.vertices[face + 1]);
                back = snellius::optics::refract(
                    back,
                    Direction::new(normal).unwrap(),
                    *index_behind,
                    index,
                )
                .unwrap();
            }
            let home = Ray::new(path.vertices[1], back);
            assert!(off_line(path.vertices[0], &home) < 1e-9, "{shape}");
        }
    }
}

#[test]
fn a_traced_point_is_aimed_at_along_its_ray() {
    let mut random = Random::seeded(55);
    for (outer, shape) in vessels() {
        let stack = stack(outer, &MEDIA);
        for _ in 0..200 {
            let light = light(&mut random);
            let point = stack.trace(&light).unwrap().at(random.between(1.0, 60.0));
            let aim = aim_through(&stack, light.origin, point).unwrap();
            assert!(
                (aim.vector() - light.direction.vector()).norm() < 1e-9,
                "{shape}"
            );
        }
    }
}

/// A ray whose distance from the axis or centre exceeds the radius passes by; one through the wall alone
/// misses the inner face. By geometry: at distance d from the middle it enters the glass at sine d/R and
/// passes the middle at d/1.5.
#[test]
fn light_that_passes_by_is_an_error_that_names_the_face() {
    for (outer, shape) in vessels() {
        let stack = stack(outer.clone(), &MEDIA);
        let offset = |d: f64| {
            let across = match &outer {
                Surface::Cylinder(c) => c.axis.vector().cross(&Vector3::z()).normalize(),
                _ => Vector3::x(),
            };
            Ray::new(
                Point::from_coords(across * d - Vector3::z() * 350.0),
                Direction::new(Vector3::z()).unwrap(),
            )
        };
        let r = radius(&outer);
        assert!(
            stack.trace(&offset(r - 0.01)).is_ok(),
            "{shape}: glass bends it inwards"
        );
        let miss = stack.trace(&offset(r + 0.01)).unwrap_err();
        assert_eq!(
            (miss.face, miss.problem),
            (0, TraceProblem::Miss),
            "{shape}"
        );
        let thick = Wall::exact(outer.clone(), 0.5 * r, None)
            .stack(&MEDIA, InsideMedium::Liquid)
            .unwrap();
        let within_glass = thick.trace(&offset(0.9 * r)).unwrap_err();
        assert_eq!(
            (within_glass.face, within_glass.problem),
            (1, TraceProblem::Miss),
            "{shape}"
        );
    }
}

#[test]
fn a_wall_thicker_than_its_vessel_is_an_error() {
    for (outer, shape) in vessels() {
        let thick = Wall::exact(outer.clone(), radius(&outer) + 1.0, None);
        let error = thick.stack(&MEDIA, InsideMedium::Liquid).unwrap_err();
        assert!(
            error.to_string().contains("vessel.wall_thickness"),
            "{shape}: {error}"
        );
    }
}

/// A free form without any height is what it stands on: light takes the same way through both.
#[test]
fn a_free_form_without_heights_bends_light_as_its_base_does() {
    let mut random = Random::seeded(56);
    let front = Point::new(0.0, 0.0, -350.0);
    for (outer, shape) in vessels() {
        let base = match &outer {
            Surface::Cylinder(cylinder) => Base::on_cylinder(cylinder, front),
            Surface::Sphere(sphere) => Base::on_sphere(sphere, front),
            flat => panic!("{flat:?} is not round"),
        };
        let corner = |x: f64, y: f64| Vector2::new(90.0 * x, 90.0 * y);
        let sheet = Sheet {
            base: base.unwrap(),
            grid: Grid {
                start: corner(-1.0, -1.0),
                step: Vector2::repeat(36.0),
                columns: 8,
                rows: 8,
            },
            heights: vec![0.0; 64],
            patch: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| corner(x, y))
                .to_vec(),
        };
        let free = stack(Surface::Freeform(Freeform::new(sheet)), &MEDIA);
        let round = stack(outer, &MEDIA);
        for _ in 0..200 {
            let light = light(&mut random);
            let (here, there) = (free.trace(&light).unwrap(), round.trace(&light).unwrap());
            assert!(here.origin.distance(there.origin) < 1e-9, "{shape}");
            let turned = here.direction.vector() - there.direction.vector();
            assert!(turned.norm() < 1e-11, "{shape}");
        }
    }
}
