//! Where the things under test lie. `cargo xtask test` says so by variables; without them the
//! usual places count, so that `cargo test -p snellius-tests` works after a build.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};

/// The workspace's root.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("tests/ lies in the workspace")
}

fn variable(name: &str) -> Option<PathBuf> {
    std::env::var_os(name).map(PathBuf::from)
}

/// The built page.
pub fn dist() -> Result<PathBuf> {
    let dist = variable("SNELLIUS_DIST").unwrap_or_else(|| root().join("dist"));
    ensure!(
        dist.join("index.html").is_file(),
        "no page in {}; run `cargo xtask test`",
        dist.display()
    );
    Ok(dist)
}

/// The companion program.
pub fn companion() -> Result<PathBuf> {
    let program = variable("SNELLIUS_CLI").map_or_else(companion_beside_tests, Ok)?;
    ensure!(
        program.is_file(),
        "no companion program at {}; run `cargo xtask test`",
        program.display()
    );
    Ok(program)
}

/// The npm package.
pub fn npm_package() -> Result<PathBuf> {
    let usual = || root().join("target").join("npm").join("snellius");
    let package = variable("SNELLIUS_NPM").unwrap_or_else(usual);
    ensure!(
        package.join("package.json").is_file(),
        "no npm package in {}; run `cargo xtask npm`",
        package.display()
    );
    Ok(package)
}

/// The script of axe-core, which finds faults of accessibility.
pub fn axe() -> Result<PathBuf> {
    let usual = || root().join("target").join("npm").join("axe");
    let folder = variable("SNELLIUS_AXE").unwrap_or_else(usual);
    let script = folder.join("node_modules/axe-core/axe.min.js");
    ensure!(
        script.is_file(),
        "no axe-core at {}; run `cargo xtask test`",
        script.display()
    );
    Ok(script)
}

/// The tests run from `target/debug/deps`.
fn companion_beside_tests() -> Result<PathBuf> {
    let this = std::env::current_exe()?;
    let directory = this
        .parent()
        .and_then(Path::parent)
        .context("the tests lie in no target directory")?;
    Ok(directory.join(format!("snellius{}", std::env::consts::EXE_SUFFIX)))
}

/// Chromium, or a browser made from it.
pub(crate) fn chromium() -> Result<PathBuf> {
    if let Some(chosen) = variable("CHROME") {
        return Ok(chosen);
    }
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"];
    let path = std::env::var_os("PATH").unwrap_or_default();
    for name in names {
        let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
        let found = std::env::split_paths(&path).map(|directory| directory.join(&name));
        if let Some(found) = found.into_iter().find(|program| program.is_file()) {
            return Ok(found);
        }
    }
    bail!("no Chromium in PATH; set CHROME to one, or run `cargo xtask test`, which installs it")
}

/// The sample archives, smallest first.
pub fn samples() -> Result<Vec<PathBuf>> {
    let directory = root().join("samples");
    let mut archives = vec![];
    for entry in fs::read_dir(&directory)? {
        let path = entry?.path();
        if path.extension().is_some_and(|kind| kind == "zip") {
            archives.push((fs::metadata(&path)?.len(), path));
        }
    }
    ensure!(
        !archives.is_empty(),
        "no archive in {}",
        directory.display()
    );
    archives.sort();
    Ok(archives.into_iter().map(|(_, path)| path).collect())
}

/// Where screenshots are kept to be looked at.
pub(crate) fn screenshots() -> Result<PathBuf> {
    let directory = variable("SNELLIUS_SCREENSHOTS")
        .unwrap_or_else(|| root().join("target").join("e2e-screenshots"));
    fs::create_dir_all(&directory)
        .with_context(|| format!("cannot make {}", directory.display()))?;
    Ok(directory)
}
