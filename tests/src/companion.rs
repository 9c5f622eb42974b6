//! The companion program, whose files the page's must equal.

use std::{fs, path::Path, process::Command};

use anyhow::{Context, Result, ensure};
use tempfile::TempDir;

use crate::places;

/// Every format that the page, or a page of one file, offers as well.
const FORMATS: &str = "json,ply,vessel-ply,csv,object-csv,pcd,las,e57,glb,stl,obj,html";

/// A one-file page of a scan archive, as `snellius share` makes it; `more` are further arguments.
pub fn share(archive: &Path, more: &[&str]) -> Result<Vec<u8>> {
    let directory = tempfile::tempdir()?;
    let page = directory.path().join("page.html");
    let ran = Command::new(places::companion()?)
        .arg("share")
        .arg(archive)
        .arg("--output")
        .arg(&page)
        .arg("--viewer")
        .arg(places::dist()?.join("viewer.html"))
        .args(more)
        .output()
        .context("cannot start the companion program")?;
    let said = String::from_utf8_lossy(&ran.stderr);
    ensure!(
        ran.status.success(),
        "snellius share {} {more:?} ended with {}: {said}",
        archive.display(),
        ran.status
    );
    Ok(fs::read(&page)?)
}

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
