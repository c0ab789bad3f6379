//! Reading and writing of variables by value reference, in the types of either version.

use std::fmt;

use crate::instance::Instance;
use crate::legality::Mode;
use crate::model::{Causality, Values, ValuesMut, Variability, Variable, Variables};
use crate::transfer::{Element, Transfer};
use crate::unit::{Failure, Unit};

/// What a value reference names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Addressing {
    /// FMI 2.0: one element.
    Elements,
    /// FMI 3.0: a variable with all its elements.
    Variables,
}

impl<U: Unit> Instance<U> {
    /// Reads variables, those with several elements in a row.
    pub(crate) fn get<T: Transfer>(
        &mut self,
        references: &[u32],
        values: &mut [T::Foreign],
        addressing: Addressing,
    ) -> Result<(), Failure> {
        self.check_count(references, values.len(), addressing)?;
        let mut targets = values.iter_mut();
        for &reference in references {
            let (variable, first, count) = self.locate(reference, addressing)?;
            let given = matches!(
                variable.causality,
                Causality::Parameter
                    | Causality::StructuralParameter
                    | Causality::Input
                    | Causality::Independent
            );
            if !given {
                self.refresh();
            }
            for (index, target) in (first..first + count).zip(&mut targets) {
                let element = self.element(variable, index)?;
                *target = T::outward(element).ok_or_else(|| mismatch(variable))?;
            }
        }
        Ok(())
    }

    /// Writes variables; all or, if one of them cannot be written, none.
    pub(crate) fn set<T: Transfer>(
        &mut self,
        references: &[u32],
        values: &[T::Foreign],
        addressing: Addressing,
    ) -> Result<(), Failure> {
        self.check_count(references, values.len(), addressing)?;
        for stored in [false, true] {
            let mut sources = values.iter();
            for &reference in references {
                let (variable, first, count) = self.locate(reference, addressing)?;
                for (index, &source) in (first..first + count).zip(&mut sources) {
                    let element =
                        T::inward(source, variable.kind).ok_or_else(|| mismatch(variable))?;
                    if !stored {
                        self.check_settable(variable, index, element)?;
                        check_admissible(variable, index, element)?;
                    } else if let Some(position) = self.state_position(variable, index) {
                        self.set_state(position, element);
                    } else {
                        store(&mut self.now.variables, variable, index, element)?;
                    }
                }
            }
        }
        self.now.stale = true;
        Ok(())
    }

    /// Which of the continuous states a variable is.
    fn state(variable: &Variable, index: usize) -> Option<usize> {
        let reference = variable.value_reference + index as u32;
        let mut states = U::Variables::MODEL.states.iter();
        states.position(|&state| state == reference)
    }

    /// The same where it can be set as one: in Continuous-Time Mode (FMI 3.0.2 sec 3.2.1; CasADi does it in
    /// FMI 2.0 too).
    fn state_position(&self, variable: &Variable, index: usize) -> Option<usize> {
        let settable = self.now.mode == Mode::ContinuousTime;
        settable.then(|| Self::state(variable, index)).flatten()
    }

    /// Sets one of the continuous states, as [`Self::set_states`] sets all. O(states).
    fn set_state(&mut self, position: usize, element: Element) {
        let [states, _] = &mut self.states;
        if let (Some(unit), Element::Float64(value)) = (&mut self.unit, element) {
            unit.continuous_states(states);
            states[position] = value;
            unit.set_continuous_states(states);
        }
    }

    /// Inputs and tunable parameters can always be set, fixed ones until initialization is done, structural ones
    /// in Configuration Mode, where nothing else can. Otherwise only their present value is accepted, which
    /// importers like to send once more.
    fn check_settable(
        &self,
        variable: &'static Variable,
        index: usize,
        element: Element,
    ) -> Result<(), Failure> {
        if self.state_position(variable, index).is_some() {
            return Ok(());
        }
        let (name, mode) = (Name(variable, index), self.now.mode);
        let structural = variable.causality == Causality::StructuralParameter;
        if mode == Mode::Configuration && !structural {
            return Err(Failure(format!(
                "{name} cannot be set in {mode}: it is no structural parameter"
            )));
        }
        match (variable.causality, variable.variability) {
            (Causality::StructuralParameter, _) => {
                if mode == Mode::Configuration || self.element(variable, index)? == element {
                    Ok(())
                } else {
                    Err(Failure(format!(
                        "{name} is a structural parameter: it can be set in Configuration Mode only, not in {mode}"
                    )))
                }
            }
            (Causality::Input, _) | (Causality::Parameter, Variability::Tunable) => Ok(()),
            (Causality::Parameter, Variability::Fixed) => {
                let early = matches!(mode, Mode::Instantiated | Mode::Initialization);
                if early || self.element(variable, index)? == element {
                    Ok(())
                } else {
                    Err(Failure(format!(
                        "{name} is fixed: it can be set until the end of initialization only"
                    )))
                }
            }
            _ if Self::state(variable, index).is_some() => Err(Failure(format!(
                "{name} is a continuous state: it cannot be set in {mode}, only in Continuous-Time Mode of Model Exchange"
            ))),
            (causality, _) => Err(Failure(format!(
                "{name} cannot be set: its causality is {causality:?}"
            ))),
        }
    }

    fn element(&self, variable: &'static Variable, index: usize) -> Result<Element, Failure> {
        if variable.causality == Causality::Independent {
            return Ok(Element::Float64(self.now.time));
        }
        element(&self.now.variables, variable, index)
    }

    /// The elements that references name, one after the other; unknown ones are left out.
    pub(crate) fn elements(
        &self,
        references: &[u32],
        addressing: Addressing,
    ) -> impl Iterator<Item = (&'static Variable, usize)> {
        references
            .iter()
            .flat_map(move |&reference| {
                let (variable, first, count) = self.locate(reference, addressing).ok()?;
                Some((first..first + count).map(move |index| (variable, index)))
            })
            .flatten()
    }

    /// The variable that a reference names, its first element meant and their number.
    pub(crate) fn locate(
        &self,
        reference: u32,
        addressing: Addressing,
    ) -> Result<(&'static Variable, usize, usize), Failure> {
        let Some((variable, index)) = U::Variables::MODEL.find(reference) else {
            return Err(Failure(format!("value reference {reference} is unknown")));
        };
        let length = length(&self.now.variables, variable);
        match addressing {
            Addressing::Elements if index < length => Ok((variable, index, 1)),
            // A state of FMI 3.0 may have brought a smaller array.
            Addressing::Elements => Err(Failure(format!(
                "value reference {reference} is unknown: {} has {length} elements",
                variable.name
            ))),
            Addressing::Variables if index == 0 => Ok((variable, 0, length)),
            Addressing::Variables => Err(Failure(format!(
                "value reference {reference} is unknown: it names an element of {}, an array with value reference {}",
                variable.name, variable.value_reference
            ))),
        }
    }

    /// Whether as many values are given as the variables have elements.
    fn check_count(
        &self,
        references: &[u32],
        values: usize,
        addressing: Addressing,
    ) -> Result<(), Failure> {
        let mut elements = 0;
        let mut array = None;
        for &reference in references {
            let (variable, _, count) = self.locate(reference, addressing)?;
            elements += count;
            array = array.or(variable.dimension.map(|_| (variable.name, count)));
        }
        if elements == values {
            return Ok(());
        }
        let array = array.map(|(name, count)| format!(": {name} has {count}"));
        let array = array.unwrap_or_default();
        Err(Failure(format!(
            "{values} values for {elements} elements{array}"
        )))
    }
}

/// Writes one element.
pub(crate) fn store<V: Variables>(
    variables: &mut V,
    variable: &'static Variable,
    index: usize,
    element: Element,
) -> Result<(), Failure> {
    match (variables.values_mut(variable.value_reference), element) {
        (Some(ValuesMut::Float64(slots)), Element::Float64(value)) => put(slots, index, value),
        (Some(ValuesMut::Int32(slots)), Element::Int32(value)) => put(slots, index, value),
        (Some(ValuesMut::UInt64(slots)), Element::UInt64(value)) => put(slots, index, value),
        (Some(ValuesMut::Boolean(slots)), Element::Boolean(value)) => put(slots, index, value),
        (Some(ValuesMut::Enumeration(slots)), Element::Enumeration(value)) => {
            put(slots, index, value)
        }
        _ => None,
    }
    .ok_or_else(|| mismatch(variable))
}

fn put<T>(slots: &mut [T], index: usize, value: T) -> Option<()> {
    *slots.get_mut(index)? = value;
    Some(())
}

/// Reads one element.
pub(crate) fn element<V: Variables>(
    variables: &V,
    variable: &'static Variable,
    index: usize,
) -> Result<Element, Failure> {
    match variables.values(variable.value_reference) {
        Some(Values::Float64(values)) => values.get(index).copied().map(Element::Float64),
        Some(Values::Int32(values)) => values.get(index).copied().map(Element::Int32),
        Some(Values::UInt64(values)) => values.get(index).copied().map(Element::UInt64),
        Some(Values::Boolean(values)) => values.get(index).copied().map(Element::Boolean),
        Some(Values::Enumeration(values)) => values.get(index).copied().map(Element::Enumeration),
        None => None,
    }
    .ok_or_else(|| mismatch(variable))
}

fn is_parameter(variable: &Variable) -> bool {
    matches!(
        variable.causality,
        Causality::Parameter | Causality::StructuralParameter
    )
}

/// Number of elements that a variable has now.
pub(crate) fn length<V: Variables>(variables: &V, variable: &Variable) -> usize {
    let values = variables.values(variable.value_reference);
    // The independent variable has no storage.
    values.map_or(1, Values::len)
}

/// Whether every array has the size that is declared, or that its structural parameter says.
pub(crate) fn check_sizes<V: Variables>(variables: &V) -> bool {
    let is_right = |variable: &Variable| {
        let size = match variable.dimension.and_then(|d| d.parameter) {
            None => Some(variable.length().into()),
            Some(parameter) => match variables.values(parameter) {
                Some(Values::UInt64(&[size])) => Some(size),
                _ => None,
            },
        };
        size == Some(length(variables, variable) as u64)
    };
    V::MODEL.variables.iter().all(is_right)
}

/// Whether every parameter is within its range.
pub(crate) fn check_parameters<V: Variables>(variables: &V) -> Result<(), Failure> {
    for variable in V::MODEL.variables {
        if is_parameter(variable) {
            for index in 0..length(variables, variable) {
                check_admissible(variable, index, element(variables, variable, index)?)?;
            }
        }
    }
    Ok(())
}

/// Whether every output is a number: an importer may read it before the next step makes it anew.
pub(crate) fn check_outputs<V: Variables>(variables: &V) -> Result<(), Failure> {
    let outputs = V::MODEL.variables.iter();
    for variable in outputs.filter(|v| v.causality == Causality::Output) {
        for index in 0..length(variables, variable) {
            if let Element::Float64(value) = element(variables, variable, index)?
                && !value.is_finite()
            {
                return Err(Failure(format!(
                    "the serialized state gives {} = {value}{}: must be finite",
                    Name(variable, index),
                    Suffix(variable.unit)
                )));
            }
        }
    }
    Ok(())
}

/// Whether all parameters of two sets of values are the same.
pub(crate) fn same_parameters<V: Variables>(a: &V, b: &V) -> bool {
    V::MODEL
        .variables
        .iter()
        .filter(|v| is_parameter(v))
        .all(|v| a.values(v.value_reference) == b.values(v.value_reference))
}

/// Parameters must be finite and within their range, enumerations must be one of their items. Inputs
/// may be any number: the unit handles them.
fn check_admissible(
    variable: &'static Variable,
    index: usize,
    element: Element,
) -> Result<(), Failure> {
    let value = match element {
        Element::Boolean(_) => return Ok(()),
        Element::Enumeration(value) => {
            if variable.items.iter().any(|&(item, _)| item == value) {
                return Ok(());
            }
            let items: Vec<_> = variable
                .items
                .iter()
                .map(|(item, name)| format!("{item} ({name})"))
                .collect();
            return Err(Failure(format!(
                "{} = {value} is none of {}",
                Name(variable, index),
                items.join(", ")
            )));
        }
        Element::Float64(value) => value,
        Element::Int32(value) => value.into(),
        Element::UInt64(value) => value as f64,
    };
    let within = value.is_finite() && (variable.min..=variable.max).contains(&value);
    if within || !is_parameter(variable) {
        return Ok(());
    }
    let unit = Suffix(variable.unit);
    Err(Failure(format!(
        "{} = {}{unit} is outside [{}, {}]{unit}",
        Name(variable, index),
        Number(value),
        Number(variable.min),
        Number(variable.max),
    )))
}

fn mismatch(variable: &Variable) -> Failure {
    Failure(format!("{} is of type {:?}", variable.name, variable.kind))
}

/// Name of an element, subscripts counted from 1.
struct Name(&'static Variable, usize);

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(variable, index) = self;
        if variable.dimension.is_some() {
            write!(f, "{}[{}]", variable.name, index + 1)
        } else {
            f.write_str(variable.name)
        }
    }
}

/// A unit behind its number.
struct Suffix(&'static str);

impl fmt::Display for Suffix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

/// A number as an engineer writes it: 1e-9, 0.25, 1e6.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size.is_finite() && size != 0.0 && !(1e-3..1e5).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}
