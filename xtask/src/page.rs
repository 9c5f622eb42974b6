//! The page, built by Trunk. How is said in `Trunk.toml` and in `web/index.html`.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::Result;

use crate::{
    process::{path_with, program, root, run},
    size,
    tools::{self, Tools},
    viewer,
};

/// How the page is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Profile {
    /// As it is published.
    Release,
    /// Quicker to compile, slower to run.
    Debug,
}

/// Where the published page ends up.
pub(crate) fn dist() -> PathBuf {
    root().join("dist")
}

/// A Trunk command, with the tools it needs in PATH.
pub(crate) fn trunk(tools: &Tools, subcommand: &str, profile: Profile) -> Result<Command> {
    let mut command = program(tools.trunk());
    command.arg(subcommand);
    if profile == Profile::Release {
        command.arg("--release");
    }
    command.env("PATH", path_with(tools.directories())?);
    // The custom is that NO_COLOR counts whatever it is set to; Trunk takes nothing but `true`.
    if std::env::var_os("NO_COLOR").is_some() {
        command.env("NO_COLOR", "true");
    }
    Ok(command)
}

/// Builds the page, and the viewer that it makes one-file pages of, into `dist` and holds its size against the
/// limit.
pub(crate) fn build(tools: &Tools, profile: Profile, dist: &Path) -> Result<()> {
    viewer::build(&tools::wasm_bindgen_program()?)?;
    run(trunk(tools, "build", profile)?.arg("--dist").arg(dist))?;
    if profile == Profile::Release {
        size::check(dist)?;
    }
    Ok(())
}
