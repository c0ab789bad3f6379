//! Values over time for the inputs of a system, from a CSV file: `time` and names of the system's input
//! connectors. Each row holds from its time \[s\] until the next one, as in setpoint files.

use crate::fmu::short;
use crate::input::Error;
use crate::input::rows::Rows;
use crate::input::setpoints::{Row, end};

/// The file, checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Table {
    /// Names of the columns after the time.
    pub names: Vec<String>,
    /// Values of the columns; times increase.
    pub rows: Vec<Row>,
}

impl Table {
    /// Reads a file, whose first row must hold at `start`. `inputs` are the connectors that there are.
    pub fn read(text: &str, file: &str, start: f64, inputs: &[&str]) -> Result<Self, Error> {
        let mut source = Rows::new(text, file)?;
        let (head, columns) = (source.head(), source.columns.clone());
        if columns.len() < 2 || columns[0] != "time" {
            return Err(Error::Header {
                place: head,
                expected: "time and names of inputs of the system",
                found: columns.join(","),
            });
        }
        for (i, name) in columns.iter().enumerate().skip(1) {
            if columns[..i].contains(name) {
                return Err(Error::TwoSources {
                    place: head,
                    name: name.clone(),
                });
            }
            if !inputs.contains(&name.as_str()) {
                return Err(Error::Syntax {
                    place: head,
                    message: format!(
                        "the system has no input {name}; there are: {}",
                        inputs.join(", ")
                    ),
                });
            }
        }
        let mut rows: Vec<Row> = Vec::new();
        while source.read()? {
            source.complete()?;
            let place = source.place();
            let time = source.number(0)?;
            let values = (1..columns.len()).map(|column| source.number(column));
            let values = values.collect::<Result<_, _>>()?;
            match rows.last().map(|row| row.time) {
                Some(previous) if time <= previous => {
                    return Err(Error::Time {
                        place,
                        value: time,
                        previous: Some(previous),
                    });
                }
                None if time != start => {
                    let message = format!(
                        "time = {time} s: the first row must hold at the start, time {} s",
                        short(start)
                    );
                    return Err(Error::Syntax { place, message });
                }
                _ => rows.push(Row { time, values }),
            }
        }
        if rows.is_empty() {
            return Err(Error::NoRows { place: head });
        }
        let names = columns[1..].to_vec();
        Ok(Self { names, rows })
    }

    /// When its last row ends \[s\], as of setpoints. None for a single row.
    pub fn end(&self) -> Option<f64> {
        end(&self.rows)
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
