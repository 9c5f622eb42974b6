//! Half-filled vessels whose manifest says of some views that the beam entered another medium.
#![cfg(feature = "simulate")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::Random;
use common::synthetic::{KINDS, Score, measure, measure_with, scene};
use snellius::export::ReconstructionResult;
use snellius::pipeline::Settings;
use snellius::scan::{InsideMedium, Manifest};
use snellius::simulate::Scene;

/// A box in a half-filled tank, and how many of its views enter air.
fn half_filled(kind: &str, seed: u64) -> Scene {
    let mut random = Random::seeded(seed);
    let mut scene = scene(kind, &mut random);
    scene.seed = 1000 * seed;
    scene.vessel.level = Some(random.between(-70.0, 70.0));
    scene
}

fn proposed(result: &ReconstructionResult) -> Vec<Option<InsideMedium>> {
    result
        .views
        .iter()
        .map(|view| view.inside_proposed)
        .collect()
}

fn all_in_liquid(manifest: &mut Manifest) {
    for view in &mut manifest.views {
        view.inside = InsideMedium::Liquid;
    }
}

#[track_caller]
fn assert_left_alone(scene: Scene) {
    let name = format!("{scene:?}");
    let (result, _) = measure(scene);
    assert!(
        proposed(&result).iter().all(Option::is_none),
        "{:?} of {name}",
        result.warnings
    );
}

/// With and without ghosts; full and half full.
#[test]
fn a_manifest_that_is_right_is_left_alone() {
    for kind in KINDS {
        for seed in 0..12 {
            let mut random = Random::seeded(seed);
            let mut full = scene(kind, &mut random);
            full.seed = 1000 * seed;
            full.ghosts.probability = 0.1 * (seed % 3) as f64;
            assert_left_alone(full);
            if kind.starts_with("box") {
                assert_left_alone(half_filled(kind, seed));
            }
        }
    }
}

/// Whether few or most views are wrong, and whether the rig stands almost square to the wall, so that the
/// surface alone tells, or is pitched, so that the ray distance does.
#[test]
fn views_above_the_liquid_are_found_out() {
    for kind in ["box in a tank", "box in a tank, pitched"] {
        let mut in_air = 0;
        for seed in 0..12 {
            let mut truth = Vec::new();
            let note = |manifest: &mut Manifest| {
                truth = manifest.views.iter().map(|view| view.inside).collect();
                all_in_liquid(manifest);
            };
            let (result, _) = measure_with(half_filled(kind, seed), note, &Settings::default());
            let wrong = truth
                .iter()
                .map(|inside| Some(*inside).filter(|i| *i == InsideMedium::Air));
            assert_eq!(
                proposed(&result),
                wrong.collect::<Vec<_>>(),
                "{kind}, {seed}"
            );
            let warned = result
                .warnings
                .iter()
                .any(|w| w.contains("as if the beam entered air"));
            assert_eq!(
                warned,
                truth.contains(&InsideMedium::Air),
                "{:?}",
                result.warnings
            );
            in_air += truth.iter().filter(|i| **i == InsideMedium::Air).count();
        }
        assert!(in_air > 100, "{kind}: {in_air}");
    }
}

/// Some views of a row, taken for air by mistake.
#[test]
fn a_few_views_of_a_row_are_found_out() {
    let mistake = |manifest: &mut Manifest| {
        for view in &mut manifest.views[15..20] {
            view.inside = InsideMedium::Air;
        }
    };
    let mut scene = scene("box in a tank", &mut Random::seeded(3));
    scene.seed = 3;
    let (result, _) = measure_with(scene, mistake, &Settings::default());
    for (view, proposed) in proposed(&result).into_iter().enumerate() {
        let expected = (15..20).contains(&view).then_some(InsideMedium::Liquid);
        assert_eq!(proposed, expected, "view {view}");
    }
}

/// Nothing changes by itself; where the proposal is accepted, the result is that of a manifest that is right.
#[test]
fn accepting_the_proposal_puts_the_object_right() {
    let scene = || half_filled("box in a tank", 2);
    let accept = Settings {
        accept_media: true,
        ..Settings::default()
    };
    let (right, truth) = measure(scene());
    let (proposed, _) = measure_with(scene(), all_in_liquid, &Settings::default());
    let (accepted, _) = measure_with(scene(), all_in_liquid, &accept);
    let rms = |result: &ReconstructionResult| Score::of(result, &truth).rms();
    assert!(
        rms(&right) < 0.2 && rms(&proposed) > 5.0,
        "{} {}",
        rms(&right),
        rms(&proposed)
    );
    for (right, accepted) in right.views.iter().zip(&accepted.views) {
        assert_eq!(right.object, accepted.object, "{}", right.id);
        assert_eq!(accepted.inside, accepted.inside_proposed);
    }
    assert!(proposed.views.iter().all(|view| view.inside.is_none()));
}
