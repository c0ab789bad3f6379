//! Values of parameter sets on their way: renamed by mappings, converted and transformed.

use super::document::{Mapping, MappingEntry, Written};
use super::package::{mistake, syntax};
use super::transformation::{NamedUnit, Transformation, Unit};
use crate::Error;
use crate::fmu::{hint, similar};
use crate::input::{self, Place};
use model_description::ssv::{self, ParameterSet};
use model_description::xml::f64_text;

/// A value on its way to what it is for.
#[derive(Clone, Debug)]
pub(super) struct Given {
    pub name: String,
    pub text: String,
    unit: Option<NamedUnit>,
    pub place: Place,
    /// After the unit conversion, which may be suppressed.
    transformation: Option<Written>,
    suppress_unit_conversion: bool,
}

impl Given {
    /// A value without a unit, by its full name.
    pub fn plain(name: String, text: String, place: Place) -> Self {
        Self {
            name,
            text,
            unit: None,
            place,
            transformation: None,
            suppress_unit_conversion: false,
        }
    }

    /// The value in the unit of what it is for, transformed, as text that reads back exactly.
    pub fn text_in(&self, unit: Option<&NamedUnit>, title: &str) -> Result<String, Error> {
        let wrong = |why: String| syntax(self.place.clone(), format!("{title}: {why}"));
        let conversion = match (&self.unit, unit) {
            (Some(from), Some(to)) if !self.suppress_unit_conversion => {
                from.to(to).map_err(wrong)?
            }
            _ => Transformation::identity(),
        };
        let own = match &self.transformation {
            None => Transformation::identity(),
            Some(Written::Linear { factor, offset }) => Transformation::linear(*factor, *offset),
            Some(Written::Boolean(entries)) => {
                return look_up(entries, &self.text, |t| t.parse().ok()).map_err(wrong);
            }
            Some(Written::Integer(entries)) => {
                return look_up(entries, &self.text, |t| t.parse().ok()).map_err(wrong);
            }
            Some(Written::Enumeration(entries)) => {
                return look_up(entries, &self.text, |t| Some(t.to_owned())).map_err(wrong);
            }
        };
        let whole = conversion.then(&own);
        if whole.is_identity() {
            return Ok(self.text.clone());
        }
        let number: Option<f64> = self.text.trim().parse().ok();
        let Some(number) = number.and_then(|number| whole.apply(number)) else {
            return Err(wrong(format!(
                "{:?} is no number to be converted",
                self.text
            )));
        };
        Ok(f64_text(number))
    }
}

/// The values of a set, as they are in its file.
pub(super) fn given(set: &ParameterSet, file: &str, prefix: &str) -> Vec<Given> {
    let unit = |name: &String| {
        let declared = set.units.iter().find(|unit| unit.name == *name);
        NamedUnit {
            name: name.clone(),
            unit: declared.and_then(|unit| Unit::of_attributes(unit.base.as_ref()?)),
        }
    };
    let one = |parameter: &ssv::Parameter| {
        let place = Place::new(file, Some(parameter.line.into()));
        let name = format!("{prefix}{}", parameter.name);
        Given {
            unit: parameter.unit.as_ref().map(unit),
            ..Given::plain(name, parameter.value.to_string(), place)
        }
    };
    set.parameters.iter().map(one).collect()
}

/// What a mapping makes of values: those that it does not name are dropped (SSP 1.0 sec 7.1).
pub(super) fn mapped(
    all: &[Given],
    mapping: &Mapping,
    file: &str,
) -> Result<Vec<Given>, input::Error> {
    let one = |entry: &MappingEntry| {
        let source = all.iter().find(|given| given.name == entry.source);
        let given = source.ok_or_else(|| {
            let place = Place::new(file, Some(entry.line.into()));
            let names = all.iter().map(|given| given.name.as_str());
            let hint = hint(&similar(&entry.source, names));
            mistake(
                place,
                format!(
                    "mapping entry: no parameter is called {}{hint}",
                    entry.source
                ),
            )
        })?;
        Ok(Given {
            name: entry.target.clone(),
            transformation: entry.transformation.clone(),
            suppress_unit_conversion: entry.suppress_unit_conversion,
            ..given.clone()
        })
    };
    mapping.entries.iter().map(one).collect()
}

/// What a map has for a value.
fn look_up<T: PartialEq + std::fmt::Display>(
    entries: &[(T, T)],
    text: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<String, String> {
    let value = parse(text.trim());
    let entry = entries
        .iter()
        .find(|(from, _)| Some(from) == value.as_ref());
    entry
        .map(|(_, to)| to.to_string())
        .ok_or_else(|| format!("{text:?} is not in the mapping"))
}
