use schemars::{Schema, schema_for};

use super::{Failure, print};
use crate::export::ReconstructionResult;
use crate::pipeline::Settings;
use crate::scan::Manifest;

/// Arguments of `snellius schema`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// Which format; all, keyed by name, if left out
    format: Option<Format>,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Format {
    /// scan.json
    Scan,
    /// result.json
    Result,
    /// The settings that a scan is measured with
    Settings,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let schema = match arguments.format {
        Some(format) => schema(format).to_value(),
        None => serde_json::json!({
            "scan": schema(Format::Scan),
            "result": schema(Format::Result),
            "settings": schema(Format::Settings),
        }),
    };
    print(&format!("{schema:#}"))
}

fn schema(format: Format) -> Schema {
    match format {
        Format::Scan => schema_for!(Manifest),
        Format::Result => schema_for!(ReconstructionResult),
        Format::Settings => schema_for!(Settings),
    }
}
