//! What a scan tells of the liquid's refractive index, and that it says so where it tells nothing.
#![cfg(feature = "cli")]

use snellius::camera::Pixel;
use snellius::index::{
    IndexError, IndexEstimate, IndexMethod, IndexRange, PreparedSights, Verdict,
};
use snellius::object::{line_of_sight, meet};
use snellius::optics::Media;
use snellius::pipeline::{PipelineError, Settings, reconstruct, study_index};
use snellius::rig::Calibration;
use snellius::scan::{InsideMedium, Scan, VesselShape};
use snellius::simulate::{Scene, Simulation};
use snellius::spots::Spots;

const FIVE_ATTITUDES: &str = include_str!("../examples/scenes/attitudes.toml");
const ONE_ATTITUDE: &str = include_str!("../examples/scenes/one_attitude.toml");
const NOISE: f64 = 0.05;

struct Seen {
    scan: Scan,
    spots: Vec<Spots>,
    truth: f64,
}

fn seen(scene: Scene) -> Seen {
    let truth = scene.media.inside;
    let simulation = Simulation::new(scene).unwrap();
    let views = 0..simulation.views();
    Seen {
        scan: Scan::new(simulation.manifest().clone()).unwrap(),
        spots: views.map(|v| simulation.spots(v, NOISE, 5)).collect(),
        truth,
    }
}

fn scene(text: &str) -> Scene {
    Scene::from_toml(text).unwrap()
}

impl Seen {
    fn estimates(&self) -> Vec<IndexEstimate> {
        study_index(&self.scan, &self.spots, &Settings::default())
            .unwrap()
            .estimates
    }

    fn joint(&self) -> IndexEstimate {
        let joint = |e: &IndexEstimate| e.method == IndexMethod::Joint;
        self.estimates().into_iter().find(joint).unwrap()
    }

    fn refusal(&self, settings: &Settings) -> IndexError {
        match study_index(&self.scan, &self.spots, settings) {
            Err(PipelineError::Index(error)) => error,
            other => panic!("{other:?}"),
        }
    }

    fn refusal_of_known(mut self, known: &str) -> String {
        self.scan.manifest.known = serde_json::from_str(known).unwrap();
        self.refusal(&Settings::default()).to_string()
    }
}

#[track_caller]
fn assert_holds(estimate: &IndexEstimate, truth: f64) {
    let [low, high] = estimate.interval;
    assert!(low <= truth && truth <= high, "{truth}: {estimate:?}");
}

/// The laser is off by 0.12 degrees within the plane of its rays and across it, and nobody knows.
#[test]
fn five_attitudes_find_the_index_though_the_laser_is_off() {
    for direction in [[0.12, 0.0], [0.0, 0.12], [-0.12, 0.08]] {
        let mut scene = scene(FIVE_ATTITUDES);
        scene.calibration_error.laser_direction = direction;
        let seen = seen(scene);
        let joint = seen.joint();
        assert_eq!(joint.verdict, Verdict::Determined, "{joint:?}");
        assert!(
            (joint.value.unwrap() - seen.truth).abs() < 0.006,
            "{joint:?}"
        );
        assert_holds(&joint, seen.truth);
    }
}

/// From one attitude an error of the laser within the plane of its rays cannot be told from another index.
#[test]
fn one_attitude_owns_up_to_what_it_cannot_see() {
    for within in [-0.12, 0.12] {
        let mut scene = scene(ONE_ATTITUDE);
        scene.calibration_error.laser_direction = [within, 0.0];
        let seen = seen(scene);
        let joint = seen.joint();
        assert!(joint.sigma > 0.005, "{joint:?}");
        assert_holds(&joint, seen.truth);
    }
}

#[test]
fn other_liquids_are_found_as_well() {
    for liquid in [1.333, 1.4706] {
        let mut scene = scene(FIVE_ATTITUDES);
        scene.media.inside = liquid;
        let joint = seen(scene).joint();
        assert!((joint.value.unwrap() - liquid).abs() < 0.006, "{joint:?}");
        assert_holds(&joint, liquid);
    }
}

/// Every method's interval holds the truth about as often as it says, over scans whose calibration is off
/// as calibration's standard deviations say. (The example `index_monte_carlo` does it with hundreds.)
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    const SCANS: u64 = 12;
    let simulation = Simulation::new(scene(FIVE_ATTITUDES)).unwrap();
    let scan = Scan::new(simulation.manifest().clone()).unwrap();
    let (mut held, mut all) = (0, 0);
    let mut random = common::Random::seeded(77);
    for seed in 0..SCANS {
        let mut rig = *simulation.rig();
        for number in Calibration::ALL {
            rig = number.nudge(
                &rig,
                random.normal() * number.sigma(&scan.calibration_sigma),
            );
        }
        let true_one = simulation.clone().with_rig(rig);
        let views = 0..simulation.views();
        let spots: Vec<Spots> = views.map(|v| true_one.spots(v, 0.1, 1000 * seed)).collect();
        let study = study_index(&scan, &spots, &Settings::default()).unwrap();
        for estimate in &study.estimates {
            let [low, high] = estimate.interval;
            held += i32::from(low <= 1.361 && 1.361 <= high);
            all += 1;
        }
    }
    assert_eq!(all, 4 * SCANS as i32, "every method answers every scan");
    assert!(
        10 * held >= 9 * all,
        "{held} of {all} intervals hold the truth"
    );
}

mod common;

/// A level rig squarely before the tank: the paper's set-up.
fn level() -> Scene {
    let text = include_str!("../../samples/scenes/tank-paper.toml");
    let mut scene = scene(text);
    scene.index_known = false;
    scene
}

#[test]
fn where_the_rays_always_meet_no_index_is_given_but_the_reason_and_a_remedy() {
    let seen = seen(level());
    let settings = Settings {
        index_method: Some(IndexMethod::RayDistance),
        ..Settings::default()
    };
    let reconstruction = reconstruct(&seen.scan, &seen.spots, &settings).unwrap();
    let result = reconstruction.result();
    let inside = result.media.inside;
    assert_eq!(inside.value, None);
    assert_eq!(inside.verdict, Verdict::NotDetermined);
    let reason = inside.reason.unwrap();
    for part in ["(D1)", "px per unit", "pitch the rig", "+-0."] {
        assert!(reason.contains(part), "{part}: {reason}");
    }
    // What does not depend on the index is still there: the wall, and the object above the water.
    assert!(result.vessel.points > 20);
    for (view, station) in result.views.iter().zip(&seen.scan.stations) {
        let in_air = station.inside == InsideMedium::Air;
        assert!(view.object.iter().next().is_none() || in_air, "{}", view.id);
    }
}

/// The paper's experiment B: the angle of two planes over the index meets what is known at the true one;
/// with the laser off it meets it elsewhere, and the joint estimate owns up to it.
#[test]
fn the_angle_of_two_planes_meets_what_is_known_at_the_true_index() {
    let met = |error: [f64; 2]| {
        let mut scene = scene(ONE_ATTITUDE);
        scene.calibration_error.laser_direction = error;
        let seen = seen(scene);
        let study = study_index(&seen.scan, &seen.spots, &Settings::default()).unwrap();
        let curve = &study.known_curves[0];
        assert!(curve.sensitivity.abs() > 30.0, "{}", curve.sensitivity);
        let off = |i: &usize| (curve.measured.value[*i].unwrap() - curve.known).abs();
        let nearest = (0..curve.measured.index.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
        curve.measured.index[nearest.unwrap()]
    };
    assert!((met([0.0, 0.0]) - 1.361).abs() < 0.011);
    assert!((met([0.3, 0.0]) - 1.361).abs() > 0.015);
}

#[test]
fn what_cannot_be_known_of_an_object_is_refused_by_name() {
    let case = |known: &str| seen(scene(FIVE_ATTITUDES)).refusal_of_known(known);
    let contradiction =
        case(r#"[{"kind": "plane_angle", "degrees": 90}, {"kind": "plane_angle", "degrees": 80}]"#);
    assert!(
        contradiction.contains("known[0] and known[1] contradict"),
        "{contradiction}"
    );
    let negative = case(r#"[{"kind": "plane_angle", "degrees": 90, "weight": -1}]"#);
    assert!(negative.contains("known[0].weight: -1"), "{negative}");
    let nothing = case(r#"[{"kind": "plane_angle", "degrees": 90, "weight": 0}]"#);
    assert!(nothing.contains("all weights are 0"), "{nothing}");
    let few = case(
        r#"[{"kind": "plane_angle", "degrees": 90, "views": [["0000", "0001"], ["0010", "0011"]]}]"#,
    );
    assert!(few.contains("known[0]: 2 object points"), "{few}");
    let absent = case(r#"[{"kind": "flatness", "views": [["nowhere"]]}]"#);
    assert!(absent.contains("\"nowhere\""), "{absent}");
    let none = case(r#"[{"kind": "radius", "mm": 20}]"#);
    assert!(none.contains("no faces for this radius"), "{none}");
    let valueless = case(r#"[{"kind": "edge_length"}]"#);
    assert!(valueless.contains("known[0].mm"), "{valueless}");
}

#[test]
fn a_range_without_a_liquid_is_refused() {
    let seen = seen(scene(FIVE_ATTITUDES));
    for (from, to) in [(3.0, 4.0), (1.5, 1.2), (0.2, 0.9)] {
        let index_range = IndexRange {
            from,
            to,
            count: 50,
        };
        let settings = Settings {
            index_range,
            ..Settings::default()
        };
        let refusal = seen.refusal(&settings);
        assert_eq!(refusal, IndexError::Range { from, to });
    }
}

/// Light that is traced once and bent again gives, for any index, what tracing all of it gives: behind
/// flat and round walls.
#[test]
fn prepared_light_comes_out_as_traced_light() {
    for (shape, radius) in [
        (VesselShape::Plane, None),
        (VesselShape::Cylinder, Some(150.0)),
        (VesselShape::Sphere, Some(150.0)),
    ] {
        let mut scene = scene(ONE_ATTITUDE);
        scene.vessel.shape = shape;
        scene.vessel.radius = radius;
        if radius.is_some() {
            scene.vessel.centre = [0.0, 0.0, 150.0];
        }
        scene.index_known = true;
        let seen = seen(scene);
        let settings = Settings::default();
        let reconstruction = reconstruct(&seen.scan, &seen.spots, &settings).unwrap();
        let setup = reconstruction.setup();
        let sights: Vec<(usize, Pixel)> = reconstruction
            .object
            .iter()
            .enumerate()
            .flat_map(|(view, choice)| {
                let spots = &seen.spots[view].spots;
                choice
                    .points
                    .iter()
                    .map(move |p| (view, spots[p.spot].pixel()))
            })
            .collect();
        assert!(sights.len() > 20, "{shape:?}: {} sights", sights.len());
        let prepared = PreparedSights::new(&setup, &sights);
        for liquid in [1.0, 1.2, 1.333, 1.5, 1.9] {
            let media = Media {
                liquid,
                ..setup.media
            };
            let stack = setup
                .vessel
                .wall
                .stack(&media, InsideMedium::Liquid)
                .unwrap();
            let lights = sights
                .iter()
                .zip(prepared.points(liquid))
                .zip(prepared.gaps(liquid));
            for (((view, pixel), point), gap) in lights {
                let pose = &setup.stations[*view].world_from_camera;
                let traced = meet(setup.rig, pose, &stack, *pixel);
                let (Ok(traced), Some(point)) = (traced, point) else {
                    assert!(line_of_sight(setup.rig, pose, *pixel).is_ok());
                    continue;
                };
                common::assert_close(point.distance(traced.point()), 0.0, 1e-7);
                common::assert_close(gap, traced.gap(), 1e-9);
            }
        }
    }
}
