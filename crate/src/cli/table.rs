use std::fs;
use std::path::{Path, PathBuf};

use super::{Failure, views};
use crate::pipeline::{Settings, reconstruct};
use crate::table::{Reach, Table, build};

/// Arguments of `snellius table`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A scan archive of the rig before its wall
    #[arg(value_name = "SCAN.zip")]
    scan: PathBuf,
    /// The file that the table is written to
    #[arg(long, short, value_name = "TABLE.json")]
    output: PathBuf,
    /// The view whose pose against the wall the table is for; the first if left out
    #[arg(long, value_name = "ID")]
    view: Option<String>,
    /// The liquid's refractive index, in place of the scan's
    #[arg(long, value_name = "N")]
    index: Option<f64>,
    /// The nearest point in reach, mm behind the wall along the light
    #[arg(long, default_value_t = 1.0, value_name = "MM")]
    nearest: f64,
    /// The farthest point in reach, mm behind the wall along the light
    #[arg(long, default_value_t = 400.0, value_name = "MM")]
    farthest: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scan;
    let settings = Settings {
        index: arguments.index,
        ..Settings::default()
    };
    let archive = views::open(path)?;
    let scan = archive.scan();
    let view = match &arguments.view {
        None => 0,
        Some(id) => {
            let found = scan.manifest.views.iter().position(|view| view.id == *id);
            found.ok_or_else(|| Failure::file(path, format!("no view has the id \"{id}\"")))?
        }
    };
    let spots = views::spots(path, scan, &settings, 0)?;
    let reconstruction =
        reconstruct(scan, &spots, &settings).map_err(|error| Failure::Pipeline {
            path: path.clone(),
            error,
        })?;
    let reach = Reach {
        nearest: arguments.nearest,
        farthest: arguments.farthest,
    };
    let table = build(&reconstruction, view, reach).map_err(|e| Failure::file(path, e))?;
    let output = &arguments.output;
    fs::write(output, table.to_json()).map_err(|e| Failure::file(output, e))?;
    summarise(&table);
    Ok(())
}

/// Reads a table that `run` wrote.
pub(super) fn read(path: &Path) -> Result<Table, Failure> {
    let json = fs::read(path).map_err(|e| Failure::file(path, e))?;
    serde_json::from_slice(&json).map_err(|e| Failure::file(path, format!("no table: {e}")))
}

#[expect(clippy::print_stderr, reason = "the summary is for a person")]
fn summarise(table: &Table) {
    let (grid, accuracy) = (&table.grid, &table.accuracy);
    eprintln!("{}, view {}", table.scan, table.view);
    eprintln!(
        "  nodes         {} x {}, {} px apart",
        grid.columns, grid.rows, grid.step
    );
    eprintln!(
        "  between them  at most {:.5} mm off, {:.3} standard deviations of a spot located to {:.3} px \
         ({} places compared)",
        accuracy.largest_error, accuracy.largest_share, accuracy.pixel_sigma, accuracy.places
    );
}
