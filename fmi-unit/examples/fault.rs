//! A unit that fails when told to, for tests of whoever imports it: the variable table that a build
//! script makes elsewhere is written by hand here. Its descriptions are `fault.fmi2.xml` and
//! `fault.fmi3.xml`.

use fmi_unit::{
    Causality, Failure, Kind, Log, Model, Unit, Values, ValuesMut, Variability, Variable, Variables,
};
use serde::{Deserialize, Serialize};

/// Values of [`FaultVariables::fault`].
const ERROR: i32 = 1;
const PANIC: i32 = 2;

/// The variables.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct FaultVariables {
    /// Input: what the next step does, 0 for nothing special.
    fault: i32,
    /// Output: steps so far.
    steps: i32,
}

const fn integer(name: &'static str, value_reference: u32, causality: Causality) -> Variable {
    Variable {
        name,
        value_reference,
        dimension: None,
        kind: Kind::Int32,
        causality,
        variability: Variability::Discrete,
        min: i32::MIN as f64,
        max: i32::MAX as f64,
        unit: "",
        items: &[],
    }
}

static MODEL: Model = Model {
    name: "fault",
    token: "{fault}",
    variables: &[
        integer("fault", 1, Causality::Input),
        integer("steps", 2, Causality::Output),
    ],
    states: &[],
    derivatives: &[],
    event_indicators: &[],
    clocks: &[],
    event_mode: false,
    scheduled_execution: false,
    model_exchange: false,
    directional_derivatives: false,
    log_categories: &["logStatusError", "logStatusWarning", "logStatusFatal"],
};

impl Variables for FaultVariables {
    const MODEL: &'static Model = &MODEL;

    fn values(&self, value_reference: u32) -> Option<Values<'_>> {
        match value_reference {
            1 => Some(Values::Int32(std::slice::from_ref(&self.fault))),
            2 => Some(Values::Int32(std::slice::from_ref(&self.steps))),
            _ => None,
        }
    }

    fn values_mut(&mut self, value_reference: u32) -> Option<ValuesMut<'_>> {
        match value_reference {
            1 => Some(ValuesMut::Int32(std::slice::from_mut(&mut self.fault))),
            2 => Some(ValuesMut::Int32(std::slice::from_mut(&mut self.steps))),
            _ => None,
        }
    }

    fn resize(&mut self) {}
}

/// The unit.
pub struct Fault;

impl Unit for Fault {
    type Variables = FaultVariables;
    type State = ();
    type Job = ();

    fn initial_outputs(_: &mut FaultVariables) {}

    fn new(_: &mut FaultVariables, _: f64) -> Result<Self, Vec<Failure>> {
        Ok(Self)
    }

    fn state(&self) -> &() {
        &()
    }

    fn set_state(&mut self, (): &()) -> Result<(), Failure> {
        Ok(())
    }

    fn next_event(&self) -> f64 {
        f64::INFINITY
    }

    fn event(&mut self, _: &mut FaultVariables, _: f64, _: &mut Log<'_>) -> Result<(), Failure> {
        Ok(())
    }

    fn advance(
        &mut self,
        variables: &mut FaultVariables,
        from: f64,
        _: f64,
        _: &mut Log<'_>,
    ) -> Result<(), Failure> {
        variables.steps = variables.steps.saturating_add(1);
        match variables.fault {
            ERROR => Err(Failure(format!("told to fail at {from} s"))),
            PANIC => panic!("told to panic at {from} s"),
            _ => Ok(()),
        }
    }
}

fmi_unit::export!(Fault);
