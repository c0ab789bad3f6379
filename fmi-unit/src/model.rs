//! What a unit declares about itself: the table that the build makes from the model description.
//!
//! Nothing here is written by hand for a unit; `build.rs` generates a [`Model`] and a type that
//! implements [`Variables`] from `modelDescription/<unit>.xml`.

/// Type of a variable (FMI 3.0 sec 2.2.4; FMI 2.0 maps `Int32` to Integer and drops the widths).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 64-bit floating point; Real in FMI 2.0.
    Float64,
    /// 32-bit integer; Integer in FMI 2.0.
    Int32,
    /// Unsigned 64-bit integer: structural parameters, which FMI 2.0 does not have.
    UInt64,
    /// Truth value.
    Boolean,
    /// Enumeration: 64-bit in FMI 3.0, Integer in FMI 2.0.
    Enumeration,
}

/// Role of a variable (FMI 3.0 sec 2.4.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub enum Causality {
    Independent,
    Parameter,
    StructuralParameter,
    CalculatedParameter,
    Input,
    Output,
    Local,
}

/// When a variable may change (FMI 3.0 sec 2.4.7.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub enum Variability {
    Constant,
    Fixed,
    Tunable,
    Discrete,
    Continuous,
}

/// One declared variable.
#[derive(Debug)]
pub struct Variable {
    /// Name, as in the description, without subscripts.
    pub name: &'static str,
    /// First value reference; an array that has n elements at the start owns the n references from here on.
    pub value_reference: u32,
    /// Size; `None` for a scalar.
    pub dimension: Option<Dimension>,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Smallest admissible value.
    pub min: f64,
    /// Largest admissible value.
    pub max: f64,
    /// Unit; empty for types without one.
    pub unit: &'static str,
    /// Values of an enumeration, with the names of their items.
    pub items: &'static [(i64, &'static str)],
}

/// Size of an array.
#[derive(Clone, Copy, Debug)]
pub struct Dimension {
    /// Number of elements at the start; in FMI 2.0 always.
    pub size: u32,
    /// Value reference of the structural parameter that the size follows, if it may change.
    pub parameter: Option<u32>,
}

impl Variable {
    /// Number of elements at the start; 1 for a scalar.
    pub fn length(&self) -> u32 {
        self.dimension.map_or(1, |dimension| dimension.size)
    }
}

/// One declared input clock, with an interval that parameters fix (FMI 3.0 sec 2.2.8).
#[derive(Debug)]
pub struct Clock {
    /// Name, as in the description.
    pub name: &'static str,
    /// Value reference.
    pub value_reference: u32,
}

/// One declared unit.
#[derive(Debug)]
pub struct Model {
    /// `modelName` and `modelIdentifier`.
    pub name: &'static str,
    /// `instantiationToken` (FMI 3.0) and `guid` (FMI 2.0): a hash of the description.
    pub token: &'static str,
    /// All variables, by ascending value reference.
    pub variables: &'static [Variable],
    /// Value references of the continuous states.
    pub states: &'static [u32],
    /// Value references of their derivatives, in the same order.
    pub derivatives: &'static [u32],
    /// Value references of the event indicators, continuous variables each.
    pub event_indicators: &'static [u32],
    /// The input clocks, by ascending value reference.
    pub clocks: &'static [Clock],
    /// Whether Model Exchange is declared.
    pub model_exchange: bool,
    /// Whether Co-Simulation has an Event Mode.
    pub event_mode: bool,
    /// Whether Scheduled Execution is declared.
    pub scheduled_execution: bool,
    /// Whether directional and adjoint derivatives are declared.
    pub directional_derivatives: bool,
    /// Names of the log categories.
    pub log_categories: &'static [&'static str],
}

impl Model {
    /// Whether there are structural parameters, all of them fixed.
    pub(crate) fn is_configurable(&self) -> bool {
        let mut variables = self.variables.iter();
        variables.any(|v| v.causality == Causality::StructuralParameter)
    }

    /// The variable that owns `value_reference` and the element it names. O(log n).
    pub fn find(&self, value_reference: u32) -> Option<(&'static Variable, usize)> {
        let variables: &'static [Variable] = self.variables;
        let after = variables.partition_point(|v| v.value_reference <= value_reference);
        let variable = &variables[after.checked_sub(1)?];
        let element = value_reference - variable.value_reference;
        (element < variable.length()).then_some((variable, element as usize))
    }
}

/// Values of one variable, all its elements.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are those of Kind")]
pub enum Values<'a> {
    Float64(&'a [f64]),
    Int32(&'a [i32]),
    UInt64(&'a [u64]),
    Boolean(&'a [bool]),
    Enumeration(&'a [i64]),
}

impl Values<'_> {
    /// Number of elements.
    pub(crate) fn len(self) -> usize {
        match self {
            Self::Float64(values) => values.len(),
            Self::Int32(values) => values.len(),
            Self::UInt64(values) => values.len(),
            Self::Boolean(values) => values.len(),
            Self::Enumeration(values) => values.len(),
        }
    }
}

/// Values of one variable, to be written.
#[derive(Debug, PartialEq)]
#[allow(missing_docs, reason = "the names are those of Kind")]
pub enum ValuesMut<'a> {
    Float64(&'a mut [f64]),
    Int32(&'a mut [i32]),
    UInt64(&'a mut [u64]),
    Boolean(&'a mut [bool]),
    Enumeration(&'a mut [i64]),
}

/// The values of a unit's variables: a struct with a field for each, `arm.inertia` being `arm.inertia`.
/// `Default` holds the start values.
pub trait Variables:
    Default + Clone + Send + serde::Serialize + serde::de::DeserializeOwned + 'static
{
    /// What the build read from the model description.
    const MODEL: &'static Model;

    /// The values of the variable whose *first* value reference this is. The independent variable
    /// has no storage: time belongs to the instance.
    fn values(&self, value_reference: u32) -> Option<Values<'_>>;

    /// The same, to be written.
    fn values_mut(&mut self, value_reference: u32) -> Option<ValuesMut<'_>>;

    /// Gives each array the size that its structural parameter says. Elements that there were keep their
    /// values, new ones have their start value.
    fn resize(&mut self);
}
