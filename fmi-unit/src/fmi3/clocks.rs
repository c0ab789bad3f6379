//! Functions of FMI 3.0 about clocks, and Scheduled Execution.

use fmi_abi::fmi3::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::clock::locate;
use crate::guard::{Status, call, enter, enter_when_idle, uninterrupted};
use crate::legality::{ALWAYS, Mode, fmi3 as table};
use crate::pointer::{slice, slice_mut};
use crate::unit::{Failure, Unit};

pub unsafe fn fmi3GetClock<U: Unit>(
    instance: fmi3Instance,
    references: *const fmi3ValueReference,
    n: usize,
    values: *mut fmi3Clock,
) -> fmi3Status {
    unsafe {
        call::<U>(instance, "fmi3GetClock", &table::CLOCK, |i| {
            let references = slice(references, n, "value references")?;
            let values = slice_mut(values, n, "values")?;
            for (value, &reference) in values.iter_mut().zip(references) {
                *value = i.get_clock(reference)?.into();
            }
            Ok(())
        })
    }
}

pub unsafe fn fmi3SetClock<U: Unit>(
    instance: fmi3Instance,
    references: *const fmi3ValueReference,
    n: usize,
    values: *const fmi3Clock,
) -> fmi3Status {
    unsafe {
        call::<U>(instance, "fmi3SetClock", &table::CLOCK, |i| {
            let references = slice(references, n, "value references")?;
            let values = slice(values, n, "values")?;
            i.set_clocks(references, values)
        })
    }
}

pub unsafe fn fmi3GetIntervalDecimal<U: Unit>(
    instance: fmi3Instance,
    references: *const fmi3ValueReference,
    n: usize,
    intervals: *mut fmi3Float64,
    qualifiers: *mut fmi3IntervalQualifier,
) -> fmi3Status {
    unsafe {
        call::<U>(instance, "fmi3GetIntervalDecimal", &table::INTERVAL, |i| {
            let references = slice(references, n, "value references")?;
            let intervals = slice_mut(intervals, n, "intervals")?;
            let qualifiers = slice_mut(qualifiers, n, "qualifiers")?;
            // Told once, it cannot change any more (sec 2.2.8.5).
            let known = match i.now.mode {
                Mode::Initialization => fmi3IntervalChanged,
                _ => fmi3IntervalUnchanged,
            };
            for ((&reference, interval), qualifier) in
                references.iter().zip(intervals).zip(qualifiers)
            {
                *interval = i.interval(reference)?;
                *qualifier = known;
            }
            Ok(())
        })
    }
}

/// Sets the parameter that the interval follows from, for importers that would rather set a clock (FMI 3.0.0).
pub unsafe fn fmi3SetIntervalDecimal<U: Unit>(
    instance: fmi3Instance,
    references: *const fmi3ValueReference,
    n: usize,
    intervals: *const fmi3Float64,
) -> fmi3Status {
    unsafe {
        call::<U>(
            instance,
            "fmi3SetIntervalDecimal",
            &table::SET_INTERVAL,
            |i| {
                let references = slice(references, n, "value references")?;
                let intervals = slice(intervals, n, "intervals")?;
                for (&reference, &interval) in references.iter().zip(intervals) {
                    i.set_interval(reference, interval)?;
                }
                Ok(())
            },
        )
    }
}

/// The first tick is at the start.
pub unsafe fn fmi3GetShiftDecimal<U: Unit>(
    instance: fmi3Instance,
    references: *const fmi3ValueReference,
    n: usize,
    shifts: *mut fmi3Float64,
) -> fmi3Status {
    unsafe {
        call::<U>(instance, "fmi3GetShiftDecimal", &table::INTERVAL, |_| {
            let references = slice(references, n, "value references")?;
            for &reference in references {
                locate::<U>(reference)?;
            }
            slice_mut(shifts, n, "shifts")?.fill(0.0);
            Ok(())
        })
    }
}

/// A partition does its work in three parts; the middle one, which may be long and touches nothing of the
/// instance, can be preempted by another partition.
pub unsafe fn fmi3ActivateModelPartition<U: Unit>(
    instance: fmi3Instance,
    clock: fmi3ValueReference,
    time: fmi3Float64,
) -> fmi3Status {
    let name = "fmi3ActivateModelPartition";
    let outcome = unsafe {
        uninterrupted::<U, _>(instance, || {
            enter::<U, _>(instance, name, &table::ACTIVATE, |i| {
                let clock = locate::<U>(clock)?;
                if !time.is_finite() {
                    return Err(Failure(format!(
                        "activation at {time} s: it must be finite"
                    )));
                }
                i.now.time = time;
                let job =
                    i.act(|unit, variables, log| unit.activate(variables, clock, time, log))?;
                Ok(job.map(|job| (job, i.generation)))
            })
        })
        .and_then(|job| {
            let Some((mut job, generation)) = job else {
                return Ok(());
            };
            let worked = catch_unwind(AssertUnwindSafe(|| U::work(&mut job)));
            uninterrupted::<U, _>(instance, || {
                enter_when_idle::<U, _>(instance, name, &ALWAYS, |i| {
                    // Here it poisons the instance, as any panic.
                    worked.unwrap_or_else(|payload| resume_unwind(payload));
                    if i.generation != generation {
                        // It was reset meanwhile: the job is of a unit that is gone.
                        return Ok(());
                    }
                    i.act(|unit, variables, log| unit.complete(variables, job, log))
                })
            })
        })
    };
    outcome.map_or_else(|status| status, |()| Status::Ok) as fmi3Status
}
