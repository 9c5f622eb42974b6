//! Reading a scan and finding its spots, spread over threads.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::Failure;
use crate::pipeline::{Settings, observe};
use crate::scan::{Archive, ScanError};
use crate::spots::Spots;

/// Opens an archive.
pub(super) fn open(path: &Path) -> Result<Archive<BufReader<File>>, Failure> {
    let file = File::open(path).map_err(|e| Failure::file(path, e))?;
    Archive::open(BufReader::new(file)).map_err(|e| Failure::scan(path, e))
}

/// Finds the spots of every view on `jobs` threads (0: one per core), with a progress bar on standard
/// error if that is a terminal. Each thread reads the archive by itself.
pub(super) fn spots(
    path: &Path,
    views: usize,
    settings: &Settings,
    jobs: usize,
) -> Result<Vec<Spots>, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(jobs)
        .build()
        .map_err(|e| Failure::file(path, e))?;
    let bar = progress_bar(views, "views");
    let found: Result<Vec<Spots>, ViewFailure> = pool.install(|| {
        (0..views)
            .into_par_iter()
            .progress_with(bar.clone())
            .map_init(
                || open(path),
                |archive, view| match archive {
                    Ok(archive) => observe(archive, view, settings).map_err(ViewFailure::Scan),
                    Err(_) => Err(ViewFailure::Reopen),
                },
            )
            .collect()
    });
    bar.finish_and_clear();
    found.map_err(|failure| match failure {
        ViewFailure::Scan(error) => Failure::scan(path, error),
        ViewFailure::Reopen => Failure::file(path, "the file changed while it was being read"),
    })
}

enum ViewFailure {
    Scan(ScanError),
    Reopen,
}

/// A bar that names what it counts, the rate and the time left.
pub(super) fn progress_bar(length: usize, what: &str) -> ProgressBar {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {what}, {{per_sec}}, {{eta}} left");
    let style =
        ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length as u64).with_style(style)
}
