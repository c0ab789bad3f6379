//! FMI 3.0: translates each function of the standard into calls on an instance.
//!
//! Every function is `unsafe` for the same reason: the importer is C and vouches for its pointers. An
//! instance is null or comes from an instantiation of the same unit; arrays are null or as long as
//! said; strings are null or end with a null character.
#![allow(non_snake_case, reason = "the names are the standard's")]
#![allow(missing_docs, reason = "the functions are those of the standard")]
#![allow(
    clippy::missing_safety_doc,
    clippy::undocumented_unsafe_blocks,
    reason = "one contract for all, stated above"
)]
#![allow(
    clippy::too_many_arguments,
    reason = "the signatures are the standard's"
)]

use fmi_abi::fmi3::*;
use std::ffi::c_char;

use crate::access::Addressing;
use crate::common;
use crate::guard::{call, release};
use crate::legality::fmi3 as table;
use crate::model::Variables;
use crate::pointer::{slice, slice_mut, target};
use crate::sensitivity::Product;
use crate::transfer::{Absent, Boolean, Float64, Int32, Int64, UInt64};
use crate::unit::Unit;

mod absent;
mod clocks;
mod do_step;
mod instantiate;

pub use absent::*;
pub use clocks::*;
pub use do_step::fmi3DoStep;
pub use instantiate::*;

pub(crate) use do_step::IntermediateUpdate;

pub fn fmi3GetVersion<U: Unit>() -> *const c_char {
    c"3.0".as_ptr()
}

pub unsafe fn fmi3SetDebugLogging<U: Unit>(
    instance: fmi3Instance,
    on: fmi3Boolean,
    n: usize,
    categories: *const fmi3String,
) -> fmi3Status {
    let on = on != fmi3False;
    unsafe { common::set_debug_logging::<U>(instance, "fmi3SetDebugLogging", on, n, categories) }
}

pub unsafe fn fmi3FreeInstance<U: Unit>(instance: fmi3Instance) {
    unsafe { release::<U>(instance, "fmi3FreeInstance") }
}

pub unsafe fn fmi3EnterInitializationMode<U: Unit>(
    instance: fmi3Instance,
    _tolerance_defined: fmi3Boolean,
    _tolerance: fmi3Float64,
    start: fmi3Float64,
    stop_defined: fmi3Boolean,
    stop: fmi3Float64,
) -> fmi3Status {
    let stop = (stop_defined != fmi3False).then_some(stop);
    let name = "fmi3EnterInitializationMode";
    unsafe {
        call::<U>(instance, name, &table::ENTER_INITIALIZATION, |i| {
            i.set_up(start, stop)?;
            i.enter_initialization();
            Ok(())
        })
    }
}

/// Functions whose only argument is the instance.
macro_rules! plain {
    ($($name:ident, $row:ident: |$instance:ident| $body:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(instance: fmi3Instance) -> fmi3Status {
            unsafe { call::<U>(instance, stringify!($name), &table::$row, |$instance| $body) }
        }
    )+};
}

plain! {
    fmi3EnterConfigurationMode, ENTER_CONFIGURATION: |i| i.enter_configuration();
    fmi3ExitConfigurationMode, EXIT_CONFIGURATION: |i| { i.exit_configuration(); Ok(()) };
    fmi3ExitInitializationMode, EXIT_INITIALIZATION: |i| i.exit_initialization();
    fmi3Terminate, TERMINATE: |i| { i.terminate(); Ok(()) };
    fmi3Reset, RESET: |i| { i.reset(); Ok(()) };
    fmi3EnterEventMode, ENTER_EVENT_MODE: |i| i.enter_event_mode();
    fmi3EnterContinuousTimeMode, ENTER_CONTINUOUS: |i| i.enter_continuous_time();
    fmi3EnterStepMode, ENTER_STEP_MODE: |i| i.enter_step_mode();
}

macro_rules! variables {
    ($($get:ident, $set:ident: $transfer:ty, $value:ty;)+) => {$(
        pub unsafe fn $get<U: Unit>(
            instance: fmi3Instance, references: *const fmi3ValueReference, n: usize,
            values: *mut $value, n_values: usize,
        ) -> fmi3Status {
            let call = (stringify!($get), &table::GET);
            let (references, values) = ((references, n), (values, n_values));
            unsafe {
                common::get::<U, $transfer>(instance, call, references, values, Addressing::Variables)
            }
        }
        pub unsafe fn $set<U: Unit>(
            instance: fmi3Instance, references: *const fmi3ValueReference, n: usize,
            values: *const $value, n_values: usize,
        ) -> fmi3Status {
            let call = (stringify!($set), &table::SET);
            let (references, values) = ((references, n), (values, n_values));
            unsafe {
                common::set::<U, $transfer>(instance, call, references, values, Addressing::Variables)
            }
        }
    )+};
}

variables! {
    fmi3GetFloat32, fmi3SetFloat32: Absent<fmi3Float32>, fmi3Float32;
    fmi3GetFloat64, fmi3SetFloat64: Float64, fmi3Float64;
    fmi3GetInt8, fmi3SetInt8: Absent<fmi3Int8>, fmi3Int8;
    fmi3GetUInt8, fmi3SetUInt8: Absent<fmi3UInt8>, fmi3UInt8;
    fmi3GetInt16, fmi3SetInt16: Absent<fmi3Int16>, fmi3Int16;
    fmi3GetUInt16, fmi3SetUInt16: Absent<fmi3UInt16>, fmi3UInt16;
    fmi3GetInt32, fmi3SetInt32: Int32, fmi3Int32;
    fmi3GetUInt32, fmi3SetUInt32: Absent<fmi3UInt32>, fmi3UInt32;
    fmi3GetInt64, fmi3SetInt64: Int64, fmi3Int64;
    fmi3GetUInt64, fmi3SetUInt64: UInt64, fmi3UInt64;
    fmi3GetBoolean, fmi3SetBoolean: Boolean<fmi3Boolean>, fmi3Boolean;
    fmi3GetString, fmi3SetString: Absent<fmi3String>, fmi3String;
}

pub unsafe fn fmi3GetFMUState<U: Unit>(
    instance: fmi3Instance,
    state: *mut fmi3FMUState,
) -> fmi3Status {
    let call = ("fmi3GetFMUState", &table::GET_FMU_STATE);
    unsafe { common::get_state::<U>(instance, call, state) }
}

pub unsafe fn fmi3SetFMUState<U: Unit>(instance: fmi3Instance, state: fmi3FMUState) -> fmi3Status {
    let call = ("fmi3SetFMUState", &table::SET_FMU_STATE);
    unsafe { common::set_state::<U>(instance, call, state) }
}

pub unsafe fn fmi3FreeFMUState<U: Unit>(
    instance: fmi3Instance,
    state: *mut fmi3FMUState,
) -> fmi3Status {
    unsafe { common::free_state::<U>(instance, "fmi3FreeFMUState", state) }
}

pub unsafe fn fmi3SerializedFMUStateSize<U: Unit>(
    instance: fmi3Instance,
    state: fmi3FMUState,
    size: *mut usize,
) -> fmi3Status {
    unsafe { common::state_size::<U>(instance, "fmi3SerializedFMUStateSize", state, size) }
}

pub unsafe fn fmi3SerializeFMUState<U: Unit>(
    instance: fmi3Instance,
    state: fmi3FMUState,
    bytes: *mut fmi3Byte,
    size: usize,
) -> fmi3Status {
    let bytes = (bytes, size);
    unsafe { common::serialize_state::<U>(instance, "fmi3SerializeFMUState", state, bytes) }
}

pub unsafe fn fmi3DeserializeFMUState<U: Unit>(
    instance: fmi3Instance,
    bytes: *const fmi3Byte,
    size: usize,
    state: *mut fmi3FMUState,
) -> fmi3Status {
    let bytes = (bytes, size);
    unsafe { common::deserialize_state::<U>(instance, "fmi3DeserializeFMUState", bytes, state) }
}

pub unsafe fn fmi3UpdateDiscreteStates<U: Unit>(
    instance: fmi3Instance,
    again: *mut fmi3Boolean,
    terminate: *mut fmi3Boolean,
    nominals_changed: *mut fmi3Boolean,
    states_changed: *mut fmi3Boolean,
    next_event_defined: *mut fmi3Boolean,
    next_event: *mut fmi3Float64,
) -> fmi3Status {
    let name = "fmi3UpdateDiscreteStates";
    unsafe {
        call::<U>(instance, name, &table::UPDATE_DISCRETE, |i| {
            let again = target(again, "discreteStatesNeedUpdate")?;
            let states_changed = target(states_changed, "valuesOfContinuousStatesChanged")?;
            let next_event_defined = target(next_event_defined, "nextEventTimeDefined")?;
            let next_event = target(next_event, "nextEventTime")?;
            *target(terminate, "terminateSimulation")? = fmi3False;
            *target(nominals_changed, "nominalsOfContinuousStatesChanged")? = fmi3False;
            let events = i.update_discrete()?;
            *again = events.again.into();
            *states_changed = events.states_changed.into();
            *next_event_defined = events.next.is_some().into();
            *next_event = events.next.unwrap_or(0.0);
            Ok(())
        })
    }
}

pub unsafe fn fmi3CompletedIntegratorStep<U: Unit>(
    instance: fmi3Instance,
    _no_set_fmu_state_prior: fmi3Boolean,
    enter_event_mode: *mut fmi3Boolean,
    terminate: *mut fmi3Boolean,
) -> fmi3Status {
    let name = "fmi3CompletedIntegratorStep";
    unsafe {
        call::<U>(instance, name, &table::COMPLETED_STEP, |i| {
            let event = target(enter_event_mode, "enterEventMode")?;
            *target(terminate, "terminateSimulation")? = fmi3False;
            *event = i.completed_step()?.into();
            Ok(())
        })
    }
}

pub unsafe fn fmi3SetTime<U: Unit>(instance: fmi3Instance, time: fmi3Float64) -> fmi3Status {
    unsafe {
        call::<U>(instance, "fmi3SetTime", &table::SET_TIME, |i| {
            i.set_time(time)
        })
    }
}

pub unsafe fn fmi3SetContinuousStates<U: Unit>(
    instance: fmi3Instance,
    states: *const fmi3Float64,
    n: usize,
) -> fmi3Status {
    let name = "fmi3SetContinuousStates";
    unsafe {
        call::<U>(instance, name, &table::SET_STATES, |i| {
            i.set_states(slice(states, n, "continuousStates")?)
        })
    }
}

/// Functions that fill an array, one value for each continuous state or event indicator.
macro_rules! fill {
    ($($name:ident: |$instance:ident, $values:ident| $body:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(
            instance: fmi3Instance, values: *mut fmi3Float64, n: usize,
        ) -> fmi3Status {
            unsafe {
                call::<U>(instance, stringify!($name), &table::GET_STATES, |$instance| {
                    let $values = slice_mut(values, n, "values")?;
                    $body
                })
            }
        }
    )+};
}

fill! {
    fmi3GetContinuousStates: |i, values| i.get_states(values);
    fmi3GetContinuousStateDerivatives: |i, values| i.get_derivatives(values);
    fmi3GetNominalsOfContinuousStates: |i, values| i.get_nominals(values);
    fmi3GetEventIndicators: |i, values| i.get_event_indicators(values);
}

macro_rules! derivative {
    ($($name:ident: $product:ident;)+) => {$(
        pub unsafe fn $name<U: Unit>(
            instance: fmi3Instance, unknowns: *const fmi3ValueReference, n_unknowns: usize,
            knowns: *const fmi3ValueReference, n_knowns: usize, seed: *const fmi3Float64, n_seed: usize,
            sensitivity: *mut fmi3Float64, n_sensitivity: usize,
        ) -> fmi3Status {
            let call = (stringify!($name), &table::DERIVATIVE);
            let references = [(unknowns, n_unknowns), (knowns, n_knowns)];
            let (seed, sensitivity) = ((seed, n_seed), (sensitivity, n_sensitivity));
            let (product, addressing) = (Product::$product, Addressing::Variables);
            unsafe { common::sensitivity::<U>(instance, call, product, references, seed, sensitivity, addressing) }
        }
    )+};
}

derivative! {
    fmi3GetDirectionalDerivative: Directional;
    fmi3GetAdjointDerivative: Adjoint;
}

/// Functions that tell a number that is known before the simulation.
macro_rules! count {
    ($($name:ident: $count:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(instance: fmi3Instance, n: *mut usize) -> fmi3Status {
            unsafe {
                call::<U>(instance, stringify!($name), &table::COUNTS, |_| {
                    *target(n, "the number")? = $count;
                    Ok(())
                })
            }
        }
    )+};
}

count! {
    fmi3GetNumberOfContinuousStates: U::Variables::MODEL.states.len();
    fmi3GetNumberOfEventIndicators: U::Variables::MODEL.event_indicators.len();
}
