//! `fmi3DoStep`, with the intermediate updates inside the step.

use fmi_abi::fmi3::*;

use crate::guard::{Status, enter};
use crate::instance::Instance;
use crate::legality::{ALWAYS, Mode, fmi3 as table};
use crate::pointer::target;
use crate::step::{Progress, Step};
use crate::unit::{Failure, Unit};

/// The importer's wish to look at instants inside a step.
#[derive(Clone, Copy)]
pub(crate) struct IntermediateUpdate {
    pub(crate) callback: unsafe extern "C" fn(
        fmi3InstanceEnvironment,
        fmi3Float64,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        fmi3Boolean,
        *mut fmi3Boolean,
        *mut fmi3Float64,
    ),
    pub(crate) environment: fmi3InstanceEnvironment,
}

impl IntermediateUpdate {
    /// Lets the importer look at the outputs of `time` \[s\]; returns when it wants the step to end, if
    /// that is allowed and it does.
    ///
    /// # Safety
    /// The importer's callback and environment are still valid.
    unsafe fn call(&self, time: f64, allowed: bool) -> Option<f64> {
        let (mut requested, mut end) = (fmi3False, time);
        let (set, get, finished) = (fmi3False, fmi3True, fmi3True);
        // SAFETY: called as the standard says; the out-parameters live here.
        unsafe {
            (self.callback)(
                self.environment,
                time,
                set,
                get,
                finished,
                allowed.into(),
                &raw mut requested,
                &raw mut end,
            );
        }
        (allowed && requested != fmi3False).then_some(end)
    }
}

impl<U: Unit> Instance<U> {
    /// Goes on with a step. After an event the importer may look inside, if it wants to.
    fn proceed_or_pause(
        &mut self,
        step: &mut Step,
    ) -> Result<(Progress, Option<IntermediateUpdate>), Failure> {
        self.now.mode = Mode::Step;
        let progress = self.proceed(step)?;
        let update = match progress {
            Progress::Event(_) => self.intermediate_update,
            Progress::Done { .. } => None,
        };
        if update.is_some() {
            self.now.mode = Mode::IntermediateUpdate;
        }
        Ok((progress, update))
    }
}

pub unsafe fn fmi3DoStep<U: Unit>(
    instance: fmi3Instance,
    point: fmi3Float64,
    size: fmi3Float64,
    _no_set_fmu_state_prior: fmi3Boolean,
    event_handling_needed: *mut fmi3Boolean,
    terminate: *mut fmi3Boolean,
    early_return: *mut fmi3Boolean,
    last_successful_time: *mut fmi3Float64,
) -> fmi3Status {
    let name = "fmi3DoStep";
    // SAFETY: the importer vouches for its pointers. While its callback runs, which calls back, nothing
    // here refers to the instance.
    let outcome = unsafe {
        enter::<U, _>(instance, name, &table::DO_STEP, |i| {
            *target(event_handling_needed, "eventHandlingNeeded")? = fmi3False;
            *target(terminate, "terminateSimulation")? = fmi3False;
            *target(early_return, "earlyReturn")? = fmi3False;
            *target(last_successful_time, "lastSuccessfulTime")? = i.now.time;
            i.begin_step(point, size)
        })
        .and_then(|mut step| {
            loop {
                let (progress, update) = enter::<U, _>(instance, name, &ALWAYS, |i| {
                    let outcome = i.proceed_or_pause(&mut step);
                    *target(last_successful_time, "lastSuccessfulTime")? = i.now.time;
                    outcome
                })?;
                let time = match progress {
                    Progress::Event(time) => time,
                    Progress::Done { event } => {
                        *early_return = step.is_shortened().into();
                        *event_handling_needed = event.into();
                        return Ok(());
                    }
                };
                if let Some(end) = update.and_then(|update| update.call(time, step.may_end_early()))
                {
                    step.end_early(end, time);
                }
            }
        })
    };
    outcome.map_or_else(|status| status, |()| Status::Ok) as fmi3Status
}
