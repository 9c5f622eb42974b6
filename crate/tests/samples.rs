//! The samples are recovered to what their noise allows. With `--nocapture` it prints the numbers that
//! README.md quotes.
#![cfg(feature = "cli")]

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use snellius::pipeline::{Settings, observe, reconstruct};
use snellius::scan::Archive;
use snellius::simulate::{Scene, Simulation};

fn in_samples(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../samples")
        .join(name)
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
    let file = File::open(in_samples(&format!("{sample}.zip"))).unwrap();
    let mut archive = Archive::open(BufReader::new(file)).unwrap();
    let settings = Settings::default();
    let spots: Vec<_> = (0..archive.scan().stations.len())
        .map(|view| observe(&mut archive, view, &settings).unwrap())
        .collect();
    let result = reconstruct(archive.scan(), &spots, &settings)
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
