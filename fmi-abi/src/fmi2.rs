//! Types and function signatures of FMI 2.0 (`fmi2TypesPlatform.h`, `fmi2FunctionTypes.h` of FMI 2.0.4).
//!
//! Every foreign value is a plain integer, a float or a raw pointer: enumerations and booleans that a
//! faulty partner returns may be out of range, and that must not be undefined behaviour.

use std::ffi::{c_char, c_int, c_void};

/// Pointer to an instance of the FMU.
pub type fmi2Component = *mut c_void;
/// Pointer to the importer's own data, handed back in callbacks.
pub type fmi2ComponentEnvironment = *mut c_void;
/// Pointer to a saved state of the FMU.
pub type fmi2FMUstate = *mut c_void;
/// Handle of a variable.
pub type fmi2ValueReference = u32;
/// Floating point number.
pub type fmi2Real = f64;
/// Integer.
pub type fmi2Integer = c_int;
/// Truth value: [`fmi2True`] or [`fmi2False`]; foreign values may be any integer.
pub type fmi2Boolean = c_int;
/// Character of a string.
pub type fmi2Char = c_char;
/// String in UTF-8, ended by a null character; may be null.
pub type fmi2String = *const fmi2Char;
/// Byte of a serialized state.
pub type fmi2Byte = c_char;

/// True.
pub const fmi2True: fmi2Boolean = 1;
/// False.
pub const fmi2False: fmi2Boolean = 0;

/// Outcome of a call, one of [`fmi2OK`] to [`fmi2Pending`]; foreign values may be any integer.
pub type fmi2Status = c_int;
pub const fmi2OK: fmi2Status = 0;
pub const fmi2Warning: fmi2Status = 1;
pub const fmi2Discard: fmi2Status = 2;
pub const fmi2Error: fmi2Status = 3;
pub const fmi2Fatal: fmi2Status = 4;
pub const fmi2Pending: fmi2Status = 5;

/// Kind of an instance.
pub type fmi2Type = c_int;
pub const fmi2ModelExchange: fmi2Type = 0;
pub const fmi2CoSimulation: fmi2Type = 1;

/// What to inquire of an asynchronous step.
pub type fmi2StatusKind = c_int;
pub const fmi2DoStepStatus: fmi2StatusKind = 0;
pub const fmi2PendingStatus: fmi2StatusKind = 1;
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
pub const fmi2Terminated: fmi2StatusKind = 3;

/// Receives log messages; variadic like `printf`.
pub type fmi2CallbackLogger = Option<
    unsafe extern "C" fn(
        componentEnvironment: fmi2ComponentEnvironment,
        instanceName: fmi2String,
        status: fmi2Status,
        category: fmi2String,
        message: fmi2String,
        ...
    ),
>;
/// Allocates zeroed memory.
pub type fmi2CallbackAllocateMemory =
    Option<unsafe extern "C" fn(nobj: usize, size: usize) -> *mut c_void>;
/// Frees memory of [`fmi2CallbackAllocateMemory`].
pub type fmi2CallbackFreeMemory = Option<unsafe extern "C" fn(obj: *mut c_void)>;
/// Announces the end of an asynchronous step.
pub type fmi2StepFinished = Option<
    unsafe extern "C" fn(componentEnvironment: fmi2ComponentEnvironment, status: fmi2Status),
>;

/// Functions that the importer provides.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct fmi2CallbackFunctions {
    pub logger: fmi2CallbackLogger,
    pub allocateMemory: fmi2CallbackAllocateMemory,
    pub freeMemory: fmi2CallbackFreeMemory,
    pub stepFinished: fmi2StepFinished,
    pub componentEnvironment: fmi2ComponentEnvironment,
}

/// Outcome of an event iteration in Model Exchange.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct fmi2EventInfo {
    pub newDiscreteStatesNeeded: fmi2Boolean,
    pub terminateSimulation: fmi2Boolean,
    pub nominalsOfContinuousStatesChanged: fmi2Boolean,
    pub valuesOfContinuousStatesChanged: fmi2Boolean,
    pub nextEventTimeDefined: fmi2Boolean,
    pub nextEventTime: fmi2Real,
}

pub type fmi2GetTypesPlatformTYPE = Option<unsafe extern "C" fn() -> *const c_char>;
pub type fmi2GetVersionTYPE = Option<unsafe extern "C" fn() -> *const c_char>;
pub type fmi2SetDebugLoggingTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        loggingOn: fmi2Boolean,
        nCategories: usize,
        categories: *const fmi2String,
    ) -> fmi2Status,
>;
pub type fmi2InstantiateTYPE = Option<
    unsafe extern "C" fn(
        instanceName: fmi2String,
        fmuType: fmi2Type,
        fmuGUID: fmi2String,
        fmuResourceLocation: fmi2String,
        functions: *const fmi2CallbackFunctions,
        visible: fmi2Boolean,
        loggingOn: fmi2Boolean,
    ) -> fmi2Component,
>;
pub type fmi2FreeInstanceTYPE = Option<unsafe extern "C" fn(c: fmi2Component)>;
pub type fmi2SetupExperimentTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        toleranceDefined: fmi2Boolean,
        tolerance: fmi2Real,
        startTime: fmi2Real,
        stopTimeDefined: fmi2Boolean,
        stopTime: fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2EnterInitializationModeTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2ExitInitializationModeTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2TerminateTYPE = Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2ResetTYPE = Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;

/// `fmi2GetReal` and its like: one value for each reference (FMI 2.0.4 sec 2.1.7).
pub type fmi2GetTYPE<T> = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *mut T,
    ) -> fmi2Status,
>;
pub type fmi2GetRealTYPE = fmi2GetTYPE<fmi2Real>;
pub type fmi2GetIntegerTYPE = fmi2GetTYPE<fmi2Integer>;
pub type fmi2GetBooleanTYPE = fmi2GetTYPE<fmi2Boolean>;
pub type fmi2GetStringTYPE = fmi2GetTYPE<fmi2String>;

/// `fmi2SetReal` and its like: one value for each reference (FMI 2.0.4 sec 2.1.7).
pub type fmi2SetTYPE<T> = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        value: *const T,
    ) -> fmi2Status,
>;
pub type fmi2SetRealTYPE = fmi2SetTYPE<fmi2Real>;
pub type fmi2SetIntegerTYPE = fmi2SetTYPE<fmi2Integer>;
pub type fmi2SetBooleanTYPE = fmi2SetTYPE<fmi2Boolean>;
pub type fmi2SetStringTYPE = fmi2SetTYPE<fmi2String>;

pub type fmi2GetFMUstateTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status>;
pub type fmi2SetFMUstateTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status>;
pub type fmi2FreeFMUstateTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status>;
pub type fmi2SerializedFMUstateSizeTYPE = Option<
    unsafe extern "C" fn(c: fmi2Component, FMUstate: fmi2FMUstate, size: *mut usize) -> fmi2Status,
>;
pub type fmi2SerializeFMUstateTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        FMUstate: fmi2FMUstate,
        serializedState: *mut fmi2Byte,
        size: usize,
    ) -> fmi2Status,
>;
pub type fmi2DeSerializeFMUstateTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        serializedState: *const fmi2Byte,
        size: usize,
        FMUstate: *mut fmi2FMUstate,
    ) -> fmi2Status,
>;
pub type fmi2GetDirectionalDerivativeTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vUnknown_ref: *const fmi2ValueReference,
        nUnknown: usize,
        vKnown_ref: *const fmi2ValueReference,
        nKnown: usize,
        dvKnown: *const fmi2Real,
        dvUnknown: *mut fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2EnterEventModeTYPE = Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2NewDiscreteStatesTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, fmi2eventInfo: *mut fmi2EventInfo) -> fmi2Status>;
pub type fmi2EnterContinuousTimeModeTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2CompletedIntegratorStepTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
        enterEventMode: *mut fmi2Boolean,
        terminateSimulation: *mut fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2SetTimeTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, time: fmi2Real) -> fmi2Status>;
pub type fmi2SetContinuousStatesTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, x: *const fmi2Real, nx: usize) -> fmi2Status>;
pub type fmi2GetDerivativesTYPE = Option<
    unsafe extern "C" fn(c: fmi2Component, derivatives: *mut fmi2Real, nx: usize) -> fmi2Status,
>;
pub type fmi2GetEventIndicatorsTYPE = Option<
    unsafe extern "C" fn(c: fmi2Component, eventIndicators: *mut fmi2Real, ni: usize) -> fmi2Status,
>;
pub type fmi2GetContinuousStatesTYPE =
    Option<unsafe extern "C" fn(c: fmi2Component, x: *mut fmi2Real, nx: usize) -> fmi2Status>;
pub type fmi2GetNominalsOfContinuousStatesTYPE = Option<
    unsafe extern "C" fn(c: fmi2Component, x_nominal: *mut fmi2Real, nx: usize) -> fmi2Status,
>;
pub type fmi2SetRealInputDerivativesTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *const fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2GetRealOutputDerivativesTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        vr: *const fmi2ValueReference,
        nvr: usize,
        order: *const fmi2Integer,
        value: *mut fmi2Real,
    ) -> fmi2Status,
>;
pub type fmi2DoStepTYPE = Option<
    unsafe extern "C" fn(
        c: fmi2Component,
        currentCommunicationPoint: fmi2Real,
        communicationStepSize: fmi2Real,
        noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    ) -> fmi2Status,
>;
pub type fmi2CancelStepTYPE = Option<unsafe extern "C" fn(c: fmi2Component) -> fmi2Status>;
pub type fmi2GetStatusTYPE = Option<
    unsafe extern "C" fn(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Status) -> fmi2Status,
>;

/// `fmi2GetRealStatus` and its like: what a running step has to say (FMI 2.0.4 sec 4.2.3).
pub type fmi2GetXxxStatusTYPE<T> =
    Option<unsafe extern "C" fn(c: fmi2Component, s: fmi2StatusKind, value: *mut T) -> fmi2Status>;
pub type fmi2GetRealStatusTYPE = fmi2GetXxxStatusTYPE<fmi2Real>;
pub type fmi2GetIntegerStatusTYPE = fmi2GetXxxStatusTYPE<fmi2Integer>;
pub type fmi2GetBooleanStatusTYPE = fmi2GetXxxStatusTYPE<fmi2Boolean>;
pub type fmi2GetStringStatusTYPE = fmi2GetXxxStatusTYPE<fmi2String>;
