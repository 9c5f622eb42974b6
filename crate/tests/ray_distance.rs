//! The ray distance l against the refractive index n: its closed form behind a flat wall, and where it
//! says nothing at all.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::{Random, assert_close, parallel_layers};
use nalgebra::{Vector2, Vector3};
use snellius::geometry::{Approach, Direction, Plane, Point, Ray, World, closest_approach};
use snellius::optics::{
    Base, Cylinder, Freeform, Grid, Interface, Sheet, Sphere, Stack, Surface, aim_through,
};

const WALL: f64 = 1.5;

/// A beam and a line of sight in air that meet at one point behind the wall z = 0 if the index is `n0`.
struct Rig {
    thickness: f64,
    beam: Ray<World>,
    sight: Ray<World>,
    /// Depth of the point behind the inner face.
    depth: f64,
    n0: f64,
}

fn tank(thickness: f64, n: f64) -> Stack {
    parallel_layers(1.0, &[(thickness, WALL), (0.0, n)])
}

impl Rig {
    fn meeting_at(
        laser: [f64; 3],
        camera: [f64; 3],
        point: [f64; 3],
        thickness: f64,
        n0: f64,
    ) -> Self {
        let tank = tank(thickness, n0);
        let towards = |from: [f64; 3]| {
            let from = Point::from(from);
            Ray::new(from, aim_through(&tank, from, Point::from(point)).unwrap())
        };
        Self {
            thickness,
            beam: towards(laser),
            sight: towards(camera),
            depth: point[2] - thickness,
            n0,
        }
    }

    /// Both light paths traced, as if the index were `n`.
    fn traced(&self, n: f64) -> Approach<World> {
        let tank = tank(self.thickness, n);
        closest_approach(
            &tank.trace(&self.beam).unwrap(),
            &tank.trace(&self.sight).unwrap(),
        )
        .unwrap()
    }

    /// With s_L, s_C the sines of the angles of incidence in air, phi the angle between the two planes of
    /// incidence, z the depth, a = asin(s_L/n), b = asin(s_C/n), cos psi = sin a sin b cos phi + cos a cos b:
    ///
    /// ```text
    /// D(n) = z [ sqrt((n^2 - s_L^2)/(n0^2 - s_L^2)) - sqrt((n^2 - s_C^2)/(n0^2 - s_C^2)) ]
    /// l(n) = |D(n)| sin a sin b |sin phi| / sin psi
    /// ```
    ///
    /// Derived by hand: each refracted ray crosses the normal through its entry at a depth that scales
    /// by the square root; wall and thickness drop out.
    fn closed_form(&self, n: f64) -> f64 {
        let (l, c) = (flat(self.beam.direction), flat(self.sight.direction));
        let (s_l, s_c) = (l.norm(), c.norm());
        let stretch = |s: f64| ((n * n - s * s) / (self.n0 * self.n0 - s * s)).sqrt();
        let (sin_a, sin_b) = (s_l / n, s_c / n);
        let cos_phi = l.dot(&c) / (s_l * s_c);
        let sin_phi = l.cross(&c).norm() / (s_l * s_c);
        let cos_psi =
            sin_a * sin_b * cos_phi + (1.0 - sin_a * sin_a).sqrt() * (1.0 - sin_b * sin_b).sqrt();
        let difference = self.depth * (stretch(s_l) - stretch(s_c));
        difference.abs() * sin_a * sin_b * sin_phi / (1.0 - cos_psi * cos_psi).sqrt()
    }
}

/// The part along the wall.
fn flat(direction: Direction<World>) -> Vector3<f64> {
    let mut along = direction.vector();
    along.z = 0.0;
    along
}

#[test]
fn tracing_agrees_with_the_closed_form_of_the_ray_distance() {
    let mut random = Random::seeded(21);
    let mut largest: f64 = 0.0;
    for _ in 0..2000 {
        let mut place = |z: f64| {
            [
                random.between(-250.0, 250.0),
                random.between(-250.0, 250.0),
                z,
            ]
        };
        let (laser, camera) = (place(-350.0), place(-400.0));
        let thickness = random.between(0.5, 10.0);
        let point = [
            random.between(-50.0, 50.0),
            random.between(-50.0, 50.0),
            thickness + random.between(5.0, 200.0),
        ];
        let rig = Rig::meeting_at(laser, camera, point, thickness, random.between(1.1, 1.6));
        assert!(
            rig.traced(rig.n0).gap.abs() < 1e-9,
            "the rays meet where the index is right"
        );
        assert!((rig.traced(rig.n0).midpoint() - Point::from(point)).norm() < 1e-6);
        let n = random.between(1.0, 1.8);
        let traced = rig.traced(n).gap.abs();
        assert_close(traced, rig.closed_form(n), 1e-9);
        largest = largest.max(traced);
    }
    assert!(largest > 1.0, "the index shows in these rigs: {largest} mm");
}

/// The paper's own set-up, most likely: laser, camera and the wall's normal in one plane.
#[test]
fn in_a_mirror_plane_the_ray_distance_is_0_for_every_index() {
    let mut random = Random::seeded(22);
    for _ in 0..200 {
        let x = |random: &mut Random| random.between(-200.0, 200.0);
        let rig = Rig::meeting_at(
            [x(&mut random), 0.0, -350.0],
            [x(&mut random), 0.0, -400.0],
            [x(&mut random), 0.0, 80.0],
            2.1,
            1.333,
        );
        assert_blind_but_moving(&rig);
    }
}

/// Beam and line of sight at equal angles to the wall, however they are turned about its normal.
#[test]
fn at_equal_angles_the_ray_distance_is_0_for_every_index() {
    let mut random = Random::seeded(23);
    for _ in 0..200 {
        let (radius, turn) = (random.between(50.0, 250.0), random.between(0.2, 3.0));
        let rig = Rig::meeting_at(
            [radius, 0.0, -380.0],
            [radius * turn.cos(), radius * turn.sin(), -380.0],
            [0.0, 0.0, 80.0],
            2.1,
            1.333,
        );
        assert_blind_but_moving(&rig);
    }
}

/// A bulge over a round wall, the same to the left and the right, above and below.
fn bulge(jar: &Cylinder) -> Surface {
    let at = |i: i32| 36.0 * (f64::from(i) - 3.5);
    let height = |x: f64, y: f64| 5.0 * (-(x * x + y * y) / (2.0 * 50.0 * 50.0)).exp();
    let heights = (0..8).flat_map(|row| (0..8).map(move |column| height(at(column), at(row))));
    let corner = |x: f64, y: f64| Vector2::new(90.0 * x, 90.0 * y);
    Surface::Freeform(Freeform::new(Sheet {
        base: Base::on_cylinder(jar, Point::new(0.0, 0.0, -350.0)).unwrap(),
        grid: Grid {
            start: corner(-1.0, -1.0),
            step: Vector2::repeat(36.0),
            columns: 8,
            rows: 8,
        },
        heights: heights.collect(),
        patch: [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| corner(x, y))
            .to_vec(),
    }))
}

/// Other walls have mirror planes too: any through a ball's middle or a jar's axis, those across the axis,
/// and those of a bulge. In one the rays meet for every index; so they do where a mirror swaps the two.
#[test]
fn before_walls_of_every_shape_mirrors_make_the_ray_distance_0_for_every_index() {
    let radius = 90.0;
    let centre = Point::new(0.0, 0.0, radius);
    let jar = |axis: [f64; 3]| Cylinder {
        point: centre,
        axis: Direction::new(axis.into()).unwrap(),
        radius,
    };
    let ball = Surface::Sphere(Sphere { centre, radius });
    let flat = Surface::Plane(Plane::new(
        Point::origin(),
        Direction::new([0.0, 0.0, -1.0].into()).unwrap(),
    ));
    let (upright, lying) = (jar([0.0, 1.0, 0.0]), jar([1.0, 0.0, 0.0]));
    let bulge = bulge(&upright);
    let walls = [
        Surface::Cylinder(upright),
        Surface::Cylinder(lying),
        ball,
        flat,
        bulge,
    ];
    // In the plane y = 0; and swapped by the mirror x = 0.
    let in_plane = ([-150.0, 0.0, -380.0], [20.0, 0.0, -400.0], [9.0, 0.0, 60.0]);
    let swapped = (
        [-80.0, 60.0, -390.0],
        [80.0, 60.0, -390.0],
        [0.0, -9.0, 60.0],
    );
    for wall in &walls {
        for (laser, camera, point) in [in_plane, swapped] {
            let stack = |n: f64| Stack {
                outside: 1.0,
                interfaces: vec![
                    Interface {
                        surface: wall.clone(),
                        index_behind: WALL,
                    },
                    Interface {
                        surface: wall.behind(2.1).unwrap(),
                        index_behind: n,
                    },
                ],
            };
            let towards = |from: [f64; 3]| {
                let from = Point::from(from);
                let aim = aim_through(&stack(1.333), from, Point::from(point)).unwrap();
                Ray::new(from, aim)
            };
            let (beam, sight) = (towards(laser), towards(camera));
            for n in [1.0, 1.2, 1.333, 1.5, 1.9] {
                let there = stack(n);
                let rays = (there.trace(&beam).unwrap(), there.trace(&sight).unwrap());
                let gap = closest_approach(&rays.0, &rays.1).unwrap().gap;
                assert!(gap.abs() < 1e-7, "l({n}) = {gap} behind {wall:?}");
            }
        }
    }
}

/// The ray distance tells nothing of the index, though the point moves with it.
#[track_caller]
fn assert_blind_but_moving(rig: &Rig) {
    let right = rig.traced(rig.n0).midpoint();
    for n in [1.0, 1.2, 1.333, 1.5, 1.9] {
        let meeting = rig.traced(n);
        assert!(meeting.gap.abs() < 1e-9, "l({n}) = {}", meeting.gap);
        let moved = (meeting.midpoint() - right).z.abs();
        assert!(moved > 1.0 || (n - rig.n0).abs() < 0.1, "{moved}");
    }
}
