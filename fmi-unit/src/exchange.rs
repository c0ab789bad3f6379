//! Model Exchange: the importer integrates, the instance answers for states, derivatives and events.

use crate::clock::Ticks;
use crate::instance::{Instance, Interface, rounding};
use crate::legality::Mode;
use crate::model::{Values, Variables};
use crate::unit::{Failure, Unit};

/// How close to an event instant the importer must stop for the event to be due \[s\].
const EVENT_TOLERANCE: f64 = 1e-9;

/// Outcome of an event iteration.
pub(crate) struct EventInfo {
    /// Another event is already due.
    pub(crate) again: bool,
    /// The continuous states jumped.
    pub(crate) states_changed: bool,
    /// Next time event \[s\], if any.
    pub(crate) next: Option<f64>,
}

impl<U: Unit> Instance<U> {
    /// Before the unit is set up, this gives the start time.
    pub(crate) fn set_time(&mut self, time: f64) -> Result<(), Failure> {
        if !time.is_finite() {
            return Err(Failure(format!("time = {time} s is not finite")));
        }
        if self.unit.is_none() {
            self.now.start = time;
        }
        self.now.time = time;
        self.now.stale = true;
        Ok(())
    }

    pub(crate) fn set_states(&mut self, states: &[f64]) -> Result<(), Failure> {
        check_count::<U>(states.len())?;
        if let Some(unit) = &mut self.unit {
            unit.set_continuous_states(states);
        }
        self.now.stale = true;
        Ok(())
    }

    pub(crate) fn get_states(&mut self, states: &mut [f64]) -> Result<(), Failure> {
        check_count::<U>(states.len())?;
        match &self.unit {
            Some(unit) => unit.continuous_states(states),
            None => self.initial(U::Variables::MODEL.states, states),
        }
        Ok(())
    }

    pub(crate) fn get_derivatives(&mut self, derivatives: &mut [f64]) -> Result<(), Failure> {
        check_count::<U>(derivatives.len())?;
        match &self.unit {
            Some(unit) => unit.derivatives(&self.now.variables, derivatives),
            None => self.initial(U::Variables::MODEL.derivatives, derivatives),
        }
        check_finite::<U>(derivatives)
    }

    /// Values of variables: before the unit exists, states and derivatives are among the initial outputs.
    fn initial(&mut self, references: &[u32], values: &mut [f64]) {
        self.refresh();
        for (value, &reference) in values.iter_mut().zip(references) {
            if let Some(Values::Float64(&[initial, ..])) = self.now.variables.values(reference) {
                *value = initial;
            }
        }
    }

    pub(crate) fn get_nominals(&self, nominals: &mut [f64]) -> Result<(), Failure> {
        check_count::<U>(nominals.len())?;
        nominals.fill(1.0);
        Ok(())
    }

    /// Event indicators are variables of the unit.
    pub(crate) fn get_event_indicators(&mut self, indicators: &mut [f64]) -> Result<(), Failure> {
        let references = U::Variables::MODEL.event_indicators;
        if indicators.len() != references.len() {
            let (n, own) = (indicators.len(), references.len());
            return Err(Failure(format!("{n} values for {own} event indicators")));
        }
        self.initial(references, indicators);
        Ok(())
    }

    pub(crate) fn enter_event_mode(&mut self) -> Result<(), Failure> {
        if self.now.interface == Interface::CoSimulation {
            return Err(Failure("eventModeUsed was false at instantiation".into()));
        }
        self.now.mode = Mode::Event;
        Ok(())
    }

    pub(crate) fn enter_continuous_time(&mut self) -> Result<(), Failure> {
        if self.now.interface != Interface::ModelExchange {
            return Err(Failure("this is for Model Exchange".into()));
        }
        self.now.ticks = Ticks::default();
        self.now.mode = Mode::ContinuousTime;
        Ok(())
    }

    pub(crate) fn enter_step_mode(&mut self) -> Result<(), Failure> {
        match self.now.interface {
            Interface::EventfulCoSimulation => {
                self.now.ticks = Ticks::default();
                self.now.mode = Mode::Step;
                Ok(())
            }
            Interface::CoSimulation => {
                Err(Failure("eventModeUsed was false at instantiation".into()))
            }
            _ => Err(Failure("this is for Co-Simulation".into())),
        }
    }

    /// Returns whether the importer must enter Event Mode: the unit asks for it, or a time event is due
    /// and the importer has not noticed.
    pub(crate) fn completed_step(&mut self) -> Result<bool, Failure> {
        let time = self.now.time;
        let asked = self.act(|unit, variables, _| Ok(unit.completed_step(variables, time)))?;
        self.now.step_event |= asked;
        let next = self.next_event()?;
        Ok(self.now.step_event || self.is_due(next))
    }

    /// Carries out one event: the ticks of clocks, or one that is due.
    pub(crate) fn update_discrete(&mut self) -> Result<EventInfo, Failure> {
        let time = self.now.time;
        let next = self.next_event()?;
        let timed = self.is_due(next);
        let mut states_changed = false;
        let ticks = std::mem::take(&mut self.now.ticks);
        if timed || self.now.step_event || !ticks.is_empty() {
            self.remember_states(0);
            if !ticks.is_empty() {
                self.act(|unit, variables, log| unit.tick(variables, ticks, time, log))?;
            } else if timed {
                self.timed_event(next)?;
            } else {
                self.act(|unit, variables, log| unit.event(variables, time, log))?;
            }
            self.now.step_event = false;
            self.remember_states(1);
            let [before, after] = &self.states;
            states_changed = before
                .iter()
                .zip(after)
                .any(|(a, b)| a.to_bits() != b.to_bits());
        }
        let next = self.next_event()?;
        Ok(EventInfo {
            again: self.is_due(next),
            states_changed,
            next: next.is_finite().then_some(next),
        })
    }

    pub(crate) fn is_due(&self, event: f64) -> bool {
        event <= self.now.time + EVENT_TOLERANCE + rounding(self.now.time)
    }

    fn remember_states(&mut self, which: usize) {
        if let Some(unit) = &self.unit {
            unit.continuous_states(&mut self.states[which]);
        }
    }
}

/// An input that is no number must not pass into the importer's solver unnoticed.
fn check_finite<U: Unit>(derivatives: &[f64]) -> Result<(), Failure> {
    let model = U::Variables::MODEL;
    let Some(index) = derivatives.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    let (value, reference) = (derivatives[index], model.derivatives[index]);
    let (name, unit) = model
        .find(reference)
        .map_or(("a derivative", ""), |(v, _)| (v.name, v.unit));
    Err(Failure(format!(
        "{name} = {value} {unit} is not finite: check the inputs and the states"
    )))
}

fn check_count<U: Unit>(count: usize) -> Result<(), Failure> {
    let states = U::Variables::MODEL.states.len();
    if count == states {
        return Ok(());
    }
    Err(Failure(format!(
        "{count} values for {states} continuous states"
    )))
}
