//! What a one-file page carries: the scan's manifest and the result, each in its own public format.

use serde::{Deserialize, Serialize};

use crate::export::{ReconstructionResult, ResultError};
use crate::json;
use crate::pipeline::Settings;
use crate::scan::{Manifest, Scan, ScanError};

/// The format's name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DocumentFormat {
    /// `snellius-page`
    #[default]
    #[serde(rename = "snellius-page")]
    SnelliusPage,
}

/// A reconstruction with all that is needed to look at it, and to measure it again with another index: no
/// pictures, but where the spots are in them.
///
/// Version 1. A file that was made once opens for ever: `tests/data/page-v1.json` is opened by a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// `snellius-page`.
    pub format: DocumentFormat,
    /// The format's version: 1.
    pub version: u32,
    /// What stands above it.
    pub title: String,
    /// What its maker says of it.
    #[serde(default)]
    pub notes: String,
    /// How it was measured.
    #[serde(default)]
    pub settings: Settings,
    /// `scan.json`; missing where the reconstruction came without, as from a link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scan: Option<Manifest>,
    /// `result.json`.
    pub result: ReconstructionResult,
}

/// Why a file or its data cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// There is no data block in the file.
    #[error("this page holds no reconstruction of Snellius")]
    NotOurs,
    /// The file ends within its data block.
    #[error("the page was cut off: its data does not end")]
    Cut,
    /// It is no JSON, or not of this format.
    #[error("{place}: {problem}")]
    Format {
        /// Where in the data.
        place: String,
        /// What is wrong there.
        problem: String,
    },
    /// A later program made it.
    #[error(
        "the page is of version {0}, and this program knows version 1; load the newest program"
    )]
    Version(u64),
    /// The manifest in it cannot be used.
    #[error("scan: {0}")]
    Scan(#[from] ScanError),
    /// The result in it cannot be used.
    #[error("result: {0}")]
    Result(#[from] ResultError),
    /// What it is to be put into is no viewer.
    #[error(
        "{0} stands {1} times in the viewer, and should stand once: it is no viewer of Snellius"
    )]
    NoViewer(&'static str, usize),
}

impl DocumentError {
    pub(super) fn format(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Format {
            place: place.into(),
            problem: problem.into(),
        }
    }
}

impl Document {
    /// The newest version of the format.
    pub const VERSION: u32 = 1;

    /// A document of a measured scan; without a title of its own it has the scan's name.
    pub fn new(
        title: Option<String>,
        notes: String,
        settings: Settings,
        scan: Option<Manifest>,
        result: ReconstructionResult,
    ) -> Self {
        Self {
            format: DocumentFormat::SnelliusPage,
            version: Self::VERSION,
            title: title.unwrap_or_else(|| usual_title(&result)),
            notes,
            settings,
            scan,
            result,
        }
    }

    /// The document's bytes. The same document gives the same bytes everywhere.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self)
            .expect("strings and numbers alone, with string keys, always serialise")
    }

    /// Reads a document. Whatever the bytes are, nothing but numbers and texts comes out.
    pub fn from_json(json: &[u8]) -> Result<Self, DocumentError> {
        check_version(json)?;
        let document: Self = json::read(json, "the data")
            .map_err(|error| DocumentError::format(error.place, error.problem.to_string()))?;
        if document.result.version != 1 {
            return Err(ResultError::Version(document.result.version).into());
        }
        if let Some(scan) = document.checked_scan()? {
            check_views(&scan, &document.result)?;
        }
        Ok(document)
    }

    /// What the manifest means.
    pub(super) fn checked_scan(&self) -> Result<Option<Scan>, DocumentError> {
        Ok(self.scan.clone().map(Scan::new).transpose()?)
    }
}

/// What stands above a reconstruction unless its maker says something else.
fn usual_title(result: &ReconstructionResult) -> String {
    match result.scan.trim() {
        "" => "Reconstruction".to_owned(),
        name => name.to_owned(),
    }
}

/// A later version may look quite different: its number is read first, alone.
fn check_version(json: &[u8]) -> Result<(), DocumentError> {
    #[derive(Deserialize)]
    struct Head {
        format: DocumentFormat,
        version: u64,
    }
    let head: Head = serde_json::from_slice(json)
        .map_err(|error| DocumentError::format("the data", error.to_string()))?;
    let DocumentFormat::SnelliusPage = head.format;
    if head.version != u64::from(Document::VERSION) {
        return Err(DocumentError::Version(head.version));
    }
    Ok(())
}

fn check_views(scan: &Scan, result: &ReconstructionResult) -> Result<(), DocumentError> {
    let (stations, views) = (scan.stations.len(), result.views.len());
    if stations == views {
        return Ok(());
    }
    Err(DocumentError::format(
        "result.views",
        format!("{views} of them, and the scan has {stations}"),
    ))
}
