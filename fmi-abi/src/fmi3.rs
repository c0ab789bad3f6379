//! Types of FMI 3.0 (`fmi3PlatformTypes.h`, `fmi3FunctionTypes.h` of FMI 3.0.2).
//!
//! Every foreign value is a plain integer, a float or a raw pointer: enumerations and booleans that a
//! faulty partner returns may be out of range, and that must not be undefined behaviour.

mod functions;

pub use functions::*;

use std::ffi::{c_char, c_int, c_void};

/// Pointer to an instance of the FMU.
pub type fmi3Instance = *mut c_void;
/// Pointer to the importer's own data, handed back in callbacks.
pub type fmi3InstanceEnvironment = *mut c_void;
/// Pointer to a saved state of the FMU.
pub type fmi3FMUState = *mut c_void;
/// Handle of a variable.
pub type fmi3ValueReference = u32;
pub type fmi3Float32 = f32;
pub type fmi3Float64 = f64;
pub type fmi3Int8 = i8;
pub type fmi3UInt8 = u8;
pub type fmi3Int16 = i16;
pub type fmi3UInt16 = u16;
pub type fmi3Int32 = i32;
pub type fmi3UInt32 = u32;
pub type fmi3Int64 = i64;
pub type fmi3UInt64 = u64;
/// Truth value: C `bool`, one byte; foreign values may be any byte.
pub type fmi3Boolean = u8;
/// Character of a string.
pub type fmi3Char = c_char;
/// String in UTF-8, ended by a null character; may be null.
pub type fmi3String = *const fmi3Char;
/// Byte of binary data.
pub type fmi3Byte = u8;
/// Binary data, its length given beside it.
pub type fmi3Binary = *const fmi3Byte;
/// Activation of a clock: C `bool`, one byte; foreign values may be any byte.
pub type fmi3Clock = u8;

/// True.
pub const fmi3True: fmi3Boolean = 1;
/// False.
pub const fmi3False: fmi3Boolean = 0;
/// The clock ticks.
pub const fmi3ClockActive: fmi3Clock = 1;
/// The clock does not tick.
pub const fmi3ClockInactive: fmi3Clock = 0;

/// Outcome of a call, one of [`fmi3OK`] to [`fmi3Fatal`]; foreign values may be any integer.
pub type fmi3Status = c_int;
pub const fmi3OK: fmi3Status = 0;
pub const fmi3Warning: fmi3Status = 1;
pub const fmi3Discard: fmi3Status = 2;
pub const fmi3Error: fmi3Status = 3;
pub const fmi3Fatal: fmi3Status = 4;

/// How a variable depends on another.
pub type fmi3DependencyKind = c_int;
pub const fmi3Independent: fmi3DependencyKind = 0;
pub const fmi3Constant: fmi3DependencyKind = 1;
pub const fmi3Fixed: fmi3DependencyKind = 2;
pub const fmi3Tunable: fmi3DependencyKind = 3;
pub const fmi3Discrete: fmi3DependencyKind = 4;
pub const fmi3Dependent: fmi3DependencyKind = 5;

/// Whether the interval of a clock is known.
pub type fmi3IntervalQualifier = c_int;
pub const fmi3IntervalNotYetKnown: fmi3IntervalQualifier = 0;
pub const fmi3IntervalUnchanged: fmi3IntervalQualifier = 1;
pub const fmi3IntervalChanged: fmi3IntervalQualifier = 2;

/// Receives log messages.
pub type fmi3LogMessageCallback = Option<
    unsafe extern "C" fn(
        instanceEnvironment: fmi3InstanceEnvironment,
        status: fmi3Status,
        category: fmi3String,
        message: fmi3String,
    ),
>;
/// Announces a change of an output clock.
pub type fmi3ClockUpdateCallback =
    Option<unsafe extern "C" fn(instanceEnvironment: fmi3InstanceEnvironment)>;
/// Lets the importer look at an instant inside a step.
pub type fmi3IntermediateUpdateCallback = Option<
    unsafe extern "C" fn(
        instanceEnvironment: fmi3InstanceEnvironment,
        intermediateUpdateTime: fmi3Float64,
        intermediateVariableSetRequested: fmi3Boolean,
        intermediateVariableGetAllowed: fmi3Boolean,
        intermediateStepFinished: fmi3Boolean,
        canReturnEarly: fmi3Boolean,
        earlyReturnRequested: *mut fmi3Boolean,
        earlyReturnTime: *mut fmi3Float64,
    ),
>;
/// Begins a section that no other model partition may interrupt.
pub type fmi3LockPreemptionCallback = Option<unsafe extern "C" fn()>;
/// Ends a section that no other model partition may interrupt.
pub type fmi3UnlockPreemptionCallback = Option<unsafe extern "C" fn()>;
