//! What can be wrong with what the user gives.

use super::{Place, Side};
use crate::fmu::hint;
use model_description::Diagnostic;
use std::collections::BTreeSet;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// A mistake in what the user gives.
#[derive(Debug)]
#[allow(missing_docs, reason = "the fields are what Display prints")]
pub enum Error {
    /// A file cannot be read.
    Read { file: PathBuf, source: io::Error },
    /// A file is not UTF-8.
    NotText { file: PathBuf },
    /// A file is not of its format.
    Syntax { place: Place, message: String },
    /// The value of a key cannot be meant.
    Key {
        place: Place,
        value: String,
        expected: String,
    },
    /// A parameter file is not of its format.
    ParameterFile(Vec<Diagnostic>),
    /// A name lacks the FMU it belongs to.
    Side { place: Place, name: String },
    /// No variable has the name.
    Unknown {
        place: Place,
        owner: Option<Side>,
        name: String,
        similar: Vec<String>,
        existing: Vec<String>,
    },
    /// No column of the recording has the name.
    Unrecorded {
        place: Place,
        name: String,
        similar: Vec<String>,
        existing: Vec<String>,
    },
    /// An array cannot be used as a whole.
    Array {
        place: Place,
        name: String,
        first: String,
        last: String,
    },
    /// The variable exists but cannot be used here.
    Role {
        place: Place,
        name: String,
        found: String,
        existing: Vec<String>,
    },
    /// Both FMUs have an input of this name.
    Ambiguous { place: Place, name: String },
    /// Two sources for one input.
    TwoSources { place: Place, name: String },
    /// Source and target belong to the same FMU.
    SameFmu {
        place: Place,
        from: String,
        to: String,
    },
    /// No connection is possible.
    NothingToConnect {
        controller: [Vec<String>; 2],
        plant: [Vec<String>; 2],
    },
    /// A value is not of the variable's type.
    Value {
        place: Place,
        name: String,
        value: String,
        expected: String,
    },
    /// A value is out of range.
    Range {
        place: Place,
        name: String,
        value: String,
        range: String,
    },
    /// A value is given in another unit than the variable's.
    Unit {
        place: Place,
        name: String,
        unit: String,
        declared: Option<String>,
    },
    /// An option is not of its form.
    Form {
        option: String,
        expected: &'static str,
    },
    /// The header of a setpoint file.
    Header {
        place: Place,
        expected: &'static str,
        found: String,
    },
    /// A row of a setpoint file has too few or too many values.
    Columns {
        place: Place,
        found: usize,
        expected: usize,
    },
    /// Times do not increase.
    Time {
        place: Place,
        value: f64,
        previous: Option<f64>,
    },
    /// Setpoints are given that have no meaning for the pair.
    Purposeless {
        file: String,
        missing: &'static str,
        swapped: bool,
    },
    /// Several mistakes of one kind.
    Several(Vec<Self>),
    /// A setpoint file without rows.
    NoRows { place: Place },
    /// A measurement lacks a column.
    Column {
        place: Place,
        expected: String,
        found: String,
    },
    /// Times that are not equally spaced.
    Spacing {
        place: Place,
        value: f64,
        previous: f64,
        period: f64,
    },
    /// Values that are finite but cannot be meant.
    Implausible { place: Place, message: String },
    /// A measurement does not identify the arm.
    Measurement {
        file: String,
        source: identification::Error,
    },
    /// A setting of the run is out of range.
    Setting {
        name: String,
        value: String,
        expected: String,
    },
}

impl Error {
    /// One mistake of several, each of them once: what runs have in common is wrong for all of them.
    pub(crate) fn several(mistakes: Vec<Self>) -> Option<Self> {
        let mut seen = BTreeSet::new();
        let each = mistakes.into_iter().flat_map(|mistake| match mistake {
            Self::Several(mistakes) => mistakes,
            one => vec![one],
        });
        let mut mistakes: Vec<_> = each
            .filter(|mistake| seen.insert(mistake.to_string()))
            .collect();
        match mistakes.len() {
            0 | 1 => mistakes.pop(),
            _ => Some(Self::Several(mistakes)),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read { file, source } => write!(f, "cannot read {}: {source}", file.display()),
            Self::NotText { file } => write!(f, "{} is not text in UTF-8", file.display()),
            Self::Syntax { place, message } => write!(f, "{place}: {message}"),
            Self::Key {
                place,
                value,
                expected,
            } => write!(f, "{place} = {value}: expected {expected}"),
            Self::ParameterFile(diagnostics) => {
                for (i, diagnostic) in diagnostics.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n  " };
                    write!(f, "{separator}{diagnostic}")?;
                }
                Ok(())
            }
            Self::Side { place, name } => write!(
                f,
                "{place}: {name:?} must say whose it is: controller.{name} or plant.{name}"
            ),
            Self::Unknown {
                place,
                owner,
                name,
                similar,
                existing,
            } => {
                match owner {
                    Some(side) => write!(f, "{place}: {side} has no variable {name}")?,
                    None => write!(f, "{place}: neither FMU has a variable {name}")?,
                }
                f.write_str(&hint(similar))?;
                list(f, "; there are: ", existing)
            }
            Self::Unrecorded {
                place,
                name,
                similar,
                existing,
            } => {
                write!(f, "{place}: no column {name} is recorded")?;
                f.write_str(&hint(similar))?;
                list(f, "; there are: ", existing)
            }
            Self::Array {
                place,
                name,
                first,
                last,
            } => write!(
                f,
                "{place}: {name} is an array: use its elements {first} to {last}"
            ),
            Self::Role {
                place,
                name,
                found,
                existing,
            } => {
                write!(f, "{place}: {name} is {found}")?;
                list(f, "; possible here: ", existing)
            }
            Self::Ambiguous { place, name } => write!(
                f,
                "{place}: both FMUs have {name}: write controller.{name} or plant.{name}"
            ),
            Self::TwoSources { place, name } => {
                write!(f, "{place}: {name} already has a source")
            }
            Self::SameFmu { place, from, to } => {
                write!(f, "{place}: {from} and {to} belong to the same FMU")
            }
            Self::NothingToConnect { controller, plant } => {
                write!(
                    f,
                    "no output of one FMU has the name of an input of the other; name the pairs in a file \
                     for --connections"
                )?;
                for (owner, [inputs, outputs]) in [("controller", controller), ("plant", plant)] {
                    list(f, &format!("\n  {owner} inputs: "), inputs)?;
                    list(f, &format!("\n  {owner} outputs: "), outputs)?;
                }
                Ok(())
            }
            Self::Value {
                place,
                name,
                value,
                expected,
            } => {
                write!(f, "{place}: {name} = {value:?}: expected {expected}")
            }
            Self::Range {
                place,
                name,
                value,
                range,
            } => {
                write!(f, "{place}: {name} = {value}: must be in {range}")
            }
            Self::Unit {
                place,
                name,
                unit,
                declared,
            } => {
                write!(f, "{place}: {name} is given in {unit}, but its unit is ")?;
                match declared {
                    Some(declared) => f.write_str(declared),
                    None => f.write_str("not declared"),
                }
            }
            Self::Form { option, expected } => {
                write!(f, "{option:?} is not of the form {expected}")
            }
            Self::Header {
                place,
                expected,
                found,
            } => {
                write!(f, "{place}: the header must be {expected}, not {found:?}")
            }
            Self::Columns {
                place,
                found,
                expected,
            } => {
                write!(
                    f,
                    "{place}: {found} values, but the header names {expected} columns"
                )
            }
            Self::Time {
                place,
                value,
                previous,
            } => match previous {
                Some(previous) => write!(
                    f,
                    "{place}: time = {value} s does not come after {previous} s: times must increase"
                ),
                None => write!(
                    f,
                    "{place}: time = {value} s: the first row must hold at the start, time 0 s"
                ),
            },
            Self::Purposeless {
                file,
                missing,
                swapped,
            } => {
                let hint = if *swapped {
                    "are controller and plant exchanged?"
                } else {
                    "name it in a file for --connections"
                };
                write!(f, "{file}: {missing}: {hint}")
            }
            Self::Several(errors) => {
                for (i, error) in errors.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n  " };
                    write!(f, "{separator}{error}")?;
                }
                Ok(())
            }
            Self::NoRows { place } => write!(f, "{place}: no rows"),
            Self::Column {
                place,
                expected,
                found,
            } => write!(f, "{place}: no column {expected}; there are: {found}"),
            Self::Spacing {
                place,
                value,
                previous,
                period,
            } => write!(
                f,
                "{place}: time = {value} s comes {:.3e} s after {previous} s: times must be multiples of the period, \
                 {period:.3e} s, apart",
                value - previous
            ),
            Self::Implausible { place, message } => write!(f, "{place}: {message}"),
            Self::Measurement { file, source } => write!(f, "{file}: {source}"),
            Self::Setting {
                name,
                value,
                expected,
            } => {
                write!(f, "{name} = {value}: expected {expected}")
            }
        }
    }
}

/// At most twenty names.
fn list(f: &mut fmt::Formatter<'_>, title: &str, names: &[String]) -> fmt::Result {
    if names.is_empty() {
        return Ok(());
    }
    write!(f, "{title}{}", names[..names.len().min(20)].join(", "))?;
    if names.len() > 20 {
        write!(f, ", … ({} in all)", names.len())?;
    }
    Ok(())
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Read { source, .. } => Some(source),
            Self::Measurement { source, .. } => Some(source),
            _ => None,
        }
    }
}
