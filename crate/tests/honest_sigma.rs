//! Standard deviations against the scatter of many scans: what the centroids' noise does to the wall's fit
//! and to the object's points, for every shape of the wall.
#![cfg(feature = "simulate")]
#![allow(
    clippy::disallowed_methods,
    reason = "expectations may come from the platform"
)]

mod common;

use common::Random;
use common::synthetic::{measure, scene};

/// Errors along each axis in units of their standard deviation, over scans of a kind that differ by their
/// noise.
fn normalised(kind: &str, scans: u64) -> Vec<f64> {
    let mut all = Vec::new();
    for seed in 0..scans {
        let mut scene = scene(kind, &mut Random::seeded(seed));
        scene.seed = 1000 * seed + 17;
        let (result, truth) = measure(scene);
        for (view, truth) in result.views.iter().zip(&truth.views) {
            let found = view.object.first().zip(view.object_sigma.first());
            if let (Some((found, sigma)), Some(place)) = (found, truth.object.first()) {
                all.extend((0..3).map(|axis| (found[axis] - place[axis]) / sigma[axis]));
            }
        }
    }
    all
}

/// A normal distribution has 95.4 % within two standard deviations and 68.3 % within one. What the points
/// of one scan share, the wall's fit, leaves some hundred independent values, hence the width allowed.
#[test]
fn standard_deviations_are_those_of_the_scatter() {
    for kind in [
        "box in a tank",
        "box in a tank, pitched",
        "ball in a jar",
        "ball in a bowl",
    ] {
        let all = normalised(kind, 40);
        let share =
            |limit: f64| all.iter().filter(|z| z.abs() <= limit).count() as f64 / all.len() as f64;
        assert!(
            (0.93..0.98).contains(&share(2.0)),
            "{kind}: {} within 2",
            share(2.0)
        );
        assert!(
            (0.62..0.75).contains(&share(1.0)),
            "{kind}: {} within 1",
            share(1.0)
        );
    }
}
