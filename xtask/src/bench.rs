//! `cargo xtask bench`: what the core takes, and what a large archive takes in the page.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use lexopt::prelude::*;

use crate::{
    browser, page,
    process::{cargo, program, root, run as run_to_end, target_directory},
    test,
};

/// More than the 4 GiB that a ZIP file can count without Zip64.
const LARGE: &str = "4.4G";

/// What the command line may say.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Options {
    /// The core's benchmarks, on the sample or on the scan archives given.
    Core(Vec<OsString>),
    /// The page, with an archive of that size.
    Large(String),
}

impl Options {
    pub(crate) fn parse(mut arguments: lexopt::Parser) -> Result<Self> {
        let mut scans = vec![];
        while let Some(argument) = arguments.next()? {
            match argument {
                Long("large") => {
                    let size = arguments.next()?.map_or_else(
                        || Ok(LARGE.to_owned()),
                        |size| match size {
                            Value(size) => size.string().map_err(anyhow::Error::from),
                            other => Err(other.unexpected().into()),
                        },
                    )?;
                    ensure!(scans.is_empty(), "--large makes its own archive");
                    return Ok(Self::Large(size));
                }
                Value(scan) => scans.push(scan),
                other => return Err(other.unexpected().into()),
            }
        }
        Ok(Self::Core(scans))
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    match options {
        Options::Core(scans) => core(scans),
        Options::Large(size) => large(size),
    }
}

/// Runs the files in `crate/benches`.
fn core(scans: &[OsString]) -> Result<()> {
    let mut command = cargo(["bench", "--package", "snellius", "--bench", "*", "--"]);
    for scan in scans {
        // Cargo starts a benchmark in the package's folder, where a relative path would lead astray.
        let path = Path::new(scan).canonicalize();
        command.arg(path.with_context(|| scan.to_string_lossy().into_owned())?);
    }
    run_to_end(&mut command)
}

/// Makes a large archive and sends it through the page as it was built last.
fn large(size: &str) -> Result<()> {
    let dist = page::dist();
    ensure!(
        dist.join("index.html").is_file(),
        "there is no page in {}; run `cargo xtask dist` first",
        dist.display()
    );
    let browser = browser::find_or_install()?;
    let archive = LargeArchive::make(size)?;
    // What takes time here is the browser's program, so the benchmark's own is not optimised.
    let words = "bench --profile dev --package snellius-tests --bench large --";
    run_to_end(
        cargo(words.split(' '))
            .arg(&archive.0)
            .env("SNELLIUS_DIST", dist)
            .env("CHROME", browser.chromium),
    )
}

/// An archive that is gone when it is not needed any more.
struct LargeArchive(PathBuf);

impl LargeArchive {
    fn make(size: &str) -> Result<Self> {
        let companion = test::companion()?;
        let archive = Self(target_directory()?.join("large.zip"));
        let sample = root().join("samples").join("tank-paper.zip");
        run_to_end(
            program(companion)
                .arg("repeat")
                .arg(sample)
                .args(["--size", size, "--output"])
                .arg(&archive.0),
        )?;
        Ok(archive)
    }
}

impl Drop for LargeArchive {
    fn drop(&mut self) {
        // The next one is written over it.
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(words: &[&str]) -> Result<Options> {
        Options::parse(lexopt::Parser::from_args(words.iter().copied()))
    }

    #[test]
    fn a_large_archive_has_a_size_of_its_own_unless_one_is_given() {
        let large = |size: &str| Options::Large(size.to_owned());
        assert_eq!(options(&["--large"]).unwrap(), large(LARGE));
        assert_eq!(options(&["--large", "100M"]).unwrap(), large("100M"));
    }

    #[test]
    fn scans_are_for_the_core() {
        let core = |scans: &[&str]| Options::Core(scans.iter().map(Into::into).collect());
        assert_eq!(options(&[]).unwrap(), core(&[]));
        assert_eq!(options(&["a.zip"]).unwrap(), core(&["a.zip"]));
        assert!(options(&["a.zip", "--large"]).is_err());
        assert!(options(&["--huge"]).is_err());
    }
}
