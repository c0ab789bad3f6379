//! `FlexArm.Internal.Contract`: what crosses the C interface of the controller's binary, and in which order.

use super::{Files, class, parameters};
use model_description::{Causality, EnumerationType, Kind, ModelDescription, Variable};

/// The setters and getters of FMI 2.0: enumerations are integers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Register {
    Real,
    Integer,
    Boolean,
}

const REGISTERS: [(Register, &str, &str); 3] = [
    (Register::Real, "real", "Real"),
    (Register::Integer, "integer", "Integer"),
    (Register::Boolean, "boolean", "Boolean"),
];

fn register(variable: &Variable) -> Register {
    match variable.kind {
        Kind::Float64 => Register::Real,
        Kind::Int32 | Kind::UInt64 | Kind::Enumeration => Register::Integer,
        Kind::Boolean => Register::Boolean,
    }
}

/// Adds the package, and the record of outputs that its sample gives.
pub fn add(controller: &ModelDescription, files: &mut Files) -> Result<(), String> {
    let inputs: Vec<_> = of(controller, Causality::Input).collect();
    // Arrays are the planned trajectory, which the block leaves out.
    let outputs: Vec<_> = of(controller, Causality::Output)
        .filter(|v| v.dimension.is_none())
        .collect();
    let mut constants = format!(
        "  constant String token = {} \"What the binary must be made from\";\n",
        class::string(&controller.token)
    );
    constants += &references("inputs", &inputs);
    let mut functions = String::new();
    let mut results = String::new();
    let mut record = String::new();
    for (of_register, name, kind) in REGISTERS {
        let given: Vec<_> = parameters::of(&[controller])
            .into_iter()
            .map(|(_, v)| v)
            .filter(|v| register(v) == of_register)
            .collect();
        constants += &references(&format!("{name}Parameters"), &given);
        functions += &values(name, kind, &given);
        let taken: Vec<_> = outputs
            .iter()
            .copied()
            .filter(|v| register(v) == of_register)
            .collect();
        if of_register != Register::Boolean {
            constants += &references(&format!("{name}Outputs"), &taken);
        } else if !taken.is_empty() {
            return Err(format!(
                "{}: Boolean outputs have no way into Modelica",
                controller.file
            ));
        }
        for (i, variable) in taken.iter().enumerate() {
            let field = variable.name.replace('.', "_");
            let number = i + 1;
            results += &match controller.declared_type(variable) {
                // Enumerations of Modelica count from one.
                Some(of) => {
                    let first = of.items.first().map_or(1, |item| item.value);
                    let (items, shift) = (items(of), 1 - first);
                    constants += &items;
                    format!(
                        "    outputs.{field} := all{}[integers[{number}] + {shift}];\n",
                        of.name
                    )
                }
                None => format!("    outputs.{field} := {name}s[{number}];\n"),
            };
            let mut flat = (*variable).clone();
            flat.name = field;
            record += &class::declaration(controller, &flat, "")?;
        }
    }
    class::add(
        files,
        "Internal",
        ["record", "Outputs", "Outputs of the controller", "Record"],
        &record,
        "<p>Outputs of the FMU but the planned trajectory; dots of their names are underscores.</p>",
    );
    let body = format!(
        "{constants}{functions}
  impure function sample \"One sample of the controller\"
    extends Modelica.Icons.Function;
    input FlexArm.Internal.Instance instance \"The controller\";
    input Real now(unit = \"s\") \"Time\";
    input Real angle(unit = \"rad\") \"Measured angle\";
    input Real setpoint(unit = \"rad\") \"Setpoint\";
    output FlexArm.Internal.Outputs outputs \"Outputs, which hold until the next sample\";
  protected
    Real reals[size(realOutputs, 1)];
    Integer integers[size(integerOutputs, 1)];
  algorithm
    (reals, integers) := FlexArm.Internal.exchange(instance, now, {{angle, setpoint}}, size(realOutputs, 1), size(integerOutputs, 1));
{results}    annotation (Documentation(info = \"<html><p>Gives the inputs and names what comes back.</p></html>\"));
  end sample;
"
    );
    class::add(
        files,
        "Internal",
        [
            "package",
            "Contract",
            "What crosses the C interface, and in which order",
            "InternalPackage",
        ],
        &body,
        "<p>Value references of the controller's FMI 2.0 description.</p>",
    );
    let order = "Instance\nexchange\nOutputs\nContract\n";
    files.insert("Internal/package.order".to_owned(), order.into());
    Ok(())
}

fn of(unit: &ModelDescription, causality: Causality) -> impl Iterator<Item = &Variable> {
    unit.variables
        .iter()
        .filter(move |v| v.causality == causality)
}

/// A constant with all items of an enumeration, in their order.
fn items(of: &EnumerationType) -> String {
    let items: Vec<_> = of
        .items
        .iter()
        .map(|item| format!("FlexArm.Types.{}.{}", of.name, class::component(&item.name)))
        .collect();
    format!(
        "  constant FlexArm.Types.{0} all{0}[{1}] = {{{2}}} \"Items by their values\";\n",
        of.name,
        items.len(),
        items.join(", ")
    )
}

/// A constant with all value references; an array of n elements has n.
fn references(name: &str, variables: &[&Variable]) -> String {
    let references: Vec<_> = variables
        .iter()
        .flat_map(|v| v.value_reference..v.value_reference + v.length())
        .map(|reference| reference.to_string())
        .collect();
    format!(
        "  constant Integer {name}[{}] = {{{}}} \"Value references\";\n",
        references.len(),
        references.join(", ")
    )
}

/// A function that lists the values of parameters in the order of their references.
fn values(name: &str, kind: &str, variables: &[&Variable]) -> String {
    let mut count = 0;
    let mut assignments = String::new();
    for variable in variables {
        let path = format!("parameters.{}", class::path(&variable.name));
        let length = variable.length();
        let (place, value) = match (variable.dimension, variable.kind) {
            (Some(_), _) => (format!("{}:{}", count + 1, count + length), path),
            (None, Kind::Enumeration) => (format!("{}", count + 1), format!("Integer({path})")),
            _ => (format!("{}", count + 1), path),
        };
        assignments += &format!("    values[{place}] := {value};\n");
        count += length;
    }
    format!(
        "
  function {name}s \"Values of the {kind} parameters\"
    extends Modelica.Icons.Function;
    input FlexArm.Parameters.TFlex parameters \"Parameters\";
    output {kind} values[{count}] \"In the order of their references\";
  algorithm
{assignments}    annotation (Documentation(info = \"<html><p>In the order of <code>{name}Parameters</code>.</p></html>\"));
  end {name}s;
"
    )
}
