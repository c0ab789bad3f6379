//! Reads `.ssd` and `.ssm` files of SSP 1.0 and 2.0, which share their namespaces. Everything that is wrong is
//! reported with its line; graphics, metadata and annotations of others are skipped.

use super::bindings::{binding, transformation};
use super::document::{
    Child, Component, Connection, Connector, Element, Kind, System, SystemStructure, Type,
};
use super::transformation::{NamedUnit, Unit};
use crate::input::{Error, Place};
use model_description::Diagnostic;
use model_description::xml::Reader;
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, BTreeSet};

pub(super) const SSD: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
pub(super) const SSC: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";

/// Annotation of OMSimulator with the step of its master.
pub(super) const OPENMODELICA: &str = "org.openmodelica";
/// Annotation that names a file with values for the inputs of the system.
pub(super) const INPUTS: &str = "flexarm.inputs";

/// Every problem as an error with its place.
pub(super) fn errors(diagnostics: Vec<Diagnostic>) -> Error {
    let error = |d: Diagnostic| Error::Syntax {
        place: Place::new(d.file, Some(d.line.into())),
        message: d.message,
    };
    Error::Several(diagnostics.into_iter().map(error).collect())
}

pub(super) fn parse<'a>(text: &'a str, file: &str) -> Result<Document<'a>, Error> {
    Document::parse(text).map_err(|error| Error::Syntax {
        place: Place::new(file, Some(error.pos().row.into())),
        message: format!("not well-formed: {error}"),
    })
}

/// Reads a system structure; `file` names it in messages.
pub(super) fn system_structure(text: &str, file: &str) -> Result<SystemStructure, Error> {
    let document = parse(text, file)?;
    let mut reader = Reader::new(&document, file);
    let read = root(&mut reader, document.root_element(), file);
    match reader.finish(read).map_err(errors)? {
        Some(read) => Ok(read),
        None => Err(Error::Syntax {
            place: Place::new(file, Some(1)),
            message: "no system".to_owned(),
        }),
    }
}

fn root<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>, file: &str) -> Option<SystemStructure> {
    if !node.has_tag_name((SSD, "SystemStructureDescription")) {
        r.problem(
            node,
            format_args!("the root element must be `SystemStructureDescription` of {SSD}"),
        );
        return None;
    }
    let version = r.required(node, "version");
    if !version.is_empty() && !version.starts_with("1.") && !version.starts_with("2.") {
        r.problem(
            node,
            format_args!("version `{version}`: 1.x and 2.x can be read"),
        );
    }
    let name = r.required(node, "name");
    let mut system_node = None;
    let (mut units, mut enumerations) = (BTreeMap::new(), BTreeMap::new());
    let (mut start, mut stop, mut step, mut inputs) = (None, None, None, None);
    let sections = [
        "System",
        "Enumerations",
        "Units",
        "DefaultExperiment",
        "MetaData",
        "Annotations",
    ];
    for section in r.children(node, &sections) {
        match section.tag_name().name() {
            "System" => system_node = Some(section),
            "Units" => units = self::units(r, section),
            "Enumerations" => enumerations = self::enumerations(r, section),
            "DefaultExperiment" => {
                start = r.number(section, "startTime");
                stop = r.number(section, "stopTime");
                let annotation = annotation(section, INPUTS);
                let source = annotation.and_then(|a| Some((a, a.attribute("source")?)));
                inputs = source.map(|(node, path)| (path.to_owned(), r.line(node)));
            }
            _ => {}
        }
    }
    let Some(system_node) = system_node else {
        r.problem(node, "has no `System`");
        return None;
    };
    // OMSimulator keeps its master with the root system.
    for master in annotation(system_node, OPENMODELICA)
        .iter()
        .flat_map(Node::descendants)
    {
        let attribute = match master.tag_name().name() {
            "FixedStepMaster" => "stepSize",
            "VariableStepMaster" => "maximumStepSize",
            _ => continue,
        };
        step = r.number(master, attribute).filter(|step| *step > 0.0);
    }
    Some(SystemStructure {
        file: file.to_owned(),
        name,
        system: system(r, system_node),
        units,
        enumerations,
        start,
        stop,
        step,
        inputs,
    })
}

/// The content of the annotation of a type.
fn annotation<'a>(node: Node<'a, 'a>, of: &str) -> Option<Node<'a, 'a>> {
    let annotations = node
        .children()
        .filter(|c| c.has_tag_name((SSD, "Annotations")));
    let mut all = annotations.flat_map(|a| a.children());
    let found = all.find(|a| a.attribute("type") == Some(of))?;
    found.children().find(Node::is_element)
}

fn units<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> BTreeMap<String, NamedUnit> {
    let mut units = BTreeMap::new();
    for child in r.children(node, &["Unit"]) {
        let name = r.required(child, "name");
        let base = child.children().find(|c| c.has_tag_name((SSC, "BaseUnit")));
        let unit = base.and_then(Unit::new);
        if unit.is_none() {
            r.problem(
                child,
                "needs a `BaseUnit` with whole exponents, a factor that is not 0 and an offset",
            );
        }
        let named = NamedUnit {
            name: name.clone(),
            unit,
        };
        if units.insert(name, named).is_some() {
            r.problem(child, "given twice");
        }
    }
    units
}

fn enumerations<'a>(
    r: &mut Reader<'a>,
    node: Node<'a, 'a>,
) -> BTreeMap<String, Vec<(String, i64)>> {
    let mut enumerations = BTreeMap::new();
    for child in r.children(node, &["Enumeration"]) {
        let mut items = Vec::new();
        for item in r.children(child, &["Item", "Annotations"]) {
            if item.tag_name().name() == "Item" {
                r.required(item, "value");
                let value = r.parsed(item, "value", "an integer", |t| t.trim().parse().ok());
                items.push((r.required(item, "name"), value.unwrap_or(0)));
            }
        }
        enumerations.insert(r.required(child, "name"), items);
    }
    enumerations
}

fn element<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Element {
    let mut element = Element {
        name: r.required(node, "name"),
        connectors: Vec::new(),
        bindings: Vec::new(),
        line: r.line(node),
    };
    let mut names: BTreeMap<String, u32> = BTreeMap::new();
    for section in node.children().filter(Node::is_element) {
        match section.tag_name().name() {
            "Connectors" => {
                for child in r.children(section, &["Connector"]) {
                    let Some(connector) = connector(r, child) else {
                        continue;
                    };
                    if let Some(line) = names.insert(connector.name.clone(), connector.line) {
                        let of = &element.name;
                        let message = format!("`{of}` has this connector already, in line {line}");
                        r.problem(child, message);
                    }
                    element.connectors.push(connector);
                }
            }
            "ParameterBindings" => {
                let nodes = r.children(section, &["ParameterBinding"]);
                let bindings = nodes.into_iter().filter_map(|child| binding(r, child));
                element.bindings = bindings.collect();
            }
            _ => {}
        }
    }
    element
}

/// Elements that systems and components may have.
const OF_ELEMENTS: [&str; 5] = [
    "Connectors",
    "ElementGeometry",
    "ParameterBindings",
    "MetaData",
    "Annotations",
];

fn system<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> System {
    let mut system = System {
        element: element(r, node),
        children: Vec::new(),
        connections: Vec::new(),
    };
    let own = [
        "Elements",
        "Connections",
        "SignalDictionaries",
        "SystemGeometry",
        "GraphicalElements",
    ];
    let mut names = BTreeSet::new();
    for section in r.children(node, &[&OF_ELEMENTS[..], &own].concat()) {
        match section.tag_name().name() {
            "Elements" => {
                let kinds = ["Component", "System", "SignalDictionaryReference"];
                for child in r.children(section, &kinds) {
                    let kind = child.tag_name().name();
                    let read = match kind {
                        "Component" => component(r, child).map(Child::Component),
                        "System" => Some(Child::System(self::system(r, child))),
                        _ => {
                            r.problem(child, "signal dictionaries cannot be simulated: connect the signals themselves");
                            None
                        }
                    };
                    let Some(read) = read else { continue };
                    if !names.insert(read.element().name.clone()) {
                        r.problem(child, "the system has an element of this name already");
                    }
                    system.children.push(read);
                }
            }
            "Connections" => {
                let nodes = r.children(section, &["Connection"]);
                let connections = nodes.into_iter().map(|child| connection(r, child));
                system.connections = connections.collect();
            }
            _ => {}
        }
    }
    system
}

fn component<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Component> {
    r.children(node, &OF_ELEMENTS);
    let source = r.required(node, "source");
    let kind = node.attribute("type");
    if let Some(kind) = kind.filter(|kind| *kind != "application/x-fmu-sharedlibrary") {
        r.problem(
            node,
            format_args!("type `{kind}` cannot be simulated, only application/x-fmu-sharedlibrary"),
        );
        return None;
    }
    match node.attribute("implementation") {
        None | Some("any" | "CoSimulation") => {}
        Some(other) => {
            r.problem(
                node,
                format_args!(
                    "implementation `{other}` cannot be simulated, only any and CoSimulation"
                ),
            );
        }
    }
    Some(Component {
        element: element(r, node),
        source,
    })
}

fn connector<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Option<Connector> {
    let name = r.required(node, "name");
    let kind = match r.required(node, "kind").as_str() {
        "" => return None,
        "input" => Kind::Input,
        "output" | "local" => Kind::Output,
        "parameter" | "structuralParameter" => Kind::Parameter,
        "calculatedParameter" | "constant" => Kind::CalculatedParameter,
        other => {
            r.problem(node, format_args!("kind `{other}` cannot be simulated, only input, output, parameter and calculatedParameter"));
            return None;
        }
    };
    let (mut signal, mut unit) = (None, None);
    for child in node.children().filter(Node::is_element) {
        let tag = child.tag_name().name();
        signal = Some(match tag {
            "ConnectorGeometry" | "Annotations" | "MetaData" => continue,
            "Real" | "Float64" | "Float32" => {
                unit = child.attribute("unit").map(str::to_owned);
                Type::Real
            }
            "Boolean" => Type::Boolean,
            "Enumeration" => Type::Enumeration(r.required(child, "name")),
            "String" | "Binary" | "Clock" => Type::Other(tag.to_owned()),
            "Dimension" => {
                r.problem(
                    node,
                    "arrays cannot be connected as a whole: connect their elements",
                );
                continue;
            }
            _ if tag == "Integer" || tag.starts_with("Int") || tag.starts_with("UInt") => {
                Type::Integer
            }
            _ => {
                r.problem(node, format_args!("unknown element `{tag}`"));
                continue;
            }
        });
    }
    Some(Connector {
        name,
        kind,
        signal,
        unit,
        line: r.line(node),
    })
}

fn connection<'a>(r: &mut Reader<'a>, node: Node<'a, 'a>) -> Connection {
    let transformation =
        transformation(r, node, &["ConnectionGeometry", "MetaData", "Annotations"]);
    for indices in ["startIndices", "endIndices"] {
        if node.has_attribute(indices) {
            r.problem(
                node,
                format_args!("{indices}: arrays cannot be connected in part"),
            );
        }
    }
    let mut end = |element: &str, connector: &str| {
        let element = node.attribute(element).map(str::to_owned);
        (element, r.required(node, connector))
    };
    let ends = [
        end("startElement", "startConnector"),
        end("endElement", "endConnector"),
    ];
    Connection {
        ends,
        transformation,
        suppress_unit_conversion: r.flag(node, "suppressUnitConversion"),
        line: r.line(node),
    }
}
