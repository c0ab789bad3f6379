//! What is wrong with a file, and where.

use std::fmt;

/// One inconsistency in a file. Displays as `file:line: message`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Diagnostic {
    /// File, as it was named to the reader.
    pub file: String,
    /// Line, from 1.
    pub line: u32,
    /// What is wrong, naming the element.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.message)
    }
}

impl std::error::Error for Diagnostic {}
