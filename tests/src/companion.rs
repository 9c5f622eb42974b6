//! The companion program, whose files the page's must equal.

use std::{fs, path::Path, process::Command};

use anyhow::{Context, Result, ensure};
use tempfile::TempDir;

use crate::places;

/// Every format that the page offers as well.
const FORMATS: &str = "json,ply,vessel-ply,csv,object-csv,pcd,glb,stl,obj,html";

/// What `snellius reconstruct` wrote.
pub struct Output(TempDir);

impl Output {
    /// Reconstructs a scan archive; `more` are further arguments.
    pub fn of(archive: &Path, more: &[&str]) -> Result<Self> {
        let directory = tempfile::tempdir()?;
        let ran = Command::new(places::companion()?)
            .arg("reconstruct")
            .arg(archive)
            .arg("--output")
            .arg(directory.path())
            .args(["--formats", FORMATS])
            .args(more)
            .output()
            .context("cannot start the companion program")?;
        let said = String::from_utf8_lossy(&ran.stderr);
        ensure!(
            ran.status.success(),
            "snellius reconstruct {} {more:?} ended with {}: {said}",
            archive.display(),
            ran.status
        );
        Ok(Self(directory))
    }

    /// One of the files.
    pub fn file(&self, name: &str) -> Result<Vec<u8>> {
        fs::read(self.0.path().join(name))
            .with_context(|| format!("snellius reconstruct wrote no {name}"))
    }
}
