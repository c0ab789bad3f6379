//! A system structure as it is written (SSP 1.0 sec 5): what [`super::read`] finds in an `.ssd`.

use super::transformation::NamedUnit;
use model_description::ssv::ParameterSet;
use std::collections::BTreeMap;
use std::fmt;

/// A `SystemStructureDescription`.
#[derive(Clone, Debug)]
pub(super) struct SystemStructure {
    /// File for messages: the package and the path in it.
    pub file: String,
    pub name: String,
    pub system: System,
    pub units: BTreeMap<String, NamedUnit>,
    /// Items with their values.
    pub enumerations: BTreeMap<String, Vec<(String, i64)>>,
    pub start: Option<f64>,
    pub stop: Option<f64>,
    /// Communication step, from an annotation of OMSimulator.
    pub step: Option<f64>,
    /// Path of a file with values for the inputs of the system, from an annotation of ours, and its line.
    pub inputs: Option<(String, u32)>,
}

/// A system with its content.
#[derive(Clone, Debug)]
pub(super) struct System {
    pub element: Element,
    pub children: Vec<Child>,
    pub connections: Vec<Connection>,
}

/// What a system contains.
#[derive(Clone, Debug)]
pub(super) enum Child {
    Component(Component),
    System(System),
}

impl Child {
    pub fn element(&self) -> &Element {
        match self {
            Self::Component(component) => &component.element,
            Self::System(system) => &system.element,
        }
    }
}

/// What systems and components have in common.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    pub connectors: Vec<Connector>,
    pub bindings: Vec<Binding>,
    pub line: u32,
}

/// An FMU in a system.
#[derive(Clone, Debug)]
pub(super) struct Component {
    pub element: Element,
    /// Path of the FMU in the package.
    pub source: String,
}

/// Which way values go through a connector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Input,
    Output,
    Parameter,
    CalculatedParameter,
}

impl Kind {
    /// Whether values go into the element.
    pub fn is_inward(self) -> bool {
        matches!(self, Self::Input | Self::Parameter)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
        })
    }
}

/// Type of a signal, as far as connections must distinguish.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Real,
    Integer,
    Boolean,
    /// With its name in the file.
    Enumeration(String),
    /// String, Binary or Clock: not connected by this host.
    Other(String),
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Real => "Real",
            Self::Integer => "Integer",
            Self::Boolean => "Boolean",
            Self::Enumeration(_) => "Enumeration",
            Self::Other(name) => name,
        })
    }
}

/// A connector of a system or component.
#[derive(Clone, Debug)]
pub(super) struct Connector {
    pub name: String,
    pub kind: Kind,
    pub signal: Option<Type>,
    pub unit: Option<String>,
    pub line: u32,
}

/// A connection between two connectors of a system and its elements.
#[derive(Clone, Debug)]
pub(super) struct Connection {
    /// Element, none for the system itself, and connector. The terms start and end of the standard do not
    /// tell which way values go (SSP 1.0 sec 5.3.2).
    pub ends: [(Option<String>, String); 2],
    pub transformation: Option<Written>,
    pub suppress_unit_conversion: bool,
    pub line: u32,
}

/// A transformation as it is written.
#[derive(Clone, Debug)]
pub(super) enum Written {
    Linear { factor: f64, offset: f64 },
    Boolean(Vec<(bool, bool)>),
    Integer(Vec<(i64, i64)>),
    Enumeration(Vec<(String, String)>),
}

impl Written {
    /// Name of its element.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Linear { .. } => "LinearTransformation",
            Self::Boolean(_) => "BooleanMappingTransformation",
            Self::Integer(_) => "IntegerMappingTransformation",
            Self::Enumeration(_) => "EnumerationMappingTransformation",
        }
    }
}

/// Parameter values that are given to an element.
#[derive(Clone, Debug)]
pub(super) struct Binding {
    pub prefix: String,
    pub values: Source<ParameterSet>,
    pub mapping: Option<Source<Mapping>>,
    pub line: u32,
}

/// Content that stands in the file or in another one.
#[derive(Clone, Debug)]
pub(super) enum Source<T> {
    Inline(T),
    File {
        path: String,
        /// Whether the path is within the component.
        in_component: bool,
    },
}

/// A `ParameterMapping` (SSP 1.0 sec 7).
#[derive(Clone, Debug)]
pub(super) struct Mapping {
    pub entries: Vec<MappingEntry>,
}

/// Gives a parameter of the source to a parameter of the element.
#[derive(Clone, Debug)]
pub(super) struct MappingEntry {
    pub source: String,
    pub target: String,
    pub transformation: Option<Written>,
    pub suppress_unit_conversion: bool,
    pub line: u32,
}
