//! The page, built by Trunk. How is said in `Trunk.toml` and in `web/index.html`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};

use crate::{
    process::{path_with, program, root, run},
    tools::{self, Tools},
    viewer,
};

/// Compressed or not, nobody waits for a page of tens of megabytes. Room to grow is left, but
/// a dependency that brings half the world along shall not go unnoticed.
const LIMIT_BYTES: u64 = 12_000_000;

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
        let code = code_bytes(dist)?;
        println!("code of the page: {:.2} MB", code as f64 / 1e6);
        ensure!(
            code <= LIMIT_BYTES,
            "the page's code has {code} bytes; the limit is {LIMIT_BYTES} (xtask/src/page.rs)"
        );
    }
    Ok(())
}

/// Size of the WebAssembly and JavaScript that a visitor may have to load.
fn code_bytes(dist: &Path) -> Result<u64> {
    let files = fs::read_dir(dist).with_context(|| format!("cannot read {}", dist.display()))?;
    let mut sum = 0;
    for file in files {
        let file = file?;
        let path = file.path();
        if path
            .extension()
            .is_some_and(|kind| kind == "wasm" || kind == "js")
        {
            sum += file.metadata()?.len();
        }
    }
    ensure!(sum > 0, "{} holds no code", dist.display());
    Ok(sum)
}
