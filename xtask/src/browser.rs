//! Chromium and chromedriver: found where they usually are, else installed where that is possible
//! without asking anyone.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::packages;
use crate::process::{find_in_path, output_of, program};

/// The two programs that browser tests need.
#[derive(Debug)]
pub(crate) struct Browser {
    pub(crate) chromium: PathBuf,
    pub(crate) chromedriver: PathBuf,
}

/// Finds both programs, installing them from the distribution where they are missing.
pub(crate) fn find_or_install() -> Result<Browser> {
    if let Some(browser) = find() {
        return Ok(browser);
    }
    install()?;
    find().context("the package is installed, but no working Chromium is to be found; set CHROME to one and CHROMEDRIVER to its driver")
}

fn find() -> Option<Browser> {
    Some(Browser {
        chromium: chromium()?,
        chromedriver: chromedriver()?,
    })
}

fn chromium() -> Option<PathBuf> {
    let names = [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
        "chrome",
    ];
    let usual_places = [
        "/Applications/Chromium.app/Contents/MacOS/Chromium",
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
        r"C:\Program Files\Google\Chrome\Application\chrome.exe",
        r"C:\Program Files (x86)\Google\Chrome\Application\chrome.exe",
        r"C:\Program Files\Chromium\Application\chrome.exe",
    ];
    let chosen = std::env::var_os("CHROME").map(PathBuf::from);
    chosen
        .into_iter()
        .chain(names.into_iter().filter_map(find_in_path))
        .chain(usual_places.map(PathBuf::from))
        .find(|candidate| works(candidate))
}

fn chromedriver() -> Option<PathBuf> {
    let chosen = std::env::var_os("CHROMEDRIVER").map(PathBuf::from);
    let debian = PathBuf::from("/usr/lib/chromium/chromedriver");
    chosen
        .into_iter()
        .chain(find_in_path("chromedriver"))
        .chain([debian])
        .find(|candidate| works(candidate))
}

/// Some distributions ship a `chromium-browser` that only says where to get the real one.
fn works(candidate: &Path) -> bool {
    // On Windows `chrome.exe --version` opens a window and prints nothing.
    candidate.is_file()
        && (cfg!(windows) || output_of(program(candidate).arg("--version")).is_some())
}

fn install() -> Result<()> {
    packages::install(&["chromium", "chromium-driver"])
        .with_context(|| format!("Chromium and chromedriver are missing. {}", advice()))
}

fn advice() -> &'static str {
    if cfg!(target_os = "macos") {
        "Install both, for instance `brew install --cask chromium chromedriver`, or set CHROME and CHROMEDRIVER to them."
    } else if cfg!(windows) {
        "Install Chrome and the chromedriver of the same version, and set CHROME and CHROMEDRIVER to them."
    } else {
        "Install both (Debian: `sudo apt-get install chromium chromium-driver`), or set CHROME and CHROMEDRIVER to them."
    }
}
