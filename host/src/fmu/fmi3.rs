//! Instances of FMI 3.0 for Co-Simulation, without Event Mode and without early return.

use super::interface::{Experiment, Interface, StatePointer, call, function_table};
use super::log::{Environment, receive};
use super::status::Failed;
use super::value::Buffer;
use fmi_abi::fmi3::*;
use std::ffi::{CStr, CString};
use std::sync::Arc;

function_table! { Functions:
    required {
    fmi3InstantiateCoSimulation: fmi3InstantiateCoSimulationTYPE,
    fmi3FreeInstance: fmi3FreeInstanceTYPE,
    fmi3EnterInitializationMode: fmi3EnterInitializationModeTYPE,
    fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE,
    fmi3Terminate: fmi3TerminateTYPE,
    fmi3Reset: fmi3ResetTYPE,
    fmi3GetFloat64: fmi3GetFloat64TYPE,
    fmi3SetFloat64: fmi3SetFloat64TYPE,
    fmi3DoStep: fmi3DoStepTYPE,
    } optional {
    fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE,
    fmi3EnterConfigurationMode: fmi3EnterConfigurationModeTYPE,
    fmi3ExitConfigurationMode: fmi3ExitConfigurationModeTYPE,
    fmi3GetFloat32: fmi3GetFloat32TYPE,
    fmi3GetInt8: fmi3GetInt8TYPE,
    fmi3GetUInt8: fmi3GetUInt8TYPE,
    fmi3GetInt16: fmi3GetInt16TYPE,
    fmi3GetUInt16: fmi3GetUInt16TYPE,
    fmi3GetInt32: fmi3GetInt32TYPE,
    fmi3GetUInt32: fmi3GetUInt32TYPE,
    fmi3GetInt64: fmi3GetInt64TYPE,
    fmi3GetUInt64: fmi3GetUInt64TYPE,
    fmi3GetBoolean: fmi3GetBooleanTYPE,
    fmi3SetFloat32: fmi3SetFloat32TYPE,
    fmi3SetInt8: fmi3SetInt8TYPE,
    fmi3SetUInt8: fmi3SetUInt8TYPE,
    fmi3SetInt16: fmi3SetInt16TYPE,
    fmi3SetUInt16: fmi3SetUInt16TYPE,
    fmi3SetInt32: fmi3SetInt32TYPE,
    fmi3SetUInt32: fmi3SetUInt32TYPE,
    fmi3SetInt64: fmi3SetInt64TYPE,
    fmi3SetUInt64: fmi3SetUInt64TYPE,
    fmi3SetBoolean: fmi3SetBooleanTYPE,
    fmi3SetString: fmi3SetStringTYPE,
    fmi3GetFMUState: fmi3GetFMUStateTYPE,
    fmi3SetFMUState: fmi3SetFMUStateTYPE,
    fmi3FreeFMUState: fmi3FreeFMUStateTYPE,
    fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE,
    fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE,
    fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE,
    }
}

/// An instance.
pub(super) struct Instance {
    functions: Functions,
    instance: fmi3Instance,
    /// The FMU may keep the pointer for as long as it lives.
    _environment: Arc<Environment>,
}

impl Instance {
    /// None if the FMU refuses; its reason is in the log.
    pub(super) fn new(
        functions: Functions,
        name: &CStr,
        token: &CStr,
        resources: &CStr,
        logging: bool,
        environment: Arc<Environment>,
    ) -> Option<Self> {
        // SAFETY: all pointers outlive the instance, which holds the environment.
        let instance = unsafe {
            functions.fmi3InstantiateCoSimulation?(
                name.as_ptr(),
                token.as_ptr(),
                resources.as_ptr(),
                fmi3False,
                fmi3Boolean::from(logging),
                fmi3False,
                fmi3False,
                std::ptr::null(),
                0,
                Arc::as_ptr(&environment).cast_mut().cast(),
                Some(receive),
                None,
            )
        };
        // Lazily: dropping a `Self` frees its instance.
        (!instance.is_null()).then(|| Self {
            functions,
            instance,
            _environment: environment,
        })
    }
}

impl Interface for Instance {
    fn log_only(&mut self, categories: &[CString]) -> Result<(), Failed> {
        let pointers: Vec<_> = categories.iter().map(|c| c.as_ptr()).collect();
        call!(self.fmi3SetDebugLogging(fmi3True, pointers.len(), pointers.as_ptr()))
    }

    fn enter_configuration(&mut self) -> Result<(), Failed> {
        call!(self.fmi3EnterConfigurationMode())
    }

    fn exit_configuration(&mut self) -> Result<(), Failed> {
        call!(self.fmi3ExitConfigurationMode())
    }

    fn enter_initialization(&mut self, experiment: &Experiment) -> Result<(), Failed> {
        call!(self.fmi3EnterInitializationMode(
            fmi3Boolean::from(experiment.tolerance.is_some()),
            experiment.tolerance.unwrap_or(0.0),
            experiment.start,
            fmi3Boolean::from(experiment.stop.is_some()),
            experiment.stop.unwrap_or(0.0),
        ))
    }

    fn exit_initialization(&mut self) -> Result<(), Failed> {
        call!(self.fmi3ExitInitializationMode())
    }

    fn get(&mut self, references: &[u32], values: &mut Buffer) -> Result<(), Failed> {
        macro_rules! get {
            ($($variant:ident: $function:ident),*) => {
                match values {
                    $(Buffer::$variant(values) => call!(self.$function(
                        references.as_ptr(), references.len(), values.as_mut_ptr(), values.len(),
                    )),)*
                }
            };
        }
        get!(Float64: fmi3GetFloat64, Float32: fmi3GetFloat32, Int8: fmi3GetInt8, UInt8: fmi3GetUInt8,
            Int16: fmi3GetInt16, UInt16: fmi3GetUInt16, Int32: fmi3GetInt32, UInt32: fmi3GetUInt32,
            Int64: fmi3GetInt64, UInt64: fmi3GetUInt64, Boolean: fmi3GetBoolean)
    }

    fn set(&mut self, references: &[u32], values: &Buffer) -> Result<(), Failed> {
        macro_rules! set {
            ($($variant:ident: $function:ident),*) => {
                match values {
                    $(Buffer::$variant(values) => call!(self.$function(
                        references.as_ptr(), references.len(), values.as_ptr(), values.len(),
                    )),)*
                }
            };
        }
        set!(Float64: fmi3SetFloat64, Float32: fmi3SetFloat32, Int8: fmi3SetInt8, UInt8: fmi3SetUInt8,
            Int16: fmi3SetInt16, UInt16: fmi3SetUInt16, Int32: fmi3SetInt32, UInt32: fmi3SetUInt32,
            Int64: fmi3SetInt64, UInt64: fmi3SetUInt64, Boolean: fmi3SetBoolean)
    }

    fn set_text(&mut self, reference: u32, values: &[CString]) -> Result<(), Failed> {
        let pointers: Vec<_> = values.iter().map(|v| v.as_ptr()).collect();
        call!(self.fmi3SetString(&reference, 1, pointers.as_ptr(), pointers.len()))
    }

    fn do_step(&mut self, time: f64, step: f64, final_state: bool) -> Result<(), Failed> {
        let mut event_handling_needed = fmi3False;
        let mut terminate = fmi3False;
        let mut early_return = fmi3False;
        let mut last_successful_time = time;
        call!(self.fmi3DoStep(
            time,
            step,
            fmi3Boolean::from(final_state),
            &mut event_handling_needed,
            &mut terminate,
            &mut early_return,
            &mut last_successful_time,
        ))?;
        if terminate != fmi3False {
            Err(Failed::Terminated(last_successful_time))
        } else if early_return != fmi3False {
            Err(Failed::ReturnedEarly(last_successful_time))
        } else {
            Ok(())
        }
    }

    fn terminate(&mut self) -> Result<(), Failed> {
        call!(self.fmi3Terminate())
    }

    fn reset(&mut self) -> Result<(), Failed> {
        call!(self.fmi3Reset())
    }

    fn state(&mut self) -> Result<StatePointer, Failed> {
        let mut state = std::ptr::null_mut();
        call!(self.fmi3GetFMUState(&mut state)).map(|()| state)
    }

    fn set_state(&mut self, state: StatePointer) -> Result<(), Failed> {
        call!(self.fmi3SetFMUState(state))
    }

    fn free_state(&mut self, mut state: StatePointer) -> Result<(), Failed> {
        call!(self.fmi3FreeFMUState(&mut state))
    }

    fn serialize(&mut self, state: StatePointer) -> Result<Vec<u8>, Failed> {
        let mut size = 0;
        call!(self.fmi3SerializedFMUStateSize(state, &mut size))?;
        let mut bytes = vec![0; size];
        call!(self.fmi3SerializeFMUState(state, bytes.as_mut_ptr(), size))?;
        Ok(bytes)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<StatePointer, Failed> {
        let mut state = std::ptr::null_mut();
        call!(self.fmi3DeserializeFMUState(bytes.as_ptr(), bytes.len(), &mut state)).map(|()| state)
    }

    fn abandon(self: Box<Self>) {
        std::mem::forget(self);
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some(free_instance) = self.functions.fmi3FreeInstance {
            // SAFETY: the instance is live and never used again.
            unsafe { free_instance(self.instance) };
        }
    }
}
