//! The TypeScript compiler, from npm, in the user's cache: it reads our declarations as other people's
//! programs do.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};

use crate::{
    cache,
    process::{find_in_path, program, run},
};

/// The version that the declarations are checked with.
const VERSION: &str = "5.9.3";

/// The compiler; `None` where there is no npm to install it with.
pub(crate) fn ensure() -> Result<Option<PathBuf>> {
    let Some(npm) = find_in_path("npm") else {
        return Ok(None);
    };
    let home = cache::directory()?.join(format!("typescript-{VERSION}"));
    let _lock = cache::lock()?;
    let compiler = home
        .join("node_modules")
        .join("typescript")
        .join("bin")
        .join("tsc");
    if !compiler.is_file() {
        println!(
            "installing TypeScript {VERSION} from npm into {}",
            home.display()
        );
        fs::create_dir_all(&home).with_context(|| format!("cannot make {}", home.display()))?;
        run(program(npm)
            .args(["install", "--no-audit", "--no-fund", "--silent", "--prefix"])
            .arg(&home)
            .arg(format!("typescript@{VERSION}")))
        .context("TypeScript cannot be installed from npm, so the declarations were NOT checked")?;
    }
    Ok(Some(compiler))
}
