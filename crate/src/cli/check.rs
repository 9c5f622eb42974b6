use std::path::PathBuf;

use super::{Failure, print, views};
use crate::pipeline::{Settings, reconstruct};
use crate::scan::{Scan, sweeps};
use crate::spots::Spots;
use crate::text::{count, some_of};

/// Arguments of `snellius check`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The scan archive
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// Leave the pictures undecoded: check the manifest and that every entry is there
    #[arg(long)]
    quick: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let archive = views::open(&arguments.scan)?;
    let scan = archive.scan();
    for line in contents(scan) {
        print(&line)?;
    }
    let mut odd = scan.warnings.clone();
    if !arguments.quick {
        let settings = Settings::default();
        let spots = views::spots(&arguments.scan, scan.stations.len(), &settings, 0)?;
        print(&spots_found(&spots))?;
        odd.extend(measurement_oddities(scan, &spots, &settings));
    }
    for warning in &odd {
        print(&format!("looks wrong: {warning}"))?;
    }
    if odd.is_empty() {
        print("nothing looks wrong")?;
    }
    Ok(())
}

fn contents(scan: &Scan) -> Vec<String> {
    let manifest = &scan.manifest;
    let camera = &manifest.camera;
    let media = &manifest.media;
    let inside = media.inside.map_or("unknown".to_owned(), |n| n.to_string());
    let rows = sweeps(&scan.stations)
        .into_iter()
        .max()
        .map_or(0, |last| last + 1);
    let in_air = scan
        .stations
        .iter()
        .filter(|s| s.inside == crate::scan::InsideMedium::Air);
    vec![
        format!("scan      {}", manifest.name),
        format!(
            "views     {}, {} in air, in {}",
            manifest.views.len(),
            in_air.count(),
            count(rows, "sweep")
        ),
        format!("pictures  {} x {} px", camera.width, camera.height),
        format!(
            "vessel    {:?}, wall {} mm",
            manifest.vessel.shape, manifest.vessel.wall_thickness
        )
        .to_lowercase(),
        format!(
            "media     {} outside, {} wall, {inside} inside",
            media.outside, media.wall
        ),
    ]
}

fn spots_found(spots: &[Spots]) -> String {
    let total: usize = spots.iter().map(|view| view.spots.len()).sum();
    let noise: f64 = spots.iter().map(|view| view.noise).sum::<f64>() / spots.len() as f64;
    format!(
        "spots     {:.1} a view, noise of the difference {noise:.2} grey values",
        total as f64 / spots.len() as f64
    )
}

/// What only a measurement shows: views without spots, and why there is no reconstruction.
fn measurement_oddities(scan: &Scan, spots: &[Spots], settings: &Settings) -> Vec<String> {
    let views = scan.manifest.views.iter().zip(spots);
    let empty: Vec<&str> = views
        .filter(|(_, s)| s.spots.is_empty())
        .map(|(view, _)| view.id.as_str())
        .collect();
    let mut odd = Vec::new();
    if !empty.is_empty() {
        odd.push(format!(
            "no laser spot in {}: {}",
            count(empty.len(), "view"),
            some_of(&empty)
        ));
    }
    match reconstruct(scan, spots, settings) {
        Ok(reconstruction) => {
            let known = scan.warnings.len();
            odd.extend(reconstruction.result().warnings.into_iter().skip(known));
        }
        Err(error) => odd.push(error.to_string()),
    }
    odd
}
