use std::fmt;

/// Where in a scan something is wrong: `views[3].on`, `camera.fx`, or the file as a whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place(String);

impl Place {
    /// A key of the manifest, written as a path.
    pub fn key(path: impl Into<String>) -> Self {
        Self(path.into())
    }

    /// A key of a view.
    pub fn view(index: usize, key: &str) -> Self {
        Self(format!("views[{index}].{key}"))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// What can be wrong with a scan archive.
#[derive(Debug, thiserror::Error)]
pub enum ScanError {
    /// The bytes are no ZIP archive, or one that was cut off.
    #[error(
        "this is not a whole ZIP archive ({problem}); a scan archive is a .zip with scan.json and its \
         pictures, and one that was cut off while copying must be copied again"
    )]
    NotAnArchive {
        /// What the ZIP reader says.
        problem: String,
    },
    /// The archive has no manifest.
    #[error(
        "no scan.json at the archive's root or in its only top-level folder; it holds {entries} entries{}",
        first.as_ref().map(|name| format!(", the first is \"{name}\"")).unwrap_or_default()
    )]
    NoManifest {
        /// How many entries there are.
        entries: usize,
        /// The name of the first.
        first: Option<String>,
    },
    /// The manifest is no JSON.
    #[error("scan.json, line {line}, column {column}: {problem}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the JSON reader says.
        problem: String,
    },
    /// A value of the manifest is missing, of the wrong type or impossible.
    #[error("{place}: {problem}")]
    Value {
        /// Its key.
        place: Place,
        /// What is wrong with it.
        problem: String,
    },
    /// An entry that the manifest names is not in the archive.
    #[error("{place}: no entry \"{name}\"")]
    NoEntry {
        /// The key that names it.
        place: Place,
        /// The name.
        name: String,
    },
    /// An entry cannot be read or decoded.
    #[error("{place}: \"{name}\": {problem}")]
    Entry {
        /// The key that names it.
        place: Place,
        /// The entry.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
}

impl ScanError {
    pub(crate) fn value(place: Place, problem: impl Into<String>) -> Self {
        Self::Value {
            place,
            problem: problem.into(),
        }
    }
}
