//! The FMI 3.0 `modelDescription.xml` in the host's terms.

use super::description::{
    Causality, CoSimulation, DefaultExperiment, Description, Item, Variable, Version,
};
use super::reader;
use super::structure::{Dependencies, Units};
use super::value::Kind;
use fmi_rs::model_description::ModelDescriptionError;
use fmi_rs::model_description::fmi3::{self, TypeDefinition, VariableType};
use std::collections::HashMap;

pub(super) fn read(text: &str) -> Result<Description, ModelDescriptionError> {
    let parsed = fmi3::ModelDescription::from_string(text)?;
    let variables = parsed
        .modelVariables
        .iter()
        .map(|v| variable(v, &parsed))
        .collect::<Result<_, _>>()?;
    let experiment = parsed.defaultExperiment.as_ref();
    let number = |text: &Option<String>| text.as_ref().and_then(|t| t.trim().parse().ok());
    Ok(Description {
        version: Version::V3,
        problems: reader::problems(|| parsed.validate()),
        fmi_version: parsed.fmiVersion,
        model_exchange: parsed.modelExchange.is_some(),
        scheduled_execution: parsed.scheduledExecution.is_some(),
        co_simulation: parsed.coSimulation.map(|c| CoSimulation {
            model_identifier: c.modelIdentifier,
            needs_execution_tool: c.needsExecutionTool,
            can_be_instantiated_only_once_per_process: c.canBeInstantiatedOnlyOncePerProcess,
            can_get_and_set_state: c.canGetAndSetFMUState,
            can_serialize_state: c.canSerializeFMUState,
            can_handle_variable_step: c.canHandleVariableCommunicationStepSize,
            fixed_internal_step: number(&c.fixedInternalStepSize),
            has_event_mode: c.hasEventMode,
        }),
        default_experiment: experiment.map_or_else(DefaultExperiment::default, reader::experiment),
        log_categories: parsed.logCategories.into_iter().map(|c| c.name).collect(),
        model_name: parsed.modelName,
        token: parsed.instantiationToken,
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

/// Type, own range and name of the declared type.
struct Typed<'a> {
    kind: Kind,
    min: Option<f64>,
    max: Option<f64>,
    declared: Option<&'a str>,
}

fn typed(variable: &VariableType) -> Typed<'_> {
    macro_rules! of {
        ($($variant:ident),*; $($other:ident),*) => {
            match variable {
                $(VariableType::$variant { min, max, declaredType, .. } => Typed {
                    kind: Kind::$variant,
                    min: min.map(|b| b as f64),
                    max: max.map(|b| b as f64),
                    declared: declaredType.as_deref(),
                },)*
                $(VariableType::$other { declaredType, .. } => Typed {
                    kind: Kind::$other,
                    min: None,
                    max: None,
                    declared: declaredType.as_deref(),
                },)*
                VariableType::Enumeration { declaredType, .. } => Typed {
                    kind: Kind::Enumeration,
                    min: None,
                    max: None,
                    declared: Some(declaredType),
                },
            }
        };
    }
    of!(Float32, Float64, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64;
        Boolean, String, Binary, Clock)
}

/// Range and items of a declared type.
fn inherited(definition: &TypeDefinition) -> (Option<f64>, Option<f64>, Vec<Item>) {
    macro_rules! of {
        ($($variant:ident),*) => {
            match definition {
                $(TypeDefinition::$variant { min, max, .. } => {
                    (min.map(|b| b as f64), max.map(|b| b as f64), Vec::new())
                })*
                TypeDefinition::Enumeration { items, min, max, .. } => {
                    let items = items.iter().map(|i| Item { name: i.name.clone(), value: i.value });
                    (min.map(|b| b as f64), max.map(|b| b as f64), items.collect())
                }
                _ => (None, None, Vec::new()),
            }
        };
    }
    of!(
        Float32, Float64, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64
    )
}

fn variable(
    v: &fmi3::ModelVariable,
    model: &fmi3::ModelDescription,
) -> Result<Variable, ModelDescriptionError> {
    let own = typed(&v.variableType);
    let (min, max, items) = own
        .declared
        .and_then(|name| model.get_type_definition(name))
        .map_or_else(Default::default, inherited);
    let causality = match v.causality {
        fmi3::Causality::Parameter => Causality::Parameter,
        fmi3::Causality::CalculatedParameter => Causality::CalculatedParameter,
        fmi3::Causality::StructuralParameter => Causality::StructuralParameter,
        fmi3::Causality::Input => Causality::Input,
        fmi3::Causality::Output => Causality::Output,
        fmi3::Causality::Local => Causality::Local,
        fmi3::Causality::Independent => Causality::Independent,
    };
    let constant = v.variability == fmi3::Variability::Constant;
    Ok(Variable {
        name: v.name.clone(),
        reference: v.valueReference,
        kind: own.kind,
        causality,
        constant: constant || v.variability == fmi3::Variability::Fixed,
        settable: !constant
            && (causality == Causality::Input
                || matches!(
                    v.initial,
                    Some(fmi3::Initial::Exact | fmi3::Initial::Approx)
                )),
        unit: model.get_unit(v).map(str::to_owned),
        min: own.min.or(min),
        max: own.max.or(max),
        start: v.variableType.start().unwrap_or_default(),
        dimensions: model.initial_size(v)?,
        sized_by: v.dimensions.iter().map(parameter).collect(),
        description: v.description.clone().unwrap_or_default(),
        items,
    })
}

/// The structural parameter that a dimension follows.
fn parameter(dimension: &fmi3::Dimension) -> Option<u32> {
    match dimension {
        fmi3::Dimension::Fixed { .. } => None,
        fmi3::Dimension::Variable { valueReference } => Some(*valueReference),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contract(unit: &str) -> Description {
        let path = format!(
            "{}/../modelDescription/{unit}.xml",
            env!("CARGO_MANIFEST_DIR")
        );
        read(&std::fs::read_to_string(path).unwrap()).unwrap()
    }

    #[test]
    fn the_contracts_are_read() {
        let controller = contract("controller");
        assert!(controller.problems.is_empty(), "{:?}", controller.problems);
        let find = |name: &str| {
            controller
                .variables
                .iter()
                .find(|v| v.name == name)
                .unwrap()
        };
        let law = find("feedback.law");
        assert_eq!(law.kind, Kind::Enumeration);
        assert_eq!(
            law.items[1],
            Item {
                name: "lqri".into(),
                value: 2
            }
        );
        assert!(law.settable && law.constant);
        let cogging = find("arm.cogging_cos");
        assert_eq!((cogging.length(), cogging.start.len()), (9, 9));
        assert_eq!(
            (cogging.min, cogging.unit.as_deref()),
            (Some(-1e6), Some("N.m"))
        );
        assert!(!find("torque").settable);
        let points = find("nmpc.plan.points");
        assert_eq!(
            (points.kind, points.causality, points.settable),
            (Kind::UInt64, Causality::StructuralParameter, true)
        );
        let plan = find("nmpc.plan.angle");
        assert_eq!(
            (&plan.dimensions[..], &plan.sized_by[..]),
            (&[41][..], &[Some(points.reference)][..])
        );
    }
}
