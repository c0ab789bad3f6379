//! Functions of FMI 3.0 for what the description does not declare. Importers load them all the same.
//! They fail with a message, or succeed if nothing is asked of them.

use fmi_abi::fmi3::*;

use crate::common::undeclared;
use crate::unit::Unit;

macro_rules! absent {
    ($($name:ident($($argument:ident: $type:ty),*): $asked:expr, $what:literal;)+) => {$(
        pub unsafe fn $name<U: Unit>(instance: fmi3Instance, $($argument: $type),*) -> fmi3Status {
            let _ = ($($argument,)*);
            // SAFETY: the importer vouches for the instance.
            unsafe { undeclared::<U>(instance, stringify!($name), $asked, $what) }
        }
    )+};
}

absent! {
    fmi3GetBinary(
        references: *const fmi3ValueReference, n: usize, value_sizes: *mut usize, values: *mut fmi3Binary, n_values: usize
    ): n > 0, "a binary variable";
    fmi3SetBinary(
        references: *const fmi3ValueReference, n: usize, value_sizes: *const usize, values: *const fmi3Binary, n_values: usize
    ): n > 0, "a binary variable";
    fmi3GetNumberOfVariableDependencies(
        reference: fmi3ValueReference, n_dependencies: *mut usize
    ): true, "the inquiry of dependencies";
    fmi3GetVariableDependencies(
        dependent: fmi3ValueReference, element_indices_of_dependent: *mut usize, independents: *mut fmi3ValueReference, element_indices_of_independents: *mut usize, dependency_kinds: *mut fmi3DependencyKind, n_dependencies: usize
    ): true, "the inquiry of dependencies";
    fmi3GetIntervalFraction(
        references: *const fmi3ValueReference, n: usize, counters: *mut fmi3UInt64, resolutions: *mut fmi3UInt64, qualifiers: *mut fmi3IntervalQualifier
    ): n > 0, "an interval as a fraction, or a shift,";
    fmi3GetShiftFraction(
        references: *const fmi3ValueReference, n: usize, counters: *mut fmi3UInt64, resolutions: *mut fmi3UInt64
    ): n > 0, "an interval as a fraction, or a shift,";
    fmi3SetIntervalFraction(
        references: *const fmi3ValueReference, n: usize, counters: *const fmi3UInt64, resolutions: *const fmi3UInt64
    ): n > 0, "an interval as a fraction, or a shift,";
    fmi3SetShiftDecimal(
        references: *const fmi3ValueReference, n: usize, shifts: *const fmi3Float64
    ): n > 0, "an interval as a fraction, or a shift,";
    fmi3SetShiftFraction(
        references: *const fmi3ValueReference, n: usize, counters: *const fmi3UInt64, resolutions: *const fmi3UInt64
    ): n > 0, "an interval as a fraction, or a shift,";
    fmi3EvaluateDiscreteStates(): true, "the evaluation of discrete states outside events";
    fmi3GetOutputDerivatives(
        references: *const fmi3ValueReference, n: usize, orders: *const fmi3Int32, values: *mut fmi3Float64, n_values: usize
    ): n > 0, "the derivative of an output";
}
