//! Values over time for the inputs of a system, from a CSV file: `time` and names of the system's input
//! connectors. Each row holds from its time \[s\] until the next one, as in setpoint files.

use crate::fmu::short;
use crate::input::{Error, Place};
use csv::{Position, ReaderBuilder, Trim};

/// The file, checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Table {
    /// Names of the columns after the time.
    pub names: Vec<String>,
    /// Times \[s\] and values; times increase.
    pub rows: Vec<(f64, Vec<f64>)>,
}

impl Table {
    /// Reads a file, whose first row must hold at `start`. `inputs` are the connectors that there are.
    pub fn read(text: &str, file: &str, start: f64, inputs: &[&str]) -> Result<Self, Error> {
        let mut reader = ReaderBuilder::new()
            .trim(Trim::All)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut records = reader.records();
        let place = |line: u64| Place::new(file, Some(line));
        let broken = |error: csv::Error| Error::Syntax {
            place: Place::new(file, error.position().map(Position::line)),
            message: error.to_string(),
        };
        let header = records
            .next()
            .transpose()
            .map_err(broken)?
            .unwrap_or_default();
        let columns: Vec<String> = header.iter().map(str::to_owned).collect();
        if columns.len() < 2 || columns[0] != "time" {
            return Err(Error::Header {
                place: place(1),
                expected: "time and names of inputs of the system",
                found: columns.join(","),
            });
        }
        for (i, name) in columns.iter().enumerate().skip(1) {
            if columns[..i].contains(name) {
                return Err(Error::TwoSources {
                    place: place(1),
                    name: name.clone(),
                });
            }
            if !inputs.contains(&name.as_str()) {
                return Err(Error::Syntax {
                    place: place(1),
                    message: format!(
                        "the system has no input {name}; there are: {}",
                        inputs.join(", ")
                    ),
                });
            }
        }
        let mut table = Self {
            names: columns[1..].to_vec(),
            rows: Vec::new(),
        };
        for record in records {
            let record = record.map_err(broken)?;
            let place = place(record.position().map_or(0, Position::line));
            if record.len() != columns.len() {
                return Err(Error::Columns {
                    place,
                    found: record.len(),
                    expected: columns.len(),
                });
            }
            let mut numbers = Vec::new();
            for (text, name) in record.iter().zip(&columns) {
                let number = text.parse().ok().filter(|number: &f64| number.is_finite());
                numbers.push(number.ok_or_else(|| Error::Value {
                    place: place.clone(),
                    name: name.clone(),
                    value: text.to_owned(),
                    expected: "a finite number".to_owned(),
                })?);
            }
            let time = numbers.remove(0);
            match table.rows.last() {
                Some((previous, _)) if time <= *previous => {
                    return Err(Error::Time {
                        place,
                        value: time,
                        previous: Some(*previous),
                    });
                }
                None if time != start => {
                    let message = format!(
                        "time = {time} s: the first row must hold at the start, time {} s",
                        short(start)
                    );
                    return Err(Error::Syntax { place, message });
                }
                _ => table.rows.push((time, numbers)),
            }
        }
        if table.rows.is_empty() {
            return Err(Error::NoRows { place: place(1) });
        }
        Ok(table)
    }

    /// When its last row ends \[s\], which is taken to hold as long as the longest before it. None for a
    /// single row.
    pub fn end(&self) -> Option<f64> {
        let held = self.rows.windows(2).map(|w| w[1].0 - w[0].0);
        Some(self.rows.last()?.0 + held.reduce(f64::max)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let read = |text| Table::read(text, "u.csv", 0.0, &["u", "v"]).map_err(|e| e.to_string());
        let table = read("time, v\n0, 1\n0.5, 2\n0.75, 3\n").unwrap();
        assert_eq!(
            (table.names.as_slice(), table.end()),
            (&["v".to_owned()][..], Some(1.25))
        );
        for (text, message) in [
            (
                "t,u\n0,1",
                "u.csv:1: the header must be time and names of inputs of the system, not \"t,u\"",
            ),
            (
                "time,w\n0,1",
                "u.csv:1: the system has no input w; there are: u, v",
            ),
            ("time,u,u\n0,1,1", "u.csv:1: u"),
            (
                "time,u\n0,1,2",
                "u.csv:2: 3 values, but the header names 2 columns",
            ),
            (
                "time,u\n0,x",
                "u.csv:2: u = \"x\": expected a finite number",
            ),
            (
                "time,u\n1,1",
                "u.csv:2: time = 1 s: the first row must hold at the start, time 0 s",
            ),
            (
                "time,u\n0,1\n0,2",
                "u.csv:3: time = 0 s does not come after 0 s",
            ),
            ("time,u\n", "u.csv:1: no rows"),
        ] {
            let found = read(text).unwrap_err();
            assert!(found.starts_with(message), "{found}");
        }
    }
}
