use std::path::PathBuf;

use super::{Failure, files, views};
use crate::export::{Format, ReconstructionResult};
use crate::pipeline::{Reconstruction, Settings, reconstruct};

/// Arguments of `snellius reconstruct`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The folder that the files are written to
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// What to write, separated by commas; json,ply,vessel-ply,csv if left out
    #[arg(long, short, value_delimiter = ',', value_name = "FORMATS", value_parser = files::format)]
    formats: Option<Vec<Format>>,
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
    let formats = arguments.formats.as_deref().unwrap_or(&Format::USUAL);
    files::write(&arguments.output, &result, formats)?;
    summarise(&reconstruction, &result);
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
