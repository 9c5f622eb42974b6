//! Photographed scenes of every kind of wall, held against what the true wall would give on the same
//! pictures.
#![cfg(feature = "cli")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::Cursor;

use common::archives::{both_faces_glow, scene, simulate};
use common::errors::Errors;
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{Archive, Scan, VesselShape};
use snellius::simulate::{Relief, Scene, SceneFarWall, SceneObject, Simulation, Sweep, Truth};
use snellius::spots::Spots;

fn errors(scan: &Scan, spots: &[Spots], truth: &Truth) -> Errors {
    let result = reconstruct(scan, spots, &Settings::default());
    let result = result.unwrap().result();
    let mut errors = Errors::default();
    for (view, truth) in result.views.iter().zip(&truth.views) {
        let found = view.object.first().zip(view.object_sigma.first());
        match truth.object.first() {
            Some(there) => errors.count(there, found),
            None => assert!(found.is_none(), "{}: no object", view.id),
        }
    }
    errors
}

/// The inner face's light, the outer one's being 500: shares q of both at even parts of what is held likely
/// of them beforehand (q (1 - q) = 0.16 +- 0.06).
const INNER_FACE: [f64; 4] = [56.0, 103.0, 153.0, 275.0];

/// The contrast of grains a pixel wide. They put a round spot's centroid off by 0.18 / sqrt(8 pi) = 0.036 px.
const SPECKLE: f64 = 0.18;

/// Over scans that differ in noise, speckle and the inner face's glow: at most `factor` times the error that
/// the true wall gives, and at least `share` of the points. Gives the share of coordinates within two
/// standard deviations.
#[track_caller]
fn assert_recovered(scene: &Scene, factor: f64, share: f64) -> f64 {
    let (mut measured, mut known) = (Errors::default(), Errors::default());
    for (seed, inner_face) in (20..).zip(INNER_FACE) {
        let mut scene = scene.clone();
        scene.seed = seed;
        scene.brightness.inner_face = inner_face;
        scene.beam.speckle = SPECKLE;
        let wall = Simulation::new(scene.clone()).unwrap().wall().clone();
        let simulated = simulate(scene);
        let mut archive = Archive::open(Cursor::new(&simulated.archive[..])).unwrap();
        let settings = Settings::default();
        let spots: Vec<_> = (0..archive.scan().stations.len())
            .map(|view| observe(&mut archive, view, &settings).unwrap())
            .collect();
        let scan = archive.scan();
        let true_wall = Scan {
            known_wall: Some(wall.outer),
            ..scan.clone()
        };
        measured.add(&errors(scan, &spots, &simulated.truth));
        known.add(&errors(&true_wall, &spots, &simulated.truth));
    }
    assert!(measured.wanted >= 80.0, "the scene shows its object");
    let (here, best) = (measured.rms(), known.rms());
    assert!(
        measured.found >= share * measured.wanted,
        "{measured:?} found"
    );
    assert!(
        here <= factor * best,
        "{here} mm, {best} mm with the true wall"
    );
    measured.honest()
}

/// A simple wall: as good as known but for half, every point, and honest.
#[track_caller]
fn assert_honest(scene: &Scene) {
    let honest = assert_recovered(scene, 1.5, 1.0);
    assert!((0.90..=0.99).contains(&honest), "{honest} within 2 sigma");
}

/// Rows of nine stations that look at the y axis from 365 mm before a round vessel.
fn around(radius: f64, heights: &[f64]) -> Vec<Sweep> {
    let stations = heights
        .iter()
        .flat_map(|y| (-4..=4).map(move |step| (y, 7.0 * f64::from(step))));
    let station = |(y, degrees): (&f64, f64)| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let away = radius + 365.0;
        let place = [-away * sin, *y, -away * cos];
        Sweep {
            from: place,
            to: place,
            views: 1,
            rotation: [0.0, degrees, 0.0],
            turn: [0.0; 2],
        }
    };
    stations.map(station).collect()
}

/// A ball in a round vessel; the rig walks around it.
fn round(shape: VesselShape) -> Scene {
    let mut scene = scene();
    scene.brightness = both_faces_glow();
    scene.vessel.shape = shape;
    scene.vessel.radius = Some(80.0);
    scene.vessel.rotation = [1.0, 0.0, -2.0];
    scene.objects = vec![SceneObject::Sphere {
        centre: [6.0, 0.0, 8.0],
        radius: 32.0,
    }];
    scene.sweeps = around(80.0, &[-14.0, 0.0, 14.0]);
    scene
}

/// Of another size, thickness and liquid, before a rig of a shorter base.
fn another(shape: VesselShape, radius: f64) -> Scene {
    let mut scene = round(shape);
    scene.vessel.declared = Some(VesselShape::Auto);
    scene.vessel.radius = Some(radius);
    scene.vessel.wall_thickness = 4.0;
    scene.vessel.rotation = [3.0, 0.0, 2.0];
    scene.media.wall = 1.52;
    scene.media.inside = 1.38;
    scene.laser.origin = [-130.0, 2.0, 0.0];
    scene.laser.direction = Some([0.290, -0.004, 0.957]);
    scene.objects = vec![SceneObject::Sphere {
        centre: [3.0, 0.0, 4.0],
        radius: 0.4 * radius,
    }];
    // Where the glows lie nearer together than a spot is wide, their share is hardly known, and such a jar
    // measured half as well as with the true wall.
    let camera = &mut scene.camera;
    (camera.width, camera.height) = (480, 360);
    (camera.fx, camera.fy, camera.cx, camera.cy) = (720.0, 719.2, 241.8, 177.4);
    scene.sweeps = around(radius, &[-20.0, -10.0, 0.0, 10.0, 20.0]);
    scene
}

/// The box in a tank whose front has a bulge, 4 mm high and some 15 cm wide.
fn bulging() -> Scene {
    let mut scene = scene();
    scene.brightness = both_faces_glow();
    scene.vessel.shape = VesselShape::Freeform;
    let height = |x: i32, y: i32| {
        let far = f64::from(x * x + y * y) * (60.0 * 60.0);
        4.0 * (-far / (2.0 * 75.0 * 75.0)).exp()
    };
    scene.vessel.relief = Some(Relief {
        over: VesselShape::Plane,
        step: [60.0, 60.0],
        heights: (-4..=4)
            .map(|y| (-4..=4).map(|x| height(x, y)).collect())
            .collect(),
    });
    scene.sweeps = [-50.0, -25.0, 0.0, 25.0, 50.0]
        .map(|y| Sweep {
            from: [-60.0, y, -400.0],
            to: [40.0, y, -400.0],
            views: 6,
            rotation: [0.0; 3],
            turn: [0.0; 2],
        })
        .to_vec();
    scene
}

/// The box in air behind a tank of water 62.1 mm deep: five media, and both walls glow.
fn behind_tank() -> Scene {
    let mut scene = scene();
    scene.vessel.far_wall = Some(SceneFarWall {
        distance: 62.1,
        thickness: 2.1,
    });
    scene.objects = vec![SceneObject::Box {
        centre: [4.0, 0.0, 160.0],
        half: [50.0, 140.0, 50.0],
        rotation: [0.0, 45.0, 0.0],
    }];
    scene.brightness = both_faces_glow();
    scene
}

#[test]
fn a_flat_wall() {
    assert_honest(&scene());
}

#[test]
fn a_jar() {
    assert_honest(&round(VesselShape::Cylinder));
}

/// A thick, small, leaning jar of sugar solution, of which nobody says what it is.
#[test]
fn another_jar() {
    assert_honest(&another(VesselShape::Cylinder, 62.0));
}

#[test]
fn a_bowl() {
    assert_honest(&round(VesselShape::Sphere));
}

#[test]
fn another_bowl() {
    assert_honest(&another(VesselShape::Sphere, 110.0));
}

/// The points of a scan share one error of the wall, so whether a free form's standard deviations are honest
/// shows over many scans: see wall_shapes.rs.
#[test]
fn a_wall_with_a_bulge() {
    assert_recovered(&bulging(), 3.0, 0.8);
}

#[test]
fn an_object_behind_the_tank() {
    assert_honest(&behind_tank());
}

#[test]
fn a_wall_that_the_manifest_knows() {
    let mut jar = round(VesselShape::Cylinder);
    jar.vessel.known = true;
    let honest = assert_recovered(&jar, 1.0 + 1e-9, 1.0);
    assert!((0.90..=0.99).contains(&honest), "{honest} within 2 sigma");
}
