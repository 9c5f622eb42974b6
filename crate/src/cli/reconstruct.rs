use std::fs;
use std::path::PathBuf;

use super::{Failure, views};
use crate::export::{ReconstructionResult, object_ply, points_csv, vessel_ply};
use crate::pipeline::{Reconstruction, Settings, reconstruct};

/// Arguments of `snellius reconstruct`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The folder that result.json, object.ply, vessel.ply and points.csv are written to
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// The liquid's refractive index, in place of the scan's
    #[arg(long, value_name = "N")]
    index: Option<f64>,
    /// How many threads read pictures; 0 is one per core
    #[arg(long, default_value_t = 0, value_name = "N")]
    jobs: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scan;
    let settings = Settings {
        index: arguments.index,
        ..Settings::default()
    };
    let archive = views::open(path)?;
    let scan = archive.scan();
    let spots = views::spots(path, scan, &settings, arguments.jobs)?;
    let reconstruction =
        reconstruct(scan, &spots, &settings).map_err(|error| Failure::Pipeline {
            path: path.clone(),
            error,
        })?;
    let result = reconstruction.result();
    write(arguments, &result)?;
    summarise(&reconstruction, &result);
    Ok(())
}

fn write(arguments: &Arguments, result: &ReconstructionResult) -> Result<(), Failure> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    let files = [
        ("result.json", result.to_json()),
        ("object.ply", object_ply(result)),
        ("vessel.ply", vessel_ply(result)),
        ("points.csv", points_csv(result)),
    ];
    for (name, text) in files {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|e| Failure::file(&path, e))?;
    }
    Ok(())
}

#[expect(clippy::print_stderr, reason = "the summary is for a person")]
fn summarise(reconstruction: &Reconstruction, result: &ReconstructionResult) {
    let summary = reconstruction.summary();
    eprintln!("{}", result.scan);
    eprintln!(
        "  views         {} of {} have an object point",
        summary.used,
        result.views.len()
    );
    eprintln!(
        "  vessel        {} points, RMS {:.3} mm",
        result.vessel.points, result.vessel.rms
    );
    if let Some(mean) = summary.mean_ray_distance {
        eprintln!("  ray distance  {mean:.3} mm on average");
    }
    eprintln!("  index inside  {}", reconstruction.media.liquid);
    for warning in &result.warnings {
        eprintln!("  warning: {warning}");
    }
}
