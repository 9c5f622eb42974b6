use std::fs;
use std::path::PathBuf;

use super::Failure;
use super::files::{self, Asked};
use crate::export::ReconstructionResult;

/// Arguments of `snellius export`.
#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// A result that `snellius reconstruct` or the page has written
    #[arg(value_name = "RESULT.json")]
    result: PathBuf,
    /// What to write, separated by commas; `all` is whatever can hold the result
    #[arg(
        long,
        short,
        required = true,
        value_delimiter = ',',
        value_name = "FORMATS"
    )]
    formats: Vec<Asked>,
    /// The folder that the files are written to
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.result;
    let bytes = fs::read(path).map_err(|e| Failure::file(path, e))?;
    if bytes.starts_with(b"PK") {
        return Err(Failure::file(
            path,
            "a scan archive, not a result; `snellius reconstruct` measures it and takes --formats as well",
        ));
    }
    let result = ReconstructionResult::from_json(&bytes).map_err(|e| Failure::file(path, e))?;
    files::write(&arguments.output, &result, &arguments.formats)
}
