//! The narrow waist between the host and an instance, whatever the version of the standard.
//!
//! Co-Simulation needs no more than this. Another way to run a unit (Model Exchange behind a solver, a child
//! process that protects the host from a crash) is another implementation.

use super::status::Failed;
use super::value::Buffer;
use std::ffi::{CString, c_void};

/// A saved state of an instance, owned by its binary.
pub(super) type StatePointer = *mut c_void;

/// When an experiment starts and stops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time \[s\].
    pub start: f64,
    /// Stop time \[s\]; a promise never to step beyond.
    pub stop: Option<f64>,
    /// Relative tolerance for solvers inside.
    pub tolerance: Option<f64>,
}

/// One instance for Co-Simulation. Dropping it frees the instance.
pub(super) trait Interface {
    /// Asks for the messages of these categories only.
    fn log_only(&mut self, categories: &[CString]) -> Result<(), Failed>;
    /// Enters Configuration Mode, which FMI 2.0 does not have.
    fn enter_configuration(&mut self) -> Result<(), Failed> {
        Err(Failed::Missing("fmi3EnterConfigurationMode"))
    }
    /// Leaves Configuration Mode: arrays have their new sizes.
    fn exit_configuration(&mut self) -> Result<(), Failed> {
        Err(Failed::Missing("fmi3ExitConfigurationMode"))
    }
    /// Sets the experiment up and enters Initialization Mode.
    fn enter_initialization(&mut self, experiment: &Experiment) -> Result<(), Failed>;
    /// Leaves Initialization Mode: steps may follow.
    fn exit_initialization(&mut self) -> Result<(), Failed>;
    /// Reads variables of one type; an array of FMI 3.0 takes as many values as it has elements.
    fn get(&mut self, references: &[u32], values: &mut Buffer) -> Result<(), Failed>;
    /// Writes variables of one type.
    fn set(&mut self, references: &[u32], values: &Buffer) -> Result<(), Failed>;
    /// Writes all elements of a variable of type String.
    fn set_text(&mut self, reference: u32, values: &[CString]) -> Result<(), Failed>;
    /// Steps from `time` to `time + step` \[s\]. `final_state` tells that no earlier state will be restored.
    fn do_step(&mut self, time: f64, step: f64, final_state: bool) -> Result<(), Failed>;
    /// Ends the experiment.
    fn terminate(&mut self) -> Result<(), Failed>;
    /// Goes back to the state after instantiation.
    fn reset(&mut self) -> Result<(), Failed>;
    /// Saves the state.
    fn state(&mut self) -> Result<StatePointer, Failed>;
    /// Goes back to a state of this instance.
    fn set_state(&mut self, state: StatePointer) -> Result<(), Failed>;
    /// Frees a state of this instance.
    fn free_state(&mut self, state: StatePointer) -> Result<(), Failed>;
    /// Writes a state as bytes.
    fn serialize(&mut self, state: StatePointer) -> Result<Vec<u8>, Failed>;
    /// Makes a state from bytes.
    fn deserialize(&mut self, bytes: &[u8]) -> Result<StatePointer, Failed>;
    /// After Fatal no function may be called again, not even the one that frees the instance.
    fn abandon(self: Box<Self>);
}

/// Declares a table of functions of a binary and how to load it: functions after `required` must be there.
macro_rules! function_table {
    ($name:ident: required { $($required:ident: $required_type:ty,)* } optional { $($optional:ident: $optional_type:ty,)* }) => {
        /// Functions of the binary, by the names of the standard.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case)]
        pub(super) struct $name {
            $($required: $required_type,)*
            $($optional: $optional_type,)*
        }

        impl $name {
            /// Looks all functions up. Errors: the name of the first required one that is missing.
            pub(super) fn load(library: &libloading::Library) -> Result<Self, &'static str> {
                // SAFETY: the types are those of the standard for these names.
                unsafe {
                    Ok(Self {
                        $($required: *library
                            .get::<$required_type>(stringify!($required))
                            .map_err(|_| stringify!($required))?,)*
                        $($optional: library
                            .get::<$optional_type>(stringify!($optional))
                            .ok()
                            .and_then(|symbol| *symbol),)*
                    })
                }
            }
        }
    };
}

/// Calls a function of the table, if it is there, and checks its status.
macro_rules! call {
    ($self:ident.$function:ident($($argument:expr),* $(,)?)) => {
        match $self.functions.$function {
            Some(function) => {
                // SAFETY: the instance is live, pointers and lengths belong together.
                let status = unsafe { function($self.instance, $($argument),*) };
                $crate::fmu::status::check(stringify!($function), status)
            }
            None => Err($crate::fmu::status::Failed::Missing(stringify!($function))),
        }
    };
}

pub(super) use {call, function_table};
