use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::reconstruct::WantedIndex;
use super::{Failure, views};
use crate::pipeline::{Settings, reconstruct};
use crate::share::{Document, Viewer, one_file};

/// Arguments of `snellius share`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The page to write
    #[arg(long, short, value_name = "PAGE.html")]
    output: PathBuf,
    /// What stands above it; the scan's name if left out
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// What stands below that
    #[arg(long, default_value = "", value_name = "TEXT")]
    notes: String,
    /// The liquid's refractive index in place of the scan's, or how to estimate it: a number,
    /// ray-distance, overlap, known-shape or joint
    #[arg(long, value_name = "INDEX")]
    index: Option<WantedIndex>,
    /// Measures views in air or liquid as the scan itself proposes, where scan.json seems wrong
    #[arg(long)]
    accept_media: bool,
    /// The viewer, which has viewer.wasm beside it; if left out, viewer.html beside this program
    #[arg(long, value_name = "VIEWER.html")]
    viewer: Option<PathBuf>,
    /// How many threads read pictures; 0 is one per core
    #[arg(long, default_value_t = 0, value_name = "N")]
    jobs: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scan;
    // Before the work, so that nobody waits for nothing.
    let (place, viewer, module) = viewer(arguments)?;
    let settings = Settings {
        index: arguments.index.and_then(WantedIndex::value),
        index_method: arguments.index.and_then(WantedIndex::method),
        accept_media: arguments.accept_media,
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
    let document = Document::new(
        arguments.title.clone(),
        arguments.notes.clone(),
        settings,
        Some(scan.manifest.clone()),
        result,
    );
    let viewer = Viewer {
        page: &viewer,
        module: &module,
    };
    let page = one_file(&viewer, &document).map_err(|e| Failure::file(&place, e))?;
    fs::write(&arguments.output, page).map_err(|e| Failure::file(&arguments.output, e))
}

/// Where the viewer lies, its page and its module.
fn viewer(arguments: &Arguments) -> Result<(PathBuf, String, Vec<u8>), Failure> {
    let place = match &arguments.viewer {
        Some(place) => place.clone(),
        None => {
            let program = env::current_exe().unwrap_or_default();
            program.with_file_name("viewer.html")
        }
    };
    let module = place.with_extension("wasm");
    let page = fs::read_to_string(&place).map_err(|error| no_viewer(&place, &error))?;
    let module = fs::read(&module).map_err(|error| no_viewer(&module, &error))?;
    Ok((place, page, module))
}

fn no_viewer(place: &Path, error: &io::Error) -> Failure {
    Failure::file(
        place,
        format!(
            "{error}; viewer.html and viewer.wasm are what one-file pages are made of: `cargo xtask viewer` builds \
             them, every site of Snellius has them beside its index.html, and --viewer says where they lie"
        ),
    )
}
