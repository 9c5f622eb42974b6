use std::fs;
use std::path::PathBuf;

use super::{Failure, table, views};
use crate::export::{ReconstructionResult, Status, object_ply, points_csv, vessel_ply};
use crate::pipeline::{Settings, reconstruct};
use crate::table::measure;

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
    /// Measure with the table of a rig that never moves against its window, and trace no ray
    #[arg(long, value_name = "TABLE.json", conflicts_with = "index")]
    table: Option<PathBuf>,
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
    if let Some(table) = &arguments.table {
        let measured = measure(&table::read(table)?, scan, &spots, &settings.object);
        let result = measured.map_err(|e| Failure::file(path, e))?;
        write(arguments, &result)?;
        summarise(&result);
        return Ok(());
    }
    let reconstruction =
        reconstruct(scan, &spots, &settings).map_err(|error| Failure::Pipeline {
            path: path.clone(),
            error,
        })?;
    let result = reconstruction.result();
    write(arguments, &result)?;
    summarise(&result);
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
fn summarise(result: &ReconstructionResult) {
    eprintln!("{}", result.scan);
    let used = result.views.iter().filter(|view| view.status == Status::Ok);
    eprintln!(
        "  views         {} of {} have an object point",
        used.count(),
        result.views.len()
    );
    eprintln!(
        "  vessel        {} points, RMS {:.3} mm",
        result.vessel.points, result.vessel.rms
    );
    let distances = result
        .views
        .iter()
        .flat_map(|view| view.ray_distance.iter());
    let count = distances.clone().count();
    if count > 0 {
        let mean = distances.sum::<f64>() / count as f64;
        eprintln!("  ray distance  {mean:.3} mm on average");
    }
    if let Some(index) = result.media.inside.value {
        eprintln!("  index inside  {index}");
    }
    for warning in &result.warnings {
        eprintln!("  warning: {warning}");
    }
}
