//! Names, literals and whole classes of Modelica.

use super::Files;
use model_description::{Kind, ModelDescription, Value, Variable};

/// Names in the contracts that Modelica takes for itself.
const TAKEN: [&str; 3] = ["initial", "model", "terminal"];

/// The name of a component: that of the contract, with an underscore where Modelica takes it for itself.
pub fn component(name: &str) -> String {
    if TAKEN.contains(&name) {
        format!("{name}_")
    } else {
        name.to_owned()
    }
}

/// The path of a variable of the contract, every part of it a component.
pub fn path(name: &str) -> String {
    name.split('.').map(component).collect::<Vec<_>>().join(".")
}

/// The name of a class for a group of the contract.
pub fn class(group: &str) -> String {
    let mut letters = group.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// A string literal.
pub fn string(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Text for the HTML of a documentation annotation.
pub fn html(text: &str) -> String {
    let text = text
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    text.replace('\\', "\\\\").replace('"', "&quot;")
}

/// A unit in Modelica's syntax, where a bracket has no exponent: `rad2/(N.m)2` is `rad2/(N2.m2)`.
pub fn unit(name: &str) -> String {
    let Some((numerator, (factors, exponent))) = name
        .split_once("/(")
        .and_then(|(numerator, rest)| Some((numerator, rest.split_once(')')?)))
    else {
        return name.to_owned();
    };
    let factors: Vec<_> = factors
        .split('.')
        .map(|factor| format!("{factor}{exponent}"))
        .collect();
    format!("{numerator}/({})", factors.join("."))
}

/// A number; large ones with an exponent, for they would overflow an integer.
fn real(value: f64) -> String {
    if value.abs() >= 1e6 {
        format!("{value:e}")
    } else {
        Value::Float64(value).to_string()
    }
}

/// A value as an expression.
pub fn literal(
    description: &ModelDescription,
    variable: &Variable,
    value: Value,
) -> Result<String, String> {
    let Value::Enumeration(number) = value else {
        return Ok(match value {
            Value::Float64(value) => real(value),
            value => value.to_string(),
        });
    };
    let name = &variable.name;
    let of = description.declared_type(variable);
    let of = of.ok_or_else(|| format!("{name}: no enumeration type"))?;
    let item = of.items.iter().find(|item| item.value == number);
    let item = item.ok_or_else(|| format!("{name}: {} has no item {number}", of.name))?;
    Ok(format!(
        "FlexArm.Types.{}.{}",
        of.name,
        component(&item.name)
    ))
}

/// A component: type, dimension, modifiers, default and description of a variable.
pub fn declaration(
    description: &ModelDescription,
    variable: &Variable,
    prefix: &str,
) -> Result<String, String> {
    let kind = match (variable.kind, &variable.declared_type) {
        (Kind::Enumeration, Some(name)) => format!("FlexArm.Types.{name}"),
        (Kind::Int32 | Kind::UInt64, _) => "Integer".to_owned(),
        (Kind::Boolean, _) => "Boolean".to_owned(),
        _ => "Real".to_owned(),
    };
    let each = if variable.dimension.is_some() {
        "each "
    } else {
        ""
    };
    let mut modifiers = Vec::new();
    if let Some(name) = &variable.unit {
        modifiers.push(format!("{each}unit = {}", string(&unit(name))));
    }
    for (bound, value) in [("min", variable.min), ("max", variable.max)] {
        if let Some(value) = value {
            let value = match variable.kind {
                Kind::Int32 | Kind::UInt64 => format!("{value:.0}"),
                _ => real(value),
            };
            modifiers.push(format!("{each}{bound} = {value}"));
        }
    }
    let modifiers = if modifiers.is_empty() {
        String::new()
    } else {
        format!("({})", modifiers.join(", "))
    };
    let start: Result<Vec<_>, _> = variable
        .start
        .iter()
        .flatten()
        .map(|value| literal(description, variable, *value))
        .collect();
    let start = start?.join(", ");
    let default = match variable.dimension {
        _ if start.is_empty() => String::new(),
        Some(_) => format!(" = {{{start}}}"),
        None => format!(" = {start}"),
    };
    let dimension = variable
        .dimension
        .map_or_else(String::new, |d| format!("[{}]", d.size));
    let last = variable.name.rsplit('.').next().unwrap_or_default();
    Ok(format!(
        "  {prefix}{kind} {}{dimension}{modifiers}{default} {};\n",
        component(last),
        string(&variable.description)
    ))
}

/// Adds a class in a file of its own. `kind` is its restriction, `body` what stands between its icon and its documentation.
pub fn add(
    files: &mut Files,
    package: &str,
    [kind, name, comment, icon]: [&str; 4],
    body: &str,
    info: &str,
) {
    let within = package.replace('/', ".");
    let text = format!(
        "within FlexArm.{within};\n{kind} {name} {}\n  extends Modelica.Icons.{icon};\n{body}\n  annotation (Documentation(info = \"<html>\n\
         {info}\n</html>\"));\nend {name};\n",
        string(comment)
    );
    files.insert(format!("{package}/{name}.mo"), text.into_bytes());
}

/// Adds the `package.mo` and `package.order` of a package of generated classes.
pub fn package(
    files: &mut Files,
    name: &str,
    [comment, icon, info]: [&str; 3],
    members: &[String],
) {
    let text = format!(
        "within FlexArm;\npackage {name} {}\n  extends Modelica.Icons.{icon};\n\n  annotation (Documentation(info = \"<html>\n{info}\n</html>\"));\nend {name};\n",
        string(comment)
    );
    files.insert(format!("{name}/package.mo"), text.into_bytes());
    let order: String = members.iter().map(|m| format!("{m}\n")).collect();
    files.insert(format!("{name}/package.order"), order.into_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_no_exponent_on_brackets() {
        assert_eq!(unit("rad2/(N.m)2"), "rad2/(N2.m2)");
        assert_eq!(unit("N.m/(rad.s)"), "N.m/(rad.s)");
        assert_eq!(unit("N.m.s/rad"), "N.m.s/rad");
    }

    #[test]
    fn names_that_modelica_takes_end_in_an_underscore() {
        assert_eq!(path("nmpc.model"), "nmpc.model_");
        assert_eq!(path("initial.angle"), "initial_.angle");
        assert_eq!(path("arm.inertia"), "arm.inertia");
    }
}
