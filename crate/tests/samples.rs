//! The samples are recovered to what their noise allows. With `--nocapture` it prints the numbers that
//! README.md and docs/refractive-index.md quote.
#![cfg(feature = "cli")]

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use snellius::index::{IndexCurve, IndexStudy, Verdict};
use snellius::pipeline::{Settings, observe, reconstruct, study_index};
use snellius::scan::{Archive, Scan};
use snellius::simulate::{Scene, Simulation};
use snellius::spots::Spots;

fn in_samples(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../samples")
        .join(name)
}

fn observed(sample: &str) -> (Scan, Vec<Spots>) {
    let file = File::open(in_samples(&format!("{sample}.zip"))).unwrap();
    let mut archive = Archive::open(BufReader::new(file)).unwrap();
    let views = 0..archive.scan().stations.len();
    let spots = views.map(|view| observe(&mut archive, view, &Settings::default()).unwrap());
    let spots = spots.collect();
    (archive.scan().clone(), spots)
}

/// What became of a sample's object points.
struct Recovered {
    wanted: u32,
    found: u32,
    /// RMS error, mm.
    rms: f64,
    /// RMS of the standard deviations that the program states, mm.
    stated: f64,
}

fn recovered(sample: &str) -> Recovered {
    let scene = std::fs::read_to_string(in_samples(&format!("scenes/{sample}.toml"))).unwrap();
    let truth = Simulation::new(Scene::from_toml(&scene).unwrap())
        .unwrap()
        .truth();
    let (scan, spots) = observed(sample);
    let result = reconstruct(&scan, &spots, &Settings::default())
        .unwrap()
        .result();
    let (mut wanted, mut found) = (0, 0);
    let (mut errors, mut variances) = (0.0, 0.0);
    for (view, truth) in result.views.iter().zip(&truth.views) {
        let Some(there) = truth.object.first() else {
            assert!(
                view.object.first().is_none(),
                "{sample}: a point where there is none"
            );
            continue;
        };
        wanted += 1;
        let (Some(here), Some(sigma)) = (view.object.first(), view.object_sigma.first()) else {
            continue;
        };
        found += 1;
        for axis in 0..3 {
            errors += (here[axis] - there[axis]) * (here[axis] - there[axis]);
            variances += sigma[axis] * sigma[axis];
        }
    }
    let rms = |squares: f64| (squares / f64::from(found)).sqrt();
    Recovered {
        wanted,
        found,
        rms: rms(errors),
        stated: rms(variances),
    }
}

/// The points lie off the truth by what the program says they do, not more.
#[test]
#[expect(clippy::print_stdout, reason = "README.md quotes these numbers")]
fn samples_are_recovered_to_their_noise() {
    for sample in ["tank-paper", "jar"] {
        let Recovered {
            wanted,
            found,
            rms,
            stated,
        } = recovered(sample);
        println!(
            "{sample}: {found} of {wanted} object points, RMS error {rms:.3} mm ({stated:.3} mm stated)"
        );
        assert_eq!(found, wanted, "{sample}");
        assert!(rms < 1.3 * stated, "{sample}: {rms} mm, {stated} mm stated");
    }
}

/// The index for which a rising curve meets a value.
fn meets(curve: &IndexCurve, wanted: f64) -> f64 {
    let points = || curve.index.iter().zip(&curve.value);
    let neighbours = points().zip(points().skip(1));
    let mut crossings = neighbours.filter_map(|((n0, v0), (n1, v1))| {
        let (v0, v1) = ((*v0)?, (*v1)?);
        let part = (wanted - v0) / (v1 - v0);
        (v0 < v1 && (0.0..1.0).contains(&part)).then_some(n0 + part * (n1 - n0))
    });
    crossings.next().expect("the curve meets the value")
}

/// The paper's experiment B: with a good calibration two planes at 90 degrees come out so at the index of
/// water; with the laser 0.2 degrees off they do at 1.36, as in the paper's Fig. 12. Either way the joint
/// estimate says how far it is to be trusted, and holds the truth.
#[test]
#[expect(
    clippy::print_stdout,
    reason = "docs/refractive-index.md quotes these numbers"
)]
fn the_angle_of_two_planes_tells_water_as_exactly_as_the_laser_is_calibrated() {
    const WATER: f64 = 1.333;
    for (sample, expected) in [("angle", WATER), ("angle-off", 1.36)] {
        let (scan, spots) = observed(sample);
        let study: IndexStudy = study_index(&scan, &spots, &Settings::default()).unwrap();
        let curve = &study.known_curves[0];
        let met = meets(&curve.measured, curve.known);
        let joint = study.best().unwrap();
        let [low, high] = joint.interval;
        println!(
            "{sample}: 90 degrees at n = {met:.4} ({:.1} degrees per unit); joint {:.4} +- {:.4}, \
             95 % within {low:.3} to {high:.3}, {}",
            curve.sensitivity,
            0.5 * (low + high),
            joint.sigma,
            joint.verdict.name()
        );
        assert!((met - expected).abs() < 0.003, "{sample}: {met}");
        assert!(low < WATER && WATER < high, "{sample}: {joint:?}");
        assert_eq!(joint.verdict, Verdict::Weak, "{sample}: {joint:?}");
    }
}
