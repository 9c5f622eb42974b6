//! Scans as large as one likes, made of a sample.

use std::{
    fs::File,
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use serde_json::{Value, json};
use zip::{CompressionMethod, ZipArchive, ZipWriter, write::SimpleFileOptions};

use crate::places::samples;

/// The sample of a line laser so many times over, each copy a little further along its wall. The copies share
/// their pictures.
pub fn line_copies(folder: &Path, copies: usize) -> Result<PathBuf> {
    let samples = samples()?;
    let line = samples.iter().find(|path| path.ends_with("line.zip"));
    let mut archive = ZipArchive::new(File::open(line.context("no sample line.zip")?)?)?;
    let mut manifest: Value = serde_json::from_reader(archive.by_name("scan.json")?)?;
    let views = manifest["views"].as_array().context("no views")?.clone();
    let moved = |copy: usize| views.iter().map(move |view| moved(view, copy, copies));
    manifest["views"] = (0..copies).flat_map(moved).collect();

    let path = folder.join("many.zip");
    let mut many = ZipWriter::new(File::create(&path)?);
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    many.start_file("scan.json", stored)?;
    many.write_all(&serde_json::to_vec(&manifest)?)?;
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index)?;
        if entry.name()? != "scan.json" {
            many.raw_copy_file(entry)?;
        }
    }
    many.finish()?;
    Ok(path)
}

/// A view as if the rig had stood a part of a step further along the wall, which is turned by two degrees.
fn moved(view: &Value, copy: usize, copies: usize) -> Value {
    const STEP: f64 = 6.0;
    let way = STEP * copy as f64 / copies as f64;
    // tan 2 degrees.
    let slope = -0.034_920_769_5;
    let mut view = view.clone();
    view["id"] = format!("{}-{copy}", view["id"].as_str().unwrap_or_default()).into();
    let place = &mut view["world_from_flange"]["translation"];
    let at = |place: &Value, axis: usize| place[axis].as_f64().unwrap_or_default();
    *place = json!([at(place, 0) + way, at(place, 1), at(place, 2) + slope * way]);
    view
}
