//! The layout that C compilers give the structures and types of the headers.

use std::mem::{offset_of, size_of};

use crate::{fmi2, fmi3};

const POINTER: usize = size_of::<usize>();

#[test]
fn callback_functions_are_five_pointers_in_order() {
    use fmi2::fmi2CallbackFunctions as F;
    assert_eq!(size_of::<F>(), 5 * POINTER);
    assert_eq!(offset_of!(F, logger), 0);
    assert_eq!(offset_of!(F, allocateMemory), POINTER);
    assert_eq!(offset_of!(F, freeMemory), 2 * POINTER);
    assert_eq!(offset_of!(F, stepFinished), 3 * POINTER);
    assert_eq!(offset_of!(F, componentEnvironment), 4 * POINTER);
}

#[test]
fn event_info_is_five_ints_padding_and_a_double() {
    use fmi2::fmi2EventInfo as I;
    assert_eq!(size_of::<I>(), 32);
    assert_eq!(offset_of!(I, newDiscreteStatesNeeded), 0);
    assert_eq!(offset_of!(I, terminateSimulation), 4);
    assert_eq!(offset_of!(I, nominalsOfContinuousStatesChanged), 8);
    assert_eq!(offset_of!(I, valuesOfContinuousStatesChanged), 12);
    assert_eq!(offset_of!(I, nextEventTimeDefined), 16);
    assert_eq!(offset_of!(I, nextEventTime), 24);
}

#[test]
fn scalars_have_the_widths_of_c() {
    assert_eq!(size_of::<fmi2::fmi2Status>(), 4);
    assert_eq!(size_of::<fmi2::fmi2Boolean>(), 4);
    assert_eq!(size_of::<fmi2::fmi2Byte>(), 1);
    assert_eq!(size_of::<fmi3::fmi3Status>(), 4);
    assert_eq!(size_of::<fmi3::fmi3Boolean>(), 1);
    assert_eq!(size_of::<fmi3::fmi3Clock>(), 1);
    assert_eq!(size_of::<fmi3::fmi3DoStepTYPE>(), POINTER);
}
