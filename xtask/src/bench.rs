//! `cargo xtask bench`: the core's benchmarks.

use anyhow::Result;

use crate::process::{cargo, run as run_to_end};

/// Runs the files in `crate/benches`; what stands after `bench` is handed on to them.
pub(crate) fn run(mut arguments: lexopt::Parser) -> Result<()> {
    let rest = arguments.raw_args()?;
    run_to_end(cargo(["bench", "--package", "snellius", "--bench", "*"]).args(rest))
}
