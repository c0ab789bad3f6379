//! Setpoints over time, and values of other inputs, from a CSV file or as the rows of an experiment.
//!
//! The header is `time,setpoint` and optional further columns, each named like an input of either FMU
//! (`disturbance_torque`, or `plant.disturbance_torque` if both have one). Each row holds from its time
//! \[s\] until the next one (zero-order hold). The first row is at time 0, times increase, and every value is
//! a finite number, setpoints in the unit of the plant's angle (rad).

use super::rows::{Rows, not_finite};
use super::{Error, Pair, Place, Side, read_text};
use crate::fmu::{Causality, Scalar, short};
use csv::StringRecord;
use std::fmt;
use std::path::{Path, PathBuf};

/// Setpoints as the user gives them.
#[derive(Clone, Debug, PartialEq)]
pub enum Setpoints {
    /// A CSV file.
    File(PathBuf),
    /// Rows that stand elsewhere.
    Rows {
        /// Where the columns are named.
        place: Place,
        /// `time`, `setpoint`, then names of inputs.
        columns: Vec<String>,
        /// Each row with its place.
        rows: Vec<(Place, Vec<f64>)>,
    },
}

impl fmt::Display for Setpoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Rows { place, .. } => place.fmt(f),
        }
    }
}

impl Setpoints {
    /// Reads and checks them. `limits` bounds the setpoints, if it is known.
    pub fn table(&self, pair: Pair<'_>, limits: Option<AngleLimits>) -> Result<Table, Error> {
        match self {
            Self::File(path) => Table::read(path, pair, limits),
            Self::Rows {
                place,
                columns,
                rows,
            } => {
                let mut table = Table::new(pair, place, columns)?;
                for (place, row) in rows {
                    table.push(pair, place, columns, row, limits)?;
                }
                table.not_empty(place)
            }
        }
    }
}

/// What a run is driven by.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Inputs that the columns after the setpoint drive.
    pub inputs: Vec<(Side, Scalar)>,
    /// Rows in order; the first is at time 0.
    pub rows: Vec<Row>,
}

/// Values that hold from one instant to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// When the values begin to hold \[s\].
    pub time: f64,
    /// The setpoint, in the unit of the angle, then the values of the inputs.
    pub values: Vec<f64>,
}

/// When the last row ends \[s\], which is taken to hold as long as the longest before it. None for a single row.
pub fn end(rows: &[Row]) -> Option<f64> {
    let held = rows.windows(2).map(|w| w[1].time - w[0].time);
    Some(rows.last()?.time + held.reduce(f64::max)?)
}

/// Admissible setpoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleLimits {
    /// Lower limit \[rad\].
    pub lower: f64,
    /// Upper limit \[rad\].
    pub upper: f64,
}

impl AngleLimits {
    /// Whether an angle \[rad\] lies within them.
    pub fn contains(&self, angle: f64) -> bool {
        (self.lower..=self.upper).contains(&angle)
    }
}

impl Table {
    /// One setpoint for the whole run.
    pub fn constant(setpoint: f64) -> Self {
        Self {
            inputs: Vec::new(),
            rows: vec![Row {
                time: 0.0,
                values: vec![setpoint],
            }],
        }
    }

    /// Reads a file. `limits` bounds the setpoints, if it is known.
    pub fn read(path: &Path, pair: Pair<'_>, limits: Option<AngleLimits>) -> Result<Self, Error> {
        let text = read_text(path)?;
        let mut rows = Rows::new(&text, path.display().to_string())?;
        let mut table = Self::new(pair, &rows.head(), &rows.columns)?;
        while rows.read()? {
            let (place, columns) = (rows.place(), &rows.columns);
            let numbers = numbers(&place, columns, &rows.record)?;
            table.push(pair, &place, columns, &numbers, limits)?;
        }
        table.not_empty(&rows.head())
    }

    /// A table without rows, whose columns are `time`, `setpoint` and names of inputs.
    fn new(pair: Pair<'_>, place: &Place, columns: &[String]) -> Result<Self, Error> {
        if columns.len() < 2 || columns[0] != "time" || columns[1] != "setpoint" {
            return Err(Error::Header {
                place: place.clone(),
                expected: "time,setpoint and names of inputs",
                found: columns.join(","),
            });
        }
        let mut inputs = Vec::new();
        for name in &columns[2..] {
            let input = input(pair, place, name)?;
            if inputs.contains(&input) {
                return Err(Error::TwoSources {
                    place: place.clone(),
                    name: pair.name(input.0, input.1),
                });
            }
            inputs.push(input);
        }
        Ok(Self {
            inputs,
            rows: Vec::new(),
        })
    }

    fn not_empty(self, place: &Place) -> Result<Self, Error> {
        if self.rows.is_empty() {
            return Err(Error::NoRows {
                place: place.clone(),
            });
        }
        Ok(self)
    }

    fn push(
        &mut self,
        pair: Pair<'_>,
        place: &Place,
        columns: &[String],
        numbers: &[f64],
        limits: Option<AngleLimits>,
    ) -> Result<(), Error> {
        if numbers.len() != columns.len() {
            return Err(Error::Columns {
                place: place.clone(),
                found: numbers.len(),
                expected: columns.len(),
            });
        }
        for (number, column) in numbers.iter().zip(columns) {
            if !number.is_finite() {
                return Err(not_finite(place, column, &number.to_string()));
            }
        }
        let (time, values) = (numbers[0], &numbers[1..]);
        let previous = self.rows.last().map(|row| row.time);
        if previous.map_or(time != 0.0, |previous| time <= previous) {
            return Err(Error::Time {
                place: place.clone(),
                value: time,
                previous,
            });
        }
        let out_of_range = |name: &str, value: f64, range: String| Error::Range {
            place: place.clone(),
            name: name.to_owned(),
            value: value.to_string(),
            range,
        };
        if let Some(limits) = limits
            && !limits.contains(values[0])
        {
            let AngleLimits { lower, upper } = limits;
            let range = format!(
                "[{}, {}] rad, the limits of the angle",
                short(lower),
                short(upper)
            );
            return Err(out_of_range("setpoint", values[0], range));
        }
        for (&(side, scalar), &value) in self.inputs.iter().zip(&values[1..]) {
            let variable = pair.of(side).variable(scalar);
            if variable.min.is_some_and(|min| value < min)
                || variable.max.is_some_and(|max| value > max)
            {
                return Err(out_of_range(&variable.name, value, variable.range()));
            }
        }
        self.rows.push(Row {
            time,
            values: values.to_vec(),
        });
        Ok(())
    }

    /// How long the table lasts \[s\]: until the [`end`] of its rows.
    pub fn duration(&self) -> Option<f64> {
        end(&self.rows)
    }

    /// When the setpoint changes for the first time \[s\].
    pub fn first_change(&self) -> Option<f64> {
        let first = self.rows.first()?.values[0];
        self.rows
            .iter()
            .find(|row| row.values[0] != first)
            .map(|row| row.time)
    }
}

/// The numbers of a row; how many there are is checked with their meaning.
fn numbers(place: &Place, columns: &[String], record: &StringRecord) -> Result<Vec<f64>, Error> {
    let number = |(i, text): (usize, &str)| {
        let column = columns.get(i).map_or("a value", String::as_str);
        text.parse().map_err(|_| not_finite(place, column, text))
    };
    record.iter().enumerate().map(number).collect()
}

/// The input that a column drives.
fn input(pair: Pair<'_>, place: &Place, name: &str) -> Result<(Side, Scalar), Error> {
    if name.starts_with("controller.") || name.starts_with("plant.") {
        return pair.resolve(place, name, &[Causality::Input]);
    }
    let of = |side| {
        pair.scalar(place, side, name, &[Causality::Input])
            .map(|s| (side, s))
    };
    match (of(Side::Controller), of(Side::Plant)) {
        (Ok(_), Ok(_)) => Err(Error::Ambiguous {
            place: place.clone(),
            name: name.to_owned(),
        }),
        (Ok(found), Err(_)) | (Err(_), Ok(found)) => Ok(found),
        (
            Err(Error::Unknown {
                existing, similar, ..
            }),
            Err(Error::Unknown {
                existing: others,
                similar: more,
                ..
            }),
        ) => Err(Error::Unknown {
            place: place.clone(),
            owner: None,
            name: name.to_owned(),
            similar: similar.into_iter().chain(more).collect(),
            existing: existing.into_iter().chain(others).collect(),
        }),
        (Err(Error::Unknown { .. }), Err(error)) | (Err(error), Err(_)) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::contract;
    use super::*;
    use proptest::prelude::*;
    use std::fs;

    fn read(text: &str) -> Result<Table, String> {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let limits = AngleLimits {
            lower: 0.9,
            upper: 1.6,
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("S.csv");
        fs::write(&file, text).unwrap();
        let message = |e: Error| {
            e.to_string()
                .replace(&format!("{}/", folder.path().display()), "")
        };
        Table::read(&file, pair, Some(limits)).map_err(message)
    }

    #[test]
    fn rows_and_further_inputs_are_read() {
        let table =
            read("time, setpoint, disturbance_torque\n0,1.3,0\n0.5,1.3,30\n1.5,1.2,27\n").unwrap();
        assert_eq!(table.inputs.len(), 1);
        assert_eq!(
            table.rows[1],
            Row {
                time: 0.5,
                values: vec![1.3, 30.0]
            }
        );
        assert_eq!(table.duration(), Some(2.5));
        assert_eq!(table.first_change(), Some(1.5));
        let pulse = read("time,setpoint\n0,1\n0.5,1.1\n0.50001,1\n").unwrap();
        assert_eq!(pulse.duration(), Some(0.50001 + 0.5));
        let one = read("\u{feff}time,setpoint\r\n0,1.0\r\n").unwrap();
        assert_eq!((one.duration(), one.first_change()), (None, None));
    }

    #[test]
    fn mistakes_are_named() {
        for (text, message) in [
            (
                "",
                r#"S.csv:1: the header must be time,setpoint and names of inputs, not """#,
            ),
            (
                "t,setpoint\n",
                r#"S.csv:1: the header must be time,setpoint and names of inputs, not "t,setpoint""#,
            ),
            ("time,setpoint\n", "S.csv:1: no rows"),
            (
                "time,setpoint\n0,1\n1\n",
                "S.csv:3: 1 values, but the header names 2 columns",
            ),
            (
                "time,setpoint\n0,x\n",
                r#"S.csv:2: setpoint = "x": expected a finite number"#,
            ),
            (
                "time,setpoint\n0,\n",
                r#"S.csv:2: setpoint = "": expected a finite number"#,
            ),
            (
                "time,setpoint\n0,NaN\n",
                r#"S.csv:2: setpoint = "NaN": expected a finite number"#,
            ),
            (
                "time,setpoint\n0,inf\n",
                r#"S.csv:2: setpoint = "inf": expected a finite number"#,
            ),
            (
                "time,setpoint\n0.1,1\n",
                "S.csv:2: time = 0.1 s: the first row must hold at the start, time 0 s",
            ),
            (
                "time,setpoint\n0,1\n\n1,1\n1,1\n",
                "S.csv:5: time = 1 s does not come after 1 s: times must increase",
            ),
            (
                "time,setpoint\n0,1\n1,1.61\n",
                "S.csv:3: setpoint = 1.61: must be in [0.9, 1.6] rad, the limits of the angle",
            ),
            (
                "time,setpoint,torqe\n0,1,1\n",
                "S.csv:1: neither FMU has a variable torqe, did you mean torque?; there are: angle, setpoint, torque, disturbance_torque",
            ),
            (
                "time,setpoint,velocity\n0,1,1\n",
                "S.csv:1: plant.velocity is an output; possible here: torque, disturbance_torque",
            ),
            (
                "time,setpoint,plant.torque,torque\n0,1,1,1\n",
                "S.csv:1: plant.torque already has a source",
            ),
        ] {
            assert_eq!(read(text).unwrap_err(), message, "{text:?}");
        }
    }

    proptest! {
        /// No text makes the reader panic, and what it accepts keeps its promises.
        #[test]
        fn whatever_is_accepted_is_ordered_and_finite(rows in "(time,setpoint\n)?([0-9.,a-zN\n-]{0,40})") {
            if let Ok(table) = read(&rows) {
                prop_assert_eq!(table.rows[0].time, 0.0);
                prop_assert!(table.rows.windows(2).all(|w| w[0].time < w[1].time));
                prop_assert!(table.rows.iter().all(|r| (0.9..=1.6).contains(&r.values[0])));
            }
        }
    }
}
