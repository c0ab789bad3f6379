//! The tables of variables, by role and group.

use super::escape;
use model_description::{Causality, Clock, Kind, ModelDescription, Value, Variable};

/// All variables: inputs, outputs, parameters by group, local variables.
pub fn variables(d: &ModelDescription) -> String {
    let mut html = String::new();
    let of = |causality| d.variables.iter().filter(move |v| v.causality == causality);
    html += &table(d, "Inputs", of(Causality::Input));
    html += &table(d, "Outputs", of(Causality::Output));
    let mut groups: Vec<&str> = Vec::new();
    for variable in of(Causality::Parameter) {
        if !groups.contains(&group(variable)) {
            groups.push(group(variable));
        }
    }
    for name in groups {
        let title = match name {
            "" => "Parameters".to_owned(),
            name => format!("Parameters <code>{name}.*</code>"),
        };
        let members = of(Causality::Parameter).filter(|v| group(v) == name);
        html += &table(d, &title, members);
    }
    let title = "Structural parameters (FMI 3.0, set in Configuration Mode)";
    html += &table(d, title, of(Causality::StructuralParameter));
    html += &table(d, "Local variables", of(Causality::Local));
    html + &clocks(d)
}

/// The input clocks of FMI 3.0.
fn clocks(d: &ModelDescription) -> String {
    let row = |clock: &Clock| {
        let (name, text) = (escape(&clock.name), escape(&clock.description));
        format!(
            "<tr><td><code>{name}</code></td><td>s</td><td></td><td></td><td>{text}</td></tr>\n"
        )
    };
    let rows: String = d.clocks.iter().map(row).collect();
    framed("Clocks (FMI 3.0)", &rows)
}

/// What stands before the first dot of the name; empty if there is none.
fn group(v: &Variable) -> &str {
    v.name.split_once('.').map_or("", |(group, _)| group)
}

fn table<'a>(
    d: &ModelDescription,
    title: &str,
    variables: impl Iterator<Item = &'a Variable>,
) -> String {
    let rows: String = variables.map(|v| row(d, v)).collect();
    framed(title, &rows)
}

/// Rows with their title and head; nothing without rows.
fn framed(title: &str, rows: &str) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format!(
        "<h3>{title}</h3>\n<table class=\"variables\">\n<thead><tr><th>Name</th><th>Unit</th><th>Default</th><th>Range</th>\
         <th>Description</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn row(d: &ModelDescription, v: &Variable) -> String {
    let dimension = match (v.dimension, v.sized_by().and_then(|p| d.variable(p))) {
        (_, Some(size)) => format!("[{}]", size.name),
        (Some(dimension), None) => format!("[{}]", dimension.size),
        (None, None) => String::new(),
    };
    let start = v.start.iter().flatten().map(|value| match value {
        Value::Enumeration(item) => {
            let mut items = d.declared_type(v).into_iter().flat_map(|t| &t.items);
            let item = items.find(|i| i.value == *item);
            item.map(|i| escape(&i.name)).unwrap_or_default()
        }
        value => value.to_string().replace('-', "\u{2212}"),
    });
    let items: Vec<_> = d
        .declared_type(v)
        .into_iter()
        .flat_map(|t| &t.items)
        .map(|i| {
            let (value, name) = (i.value, escape(&i.name));
            format!("<br><code>{value} {name}</code> {}", escape(&i.description))
        })
        .collect();
    format!(
        "<tr><td><code>{}{dimension}</code></td><td>{}</td><td>{}</td><td>{}</td><td>{}{}</td></tr>\n",
        escape(&v.name),
        escape(v.unit.as_deref().unwrap_or(match v.kind {
            Kind::Int32 | Kind::UInt64 => "integer",
            Kind::Boolean => "boolean",
            _ => "",
        })),
        start.collect::<Vec<_>>().join(" "),
        range(v),
        escape(&v.description),
        items.concat(),
    )
}

fn range(v: &Variable) -> String {
    let number = |x: f64| {
        let text = Value::Float64(x).to_string();
        // Whole powers of ten read better in scientific notation.
        let text = if x.abs() >= 1e4 {
            format!("{x:e}")
        } else {
            text
        };
        text.replace('-', "\u{2212}")
    };
    match (v.min, v.max) {
        (Some(min), Some(max)) => format!("{} … {}", number(min), number(max)),
        (Some(min), None) => format!("≥ {}", number(min)),
        (None, Some(max)) => format!("≤ {}", number(max)),
        (None, None) => String::new(),
    }
}

/// The categories that the unit logs under.
pub fn log_categories(d: &ModelDescription) -> String {
    let rows = d.log_categories.iter().map(|c| {
        let (name, text) = (escape(&c.name), escape(&c.description));
        format!("<tr><td><code>{name}</code></td><td>{text}</td></tr>\n")
    });
    let rows: String = rows.collect();
    format!(
        "<table>\n<thead><tr><th>Category</th><th>What is logged</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>"
    )
}
