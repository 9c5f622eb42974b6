//! What went wrong, said so that a person can act on it: the cause, and the next step.

use serde::{Deserialize, Serialize};
use snellius::export::ExportError;
use snellius::pipeline::{PipelineError, Stage};
use snellius::scan::ScanError;

/// A cause and a next step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Problem {
    /// What the matter is, as far as the page treats it differently.
    pub(crate) kind: ProblemKind,
    /// The stage that could not be done, if the spots were found.
    pub(crate) stage: Option<Stage>,
    /// The cause, with its place.
    pub(crate) cause: String,
    /// What to do next.
    pub(crate) next_step: String,
}

/// Whose matter a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum ProblemKind {
    /// The archive cannot be used.
    Input,
    /// The liquid's index is needed and not known.
    IndexWanted,
    /// The index that was given cannot be one.
    IndexImpossible,
    /// The program is at fault.
    Own,
}

impl Problem {
    /// The archive is at fault.
    pub(crate) fn input(cause: impl Into<String>, next_step: &str) -> Self {
        Self {
            kind: ProblemKind::Input,
            stage: None,
            cause: cause.into(),
            next_step: next_step.to_owned(),
        }
    }

    /// The scan does not tell the liquid's index.
    pub(crate) fn index_wanted(reason: Option<&str>) -> Self {
        Self {
            kind: ProblemKind::IndexWanted,
            stage: Some(Stage::Index),
            cause: format!(
                "The scan does not determine the liquid's refractive index: {}.",
                reason.unwrap_or("nothing in it depends on the index")
            ),
            next_step: "Give the liquid's refractive index below.".to_owned(),
        }
    }

    /// The program is at fault.
    pub(crate) fn own(cause: impl Into<String>) -> Self {
        Self {
            kind: ProblemKind::Own,
            stage: None,
            cause: cause.into(),
            next_step:
                "This is a fault of the program, not of your scan. Load the page again; if it \
                        happens again, please report this message."
                    .to_owned(),
        }
    }
}

impl From<ExportError> for Problem {
    fn from(error: ExportError) -> Self {
        Self::input(
            format!("This file cannot be written: {error}."),
            "Save it in another format.",
        )
    }
}

impl From<ScanError> for Problem {
    fn from(error: ScanError) -> Self {
        let next_step = match &error {
            ScanError::NotAnArchive { .. } => {
                "Choose a .zip that holds scan.json and the pictures it names."
            }
            ScanError::NoManifest { .. } => {
                "Put scan.json at the root of the archive, beside the pictures, and choose it again."
            }
            ScanError::Syntax { .. } | ScanError::Value { .. } => {
                "Correct this in scan.json, pack the archive again and choose it once more."
            }
            ScanError::NoEntry { .. } => {
                "Add the picture to the archive, or correct its name in scan.json, and choose the \
                 archive again."
            }
            ScanError::Entry { .. } => {
                "Replace this entry by a good copy, and choose the archive again."
            }
        };
        Self::input(capitalised(&error.to_string()), next_step)
    }
}

impl From<PipelineError> for Problem {
    fn from(error: PipelineError) -> Self {
        let cause = capitalised(&error.to_string());
        let stage = Some(error.stage());
        let (kind, next_step) = match error {
            PipelineError::Scan(error) => return error.into(),
            PipelineError::Index(_) => (
                ProblemKind::IndexWanted,
                "Correct this in scan.json, or give the liquid's refractive index below.",
            ),
            PipelineError::IndexImpossible(_) => (
                ProblemKind::IndexImpossible,
                "Give a number between 1 and 4; water has 1.333.",
            ),
            PipelineError::Vessel(_) => (
                ProblemKind::Input,
                "Try another shape below, or check the scan's pictures and calibration, and choose the \
                 corrected archive.",
            ),
            PipelineError::NoSpots { .. } => (
                ProblemKind::Input,
                "Try a lower peak below, or check the scan's pictures, and choose the corrected archive.",
            ),
        };
        Self {
            kind,
            stage,
            cause,
            next_step: next_step.to_owned(),
        }
    }
}

/// A message of the core as a sentence, unless it starts with a key of the manifest.
fn capitalised(message: &str) -> String {
    let is_key = message
        .split_once(':')
        .is_some_and(|(key, _)| !key.contains(' '));
    let mut letters = message.chars();
    match letters.next() {
        Some(first) if !is_key => first.to_uppercase().chain(letters).collect(),
        _ => message.to_owned(),
    }
}
