//! Laws that light obeys at any number of faces, whoever traces it.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::{Random, assert_close, direction, face, lens, off_line, parallel_layers, ray};
use nalgebra::{DMatrix, DVector, Matrix3, Vector2, Vector3};
use snellius::geometry::{Direction, Plane, Point, Ray, World};
use snellius::optics::{
    AimError, Interface, Media, Stack, Surface, TraceProblem, aim_through, refract,
};
use snellius::scan::InsideMedium;
use snellius::vessel::Wall;

/// Five media (air, glass, water, plastic, oil) parted by four faces, each tilted by up to 5 degrees.
fn tilted_stack(random: &mut Random) -> Stack {
    let indices = [1.52, 1.333, 1.49, 1.47];
    let interfaces = indices.iter().enumerate().map(|(k, index)| {
        let normal = -random.forward::<World>(5.0).vector();
        face([0.0, 0.0, 60.0 * k as f64], normal, *index)
    });
    Stack {
        outside: 1.0,
        interfaces: interfaces.collect(),
    }
}

fn plane_of(interface: &Interface) -> Plane<World> {
    match &interface.surface {
        Surface::Plane(plane) => *plane,
        round => panic!("{round:?} is not flat"),
    }
}

fn normal_of(interface: &Interface) -> Direction<World> {
    plane_of(interface).normal
}

fn eye(random: &mut Random) -> Point<World> {
    Point::from_coords(random.vector(80.0) + Vector3::new(0.0, 0.0, -350.0))
}

/// n1 sin a = n2 sin b with light, normal and bent light in one plane is one equation of vectors:
/// n1 d x N = n2 t x N (Born & Wolf, Principles of Optics, section 3.2.2).
#[test]
fn light_obeys_snells_law_at_a_face() {
    let mut random = Random::seeded(1);
    let mut bent = 0;
    for _ in 0..2000 {
        let (light, normal) = (random.direction::<World>(), random.direction());
        let (n1, n2) = (random.between(1.0, 2.5), random.between(1.0, 2.5));
        let Ok(after) = refract(light, normal, n1, n2) else {
            continue;
        };
        bent += 1;
        let before = light.vector().cross(&normal.vector()) * n1;
        assert!((before - after.vector().cross(&normal.vector()) * n2).norm() < 1e-14);
        assert_close(after.vector().norm(), 1.0, 1e-15);
        assert!(
            light.dot(normal) * after.dot(normal) >= 0.0,
            "it goes on, through the face"
        );
    }
    assert!(bent > 1000);
}

#[test]
fn light_obeys_snells_law_at_every_face_of_a_stack() {
    let mut random = Random::seeded(2);
    for _ in 0..300 {
        let stack = tilted_stack(&mut random);
        let light = Ray::new(eye(&mut random), random.forward(20.0));
        let path = stack.path(&light).unwrap();
        assert_eq!(path.vertices.len(), 5);
        let mut legs: Vec<_> = path
            .vertices
            .windows(2)
            .map(|v| (v[1] - v[0]).normalize())
            .collect();
        legs.push(path.last.direction.vector());
        let mut n1 = stack.outside;
        for (face, leg) in stack.interfaces.iter().zip(legs.windows(2)) {
            let normal = normal_of(face).vector();
            let n2 = face.index_behind;
            assert!((leg[0].cross(&normal) * n1 - leg[1].cross(&normal) * n2).norm() < 1e-12);
            n1 = n2;
        }
        let Ok(last) = stack.trace(&light) else {
            panic!("path() got through")
        };
        assert_eq!(last, path.last);
    }
}

/// The critical angle of glass (1.5) against air is asin(1/1.5) = 41.8103 degrees (any textbook).
#[test]
fn beyond_the_critical_angle_light_is_thrown_back() {
    let normal = direction::<World>([0.0, 0.0, -1.0]);
    let at = |degrees: f64| {
        let angle = degrees.to_radians();
        refract(direction([angle.sin(), 0.0, angle.cos()]), normal, 1.5, 1.0)
    };
    assert!(at(41.81).is_ok());
    let thrown_back = at(41.811).unwrap_err();
    assert_close(
        thrown_back.critical.to_degrees(),
        41.810_314_895_778_6,
        1e-12,
    );
    assert_close(thrown_back.incidence.to_degrees(), 41.811, 1e-12);
    assert!(thrown_back.to_string().contains("41.81"), "{thrown_back}");
    // Just below it the light leaves along the face.
    let grazing = at(41.810_314_895_7).unwrap().vector();
    assert!(grazing.z > 0.0 && grazing.z < 1e-4);
}

/// A prism of 60 degrees: light that enters square to the first face meets the second at 60 degrees.
#[test]
fn a_stack_names_the_face_that_throws_light_back() {
    let second = [
        60.0_f64.to_radians().sin(),
        0.0,
        -60.0_f64.to_radians().cos(),
    ];
    let prism = Stack {
        outside: 1.0,
        interfaces: vec![
            face([0.0; 3], [0.0, 0.0, -1.0], 1.5),
            face([0.0, 0.0, 30.0], second, 1.0),
        ],
    };
    let stopped = prism
        .trace(&ray([0.0, 0.0, -100.0], [0.0, 0.0, 1.0]))
        .unwrap_err();
    assert_eq!(stopped.face, 1);
    let TraceProblem::TotalReflection(reflection) = stopped.problem else {
        panic!("{stopped}");
    };
    assert_close(reflection.incidence.to_degrees(), 60.0, 1e-12);
    assert_close(reflection.critical, (1.0_f64 / 1.5).asin(), 1e-15);
}

/// A plate in air shifts light by t sin(a - b) / cos b and leaves it parallel to itself (Hecht, Optics).
#[test]
fn a_plate_shifts_light_parallel_to_itself() {
    let mut random = Random::seeded(3);
    for _ in 0..300 {
        let (t, n, a) = (
            random.between(0.5, 20.0),
            random.between(1.2, 2.0),
            random.between(0.0, 1.4),
        );
        let plate = parallel_layers(1.0, &[(t, n), (0.0, 1.0)]);
        let light = ray::<World>([7.0, -3.0, -120.0], [a.sin(), 0.0, a.cos()]);
        let out = plate.trace(&light).unwrap();
        let b = (a.sin() / n).asin();
        assert!((out.direction.vector() - light.direction.vector()).norm() < 1e-14);
        // Slanting light runs hundreds of millimetres here: 1e-12 of the way is what rounding leaves.
        assert_close(
            off_line(out.origin, &light),
            t * (a - b).sin() / b.cos(),
            1e-11,
        );
    }
}

/// 0.742462120246 mm and 22.082413194 degrees: optiland 0.6.3, prysm 0.21.1 and rayoptics 0.9.8 agree on
/// them to 1e-16, a 40-digit solution of Fermat's principle to 1.2e-13 mm.
#[test]
fn a_ray_at_30_degrees_goes_through_a_tanks_wall_as_other_programs_say() {
    let tank = parallel_layers(1.0, &[(2.1, 1.5), (0.0, 1.33)]);
    let thirty = 30.0_f64.to_radians();
    let path = tank
        .path(&ray([0.0, 0.0, 0.0], [thirty.sin(), 0.0, thirty.cos()]))
        .unwrap();
    let inner = path.vertices[2].coords;
    assert_close(inner.x, 0.742_462_120_246, 1e-12);
    assert_close(inner.z, 2.1, 1e-15);
    let in_water = path.last.direction.vector();
    assert_close(
        in_water.x.atan2(in_water.z).to_degrees(),
        22.082_413_194,
        1e-9,
    );
}

#[test]
fn where_all_media_are_the_same_light_goes_straight() {
    let mut random = Random::seeded(4);
    for _ in 0..200 {
        let mut stack = tilted_stack(&mut random);
        stack.outside = 1.333;
        stack
            .interfaces
            .iter_mut()
            .for_each(|face| face.index_behind = 1.333);
        let light = Ray::new(eye(&mut random), random.forward(20.0));
        let path = stack.path(&light).unwrap();
        assert!((path.last.direction.vector() - light.direction.vector()).norm() < 1e-14);
        assert!(path.vertices.iter().all(|v| off_line(*v, &light) < 1e-10));
    }
}

#[test]
fn a_wall_is_two_planes_a_thickness_apart() {
    let mut random = Random::seeded(5);
    let media = Media {
        outside: 1.0,
        wall: 1.5,
        liquid: 1.33,
    };
    for _ in 0..100 {
        let outer = Plane::new(
            Point::from_coords(random.vector(20.0)),
            -random.forward::<World>(30.0),
        );
        let thickness = random.between(0.5, 15.0);
        let wall = Wall::exact(Surface::Plane(outer), thickness, None);
        let inner = outer.point.coords - outer.normal.vector() * thickness;
        let planes = Stack {
            outside: 1.0,
            interfaces: vec![
                face(outer.point.to_array(), outer.normal.vector(), 1.5),
                face(inner.into(), outer.normal.vector(), 1.33),
            ],
        };
        let light = Ray::new(eye(&mut random), random.forward(30.0));
        let slab = wall.stack(&media, InsideMedium::Liquid).unwrap();
        assert_eq!(slab.trace(&light), planes.trace(&light));
    }
}

#[test]
fn light_returns_the_way_it_came() {
    let mut random = Random::seeded(6);
    for _ in 0..300 {
        let stack = tilted_stack(&mut random);
        let light = Ray::new(eye(&mut random), random.forward(20.0));
        let there = stack.trace(&light).unwrap();
        let back = reversed(&stack)
            .trace(&Ray::new(there.at(75.0), -there.direction))
            .unwrap();
        assert!((back.direction.vector() + light.direction.vector()).norm() < 1e-13);
        assert!(off_line(light.origin, &back) < 1e-10);
    }
}

/// The same faces as light from behind meets them.
fn reversed(stack: &Stack) -> Stack {
    let mut before = vec![stack.outside];
    before.extend(stack.interfaces.iter().map(|face| face.index_behind));
    let interfaces = stack
        .interfaces
        .iter()
        .zip(&before)
        .rev()
        .map(|(face, index)| {
            let plane = plane_of(face);
            Interface {
                surface: Surface::Plane(Plane::new(plane.point, -plane.normal)),
                index_behind: *index,
            }
        });
    Stack {
        outside: stack.innermost_index(),
        interfaces: interfaces.collect(),
    }
}

/// Fermat: of all paths over the faces light takes the one of least time. The crossings are found by
/// minimising the optical path alone; no law of refraction is in it.
#[test]
fn light_takes_the_path_of_least_time() {
    let mut random = Random::seeded(7);
    for _ in 0..60 {
        let stack = tilted_stack(&mut random);
        let from = eye(&mut random);
        let to = Point::from_coords(random.vector(60.0) + Vector3::new(0.0, 0.0, 270.0));
        let aim = aim_through(&stack, from, to).unwrap();
        let path = stack.path(&Ray::new(from, aim)).unwrap();
        let crossings = quickest_crossings(&stack, from, to);
        for (traced, quickest) in path.vertices[1..].iter().zip(&crossings) {
            assert!(
                (traced.coords - quickest).norm() < 1e-7,
                "{traced:?} {quickest}"
            );
        }
        // And it is a minimum: every other path is longer.
        let least = optical_path(&stack, from, to, &crossings);
        for _ in 0..20 {
            let detour: Vec<_> = stack
                .interfaces
                .iter()
                .zip(&crossings)
                .map(|(face, c)| {
                    let (u, v) = normal_of(face).tangents();
                    c + u * random.between(-3.0, 3.0) + v * random.between(-3.0, 3.0)
                })
                .collect();
            assert!(optical_path(&stack, from, to, &detour) > least);
        }
    }
}

fn indices(stack: &Stack) -> Vec<f64> {
    let behind = stack.interfaces.iter().map(|face| face.index_behind);
    std::iter::once(stack.outside).chain(behind).collect()
}

fn optical_path(
    stack: &Stack,
    from: Point<World>,
    to: Point<World>,
    crossings: &[Vector3<f64>],
) -> f64 {
    let mut places = vec![from.coords];
    places.extend(crossings);
    places.push(to.coords);
    let legs = places.windows(2).zip(indices(stack));
    legs.map(|(leg, n)| n * (leg[1] - leg[0]).norm()).sum()
}

/// Newton's method on the optical path, which is a convex function of the crossings: a sum of lengths.
fn quickest_crossings(stack: &Stack, from: Point<World>, to: Point<World>) -> Vec<Vector3<f64>> {
    let faces = stack.interfaces.len();
    let axes: Vec<_> = stack
        .interfaces
        .iter()
        .map(|face| normal_of(face).tangents())
        .collect();
    let mut at: Vec<Vector3<f64>> = stack
        .interfaces
        .iter()
        .map(|face| {
            let plane = plane_of(face);
            plane.point.coords
        })
        .collect();
    for _ in 0..100 {
        let mut gradient = DVector::<f64>::zeros(2 * faces);
        let mut curvature = DMatrix::<f64>::zeros(2 * faces, 2 * faces);
        for (leg, n) in indices(stack).into_iter().enumerate() {
            let start = if leg == 0 { from.coords } else { at[leg - 1] };
            let end = if leg == faces { to.coords } else { at[leg] };
            let length = (end - start).norm();
            let along = (end - start) / length;
            let bend = (Matrix3::identity() - along * along.transpose()) * (n / length);
            // The leg's length grows as its end moves along and its start moves back.
            let ends: Vec<_> = [
                (leg.checked_sub(1), -1.0),
                ((leg < faces).then_some(leg), 1.0),
            ]
            .into_iter()
            .filter_map(|(face, sign)| Some((face?, sign)))
            .flat_map(|(f, sign)| [(2 * f, axes[f].0 * sign), (2 * f + 1, axes[f].1 * sign)])
            .collect();
            for (row, u) in &ends {
                gradient[*row] += n * along.dot(u);
                for (column, v) in &ends {
                    curvature[(*row, *column)] += u.dot(&(bend * v));
                }
            }
        }
        let step = curvature.lu().solve(&gradient).unwrap();
        let moved = |part: f64| -> Vec<Vector3<f64>> {
            let step = &step * part;
            (0..faces)
                .map(|f| at[f] - (axes[f].0 * step[2 * f] + axes[f].1 * step[2 * f + 1]))
                .collect()
        };
        // Far off, the step is shortened until it helps; near the minimum lengths no longer tell.
        let now = optical_path(stack, from, to, &at);
        let helps =
            |part: &f64| step.norm() < 1e-3 || optical_path(stack, from, to, &moved(*part)) < now;
        let part = [1.0, 0.5, 0.25, 0.1, 0.01].into_iter().find(helps);
        at = moved(part.expect("a step that shortens the path"));
        if step.norm() < 1e-11 {
            break;
        }
    }
    at
}

/// Forward projection undoes tracing: a point on a pixel's refracted line of sight is seen at that pixel.
#[test]
fn a_traced_point_is_seen_at_its_pixel() {
    let mut random = Random::seeded(8);
    let camera = lens();
    for _ in 0..200 {
        let stack = tilted_stack(&mut random);
        let world_from_camera = common::SeenFrom::from_parts(
            nalgebra::UnitQuaternion::from_scaled_axis(random.vector(0.2)),
            eye(&mut random).coords,
        );
        let pixel =
            snellius::camera::Pixel::new(random.between(0.0, 799.0), random.between(0.0, 599.0));
        let sight = Ray::new(Point::origin(), camera.slope(pixel).unwrap().direction());
        let inside = stack.trace(&world_from_camera.ray(&sight)).unwrap();
        let point = inside.at(random.between(1.0, 200.0));
        let aim = aim_through(&stack, world_from_camera.point(Point::origin()), point).unwrap();
        let ahead = world_from_camera.inverse().direction(aim).vector();
        let seen = camera.project(Point::from_coords(ahead)).unwrap();
        assert!(seen.distance(pixel) < 1e-6, "{seen:?} {pixel:?}");
    }
}

/// Through parallel layers the sine s of the angle in air solves sum_k t_k s / sqrt(n_k^2 - s^2) = R, one
/// rising function of s, solved here by halving the interval.
#[test]
fn aiming_through_parallel_layers_solves_their_one_equation() {
    let mut random = Random::seeded(9);
    for _ in 0..200 {
        let distance = random.between(100.0, 500.0);
        let layers =
            [2.1, 30.0, 5.0, random.between(5.0, 300.0)].map(|t| (t, random.between(1.0, 2.0)));
        let target = Vector2::new(random.between(-300.0, 300.0), random.between(-300.0, 300.0));
        let depth: f64 = layers.iter().map(|(t, _)| t).sum();
        let way = |s: f64| -> f64 {
            let through = |(t, n): &(f64, f64)| t * s / (n * n - s * s).sqrt();
            through(&(distance, 1.0)) + layers.iter().map(through).sum::<f64>()
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if way(middle) < target.norm() {
                low = middle;
            } else {
                high = middle;
            }
        }
        let aim = aim_through(
            &parallel_layers(1.0, &layers),
            Point::new(0.0, 0.0, -distance),
            Point::new(target.x, target.y, depth),
        )
        .unwrap()
        .vector();
        assert!((Vector2::new(aim.x, aim.y) - target.normalize() * low).norm() < 1e-11);
    }
}

/// From water into air there is a way to every point, though the straight line to it may meet the face
/// beyond the critical angle of 48.75 degrees.
#[test]
fn an_eye_in_the_denser_medium_sees_points_far_to_the_side() {
    let window = parallel_layers(1.333, &[(5.0, 1.5), (0.0, 1.0)]);
    let target = Point::new(260.0, 40.0, 60.0);
    let eye = Point::new(0.0, 0.0, -60.0);
    let aim = aim_through(&window, eye, target).unwrap();
    let arriving = window.trace(&Ray::new(eye, aim)).unwrap();
    assert!(off_line(target, &arriving) < 1e-7);
}

#[test]
fn light_that_misses_a_face_is_an_error_that_names_it() {
    let tank = parallel_layers(1.0, &[(2.1, 1.5), (0.0, 1.33)]);
    for along in [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.3, 0.0, -0.1]] {
        let miss = tank.trace(&ray([0.0, 0.0, -100.0], along)).unwrap_err();
        assert_eq!(
            (miss.face, miss.problem),
            (0, TraceProblem::Miss),
            "{along:?}"
        );
    }
    // A face that stands across the first lies behind the light.
    let mut crossed = tank;
    crossed.interfaces[1] = face([-50.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 1.33);
    let miss = crossed
        .trace(&ray([0.0, 0.0, -100.0], [0.1, 0.0, 1.0]))
        .unwrap_err();
    assert_eq!((miss.face, miss.problem), (1, TraceProblem::Miss));
}

#[test]
fn what_cannot_be_aimed_at_is_an_error() {
    let tank = parallel_layers(1.0, &[(2.1, 1.5), (0.0, 1.33)]);
    let eye = Point::new(0.0, 0.0, -300.0);
    let at_itself = aim_through(&tank, eye, eye).unwrap_err();
    assert!(
        matches!(at_itself, AimError::NotReached { .. }),
        "{at_itself}"
    );
    let behind_the_eye = aim_through(&tank, eye, Point::new(0.0, 10.0, -600.0)).unwrap_err();
    assert!(matches!(behind_the_eye, AimError::Blocked(e) if e.problem == TraceProblem::Miss));
}
