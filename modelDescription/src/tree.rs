//! The typed tree of a model description.

use std::collections::BTreeMap;
use std::fmt;

/// A checked model description (FMI 3.0 sec 2.4).
#[derive(Clone, Debug)]
pub struct ModelDescription {
    /// File, as it was named to the reader.
    pub file: String,
    /// The text it was read from.
    pub source: String,
    /// `instantiationToken` (FMI 3.0) and `guid` (FMI 2.0): SHA-256 of the text, in hexadecimal.
    pub token: String,
    /// `modelName`, also the `modelIdentifier` of every interface.
    pub name: String,
    /// What the unit is.
    pub description: String,
    /// Version of the unit.
    pub version: String,
    /// Licence, as an SPDX expression.
    pub license: String,
    /// Tool that made the unit.
    pub generation_tool: String,
    /// Model Exchange, if offered.
    pub model_exchange: Option<Interface>,
    /// Co-Simulation, if offered.
    pub co_simulation: Option<Interface>,
    /// Scheduled Execution, if offered: by FMI 3.0 only.
    pub scheduled_execution: Option<Interface>,
    /// Units.
    pub units: Vec<Unit>,
    /// Enumeration types.
    pub types: Vec<EnumerationType>,
    /// Log categories.
    pub log_categories: Vec<LogCategory>,
    /// Default experiment.
    pub experiment: Experiment,
    /// Variables, by ascending value reference.
    pub variables: Vec<Variable>,
    /// `Output` entries of the model structure.
    pub outputs: Vec<Unknown>,
    /// `ContinuousStateDerivative` entries of the model structure.
    pub derivatives: Vec<Unknown>,
    /// `InitialUnknown` entries of the model structure.
    pub initial_unknowns: Vec<Unknown>,
    /// `EventIndicator` entries of the model structure.
    pub event_indicators: Vec<Unknown>,
    /// Input clocks, which FMI 2.0 does not have.
    pub clocks: Vec<Clock>,
}

impl ModelDescription {
    /// The variable whose first value reference this is.
    pub fn variable(&self, value_reference: u32) -> Option<&Variable> {
        self.variables
            .iter()
            .find(|v| v.value_reference == value_reference)
    }

    /// The interfaces that are offered.
    pub fn interfaces(&self) -> impl Iterator<Item = &Interface> {
        let both = self.model_exchange.iter().chain(&self.co_simulation);
        both.chain(&self.scheduled_execution)
    }

    /// The enumeration type of a variable, if it has one.
    pub fn declared_type(&self, variable: &Variable) -> Option<&EnumerationType> {
        let name = variable.declared_type.as_deref()?;
        self.types.iter().find(|t| t.name == name)
    }

    /// The continuous states, in the order of [`ModelDescription::derivatives`].
    pub fn states(&self) -> impl Iterator<Item = &Variable> {
        self.derivatives
            .iter()
            .filter_map(|d| self.variable(self.variable(d.value_reference)?.derivative?))
    }
}

/// Attributes of `ModelExchange`, `CoSimulation` or `ScheduledExecution` that the units use.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct Interface {
    pub model_identifier: String,
    pub can_get_and_set_state: bool,
    pub can_serialize_state: bool,
    pub needs_completed_integrator_step: bool,
    pub can_handle_variable_step: bool,
    pub provides_directional_derivatives: bool,
    pub provides_adjoint_derivatives: bool,
    pub has_event_mode: bool,
    pub line: u32,
}

/// A unit of measurement.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Name.
    pub name: String,
    /// `BaseUnit`: exponents of the SI base units and rad, `factor` and `offset`, as written.
    pub base: Option<BTreeMap<String, String>>,
    /// Units that a tool may display instead.
    pub display_units: Vec<DisplayUnit>,
    /// Line of its declaration.
    pub line: u32,
}

/// A unit to display values in: display value = factor · value + offset.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct DisplayUnit {
    pub name: String,
    pub factor: f64,
    pub offset: f64,
}

/// An enumeration type.
#[derive(Clone, Debug)]
pub struct EnumerationType {
    /// Name, in camel case: also the name of the Rust type.
    pub name: String,
    /// What it tells apart.
    pub description: String,
    /// Its items.
    pub items: Vec<Item>,
    /// Line of its declaration.
    pub line: u32,
}

/// An item of an enumeration type.
#[derive(Clone, Debug)]
pub struct Item {
    /// Name, in snake case.
    pub name: String,
    /// Value. FMI 2.0 allows 32 bits.
    pub value: i32,
    /// What it means.
    pub description: String,
    /// Line of its declaration.
    pub line: u32,
}

/// A log category.
#[derive(Clone, Debug)]
pub struct LogCategory {
    /// Name.
    pub name: String,
    /// What is logged under it.
    pub description: String,
    /// Line of its declaration.
    pub line: u32,
}

/// The experiment that a tool offers first \[s\].
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct Experiment {
    pub start_time: Option<f64>,
    pub stop_time: Option<f64>,
    pub tolerance: Option<f64>,
    pub step_size: Option<f64>,
    pub line: u32,
}

/// Defines an enum whose variants have the names of the standard.
macro_rules! named {
    ($(#[$meta:meta])* $name:ident { $($variant:ident = $text:literal),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(missing_docs, reason = "the names are the standard's")]
        pub enum $name { $($variant),* }

        impl $name {
            /// All names, as in the standard.
            pub const NAMES: &'static [&'static str] = &[$($text),*];

            /// The variant of that name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name {
                    $($text => Some(Self::$variant),)*
                    _ => None,
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$variant => $text),* })
            }
        }
    };
}

named! {
    /// Type of a variable: those that both FMI versions have and the units need, and `UInt64` of structural
    /// parameters, which FMI 2.0 does not have.
    Kind {
        Float64 = "Float64",
        Int32 = "Int32",
        UInt64 = "UInt64",
        Boolean = "Boolean",
        Enumeration = "Enumeration",
    }
}

named! {
    /// Role of a variable (FMI 3.0 sec 2.4.7.4).
    Causality {
        Independent = "independent",
        Parameter = "parameter",
        StructuralParameter = "structuralParameter",
        CalculatedParameter = "calculatedParameter",
        Input = "input",
        Output = "output",
        Local = "local",
    }
}

named! {
    /// When a variable may change (FMI 3.0 sec 2.4.7.4).
    Variability {
        Constant = "constant",
        Fixed = "fixed",
        Tunable = "tunable",
        Discrete = "discrete",
        Continuous = "continuous",
    }
}

named! {
    /// How a variable gets its initial value (FMI 3.0 sec 2.4.7.5).
    Initial { Exact = "exact", Approx = "approx", Calculated = "calculated" }
}

/// A value of one of the kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are those of Kind")]
pub enum Value {
    Float64(f64),
    Int32(i32),
    UInt64(u64),
    Boolean(bool),
    Enumeration(i32),
}

impl Value {
    /// The value as a number; truth values are 0 and 1.
    pub fn number(self) -> f64 {
        match self {
            Self::Float64(value) => value,
            Self::Int32(value) | Self::Enumeration(value) => f64::from(value),
            Self::UInt64(value) => value as f64,
            Self::Boolean(value) => f64::from(u8::from(value)),
        }
    }

    /// Reads the value of an attribute. None if it is not of that kind.
    pub fn parse(kind: Kind, text: &str) -> Option<Self> {
        Some(match kind {
            Kind::Float64 => Self::Float64(crate::xml::parse_f64(text)?),
            Kind::Int32 => Self::Int32(text.parse().ok()?),
            Kind::UInt64 => Self::UInt64(text.parse().ok()?),
            Kind::Boolean => Self::Boolean(crate::xml::parse_bool(text)?),
            Kind::Enumeration => Self::Enumeration(text.parse().ok()?),
        })
    }
}

/// In the notation of XML Schema; numbers read back exactly.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float64(value) => f.write_str(&crate::xml::f64_text(*value)),
            Self::Int32(value) | Self::Enumeration(value) => write!(f, "{value}"),
            Self::UInt64(value) => write!(f, "{value}"),
            Self::Boolean(value) => write!(f, "{value}"),
        }
    }
}

/// A variable of the unit.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Name: dotted groups of snake case names, or `der(name)`. Arrays carry no subscript.
    pub name: String,
    /// First value reference; an array that has n elements at the start owns n consecutive ones.
    pub value_reference: u32,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// How it gets its initial value. None for inputs and the independent variable.
    pub initial: Option<Initial>,
    /// What it is.
    pub description: String,
    /// Name of the enumeration type.
    pub declared_type: Option<String>,
    /// Unit.
    pub unit: Option<String>,
    /// Unit that tools should display.
    pub display_unit: Option<String>,
    /// Smallest admissible value.
    pub min: Option<f64>,
    /// Largest admissible value.
    pub max: Option<f64>,
    /// Typical magnitude.
    pub nominal: Option<f64>,
    /// Start values, one per element, or one for all of an array whose size may change; None if the variable
    /// has none.
    pub start: Option<Vec<Value>>,
    /// Size; None for a scalar.
    pub dimension: Option<Dimension>,
    /// Value reference of the variable that this one is the time derivative of.
    pub derivative: Option<u32>,
    /// Line of its declaration.
    pub line: u32,
}

/// Size of an array (FMI 3.0 sec 2.4.7.5: `Dimension`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    /// Number of elements at the start.
    pub size: u32,
    /// Value reference of the structural parameter that it follows, if it may change.
    pub parameter: Option<u32>,
}

impl Variable {
    /// Number of elements at the start; 1 for a scalar.
    pub fn length(&self) -> u32 {
        self.dimension.map_or(1, |dimension| dimension.size)
    }

    /// Value reference of the structural parameter that its size follows.
    pub fn sized_by(&self) -> Option<u32> {
        self.dimension?.parameter
    }

    /// Names of its scalar elements, as FMI 2.0 and parameter files know them: `name`, or `name[1]` …
    pub fn element_names(&self) -> impl Iterator<Item = String> {
        (1..=self.length()).map(|i| match self.dimension {
            None => self.name.clone(),
            Some(_) => format!("{}[{i}]", self.name),
        })
    }
}

/// An input clock that ticks in an interval which fixed parameters say: without `intervalDecimal` the importer asks
/// for it (FMI 3.0 sec 2.2.8.3).
#[derive(Clone, Debug)]
pub struct Clock {
    /// Name, as of a variable.
    pub name: String,
    /// Value reference.
    pub value_reference: u32,
    /// What happens when it ticks.
    pub description: String,
    /// Line of its declaration.
    pub line: u32,
}

/// An entry of the model structure.
#[derive(Clone, Debug)]
pub struct Unknown {
    /// Value reference of the variable.
    pub value_reference: u32,
    /// Value references that it depends on. None: on everything it may depend on.
    pub dependencies: Option<Vec<u32>>,
    /// Line of the entry.
    pub line: u32,
}
