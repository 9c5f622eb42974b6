//! The range finder in air: triangulation, the order of spots along the beam, the hand's poses.
#![cfg(not(target_family = "wasm"))]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::pictures::{Light, pair};
use common::{Random, assert_close, lens, ray};
use nalgebra::{Isometry3, Translation3, Vector3};
use snellius::camera::{Distortion, Intrinsics, Slope};
use snellius::geometry::{Camera, Flange, Point, Pose, Ray, World, closest_approach};
use snellius::optics::Media;
use snellius::rig::{Laser, Rig};
use snellius::scan::{Manifest, Scan};
use snellius::spots::{SpotSettings, Spots, find_spots};
use snellius::vessel::{VesselSettings, find_vessel};

fn rig(beam: Ray<Camera>) -> Rig {
    Rig {
        camera: lens(),
        laser: Laser::Beam(beam),
        flange_from_camera: Pose::identity(),
    }
}

/// A beam parallel to the optical axis, a baseline b beside it: z = b f / (u - c) for an ideal lens.
#[test]
fn a_parallel_beam_is_triangulated_by_similar_triangles() {
    let ideal = Intrinsics {
        distortion: Distortion::default(),
        ..lens()
    };
    let baseline = -160.0;
    let line = rig(ray([baseline, 0.0, 0.0], [0.0, 0.0, 1.0]))
        .epipolar_line()
        .unwrap();
    for u in [0.0, 50.0, 123.4, 380.0] {
        let sight = ideal
            .slope(snellius::camera::Pixel::new(u, ideal.centre.v))
            .unwrap();
        let found = line.triangulate(sight).unwrap();
        let depth = baseline * ideal.focal[0] / (u - ideal.centre.u);
        assert_close(found.point.coords.z, depth, 1e-10 * depth);
        assert_close(found.point.coords.x, baseline, 1e-12);
        assert_close(found.along, depth, 1e-10 * depth);
        assert_close(found.off_line.unwrap(), 0.0, 1e-15);
    }
}

/// A beam tilted by theta towards the axis, in the plane of the picture's rows:
/// -b + z tan theta = z x, so z = b / (tan theta - x).
#[test]
fn a_tilted_beam_is_triangulated_by_the_law_of_its_triangle() {
    let (b, theta) = (160.0_f64, 19.6_f64.to_radians());
    let line = rig(ray([-b, 0.0, 0.0], [theta.sin(), 0.0, theta.cos()]))
        .epipolar_line()
        .unwrap();
    for x in [-0.3, -0.1, 0.0, 0.2] {
        let found = line.triangulate(Slope { x, y: 0.0 }).unwrap();
        let depth = b / (theta.tan() - x);
        assert_close(found.point.coords.z, depth, 1e-11 * depth);
        assert_close(found.along, depth / theta.cos(), 1e-11 * depth);
    }
    // At the slope of the beam itself they would meet at infinity, beyond it behind the rig.
    assert!(
        line.triangulate(Slope {
            x: theta.tan() + 0.01,
            y: 0.0
        })
        .is_none()
    );
}

/// Whatever the beam, the sight of a point on it leads back to that point, through a real lens.
#[test]
fn a_point_of_any_beam_is_found_again() {
    let mut random = Random::seeded(31);
    let mut seen = 0;
    for _ in 0..500 {
        let beam = Ray::new(
            Point::from_coords(random.vector(200.0)),
            random.forward(30.0),
        );
        let (rig, along) = (rig(beam), random.between(150.0, 900.0));
        let Some(pixel) = rig.camera.project(beam.at(along)) else {
            continue;
        };
        let Ok(sight) = rig.camera.slope(pixel) else {
            continue;
        };
        if (beam.at(along) - beam.origin)
            .cross(&beam.at(along).coords)
            .norm()
            < 1000.0
        {
            continue; // beam and sight all but parallel
        }
        seen += 1;
        let found = rig.epipolar_line().unwrap().triangulate(sight).unwrap();
        assert!(
            found.point.distance(beam.at(along)) < 1e-8,
            "{found:?} {along}"
        );
    }
    assert!(seen > 300, "{seen}");
}

/// A sight beside the line is moved onto it by the shortest way, and the point lies on the beam. Without
/// that move the nearest point of the beam to the sight would be taken: for small offsets nearly the same.
#[test]
fn a_sight_beside_the_line_gives_the_point_of_its_foot() {
    let beam = ray([-160.0, 3.0, 4.0], [0.336, -0.006, 0.942]);
    let line = rig(beam).epipolar_line().unwrap();
    let on = Slope::of(beam.at(400.0)).unwrap();
    let ahead = Slope::of(beam.at(401.0)).unwrap();
    let along = nalgebra::Vector2::new(ahead.x - on.x, ahead.y - on.y).normalize();
    for off in [-2e-3, 1e-4, 3e-3] {
        let beside = Slope {
            x: on.x - off * along.y,
            y: on.y + off * along.x,
        };
        let found = line.triangulate(beside).unwrap();
        assert_close(found.off_line.unwrap().abs(), off.abs(), 1e-15);
        assert_close(found.along, 400.0, 1e-8);
        let sight = Ray::new(Point::origin(), beside.direction());
        let nearest = closest_approach(&beam, &sight).unwrap();
        assert!(nearest.first.distance(found.point) < 300.0 * off.abs());
    }
}

/// The vessel's spot is the first along the line from the laser's side: the left-most with the laser on
/// the left (section II-C of the paper), and so on around.
#[test]
fn the_vessels_spot_is_the_first_from_the_lasers_side() {
    for (origin, side) in [
        ([-160.0, 0.0, 0.0], Vector3::new(-1.0, 0.0, 0.0)),
        ([160.0, 0.0, 0.0], Vector3::new(1.0, 0.0, 0.0)),
        ([0.0, -160.0, 0.0], Vector3::new(0.0, -1.0, 0.0)),
        ([0.0, 160.0, 0.0], Vector3::new(0.0, 1.0, 0.0)),
    ] {
        let inwards = Vector3::from(origin) * -0.336 / 160.0 + Vector3::new(0.0, 0.0, 0.942);
        let scan = nine_stations(origin, inwards.into());
        let beam = scan.rig.laser.axis();
        let seen_at = |z: f64| {
            let along = (z - beam.origin.coords.z) / beam.direction.vector().z;
            scan.rig.camera.project(beam.at(along)).unwrap()
        };
        // Behind the wall z = 400 something brighter, on the line too.
        let spots: Vec<Spots> = (0..9)
            .map(|k| {
                let (wall, beyond) = (seen_at(400.0), seen_at(450.0 + f64::from(k)));
                let towards_laser = (wall.u - beyond.u) * side.x + (wall.v - beyond.v) * side.y;
                assert!(
                    towards_laser > 20.0,
                    "the wall's spot is nearer to the laser's side"
                );
                let dark = Light::of(800, 600, |_, _| 1000.0);
                let lit = dark
                    .clone()
                    .with_spot(wall, 4e3, 1.5)
                    .with_spot(beyond, 2e4, 1.5);
                let pictures = pair(lit.still(u16::MAX), dark.still(u16::MAX));
                find_spots(&pictures, &SpotSettings::default())
            })
            .collect();
        let settings = VesselSettings {
            separate_glows: false,
            ..VesselSettings::default()
        };
        let media = Media {
            outside: 1.0,
            wall: 1.5,
            liquid: 1.33,
        };
        let vessel = find_vessel(&scan, &spots, &media, &settings).unwrap();
        for (points, station) in vessel.points.iter().zip(&scan.stations) {
            let point = points.first().expect("a vessel point in every view");
            assert!(
                point.pixel.distance(seen_at(400.0)) < 0.01,
                "laser at {origin:?}"
            );
            let in_camera = station.world_from_camera.inverse().point(point.point);
            assert_close(in_camera.coords.z, 400.0, 0.05);
            assert_close(point.off_line.unwrap(), 0.0, 0.01);
        }
    }
}

/// A scan by a level rig that stands in three rows of three.
fn nine_stations(origin: [f64; 3], direction: [f64; 3]) -> Scan {
    let pose =
        |x: f64, y: f64| serde_json::json!({ "rotation": [1, 0, 0, 0], "translation": [x, y, 0] });
    let views: Vec<_> = (0..9)
        .map(|k| {
            let at = pose(30.0 * f64::from(k % 3), 30.0 * f64::from(k / 3));
            serde_json::json!({ "id": k.to_string(), "on": "on.png", "world_from_flange": at })
        })
        .collect();
    let manifest = serde_json::json!({
        "format": "refractive-scan", "version": 1, "length_unit": "mm",
        "camera": { "model": "opencv", "width": 800, "height": 600,
                    "fx": 1102.5, "fy": 1101.8, "cx": 403.2, "cy": 296.4,
                    "distortion": [-0.112, 0.061, 0.0006, -0.0004, 0.0] },
        "laser": { "kind": "spot", "origin": origin, "direction": direction },
        "flange_from_camera": pose(0.0, 0.0),
        "vessel": { "shape": "plane", "wall_thickness": 2.1 },
        "media": { "outside": 1.0, "wall": 1.5, "inside": 1.33 },
        "views": views,
    });
    Scan::new(Manifest::from_json(manifest.to_string().as_bytes()).unwrap()).unwrap()
}

fn isometry<A: snellius::geometry::Frame, B: snellius::geometry::Frame>(
    pose: &Pose<A, B>,
) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(pose.translation()), pose.rotation())
}

/// nalgebra's `Isometry3` is the independent implementation.
#[test]
fn poses_compose_and_invert_like_rigid_motions() {
    let mut random = Random::seeded(32);
    for _ in 0..200 {
        let world_from_flange: Pose<World, Flange> = random.pose();
        let flange_from_camera: Pose<Flange, Camera> = random.pose();
        let world_from_camera = world_from_flange * flange_from_camera;
        let expected = isometry(&world_from_flange) * isometry(&flange_from_camera);
        let point = Point::<Camera>::from_coords(random.vector(500.0));
        let mapped = world_from_camera.point(point);
        assert!(
            (mapped.coords - expected.transform_point(&point.coords.into()).coords).norm() < 1e-11
        );
        assert!(world_from_camera.inverse().point(mapped).distance(point) < 1e-11);
        let light = Ray::new(point, random.direction());
        let there = world_from_camera.ray(&light);
        assert!(
            there
                .at(100.0)
                .distance(world_from_camera.point(light.at(100.0)))
                < 1e-11
        );
    }
}

/// By hand: the camera sits 10 mm above the hand (y down), turned by 90 degrees about z; the hand is
/// 100 mm along x. Camera x is then the hand's y: a point 5 mm to the camera's right is 5 mm below it.
#[test]
fn a_station_is_hand_eye_carried_by_the_hand() {
    let rig = Rig {
        flange_from_camera: Pose::new([1.0, 0.0, 0.0, 1.0], [0.0, -10.0, 0.0]).unwrap(),
        ..rig(ray([-160.0, 0.0, 0.0], [0.3, 0.0, 1.0]))
    };
    let station = rig.station(&Pose::new([2.0, 0.0, 0.0, 0.0], [100.0, 0.0, 0.0]).unwrap());
    let point = station.point(Point::new(5.0, 0.0, 300.0));
    assert!(
        point.distance(Point::new(100.0, -5.0, 300.0)) < 1e-12,
        "{point:?}"
    );
}

#[test]
fn a_quaternion_without_length_is_no_rotation() {
    for rotation in [
        [0.0; 4],
        [f64::NAN, 0.0, 0.0, 1.0],
        [f64::INFINITY, 0.0, 0.0, 0.0],
    ] {
        assert!(
            Pose::<World, Camera>::new(rotation, [0.0; 3]).is_err(),
            "{rotation:?}"
        );
    }
}
