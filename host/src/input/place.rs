//! Where a mistake is.

use std::fmt;
use std::path::Path;

/// A file and perhaps a line and a key, or an option: `FILE:LINE: KEY`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place(Box<Parts>);

/// Boxed: an error has one, and results should be small.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Parts {
    file: String,
    line: Option<u64>,
    key: Option<String>,
}

impl Place {
    /// A place in a file as the user named it, its lines counted from 1, or an option.
    pub fn new(file: impl Into<String>, line: Option<u64>) -> Self {
        Self(Box::new(Parts {
            file: file.into(),
            line,
            key: None,
        }))
    }

    pub(super) fn in_file(path: &Path, line: u64) -> Self {
        Self::new(path.display().to_string(), Some(line))
    }

    /// The same at a key, which is named with the tables that it is in, like `run.sequence.every`.
    pub(crate) fn at_key(mut self, key: impl Into<String>) -> Self {
        self.0.key = Some(key.into());
        self
    }

    /// The same with `line` if it names none.
    pub(crate) fn or_line(mut self, line: u64) -> Self {
        self.0.line.get_or_insert(line);
        self
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Parts { file, line, key } = &*self.0;
        f.write_str(file)?;
        line.map_or(Ok(()), |line| write!(f, ":{line}"))?;
        key.iter().try_for_each(|key| write!(f, ": {key}"))
    }
}
