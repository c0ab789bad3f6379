//! What the host needs to know of a `modelDescription.xml`, the same for FMI 2.0 and 3.0.
//!
//! The files of both versions are parsed and validated by `fmi-rs`; [`super::fmi2_description`] and
//! [`super::fmi3_description`] translate. Scalars are addressed by name: an array `a` of FMI 3.0 has the
//! elements `a[1]`, `a[2]`, … (`a[1,2]` in two dimensions), which is how FMI 2.0 spells them too.

use super::structure::{Dependencies, Units};
use super::text::{short, similar};
use super::value::{Kind, Value};
use std::collections::HashMap;
use std::fmt;

/// Major version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    V2,
    /// FMI 3.0.
    V3,
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

impl fmt::Display for Causality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Independent => "independent variable",
            Self::Parameter => "parameter",
            Self::StructuralParameter => "structural parameter",
            Self::CalculatedParameter => "calculated parameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local variable",
        })
    }
}

/// One item of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Name.
    pub name: String,
    /// Value.
    pub value: i64,
}

/// Elements of an array that the host works with: 8 MiB of numbers.
pub(super) const MAX_ELEMENTS: usize = 1 << 20;

/// One variable: a scalar, or an array of FMI 3.0.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Name, without subscripts if it is an array.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub causality: Causality,
    /// Whether it never changes after initialisation (variability constant or fixed).
    pub constant: bool,
    /// Whether the importer may set a value before initialisation.
    pub settable: bool,
    /// Unit, if one is declared.
    pub unit: Option<String>,
    /// Smallest admissible value, if one is declared.
    pub min: Option<f64>,
    /// Largest admissible value, if one is declared.
    pub max: Option<f64>,
    /// Start values as they are written: one for each element, one for all, or none.
    pub start: Vec<String>,
    /// Size of each dimension; empty for a scalar.
    pub dimensions: Vec<usize>,
    /// Value reference of the structural parameter that each dimension follows; none for one that is fixed.
    pub sized_by: Vec<Option<u32>>,
    /// Description.
    pub description: String,
    /// Items of an enumeration.
    pub items: Vec<Item>,
}

impl Variable {
    /// Number of elements; 1 for a scalar.
    pub fn length(&self) -> usize {
        self.dimensions.iter().product()
    }

    /// [`length`](Self::length), unless it overflows or is beyond [`MAX_ELEMENTS`]: dimensions come from
    /// the file.
    pub(super) fn elements(&self) -> Option<usize> {
        let product = self
            .dimensions
            .iter()
            .try_fold(1usize, |product, size| product.checked_mul(*size));
        product.filter(|count| *count <= MAX_ELEMENTS)
    }

    /// The declared start value of an element.
    pub fn start_of(&self, element: usize) -> Option<Value> {
        let text = match self.start.as_slice() {
            [one] => one,
            many => many.get(element)?,
        };
        Value::parse(text, self).ok()
    }

    /// The range for messages, like `[0, 1] rad`.
    pub fn range(&self) -> String {
        let bound = |bound: Option<f64>, open: &str| bound.map_or(open.to_owned(), short);
        let unit = self
            .unit
            .as_deref()
            .map_or(String::new(), |u| format!(" {u}"));
        format!(
            "[{}, {}]{unit}",
            bound(self.min, "-inf"),
            bound(self.max, "inf")
        )
    }
}

/// One scalar of a [`Description`]: a variable and an element of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Scalar {
    /// Index into [`Description::variables`].
    pub variable: usize,
    /// Element, from 0, in row-major order; 0 for a scalar variable.
    pub element: usize,
}

/// What the host uses of Co-Simulation.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct CoSimulation {
    pub model_identifier: String,
    pub needs_execution_tool: bool,
    pub can_be_instantiated_only_once_per_process: bool,
    pub can_get_and_set_state: bool,
    pub can_serialize_state: bool,
    pub can_handle_variable_step: bool,
    pub fixed_internal_step: Option<f64>,
    pub has_event_mode: bool,
}

/// Default experiment, as far as it is declared \[s\].
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct DefaultExperiment {
    pub start_time: Option<f64>,
    pub stop_time: Option<f64>,
    pub tolerance: Option<f64>,
    pub step_size: Option<f64>,
}

/// What an FMU says of itself.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names are the standard's")]
pub struct Description {
    pub version: Version,
    pub fmi_version: String,
    pub model_name: String,
    /// `guid` in FMI 2.0, `instantiationToken` in 3.0.
    pub token: String,
    pub description: String,
    pub model_version: String,
    pub author: String,
    pub license: String,
    pub generation_tool: String,
    pub generation_date: String,
    pub model_exchange: bool,
    pub scheduled_execution: bool,
    pub co_simulation: Option<CoSimulation>,
    pub default_experiment: DefaultExperiment,
    pub log_categories: Vec<String>,
    pub variables: Vec<Variable>,
    pub units: Units,
    pub dependencies: Dependencies,
    /// What its validation found. Shown, not refused: vendors' files are rarely spotless.
    pub problems: Vec<String>,
    pub(super) index: HashMap<String, usize>,
}

/// Why a name is no scalar of an FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameError {
    /// No variable has the name; the most similar names that exist.
    Unknown {
        /// At most three.
        similar: Vec<String>,
    },
    /// The name is that of an array: its elements can be addressed.
    Array {
        /// Name of the first element.
        first: String,
        /// Name of the last element.
        last: String,
    },
}

impl Description {
    /// The scalar called `name`.
    pub fn scalar(&self, name: &str) -> Result<Scalar, NameError> {
        if let Some(&variable) = self.index.get(name) {
            let dimensions = &self.variables[variable].dimensions;
            if dimensions.is_empty() {
                return Ok(Scalar {
                    variable,
                    element: 0,
                });
            }
            let last: Vec<_> = dimensions.iter().map(usize::to_string).collect();
            return Err(NameError::Array {
                first: format!("{name}[{}]", vec!["1"; dimensions.len()].join(",")),
                last: format!("{name}[{}]", last.join(",")),
            });
        }
        self.element(name).ok_or_else(|| NameError::Unknown {
            similar: similar(name, self.variables.iter().map(|v| v.name.as_str())),
        })
    }

    /// An array element `base[i,j]`, subscripts from 1.
    fn element(&self, name: &str) -> Option<Scalar> {
        let (base, subscripts) = name.strip_suffix(']')?.rsplit_once('[')?;
        let &variable = self.index.get(base)?;
        let dimensions = &self.variables[variable].dimensions;
        let subscripts: Vec<usize> = subscripts
            .split(',')
            .map(|s| s.trim().parse().ok())
            .collect::<Option<_>>()?;
        if dimensions.is_empty() || subscripts.len() != dimensions.len() {
            return None;
        }
        let mut element = 0;
        for (subscript, size) in subscripts.into_iter().zip(dimensions) {
            if subscript == 0 || subscript > *size {
                return None;
            }
            element = element * size + subscript - 1;
        }
        Some(Scalar { variable, element })
    }

    /// Name of a scalar, with subscripts for an element of an array.
    pub fn name_of(&self, scalar: Scalar) -> String {
        let variable = &self.variables[scalar.variable];
        let mut rest = scalar.element;
        let mut subscripts: Vec<String> = Vec::new();
        for size in variable.dimensions.iter().rev() {
            subscripts.push((rest % size + 1).to_string());
            rest /= size;
        }
        if subscripts.is_empty() {
            return variable.name.clone();
        }
        subscripts.reverse();
        format!("{}[{}]", variable.name, subscripts.join(","))
    }

    /// The variable that a scalar belongs to.
    pub fn variable(&self, scalar: Scalar) -> &Variable {
        &self.variables[scalar.variable]
    }

    /// The declared start value of the scalar called `name`.
    pub fn start(&self, name: &str) -> Option<Value> {
        let scalar = self.scalar(name).ok()?;
        self.variable(scalar).start_of(scalar.element)
    }

    /// The same with the sizes of arrays that follow from `values` of structural parameters.
    pub(super) fn resized(&self, values: &[(Scalar, Value)]) -> Self {
        let mut resized = self.clone();
        for (scalar, value) in values {
            let parameter = self.variable(*scalar).reference;
            let Value::Integer(number) = value else {
                continue;
            };
            for variable in &mut resized.variables {
                for (size, by) in variable.dimensions.iter_mut().zip(&variable.sized_by) {
                    if *by == Some(parameter) {
                        *size = usize::try_from(*number).unwrap_or(usize::MAX);
                    }
                }
            }
        }
        resized
    }

    /// All scalar variables of numeric type with the given causality. Arrays are left out.
    pub fn numeric_scalars(&self, causality: Causality) -> impl Iterator<Item = Scalar> {
        self.variables
            .iter()
            .enumerate()
            .filter(move |(_, v)| {
                v.causality == causality && v.dimensions.is_empty() && v.kind.is_numeric()
            })
            .map(|(variable, _)| Scalar {
                variable,
                element: 0,
            })
    }

    /// Names of the variables with the given causality whose values are numbers.
    pub fn names(&self, causality: Causality) -> Vec<&str> {
        self.variables
            .iter()
            .filter(|v| v.causality == causality && v.kind.is_numeric())
            .map(|v| v.name.as_str())
            .collect()
    }
}

#[cfg(test)]
pub(crate) mod tests;
