//! Does the estimate of the refractive index keep what it promises? Many scans of a scene are simulated at
//! the level of spots, each with noise of its own and with a range finder that is off its calibration as
//! calibration's standard deviations say, what is known of the object is off as exactly as it is taken to be,
//! and the index is estimated from each.
//!
//! ```sh
//! cargo run --release -p snellius --example index_monte_carlo -- SCENE.toml [SCANS] [PIXELS]
//! ```
//!
//! For each method it prints how far the estimates scatter, beside the Cramer-Rao bound and the standard
//! deviation that the program states, and how often the 95 % interval holds the truth.
#![allow(clippy::print_stdout, reason = "the numbers are this program's output")]

use std::error::Error;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use snellius::index::{IndexEstimate, IndexMethod, KNOWN_TOLERANCE};
use snellius::pipeline::{Settings, study_index};
use snellius::rig::Calibration;
use snellius::scan::Scan;
use snellius::simulate::{Scene, Simulation};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().ok_or("which scene?")?;
    let number = |i: usize| arguments.get(i).map(|text| text.parse::<f64>()).transpose();
    let scans = number(1)?.unwrap_or(500.0) as u64;
    let pixels = number(2)?.unwrap_or(0.1);
    let scene = Scene::from_toml(&std::fs::read_to_string(path)?)?;
    let truth = scene.media.inside;
    let simulation = Simulation::new(scene)?;
    let scan = Scan::new(simulation.manifest().clone())?;
    let all: Vec<Vec<IndexEstimate>> = (0..scans)
        .into_par_iter()
        .map(|seed| estimates(&simulation, &scan, pixels, seed))
        .collect();
    println!("{path}: {scans} scans, centroids to {pixels} px, n = {truth}");
    println!(
        "method        scans  bias      scatter  bound    ratio  stated   within 95 %  determined"
    );
    for method in [
        IndexMethod::RayDistance,
        IndexMethod::Overlap,
        IndexMethod::KnownShape,
        IndexMethod::Joint,
    ] {
        let found: Vec<&IndexEstimate> = all
            .iter()
            .flatten()
            .filter(|estimate| estimate.method == method)
            .collect();
        if !found.is_empty() {
            print(method, &found, truth);
        }
    }
    Ok(())
}

/// What each method says of one scan.
fn estimates(simulation: &Simulation, scan: &Scan, pixels: f64, seed: u64) -> Vec<IndexEstimate> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut rig = *simulation.rig();
    for number in Calibration::ALL {
        let error: f64 = random.sample(StandardNormal);
        rig = number.nudge(&rig, error * number.sigma(&scan.calibration_sigma));
    }
    let simulation = simulation.clone().with_rig(rig);
    let mut scan = scan.clone();
    for known in &mut scan.manifest.known {
        let error: f64 = random.sample(StandardNormal);
        let error = error * KNOWN_TOLERANCE / known.weight.sqrt();
        known.degrees = known.degrees.map(|value| value + error);
        known.mm = known.mm.map(|value| value + error);
    }
    let views = 0..simulation.views();
    let spots: Vec<_> = views
        .map(|v| simulation.spots(v, pixels, 1000 * seed))
        .collect();
    match study_index(&scan, &spots, &Settings::default()) {
        Ok(study) => study.estimates,
        Err(error) => {
            println!("scan {seed}: {error}");
            Vec::new()
        }
    }
}

fn print(method: IndexMethod, found: &[&IndexEstimate], truth: f64) {
    let count = found.len() as f64;
    let mean =
        |value: &dyn Fn(&IndexEstimate) -> f64| found.iter().map(|e| value(e)).sum::<f64>() / count;
    let middle = |e: &IndexEstimate| 0.5 * (e.interval[0] + e.interval[1]);
    let bias = mean(&middle) - truth;
    let square = |x: f64| x * x;
    let scatter = mean(&|e| square(middle(e) - truth - bias)).sqrt();
    let bound = mean(&|e| square(e.floor)).sqrt();
    let stated = mean(&|e| square(e.sigma)).sqrt();
    let holds =
        |e: &IndexEstimate| f64::from(u8::from(e.interval[0] <= truth && truth <= e.interval[1]));
    let determined = |e: &IndexEstimate| f64::from(u8::from(e.value.is_some()));
    println!(
        "{:<13} {:5}  {bias:+.5}  {scatter:.5}  {bound:.5}  {:5.3}  {stated:.5}  {:9.1} %  {:8.1} %",
        method.name(),
        found.len(),
        scatter / bound,
        100.0 * mean(&holds),
        100.0 * mean(&determined)
    );
}
