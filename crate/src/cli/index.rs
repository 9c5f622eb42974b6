use std::fs;
use std::path::{Path, PathBuf};

use super::curves::{Drawn, csv, svg};
use super::{Failure, print, views};
use crate::index::{IndexEstimate, IndexMethod, IndexStudy, LIQUIDS, Observability};
use crate::pipeline::{Settings, study_index};
use crate::scan::KnownKind;

/// Arguments of `snellius index`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The folder that the curves are written to, as CSV and SVG
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
    /// The laser's wavelength in air, nm, for the table of liquids
    #[arg(long, default_value_t = 635.0, value_name = "NM")]
    wavelength: f64,
    /// The liquid's temperature, degrees Celsius, for the table of liquids
    #[arg(long, default_value_t = 20.0, value_name = "C")]
    temperature: f64,
    /// How many threads read pictures; 0 is one per core
    #[arg(long, default_value_t = 0, value_name = "N")]
    jobs: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scan;
    let settings = Settings::default();
    let archive = views::open(path)?;
    let scan = archive.scan();
    let spots = views::spots(path, scan, &settings, arguments.jobs)?;
    let study = study_index(scan, &spots, &settings).map_err(|error| Failure::Pipeline {
        path: path.clone(),
        error,
    })?;
    print(&report(&study).join("\n"))?;
    print(&liquids(arguments).join("\n"))?;
    match &arguments.output {
        Some(folder) => write(folder, &study),
        None => Ok(()),
    }
}

fn write(folder: &Path, study: &IndexStudy) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    for drawn in drawn(study) {
        // A curve without a value anywhere is a table of blanks, and no drawing.
        let files = [("csv", Some(csv(&drawn))), ("svg", svg(&drawn).ok())];
        for (ending, text) in files {
            let Some(text) = text else { continue };
            let path = folder.join(format!("{}.{ending}", drawn.name));
            fs::write(&path, text).map_err(|e| Failure::file(&path, e))?;
        }
    }
    Ok(())
}

/// The study's curves.
fn drawn(study: &IndexStudy) -> Vec<Drawn<'_>> {
    let interval = |method| study.estimate(method).map(|e| e.interval);
    let mut curves = Vec::new();
    if study.observability.is_some() {
        curves.push(Drawn {
            name: "ray-distance-plain".to_owned(),
            quantity: "mean ray distance (mm)".to_owned(),
            curve: &study.plain_curve,
            level: None,
            interval: None,
        });
        curves.push(Drawn {
            name: "ray-distance".to_owned(),
            quantity: "mean robust loss of ray distance over its sigma".to_owned(),
            curve: &study.ray_distance_curve,
            level: None,
            interval: interval(IndexMethod::RayDistance),
        });
    }
    curves.extend(study.overlap_curve.iter().map(|curve| Drawn {
        name: "overlap".to_owned(),
        quantity: "RMS distance from the shared faces (mm)".to_owned(),
        curve,
        level: None,
        interval: interval(IndexMethod::Overlap),
    }));
    curves.extend(study.known_curves.iter().map(|known| {
        let what = match known.kind {
            KnownKind::PlaneAngle => "angle between two planes (degrees)",
            KnownKind::EdgeLength => "edge (mm)",
            KnownKind::Flatness => "RMS distance from the plane (mm)",
            KnownKind::Radius => "radius (mm)",
        };
        Drawn {
            name: format!("known-{}", known.entry),
            quantity: what.to_owned(),
            curve: &known.measured,
            level: Some(known.known),
            interval: interval(IndexMethod::KnownShape),
        }
    }));
    curves
}

fn report(study: &IndexStudy) -> Vec<String> {
    let mut lines: Vec<String> = study.observability.iter().flat_map(observability).collect();
    lines.extend([
        String::new(),
        "method        index     sigma     sampling  model     floor     verdict".to_owned(),
    ]);
    lines.extend(study.estimates.iter().map(row));
    for (method, why) in &study.not_applicable {
        lines.push(format!("{:<13} -         {why}", method.name()));
    }
    for estimate in &study.estimates {
        if let Some(reason) = &estimate.reason {
            lines.push(format!("{}: {reason}", estimate.method.name()));
        }
        if let Some(remedy) = study.remedy(estimate.method) {
            lines.push(format!("{}: remedy: {remedy}", estimate.method.name()));
        }
    }
    lines.push(String::new());
    lines.push("eq. (3) as printed, with calibration taken at its word:".to_owned());
    if let Some(minimum) = study.plain_curve.minimum() {
        lines.push(if minimum.at_bound {
            "  least at the end of the search range, so it tells nothing".to_owned()
        } else {
            format!(
                "  least at {:.4} (no standard deviation; do not use it)",
                minimum.index
            )
        });
    }
    for known in &study.known_curves {
        lines.push(format!(
            "known[{}]: changes by {:.2} per unit of the index",
            known.entry, known.sensitivity
        ));
    }
    if let Some(best) = study.best() {
        lines.push(String::new());
        lines.push("joint estimate of calibration:".to_owned());
        for correction in &best.corrections {
            lines.push(format!(
                "  {:<45} {:+.5} +- {:.5} (before {:.5}) {}",
                correction.unknown.describe(),
                correction.by,
                correction.sigma,
                correction.prior_sigma,
                if correction.moved_by_data() {
                    "from the data"
                } else {
                    "held by its prior"
                }
            ));
        }
    }
    lines
}

fn observability(seen: &Observability) -> [String; 2] {
    [
        format!(
            "ray distance  {:.2} px of signal per unit of the index (median); {:.1} degrees off the mirror \
             plane, incidence {:.1} and {:.1} degrees, {:.0} mm deep",
            seen.median_pixels,
            seen.off_mirror_plane,
            seen.beam_incidence,
            seen.sight_incidence,
            seen.depth
        ),
        format!(
            "laser         0.05 degrees within the plane of the rays shift the index by {:+.4}, across it by \
             {:+.4}, if nothing corrects for them",
            seen.shift_in_plane, seen.shift_out_of_plane
        ),
    ]
}

fn row(estimate: &IndexEstimate) -> String {
    let value = estimate.value.map_or("-".to_owned(), |n| format!("{n:.4}"));
    let model = estimate
        .model_sigma
        .map_or("-".to_owned(), |s| format!("{s:.4}"));
    format!(
        "{:<13} {value:<9} {:<9.4} {:<9.4} {model:<9} {:<9.4} {}",
        estimate.method.name(),
        estimate.sigma,
        estimate.sampling_sigma,
        estimate.floor,
        estimate.verdict.name()
    )
}

fn liquids(arguments: &Arguments) -> Vec<String> {
    let (nm, celsius) = (arguments.wavelength, arguments.temperature);
    let mut lines = vec![format!("\nliquids at {nm} nm and {celsius} C:")];
    lines.extend(
        LIQUIDS
            .iter()
            .map(|l| format!("  {:<10} {:.4}", l.name, l.index(nm, celsius))),
    );
    lines
}
