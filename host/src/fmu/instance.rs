//! A running instance of an FMU.

use super::description::{Description, Scalar};
use super::error::Error;
use super::interface::{Experiment, Interface, StatePointer};
use super::log::{Environment, Message};
use super::signals::Signals;
use super::status::{Failed, Status};
use super::value::{Buffer, Kind, Value};
use super::{Binary, Fmu};
use std::ffi::CString;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Log messages that an error carries.
const LOG_LINES: usize = 10;

/// An instance for Co-Simulation. Dropping it frees it, unless its FMU returned Fatal: then nothing may be
/// called any more (FMI 2.0.4 sec 2.1.3, FMI 3.0 sec 2.2.3), and instance and binary are left as they are.
pub struct Instance {
    name: String,
    /// None only while dropping.
    interface: Option<Box<dyn Interface>>,
    states: Vec<StatePointer>,
    time: Option<f64>,
    /// Whether Initialization Mode is over.
    set_up: bool,
    failed: bool,
    environment: Arc<Environment>,
    binary: Arc<Binary>,
    // Last: the unpacked folder goes after the binary.
    fmu: Fmu,
}

/// A state that an [`Instance`] saved. It is freed with the instance at the latest.
#[derive(Debug)]
pub struct SavedState(StatePointer);

impl std::fmt::Debug for Instance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Instance({} of {})",
            self.name,
            self.fmu.file().display()
        )
    }
}

impl Instance {
    pub(super) fn new(
        name: &str,
        fmu: Fmu,
        binary: Arc<Binary>,
        environment: Arc<Environment>,
        interface: Box<dyn Interface>,
    ) -> Self {
        Self {
            name: name.to_owned(),
            interface: Some(interface),
            states: Vec::new(),
            time: None,
            set_up: false,
            failed: false,
            environment,
            binary,
            fmu,
        }
    }

    /// Name of the instance.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What its FMU says of itself.
    pub fn description(&self) -> &Description {
        self.fmu.description()
    }

    /// All messages that it logged, oldest first; at most the latest 1000.
    pub fn messages(&self) -> Vec<Message> {
        self.environment.log.all()
    }

    fn call<T>(
        &mut self,
        function: impl FnOnce(&mut dyn Interface) -> Result<T, Failed>,
    ) -> Result<T, Error> {
        if self.fmu.unpacked.fatal.load(Ordering::Relaxed) {
            return Err(self.after_fatal());
        }
        match &mut self.interface {
            Some(interface) => function(interface.as_mut()).map_err(|failed| self.failure(failed)),
            None => Err(self.after_fatal()),
        }
    }

    fn after_fatal(&self) -> Error {
        Error::AfterFatal {
            instance: self.name.clone(),
        }
    }

    #[cold]
    fn failure(&mut self, failed: Failed) -> Error {
        let instance = self.name.clone();
        let log = self.environment.log.last(LOG_LINES);
        match failed {
            Failed::Status(function, status) => {
                if status == Status::Fatal {
                    self.fmu.unpacked.fatal.store(true, Ordering::Relaxed);
                }
                // Discard leaves the instance as it was.
                self.failed |= status != Status::Discard;
                if !self.set_up && status != Status::Fatal {
                    return Error::SetUp {
                        instance,
                        function,
                        status,
                        log,
                    };
                }
                Error::Call {
                    instance,
                    function,
                    status,
                    time: self.time,
                    log,
                }
            }
            Failed::Missing(function) => Error::MissingFunction {
                file: self.fmu.file().to_owned(),
                function,
            },
            Failed::Terminated(time) => Error::Terminated {
                instance,
                time,
                log,
            },
            Failed::ReturnedEarly(time) => Error::ReturnedEarly {
                instance,
                time,
                asked: self.time.unwrap_or(f64::NAN),
            },
        }
    }

    /// Gives structural parameters the values of [`Fmu::configured`], before anything else is set.
    pub(super) fn configure(&mut self) -> Result<(), Error> {
        let structure = Arc::clone(&self.fmu.structure);
        if structure.is_empty() {
            return Ok(());
        }
        self.call(|i| i.enter_configuration())?;
        self.write(&structure)?;
        self.call(|i| i.exit_configuration())
    }

    /// Sets values before initialisation: parameters, start values. They were parsed for their variables.
    /// Structural parameters have theirs from [`Fmu::configured`] already.
    pub fn set_start_values(&mut self, values: &[(Scalar, Value)]) -> Result<(), Error> {
        let structure = Arc::clone(&self.fmu.structure);
        let mut values = values.to_vec();
        values.retain(|value| !structure.contains(value));
        self.write(&values)
    }

    fn write(&mut self, values: &[(Scalar, Value)]) -> Result<(), Error> {
        let scalars: Vec<_> = values.iter().map(|(scalar, _)| *scalar).collect();
        let mut signals = Signals::new(self.description(), &scalars);
        signals.write_values(self, values)?;
        for (scalar, value) in values {
            if let Value::Text(text) = value {
                self.set_text(*scalar, text)?;
            }
        }
        Ok(())
    }

    fn set_text(&mut self, scalar: Scalar, text: &str) -> Result<(), Error> {
        let variable = self.description().variable(scalar);
        let (reference, kind, length) = (variable.reference, variable.kind, variable.length());
        let wrong = |instance: &Self, why| Error::Type {
            instance: instance.name.clone(),
            name: instance.description().name_of(scalar),
            why,
        };
        if kind != Kind::String || length != 1 {
            return Err(wrong(self, "is no scalar of type String"));
        }
        let text = CString::new(text).map_err(|_| wrong(self, "cannot hold a zero byte"))?;
        self.call(|i| i.set_text(reference, &[text]))
    }

    /// Sets the experiment up and enters Initialization Mode.
    pub fn enter_initialization(&mut self, experiment: &Experiment) -> Result<(), Error> {
        self.call(|i| i.enter_initialization(experiment))
    }

    /// Leaves Initialization Mode: steps may follow.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        self.call(|i| i.exit_initialization())?;
        self.set_up = true;
        Ok(())
    }

    pub(super) fn get(&mut self, references: &[u32], values: &mut Buffer) -> Result<(), Error> {
        self.call(|i| i.get(references, values))
    }

    pub(super) fn set(&mut self, references: &[u32], values: &Buffer) -> Result<(), Error> {
        self.call(|i| i.set(references, values))
    }

    /// Reads one scalar as a number.
    pub fn value(&mut self, scalar: Scalar) -> Result<f64, Error> {
        if !self.description().variable(scalar).kind.is_numeric() {
            return Err(Error::Type {
                instance: self.name.clone(),
                name: self.description().name_of(scalar),
                why: "is not numeric",
            });
        }
        let mut number = [0.0];
        Signals::new(self.description(), &[scalar]).read(self, &mut number)?;
        Ok(number[0])
    }

    /// Steps from `time` to `time + step` \[s\].
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<(), Error> {
        self.time = Some(time);
        let final_state = self.states.is_empty();
        self.call(|i| i.do_step(time, step, final_state))
    }

    /// Ends the experiment. An instance that failed is left alone.
    pub fn terminate(&mut self) -> Result<(), Error> {
        if self.failed {
            return Ok(());
        }
        self.call(|i| i.terminate())
    }

    /// Goes back to the state after instantiation, for another run.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.call(|i| i.reset())?;
        self.time = None;
        self.set_up = false;
        self.failed = false;
        // All variables have their start values again (FMI 3.0 sec 2.3.1).
        self.configure()
    }

    /// Saves the state.
    pub fn save(&mut self) -> Result<SavedState, Error> {
        let state = self.call(|i| i.state())?;
        self.states.push(state);
        Ok(SavedState(state))
    }

    /// Goes back to a saved state.
    pub fn restore(&mut self, state: &SavedState) -> Result<(), Error> {
        let pointer = self.own(state)?;
        self.call(|i| i.set_state(pointer))
    }

    /// Frees a saved state.
    pub fn discard(&mut self, state: SavedState) -> Result<(), Error> {
        let pointer = self.own(&state)?;
        self.states.retain(|&other| other != pointer);
        self.call(|i| i.free_state(pointer))
    }

    /// Writes a saved state as bytes, which another process may read.
    pub fn serialize(&mut self, state: &SavedState) -> Result<Vec<u8>, Error> {
        let pointer = self.own(state)?;
        self.call(|i| i.serialize(pointer))
    }

    /// Makes a saved state from bytes.
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<SavedState, Error> {
        let state = self.call(|i| i.deserialize(bytes))?;
        self.states.push(state);
        Ok(SavedState(state))
    }

    fn own(&self, state: &SavedState) -> Result<StatePointer, Error> {
        if self.states.contains(&state.0) {
            Ok(state.0)
        } else {
            Err(Error::ForeignState {
                instance: self.name.clone(),
            })
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        let Some(mut interface) = self.interface.take() else {
            return;
        };
        if self.fmu.unpacked.fatal.load(Ordering::Relaxed) {
            interface.abandon();
            // Unloading would run code of the binary too.
            std::mem::forget(Arc::clone(&self.binary));
            return;
        }
        for state in self.states.drain(..) {
            // Nothing can be done about a failure here.
            let _ = interface.free_state(state);
        }
    }
}
