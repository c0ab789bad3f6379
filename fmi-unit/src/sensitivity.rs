//! Directional and adjoint derivatives (FMI 2.0.4 sec 2.1.9, FMI 3.0.2 sec 2.2.11).
//!
//! Both are products with the matrix of partial derivatives, made column by column: one evaluation of
//! [`Unit::tangent`] for each element of the knowns.

use std::fmt;

use crate::access::{Addressing, element, length, store};
use crate::instance::Instance;
use crate::legality::Mode;
use crate::model::{Causality, Kind, Variability, Variable, Variables};
use crate::transfer::{Element, Float64, Transfer};
use crate::unit::{Failure, Unit};

/// Step of a difference, relative to the value: the cube root of the rounding.
const STEP: f64 = 6e-6;
/// Values below this are perturbed as if they were as large as this.
const LEAST: f64 = 1e-3;

/// Room for a column of the matrix, made when the instance is.
pub(crate) struct Columns<V> {
    /// A direction: zero but while a column is made.
    direction: V,
    /// Derivatives in that direction, or values on either side of the present ones.
    sides: [V; 2],
}

impl<V: Variables> Columns<V> {
    pub(crate) fn new() -> Box<Self> {
        let zeros = || zeros(V::default());
        Box::new(Self {
            direction: zeros(),
            sides: [zeros(), zeros()],
        })
    }

    /// Gives the arrays the sizes that those of `now` have, if they differ.
    fn fit(&mut self, now: &V) {
        let differs = |v: &Variable| length(&self.direction, v) != length(now, v);
        if V::MODEL.variables.iter().any(differs) {
            let zeros = zeros(now.clone());
            self.sides = [zeros.clone(), zeros.clone()];
            self.direction = zeros;
        }
    }
}

/// `values` with all numbers zero.
fn zeros<V: Variables>(mut values: V) -> V {
    for variable in V::MODEL.variables {
        for index in 0..length(&values, variable) {
            if variable.kind == Kind::Float64 && variable.causality != Causality::Independent {
                let zero = Element::Float64(0.0);
                // Every variable but the independent one has storage.
                let _ = store(&mut values, variable, index, zero);
            }
        }
    }
    values
}

/// Which of the two products.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Product {
    /// Matrix times seed: a seed for each known, a sensitivity for each unknown.
    Directional,
    /// Seed times matrix: a seed for each unknown, a sensitivity for each known.
    Adjoint,
}

/// What a variable is to a derivative.
#[derive(Clone, Copy)]
enum Role {
    Unknown,
    Known,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "unknown",
            Self::Known => "known",
        })
    }
}

impl<U: Unit> Instance<U> {
    /// Multiplies the partial derivatives of the unknowns by the knowns with `seed`. O(elements of knowns ·
    /// (cost of the right-hand side + elements of unknowns)).
    pub(crate) fn sensitivity(
        &mut self,
        product: Product,
        [unknowns, knowns]: [&[u32]; 2],
        seed: &[f64],
        sensitivity: &mut [f64],
        addressing: Addressing,
    ) -> Result<(), Failure> {
        let Some(mut room) = self.columns.take() else {
            return Err(Failure("derivatives are not provided".into()));
        };
        let outcome = self.multiply(
            &mut room,
            product,
            [unknowns, knowns],
            seed,
            sensitivity,
            addressing,
        );
        self.columns = Some(room);
        outcome
    }

    fn multiply(
        &mut self,
        room: &mut Columns<U::Variables>,
        product: Product,
        [unknowns, knowns]: [&[u32]; 2],
        seed: &[f64],
        sensitivity: &mut [f64],
        addressing: Addressing,
    ) -> Result<(), Failure> {
        let (rows, columns) = match product {
            Product::Directional => (sensitivity.len(), seed.len()),
            Product::Adjoint => (seed.len(), sensitivity.len()),
        };
        self.check(unknowns, rows, addressing, Role::Unknown)?;
        self.check(knowns, columns, addressing, Role::Known)?;
        self.refresh();
        sensitivity.fill(0.0);
        room.fit(&self.now.variables);
        for (j, (known, index)) in self.elements(knowns, addressing).enumerate() {
            let column = self.column(room, known, index, self.elements(unknowns, addressing));
            for (i, partial) in column.enumerate() {
                match product {
                    Product::Directional => sensitivity[i] += partial? * seed[j],
                    Product::Adjoint => sensitivity[j] += partial? * seed[i],
                }
            }
        }
        Ok(())
    }

    /// Partial derivatives of `unknowns` by one known.
    ///
    /// Until the unit is set up these are central differences of the initial outputs, which follow from
    /// parameters and inputs alone.
    fn column<'a>(
        &self,
        room: &'a mut Columns<U::Variables>,
        known: &'static Variable,
        index: usize,
        unknowns: impl Iterator<Item = (&'static Variable, usize)> + 'a,
    ) -> impl Iterator<Item = Result<f64, Failure>> + 'a {
        let Columns { direction, sides } = room;
        let now = &self.now.variables;
        let set = |values: &mut U::Variables, value: f64| {
            // Checked to be a number before.
            let _ = store(values, known, index, Element::Float64(value));
        };
        let mut width = None;
        if let Some(unit) = &self.unit {
            set(direction, 1.0);
            unit.tangent(now, direction, &mut sides[0]);
            set(direction, 0.0);
        } else {
            let value = number(now, known, index).unwrap_or(0.0);
            let step = STEP * value.abs().max(LEAST);
            let ends = [value + step, value - step];
            for (values, end) in sides.iter_mut().zip(ends) {
                values.clone_from(now);
                set(values, end);
                U::initial_outputs(values);
            }
            width = Some(ends[0] - ends[1]);
        }
        let [first, second] = &*sides;
        unknowns.map(move |(unknown, index)| {
            let value = number(first, unknown, index)?;
            match width {
                None => Ok(value),
                Some(width) => Ok((value - number(second, unknown, index)?) / width),
            }
        })
    }

    /// Whether derivatives of or by these variables exist, and as many numbers are given as they have
    /// elements.
    fn check(
        &self,
        references: &[u32],
        count: usize,
        addressing: Addressing,
        role: Role,
    ) -> Result<(), Failure> {
        let model = U::Variables::MODEL;
        let initial = matches!(self.now.mode, Mode::Instantiated | Mode::Initialization);
        let mut total = 0;
        for &reference in references {
            let (variable, _, elements) = self.locate(reference, addressing)?;
            let reference = variable.value_reference;
            let (is_state, is_derivative) = (
                model.states.contains(&reference),
                model.derivatives.contains(&reference),
            );
            let continuous = variable.variability == Variability::Continuous;
            let admissible = match (role, variable.causality) {
                (Role::Known, Causality::Input) => continuous,
                (Role::Known, Causality::Parameter) => initial,
                (Role::Known, _) => is_state && !initial,
                (Role::Unknown, Causality::Output) => continuous,
                (Role::Unknown, Causality::Local) => is_derivative || is_state && initial,
                (Role::Unknown, _) => false,
            };
            if !admissible || variable.kind != Kind::Float64 {
                let (name, mode) = (variable.name, self.now.mode);
                return Err(Failure(format!("{name} is no {role} in {mode}")));
            }
            total += elements;
        }
        if total == count {
            return Ok(());
        }
        Err(Failure(format!("{count} values for {total} {role}s")))
    }
}

fn number<V: Variables>(
    values: &V,
    variable: &'static Variable,
    index: usize,
) -> Result<f64, Failure> {
    let value = element(values, variable, index)?;
    Float64::outward(value).ok_or_else(|| Failure(format!("{} is no number", variable.name)))
}
