use crate::scan::Place;

/// Why somebody else's file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// It breaks the rules of its language.
    #[error("line {line}, column {column}: {problem}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the reader says.
        problem: String,
    },
    /// A value is missing, of the wrong kind, or says something that cannot be taken over.
    #[error("{place}: {problem}")]
    Value {
        /// Its key, or its line.
        place: Place,
        /// What is wrong with it.
        problem: String,
    },
    /// It is none of the kinds of file that can be read.
    #[error("{0}")]
    Unknown(String),
}

impl ImportError {
    pub(super) fn value(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Value {
            place: Place::key(place),
            problem: problem.into(),
        }
    }
}
