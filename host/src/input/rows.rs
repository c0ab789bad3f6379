//! CSV files row by row: a header, then rows of as many values.

use super::{Error, Place};
use csv::{Position, Reader, ReaderBuilder, StringRecord, Trim};

/// A file from its header on.
pub(crate) struct Rows<'a> {
    file: String,
    reader: Reader<&'a [u8]>,
    /// Names in the header.
    pub(crate) columns: Vec<String>,
    /// The values of the row that was read last, as they are written.
    pub(crate) record: StringRecord,
}

impl<'a> Rows<'a> {
    /// Reads the header; `file` names the text in messages.
    pub(crate) fn new(text: &'a str, file: impl Into<String>) -> Result<Self, Error> {
        let reader = ReaderBuilder::new()
            .trim(Trim::All)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut rows = Self {
            file: file.into(),
            reader,
            columns: Vec::new(),
            record: StringRecord::new(),
        };
        rows.read()?;
        rows.columns = rows.record.iter().map(str::to_owned).collect();
        Ok(rows)
    }

    /// Reads the next row, if there is one.
    pub(crate) fn read(&mut self) -> Result<bool, Error> {
        let read = self.reader.read_record(&mut self.record);
        read.map_err(|error| Error::Syntax {
            place: Place::new(&*self.file, error.position().map(Position::line)),
            message: error.to_string(),
        })
    }

    /// Where the header is.
    pub(crate) fn head(&self) -> Place {
        Place::new(&*self.file, Some(1))
    }

    /// Line of the row.
    pub(crate) fn line(&self) -> u64 {
        self.record.position().map_or(0, Position::line)
    }

    /// Where the row is.
    pub(crate) fn place(&self) -> Place {
        Place::new(&*self.file, Some(self.line()))
    }

    /// Refuses a row with more or fewer values than the header has columns.
    pub(crate) fn complete(&self) -> Result<(), Error> {
        let (found, expected) = (self.record.len(), self.columns.len());
        if found == expected {
            return Ok(());
        }
        Err(Error::Columns {
            place: self.place(),
            found,
            expected,
        })
    }

    /// The finite number in a column of a complete row.
    pub(crate) fn number(&self, column: usize) -> Result<f64, Error> {
        let text = &self.record[column];
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| not_finite(&self.place(), &self.columns[column], text))
    }
}

/// A value that is no finite number, as it is written.
pub(super) fn not_finite(place: &Place, name: &str, value: &str) -> Error {
    Error::Value {
        place: place.clone(),
        name: name.to_owned(),
        value: value.to_owned(),
        expected: "a finite number".to_owned(),
    }
}
