//! The trait that a simulation unit implements to become an FMU.

use crate::clock::Ticks;
use crate::log::Log;
use crate::model::Variables;

/// Why a unit could not be set up or could not go on. Becomes status Error and a log message.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure(pub String);

/// A simulation unit for Co-Simulation, Model Exchange and Scheduled Execution.
///
/// The life of a unit, in the terms of FMI 3.0:
///
/// 1. *Instantiated, Initialization Mode*: only `Variables` exist. [`Unit::initial_outputs`] makes the
///    outputs that may be read there.
/// 2. Leaving Initialization Mode: [`Unit::new`] validates every parameter and allocates everything.
/// 3. *Running*: time is a sequence of **events**, instants at which the discrete part changes, and of
///    continuous stretches between them.
///    - Co-Simulation: the interface calls [`Unit::event`] for each event instant in `[t, t + h)` and
///      [`Unit::advance`] for the stretches between, with the inputs held at their values of `t`.
///    - Model Exchange: the importer integrates [`Unit::derivatives`] and stops at
///      [`Unit::next_event`], where [`Unit::event`] is called.
///    - With clocks, an importer of FMI 3.0 may make the events itself ([`Unit::tick`]), or run their
///      partitions as tasks of its own ([`Unit::activate`]).
///
/// Nothing that runs after `new` may allocate, lock, print or panic.
///
/// Outputs are refreshed when the importer reads them, so that [`Unit::event`] and [`Unit::advance`] must
/// not depend on output variables: what they need belongs to `State`.
///
/// A snapshot is `Variables` and `State`, so both together must hold everything that `new` does not
/// derive from the parameters.
pub trait Unit: Sized + Send + 'static {
    /// The variables that the build generated.
    type Variables: Variables;

    /// Everything that changes while the unit runs and is not a variable.
    type State: Clone + serde::Serialize + serde::de::DeserializeOwned + Send + 'static;

    /// Makes the outputs and local variables that can be read before the first step, from parameters
    /// and inputs alone.
    fn initial_outputs(variables: &mut Self::Variables);

    /// Sets the unit up from its parameters at time `start` \[s\]. Errors: every inadmissible
    /// parameter or combination, each with its name, value, admissible range and unit.
    fn new(variables: &mut Self::Variables, start: f64) -> Result<Self, Vec<Failure>>;

    /// What a model partition has to do that may be preempted; `()` if no clocks are declared.
    type Job: Send;

    /// The state, for a snapshot.
    fn state(&self) -> &Self::State;

    /// Whether a state that came from elsewhere can be one of this unit: its numbers are some that can be
    /// worked with, and its counts, where that matters, agree with each other.
    fn is_admissible(state: &Self::State) -> bool {
        let _ = state;
        true
    }

    /// Goes back to a snapshot. The unit was made by [`Unit::new`] from the snapshot's variables.
    fn set_state(&mut self, state: &Self::State) -> Result<(), Failure>;

    /// The next event instant \[s\], computed from an integer count, or infinity. At the start it may
    /// be the start itself.
    fn next_event(&self) -> f64;

    /// Carries out the discrete change at an event instant.
    fn event(
        &mut self,
        variables: &mut Self::Variables,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure>;

    /// If clocks are declared: the interval of the one at `clock` in `Model::clocks` \[s\].
    fn clock_interval(variables: &Self::Variables, clock: usize) -> f64 {
        let _ = (variables, clock);
        f64::NAN
    }

    /// If clocks are declared: sets the parameter that is the interval.
    fn set_clock_interval(variables: &mut Self::Variables, clock: usize, interval: f64) {
        let _ = (variables, clock, interval);
    }

    /// If clocks are declared: carries out what the importer makes happen at `time` \[s\].
    fn tick(
        &mut self,
        variables: &mut Self::Variables,
        ticks: Ticks,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        let _ = (variables, ticks, time, log);
        Ok(())
    }

    /// Scheduled Execution: the partition of `clock` runs at `time` \[s\]. What takes long it returns as a
    /// job. Meanwhile other partitions may run, this one may not.
    fn activate(
        &mut self,
        variables: &mut Self::Variables,
        clock: usize,
        time: f64,
        log: &mut Log<'_>,
    ) -> Result<Option<Self::Job>, Failure> {
        let _ = (variables, clock, time, log);
        Ok(None)
    }

    /// Scheduled Execution: does a job, apart from the unit.
    fn work(job: &mut Self::Job) {
        let _ = job;
    }

    /// Scheduled Execution: takes a finished job back.
    fn complete(
        &mut self,
        variables: &mut Self::Variables,
        job: Self::Job,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        let _ = (variables, job, log);
        Ok(())
    }

    /// Co-Simulation: integrates the continuous part from `from` to `to` \[s\]. No event lies between.
    fn advance(
        &mut self,
        variables: &mut Self::Variables,
        from: f64,
        to: f64,
        log: &mut Log<'_>,
    ) -> Result<(), Failure> {
        let _ = (variables, from, to, log);
        Ok(())
    }

    /// Refreshes the outputs and local variables that follow from states and inputs.
    fn outputs(&self, variables: &mut Self::Variables) {
        let _ = variables;
    }

    /// Model Exchange: writes the continuous states in the order of `Model::states`.
    fn continuous_states(&self, states: &mut [f64]) {
        let _ = states;
    }

    /// Model Exchange: takes the continuous states from the importer's solver.
    fn set_continuous_states(&mut self, states: &[f64]) {
        let _ = states;
    }

    /// Model Exchange: writes the time derivatives in the order of `Model::derivatives`.
    fn derivatives(&self, variables: &Self::Variables, derivatives: &mut [f64]) {
        let _ = (variables, derivatives);
    }

    /// If declared: the derivatives of continuous outputs and of the states' derivatives in a direction, at
    /// the present states and inputs. `direction` and `tangent` hold both in the variables themselves;
    /// all of `direction` is zero but states and continuous inputs.
    fn tangent(
        &self,
        variables: &Self::Variables,
        direction: &Self::Variables,
        tangent: &mut Self::Variables,
    ) {
        let _ = (variables, direction, tangent);
    }

    /// Model Exchange: the importer's solver completed a step that ended at `time` \[s\]. Returns
    /// whether an event must be handled there.
    fn completed_step(&mut self, variables: &Self::Variables, time: f64) -> bool {
        let _ = (variables, time);
        false
    }
}
