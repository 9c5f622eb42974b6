use std::path::PathBuf;
use std::str::FromStr;

use super::files::{self, Asked};
use super::{Failure, table, views};
use crate::export::{InsideResult, ReconstructionResult, Status};
use crate::index::IndexMethod;
use crate::pipeline::{Settings, reconstruct};
use crate::table::measure;

/// Arguments of `snellius reconstruct`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The folder that the files are written to
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// What to write, separated by commas; json,ply,vessel-ply,csv if left out, `all` is whatever can hold
    /// the result
    #[arg(long, short, value_delimiter = ',', value_name = "FORMATS")]
    formats: Option<Vec<Asked>>,
    /// The liquid's refractive index in place of the scan's, or how to estimate it: a number,
    /// ray-distance, overlap, known-shape or joint
    #[arg(long, value_name = "INDEX")]
    index: Option<WantedIndex>,
    /// Measure with the table of a rig that never moves against its window, and trace no ray
    #[arg(long, value_name = "TABLE.json", conflicts_with = "index")]
    table: Option<PathBuf>,
    /// Measures views in air or liquid as the scan itself proposes, where scan.json seems wrong
    #[arg(long)]
    accept_media: bool,
    /// How many threads read pictures; 0 is one per core
    #[arg(long, default_value_t = 0, value_name = "N")]
    jobs: usize,
}

/// What `--index` says.
#[derive(Clone, Copy, Debug)]
pub(super) enum WantedIndex {
    Value(f64),
    Method(IndexMethod),
}

impl WantedIndex {
    pub(super) const fn value(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::Method(_) => None,
        }
    }

    pub(super) const fn method(self) -> Option<IndexMethod> {
        match self {
            Self::Value(_) => None,
            Self::Method(method) => Some(method),
        }
    }
}

impl FromStr for WantedIndex {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = ESTIMATES.into_iter().find(|method| method.name() == text);
        let value = || text.parse().map(Self::Value);
        named.map(Self::Method).map_or_else(value, Ok).map_err(|_| {
            format!(
                "neither a number nor one of {}",
                ESTIMATES.map(IndexMethod::name).join(", ")
            )
        })
    }
}

const ESTIMATES: [IndexMethod; 4] = [
    IndexMethod::RayDistance,
    IndexMethod::Overlap,
    IndexMethod::KnownShape,
    IndexMethod::Joint,
];

fn index_line(index: &InsideResult) -> String {
    match (index.value, index.sigma) {
        (Some(value), Some(sigma)) => format!(
            "{value:.4} +- {sigma:.4} by {}, {}",
            index.method.name(),
            index.verdict.name()
        ),
        (Some(value), None) => value.to_string(),
        (None, _) => format!("not determined by {}", index.method.name()),
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scan;
    let settings = Settings {
        index: arguments.index.and_then(WantedIndex::value),
        index_method: arguments.index.and_then(WantedIndex::method),
        accept_media: arguments.accept_media,
        ..Settings::default()
    };
    let archive = views::open(path)?;
    let scan = archive.scan();
    let spots = views::spots(path, scan, &settings, arguments.jobs)?;
    if let Some(table) = &arguments.table {
        let measured = measure(&table::read(table)?, scan, &spots, &settings.object);
        let result = measured.map_err(|e| Failure::file(path, e))?;
        let written = write(arguments, &result);
        summarise(&result);
        return written;
    }
    let reconstruction =
        reconstruct(scan, &spots, &settings).map_err(|error| Failure::Pipeline {
            path: path.clone(),
            error,
        })?;
    let result = reconstruction.result();
    let written = write(arguments, &result);
    summarise(&result);
    written?;
    // Who asks for a method by name and gets no answer is told so by the exit code as well.
    let index = &reconstruction.index;
    match (settings.index_method, index.value) {
        (Some(_), None) => Err(Failure::NotDetermined {
            path: path.clone(),
            method: index.method.name(),
            reason: index.reason.clone().unwrap_or_default(),
        }),
        _ => Ok(()),
    }
}

fn write(arguments: &Arguments, result: &ReconstructionResult) -> Result<(), Failure> {
    let asked = arguments.formats.clone().unwrap_or_else(Asked::usual);
    files::write(&arguments.output, result, &asked)
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
    eprintln!("  index inside  {}", index_line(&result.media.inside));
    for warning in &result.warnings {
        eprintln!("  warning: {warning}");
    }
}
