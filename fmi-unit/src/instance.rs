//! One instance of a unit and its life, the same for both versions of the standard: the version
//! modules only translate.

use serde::{Deserialize, Serialize};

use crate::clock::Ticks;
use crate::fmi3::IntermediateUpdate;
use crate::guard::Preemption;
use crate::legality::{Mode, Row, Verdict};
use crate::log::{Log, Severity};
use crate::logger::{ERROR, Logger, WARNING};
use crate::model::{Model, Variables};
use crate::sensitivity::Columns;
use crate::unit::{Failure, Unit};

/// What the importer uses an instance for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Interface {
    ModelExchange,
    CoSimulation,
    /// Co-Simulation whose importer uses Event Mode (FMI 3.0 sec 4.2.1).
    EventfulCoSimulation,
    ScheduledExecution,
}

/// Everything that changes and is not the unit's own; a snapshot holds it as it is.
#[derive(Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Situation<V: Variables> {
    pub(crate) interface: Interface,
    pub(crate) mode: Mode,
    /// \[s\]
    pub(crate) start: f64,
    /// The importer will not go beyond \[s\].
    pub(crate) stop: Option<f64>,
    /// \[s\]
    pub(crate) time: f64,
    pub(crate) variables: V,
    /// Inputs, states or parameters changed since the outputs were made.
    pub(crate) stale: bool,
    /// Clocks that the importer has activated for the event at hand.
    pub(crate) ticks: Ticks,
    /// The importer ticks clocks, so that there are no time events.
    pub(crate) clocked: bool,
    /// Model Exchange: the unit asked for an event at the end of a completed integrator step.
    pub(crate) step_event: bool,
}

impl<V: Variables> Situation<V> {
    fn new(interface: Interface) -> Self {
        Self {
            interface,
            mode: Mode::Instantiated,
            start: 0.0,
            stop: None,
            time: 0.0,
            variables: V::default(),
            stale: true,
            step_event: false,
            ticks: Ticks::default(),
            clocked: false,
        }
    }
}

impl<V: Variables> Clone for Situation<V> {
    fn clone(&self) -> Self {
        let variables = self.variables.clone();
        Self { variables, ..*self }
    }

    /// Without allocation where the sizes agree.
    fn clone_from(&mut self, source: &Self) {
        let Self {
            interface,
            mode,
            start,
            stop,
            time,
            ref variables,
            stale,
            ticks,
            clocked,
            step_event,
        } = *source;
        self.variables.clone_from(variables);
        self.interface = interface;
        self.mode = mode;
        self.start = start;
        self.stop = stop;
        self.time = time;
        self.stale = stale;
        self.ticks = ticks;
        self.clocked = clocked;
        self.step_event = step_event;
    }
}

/// An instance of a unit.
pub(crate) struct Instance<U: Unit> {
    pub(crate) logger: Logger,
    pub(crate) now: Situation<U::Variables>,
    /// FMI 3.0 Co-Simulation: whom to call at events inside a step.
    pub(crate) intermediate_update: Option<IntermediateUpdate>,
    /// FMI 3.0 Co-Simulation: whether a step may end before its time.
    pub(crate) early_return_allowed: bool,
    /// FMI 3.0 Scheduled Execution.
    pub(crate) preemption: Preemption,
    /// How many units there have been: a job belongs to the one that gave it.
    pub(crate) generation: u64,
    /// Exists from the end of initialization on.
    pub(crate) unit: Option<U>,
    /// Model Exchange: continuous states before and after an event.
    pub(crate) states: [Box<[f64]>; 2],
    /// If derivatives are declared.
    pub(crate) columns: Option<Box<Columns<U::Variables>>>,
    /// Functions whose call out of order has been reported; once each is enough.
    reported: Vec<&'static str>,
}

impl<U: Unit> Instance<U> {
    /// Checks what the importer says about the model. `logger` learns the instance's name first, so
    /// that a refusal is reported under it.
    pub(crate) fn new(
        logger: &mut Logger,
        name: Option<&str>,
        token: Option<&str>,
        interface: Interface,
        logging: bool,
    ) -> Result<Self, Failure> {
        let model: &'static Model = U::Variables::MODEL;
        logger.identify(name.unwrap_or(model.name), model.log_categories, logging);
        if token != Some(model.token) {
            return Err(Failure(format!(
                "the description is not that of this binary: its token is {}, not {}",
                token.unwrap_or("null"),
                model.token
            )));
        }
        let (has, what) = match interface {
            Interface::ModelExchange => (model.model_exchange, "Model Exchange"),
            Interface::CoSimulation => (true, "Co-Simulation"),
            Interface::EventfulCoSimulation => (model.event_mode, "Event Mode in Co-Simulation"),
            Interface::ScheduledExecution => (model.scheduled_execution, "Scheduled Execution"),
        };
        if !has {
            return Err(Failure(format!("{} has no {what}", model.name)));
        }
        let zeros = || vec![0.0; model.states.len()].into_boxed_slice();
        Ok(Self {
            logger: logger.clone(),
            now: Situation::new(interface),
            intermediate_update: None,
            early_return_allowed: false,
            preemption: Preemption::default(),
            generation: 0,
            unit: None,
            states: [zeros(), zeros()],
            columns: model.directional_derivatives.then(Columns::new),
            reported: Vec::new(),
        })
    }

    /// Whether a call is in order; a tolerated one is reported the first time.
    pub(crate) fn admit(&mut self, name: &'static str, row: &Row) -> Result<(), Failure> {
        match row.verdict(self.now.mode) {
            Verdict::Legal => Ok(()),
            Verdict::Refused => Err(Failure(format!("not allowed in {}", self.now.mode))),
            Verdict::Tolerated => {
                if !self.reported.contains(&name) {
                    self.reported.push(name);
                    let mode = self.now.mode;
                    self.warn(format_args!(
                        "{name}: out of order in {mode}, accepted; further calls are not reported"
                    ));
                }
                Ok(())
            }
        }
    }

    pub(crate) fn warn(&self, message: std::fmt::Arguments<'_>) {
        self.logger.write(Severity::Warning, WARNING, message);
    }

    /// `fmi2SetupExperiment` and the first part of `fmi3EnterInitializationMode`.
    pub(crate) fn set_up(&mut self, start: f64, stop: Option<f64>) -> Result<(), Failure> {
        if !start.is_finite() {
            return Err(Failure(format!("start time = {start} s is not finite")));
        }
        if let Some(stop) = stop
            && (stop.is_nan() || stop < start)
        {
            return Err(Failure(format!(
                "stop time = {stop} s is outside [{start}, inf] s: it must not precede the start"
            )));
        }
        self.now.start = start;
        self.now.time = start;
        self.now.stop = stop;
        Ok(())
    }

    /// Refused to units that have nothing to configure (FMI 3.0 sec 2.3.3).
    pub(crate) fn enter_configuration(&mut self) -> Result<(), Failure> {
        let model = U::Variables::MODEL;
        if !model.is_configurable() {
            let name = model.name;
            return Err(Failure(format!("{name} has no structural parameter")));
        }
        self.now.mode = Mode::Configuration;
        Ok(())
    }

    /// Gives the arrays their new sizes: no step allocates for them.
    pub(crate) fn exit_configuration(&mut self) {
        self.now.variables.resize();
        self.now.stale = true;
        self.now.mode = Mode::Instantiated;
    }

    pub(crate) fn enter_initialization(&mut self) {
        self.now.mode = Mode::Initialization;
    }

    /// Sets the unit up. If that fails the instance stays in Initialization Mode, where parameters can
    /// be corrected.
    pub(crate) fn exit_initialization(&mut self) -> Result<(), Failure> {
        let now = &mut self.now;
        // What holds until the first event must not depend on who read it before.
        U::initial_outputs(&mut now.variables);
        match U::new(&mut now.variables, now.start) {
            Ok(unit) => {
                self.unit = Some(unit);
                self.generation += 1;
            }
            Err(mut failures) => {
                let last = failures.pop();
                for Failure(reason) in &failures {
                    self.logger
                        .write(Severity::Error, ERROR, format_args!("{reason}"));
                }
                return Err(last.unwrap_or_else(|| Failure("the unit cannot be set up".into())));
            }
        }
        now.stale = true;
        now.mode = match now.interface {
            Interface::CoSimulation => Mode::Step,
            Interface::ModelExchange | Interface::EventfulCoSimulation => Mode::Event,
            Interface::ScheduledExecution => Mode::ClockActivation,
        };
        Ok(())
    }

    pub(crate) fn terminate(&mut self) {
        if self.now.mode != Mode::Failed {
            self.now.mode = Mode::Terminated;
        }
    }

    /// Back to the start values. The log switches stay.
    pub(crate) fn reset(&mut self) {
        self.unit = None;
        self.generation += 1;
        self.now = Situation::new(self.now.interface);
    }

    /// Whether the instance waits for the importer to return from an intermediate update.
    pub(crate) fn within_step(&self) -> bool {
        self.now.mode == Mode::IntermediateUpdate
    }

    /// Makes the outputs anew if something they follow from has changed.
    pub(crate) fn refresh(&mut self) {
        if !self.now.stale {
            return;
        }
        match &self.unit {
            Some(unit) => unit.outputs(&mut self.now.variables),
            None => U::initial_outputs(&mut self.now.variables),
        }
        self.now.stale = false;
    }

    /// Lets the unit change something and report on it. If it fails, the instance can only be reset,
    /// restored or freed.
    pub(crate) fn act<T>(
        &mut self,
        action: impl FnOnce(&mut U, &mut U::Variables, &mut Log<'_>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let Some(unit) = &mut self.unit else {
            return Err(Failure("the unit is not set up".into()));
        };
        let logger = &self.logger;
        let mut sink = |severity, category: &'static str, message: std::fmt::Arguments<'_>| {
            logger.write(severity, category, message);
        };
        self.now.stale = true;
        let outcome = action(unit, &mut self.now.variables, &mut Log::new(&mut sink));
        if outcome.is_err() {
            self.now.mode = Mode::Failed;
        }
        outcome
    }
}

/// Rounding of a time, a few units in the last place \[s\].
pub(crate) fn rounding(time: f64) -> f64 {
    16.0 * f64::EPSILON * time.abs()
}
