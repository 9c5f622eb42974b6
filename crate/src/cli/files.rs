//! Writing a result's files.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use super::Failure;
use crate::export::{Format, ReconstructionResult};

/// What `--formats` names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// Every format that can hold the result.
    All,
    /// This one.
    For(Format),
}

impl FromStr for Asked {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let known = Format::ALL.iter().copied();
        let named = known.clone().find(|format| format.name() == name);
        if let Some(format) = named {
            return Ok(Self::For(format));
        }
        let names: Vec<String> = known.map(Format::name).collect();
        let all = (name == "all").then_some(Self::All);
        all.ok_or_else(|| format!("there are {} and all", names.join(", ")))
    }
}

impl Asked {
    /// What is written unless anything is asked for.
    pub(super) fn usual() -> Vec<Self> {
        Format::USUAL.map(Self::For).to_vec()
    }
}

/// Writes a result into a folder, a file a format. A format that cannot hold the result takes nothing from
/// the others: it is left out with a note, and is an error at the end if it was asked for by name.
#[expect(clippy::print_stderr, reason = "the note is for a person")]
pub(super) fn write(
    folder: &Path,
    result: &ReconstructionResult,
    asked: &[Asked],
) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    let named = |format: Format| asked.contains(&Asked::For(format));
    let all = asked.contains(&Asked::All);
    let formats = Format::ALL.iter().copied();
    let mut missing = None;
    for format in formats.filter(|format| all || named(*format)) {
        let path = folder.join(format.file_name());
        match result.write(format) {
            Ok(bytes) => fs::write(&path, bytes).map_err(|e| Failure::file(&path, e))?,
            Err(error) if named(format) => {
                missing.get_or_insert_with(|| Failure::file(&path, error));
            }
            Err(error) => eprintln!("  {} is left out: {error}", format.file_name()),
        }
    }
    missing.map_or(Ok(()), Err)
}
