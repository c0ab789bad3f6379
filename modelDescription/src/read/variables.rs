//! The children of `ModelVariables`.

use crate::check;
use crate::tree::{Causality, Clock, Dimension, Initial, Kind, Value, Variability, Variable};
use crate::xml::{Reader, parse_f64};
use roxmltree::Node;
use std::collections::BTreeMap;

pub(super) fn variable_or_clock<'a>(
    r: &mut Reader<'a>,
    node: Node<'a, 'a>,
) -> (Option<Variable>, Option<Clock>) {
    if node.has_tag_name("Clock") {
        (None, clock(r, node))
    } else {
        (variable(r, node), None)
    }
}

/// A clock; None if it has no value reference.
fn clock<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Clock> {
    r.know_attributes(
        node,
        &[
            "name",
            "valueReference",
            "causality",
            "variability",
            "description",
            "intervalVariability",
            "priority",
        ],
    );
    r.children(node, &[]);
    for (attribute, value) in [
        ("causality", "input"),
        ("variability", "discrete"),
        ("intervalVariability", "fixed"),
    ] {
        if node.attribute(attribute) != Some(value) {
            r.problem(
                node,
                format_args!("a clock must have {attribute}=\"{value}\""),
            );
        }
    }
    r.required(node, "priority");
    r.parsed(node, "priority", "a number from 0", |t| {
        t.parse::<u32>().ok()
    });
    r.required(node, "valueReference");
    Some(Clock {
        name: r.required(node, "name"),
        description: r.required(node, "description"),
        line: r.line(node),
        value_reference: r.reference(node, "valueReference")?,
    })
}

/// A variable; None if it has no value reference and can therefore not be checked further.
fn variable<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Variable> {
    let kind = Kind::from_name(node.tag_name().name())?;
    let mut known = vec![
        "name",
        "valueReference",
        "causality",
        "variability",
        "initial",
        "description",
        "start",
        "intermediateUpdate",
    ];
    known.extend_from_slice(match kind {
        Kind::Float64 => &["unit", "displayUnit", "min", "max", "nominal", "derivative"],
        Kind::Int32 | Kind::UInt64 => &["min", "max"],
        Kind::Boolean => &[],
        Kind::Enumeration => &["declaredType"],
    });
    r.know_attributes(node, &known);
    let name = r.required(node, "name");
    let description = r.required(node, "description");
    r.required(node, "valueReference");
    let of = |names: &[&str]| format!("one of {}", names.join(", "));
    let causality = r
        .parsed(
            node,
            "causality",
            of(Causality::NAMES),
            Causality::from_name,
        )
        .unwrap_or(Causality::Local);
    let variability = r
        .parsed(
            node,
            "variability",
            of(Variability::NAMES),
            Variability::from_name,
        )
        .unwrap_or(match kind {
            Kind::Float64 => Variability::Continuous,
            _ => Variability::Discrete,
        });
    let initial = r.parsed(node, "initial", of(Initial::NAMES), Initial::from_name);
    let what = match kind {
        Kind::Float64 => "a finite number",
        Kind::Int32 => "a 32-bit integer",
        Kind::UInt64 => "an integer from 0",
        Kind::Boolean => "true or false",
        Kind::Enumeration => "an integer",
    };
    let start = r.list(node, "start", what, |t| Value::parse(kind, t));
    let limit = |text: &str| match kind {
        Kind::Int32 => text.parse::<i32>().ok().map(f64::from),
        Kind::UInt64 => text.parse::<u64>().ok().map(|n| n as f64),
        _ => parse_f64(text),
    };
    Some(Variable {
        kind,
        causality,
        variability,
        initial: initial.or(check::default_initial(causality, variability)),
        declared_type: node.attribute("declaredType").map(str::to_owned),
        unit: node.attribute("unit").map(str::to_owned),
        display_unit: node.attribute("displayUnit").map(str::to_owned),
        min: r.parsed(node, "min", what, limit),
        max: r.parsed(node, "max", what, limit),
        nominal: r.number(node, "nominal"),
        start,
        dimension: dimension(r, node),
        derivative: r.reference(node, "derivative"),
        line: r.line(node),
        value_reference: r.reference(node, "valueReference")?,
        name,
        description,
    })
}

/// The size of an array. That of one which follows a structural parameter is filled in by [`resolve`].
fn dimension<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Dimension> {
    let dimensions = r.children(node, &["Dimension"]);
    if dimensions.len() > 1 {
        r.problem(node, "more than one dimension");
    }
    let dimension = *dimensions.first()?;
    r.know_attributes(dimension, &["start", "valueReference"]);
    r.children(dimension, &[]);
    let has = |attribute| dimension.attribute(attribute).is_some();
    if has("start") == has("valueReference") {
        r.problem(dimension, "either `start` or `valueReference`");
    }
    let parameter = r.reference(dimension, "valueReference");
    let size = r.parsed(dimension, "start", "a positive number of elements", |t| {
        t.parse().ok().filter(|n| *n > 0)
    });
    (size.is_some() || parameter.is_some()).then(|| Dimension {
        size: size.unwrap_or(1),
        parameter,
    })
}

/// Gives each array the size that its structural parameter has at the start.
pub(super) fn resolve(variables: &mut [Variable]) {
    let starts: BTreeMap<_, _> = variables
        .iter()
        .filter_map(|v| match v.start.as_deref() {
            Some([Value::UInt64(start)]) => Some((v.value_reference, u32::try_from(*start).ok()?)),
            _ => None,
        })
        .collect();
    let dimensions = variables.iter_mut().filter_map(|v| v.dimension.as_mut());
    for dimension in dimensions {
        let start = dimension.parameter.and_then(|p| starts.get(&p));
        // What is no size is reported by the checks.
        dimension.size = start.copied().unwrap_or(dimension.size).max(1);
    }
}
