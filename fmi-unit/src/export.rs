//! The macro that turns a [`Unit`](crate::Unit) into the functions that a binary exports.

/// Exports every function of FMI 2.0 and FMI 3.0 for a [`Unit`](crate::Unit), each as a symbol of its
/// own; the compiler checks every signature against the standard's. Once in a cdylib.
#[macro_export]
macro_rules! export {
    ($unit:ty) => {
        $crate::export_fmi2!($unit);
        $crate::export_fmi3!($unit);
    };
}

/// Defines functions that only forward to those of a version module.
#[doc(hidden)]
#[macro_export]
macro_rules! forward {
    ($unit:ty, $version:ident;
     $($name:ident: $type:ident ($($argument:ident: $value:ty),*) $(-> $result:ty)?;)+) => {$(
        const _: $type = {
            #[unsafe(no_mangle)]
            #[allow(non_snake_case, clippy::too_many_arguments)]
            unsafe extern "C" fn $name($($argument: $value),*) $(-> $result)? {
                // SAFETY: the importer vouches for what it passes, see the version module.
                #[allow(unused_unsafe, reason = "some functions take no pointers")]
                unsafe { $crate::$version::$name::<$unit>($($argument),*) }
            }
            Some($name)
        };
    )+};
}

#[doc(hidden)]
#[macro_export]
#[rustfmt::skip]
macro_rules! export_fmi2 {
    ($unit:ty) => { const _: () = {
        use $crate::abi::fmi2::*;
        use ::std::ffi::c_char;
        $crate::forward! { $unit, fmi2;
            fmi2GetTypesPlatform: fmi2GetTypesPlatformTYPE () -> *const c_char;
            fmi2GetVersion: fmi2GetVersionTYPE () -> *const c_char;
            fmi2SetDebugLogging: fmi2SetDebugLoggingTYPE (a: fmi2Component, b: fmi2Boolean, c: usize,
                d: *const fmi2String) -> fmi2Status;
            fmi2Instantiate: fmi2InstantiateTYPE (a: fmi2String, b: fmi2Type, c: fmi2String, d: fmi2String,
                e: *const fmi2CallbackFunctions, f: fmi2Boolean, g: fmi2Boolean) -> fmi2Component;
            fmi2FreeInstance: fmi2FreeInstanceTYPE (a: fmi2Component);
            fmi2SetupExperiment: fmi2SetupExperimentTYPE (a: fmi2Component, b: fmi2Boolean, c: fmi2Real,
                d: fmi2Real, e: fmi2Boolean, f: fmi2Real) -> fmi2Status;
            fmi2EnterInitializationMode: fmi2EnterInitializationModeTYPE (a: fmi2Component) -> fmi2Status;
            fmi2ExitInitializationMode: fmi2ExitInitializationModeTYPE (a: fmi2Component) -> fmi2Status;
            fmi2Terminate: fmi2TerminateTYPE (a: fmi2Component) -> fmi2Status;
            fmi2Reset: fmi2ResetTYPE (a: fmi2Component) -> fmi2Status;
            fmi2GetReal: fmi2GetRealTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *mut fmi2Real) -> fmi2Status;
            fmi2GetInteger: fmi2GetIntegerTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *mut fmi2Integer) -> fmi2Status;
            fmi2GetBoolean: fmi2GetBooleanTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *mut fmi2Boolean) -> fmi2Status;
            fmi2GetString: fmi2GetStringTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *mut fmi2String) -> fmi2Status;
            fmi2SetReal: fmi2SetRealTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *const fmi2Real) -> fmi2Status;
            fmi2SetInteger: fmi2SetIntegerTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *const fmi2Integer) -> fmi2Status;
            fmi2SetBoolean: fmi2SetBooleanTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *const fmi2Boolean) -> fmi2Status;
            fmi2SetString: fmi2SetStringTYPE (a: fmi2Component, b: *const fmi2ValueReference, c: usize,
                d: *const fmi2String) -> fmi2Status;
            fmi2GetFMUstate: fmi2GetFMUstateTYPE (a: fmi2Component, b: *mut fmi2FMUstate) -> fmi2Status;
            fmi2SetFMUstate: fmi2SetFMUstateTYPE (a: fmi2Component, b: fmi2FMUstate) -> fmi2Status;
            fmi2FreeFMUstate: fmi2FreeFMUstateTYPE (a: fmi2Component, b: *mut fmi2FMUstate) -> fmi2Status;
            fmi2SerializedFMUstateSize: fmi2SerializedFMUstateSizeTYPE (a: fmi2Component, b: fmi2FMUstate,
                c: *mut usize) -> fmi2Status;
            fmi2SerializeFMUstate: fmi2SerializeFMUstateTYPE (a: fmi2Component, b: fmi2FMUstate,
                c: *mut fmi2Byte, d: usize) -> fmi2Status;
            fmi2DeSerializeFMUstate: fmi2DeSerializeFMUstateTYPE (a: fmi2Component, b: *const fmi2Byte,
                c: usize, d: *mut fmi2FMUstate) -> fmi2Status;
            fmi2GetDirectionalDerivative: fmi2GetDirectionalDerivativeTYPE (a: fmi2Component,
                b: *const fmi2ValueReference, c: usize, d: *const fmi2ValueReference, e: usize,
                f: *const fmi2Real, g: *mut fmi2Real) -> fmi2Status;
            fmi2EnterEventMode: fmi2EnterEventModeTYPE (a: fmi2Component) -> fmi2Status;
            fmi2NewDiscreteStates: fmi2NewDiscreteStatesTYPE (a: fmi2Component,
                b: *mut fmi2EventInfo) -> fmi2Status;
            fmi2EnterContinuousTimeMode: fmi2EnterContinuousTimeModeTYPE (a: fmi2Component) -> fmi2Status;
            fmi2CompletedIntegratorStep: fmi2CompletedIntegratorStepTYPE (a: fmi2Component, b: fmi2Boolean,
                c: *mut fmi2Boolean, d: *mut fmi2Boolean) -> fmi2Status;
            fmi2SetTime: fmi2SetTimeTYPE (a: fmi2Component, b: fmi2Real) -> fmi2Status;
            fmi2SetContinuousStates: fmi2SetContinuousStatesTYPE (a: fmi2Component, b: *const fmi2Real,
                c: usize) -> fmi2Status;
            fmi2GetDerivatives: fmi2GetDerivativesTYPE (a: fmi2Component, b: *mut fmi2Real,
                c: usize) -> fmi2Status;
            fmi2GetEventIndicators: fmi2GetEventIndicatorsTYPE (a: fmi2Component, b: *mut fmi2Real,
                c: usize) -> fmi2Status;
            fmi2GetContinuousStates: fmi2GetContinuousStatesTYPE (a: fmi2Component, b: *mut fmi2Real,
                c: usize) -> fmi2Status;
            fmi2GetNominalsOfContinuousStates: fmi2GetNominalsOfContinuousStatesTYPE (a: fmi2Component,
                b: *mut fmi2Real, c: usize) -> fmi2Status;
            fmi2SetRealInputDerivatives: fmi2SetRealInputDerivativesTYPE (a: fmi2Component,
                b: *const fmi2ValueReference, c: usize, d: *const fmi2Integer,
                e: *const fmi2Real) -> fmi2Status;
            fmi2GetRealOutputDerivatives: fmi2GetRealOutputDerivativesTYPE (a: fmi2Component,
                b: *const fmi2ValueReference, c: usize, d: *const fmi2Integer,
                e: *mut fmi2Real) -> fmi2Status;
            fmi2DoStep: fmi2DoStepTYPE (a: fmi2Component, b: fmi2Real, c: fmi2Real,
                d: fmi2Boolean) -> fmi2Status;
            fmi2CancelStep: fmi2CancelStepTYPE (a: fmi2Component) -> fmi2Status;
            fmi2GetStatus: fmi2GetStatusTYPE (a: fmi2Component, b: fmi2StatusKind,
                c: *mut fmi2Status) -> fmi2Status;
            fmi2GetRealStatus: fmi2GetRealStatusTYPE (a: fmi2Component, b: fmi2StatusKind,
                c: *mut fmi2Real) -> fmi2Status;
            fmi2GetIntegerStatus: fmi2GetIntegerStatusTYPE (a: fmi2Component, b: fmi2StatusKind,
                c: *mut fmi2Integer) -> fmi2Status;
            fmi2GetBooleanStatus: fmi2GetBooleanStatusTYPE (a: fmi2Component, b: fmi2StatusKind,
                c: *mut fmi2Boolean) -> fmi2Status;
            fmi2GetStringStatus: fmi2GetStringStatusTYPE (a: fmi2Component, b: fmi2StatusKind,
                c: *mut fmi2String) -> fmi2Status;
        }
    }; };
}

#[doc(hidden)]
#[macro_export]
#[rustfmt::skip]
macro_rules! export_fmi3 {
    ($unit:ty) => { const _: () = {
        use $crate::abi::fmi3::*;
        use ::std::ffi::c_char;
        $crate::forward! { $unit, fmi3;
            fmi3GetVersion: fmi3GetVersionTYPE () -> *const c_char;
            fmi3SetDebugLogging: fmi3SetDebugLoggingTYPE (a: fmi3Instance, b: fmi3Boolean, c: usize,
                d: *const fmi3String) -> fmi3Status;
            fmi3InstantiateModelExchange: fmi3InstantiateModelExchangeTYPE (a: fmi3String, b: fmi3String,
                c: fmi3String, d: fmi3Boolean, e: fmi3Boolean, f: fmi3InstanceEnvironment,
                g: fmi3LogMessageCallback) -> fmi3Instance;
            fmi3InstantiateCoSimulation: fmi3InstantiateCoSimulationTYPE (a: fmi3String, b: fmi3String,
                c: fmi3String, d: fmi3Boolean, e: fmi3Boolean, f: fmi3Boolean, g: fmi3Boolean,
                h: *const fmi3ValueReference, i: usize, j: fmi3InstanceEnvironment,
                k: fmi3LogMessageCallback, l: fmi3IntermediateUpdateCallback) -> fmi3Instance;
            fmi3InstantiateScheduledExecution: fmi3InstantiateScheduledExecutionTYPE (a: fmi3String,
                b: fmi3String, c: fmi3String, d: fmi3Boolean, e: fmi3Boolean, f: fmi3InstanceEnvironment,
                g: fmi3LogMessageCallback, h: fmi3ClockUpdateCallback, i: fmi3LockPreemptionCallback,
                j: fmi3UnlockPreemptionCallback) -> fmi3Instance;
            fmi3FreeInstance: fmi3FreeInstanceTYPE (a: fmi3Instance);
            fmi3EnterInitializationMode: fmi3EnterInitializationModeTYPE (a: fmi3Instance, b: fmi3Boolean,
                c: fmi3Float64, d: fmi3Float64, e: fmi3Boolean, f: fmi3Float64) -> fmi3Status;
            fmi3ExitInitializationMode: fmi3ExitInitializationModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3EnterEventMode: fmi3EnterEventModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3Terminate: fmi3TerminateTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3Reset: fmi3ResetTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3GetFloat32: fmi3GetFloat32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Float32, e: usize) -> fmi3Status;
            fmi3GetFloat64: fmi3GetFloat64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Float64, e: usize) -> fmi3Status;
            fmi3GetInt8: fmi3GetInt8TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Int8, e: usize) -> fmi3Status;
            fmi3GetUInt8: fmi3GetUInt8TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3UInt8, e: usize) -> fmi3Status;
            fmi3GetInt16: fmi3GetInt16TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Int16, e: usize) -> fmi3Status;
            fmi3GetUInt16: fmi3GetUInt16TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3UInt16, e: usize) -> fmi3Status;
            fmi3GetInt32: fmi3GetInt32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Int32, e: usize) -> fmi3Status;
            fmi3GetUInt32: fmi3GetUInt32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3UInt32, e: usize) -> fmi3Status;
            fmi3GetInt64: fmi3GetInt64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Int64, e: usize) -> fmi3Status;
            fmi3GetUInt64: fmi3GetUInt64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3UInt64, e: usize) -> fmi3Status;
            fmi3GetBoolean: fmi3GetBooleanTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Boolean, e: usize) -> fmi3Status;
            fmi3GetString: fmi3GetStringTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3String, e: usize) -> fmi3Status;
            fmi3GetBinary: fmi3GetBinaryTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut usize, e: *mut fmi3Binary, f: usize) -> fmi3Status;
            fmi3GetClock: fmi3GetClockTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *mut fmi3Clock) -> fmi3Status;
            fmi3SetFloat32: fmi3SetFloat32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Float32, e: usize) -> fmi3Status;
            fmi3SetFloat64: fmi3SetFloat64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Float64, e: usize) -> fmi3Status;
            fmi3SetInt8: fmi3SetInt8TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Int8, e: usize) -> fmi3Status;
            fmi3SetUInt8: fmi3SetUInt8TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3UInt8, e: usize) -> fmi3Status;
            fmi3SetInt16: fmi3SetInt16TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Int16, e: usize) -> fmi3Status;
            fmi3SetUInt16: fmi3SetUInt16TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3UInt16, e: usize) -> fmi3Status;
            fmi3SetInt32: fmi3SetInt32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Int32, e: usize) -> fmi3Status;
            fmi3SetUInt32: fmi3SetUInt32TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3UInt32, e: usize) -> fmi3Status;
            fmi3SetInt64: fmi3SetInt64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Int64, e: usize) -> fmi3Status;
            fmi3SetUInt64: fmi3SetUInt64TYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3UInt64, e: usize) -> fmi3Status;
            fmi3SetBoolean: fmi3SetBooleanTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Boolean, e: usize) -> fmi3Status;
            fmi3SetString: fmi3SetStringTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3String, e: usize) -> fmi3Status;
            fmi3SetBinary: fmi3SetBinaryTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const usize, e: *const fmi3Binary, f: usize) -> fmi3Status;
            fmi3SetClock: fmi3SetClockTYPE (a: fmi3Instance, b: *const fmi3ValueReference, c: usize,
                d: *const fmi3Clock) -> fmi3Status;
            fmi3GetNumberOfVariableDependencies: fmi3GetNumberOfVariableDependenciesTYPE (a: fmi3Instance,
                b: fmi3ValueReference, c: *mut usize) -> fmi3Status;
            fmi3GetVariableDependencies: fmi3GetVariableDependenciesTYPE (a: fmi3Instance,
                b: fmi3ValueReference, c: *mut usize, d: *mut fmi3ValueReference, e: *mut usize,
                f: *mut fmi3DependencyKind, g: usize) -> fmi3Status;
            fmi3GetFMUState: fmi3GetFMUStateTYPE (a: fmi3Instance, b: *mut fmi3FMUState) -> fmi3Status;
            fmi3SetFMUState: fmi3SetFMUStateTYPE (a: fmi3Instance, b: fmi3FMUState) -> fmi3Status;
            fmi3FreeFMUState: fmi3FreeFMUStateTYPE (a: fmi3Instance, b: *mut fmi3FMUState) -> fmi3Status;
            fmi3SerializedFMUStateSize: fmi3SerializedFMUStateSizeTYPE (a: fmi3Instance, b: fmi3FMUState,
                c: *mut usize) -> fmi3Status;
            fmi3SerializeFMUState: fmi3SerializeFMUStateTYPE (a: fmi3Instance, b: fmi3FMUState,
                c: *mut fmi3Byte, d: usize) -> fmi3Status;
            fmi3DeserializeFMUState: fmi3DeserializeFMUStateTYPE (a: fmi3Instance, b: *const fmi3Byte,
                c: usize, d: *mut fmi3FMUState) -> fmi3Status;
            fmi3GetDirectionalDerivative: fmi3GetDirectionalDerivativeTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *const fmi3ValueReference, e: usize,
                f: *const fmi3Float64, g: usize, h: *mut fmi3Float64, i: usize) -> fmi3Status;
            fmi3GetAdjointDerivative: fmi3GetAdjointDerivativeTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *const fmi3ValueReference, e: usize,
                f: *const fmi3Float64, g: usize, h: *mut fmi3Float64, i: usize) -> fmi3Status;
            fmi3EnterConfigurationMode: fmi3EnterConfigurationModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3ExitConfigurationMode: fmi3ExitConfigurationModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3GetIntervalDecimal: fmi3GetIntervalDecimalTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *mut fmi3Float64,
                e: *mut fmi3IntervalQualifier) -> fmi3Status;
            fmi3GetIntervalFraction: fmi3GetIntervalFractionTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *mut fmi3UInt64, e: *mut fmi3UInt64,
                f: *mut fmi3IntervalQualifier) -> fmi3Status;
            fmi3GetShiftDecimal: fmi3GetShiftDecimalTYPE (a: fmi3Instance, b: *const fmi3ValueReference,
                c: usize, d: *mut fmi3Float64) -> fmi3Status;
            fmi3GetShiftFraction: fmi3GetShiftFractionTYPE (a: fmi3Instance, b: *const fmi3ValueReference,
                c: usize, d: *mut fmi3UInt64, e: *mut fmi3UInt64) -> fmi3Status;
            fmi3SetIntervalDecimal: fmi3SetIntervalDecimalTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *const fmi3Float64) -> fmi3Status;
            fmi3SetIntervalFraction: fmi3SetIntervalFractionTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *const fmi3UInt64,
                e: *const fmi3UInt64) -> fmi3Status;
            fmi3SetShiftDecimal: fmi3SetShiftDecimalTYPE (a: fmi3Instance, b: *const fmi3ValueReference,
                c: usize, d: *const fmi3Float64) -> fmi3Status;
            fmi3SetShiftFraction: fmi3SetShiftFractionTYPE (a: fmi3Instance, b: *const fmi3ValueReference,
                c: usize, d: *const fmi3UInt64, e: *const fmi3UInt64) -> fmi3Status;
            fmi3EvaluateDiscreteStates: fmi3EvaluateDiscreteStatesTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3UpdateDiscreteStates: fmi3UpdateDiscreteStatesTYPE (a: fmi3Instance, b: *mut fmi3Boolean,
                c: *mut fmi3Boolean, d: *mut fmi3Boolean, e: *mut fmi3Boolean, f: *mut fmi3Boolean,
                g: *mut fmi3Float64) -> fmi3Status;
            fmi3EnterContinuousTimeMode: fmi3EnterContinuousTimeModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3CompletedIntegratorStep: fmi3CompletedIntegratorStepTYPE (a: fmi3Instance, b: fmi3Boolean,
                c: *mut fmi3Boolean, d: *mut fmi3Boolean) -> fmi3Status;
            fmi3SetTime: fmi3SetTimeTYPE (a: fmi3Instance, b: fmi3Float64) -> fmi3Status;
            fmi3SetContinuousStates: fmi3SetContinuousStatesTYPE (a: fmi3Instance, b: *const fmi3Float64,
                c: usize) -> fmi3Status;
            fmi3GetContinuousStateDerivatives: fmi3GetContinuousStateDerivativesTYPE (a: fmi3Instance,
                b: *mut fmi3Float64, c: usize) -> fmi3Status;
            fmi3GetEventIndicators: fmi3GetEventIndicatorsTYPE (a: fmi3Instance, b: *mut fmi3Float64,
                c: usize) -> fmi3Status;
            fmi3GetContinuousStates: fmi3GetContinuousStatesTYPE (a: fmi3Instance, b: *mut fmi3Float64,
                c: usize) -> fmi3Status;
            fmi3GetNominalsOfContinuousStates: fmi3GetNominalsOfContinuousStatesTYPE (a: fmi3Instance,
                b: *mut fmi3Float64, c: usize) -> fmi3Status;
            fmi3GetNumberOfEventIndicators: fmi3GetNumberOfEventIndicatorsTYPE (a: fmi3Instance,
                b: *mut usize) -> fmi3Status;
            fmi3GetNumberOfContinuousStates: fmi3GetNumberOfContinuousStatesTYPE (a: fmi3Instance,
                b: *mut usize) -> fmi3Status;
            fmi3EnterStepMode: fmi3EnterStepModeTYPE (a: fmi3Instance) -> fmi3Status;
            fmi3GetOutputDerivatives: fmi3GetOutputDerivativesTYPE (a: fmi3Instance,
                b: *const fmi3ValueReference, c: usize, d: *const fmi3Int32, e: *mut fmi3Float64,
                f: usize) -> fmi3Status;
            fmi3DoStep: fmi3DoStepTYPE (a: fmi3Instance, b: fmi3Float64, c: fmi3Float64, d: fmi3Boolean,
                e: *mut fmi3Boolean, f: *mut fmi3Boolean, g: *mut fmi3Boolean,
                h: *mut fmi3Float64) -> fmi3Status;
            fmi3ActivateModelPartition: fmi3ActivateModelPartitionTYPE (a: fmi3Instance,
                b: fmi3ValueReference, c: fmi3Float64) -> fmi3Status;
        }
    }; };
}
