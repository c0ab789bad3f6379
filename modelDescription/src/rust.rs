//! The Rust code of a unit's variables, made by its build script.
//!
//! For `use`, the crate that includes the code depends on `fmi-unit` and `serde`.

use crate::names::{camel_case, group_type, path};
use crate::tree::{Causality, EnumerationType, Kind, ModelDescription, Value, Variable};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Longest array for which serde implements its traits.
const SERDE_ARRAY: u32 = 32;

/// Whether an array is a `Vec`: its size may change, or it is too long for serde.
fn is_vec(v: &Variable) -> bool {
    v.sized_by().is_some() || v.length() > SERDE_ARRAY
}

/// A struct of the generated code: fields that are variables and fields that are groups.
#[derive(Default)]
struct Group<'a> {
    variables: Vec<(String, &'a Variable)>,
    groups: BTreeMap<String, Group<'a>>,
}

impl<'a> Group<'a> {
    fn insert(&mut self, path: &[String], variable: &'a Variable) {
        match path {
            [] => {}
            [field] => self.variables.push((field.clone(), variable)),
            [group, rest @ ..] => {
                self.groups
                    .entry(group.clone())
                    .or_default()
                    .insert(rest, variable);
            }
        }
    }
}

/// Generates `MODEL`, the struct `Variables` with its groups and start values, its implementation
/// of `fmi_unit::Variables`, and an enum for each enumeration type.
pub fn generate(description: &ModelDescription) -> String {
    let mut out = String::new();
    model(&mut out, description);
    for enumeration in &description.types {
        enumeration_type(&mut out, enumeration);
    }
    let mut root = Group::default();
    let mut stored = Vec::new();
    for variable in &description.variables {
        if variable.causality == Causality::Independent {
            continue;
        }
        let fields = path(&variable.name).unwrap_or_default();
        root.insert(&fields, variable);
        stored.push((variable, fields.join(".")));
    }
    let title = format!("The variables of {}.", description.name);
    structs(&mut out, &root, &mut Vec::new(), &title);
    access(&mut out, &stored);
    out
}

/// Appends a line to the code.
macro_rules! line {
    ($out:expr, $($format:tt)*) => {{
        // Writing to a String does not fail.
        let _ = writeln!($out, $($format)*);
    }};
}

fn model(out: &mut String, d: &ModelDescription) {
    line!(out, "/// What the model description declares.");
    line!(
        out,
        "pub static MODEL: ::fmi_unit::Model = ::fmi_unit::Model {{"
    );
    line!(out, "    name: {:?},", d.name);
    line!(out, "    token: {:?},", d.token);
    line!(out, "    variables: &[");
    for v in &d.variables {
        let (least, greatest) = range(d, v);
        let items: Vec<_> = d
            .declared_type(v)
            .into_iter()
            .flat_map(|t| &t.items)
            .map(|i| format!("({}, {:?})", i.value, i.name))
            .collect();
        line!(out, "        ::fmi_unit::Variable {{");
        line!(out, "            name: {:?},", v.name);
        line!(out, "            value_reference: {},", v.value_reference);
        let dimension = v.dimension.map(|d| {
            let (size, parameter) = (d.size, d.parameter);
            format!("::fmi_unit::Dimension {{ size: {size}, parameter: {parameter:?} }}")
        });
        let dimension = dimension.map_or("None".to_owned(), |d| format!("Some({d})"));
        line!(out, "            dimension: {dimension},");
        line!(out, "            kind: ::fmi_unit::Kind::{:?},", v.kind);
        line!(
            out,
            "            causality: ::fmi_unit::Causality::{:?},",
            v.causality
        );
        line!(
            out,
            "            variability: ::fmi_unit::Variability::{:?},",
            v.variability
        );
        line!(out, "            min: {},", number(least));
        line!(out, "            max: {},", number(greatest));
        line!(
            out,
            "            unit: {:?},",
            v.unit.as_deref().unwrap_or("")
        );
        line!(out, "            items: &[{}],", items.join(", "));
        line!(out, "        }},");
    }
    line!(out, "    ],");
    line!(
        out,
        "    states: &{:?},",
        d.states().map(|s| s.value_reference).collect::<Vec<_>>()
    );
    let derivatives: Vec<_> = d.derivatives.iter().map(|u| u.value_reference).collect();
    line!(out, "    derivatives: &{derivatives:?},");
    let indicators = d.event_indicators.iter().map(|u| u.value_reference);
    let indicators: Vec<_> = indicators.collect();
    line!(out, "    event_indicators: &{indicators:?},");
    line!(out, "    clocks: &[");
    for c in &d.clocks {
        line!(out, "        ::fmi_unit::Clock {{");
        line!(out, "            name: {:?},", c.name);
        line!(out, "            value_reference: {},", c.value_reference);
        line!(out, "        }},");
    }
    line!(out, "    ],");
    line!(out, "    model_exchange: {},", d.model_exchange.is_some());
    let event_mode = d.co_simulation.as_ref().is_some_and(|i| i.has_event_mode);
    line!(out, "    event_mode: {event_mode},");
    let scheduled = d.scheduled_execution.is_some();
    line!(out, "    scheduled_execution: {scheduled},");
    let derivatives = d.interfaces().any(|i| i.provides_directional_derivatives);
    line!(out, "    directional_derivatives: {derivatives},");
    let categories: Vec<_> = d.log_categories.iter().map(|c| &c.name).collect();
    line!(out, "    log_categories: &{categories:?},");
    line!(out, "}};");
}

/// Admissible range: what is declared, else what the type can hold.
fn range(d: &ModelDescription, v: &Variable) -> (f64, f64) {
    let values = d.declared_type(v).into_iter().flat_map(|t| &t.items);
    let values: Vec<_> = values.map(|i| i.value).collect();
    let (least, greatest) = match v.kind {
        Kind::Float64 => (f64::NEG_INFINITY, f64::INFINITY),
        Kind::Int32 => (i32::MIN.into(), i32::MAX.into()),
        Kind::UInt64 => (0.0, u64::MAX as f64),
        Kind::Boolean => (0.0, 1.0),
        Kind::Enumeration => (
            values.iter().min().copied().unwrap_or_default().into(),
            values.iter().max().copied().unwrap_or_default().into(),
        ),
    };
    (v.min.unwrap_or(least), v.max.unwrap_or(greatest))
}

fn enumeration_type(out: &mut String, t: &EnumerationType) {
    let variants: Vec<_> = t.items.iter().map(|i| camel_case(&i.name)).collect();
    line!(out, "\n/// {}.", markdown(&t.description));
    line!(out, "#[derive(Clone, Copy, Debug, PartialEq, Eq)]");
    line!(out, "#[repr(i64)]");
    line!(out, "pub enum {} {{", t.name);
    for (item, variant) in t.items.iter().zip(&variants) {
        line!(out, "    /// {}.", markdown(&item.description));
        line!(out, "    {variant} = {},", item.value);
    }
    line!(out, "}}\n");
    line!(out, "impl From<{}> for i64 {{", t.name);
    line!(
        out,
        "    fn from(item: {}) -> Self {{\n        item as Self\n    }}\n}}\n",
        t.name
    );
    line!(out, "/// The error is the value that is none of the items.");
    line!(out, "impl TryFrom<i64> for {} {{", t.name);
    line!(out, "    type Error = i64;\n");
    line!(
        out,
        "    fn try_from(value: i64) -> Result<Self, i64> {{\n        match value {{"
    );
    for (item, variant) in t.items.iter().zip(&variants) {
        line!(out, "            {} => Ok(Self::{variant}),", item.value);
    }
    line!(
        out,
        "            other => Err(other),\n        }}\n    }}\n}}"
    );
}

fn structs(out: &mut String, group: &Group, at: &mut Vec<String>, title: &str) {
    let name = group_type(at);
    line!(out, "\n/// {title}");
    line!(
        out,
        "#[derive(Debug, PartialEq, ::serde::Serialize, ::serde::Deserialize)]"
    );
    line!(out, "pub struct {name} {{");
    for (field, v) in &group.variables {
        let unit = v.unit.as_ref().map(|u| format!(" \\[{u}\\]"));
        line!(
            out,
            "    /// {}{}.",
            markdown(&v.description),
            unit.unwrap_or_default()
        );
        let scalar = match v.kind {
            Kind::Float64 => "f64",
            Kind::Int32 => "i32",
            Kind::UInt64 => "u64",
            Kind::Boolean => "bool",
            Kind::Enumeration => "i64",
        };
        match v.dimension {
            None => line!(out, "    pub {field}: {scalar},"),
            Some(_) if is_vec(v) => line!(out, "    pub {field}: Vec<{scalar}>,"),
            Some(d) => line!(out, "    pub {field}: [{scalar}; {}],", d.size),
        }
    }
    for field in group.groups.keys() {
        at.push(field.clone());
        line!(out, "    /// Variables `{}.*`.", at.join("."));
        line!(out, "    pub {field}: {},", group_type(at));
        at.pop();
    }
    line!(out, "}}\n");
    line!(out, "/// Start values.");
    line!(out, "impl Default for {name} {{");
    line!(
        out,
        "    #[allow(clippy::approx_constant, reason = \"start values are data\")]"
    );
    line!(out, "    fn default() -> Self {{\n        Self {{");
    for (field, v) in &group.variables {
        line!(out, "            {field}: {},", start(v));
    }
    for field in group.groups.keys() {
        at.push(field.clone());
        line!(out, "            {field}: {}::default(),", group_type(at));
        at.pop();
    }
    line!(out, "        }}\n    }}\n}}\n");
    clone(out, group, &name);
    for (field, inner) in &group.groups {
        at.push(field.clone());
        let title = format!("Variables `{}.*`.", at.join("."));
        structs(out, inner, at, &title);
        at.pop();
    }
}

/// `Clone`, where a derived `clone_from` would allocate vectors anew.
fn clone(out: &mut String, group: &Group, name: &str) {
    let variables = group.variables.iter();
    let variables = variables.map(|(field, v)| (field, !is_vec(v)));
    let fields: Vec<_> = variables
        .chain(group.groups.keys().map(|field| (field, false)))
        .collect();
    line!(out, "impl Clone for {name} {{");
    line!(out, "    fn clone(&self) -> Self {{\n        Self {{");
    for (field, is_copy) in &fields {
        let call = if *is_copy { "" } else { ".clone()" };
        line!(out, "            {field}: self.{field}{call},");
    }
    line!(out, "        }}\n    }}\n");
    line!(out, "    /// Without allocation where the sizes agree.");
    line!(out, "    fn clone_from(&mut self, source: &Self) {{");
    for (field, is_copy) in &fields {
        if *is_copy {
            line!(out, "        self.{field} = source.{field};");
        } else {
            line!(out, "        self.{field}.clone_from(&source.{field});");
        }
    }
    line!(out, "    }}\n}}");
}

/// A value as Rust code.
fn code(value: &Value) -> String {
    match value {
        Value::Float64(x) => number(*x),
        other => other.to_string(),
    }
}

/// What a variable without a start value starts with.
fn zero(v: &Variable) -> Value {
    match v.kind {
        Kind::Float64 => Value::Float64(0.0),
        Kind::Int32 => Value::Int32(0),
        Kind::UInt64 => Value::UInt64(0),
        Kind::Boolean => Value::Boolean(false),
        Kind::Enumeration => Value::Enumeration(0),
    }
}

/// The start values of a variable as Rust code; zero if it has none.
fn start(v: &Variable) -> String {
    let values: Vec<_> = v.start.iter().flatten().map(code).collect();
    let prefix = if is_vec(v) { "vec!" } else { "" };
    match (v.dimension, &values[..]) {
        (None, [value, ..]) => value.clone(),
        (None, []) => code(&zero(v)),
        (Some(d), [] | [_]) => format!("{prefix}[{}; {}]", fill(v), d.size),
        (Some(_), values) => format!("{prefix}[{}]", values.join(", ")),
    }
}

/// What new elements of an array begin with.
fn fill(v: &Variable) -> String {
    code(v.start.iter().flatten().next().unwrap_or(&zero(v)))
}

fn access(out: &mut String, stored: &[(&Variable, String)]) {
    line!(out, "\nimpl ::fmi_unit::Variables for Variables {{");
    line!(out, "    const MODEL: &'static ::fmi_unit::Model = &MODEL;");
    for (function, receiver, values, from_ref, borrow) in [
        ("values", "&self", "Values", "from_ref", "&"),
        ("values_mut", "&mut self", "ValuesMut", "from_mut", "&mut "),
    ] {
        line!(
            out,
            "\n    fn {function}({receiver}, value_reference: u32) -> Option<::fmi_unit::{values}<'_>> {{"
        );
        line!(out, "        Some(match value_reference {{");
        for (v, field) in stored {
            let slice = match v.dimension {
                None => format!("::std::slice::{from_ref}({borrow}self.{field})"),
                Some(_) => format!("{borrow}self.{field}"),
            };
            let (kind, reference) = (v.kind, v.value_reference);
            line!(
                out,
                "            {reference} => ::fmi_unit::{values}::{kind:?}({slice}),"
            );
        }
        line!(out, "            _ => return None,\n        }})\n    }}");
    }
    line!(out, "\n    fn resize(&mut self) {{");
    for (v, field) in stored {
        let sizes = |(s, _): &&(&Variable, String)| Some(s.value_reference) == v.sized_by();
        if let Some((_, size)) = stored.iter().find(sizes) {
            let fill = fill(v);
            line!(
                out,
                "        self.{field}.resize(self.{size} as usize, {fill});"
            );
        }
    }
    line!(out, "    }}");
    line!(out, "}}");
}

/// A floating-point literal.
fn number(value: f64) -> String {
    match value {
        f64::INFINITY => "f64::INFINITY".to_owned(),
        f64::NEG_INFINITY => "f64::NEG_INFINITY".to_owned(),
        value => format!("{value:?}"),
    }
}

/// Text in which rustdoc sees no markup.
fn markdown(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        if "\\`*[]<>".contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

#[cfg(test)]
mod tests;
