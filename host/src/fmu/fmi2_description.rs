//! The FMI 2.0 `modelDescription.xml` in the host's terms.
//!
//! `fmi-rs` 0.3 keeps only the first of the type definitions, so those are read here.

use super::description::{
    Causality, CoSimulation, DefaultExperiment, Description, Item, Variable, Version,
};
use super::reader;
use super::structure::{Dependencies, Units};
use super::value::Kind;
use fmi_rs::model_description::{ModelDescriptionError, fmi2};
use roxmltree::Document;
use std::collections::HashMap;

/// What a variable may inherit from its declared type.
#[derive(Default)]
struct DeclaredType {
    unit: Option<String>,
    min: Option<f64>,
    max: Option<f64>,
    items: Vec<Item>,
}

pub(super) fn read(text: &str) -> Result<Description, ModelDescriptionError> {
    let parsed = fmi2::ModelDescription::from_string(text)?;
    let types = declared_types(text)?;
    let variables = parsed
        .modelVariables
        .iter()
        .map(|v| variable(v, &types))
        .collect();
    let experiment = parsed.defaultExperiment.as_ref();
    Ok(Description {
        version: Version::V2,
        fmi_version: "2.0".into(),
        problems: reader::problems(|| parsed.validate()),
        model_exchange: parsed.modelExchange.is_some(),
        scheduled_execution: false,
        co_simulation: parsed.coSimulation.map(|c| CoSimulation {
            model_identifier: c.modelIdentifier,
            needs_execution_tool: c.needsExecutionTool,
            can_be_instantiated_only_once_per_process: c.canBeInstantiatedOnlyOncePerProcess,
            can_get_and_set_state: c.canGetAndSetFMUstate,
            can_serialize_state: c.canSerializeFMUstate,
            can_handle_variable_step: c.canHandleVariableCommunicationStepSize,
            fixed_internal_step: None,
            has_event_mode: false,
        }),
        default_experiment: experiment.map_or_else(DefaultExperiment::default, reader::experiment),
        log_categories: parsed.logCategories.into_iter().map(|c| c.name).collect(),
        model_name: parsed.modelName,
        token: parsed.guid,
        description: parsed.description.unwrap_or_default(),
        model_version: parsed.version.unwrap_or_default(),
        author: parsed.author.unwrap_or_default(),
        license: parsed.license.unwrap_or_default(),
        generation_tool: parsed.generationTool.unwrap_or_default(),
        generation_date: parsed.generationDateAndTime.unwrap_or_default(),
        variables,
        units: Units::new(),
        dependencies: Dependencies::new(),
        index: HashMap::new(),
    })
}

fn declared_types(text: &str) -> Result<HashMap<String, DeclaredType>, ModelDescriptionError> {
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..roxmltree::ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| ModelDescriptionError::Parse(e.to_string()))?;
    let mut types = HashMap::new();
    for simple in document
        .descendants()
        .filter(|n| n.has_tag_name("SimpleType"))
    {
        let (Some(name), Some(body)) = (
            simple.attribute("name"),
            simple.children().find(roxmltree::Node::is_element),
        ) else {
            continue;
        };
        let number = |key| body.attribute(key).and_then(|s| s.trim().parse().ok());
        let item = |node: roxmltree::Node<'_, '_>| {
            Some(Item {
                name: node.attribute("name")?.to_owned(),
                value: node.attribute("value")?.trim().parse().ok()?,
            })
        };
        let declared = DeclaredType {
            unit: body.attribute("unit").map(str::to_owned),
            min: number("min"),
            max: number("max"),
            items: body
                .children()
                .filter(|n| n.has_tag_name("Item"))
                .filter_map(item)
                .collect(),
        };
        types.insert(name.to_owned(), declared);
    }
    Ok(types)
}

fn variable(v: &fmi2::ScalarVariable, types: &HashMap<String, DeclaredType>) -> Variable {
    let none = DeclaredType::default();
    let declared = |name: Option<&String>| name.and_then(|n| types.get(n)).unwrap_or(&none);
    let number = |text: &Option<String>| text.as_ref().and_then(|t| t.trim().parse().ok());
    let (kind, unit, min, max, from_type) = match &v.variableType {
        fmi2::VariableType::Real {
            unit,
            min,
            max,
            declaredType,
            ..
        } => (
            Kind::Float64,
            unit.clone(),
            number(min),
            number(max),
            declared(declaredType.as_ref()),
        ),
        fmi2::VariableType::Integer {
            min,
            max,
            declaredType,
            ..
        } => (
            Kind::Int32,
            None,
            number(min),
            number(max),
            declared(declaredType.as_ref()),
        ),
        fmi2::VariableType::Boolean { .. } => (Kind::Boolean, None, None, None, &none),
        fmi2::VariableType::String { .. } => (Kind::String, None, None, None, &none),
        fmi2::VariableType::Enumeration {
            min,
            max,
            declaredType,
            ..
        } => (
            Kind::Enumeration,
            None,
            number(min),
            number(max),
            declared(Some(declaredType)),
        ),
    };
    let causality = match v.causality {
        fmi2::Causality::Parameter => Causality::Parameter,
        fmi2::Causality::CalculatedParameter => Causality::CalculatedParameter,
        fmi2::Causality::Input => Causality::Input,
        fmi2::Causality::Output => Causality::Output,
        fmi2::Causality::Local => Causality::Local,
        fmi2::Causality::Independent => Causality::Independent,
    };
    let constant = v.variability == fmi2::Variability::Constant;
    Variable {
        name: v.name.clone(),
        reference: v.valueReference,
        kind,
        causality,
        constant: constant || v.variability == fmi2::Variability::Fixed,
        settable: !constant
            && (causality == Causality::Input
                || matches!(
                    v.initial,
                    Some(fmi2::Initial::Exact | fmi2::Initial::Approx)
                )),
        unit: unit.or_else(|| from_type.unit.clone()),
        min: min.or(from_type.min),
        max: max.or(from_type.max),
        start: v.variableType.start().iter().cloned().collect(),
        dimensions: Vec::new(),
        sized_by: Vec::new(),
        description: v.description.clone().unwrap_or_default(),
        items: from_type.items.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_declared_types_are_known() {
        let text = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="m" guid="{g}">
  <CoSimulation modelIdentifier="m"/>
  <TypeDefinitions>
    <SimpleType name="Angle"><Real unit="rad" min="-1" max="2.5"/></SimpleType>
    <SimpleType name="Law"><Enumeration><Item name="lqr" value="1"/><Item name="pid" value="3"/></Enumeration></SimpleType>
  </TypeDefinitions>
  <DefaultExperiment stopTime="2.5"/>
  <ModelVariables>
    <ScalarVariable name="a" valueReference="7" causality="input"><Real declaredType="Angle" start="0"/></ScalarVariable>
    <ScalarVariable name="law" valueReference="8" causality="parameter" variability="fixed"><Enumeration declaredType="Law" start="3"/></ScalarVariable>
    <ScalarVariable name="p[1]" valueReference="9" causality="parameter" variability="fixed"><Real start="4"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>"#;
        let d = read(text).unwrap();
        assert_eq!(d.default_experiment.stop_time, Some(2.5));
        let [a, law, p] = d.variables.as_slice() else {
            panic!()
        };
        assert_eq!(
            (a.unit.as_deref(), a.min, a.max),
            (Some("rad"), Some(-1.0), Some(2.5))
        );
        assert_eq!(
            (a.reference, a.causality, a.settable),
            (7, Causality::Input, true)
        );
        assert_eq!(
            (law.kind, law.items[1].name.as_str()),
            (Kind::Enumeration, "pid")
        );
        assert_eq!((p.name.as_str(), p.start[0].as_str()), ("p[1]", "4"));
    }
}
