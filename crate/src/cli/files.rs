//! Writing a result's files.

use std::fs;
use std::path::Path;

use super::Failure;
use crate::export::{Format, ReconstructionResult};

/// Reads a format's name.
pub(super) fn format(name: &str) -> Result<Format, String> {
    let known = Format::ALL.iter().copied();
    known.clone().find(|f| f.name() == name).ok_or_else(|| {
        let names: Vec<String> = known.map(Format::name).collect();
        format!("there are {}", names.join(", "))
    })
}

/// Writes a result into a folder, a file a format. All of them are made before the first is written, so
/// that a format that cannot hold the result leaves nothing half done.
pub(super) fn write(
    folder: &Path,
    result: &ReconstructionResult,
    formats: &[Format],
) -> Result<(), Failure> {
    let files: Vec<_> = formats
        .iter()
        .map(|format| {
            let path = folder.join(format.file_name());
            match result.write(*format) {
                Ok(bytes) => Ok((path, bytes)),
                Err(error) => Err(Failure::file(&path, error)),
            }
        })
        .collect::<Result<_, _>>()?;
    fs::create_dir_all(folder).map_err(|e| Failure::file(folder, e))?;
    for (path, bytes) in files {
        fs::write(&path, bytes).map_err(|e| Failure::file(&path, e))?;
    }
    Ok(())
}
