//! Instances of FMI 2.0 for Co-Simulation.

use super::interface::{Experiment, Interface, StatePointer, call, function_table};
use super::log::Environment;
use super::status::{Failed, Status};
use super::value::Buffer;
use fmi_abi::fmi2::*;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

function_table! { Functions:
    required {
    fmi2Instantiate: fmi2InstantiateTYPE,
    fmi2FreeInstance: fmi2FreeInstanceTYPE,
    fmi2SetupExperiment: fmi2SetupExperimentTYPE,
    fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE,
    fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE,
    fmi2Terminate: fmi2TerminateTYPE,
    fmi2Reset: fmi2ResetTYPE,
    fmi2GetReal: fmi2GetRealTYPE,
    fmi2GetInteger: fmi2GetIntegerTYPE,
    fmi2GetBoolean: fmi2GetBooleanTYPE,
    fmi2SetReal: fmi2SetRealTYPE,
    fmi2SetInteger: fmi2SetIntegerTYPE,
    fmi2SetBoolean: fmi2SetBooleanTYPE,
    fmi2SetString: fmi2SetStringTYPE,
    fmi2DoStep: fmi2DoStepTYPE,
    } optional {
    fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE,
    fmi2GetStatus: fmi2GetStatusTYPE,
    fmi2GetRealStatus: fmi2GetRealStatusTYPE,
    fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE,
    fmi2GetFMUstate: fmi2GetFMUstateTYPE,
    fmi2SetFMUstate: fmi2SetFMUstateTYPE,
    fmi2FreeFMUstate: fmi2FreeFMUstateTYPE,
    fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE,
    fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE,
    fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE,
    }
}

unsafe extern "C" {
    /// The logger of `logger.c`.
    pub(super) fn flexarm_fmi2_log(
        environment: fmi2ComponentEnvironment,
        instance: fmi2String,
        status: fmi2Status,
        category: fmi2String,
        message: fmi2String,
        ...
    );
    /// Of the C library: FMUs may rely on zeroed memory of any alignment.
    fn calloc(count: usize, size: usize) -> *mut c_void;
    /// Of the C library.
    fn free(memory: *mut c_void);
}

/// An instance.
pub(super) struct Instance {
    functions: Functions,
    instance: fmi2Component,
    /// Values of Boolean variables on their way: one int each here, one byte each in the host.
    booleans: Vec<fmi2Boolean>,
    /// FMUs may keep the pointers to both for as long as they live.
    _callbacks: Rc<fmi2CallbackFunctions>,
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
        let callbacks = Rc::new(fmi2CallbackFunctions {
            logger: Some(flexarm_fmi2_log),
            allocateMemory: Some(calloc),
            freeMemory: Some(free),
            stepFinished: None,
            componentEnvironment: Arc::as_ptr(&environment).cast_mut().cast(),
        });
        // SAFETY: all pointers outlive the instance, which holds the callbacks and the environment.
        let instance = unsafe {
            functions.fmi2Instantiate?(
                name.as_ptr(),
                fmi2CoSimulation,
                token.as_ptr(),
                resources.as_ptr(),
                Rc::as_ptr(&callbacks),
                fmi2False,
                fmi2Boolean::from(logging),
            )
        };
        // Lazily: dropping a `Self` frees its instance.
        (!instance.is_null()).then(|| Self {
            functions,
            instance,
            booleans: Vec::new(),
            _callbacks: callbacks,
            _environment: environment,
        })
    }

    /// Waits for an asynchronous step: without a callback the status must be polled (sec 4.2.2).
    fn wait(&mut self) -> Result<(), Failed> {
        loop {
            let mut status = fmi2OK;
            call!(self.fmi2GetStatus(fmi2DoStepStatus, &mut status))?;
            match Status::from(status) {
                Status::Pending => std::thread::sleep(Duration::from_micros(50)),
                Status::Ok | Status::Warning => return Ok(()),
                status => return Err(Failed::Status("fmi2DoStep", status)),
            }
        }
    }

    /// Whether a discarded step means that the FMU ended the simulation (sec 4.2.2).
    fn terminated(&mut self) -> Option<f64> {
        let mut terminated = fmi2False;
        let mut time = f64::NAN;
        call!(self.fmi2GetBooleanStatus(fmi2Terminated, &mut terminated)).ok()?;
        call!(self.fmi2GetRealStatus(fmi2LastSuccessfulTime, &mut time)).ok()?;
        (terminated != fmi2False).then_some(time)
    }
}

/// The types that FMI 2.0 lacks are never asked for, since its descriptions cannot declare them.
fn no_such_type<T>() -> Result<T, Failed> {
    Err(Failed::Missing("a function for a type of FMI 3.0"))
}

impl Interface for Instance {
    fn log_only(&mut self, categories: &[CString]) -> Result<(), Failed> {
        let pointers: Vec<_> = categories.iter().map(|c| c.as_ptr()).collect();
        call!(self.fmi2SetDebugLogging(fmi2True, pointers.len(), pointers.as_ptr()))
    }

    fn enter_initialization(&mut self, experiment: &Experiment) -> Result<(), Failed> {
        call!(self.fmi2SetupExperiment(
            fmi2Boolean::from(experiment.tolerance.is_some()),
            experiment.tolerance.unwrap_or(0.0),
            experiment.start,
            fmi2Boolean::from(experiment.stop.is_some()),
            experiment.stop.unwrap_or(0.0),
        ))?;
        call!(self.fmi2EnterInitializationMode())
    }

    fn exit_initialization(&mut self) -> Result<(), Failed> {
        call!(self.fmi2ExitInitializationMode())
    }

    fn get(&mut self, references: &[u32], values: &mut Buffer) -> Result<(), Failed> {
        let (pointer, count) = (references.as_ptr(), references.len());
        match values {
            Buffer::Float64(values) => call!(self.fmi2GetReal(pointer, count, values.as_mut_ptr())),
            Buffer::Int32(values) => {
                call!(self.fmi2GetInteger(pointer, count, values.as_mut_ptr()))
            }
            Buffer::Boolean(values) => {
                self.booleans.clear();
                self.booleans.resize(count, fmi2False);
                call!(self.fmi2GetBoolean(pointer, count, self.booleans.as_mut_ptr()))?;
                for (value, truth) in values.iter_mut().zip(&self.booleans) {
                    *value = u8::from(*truth != fmi2False);
                }
                Ok(())
            }
            _ => no_such_type(),
        }
    }

    fn set(&mut self, references: &[u32], values: &Buffer) -> Result<(), Failed> {
        let (pointer, count) = (references.as_ptr(), references.len());
        match values {
            Buffer::Float64(values) => call!(self.fmi2SetReal(pointer, count, values.as_ptr())),
            Buffer::Int32(values) => call!(self.fmi2SetInteger(pointer, count, values.as_ptr())),
            Buffer::Boolean(values) => {
                self.booleans.clear();
                self.booleans
                    .extend(values.iter().map(|&v| fmi2Boolean::from(v != 0)));
                call!(self.fmi2SetBoolean(pointer, count, self.booleans.as_ptr()))
            }
            _ => no_such_type(),
        }
    }

    fn set_text(&mut self, reference: u32, values: &[CString]) -> Result<(), Failed> {
        let pointers: Vec<_> = values.iter().map(|v| v.as_ptr()).collect();
        call!(self.fmi2SetString(&reference, pointers.len(), pointers.as_ptr()))
    }

    fn do_step(&mut self, time: f64, step: f64, final_state: bool) -> Result<(), Failed> {
        let result = call!(self.fmi2DoStep(time, step, fmi2Boolean::from(final_state)));
        match result {
            Err(Failed::Status(_, Status::Pending)) => self.wait(),
            Err(Failed::Status(_, Status::Discard)) => match self.terminated() {
                Some(time) => Err(Failed::Terminated(time)),
                None => result,
            },
            result => result,
        }
    }

    fn terminate(&mut self) -> Result<(), Failed> {
        call!(self.fmi2Terminate())
    }

    fn reset(&mut self) -> Result<(), Failed> {
        call!(self.fmi2Reset())
    }

    fn state(&mut self) -> Result<StatePointer, Failed> {
        let mut state = std::ptr::null_mut();
        call!(self.fmi2GetFMUstate(&mut state)).map(|()| state)
    }

    fn set_state(&mut self, state: StatePointer) -> Result<(), Failed> {
        call!(self.fmi2SetFMUstate(state))
    }

    fn free_state(&mut self, mut state: StatePointer) -> Result<(), Failed> {
        call!(self.fmi2FreeFMUstate(&mut state))
    }

    fn serialize(&mut self, state: StatePointer) -> Result<Vec<u8>, Failed> {
        let mut size = 0;
        call!(self.fmi2SerializedFMUstateSize(state, &mut size))?;
        let mut bytes = vec![0u8; size];
        call!(self.fmi2SerializeFMUstate(state, bytes.as_mut_ptr().cast::<c_char>(), size))?;
        Ok(bytes)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<StatePointer, Failed> {
        let mut state = std::ptr::null_mut();
        let pointer = bytes.as_ptr().cast::<c_char>();
        call!(self.fmi2DeSerializeFMUstate(pointer, bytes.len(), &mut state)).map(|()| state)
    }

    fn abandon(self: Box<Self>) {
        std::mem::forget(self);
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some(free_instance) = self.functions.fmi2FreeInstance {
            // SAFETY: the instance is live and never used again.
            unsafe { free_instance(self.instance) };
        }
    }
}

const _: () = assert!(size_of::<fmi2Integer>() == size_of::<i32>() && size_of::<c_int>() == 4);
