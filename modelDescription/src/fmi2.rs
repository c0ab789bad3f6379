//! The FMI 2.0 model description, derived from the same tree.
//!
//! FMI 2.0 has no arrays: they become scalars `name[1]` …, whose value references follow each other. Without
//! arrays there are no structural parameters: they are left out, and arrays have their size at the start.
//! Its model structure counts variables from 1 instead of naming their references, time is implicit,
//! `Int32` is `Integer` and `Float64` is `Real`.

use crate::ModelDescription;
use crate::tree::{Causality, Experiment, Interface, Kind, Unit, Unknown, Variable};
use crate::xml::{escape, f64_text};
use std::fmt::{self, Write};

/// Writes the description.
pub fn write(description: &ModelDescription) -> String {
    let mut out = String::new();
    document(&mut out, description).unwrap_or_default(); // writing to a String does not fail
    out
}

fn document(out: &mut String, d: &ModelDescription) -> fmt::Result {
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    write!(out, "<fmiModelDescription fmiVersion=\"2.0\"")?;
    for (attribute, value) in [
        ("modelName", &d.name),
        ("guid", &d.token),
        ("description", &d.description),
        ("version", &d.version),
        ("license", &d.license),
        ("generationTool", &d.generation_tool),
    ] {
        write!(out, "\n    {attribute}=\"{}\"", escape(value))?;
    }
    write!(out, "\n    variableNamingConvention=\"structured\"")?;
    if d.model_exchange.is_some() {
        let count = d.event_indicators.len();
        write!(out, " numberOfEventIndicators=\"{count}\"")?;
    }
    writeln!(out, ">")?;
    if let Some(me) = &d.model_exchange {
        let not_needed = !me.needs_completed_integrator_step;
        let flags = format!(" completedIntegratorStepNotNeeded=\"{not_needed}\"");
        interface(out, "ModelExchange", me, &flags)?;
    }
    if let Some(cs) = &d.co_simulation {
        let flags = format!(
            " canHandleVariableCommunicationStepSize=\"{}\" canInterpolateInputs=\"false\" \
             maxOutputDerivativeOrder=\"0\"",
            cs.can_handle_variable_step
        );
        interface(out, "CoSimulation", cs, &flags)?;
    }
    units(out, &d.units)?;
    types(out, d)?;
    if !d.log_categories.is_empty() {
        writeln!(out, "  <LogCategories>")?;
        for c in &d.log_categories {
            let (name, text) = (escape(&c.name), escape(&c.description));
            writeln!(
                out,
                "    <Category name=\"{name}\" description=\"{text}\"/>"
            )?;
        }
        writeln!(out, "  </LogCategories>")?;
    }
    experiment(out, &d.experiment)?;
    let scalars = Scalars::new(d);
    writeln!(out, "  <ModelVariables>")?;
    for (i, variable) in scalars.variables.iter().enumerate() {
        writeln!(out, "    <!-- {} -->", i + 1)?;
        scalar(out, d, &scalars, variable)?;
    }
    writeln!(out, "  </ModelVariables>\n  <ModelStructure>")?;
    unknowns(out, &scalars, "Outputs", &d.outputs)?;
    unknowns(out, &scalars, "Derivatives", &d.derivatives)?;
    unknowns(out, &scalars, "InitialUnknowns", &d.initial_unknowns)?;
    writeln!(out, "  </ModelStructure>\n</fmiModelDescription>")
}

fn interface(out: &mut String, tag: &str, i: &Interface, flags: &str) -> fmt::Result {
    writeln!(
        out,
        "  <{tag} modelIdentifier=\"{}\" canGetAndSetFMUstate=\"{}\" canSerializeFMUstate=\"{}\" \
         canNotUseMemoryManagementFunctions=\"true\" providesDirectionalDerivative=\"{}\"{flags}/>",
        escape(&i.model_identifier),
        i.can_get_and_set_state,
        i.can_serialize_state,
        i.provides_directional_derivatives,
    )
}

fn units(out: &mut String, units: &[Unit]) -> fmt::Result {
    if units.is_empty() {
        return Ok(());
    }
    writeln!(out, "  <UnitDefinitions>")?;
    for unit in units {
        write!(out, "    <Unit name=\"{}\"><BaseUnit", escape(&unit.name))?;
        for (attribute, value) in unit.base.iter().flatten() {
            write!(out, " {attribute}=\"{}\"", escape(value))?;
        }
        write!(out, "/>")?;
        for display in &unit.display_units {
            write!(
                out,
                "<DisplayUnit name=\"{}\" factor=\"{}\" offset=\"{}\"/>",
                escape(&display.name),
                f64_text(display.factor),
                f64_text(display.offset)
            )?;
        }
        writeln!(out, "</Unit>")?;
    }
    writeln!(out, "  </UnitDefinitions>")
}

fn types(out: &mut String, d: &ModelDescription) -> fmt::Result {
    if d.types.is_empty() {
        return Ok(());
    }
    writeln!(out, "  <TypeDefinitions>")?;
    for t in &d.types {
        let (name, text) = (escape(&t.name), escape(&t.description));
        writeln!(
            out,
            "    <SimpleType name=\"{name}\" description=\"{text}\">"
        )?;
        writeln!(out, "      <Enumeration>")?;
        for item in &t.items {
            let (name, text) = (escape(&item.name), escape(&item.description));
            let value = item.value;
            writeln!(
                out,
                "        <Item name=\"{name}\" value=\"{value}\" description=\"{text}\"/>"
            )?;
        }
        writeln!(out, "      </Enumeration>\n    </SimpleType>")?;
    }
    writeln!(out, "  </TypeDefinitions>")
}

fn experiment(out: &mut String, e: &Experiment) -> fmt::Result {
    write!(out, "  <DefaultExperiment")?;
    for (attribute, value) in [
        ("startTime", e.start_time),
        ("stopTime", e.stop_time),
        ("tolerance", e.tolerance),
        ("stepSize", e.step_size),
    ] {
        if let Some(value) = value {
            write!(out, " {attribute}=\"{}\"", f64_text(value))?;
        }
    }
    writeln!(out, "/>")
}

/// The scalar variables in their order, which gives them their indices.
struct Scalars<'a> {
    variables: Vec<Scalar<'a>>,
}

struct Scalar<'a> {
    name: String,
    /// Element of the array, from 0.
    element: u32,
    of: &'a Variable,
}

impl<'a> Scalars<'a> {
    fn new(d: &'a ModelDescription) -> Self {
        use Causality as C;
        let stored = d
            .variables
            .iter()
            .filter(|v| !matches!(v.causality, C::Independent | C::StructuralParameter));
        let elements = |of: &'a Variable| {
            (0..)
                .zip(of.element_names())
                .map(move |(element, name)| Scalar { name, element, of })
        };
        Self {
            variables: stored.flat_map(elements).collect(),
        }
    }

    /// Indices, from 1, of the scalars of the variable with this value reference. None of the
    /// independent variable, which FMI 2.0 leaves implicit.
    fn indices(&self, value_reference: u32) -> impl Iterator<Item = usize> {
        (1..)
            .zip(&self.variables)
            .filter(move |(_, s)| s.of.value_reference == value_reference)
            .map(|(index, _)| index)
    }
}

fn scalar(out: &mut String, d: &ModelDescription, all: &Scalars, s: &Scalar) -> fmt::Result {
    let v = s.of;
    write!(
        out,
        "    <ScalarVariable name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\"",
        escape(&s.name),
        v.value_reference + s.element,
        v.causality,
        v.variability,
    )?;
    if let Some(initial) = v.initial {
        write!(out, " initial=\"{initial}\"")?;
    }
    writeln!(out, "\n        description=\"{}\">", escape(&v.description))?;
    write!(out, "      <{}", type_name(v.kind))?;
    if let Some(t) = d.declared_type(v) {
        write!(out, " declaredType=\"{}\"", escape(&t.name))?;
    }
    if let Some(unit) = &v.unit {
        write!(out, " unit=\"{}\"", escape(unit))?;
    }
    if let Some(unit) = &v.display_unit {
        write!(out, " displayUnit=\"{}\"", escape(unit))?;
    }
    let limits = [("min", v.min), ("max", v.max), ("nominal", v.nominal)];
    for (attribute, value) in limits {
        if let Some(value) = value {
            write!(out, " {attribute}=\"{}\"", f64_text(value))?;
        }
    }
    if let Some(start) = &v.start
        && let Some(value) = start.get(s.element as usize).or(start.first())
    {
        write!(out, " start=\"{value}\"")?;
    }
    if let Some(state) = v.derivative.and_then(|of| all.indices(of).next()) {
        write!(out, " derivative=\"{state}\"")?;
    }
    writeln!(out, "/>\n    </ScalarVariable>")
}

fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Float64 => "Real",
        Kind::Int32 | Kind::UInt64 => "Integer",
        Kind::Boolean => "Boolean",
        Kind::Enumeration => "Enumeration",
    }
}

/// A list of the model structure, by ascending index.
fn unknowns(out: &mut String, all: &Scalars, list: &str, entries: &[Unknown]) -> fmt::Result {
    let mut lines = Vec::new();
    for entry in entries {
        let dependencies = entry.dependencies.as_ref().map(|references| {
            let mut indices: Vec<_> = references.iter().flat_map(|r| all.indices(*r)).collect();
            indices.sort_unstable();
            let indices: Vec<_> = indices.iter().map(ToString::to_string).collect();
            format!(" dependencies=\"{}\"", indices.join(" "))
        });
        let dependencies = dependencies.unwrap_or_default();
        for index in all.indices(entry.value_reference) {
            lines.push((index, dependencies.clone()));
        }
    }
    if lines.is_empty() {
        return Ok(());
    }
    lines.sort();
    writeln!(out, "    <{list}>")?;
    for (index, dependencies) in lines {
        writeln!(out, "      <Unknown index=\"{index}\"{dependencies}/>")?;
    }
    writeln!(out, "    </{list}>")
}

#[cfg(test)]
mod tests {
    use crate::{fmi2, read};
    use roxmltree::Document;

    const VALID: &str = include_str!("../tests/valid.xml");

    #[test]
    fn arrays_are_flattened_and_time_is_left_out() {
        let text = fmi2::write(&read(VALID, "t.xml").unwrap());
        let document = Document::parse(&text).unwrap();
        let variables: Vec<_> = document
            .descendants()
            .filter(|n| n.has_tag_name("ScalarVariable"))
            .map(|n| {
                let value = n.first_element_child().unwrap();
                (
                    n.attribute("name").unwrap(),
                    n.attribute("valueReference").unwrap(),
                    value.tag_name().name(),
                    value.attribute("start").unwrap_or("-"),
                )
            })
            .collect();
        assert_eq!(
            variables,
            [
                ("inflow", "1", "Real", "0"),
                ("level", "2", "Real", "-"),
                ("der(level)", "3", "Real", "-"),
                ("mode", "4", "Enumeration", "1"),
                ("valve.table[1]", "10", "Real", "1"),
                ("valve.table[2]", "11", "Real", "2"),
                ("valve.table[3]", "12", "Real", "3"),
                ("valve.count", "20", "Integer", "1"),
                ("valve.closed", "21", "Boolean", "false"),
            ]
        );
    }

    #[test]
    fn structure_counts_from_one() {
        let text = fmi2::write(&read(VALID, "t.xml").unwrap());
        let document = Document::parse(&text).unwrap();
        let unknowns: Vec<_> = document
            .descendants()
            .filter(|n| n.has_tag_name("Unknown"))
            .map(|n| {
                (
                    n.parent().unwrap().tag_name().name(),
                    n.attribute("index").unwrap(),
                    n.attribute("dependencies"),
                )
            })
            .collect();
        assert_eq!(
            unknowns,
            [
                ("Outputs", "2", Some("2")),
                ("Derivatives", "3", Some("1 2")),
                ("InitialUnknowns", "2", Some("5 6 7")),
                ("InitialUnknowns", "3", None),
            ]
        );
        assert!(text.contains("unit=\"m/s\" derivative=\"2\""));
    }
}
