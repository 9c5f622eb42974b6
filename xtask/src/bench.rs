//! `cargo xtask bench`: the core's benchmarks.

use std::path::Path;

use anyhow::{Context, Result};

use crate::process::{cargo, run as run_to_end};

/// Runs the files in `crate/benches`, on the sample or on the scan archives given.
pub(crate) fn run(mut arguments: lexopt::Parser) -> Result<()> {
    let mut command = cargo(["bench", "--package", "snellius", "--bench", "*", "--"]);
    for scan in arguments.raw_args()? {
        // Cargo starts a benchmark in the package's folder, where a relative path would lead astray.
        let path = Path::new(&scan).canonicalize();
        command.arg(path.with_context(|| scan.to_string_lossy().into_owned())?);
    }
    run_to_end(&mut command)
}
