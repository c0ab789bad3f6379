//! From XML text to the typed tree.
//!
//! Elements and attributes are those of the FMI 3.0 schema that the units use; anything else is
//! reported, so that a misspelt attribute cannot be overlooked.

mod variables;

use crate::check;
use crate::tree::{
    DisplayUnit, EnumerationType, Experiment, Interface, Item, Kind, LogCategory, ModelDescription,
    Unit, Unknown,
};
use crate::xml::Reader;
use crate::{Diagnostic, fmi3};
use roxmltree::{Document, Node};

/// Reads and checks a model description.
///
/// `file` names it in the messages. Errors: everything that is wrong with it, by line.
pub fn read(text: &str, file: &str) -> Result<ModelDescription, Vec<Diagnostic>> {
    let document = Document::parse(text).map_err(|error| {
        vec![Diagnostic {
            file: file.to_owned(),
            line: error.pos().row,
            message: format!("not well-formed: {error}"),
        }]
    })?;
    let mut reader = Reader::new(&document, file);
    let mut description = root(&mut reader, document.root_element());
    description.file = file.to_owned();
    description.source = text.to_owned();
    description.token = fmi3::token(text);
    check::check(&description, &mut reader);
    description.variables.sort_by_key(|v| v.value_reference);
    let mut diagnostics = reader.diagnostics;
    if diagnostics.is_empty() {
        return Ok(description);
    }
    diagnostics.sort();
    diagnostics.dedup();
    Err(diagnostics)
}

/// The children of `fmiModelDescription` in the order that the schema demands.
const SECTIONS: [&str; 9] = [
    "ModelExchange",
    "CoSimulation",
    "ScheduledExecution",
    "UnitDefinitions",
    "TypeDefinitions",
    "LogCategories",
    "DefaultExperiment",
    "ModelVariables",
    "ModelStructure",
];

fn root<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> ModelDescription {
    if node.tag_name().name() != "fmiModelDescription" {
        r.problem(node, "the root element must be `fmiModelDescription`");
    }
    r.know_attributes(
        node,
        &[
            "fmiVersion",
            "modelName",
            "instantiationToken",
            "version",
            "description",
            "license",
            "generationTool",
            "variableNamingConvention",
        ],
    );
    if node.attribute("fmiVersion") != Some("3.0") {
        r.problem(node, "fmiVersion must be `3.0`");
    }
    if node.attribute("variableNamingConvention") != Some("structured") {
        r.problem(node, "variableNamingConvention must be `structured`");
    }
    let text = node.document().input_text();
    if text.matches(fmi3::EMPTY_TOKEN).count() != 1 {
        let message = format!(
            "`{}` must be there once: the build fills it",
            fmi3::EMPTY_TOKEN
        );
        r.problem(node, message);
    }
    let mut description = ModelDescription {
        file: String::new(),
        source: String::new(),
        token: String::new(),
        name: r.required(node, "modelName"),
        description: r.required(node, "description"),
        version: r.required(node, "version"),
        license: r.required(node, "license"),
        generation_tool: r.required(node, "generationTool"),
        model_exchange: None,
        co_simulation: None,
        scheduled_execution: None,
        units: Vec::new(),
        types: Vec::new(),
        log_categories: Vec::new(),
        experiment: Experiment::default(),
        variables: Vec::new(),
        outputs: Vec::new(),
        derivatives: Vec::new(),
        initial_unknowns: Vec::new(),
        event_indicators: Vec::new(),
        clocks: Vec::new(),
    };
    let sections = r.children(node, &SECTIONS);
    in_order(r, &sections, &SECTIONS, true);
    for section in sections {
        match section.tag_name().name() {
            "ModelExchange" => description.model_exchange = Some(interface(r, section)),
            "CoSimulation" => description.co_simulation = Some(interface(r, section)),
            "ScheduledExecution" => {
                description.scheduled_execution = Some(interface(r, section));
            }
            "UnitDefinitions" => description.units = every(r, section, &["Unit"], unit),
            "TypeDefinitions" => {
                description.types = every(r, section, &["EnumerationType"], enumeration_type);
            }
            "LogCategories" => {
                description.log_categories = every(r, section, &["Category"], log_category);
            }
            "DefaultExperiment" => description.experiment = experiment(r, section),
            "ModelVariables" => {
                let known = [Kind::NAMES, &["Clock"]].concat();
                for (variable, clock) in every(r, section, &known, variables::variable_or_clock) {
                    description.variables.extend(variable);
                    description.clocks.extend(clock);
                }
                variables::resolve(&mut description.variables);
            }
            _ => structure(r, section, &mut description),
        }
    }
    for required in ["ModelVariables", "ModelStructure"] {
        if !node.children().any(|c| c.has_tag_name(required)) {
            r.problem(node, format_args!("missing element `{required}`"));
        }
    }
    description
}

/// Reports elements that stand in another order than `order`, or twice where `once`.
fn in_order(r: &mut Reader, nodes: &[Node], order: &[&str], once: bool) {
    let position = |node: &Node| order.iter().position(|o| node.has_tag_name(*o));
    for pair in nodes.windows(2) {
        let (before, after) = (position(&pair[0]), position(&pair[1]));
        if after < before || (once && after == before) {
            let tag = pair[1].tag_name().name();
            let previous = pair[0].tag_name().name();
            let line = r.line(pair[1]);
            r.report(
                line,
                format_args!("element `{tag}` may not follow `{previous}`"),
            );
        }
    }
}

/// Reads each child of a section that may only have children named `known`.
fn every<'a, T>(
    r: &mut Reader<'a>,
    section: Node<'a, 'a>,
    known: &[&str],
    read: impl Fn(&mut Reader<'a>, Node<'a, 'a>) -> T,
) -> Vec<T> {
    r.know_attributes(section, &[]);
    r.children(section, known)
        .into_iter()
        .map(|child| read(r, child))
        .collect()
}

fn interface<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Interface {
    let mut known = vec![
        "modelIdentifier",
        "canGetAndSetFMUState",
        "canSerializeFMUState",
        "providesDirectionalDerivatives",
        "providesAdjointDerivatives",
    ];
    known.extend_from_slice(match node.tag_name().name() {
        "ModelExchange" => &["needsCompletedIntegratorStep"],
        "ScheduledExecution" => &[],
        _ => &[
            "canHandleVariableCommunicationStepSize",
            "canReturnEarlyAfterIntermediateUpdate",
            "mightReturnEarlyFromDoStep",
            "providesIntermediateUpdate",
            "hasEventMode",
        ],
    });
    r.know_attributes(node, &known);
    r.children(node, &[]);
    Interface {
        model_identifier: r.required(node, "modelIdentifier"),
        can_get_and_set_state: r.flag(node, "canGetAndSetFMUState"),
        can_serialize_state: r.flag(node, "canSerializeFMUState"),
        needs_completed_integrator_step: r.flag(node, "needsCompletedIntegratorStep"),
        can_handle_variable_step: r.flag(node, "canHandleVariableCommunicationStepSize"),
        provides_directional_derivatives: r.flag(node, "providesDirectionalDerivatives"),
        has_event_mode: r.flag(node, "hasEventMode"),
        provides_adjoint_derivatives: r.flag(node, "providesAdjointDerivatives"),
        line: r.line(node),
    }
}

pub(crate) fn unit<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Unit {
    r.know_attributes(node, &["name", "id", "description"]);
    let mut unit = Unit {
        name: r.required(node, "name"),
        base: None,
        display_units: Vec::new(),
        line: r.line(node),
    };
    let children = r.children(node, &["BaseUnit", "DisplayUnit"]);
    in_order(r, &children, &["BaseUnit", "DisplayUnit"], false);
    for child in children {
        r.children(child, &[]);
        if child.has_tag_name("BaseUnit") {
            const EXPONENTS: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
            r.know_attributes(child, &[&EXPONENTS[..], &["factor", "offset"]].concat());
            for exponent in EXPONENTS {
                r.parsed(child, exponent, "an integer", |t| t.parse::<i32>().ok());
            }
            r.number(child, "factor");
            r.number(child, "offset");
            let attributes = child.attributes();
            let pair = |a: roxmltree::Attribute| (a.name().to_owned(), a.value().to_owned());
            unit.base = Some(attributes.map(pair).collect());
        } else {
            r.know_attributes(child, &["name", "factor", "offset"]);
            unit.display_units.push(DisplayUnit {
                name: r.required(child, "name"),
                factor: r.number(child, "factor").unwrap_or(1.0),
                offset: r.number(child, "offset").unwrap_or(0.0),
            });
        }
    }
    unit
}

fn enumeration_type<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> EnumerationType {
    r.know_attributes(node, &["name", "description"]);
    EnumerationType {
        name: r.required(node, "name"),
        description: r.required(node, "description"),
        line: r.line(node),
        items: r
            .children(node, &["Item"])
            .into_iter()
            .filter_map(|child| item(r, child))
            .collect(),
    }
}

fn item<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Item> {
    r.know_attributes(node, &["name", "value", "description"]);
    r.children(node, &[]);
    r.required(node, "value");
    let (name, description) = (r.required(node, "name"), r.required(node, "description"));
    Some(Item {
        name,
        description,
        value: r.parsed(node, "value", "a 32-bit integer", |t| t.parse().ok())?,
        line: r.line(node),
    })
}

fn log_category<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> LogCategory {
    r.know_attributes(node, &["name", "description"]);
    r.children(node, &[]);
    LogCategory {
        name: r.required(node, "name"),
        description: r.required(node, "description"),
        line: r.line(node),
    }
}

fn experiment<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Experiment {
    r.know_attributes(node, &["startTime", "stopTime", "tolerance", "stepSize"]);
    r.children(node, &[]);
    Experiment {
        start_time: r.number(node, "startTime"),
        stop_time: r.number(node, "stopTime"),
        tolerance: r.number(node, "tolerance"),
        step_size: r.number(node, "stepSize"),
        line: r.line(node),
    }
}

fn structure<'a>(r: &mut Reader<'a>, section: Node<'a, 'a>, description: &mut ModelDescription) {
    const ENTRIES: [&str; 4] = [
        "Output",
        "ContinuousStateDerivative",
        "InitialUnknown",
        "EventIndicator",
    ];
    r.know_attributes(section, &[]);
    let entries = r.children(section, &ENTRIES);
    in_order(r, &entries, &ENTRIES, false);
    for entry in entries {
        r.know_attributes(entry, &["valueReference", "dependencies"]);
        r.children(entry, &[]);
        r.required(entry, "valueReference");
        let Some(value_reference) = r.reference(entry, "valueReference") else {
            continue;
        };
        let unknown = Unknown {
            value_reference,
            dependencies: r.list(entry, "dependencies", "a value reference", |t| {
                t.parse().ok()
            }),
            line: r.line(entry),
        };
        match entry.tag_name().name() {
            "Output" => description.outputs.push(unknown),
            "ContinuousStateDerivative" => description.derivatives.push(unknown),
            "EventIndicator" => description.event_indicators.push(unknown),
            _ => description.initial_unknowns.push(unknown),
        }
    }
}
