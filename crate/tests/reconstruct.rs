//! Whole scans whose truth is known, recovered to their noise.
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use std::sync::LazyLock;

use common::archives::{
    Entries, Simulated, both_faces_glow, measure, measure_with, scene, simulate,
};
use nalgebra::Vector3;
use snellius::export::{ReconstructionResult, Status};
use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::{Archive, InsideMedium};
use snellius::simulate::{Scene, SceneObject, Truth};
use zip::CompressionMethod;

/// The box in the tank, rendered once for all tests that read it.
static TANK: LazyLock<Simulated> = LazyLock::new(|| simulate(scene()));

/// How a result stands to the truth.
struct Score {
    /// Views whose truth has an object point, and how many of them were given one.
    wanted: usize,
    found: usize,
    /// Points where the truth has none.
    false_points: usize,
    rms: f64,
    worst: f64,
    /// Errors along each axis in units of their standard deviation.
    normalised: Vec<f64>,
}

fn score(result: &ReconstructionResult, truth: &Truth) -> Score {
    let mut errors = Vec::new();
    let mut score = Score {
        wanted: 0,
        found: 0,
        false_points: 0,
        rms: 0.0,
        worst: 0.0,
        normalised: Vec::new(),
    };
    for (view, truth) in result.views.iter().zip(&truth.views) {
        assert_eq!(view.id, truth.id);
        score.wanted += usize::from(truth.object.first().is_some());
        let (Some(found), Some(sigma)) = (view.object.first(), view.object_sigma.first()) else {
            continue;
        };
        let Some(true_place) = truth.object.first() else {
            score.false_points += 1;
            continue;
        };
        let off = Vector3::from(found) - Vector3::from(true_place);
        score
            .normalised
            .extend((0..3).map(|axis| off[axis] / sigma[axis]));
        errors.push(off.norm());
    }
    score.found = errors.len();
    score.rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    score.worst = errors.into_iter().fold(0.0, f64::max);
    score
}

/// The scene's points to within `rms` mm, all of them, and none that is not there.
#[track_caller]
fn assert_recovered(simulated: &Simulated, rms: f64) -> ReconstructionResult {
    let result = measure(&simulated.archive).unwrap();
    let score = score(&result, &simulated.truth);
    assert!(
        score.wanted >= 15,
        "the scene shows its object: {}",
        score.wanted
    );
    assert_eq!(score.found, score.wanted);
    assert_eq!(score.false_points, 0);
    assert!(
        score.rms < rms,
        "{} mm RMS, worst {}",
        score.rms,
        score.worst
    );
    result
}

/// One standard deviation here is some 0.1 mm: 0.2 px of the object's spot are 0.33 mm in depth at such a
/// rig (error budget of the method), and these spots are located to some 0.07 px.
#[test]
fn a_box_in_a_tank_is_recovered() {
    let result = assert_recovered(&TANK, 0.2);
    for (view, truth) in result.views.iter().zip(&TANK.truth.views) {
        let (found, place) = (view.vessel.first().unwrap(), truth.vessel.first().unwrap());
        let off = (Vector3::from(found) - Vector3::from(place)).norm();
        assert!(off < 0.5, "{}: the vessel's point is {off} mm off", view.id);
    }
}

/// Over scans with other noise the errors in units of their standard deviations are those of a normal
/// distribution: 95.4 % within two, 68.3 % within one, mean square 1. What the points of one scan share (the
/// wall) leaves less than a few hundred independent values, hence the width allowed.
#[test]
fn standard_deviations_are_honest() {
    let mut normalised = Vec::new();
    for seed in 10..16 {
        let simulated = simulate(Scene { seed, ..scene() });
        normalised
            .extend(score(&measure(&simulated.archive).unwrap(), &simulated.truth).normalised);
    }
    let share = |limit: f64| {
        normalised.iter().filter(|z| z.abs() <= limit).count() as f64 / normalised.len() as f64
    };
    let mean_square = normalised.iter().map(|z| z * z).sum::<f64>() / normalised.len() as f64;
    assert!(
        (0.92..0.99).contains(&share(2.0)),
        "{} within 2 sigma",
        share(2.0)
    );
    assert!(
        (0.58..0.80).contains(&share(1.0)),
        "{} within 1 sigma",
        share(1.0)
    );
    assert!((0.6..1.4).contains(&mean_square), "{mean_square}");
}

/// The inner face's glow, 0.3 of the outer one's, merges with it; told apart, it costs little.
#[test]
fn a_wall_whose_faces_both_glow_is_recovered() {
    assert_recovered(
        &simulate(Scene {
            brightness: both_faces_glow(),
            ..scene()
        }),
        0.35,
    );
}

/// The same tank with the laser on another side of the camera.
fn with_laser_at(origin: [f64; 3], direction: [f64; 3]) -> Scene {
    let mut scene = scene();
    scene.laser.origin = origin;
    scene.laser.direction = Some(direction);
    scene
}

#[test]
fn a_laser_on_the_right_measures_as_well() {
    assert_recovered(
        &simulate(with_laser_at([160.0, -3.0, 4.0], [-0.336, 0.006, 0.942])),
        0.25,
    );
}

#[test]
fn a_laser_above_measures_as_well() {
    assert_recovered(
        &simulate(with_laser_at([3.0, -150.0, 4.0], [-0.006, 0.336, 0.942])),
        0.25,
    );
}

/// A quarter turn of the hand: the rig's own left is the world's top.
#[test]
fn a_rig_that_is_rolled_measures_as_well() {
    let mut rolled = scene();
    rolled
        .sweeps
        .iter_mut()
        .for_each(|sweep| sweep.rotation = [0.0, 0.0, 90.0]);
    assert_recovered(&simulate(rolled), 0.25);
}

/// Above the liquid the beam enters air, and those views say so.
#[test]
fn a_half_filled_vessel_is_recovered_above_and_below_the_level() {
    let mut scene = scene();
    scene.vessel.level = Some(0.0);
    let simulated = simulate(scene);
    let result = assert_recovered(&simulated, 0.25);
    let archive = Archive::open(std::io::Cursor::new(&simulated.archive[..])).unwrap();
    let in_air = archive
        .scan()
        .stations
        .iter()
        .filter(|s| s.inside == InsideMedium::Air)
        .count();
    assert_eq!(in_air, 10, "half the rows are above the liquid");
    assert_eq!(result.views.len(), 20);
}

/// A ball that the beam misses in most views, by more than its own width: there is no point where there is no
/// object.
#[test]
fn where_the_beam_misses_the_object_there_is_no_point() {
    let mut scene = scene();
    scene.objects = vec![SceneObject::Sphere {
        centre: [14.0, 0.0, 90.0],
        radius: 32.0,
    }];
    let simulated = simulate(scene);
    let result = measure(&simulated.archive).unwrap();
    let score = score(&result, &simulated.truth);
    assert!((3..=14).contains(&score.wanted), "{}", score.wanted);
    assert_eq!((score.found, score.false_points), (score.wanted, 0));
    assert!(score.worst < 1.0, "{}", score.worst);
    for (view, truth) in result.views.iter().zip(&simulated.truth.views) {
        assert_eq!(
            view.status == Status::Ok,
            truth.object.first().is_some(),
            "{}: {:?}",
            view.id,
            view.reason
        );
        assert!(view.status == Status::Ok || view.reason.is_some());
    }
}

/// Fig. 11 of the paper: without refraction the object appears far nearer. For a flat wall and small angles
/// the depth d behind it shrinks to d/n, by some 20 mm here.
#[test]
fn ignoring_refraction_moves_the_object_by_tens_of_millimetres() {
    let mut archive = Archive::open(std::io::Cursor::new(&TANK.archive[..])).unwrap();
    let settings = Settings::default();
    let spots: Vec<_> = (0..20)
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();
    let reconstruction = reconstruct(archive.scan(), &spots, &settings).unwrap();
    for (truth, unrefracted) in TANK.truth.views.iter().zip(&reconstruction.unrefracted) {
        let (truth, nearer) = (
            Vector3::from(truth.object.first().unwrap()),
            unrefracted[0].unwrap().coords,
        );
        let expected = truth.z * (1.0 - 1.0 / 1.33);
        let moved = truth.z - nearer.z;
        assert!(
            moved > 8.0 && (moved / expected - 1.0).abs() < 0.35,
            "{moved} mm, some {expected} expected"
        );
    }
}

/// The index that the user gives stands in for the manifest's, and a wrong one moves the object.
#[test]
fn another_index_gives_another_object() {
    let result = measure_with(
        &TANK.archive,
        &Settings {
            index: Some(1.36),
            ..Settings::default()
        },
    )
    .unwrap();
    assert_eq!(result.media.inside.value, Some(1.36));
    let deeper = result
        .views
        .iter()
        .zip(&TANK.truth.views)
        .all(|(view, truth)| {
            view.object.first().unwrap()[2] > truth.object.first().unwrap()[2] + 0.5
        });
    assert!(deeper, "a higher index puts the object deeper");
}

#[test]
fn the_same_pictures_give_the_same_bytes_however_they_are_packed() {
    let expected = measure(&TANK.archive).unwrap().to_json();
    let entries = Entries::of(&TANK.archive);
    let again = |entries: &Entries, method| measure(&entries.zipped_by(method)).unwrap().to_json();
    assert_eq!(
        again(&entries, CompressionMethod::Stored),
        expected,
        "stored"
    );
    assert_eq!(
        again(&entries, CompressionMethod::Deflated),
        expected,
        "deflated"
    );
    let mut other_order = entries.clone();
    other_order.0.reverse();
    other_order.0.rotate_left(7);
    assert_eq!(
        again(&other_order, CompressionMethod::Stored),
        expected,
        "in another order"
    );
    let mut in_folder = entries;
    in_folder
        .0
        .iter_mut()
        .for_each(|(name, _)| *name = format!("my scan/{name}"));
    assert_eq!(
        again(&in_folder, CompressionMethod::Stored),
        expected,
        "in a folder"
    );
    in_folder
        .0
        .push(("__MACOSX/my scan/._scan.json".into(), b"Finder's".to_vec()));
    assert_eq!(
        again(&in_folder, CompressionMethod::Deflated),
        expected,
        "beside what macOS adds"
    );
}

#[test]
fn the_same_scan_gives_the_same_bytes_each_time() {
    let first = measure(&TANK.archive).unwrap().to_json();
    for _ in 0..3 {
        assert_eq!(measure(&TANK.archive).unwrap().to_json(), first);
    }
    assert_eq!(
        simulate(scene()).archive,
        TANK.archive,
        "and so does the same scene"
    );
}

/// Views are measured in any order on any number of threads, each with its own reader.
#[test]
fn threads_change_nothing() {
    let expected = measure(&TANK.archive).unwrap().to_json();
    let settings = Settings::default();
    let open = || Archive::open(std::io::Cursor::new(&TANK.archive[..])).unwrap();
    let spots: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..20)
            .rev()
            .map(|view| scope.spawn(move || (view, observe(&mut open(), view, &settings).unwrap())))
            .collect();
        let mut found: Vec<_> = workers
            .into_iter()
            .map(|worker| worker.join().unwrap())
            .collect();
        found.sort_by_key(|(view, _)| *view);
        found.into_iter().map(|(_, spots)| spots).collect()
    });
    let archive = open();
    let result = reconstruct(archive.scan(), &spots, &settings)
        .unwrap()
        .result();
    assert_eq!(result.to_json(), expected);
}
