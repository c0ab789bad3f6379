//! Samples as CSV.

use crate::run::recording::Recording;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// All rows; numbers read back exactly.
pub(super) fn write_csv(recording: &Recording, path: &Path) -> io::Result<()> {
    let mut header = csv::Writer::from_writer(Vec::new());
    header.write_record(recording.columns().iter().map(|c| c.name.as_str()))?;
    let mut file = BufWriter::with_capacity(1 << 20, fs::File::create(path)?);
    file.write_all(
        &header
            .into_inner()
            .map_err(|e| io::Error::other(e.to_string()))?,
    )?;
    let mut line = String::new();
    for row in recording.rows() {
        line.clear();
        for (i, value) in row.iter().enumerate() {
            if i > 0 {
                line.push(',');
            }
            // Formatting to a String cannot fail.
            let _ = if value.fract() == 0.0 && value.abs() < 1e15 {
                write!(line, "{}", *value as i64)
            } else {
                write!(line, "{value:?}")
            };
        }
        line.push('\n');
        file.write_all(line.as_bytes())?;
    }
    file.flush()
}
