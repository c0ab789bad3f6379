//! Complete parameter sets of units that are used together.
//!
//! Units that share a parameter (`arm.inertia` of plant and controller) must agree on its type,
//! unit, range and start value: one file then serves all of them.

use crate::ssv::{Parameter, ParameterSet, Value};
use crate::tree::{self, Causality, ModelDescription, Variable};
use crate::xml::f64_text;
use crate::{Diagnostic, Kind};

/// The start values of all parameters of the units, by name of first appearance.
///
/// Errors: parameters that two units declare differently.
pub fn start_values(
    units: &[ModelDescription],
    name: &str,
) -> Result<ParameterSet, Vec<Diagnostic>> {
    let mut set = ParameterSet {
        name: name.to_owned(),
        ..ParameterSet::default()
    };
    let mut diagnostics = Vec::new();
    let mut seen: Vec<(&ModelDescription, &Variable)> = Vec::new();
    for unit in units {
        for v in parameters(unit) {
            if let Some((other, first)) = seen.iter().find(|(_, s)| s.name == v.name) {
                if declaration(unit, v) != declaration(other, first) {
                    diagnostics.push(Diagnostic {
                        file: unit.file.clone(),
                        line: v.line,
                        message: format!(
                            "variable {}: declared differently in {}:{}",
                            v.name, other.file, first.line
                        ),
                    });
                }
                continue;
            }
            seen.push((unit, v));
            for (name, start) in v.element_names().zip(v.start.iter().flatten()) {
                set.parameters.push(Parameter {
                    name,
                    value: value(unit, v, *start),
                    unit: v.unit.clone(),
                    line: v.line,
                });
            }
            for u in unit
                .units
                .iter()
                .filter(|u| Some(&u.name) == v.unit.as_ref())
            {
                if !set.units.iter().any(|known| known.name == u.name) {
                    set.units.push(u.clone());
                }
            }
        }
    }
    if diagnostics.is_empty() {
        Ok(set)
    } else {
        Err(diagnostics)
    }
}

/// Replaces values of `set` by those of `changes`, read from `file`.
///
/// Errors: every change of an unknown parameter, of another type or unit, out of range or naming no
/// item of the enumeration.
pub fn change(
    set: &mut ParameterSet,
    units: &[ModelDescription],
    changes: &ParameterSet,
    file: &str,
) -> Result<(), Vec<Diagnostic>> {
    let mut diagnostics = Vec::new();
    for new in &changes.parameters {
        let old = set.parameters.iter_mut().find(|p| p.name == new.name);
        match (old, problem(units, new)) {
            (Some(old), None) => old.value = new.value.clone(),
            (_, message) => diagnostics.push(Diagnostic {
                file: file.to_owned(),
                line: new.line,
                message: format!(
                    "parameter {}: {}",
                    new.name,
                    message.unwrap_or_else(|| "not in the set".to_owned())
                ),
            }),
        }
    }
    if diagnostics.is_empty() {
        Ok(())
    } else {
        Err(diagnostics)
    }
}

fn parameters(unit: &ModelDescription) -> impl Iterator<Item = &Variable> {
    let is_parameter = |v: &&Variable| v.causality == Causality::Parameter;
    unit.variables.iter().filter(is_parameter)
}

/// What two units must have in common to share a parameter.
fn declaration<'a>(unit: &'a ModelDescription, v: &'a Variable) -> impl PartialEq + use<'a> {
    let items = unit.declared_type(v).map(|t| {
        let item = |i: &'a tree::Item| (&*i.name, i.value);
        t.items.iter().map(item).collect::<Vec<_>>()
    });
    let unit = unit.units.iter().find(|u| Some(&u.name) == v.unit.as_ref());
    let base = unit.and_then(|u| u.base.as_ref());
    (v.kind, &v.unit, base, v.min, v.max, &v.start, items)
}

/// A start value as the value of a parameter file; an enumeration by the name of its item.
fn value(unit: &ModelDescription, v: &Variable, start: tree::Value) -> Value {
    match start {
        tree::Value::Float64(value) => Value::Real(value),
        tree::Value::Int32(value) => Value::Integer(value.into()),
        tree::Value::UInt64(value) => Value::Integer(value.try_into().unwrap_or(i64::MAX)),
        tree::Value::Boolean(value) => Value::Boolean(value),
        tree::Value::Enumeration(value) => {
            let mut items = unit.declared_type(v).into_iter().flat_map(|t| &t.items);
            let name = items.find(|i| i.value == value).map(|i| i.name.clone());
            Value::Enumeration(name.unwrap_or_default())
        }
    }
}

/// What is wrong with a parameter, seen from the unit that declares it.
fn problem(units: &[ModelDescription], p: &Parameter) -> Option<String> {
    let declared = units
        .iter()
        .flat_map(|unit| parameters(unit).map(move |v| (unit, v)))
        .find(|(_, v)| v.element_names().any(|n| n == p.name));
    let Some((unit, v)) = declared else {
        return Some("no unit has such a parameter".to_owned());
    };
    let given = p.value.kind();
    let number = match (v.kind, &p.value) {
        (Kind::Float64, Value::Real(value)) => *value,
        (Kind::Int32, Value::Integer(value)) => *value as f64,
        (Kind::Boolean, Value::Boolean(_)) => return None,
        (Kind::Enumeration, Value::Enumeration(item)) => {
            let items: Vec<_> = unit
                .declared_type(v)
                .into_iter()
                .flat_map(|t| &t.items)
                .map(|i| i.name.as_str())
                .collect();
            let known = items.contains(&item.as_str());
            return (!known).then(|| format!("`{item}` is none of {}", items.join(", ")));
        }
        (kind, _) => return Some(format!("value is {given}, the variable is {kind}")),
    };
    if p.unit.is_some() && p.unit != v.unit {
        let own = v.unit.as_deref().unwrap_or("none");
        return Some(format!("unit is not the variable's, `{own}`"));
    }
    let below = v.min.is_some_and(|min| number < min);
    let above = v.max.is_some_and(|max| number > max);
    (below || above).then(|| {
        let bound = |b: Option<f64>| b.map_or("unbounded".to_owned(), f64_text);
        format!(
            "value {} is outside its range {} to {} {}",
            p.value,
            bound(v.min),
            bound(v.max),
            v.unit.as_deref().unwrap_or_default()
        )
        .trim_end()
        .to_owned()
    })
}
