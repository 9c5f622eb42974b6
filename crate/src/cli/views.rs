//! Reading a scan and finding its spots, spread over threads.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use indicatif::{ParallelProgressIterator, ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::Failure;
use crate::pipeline::{Settings, observe};
use crate::scan::{Archive, Scan, ScanError};
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
    scan: &Scan,
    settings: &Settings,
    jobs: usize,
) -> Result<Vec<Spots>, Failure> {
    let views = scan.stations.len();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads(scan, jobs))
        .build()
        .map_err(|e| Failure::file(path, e))?;
    let bar = progress_bar(views, "views");
    let found: Vec<Result<Spots, ViewFailure>> = pool.install(|| {
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
    // Of several failures the first view's, whichever thread came upon one first.
    let found: Result<Vec<Spots>, ViewFailure> = found.into_iter().collect();
    found.map_err(|failure| match failure {
        ViewFailure::Scan(error) => Failure::scan(path, error),
        ViewFailure::Reopen => Failure::file(path, "the file changed while it was being read"),
    })
}

/// As many threads as were asked for, but no more than have room for their pictures.
fn threads(scan: &Scan, jobs: usize) -> usize {
    /// While it is decoded a pixel takes up to 16 bytes: four colours of 16 bits, and grey values.
    const BYTES: usize = 16;
    const ROOM: usize = 768 << 20;
    let (width, height) = (scan.manifest.camera.width, scan.manifest.camera.height);
    let room = ROOM / (BYTES * width as usize * height as usize);
    let asked = match jobs {
        0 => rayon::current_num_threads(),
        jobs => jobs,
    };
    asked.min(room.max(1))
}

enum ViewFailure {
    Scan(ScanError),
    Reopen,
}

/// A bar that names what it counts, the rate and the time left.
pub(super) fn progress_bar(length: usize, what: &str) -> ProgressBar {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {what}, {{per_sec}}, {{eta}} left");
    bar(length as u64, &template)
}

/// A bar of bytes that are written, likewise.
pub(super) fn bytes_bar(bytes: u64) -> ProgressBar {
    const TEMPLATE: &str = "{bar:40} {bytes}/{total_bytes}, {bytes_per_sec}, {eta} left";
    bar(bytes, TEMPLATE)
}

fn bar(length: u64, template: &str) -> ProgressBar {
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}
