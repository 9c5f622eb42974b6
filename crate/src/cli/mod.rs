//! The companion program `snellius`: reconstructs, checks and simulates scan archives.
//!
//! Results go to files or to standard output, everything said to a person goes to standard error. The
//! program ends with 0, with 1 if the input is at fault, and with 2 if it was called wrongly.

mod check;
mod curves;
mod export;
mod files;
mod index;
mod reconstruct;
mod repeat;
mod schema;
mod share;
mod simulate;
mod table;
mod views;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::pipeline::PipelineError;
use crate::scan::ScanError;
use crate::simulate::SceneError;

/// Measures objects in 3-D through glass and liquid with a laser range finder.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Measures vessel and object of a scan archive
    Reconstruct(reconstruct::Arguments),
    /// Writes a result in other formats
    Export(export::Arguments),
    /// Makes a page of one file that shows a scan's reconstruction, anywhere and without a network
    Share(share::Arguments),
    /// Says what is in a scan archive and what looks wrong
    Check(check::Arguments),
    /// Says what a scan tells of the liquid's refractive index, by every method
    Index(index::Arguments),
    /// Works out the table of a rig that never moves against its window
    Table(table::Arguments),
    /// Makes a scan archive of a scene, with the truth beside it
    Simulate(simulate::Arguments),
    /// Makes a large scan archive of a small one by repeating its views
    Repeat(repeat::Arguments),
    /// Prints the JSON Schemas of scan.json and result.json
    Schema(schema::Arguments),
}

/// What makes the program end with 1.
#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error("{path}: {problem}")]
    File { path: PathBuf, problem: String },
    #[error("{path}: {error}")]
    Scan { path: PathBuf, error: ScanError },
    #[error("{path}: {error}")]
    Pipeline { path: PathBuf, error: PipelineError },
    #[error("{path}: the refractive index is not determined by {method}: {reason}")]
    NotDetermined {
        path: PathBuf,
        method: &'static str,
        reason: String,
    },
    #[error("{path}: {error}")]
    Scene { path: PathBuf, error: SceneError },
}

impl Failure {
    fn file(path: &Path, problem: impl ToString) -> Self {
        Self::File {
            path: path.to_owned(),
            problem: problem.to_string(),
        }
    }

    fn scan(path: &Path, error: ScanError) -> Self {
        Self::Scan {
            path: path.to_owned(),
            error,
        }
    }
}

/// Writes a command's output. A reader that has had enough, as in `snellius schema | head`, is no fault.
fn print(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    match writeln!(output, "{text}").and_then(|()| output.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::file(Path::new("standard output"), e))
        }
        _ => Ok(()),
    }
}

/// Runs the program with the process's arguments.
#[expect(clippy::print_stderr, reason = "this is where the program speaks")]
pub fn run() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Reconstruct(arguments) => reconstruct::run(&arguments),
        Command::Export(arguments) => export::run(&arguments),
        Command::Share(arguments) => share::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Index(arguments) => index::run(&arguments),
        Command::Table(arguments) => table::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Repeat(arguments) => repeat::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(1)
        }
    }
}
