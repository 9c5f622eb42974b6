//! The liquid's index behind every kind of wall, with either laser, and where only some of the views look
//! into the liquid: every method recovers it to what it says, or says why it cannot.
#![cfg(feature = "cli")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::io::Cursor;

use common::archives::simulate;
use snellius::index::{IndexEstimate, IndexMethod, IndexStudy};
use snellius::pipeline::{Settings, observe, study_index};
use snellius::scan::{Archive, InsideMedium, LaserKind, Scan, VesselShape};
use snellius::simulate::{Brightness, Relief, Scene, SceneFarWall, SceneObject, Simulation, Sweep};
use snellius::spots::Spots;

const NOISE: f64 = 0.05;

/// Nobody knows that the laser is off by this, degrees within the plane of its rays and across it.
const LASER_OFF: [f64; 2] = [0.085, -0.085];

/// Rows of views at these heights that look at the place 60 mm behind the tank's middle, from attitudes
/// given by pitch and yaw, degrees.
fn rows(attitudes: &[[f64; 2]], heights: &[f64], views: usize) -> Vec<Sweep> {
    const FAR: f64 = 460.0;
    let row = |[pitch, yaw]: [f64; 2], height: f64| {
        let ((sin_p, cos_p), (sin_y, cos_y)) =
            (pitch.to_radians().sin_cos(), yaw.to_radians().sin_cos());
        let ahead = [sin_y, -sin_p * cos_y, cos_p * cos_y];
        let right = [cos_y, sin_p * sin_y, -cos_p * sin_y];
        let target = [0.0, height, 60.0];
        let at = |along: f64| {
            [0, 1, 2].map(|axis| target[axis] - FAR * ahead[axis] + along * right[axis])
        };
        Sweep {
            from: at(-70.0),
            to: at(40.0),
            views,
            rotation: [pitch, yaw, 0.0],
            turn: [0.0; 2],
        }
    };
    let all = attitudes.iter();
    all.flat_map(|attitude| heights.iter().map(|height| row(*attitude, *height)))
        .collect()
}

const FIVE: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [-18.0, 0.0],
    [18.0, 0.0],
    [0.0, 22.0],
    [0.0, -22.0],
];

/// A box in a tank, its right angle known, with a laser that is off.
fn tank() -> Scene {
    let mut scene = Scene::from_toml(include_str!("../examples/scenes/attitudes.toml")).unwrap();
    scene.calibration_error.laser_direction = LASER_OFF;
    scene.sweeps = rows(&FIVE, &[-25.0, 25.0], 7);
    scene
}

fn round(shape: VesselShape) -> Scene {
    let mut scene = tank();
    scene.vessel.shape = shape;
    scene.vessel.radius = Some(150.0);
    scene.vessel.centre = [0.0, 0.0, 150.0];
    scene
}

fn study(scene: Scene) -> IndexStudy {
    let simulation = Simulation::new(scene).unwrap();
    let scan = Scan::new(simulation.manifest().clone()).unwrap();
    let views = 0..simulation.views();
    let spots: Vec<Spots> = views.map(|v| simulation.spots(v, NOISE, 11)).collect();
    study_index(&scan, &spots, &Settings::default()).unwrap()
}

fn middle(estimate: &IndexEstimate) -> f64 {
    0.5 * (estimate.interval[0] + estimate.interval[1])
}

/// Each of some methods holds the truth within two of its standard deviations.
#[track_caller]
fn assert_honest(study: &IndexStudy, methods: &[IndexMethod], truth: f64) {
    for method in methods {
        let estimate = study.estimate(*method).expect("the method applies");
        let off = middle(estimate) - truth;
        assert!(
            off.abs() <= 2.0 * estimate.sigma,
            "off by {off}: {estimate:?}"
        );
        assert_eq!(
            estimate.value.is_none(),
            estimate.reason.is_some(),
            "{estimate:?}"
        );
    }
}

const ALL: [IndexMethod; 4] = [
    IndexMethod::RayDistance,
    IndexMethod::Overlap,
    IndexMethod::KnownShape,
    IndexMethod::Joint,
];

/// Every method is honest and the joint estimate as exact as promised for many attitudes.
#[track_caller]
fn assert_found(scene: Scene, methods: &[IndexMethod], sigma: f64) {
    let truth = scene.media.inside;
    let study = study(scene);
    assert_honest(&study, methods, truth);
    let joint = study.best().unwrap();
    assert!(joint.sigma < sigma, "{joint:?}");
    let value = joint.value.expect("many attitudes determine the index");
    assert!((value - truth).abs() < 0.006, "{joint:?}");
}

#[test]
fn behind_a_jars_wall() {
    assert_found(round(VesselShape::Cylinder), &ALL, 0.004);
}

#[test]
fn behind_a_bowls_wall() {
    assert_found(round(VesselShape::Sphere), &ALL, 0.004);
}

#[test]
fn behind_a_wall_that_bulges() {
    let mut scene = tank();
    scene.vessel.shape = VesselShape::Freeform;
    let height = |x: i32, y: i32| {
        let far = f64::from(x * x + y * y) * (60.0 * 60.0);
        4.0 * (-far / (2.0 * 75.0 * 75.0)).exp()
    };
    scene.vessel.relief = Some(Relief {
        over: VesselShape::Plane,
        step: [60.0, 60.0],
        heights: (-5..=5)
            .map(|y| (-5..=5).map(|x| height(x, y)).collect())
            .collect(),
    });
    // A free form takes more points.
    scene.sweeps = rows(&FIVE, &[-35.0, 0.0, 35.0], 8);
    assert_found(scene, &ALL, 0.004);
}

#[test]
fn behind_a_known_wall() {
    let mut scene = tank();
    scene.vessel.known = true;
    assert_found(scene, &ALL, 0.004);
}

/// The object stands in air behind the tank: both rays leave the liquid as they came, and only their shift
/// tells of it.
#[test]
fn behind_the_far_wall() {
    let mut scene = tank();
    scene.vessel.far_wall = Some(SceneFarWall {
        distance: 62.1,
        thickness: 2.1,
    });
    scene.objects = vec![SceneObject::Box {
        centre: [4.0, 0.0, 160.0],
        half: [50.0, 140.0, 50.0],
        rotation: [0.0, 45.0, 0.0],
    }];
    assert_found(scene, &ALL, 0.02);
}

#[test]
fn another_liquid_wall_and_rig() {
    let mut scene = tank();
    scene.media.inside = 1.4706;
    scene.media.wall = 1.49;
    scene.vessel.wall_thickness = 8.0;
    scene.laser.origin = [150.0, -4.0, -6.0];
    scene.laser.direction = Some([-0.33, 0.01, 0.944]);
    assert_found(scene, &ALL, 0.004);
}

/// Views above the liquid say nothing of it; the others do.
#[test]
fn in_a_half_filled_tank() {
    let mut scene = tank();
    scene.vessel.level = Some(-5.0);
    let simulation = Simulation::new(scene.clone()).unwrap();
    let views = &simulation.manifest().views;
    let in_air = views.iter().filter(|v| v.inside == InsideMedium::Air);
    let in_air = in_air.count();
    assert!(
        in_air > 15 && views.len() - in_air > 15,
        "{in_air} views in air"
    );
    assert_found(scene, &ALL, 0.006);
}

/// From one attitude behind a jar's wall: the interval owns up to what cannot be seen of the laser.
#[test]
fn from_one_attitude() {
    let mut scene = round(VesselShape::Cylinder);
    scene.calibration_error.laser_direction = [0.12, 0.0];
    scene.sweeps = rows(&[[-18.0, 0.0]], &[-30.0, -10.0, 10.0, 30.0], 9);
    let study = study(scene);
    assert_honest(&study, &ALL, 1.361);
    assert!(
        study.best().unwrap().sigma > 0.006,
        "{:?}",
        study.best().unwrap()
    );
}

/// The rays of a sheet meet every line of sight: eq. (3) is refused, overlap and known shape tell.
#[test]
fn with_a_line_laser() {
    let mut scene = tank();
    scene.camera.width = 320;
    scene.camera.height = 240;
    (scene.camera.fx, scene.camera.fy) = (480.0, 479.5);
    (scene.camera.cx, scene.camera.cy) = (161.2, 118.3);
    scene.laser.kind = LaserKind::Line;
    scene.laser.direction = None;
    scene.laser.normal = Some([0.942, 0.012, -0.336]);
    scene.beam.fan = 34.0;
    scene.brightness = Brightness {
        outer_face: 150.0,
        inner_face: 45.0,
        object: 220.0,
        ..Brightness::default()
    };
    scene.sweeps = rows(&FIVE, &[0.0], 3);
    let truth = scene.media.inside;
    let mut archive = Archive::open(Cursor::new(simulate(scene).archive)).unwrap();
    let settings = Settings::default();
    let views = 0..archive.scan().stations.len();
    let spots: Vec<Spots> = views
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();
    let study = study_index(archive.scan(), &spots, &settings).unwrap();
    assert!(study.observability.is_none());
    let refused = study.not_applicable.iter();
    let mut refused = refused.filter(|(method, _)| *method == IndexMethod::RayDistance);
    let (_, why) = refused.next().expect("eq. (3) is refused");
    assert!(why.contains("whatever the index is"), "{why}");
    assert_honest(&study, &ALL[1..], truth);
    let joint = study.best().unwrap();
    assert!(joint.value.is_some() && joint.sigma < 0.01, "{joint:?}");
}
