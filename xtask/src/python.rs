//! Other people's readers of the formats that Snellius writes, from PyPI, in a virtual environment in the
//! user's cache.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};

use crate::{
    cache, packages,
    process::{find_in_path, output_of, program, root, run},
};

/// The tests and what they need.
pub(crate) fn tests() -> PathBuf {
    root().join("tests").join("exports")
}

/// A Python with everything in `tests/exports/requirements.txt`. That they cannot be had is an error:
/// without them nobody has read the exports back.
pub(crate) fn ensure() -> Result<PathBuf> {
    let wanted = fs::read_to_string(tests().join("requirements.txt"))
        .context("cannot read tests/exports/requirements.txt")?;
    let home = cache::directory()?.join(format!("python-{:016x}", fnv(&wanted)));
    let _lock = cache::lock()?;
    let installed = home.join("installed.txt");
    let python = python_in(&home);
    if !installed.is_file() || output_of(program(&python).arg("--version")).is_none() {
        install(&home).context(
            "the readers of tests/exports/requirements.txt cannot be installed from PyPI, so the exports \
             were NOT read back by other programs",
        )?;
        fs::write(&installed, wanted)?;
    }
    Ok(python)
}

fn install(home: &Path) -> Result<()> {
    println!(
        "installing the readers of the exports from PyPI into {}",
        home.display()
    );
    let environment = |home: &Path| -> Result<()> {
        let python = ["python3", "python"].into_iter().find_map(find_in_path);
        let python = python.context("there is no Python")?;
        run(program(python).args(["-m", "venv", "--clear"]).arg(home))
    };
    // Debian packs the module apart from Python itself.
    environment(home).or_else(|_| {
        packages::install(&["python3", "python3-venv"])
            .context("install Python 3 with its `venv` module")?;
        environment(home)
    })?;
    run(program(python_in(home))
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ])
        .arg("--requirement")
        .arg(tests().join("requirements.txt")))
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo): a name for each list of versions.
fn fnv(text: &str) -> u64 {
    let step = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

fn python_in(home: &Path) -> PathBuf {
    if cfg!(windows) {
        home.join("Scripts").join("python.exe")
    } else {
        home.join("bin").join("python")
    }
}
