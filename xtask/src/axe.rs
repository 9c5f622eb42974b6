//! axe-core, which finds faults of accessibility: from the npm registry, in the version that
//! `tests/axe/package.json` pins.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::{
    packages,
    process::{find_in_path, program, root, run},
};

/// The folder that has it in its `node_modules`; fetched if it is not there.
pub(crate) fn ensure() -> Result<PathBuf> {
    let wanted = root().join("tests").join("axe").join("package.json");
    let folder = root().join("target").join("npm").join("axe");
    let version = &json(&wanted)?["dependencies"]["axe-core"];
    let version = version
        .as_str()
        .context("tests/axe/package.json names no version of axe-core")?;
    if installed(&folder).as_deref() == Some(version) {
        return Ok(folder);
    }
    println!("fetching axe-core {version} from the npm registry");
    if find_in_path("npm").is_none() {
        packages::install(&["npm"]).context("axe-core comes by npm; install Node.js with npm")?;
    }
    fs::create_dir_all(&folder)?;
    fs::copy(&wanted, folder.join("package.json"))?;
    run(program("npm")
        .args(["install", "--ignore-scripts", "--no-audit", "--no-fund"])
        .args(["--no-package-lock", "--silent"])
        .current_dir(&folder))
    .context("axe-core cannot be fetched, so accessibility cannot be tested")?;
    Ok(folder)
}

fn installed(folder: &Path) -> Option<String> {
    let manifest = json(&folder.join("node_modules/axe-core/package.json")).ok()?;
    manifest["version"].as_str().map(str::to_owned)
}

fn json(file: &Path) -> Result<Value> {
    let text =
        fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
    serde_json::from_str(&text).with_context(|| format!("{} is no JSON", file.display()))
}
