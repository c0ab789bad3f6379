//! Function signatures of FMI 3.0, in the order of `fmi3FunctionTypes.h`.

use super::*;

pub type fmi3GetVersionTYPE = Option<unsafe extern "C" fn() -> *const c_char>;
pub type fmi3SetDebugLoggingTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        loggingOn: fmi3Boolean,
        nCategories: usize,
        categories: *const fmi3String,
    ) -> fmi3Status,
>;
pub type fmi3InstantiateModelExchangeTYPE = Option<
    unsafe extern "C" fn(
        instanceName: fmi3String,
        instantiationToken: fmi3String,
        resourcePath: fmi3String,
        visible: fmi3Boolean,
        loggingOn: fmi3Boolean,
        instanceEnvironment: fmi3InstanceEnvironment,
        logMessage: fmi3LogMessageCallback,
    ) -> fmi3Instance,
>;
pub type fmi3InstantiateCoSimulationTYPE = Option<
    unsafe extern "C" fn(
        instanceName: fmi3String,
        instantiationToken: fmi3String,
        resourcePath: fmi3String,
        visible: fmi3Boolean,
        loggingOn: fmi3Boolean,
        eventModeUsed: fmi3Boolean,
        earlyReturnAllowed: fmi3Boolean,
        requiredIntermediateVariables: *const fmi3ValueReference,
        nRequiredIntermediateVariables: usize,
        instanceEnvironment: fmi3InstanceEnvironment,
        logMessage: fmi3LogMessageCallback,
        intermediateUpdate: fmi3IntermediateUpdateCallback,
    ) -> fmi3Instance,
>;
pub type fmi3InstantiateScheduledExecutionTYPE = Option<
    unsafe extern "C" fn(
        instanceName: fmi3String,
        instantiationToken: fmi3String,
        resourcePath: fmi3String,
        visible: fmi3Boolean,
        loggingOn: fmi3Boolean,
        instanceEnvironment: fmi3InstanceEnvironment,
        logMessage: fmi3LogMessageCallback,
        clockUpdate: fmi3ClockUpdateCallback,
        lockPreemption: fmi3LockPreemptionCallback,
        unlockPreemption: fmi3UnlockPreemptionCallback,
    ) -> fmi3Instance,
>;
pub type fmi3FreeInstanceTYPE = Option<unsafe extern "C" fn(instance: fmi3Instance)>;
pub type fmi3EnterInitializationModeTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        toleranceDefined: fmi3Boolean,
        tolerance: fmi3Float64,
        startTime: fmi3Float64,
        stopTimeDefined: fmi3Boolean,
        stopTime: fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3ExitInitializationModeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3EnterEventModeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3TerminateTYPE = Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3ResetTYPE = Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;

/// `fmi3Get{VariableType}`: all values of each referenced variable in a row.
pub type fmi3GetTYPE<T> = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        values: *mut T,
        nValues: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetFloat32TYPE = fmi3GetTYPE<fmi3Float32>;
pub type fmi3GetFloat64TYPE = fmi3GetTYPE<fmi3Float64>;
pub type fmi3GetInt8TYPE = fmi3GetTYPE<fmi3Int8>;
pub type fmi3GetUInt8TYPE = fmi3GetTYPE<fmi3UInt8>;
pub type fmi3GetInt16TYPE = fmi3GetTYPE<fmi3Int16>;
pub type fmi3GetUInt16TYPE = fmi3GetTYPE<fmi3UInt16>;
pub type fmi3GetInt32TYPE = fmi3GetTYPE<fmi3Int32>;
pub type fmi3GetUInt32TYPE = fmi3GetTYPE<fmi3UInt32>;
pub type fmi3GetInt64TYPE = fmi3GetTYPE<fmi3Int64>;
pub type fmi3GetUInt64TYPE = fmi3GetTYPE<fmi3UInt64>;
pub type fmi3GetBooleanTYPE = fmi3GetTYPE<fmi3Boolean>;
pub type fmi3GetStringTYPE = fmi3GetTYPE<fmi3String>;

pub type fmi3GetBinaryTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        valueSizes: *mut usize,
        values: *mut fmi3Binary,
        nValues: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetClockTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        values: *mut fmi3Clock,
    ) -> fmi3Status,
>;

/// `fmi3Set{VariableType}`: all values of each referenced variable in a row.
pub type fmi3SetTYPE<T> = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        values: *const T,
        nValues: usize,
    ) -> fmi3Status,
>;
pub type fmi3SetFloat32TYPE = fmi3SetTYPE<fmi3Float32>;
pub type fmi3SetFloat64TYPE = fmi3SetTYPE<fmi3Float64>;
pub type fmi3SetInt8TYPE = fmi3SetTYPE<fmi3Int8>;
pub type fmi3SetUInt8TYPE = fmi3SetTYPE<fmi3UInt8>;
pub type fmi3SetInt16TYPE = fmi3SetTYPE<fmi3Int16>;
pub type fmi3SetUInt16TYPE = fmi3SetTYPE<fmi3UInt16>;
pub type fmi3SetInt32TYPE = fmi3SetTYPE<fmi3Int32>;
pub type fmi3SetUInt32TYPE = fmi3SetTYPE<fmi3UInt32>;
pub type fmi3SetInt64TYPE = fmi3SetTYPE<fmi3Int64>;
pub type fmi3SetUInt64TYPE = fmi3SetTYPE<fmi3UInt64>;
pub type fmi3SetBooleanTYPE = fmi3SetTYPE<fmi3Boolean>;
pub type fmi3SetStringTYPE = fmi3SetTYPE<fmi3String>;

pub type fmi3SetBinaryTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        valueSizes: *const usize,
        values: *const fmi3Binary,
        nValues: usize,
    ) -> fmi3Status,
>;
pub type fmi3SetClockTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        values: *const fmi3Clock,
    ) -> fmi3Status,
>;
pub type fmi3GetNumberOfVariableDependenciesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReference: fmi3ValueReference,
        nDependencies: *mut usize,
    ) -> fmi3Status,
>;
pub type fmi3GetVariableDependenciesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        dependent: fmi3ValueReference,
        elementIndicesOfDependent: *mut usize,
        independents: *mut fmi3ValueReference,
        elementIndicesOfIndependents: *mut usize,
        dependencyKinds: *mut fmi3DependencyKind,
        nDependencies: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetFMUStateTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance, FMUState: *mut fmi3FMUState) -> fmi3Status>;
pub type fmi3SetFMUStateTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance, FMUState: fmi3FMUState) -> fmi3Status>;
pub type fmi3FreeFMUStateTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance, FMUState: *mut fmi3FMUState) -> fmi3Status>;
pub type fmi3SerializedFMUStateSizeTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        FMUState: fmi3FMUState,
        size: *mut usize,
    ) -> fmi3Status,
>;
pub type fmi3SerializeFMUStateTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        FMUState: fmi3FMUState,
        serializedState: *mut fmi3Byte,
        size: usize,
    ) -> fmi3Status,
>;
pub type fmi3DeserializeFMUStateTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        serializedState: *const fmi3Byte,
        size: usize,
        FMUState: *mut fmi3FMUState,
    ) -> fmi3Status,
>;
pub type fmi3GetDirectionalDerivativeTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        unknowns: *const fmi3ValueReference,
        nUnknowns: usize,
        knowns: *const fmi3ValueReference,
        nKnowns: usize,
        seed: *const fmi3Float64,
        nSeed: usize,
        sensitivity: *mut fmi3Float64,
        nSensitivity: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetAdjointDerivativeTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        unknowns: *const fmi3ValueReference,
        nUnknowns: usize,
        knowns: *const fmi3ValueReference,
        nKnowns: usize,
        seed: *const fmi3Float64,
        nSeed: usize,
        sensitivity: *mut fmi3Float64,
        nSensitivity: usize,
    ) -> fmi3Status,
>;
pub type fmi3EnterConfigurationModeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3ExitConfigurationModeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3GetIntervalDecimalTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        intervals: *mut fmi3Float64,
        qualifiers: *mut fmi3IntervalQualifier,
    ) -> fmi3Status,
>;
pub type fmi3GetIntervalFractionTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        counters: *mut fmi3UInt64,
        resolutions: *mut fmi3UInt64,
        qualifiers: *mut fmi3IntervalQualifier,
    ) -> fmi3Status,
>;
pub type fmi3GetShiftDecimalTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        shifts: *mut fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3GetShiftFractionTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        counters: *mut fmi3UInt64,
        resolutions: *mut fmi3UInt64,
    ) -> fmi3Status,
>;
pub type fmi3SetIntervalDecimalTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        intervals: *const fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3SetIntervalFractionTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        counters: *const fmi3UInt64,
        resolutions: *const fmi3UInt64,
    ) -> fmi3Status,
>;
pub type fmi3SetShiftDecimalTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        shifts: *const fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3SetShiftFractionTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        counters: *const fmi3UInt64,
        resolutions: *const fmi3UInt64,
    ) -> fmi3Status,
>;
pub type fmi3EvaluateDiscreteStatesTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3UpdateDiscreteStatesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        discreteStatesNeedUpdate: *mut fmi3Boolean,
        terminateSimulation: *mut fmi3Boolean,
        nominalsOfContinuousStatesChanged: *mut fmi3Boolean,
        valuesOfContinuousStatesChanged: *mut fmi3Boolean,
        nextEventTimeDefined: *mut fmi3Boolean,
        nextEventTime: *mut fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3EnterContinuousTimeModeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3CompletedIntegratorStepTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        noSetFMUStatePriorToCurrentPoint: fmi3Boolean,
        enterEventMode: *mut fmi3Boolean,
        terminateSimulation: *mut fmi3Boolean,
    ) -> fmi3Status,
>;
pub type fmi3SetTimeTYPE =
    Option<unsafe extern "C" fn(instance: fmi3Instance, time: fmi3Float64) -> fmi3Status>;
pub type fmi3SetContinuousStatesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        continuousStates: *const fmi3Float64,
        nContinuousStates: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetContinuousStateDerivativesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        derivatives: *mut fmi3Float64,
        nContinuousStates: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetEventIndicatorsTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        eventIndicators: *mut fmi3Float64,
        nEventIndicators: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetContinuousStatesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        continuousStates: *mut fmi3Float64,
        nContinuousStates: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetNominalsOfContinuousStatesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        nominals: *mut fmi3Float64,
        nContinuousStates: usize,
    ) -> fmi3Status,
>;
pub type fmi3GetNumberOfEventIndicatorsTYPE = Option<
    unsafe extern "C" fn(instance: fmi3Instance, nEventIndicators: *mut usize) -> fmi3Status,
>;
pub type fmi3GetNumberOfContinuousStatesTYPE = Option<
    unsafe extern "C" fn(instance: fmi3Instance, nContinuousStates: *mut usize) -> fmi3Status,
>;
pub type fmi3EnterStepModeTYPE = Option<unsafe extern "C" fn(instance: fmi3Instance) -> fmi3Status>;
pub type fmi3GetOutputDerivativesTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        valueReferences: *const fmi3ValueReference,
        nValueReferences: usize,
        orders: *const fmi3Int32,
        values: *mut fmi3Float64,
        nValues: usize,
    ) -> fmi3Status,
>;
pub type fmi3DoStepTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        currentCommunicationPoint: fmi3Float64,
        communicationStepSize: fmi3Float64,
        noSetFMUStatePriorToCurrentPoint: fmi3Boolean,
        eventHandlingNeeded: *mut fmi3Boolean,
        terminateSimulation: *mut fmi3Boolean,
        earlyReturn: *mut fmi3Boolean,
        lastSuccessfulTime: *mut fmi3Float64,
    ) -> fmi3Status,
>;
pub type fmi3ActivateModelPartitionTYPE = Option<
    unsafe extern "C" fn(
        instance: fmi3Instance,
        clockReference: fmi3ValueReference,
        activationTime: fmi3Float64,
    ) -> fmi3Status,
>;
