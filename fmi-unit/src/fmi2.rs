//! FMI 2.0: translates each function of the standard into calls on an instance.
//!
//! Every function is `unsafe` for the same reason: the importer is C and vouches for its pointers. A
//! component is null or comes from [`fmi2Instantiate`] of the same unit; arrays are null or as long as
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

use fmi_abi::fmi2::*;
use std::ffi::c_char;

use crate::access::Addressing::Elements;
use crate::common;
use crate::guard::{call, create, enter, release};
use crate::instance::{Instance, Interface};
use crate::legality::{ALWAYS, Mode, fmi2 as table};
use crate::logger::Logger;
use crate::pointer::{slice, slice_mut, string, target};
use crate::sensitivity::Product;
use crate::step::Progress;
use crate::transfer::{Absent, Boolean, Float64, Integer};
use crate::unit::{Failure, Unit};

pub fn fmi2GetTypesPlatform<U: Unit>() -> *const c_char {
    c"default".as_ptr()
}

pub fn fmi2GetVersion<U: Unit>() -> *const c_char {
    c"2.0".as_ptr()
}

pub unsafe fn fmi2SetDebugLogging<U: Unit>(
    c: fmi2Component,
    on: fmi2Boolean,
    n: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    let on = on != fmi2False;
    unsafe { common::set_debug_logging::<U>(c, "fmi2SetDebugLogging", on, n, categories) }
}

pub unsafe fn fmi2Instantiate<U: Unit>(
    name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    _resources: fmi2String,
    callbacks: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging: fmi2Boolean,
) -> fmi2Component {
    let logger = unsafe { Logger::fmi2(callbacks) };
    create("fmi2Instantiate", logger, |logger| {
        let interface = match kind {
            _ if kind == fmi2ModelExchange => Interface::ModelExchange,
            _ if kind == fmi2CoSimulation => Interface::CoSimulation,
            _ => return Err(Failure(format!("FMU type {kind} is unknown"))),
        };
        let (name, guid) = unsafe { (string(name), string(guid)) };
        let logging = logging != fmi2False;
        Instance::<U>::new(logger, name.as_deref(), guid.as_deref(), interface, logging)
    })
}

pub unsafe fn fmi2FreeInstance<U: Unit>(c: fmi2Component) {
    unsafe { release::<U>(c, "fmi2FreeInstance") }
}

pub unsafe fn fmi2SetupExperiment<U: Unit>(
    c: fmi2Component,
    _tolerance_defined: fmi2Boolean,
    _tolerance: fmi2Real,
    start: fmi2Real,
    stop_defined: fmi2Boolean,
    stop: fmi2Real,
) -> fmi2Status {
    let stop = (stop_defined != fmi2False).then_some(stop);
    unsafe {
        call::<U>(c, "fmi2SetupExperiment", &table::SETUP_EXPERIMENT, |i| {
            i.set_up(start, stop)
        })
    }
}

/// Functions whose only argument is the component.
macro_rules! plain {
    ($($name:ident, $row:ident: |$instance:ident| $body:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(c: fmi2Component) -> fmi2Status {
            unsafe { call::<U>(c, stringify!($name), &table::$row, |$instance| $body) }
        }
    )+};
}

plain! {
    fmi2EnterInitializationMode, ENTER_INITIALIZATION: |i| { i.enter_initialization(); Ok(()) };
    fmi2ExitInitializationMode, EXIT_INITIALIZATION: |i| i.exit_initialization();
    fmi2Terminate, TERMINATE: |i| { i.terminate(); Ok(()) };
    fmi2Reset, RESET: |i| { i.reset(); Ok(()) };
    fmi2EnterEventMode, ENTER_EVENT_MODE: |i| i.enter_event_mode();
    fmi2EnterContinuousTimeMode, ENTER_CONTINUOUS: |i| i.enter_continuous_time();
}

macro_rules! variables {
    ($($get:ident, $set:ident: $transfer:ty, $value:ty;)+) => {$(
        pub unsafe fn $get<U: Unit>(
            c: fmi2Component, vr: *const fmi2ValueReference, n: usize, values: *mut $value,
        ) -> fmi2Status {
            let call = (stringify!($get), &table::GET);
            unsafe { common::get::<U, $transfer>(c, call, (vr, n), (values, n), Elements) }
        }
        pub unsafe fn $set<U: Unit>(
            c: fmi2Component, vr: *const fmi2ValueReference, n: usize, values: *const $value,
        ) -> fmi2Status {
            let call = (stringify!($set), &table::SET);
            unsafe { common::set::<U, $transfer>(c, call, (vr, n), (values, n), Elements) }
        }
    )+};
}

variables! {
    fmi2GetReal, fmi2SetReal: Float64, fmi2Real;
    fmi2GetInteger, fmi2SetInteger: Integer, fmi2Integer;
    fmi2GetBoolean, fmi2SetBoolean: Boolean<fmi2Boolean>, fmi2Boolean;
    fmi2GetString, fmi2SetString: Absent<fmi2String>, fmi2String;
}

pub unsafe fn fmi2GetFMUstate<U: Unit>(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    let call = ("fmi2GetFMUstate", &table::GET_FMU_STATE);
    unsafe { common::get_state::<U>(c, call, state) }
}

pub unsafe fn fmi2SetFMUstate<U: Unit>(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    let call = ("fmi2SetFMUstate", &table::SET_FMU_STATE);
    unsafe { common::set_state::<U>(c, call, state) }
}

pub unsafe fn fmi2FreeFMUstate<U: Unit>(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    unsafe { common::free_state::<U>(c, "fmi2FreeFMUstate", state) }
}

pub unsafe fn fmi2SerializedFMUstateSize<U: Unit>(
    c: fmi2Component,
    state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    unsafe { common::state_size::<U>(c, "fmi2SerializedFMUstateSize", state, size) }
}

pub unsafe fn fmi2SerializeFMUstate<U: Unit>(
    c: fmi2Component,
    state: fmi2FMUstate,
    bytes: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    let bytes = (bytes.cast(), size);
    unsafe { common::serialize_state::<U>(c, "fmi2SerializeFMUstate", state, bytes) }
}

pub unsafe fn fmi2DeSerializeFMUstate<U: Unit>(
    c: fmi2Component,
    bytes: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let bytes = (bytes.cast(), size);
    unsafe { common::deserialize_state::<U>(c, "fmi2DeSerializeFMUstate", bytes, state) }
}

pub unsafe fn fmi2GetDirectionalDerivative<U: Unit>(
    c: fmi2Component,
    unknowns: *const fmi2ValueReference,
    n_unknowns: usize,
    knowns: *const fmi2ValueReference,
    n_knowns: usize,
    seed: *const fmi2Real,
    sensitivity: *mut fmi2Real,
) -> fmi2Status {
    let call = ("fmi2GetDirectionalDerivative", &table::DERIVATIVE);
    let references = [(unknowns, n_unknowns), (knowns, n_knowns)];
    let (seed, sensitivity) = ((seed, n_knowns), (sensitivity, n_unknowns));
    let product = Product::Directional;
    unsafe { common::sensitivity::<U>(c, call, product, references, seed, sensitivity, Elements) }
}

pub unsafe fn fmi2NewDiscreteStates<U: Unit>(
    c: fmi2Component,
    info: *mut fmi2EventInfo,
) -> fmi2Status {
    unsafe {
        call::<U>(
            c,
            "fmi2NewDiscreteStates",
            &table::NEW_DISCRETE_STATES,
            |i| {
                let info = target(info, "eventInfo")?;
                let events = i.update_discrete()?;
                *info = fmi2EventInfo {
                    newDiscreteStatesNeeded: events.again.into(),
                    terminateSimulation: fmi2False,
                    nominalsOfContinuousStatesChanged: fmi2False,
                    valuesOfContinuousStatesChanged: events.states_changed.into(),
                    nextEventTimeDefined: events.next.is_some().into(),
                    nextEventTime: events.next.unwrap_or(0.0),
                };
                Ok(())
            },
        )
    }
}

pub unsafe fn fmi2CompletedIntegratorStep<U: Unit>(
    c: fmi2Component,
    _no_set_fmu_state_prior: fmi2Boolean,
    enter_event_mode: *mut fmi2Boolean,
    terminate: *mut fmi2Boolean,
) -> fmi2Status {
    unsafe {
        call::<U>(
            c,
            "fmi2CompletedIntegratorStep",
            &table::COMPLETED_STEP,
            |i| {
                let event = target(enter_event_mode, "enterEventMode")?;
                *target(terminate, "terminateSimulation")? = fmi2False;
                *event = i.completed_step()?.into();
                Ok(())
            },
        )
    }
}

pub unsafe fn fmi2SetTime<U: Unit>(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    unsafe { call::<U>(c, "fmi2SetTime", &table::SET_TIME, |i| i.set_time(time)) }
}

pub unsafe fn fmi2SetContinuousStates<U: Unit>(
    c: fmi2Component,
    x: *const fmi2Real,
    n: usize,
) -> fmi2Status {
    unsafe {
        call::<U>(c, "fmi2SetContinuousStates", &table::SET_STATES, |i| {
            i.set_states(slice(x, n, "x")?)
        })
    }
}

/// Functions that fill an array, one value for each continuous state or event indicator.
macro_rules! fill {
    ($($name:ident: |$instance:ident, $values:ident| $body:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(
            c: fmi2Component, values: *mut fmi2Real, n: usize,
        ) -> fmi2Status {
            unsafe {
                call::<U>(c, stringify!($name), &table::GET_STATES, |$instance| {
                    let $values = slice_mut(values, n, "values")?;
                    $body
                })
            }
        }
    )+};
}

fill! {
    fmi2GetContinuousStates: |i, values| i.get_states(values);
    fmi2GetDerivatives: |i, values| i.get_derivatives(values);
    fmi2GetNominalsOfContinuousStates: |i, values| i.get_nominals(values);
    fmi2GetEventIndicators: |i, values| i.get_event_indicators(values);
}

pub unsafe fn fmi2SetRealInputDerivatives<U: Unit>(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    n: usize,
    _order: *const fmi2Integer,
    _value: *const fmi2Real,
) -> fmi2Status {
    let name = "fmi2SetRealInputDerivatives";
    unsafe { common::undeclared::<U>(c, name, n > 0, "interpolation of inputs") }
}

pub unsafe fn fmi2GetRealOutputDerivatives<U: Unit>(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    n: usize,
    _order: *const fmi2Integer,
    _value: *mut fmi2Real,
) -> fmi2Status {
    let name = "fmi2GetRealOutputDerivatives";
    unsafe { common::undeclared::<U>(c, name, n > 0, "the derivative of an output") }
}

pub unsafe fn fmi2DoStep<U: Unit>(
    c: fmi2Component,
    point: fmi2Real,
    size: fmi2Real,
    _no_set_fmu_state_prior: fmi2Boolean,
) -> fmi2Status {
    unsafe {
        call::<U>(c, "fmi2DoStep", &table::DO_STEP, |i| {
            let mut step = i.begin_step(point, size)?;
            while let Progress::Event(_) = i.proceed(&mut step)? {}
            Ok(())
        })
    }
}

pub unsafe fn fmi2CancelStep<U: Unit>(c: fmi2Component) -> fmi2Status {
    unsafe { common::undeclared::<U>(c, "fmi2CancelStep", true, "an asynchronous step") }
}

/// Inquiries after a step. Steps are never pending, so that only the time and the end of the
/// simulation have an answer of their own; the others are discarded.
macro_rules! status {
    ($($name:ident, $value:ty: |$instance:ident, $kind:ident| $answer:expr;)+) => {$(
        pub unsafe fn $name<U: Unit>(
            c: fmi2Component, kind: fmi2StatusKind, value: *mut $value,
        ) -> fmi2Status {
            let answer = unsafe {
                enter::<U, _>(c, stringify!($name), &ALWAYS, |$instance| {
                    let value = target(value, "value")?;
                    let $kind = kind;
                    let answer: Option<$value> = $answer;
                    Ok(answer.map(|answer| *value = answer))
                })
            };
            match answer {
                Ok(Some(())) => fmi2OK,
                Ok(None) => fmi2Discard,
                Err(status) => status as fmi2Status,
            }
        }
    )+};
}

status! {
    fmi2GetStatus, fmi2Status: |i, kind| (kind == fmi2DoStepStatus).then_some(
        if i.now.mode == Mode::Failed { fmi2Error } else { fmi2OK }
    );
    fmi2GetRealStatus, fmi2Real: |i, kind| (kind == fmi2LastSuccessfulTime).then_some(i.now.time);
    fmi2GetIntegerStatus, fmi2Integer: |_i, _kind| None;
    fmi2GetBooleanStatus, fmi2Boolean: |_i, kind| (kind == fmi2Terminated).then_some(fmi2False);
    fmi2GetStringStatus, fmi2String: |_i, _kind| None;
}
