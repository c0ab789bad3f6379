//! Parameter values from SSV files and from single assignments.

use super::{Error, Pair, Place, Side, read_text, with_article};
use crate::fmu::{Causality, Description, NameError, Scalar, Value, similar};
use model_description::ssv::{self, ParameterSet};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// A parameter file for both FMUs or for one: `X.ssv`, `controller=X.ssv`, `plant=X.ssv`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterFile {
    /// None: each value goes to every FMU that has its name.
    pub side: Option<Side>,
    /// SSV file (SSP 1.0).
    pub path: PathBuf,
}

impl fmt::Display for ParameterFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.side.map_or(Ok(()), |side| write!(f, "{side}="))?;
        self.path.display().fmt(f)
    }
}

impl FromStr for ParameterFile {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (side, path) = match text.split_once('=') {
            Some(("controller", path)) => (Some(Side::Controller), path),
            Some(("plant", path)) => (Some(Side::Plant), path),
            _ => (None, text),
        };
        Ok(Self {
            side,
            path: path.into(),
        })
    }
}

/// A single value: `NAME=VALUE`, `controller:NAME=VALUE`, `plant:NAME=VALUE`. A point does for the colon, unless
/// the FMUs have a variable that is called so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// None: the value goes to every FMU that has the name.
    pub side: Option<Side>,
    /// Name of a scalar.
    pub name: String,
    /// A number, true, false, or the name of an enumeration's item.
    pub value: String,
    /// Where it is given.
    pub place: Place,
}

impl fmt::Display for Assignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.side.map_or(Ok(()), |side| write!(f, "{side}:"))?;
        write!(f, "{}={}", self.name, self.value)
    }
}

impl FromStr for Assignment {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Error::Form {
                option: text.to_owned(),
                expected: "[controller:|plant:]NAME=VALUE",
            });
        };
        let (side, name) = match name.split_once(':') {
            Some(("controller", name)) => (Some(Side::Controller), name),
            Some(("plant", name)) => (Some(Side::Plant), name),
            _ => (None, name),
        };
        Ok(Self {
            side,
            name: name.trim().to_owned(),
            value: value.trim().to_owned(),
            place: Place::new("--set", None),
        })
    }
}

/// Values that the user gave to the variables of both FMUs. The later one wins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartValues {
    controller: BTreeMap<Scalar, Value>,
    plant: BTreeMap<Scalar, Value>,
}

/// Parameter sets of files. Each file is read once: it may be a pipe.
#[derive(Debug)]
pub struct ParameterSets(Vec<(ParameterFile, ParameterSet)>);

impl ParameterSets {
    /// Reads all files in order.
    ///
    /// # Errors
    /// A file that cannot be read or is no parameter set, by line.
    pub fn read(files: &[ParameterFile]) -> Result<Self, Error> {
        let set = |file: &ParameterFile| {
            let text = read_text(&file.path)?;
            let set = ssv::read(&text, &file.path.display().to_string());
            Ok((file.clone(), set.map_err(Error::ParameterFile)?))
        };
        files.iter().map(set).collect::<Result<_, _>>().map(Self)
    }
}

impl StartValues {
    /// Takes all sets in order, then the assignments.
    ///
    /// # Errors
    /// Names that no FMU has or that cannot be set, and values that are not of their type or unit, by file and line.
    pub fn new(
        pair: Pair<'_>,
        sets: &ParameterSets,
        assignments: &[Assignment],
    ) -> Result<Self, Error> {
        Self::of_those(pair, sets, assignments, |_| true)
    }

    /// The values of structural parameters alone: elements of arrays have names only when the sizes are known.
    ///
    /// # Errors
    /// As those of [`Self::new`].
    pub fn structure(
        pair: Pair<'_>,
        sets: &ParameterSets,
        assignments: &[Assignment],
    ) -> Result<Self, Error> {
        Self::of_those(pair, sets, assignments, |name| {
            Side::BOTH.iter().any(|&side| {
                let description = pair.of(side);
                let bare = name.strip_prefix(&format!("{side}.")).unwrap_or(name);
                let scalar = [name, bare]
                    .into_iter()
                    .find_map(|n| description.scalar(n).ok());
                let causality = scalar.map(|scalar| description.variable(scalar).causality);
                causality == Some(Causality::StructuralParameter)
            })
        })
    }

    fn of_those(
        pair: Pair<'_>,
        sets: &ParameterSets,
        assignments: &[Assignment],
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Self, Error> {
        let mut values = Self::default();
        for (file, set) in &sets.0 {
            let name = file.path.display().to_string();
            for parameter in set.parameters.iter().filter(|p| wanted(&p.name)) {
                let place = Place::new(name.clone(), Some(parameter.line.into()));
                let text = parameter.value.to_string();
                let unit = parameter.unit.as_deref();
                values.give(pair, &place, file.side, &parameter.name, &text, unit)?;
            }
        }
        let mut errors = Vec::new();
        for a in assignments.iter().filter(|a| wanted(&a.name)) {
            if let Err(error) = values.give(pair, &a.place, a.side, &a.name, &a.value, None) {
                errors.push(error);
            }
        }
        Error::several(errors).map_or(Ok(values), Err)
    }

    /// Values for one FMU.
    pub fn of(&self, side: Side) -> Vec<(Scalar, Value)> {
        let values = match side {
            Side::Controller => &self.controller,
            Side::Plant => &self.plant,
        };
        values
            .iter()
            .map(|(scalar, value)| (*scalar, value.clone()))
            .collect()
    }

    /// The value that a numeric parameter will have: as given, or its start.
    pub fn number(&self, pair: Pair<'_>, side: Side, name: &str) -> Option<f64> {
        let description = pair.of(side);
        let scalar = description.scalar(name).ok()?;
        let given = match side {
            Side::Controller => self.controller.get(&scalar),
            Side::Plant => self.plant.get(&scalar),
        };
        let start = || description.variable(scalar).start_of(scalar.element);
        given.cloned().or_else(start)?.number()
    }

    fn give(
        &mut self,
        pair: Pair<'_>,
        place: &Place,
        side: Option<Side>,
        name: &str,
        text: &str,
        unit: Option<&str>,
    ) -> Result<(), Error> {
        let sides: &[Side] = match side {
            Some(Side::Controller) => &[Side::Controller],
            Some(Side::Plant) => &[Side::Plant],
            None => &Side::BOTH,
        };
        let mut given = false;
        let mut refusal = None;
        for &side in sides {
            let description = pair.of(side);
            match description.scalar(name) {
                Ok(scalar) if !description.variable(scalar).settable => {
                    let found = with_article(description.variable(scalar).causality);
                    refusal = Some(Error::Role {
                        place: place.clone(),
                        name: format!("{side}.{name}"),
                        found: format!("{found} that cannot be set"),
                        existing: Vec::new(),
                    });
                }
                Ok(scalar) => {
                    let value = checked(description, scalar, place, name, text, unit)?;
                    match side {
                        Side::Controller => self.controller.insert(scalar, value),
                        Side::Plant => self.plant.insert(scalar, value),
                    };
                    given = true;
                }
                Err(NameError::Array { first, last }) => {
                    return Err(Error::Array {
                        place: place.clone(),
                        name: name.to_owned(),
                        first,
                        last,
                    });
                }
                Err(NameError::Unknown { .. }) => {}
            }
        }
        if given {
            return Ok(());
        }
        if let Some(refusal) = refusal {
            return Err(refusal);
        }
        // Connections spell it `plant.NAME`; here that counts if no variable has that very name.
        if side.is_none() {
            for side in Side::BOTH {
                let bare = name.strip_prefix(&side.to_string());
                if let Some(bare) = bare.and_then(|rest| rest.strip_prefix('.')) {
                    return self.give(pair, place, Some(side), bare, text, unit);
                }
            }
        }
        let names = || {
            let variables = sides.iter().flat_map(|&s| &pair.of(s).variables);
            variables.filter(|v| v.settable).map(|v| v.name.as_str())
        };
        let mut existing: Vec<_> = names().map(str::to_owned).collect();
        existing.sort();
        existing.dedup();
        Err(Error::Unknown {
            place: place.clone(),
            owner: side,
            name: name.to_owned(),
            similar: similar(name, names()),
            existing,
        })
    }
}

/// The value, if the unit is the variable's, the text of its type and the number in its range.
pub(crate) fn checked(
    description: &Description,
    scalar: Scalar,
    place: &Place,
    name: &str,
    text: &str,
    unit: Option<&str>,
) -> Result<Value, Error> {
    let variable = description.variable(scalar);
    if let Some(unit) = unit
        && variable.unit.as_deref() != Some(unit)
    {
        return Err(Error::Unit {
            place: place.clone(),
            name: name.to_owned(),
            unit: unit.to_owned(),
            declared: variable.unit.clone(),
        });
    }
    let value = Value::parse(text, variable).map_err(|expected| Error::Value {
        place: place.clone(),
        name: name.to_owned(),
        value: text.to_owned(),
        expected,
    })?;
    if let Some(number) = value.number()
        && (variable.min.is_some_and(|min| number < min)
            || variable.max.is_some_and(|max| number > max))
    {
        return Err(Error::Range {
            place: place.clone(),
            name: name.to_owned(),
            value: text.to_owned(),
            range: variable.range(),
        });
    }
    Ok(value)
}

#[cfg(test)]
mod tests;
