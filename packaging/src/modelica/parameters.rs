//! `FlexArm.Parameters` and `FlexArm.Types`: a record for each group of parameters, one of all groups for each set that ships, and the enumerations.

use super::{Files, class};
use crate::parameters::lines;
use crate::workspace::Workspace;
use model_description::{Causality, ModelDescription, Value, Variable, ssv};

/// Sets that change something, each on top of another.
const SETS: [[&str; 3]; 2] = [
    ["pendulum", "Pendulum", "TFlex"],
    ["pendulum-model-error", "PendulumModelError", "Pendulum"],
];

/// The parameters of both units, of each the first declaration.
pub fn of<'a>(units: &[&'a ModelDescription]) -> Vec<(&'a ModelDescription, &'a Variable)> {
    let mut found: Vec<(&ModelDescription, &Variable)> = Vec::new();
    for unit in units {
        for variable in &unit.variables {
            let known = found.iter().any(|(_, v)| v.name == variable.name);
            if variable.causality == Causality::Parameter && !known {
                found.push((*unit, variable));
            }
        }
    }
    found
}

/// Adds both packages.
pub fn add(
    workspace: &Workspace,
    units: [&ModelDescription; 2],
    files: &mut Files,
) -> Result<(), String> {
    let parameters = of(&units);
    let mut groups: Vec<&str> = Vec::new();
    let mut all = String::new();
    for (unit, variable) in &parameters {
        match variable.name.split_once('.') {
            // The native plant has no noise.
            Some(("noise", _)) => {}
            Some((group, _)) if groups.contains(&group) => {}
            Some((group, _)) => {
                groups.push(group);
                let (record, name) = (class::class(group), class::component(group));
                all += &format!("  FlexArm.Parameters.{record} {name} \"{group}.*\";\n");
            }
            None => all += &class::declaration(unit, variable, "parameter ")?,
        }
    }
    let mut members = Vec::new();
    for group in groups {
        let mut body = String::new();
        for (unit, variable) in &parameters {
            let in_group = variable
                .name
                .split_once('.')
                .is_some_and(|(g, _)| g == group);
            if in_group {
                body += &class::declaration(unit, variable, "parameter ")?;
            }
        }
        let name = class::class(group);
        let comment = format!("Parameters {group}.* of the FMUs");
        let info = format!(
            "<p>Defaults are those of the T-flex. The FMUs know them as <code>{group}.*</code>.</p>"
        );
        class::add(
            files,
            "Parameters",
            ["record", &name, &comment, "Record"],
            &body,
            &info,
        );
        members.push(name);
    }
    members.sort();
    class::add(
        files,
        "Parameters",
        [
            "record",
            "TFlex",
            "T-flex arm and its controller: all defaults",
            "Record",
        ],
        &all,
        "<p>All parameters of arm and controller (eqs 14, 29, 31, 56, 57).</p>",
    );
    members.push("TFlex".to_owned());
    for [file, name, base] in SETS {
        let file = format!("modelDescription/parameters/{file}.ssv");
        let set = ssv::read(&workspace.read(&file)?, &file).map_err(lines)?;
        let modifiers = changes(&set, &parameters).map_err(|e| format!("{file}: {e}"))?;
        let body = format!("  extends {base}({modifiers});\n");
        let info = format!("<p>What differs from {base}.</p>");
        class::add(
            files,
            "Parameters",
            ["record", name, &set.description, "Record"],
            &body,
            &info,
        );
        members.push(name.to_owned());
    }
    class::package(
        files,
        "Parameters",
        [
            "Parameters of arm and controller, and the sets of the paper",
            "RecordsPackage",
            "<p>One record for each group of parameters, with the names, units, ranges and defaults of the FMUs. TFlex, Pendulum and PendulumModelError hold all groups.</p>",
        ],
        &members,
    );
    types(units, files);
    Ok(())
}

/// The modifiers that a set makes, grouped; elements of an array become one.
fn changes(
    set: &ssv::ParameterSet,
    parameters: &[(&ModelDescription, &Variable)],
) -> Result<String, String> {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for (unit, variable) in parameters {
        let values: Result<Vec<_>, String> = variable
            .element_names()
            .filter_map(|name| set.parameters.iter().find(|p| p.name == name))
            .map(|p| value(unit, variable, &p.value))
            .collect();
        let values = values?;
        if values.is_empty() {
            continue;
        }
        if values.len() != variable.length() as usize {
            return Err(format!("{}: only some elements are given", variable.name));
        }
        let value = match variable.dimension {
            Some(_) => format!("{{{}}}", values.join(", ")),
            None => values.concat(),
        };
        let (group, name) = variable
            .name
            .split_once('.')
            .unwrap_or(("", &variable.name));
        let modifier = format!("{} = {value}", class::component(name));
        match groups.iter_mut().find(|(g, _)| *g == group) {
            Some((_, members)) => members.push(modifier),
            None => groups.push((group, vec![modifier])),
        }
    }
    let groups: Vec<_> = groups
        .into_iter()
        .map(|(group, members)| match group {
            "" => members.join(", "),
            group => format!("\n    {}({})", class::component(group), members.join(", ")),
        })
        .collect();
    Ok(groups.join(","))
}

fn value(
    unit: &ModelDescription,
    variable: &Variable,
    value: &ssv::Value,
) -> Result<String, String> {
    match value {
        ssv::Value::Enumeration(item) => {
            let of = variable.declared_type.as_deref().unwrap_or_default();
            Ok(format!("FlexArm.Types.{of}.{}", class::component(item)))
        }
        ssv::Value::Real(value) => class::literal(unit, variable, Value::Float64(*value)),
        ssv::Value::Integer(value) => Ok(value.to_string()),
        ssv::Value::Boolean(value) => Ok(value.to_string()),
        other @ ssv::Value::String(_) => {
            Err(format!("{}: {other:?} is no value of it", variable.name))
        }
    }
}

fn types(units: [&ModelDescription; 2], files: &mut Files) {
    let mut members = Vec::new();
    for of in units.iter().flat_map(|unit| &unit.types) {
        let items: Vec<_> = of
            .items
            .iter()
            .map(|i| {
                format!(
                    "\n    {} {}",
                    class::component(&i.name),
                    class::string(&i.description)
                )
            })
            .collect();
        let rows = of.items.iter().map(|i| {
            let (name, text) = (class::html(&i.name), class::html(&i.description));
            format!("<li><code>{name}</code>: {text}</li>\n")
        });
        let text = format!(
            "within FlexArm.Types;\ntype {} = enumeration({}) {}\n  annotation (Documentation(info = \"<html>\n<ul>\n{}</ul>\n</html>\"));\n",
            of.name,
            items.join(","),
            class::string(&of.description),
            rows.collect::<String>(),
        );
        files.insert(format!("Types/{}.mo", of.name), text.into_bytes());
        members.push(of.name.clone());
    }
    members.sort();
    class::package(
        files,
        "Types",
        [
            "Enumerations of the controller",
            "TypesPackage",
            "<p>With the items of the FMU.</p>",
        ],
        &members,
    );
}
