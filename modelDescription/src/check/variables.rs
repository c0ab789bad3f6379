//! Rules for units, types and variables.

use crate::names::{group_type, is_camel_case, is_snake_case, path};
use crate::tree::{
    Causality, Initial, Interface, Kind, ModelDescription, Unit, Value, Variability, Variable,
};
use crate::xml::{Reader, f64_text};
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn check(d: &ModelDescription, r: &mut Reader) {
    for interface in d.interfaces() {
        if interface.model_identifier != d.name {
            let identifier = &interface.model_identifier;
            let name = &d.name;
            r.report(
                interface.line,
                format_args!("modelIdentifier `{identifier}` differs from modelName `{name}`"),
            );
        }
    }
    if d.model_exchange.is_none() && d.co_simulation.is_none() {
        r.report(1, "neither `ModelExchange` nor `CoSimulation` is offered");
    }
    derivatives(d, r);
    experiment(d, r);
    unique(r, "unit", d.units.iter().map(|u| (&*u.name, u.line)));
    let categories = d.log_categories.iter().map(|c| (&*c.name, c.line));
    unique(r, "log category", categories);
    for unit in &d.units {
        base_unit(unit, r);
    }
    types(d, r);
    unique(
        r,
        "variable",
        d.variables.iter().map(|v| (&*v.name, v.line)),
    );
    value_references(d, r);
    names(d, r);
    independent(d, r);
    for variable in &d.variables {
        for message in problems(d, variable) {
            r.report(
                variable.line,
                format_args!("variable {}: {message}", variable.name),
            );
        }
    }
}

/// A unit has both kinds of derivatives in every interface, or none.
fn derivatives(d: &ModelDescription, r: &mut Reader) {
    let flags = |i: &Interface| {
        [
            i.provides_directional_derivatives,
            i.provides_adjoint_derivatives,
        ]
    };
    let declared: Vec<_> = d.interfaces().flat_map(flags).collect();
    if let Some(last) = d.interfaces().last()
        && declared.iter().any(|flag| *flag != declared[0])
    {
        let message = "providesDirectionalDerivatives and providesAdjointDerivatives must be the same everywhere";
        r.report(last.line, message);
    }
}

fn experiment(d: &ModelDescription, r: &mut Reader) {
    let e = &d.experiment;
    if let (Some(start), Some(stop)) = (e.start_time, e.stop_time)
        && start >= stop
    {
        let (start, stop) = (f64_text(start), f64_text(stop));
        r.report(
            e.line,
            format_args!("DefaultExperiment: startTime {start} is not before stopTime {stop}"),
        );
    }
    for (name, value) in [("stepSize", e.step_size), ("tolerance", e.tolerance)] {
        if let Some(value) = value.filter(|v| *v <= 0.0) {
            let value = f64_text(value);
            r.report(
                e.line,
                format_args!("DefaultExperiment: {name} {value} is not positive"),
            );
        }
    }
}

/// Reports names that occur twice.
pub(super) fn unique<'a>(r: &mut Reader, what: &str, names: impl Iterator<Item = (&'a str, u32)>) {
    let mut seen = BTreeMap::new();
    for (name, line) in names {
        if let Some(first) = seen.insert(name, line) {
            r.report(
                line,
                format_args!("{what} {name}: name already used in line {first}"),
            );
        }
    }
}

fn base_unit(unit: &Unit, r: &mut Reader) {
    if unit.base.is_none() {
        r.report(unit.line, format_args!("unit {}: no `BaseUnit`", unit.name));
    }
}

fn types(d: &ModelDescription, r: &mut Reader) {
    unique(r, "type", d.types.iter().map(|t| (&*t.name, t.line)));
    let groups: BTreeSet<_> = d
        .variables
        .iter()
        .filter_map(|v| path(&v.name))
        .flat_map(|p| (0..p.len()).map(move |n| group_type(&p[..n])))
        .collect();
    for t in &d.types {
        let name = &t.name;
        if !is_camel_case(name) {
            r.report(
                t.line,
                format_args!("type {name}: name is not in camel case"),
            );
        }
        if groups.contains(name) {
            r.report(
                t.line,
                format_args!("type {name}: a group of variables has this name in Rust"),
            );
        }
        if t.items.is_empty() {
            r.report(t.line, format_args!("type {name}: no items"));
        }
        unique(r, "item", t.items.iter().map(|i| (&*i.name, i.line)));
        let mut values = BTreeMap::new();
        for item in &t.items {
            if let Some(first) = values.insert(item.value, &item.name) {
                let (other, value) = (&item.name, item.value);
                r.report(
                    item.line,
                    format_args!("item {other}: value {value} already belongs to `{first}`"),
                );
            }
            if !is_snake_case(&item.name) || item.name == "self" {
                r.report(
                    item.line,
                    format_args!("item {}: name is not in snake case", item.name),
                );
            }
        }
    }
}

/// FMI 3.0 wants exactly one independent variable.
fn independent(d: &ModelDescription, r: &mut Reader) {
    let mut independent = d
        .variables
        .iter()
        .filter(|v| v.causality == Causality::Independent);
    if independent.next().is_none() {
        r.report(1, "no independent variable is declared");
    }
    for v in independent {
        r.report(
            v.line,
            format_args!("variable {}: a second independent variable", v.name),
        );
    }
}

/// An array of n elements owns n consecutive value references.
fn value_references(d: &ModelDescription, r: &mut Reader) {
    let mut sorted: Vec<_> = d.variables.iter().collect();
    sorted.sort_by_key(|v| (v.value_reference, v.line));
    let end = |v: &Variable| u64::from(v.value_reference) + u64::from(v.length());
    let mut furthest: Option<&Variable> = None;
    for v in sorted {
        if let Some(other) = furthest.filter(|o| end(o) > u64::from(v.value_reference)) {
            r.report(
                v.line,
                format_args!(
                    "variable {}: value reference {} already belongs to {} (line {}), which owns {} to {}",
                    v.name,
                    v.value_reference,
                    other.name,
                    other.line,
                    other.value_reference,
                    end(other) - 1
                ),
            );
        }
        if end(v) > u64::from(u32::MAX) {
            let message = format_args!("variable {}: value references exceed 32 bits", v.name);
            r.report(v.line, message);
        }
        if furthest.is_none_or(|o| end(v) > end(o)) {
            furthest = Some(v);
        }
    }
}

/// Names must be what FMI importers and Rust can both have.
fn names(d: &ModelDescription, r: &mut Reader) {
    let mut fields: BTreeMap<Vec<String>, &str> = BTreeMap::new();
    let mut groups: BTreeMap<Vec<String>, &str> = BTreeMap::new();
    let mut types: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for v in &d.variables {
        let (name, line) = (&*v.name, v.line);
        if name == "time" {
            r.report(
                line,
                "variable time: importers keep this name for themselves",
            );
        }
        let Some(path) = path(name) else {
            r.report(
                line,
                format_args!(
                    "variable {name}: name is not dotted snake case (an array has a `Dimension`, not a subscript), \
                     or contains a Rust keyword"
                ),
            );
            continue;
        };
        for n in 1..path.len() {
            let group = path[..n].to_vec();
            let other = types
                .entry(group_type(&group))
                .or_insert_with(|| group.clone());
            if *other != group {
                let other = other.join(".");
                r.report(
                    line,
                    format_args!("variable {name}: its group and `{other}` have one name in Rust"),
                );
            }
            groups.entry(group).or_insert(name);
        }
        if let Some(other) = fields.insert(path, name)
            && other != name
        {
            r.report(
                line,
                format_args!("variable {name}: has the same name in Rust as {other}"),
            );
        }
    }
    for v in &d.variables {
        if let Some(inside) = path(&v.name).and_then(|p| groups.get(&p)) {
            let name = &v.name;
            r.report(
                v.line,
                format_args!("variable {name}: also the group of {inside}"),
            );
        }
    }
}

/// What is wrong with one variable by itself.
fn problems(d: &ModelDescription, v: &Variable) -> Vec<String> {
    let mut found = Vec::new();
    roles(v, &mut found);
    start(d, v, &mut found);
    if v.kind == Kind::Float64 {
        units(d, v, &mut found);
    }
    if v.kind == Kind::Enumeration {
        match &v.declared_type {
            None => found.push("missing attribute `declaredType`".to_owned()),
            Some(name) if d.declared_type(v).is_none() => {
                found.push(format!("unknown declaredType `{name}`"));
            }
            Some(_) => {}
        }
    }
    if let (Some(min), Some(max)) = (v.min, v.max)
        && min > max
    {
        found.push(format!(
            "min {} exceeds max {}",
            f64_text(min),
            f64_text(max)
        ));
    }
    if let Some(nominal) = v.nominal.filter(|n| *n <= 0.0) {
        found.push(format!("nominal {} is not positive", f64_text(nominal)));
    }
    found
}

/// Combinations of causality, variability and initial (FMI 3.0 sec 2.4.7.4 and 2.4.7.5).
fn roles(v: &Variable, found: &mut Vec<String>) {
    use {Causality as C, Initial as I, Variability as V};
    let (causality, variability) = (v.causality, v.variability);
    let legal = match causality {
        C::Parameter | C::StructuralParameter | C::CalculatedParameter => {
            matches!(variability, V::Fixed | V::Tunable)
        }
        C::Input => matches!(variability, V::Discrete | V::Continuous),
        C::Output => matches!(variability, V::Constant | V::Discrete | V::Continuous),
        C::Local => true,
        C::Independent => variability == V::Continuous,
    };
    if !legal {
        found.push(format!(
            "a variable of causality {causality} cannot be {variability}"
        ));
        return;
    }
    if variability == V::Continuous && v.kind != Kind::Float64 {
        found.push(format!(
            "a variable of type {} cannot be continuous",
            v.kind
        ));
    }
    if causality == C::Independent && v.kind != Kind::Float64 {
        found.push("the independent variable must be a Float64".to_owned());
    }
    let admitted: &[I] = match (causality, variability) {
        (C::Input | C::Independent, _) => &[],
        (C::Parameter | C::StructuralParameter, _) | (_, V::Constant) => &[I::Exact],
        (C::CalculatedParameter, _) | (C::Local, V::Fixed | V::Tunable) => {
            &[I::Calculated, I::Approx]
        }
        _ => &[I::Calculated, I::Approx, I::Exact],
    };
    match v.initial {
        Some(initial) if !admitted.contains(&initial) => found.push(format!(
            "a variable of causality {causality} that is {variability} cannot have initial {initial}"
        )),
        _ => {}
    }
}

/// Presence, number and range of the start values.
fn start(d: &ModelDescription, v: &Variable, found: &mut Vec<String>) {
    let needed = v.causality == Causality::Input
        || matches!(v.initial, Some(Initial::Exact | Initial::Approx));
    let Some(values) = &v.start else {
        if needed {
            found.push("missing attribute `start`".to_owned());
        }
        return;
    };
    if !needed {
        let why = match v.initial {
            Some(initial) => format!("initial {initial}"),
            None => format!("causality {}", v.causality),
        };
        found.push(format!("start is forbidden with {why}"));
    }
    let wanted = if v.sized_by().is_some() {
        1
    } else {
        v.length()
    };
    if values.len() != wanted as usize {
        let given = values.len();
        found.push(match v.sized_by() {
            None => format!("{given} start values for {wanted} elements"),
            Some(_) => {
                format!("{given} start values: one for all elements, whose number may change")
            }
        });
    }
    for value in values {
        let number = value.number();
        if v.min.is_some_and(|min| number < min) || v.max.is_some_and(|max| number > max) {
            let bound = |b: Option<f64>| b.map_or("unbounded".to_owned(), f64_text);
            let (min, max) = (bound(v.min), bound(v.max));
            found.push(format!("start {value} is outside its range {min} to {max}"));
        }
        if let (Value::Enumeration(item), Some(t)) = (value, d.declared_type(v))
            && !t.items.iter().any(|i| i.value == *item)
        {
            found.push(format!("start {item} is no item of {}", t.name));
        }
    }
}

fn units(d: &ModelDescription, v: &Variable, found: &mut Vec<String>) {
    let Some(name) = &v.unit else {
        found.push("missing attribute `unit`".to_owned());
        return;
    };
    let Some(unit) = d.units.iter().find(|u| u.name == *name) else {
        found.push(format!("unknown unit `{name}`"));
        return;
    };
    if let Some(display) = &v.display_unit
        && !unit.display_units.iter().any(|u| u.name == *display)
    {
        found.push(format!("unknown display unit `{display}` of `{name}`"));
    }
}
