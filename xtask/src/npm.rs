//! `cargo xtask npm`: the core as an npm package, in `target/npm/snellius`.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::{
    process::{cargo, find_in_path, program, root, run, target_directory},
    setup::{self, WASM},
    tools, typescript,
};

/// Where the package ends up.
pub(crate) fn package() -> PathBuf {
    root().join("target").join("npm").join("snellius")
}

/// Builds the package anew; `npm pack` in its folder makes the archive that one publishes.
pub(crate) fn build() -> Result<()> {
    setup::wasm_target()?;
    let bindgen = tools::wasm_bindgen_program()?;
    run(&mut cargo([
        "build",
        "--package",
        "snellius-npm",
        "--profile",
        "web-measure",
        "--target",
        WASM,
    ]))?;
    let module = target_directory()?
        .join(WASM)
        .join("web-measure")
        .join("snellius_npm.wasm");
    let package = package();
    if package.exists() {
        fs::remove_dir_all(&package)
            .with_context(|| format!("cannot clear {}", package.display()))?;
    }
    fs::create_dir_all(&package)?;
    run(program(bindgen)
        .args(["--target", "web", "--out-name", "snellius", "--out-dir"])
        .arg(package.join("wasm"))
        .arg(&module))?;
    copy_all(&root().join("npm").join("js"), &package)?;
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(root().join(licence), package.join(licence))?;
    }
    fs::write(package.join("schema.d.ts"), types()?)?;
    fs::write(package.join("package.json"), manifest()?)?;
    let bytes = fs::metadata(package.join("wasm").join("snellius_bg.wasm"))?.len();
    println!(
        "npm package: {} ({:.2} MB of WebAssembly)",
        package.display(),
        bytes as f64 / 1e6
    );
    Ok(())
}

/// Installs the package into a folder's `node_modules`, as `npm install` would, without asking any registry.
pub(crate) fn install_into(folder: &Path) -> Result<()> {
    let modules = folder.join("node_modules").join("snellius");
    if modules.exists() {
        fs::remove_dir_all(&modules)?;
    }
    copy_all(&package(), &modules)
}

/// Node, if it is here.
pub(crate) fn node() -> Option<PathBuf> {
    find_in_path("node")
}

/// The package's manifest, with the workspace's version.
fn manifest() -> Result<String> {
    let template = root().join("npm").join("package.json");
    let text = fs::read_to_string(&template)
        .with_context(|| format!("cannot read {}", template.display()))?;
    // As text: of the conditions under "exports" the first that holds counts, so their order must stay.
    Ok(text.replace("\"0.0.0\"", concat!("\"", env!("CARGO_PKG_VERSION"), "\"")))
}

/// The types of results and settings, from the core's own schemas.
fn types() -> Result<String> {
    let schema = |which: &str| -> Result<Value> {
        let words = [
            "run",
            "--quiet",
            "--package",
            "snellius",
            "--",
            "schema",
            which,
        ];
        let printed = cargo(words).output().context("cannot start cargo")?;
        ensure!(
            printed.status.success(),
            "`snellius schema {which}` failed: {}",
            String::from_utf8_lossy(&printed.stderr)
        );
        serde_json::from_slice(&printed.stdout).context("a schema is JSON")
    };
    Ok(typescript::declarations(&[
        schema("result")?,
        schema("settings")?,
    ]))
}

fn copy_all(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| format!("cannot read {}", from.display()))? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}
