//! The user's cache, where what was built or fetched once is kept.

use std::{
    fs::{self, File},
    path::PathBuf,
};

use anyhow::{Context, Result};

/// `snellius` in the user's cache directory.
pub(crate) fn directory() -> Result<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    let directory = if cfg!(windows) {
        variable("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        variable("HOME").map(|home| home.join("Library/Caches"))
    } else {
        variable("XDG_CACHE_HOME").or_else(|| variable("HOME").map(|home| home.join(".cache")))
    };
    let directory = directory.context("no cache directory: HOME is not set")?;
    Ok(directory.join("snellius"))
}

/// Two set-ups at the same time would write the same files: the second one waits here, and then finds the
/// work done. The lock goes with the file that is given back.
pub(crate) fn lock() -> Result<File> {
    let tools = directory()?.join("tools");
    fs::create_dir_all(&tools).with_context(|| format!("cannot make {}", tools.display()))?;
    let lock = File::create(tools.join("lock"))?;
    if lock.try_lock().is_err() {
        println!("waiting for another set-up to end");
        lock.lock().context("cannot lock the tools' directory")?;
    }
    Ok(lock)
}
