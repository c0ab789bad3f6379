//! Co-Simulation: one communication step as a sequence of events and continuous stretches.

use crate::instance::{Instance, Interface, rounding};
use crate::legality::Mode;
use crate::unit::{Failure, Unit};

/// An event is left to the next step only if it is at most this close to the end, rounding apart \[s\].
const MOST_TOLERANCE: f64 = 1e-7;

/// A communication step under way.
#[derive(Debug)]
pub(crate) struct Step {
    /// Where it ends \[s\].
    end: f64,
    /// Events this close to the end belong to the next step \[s\]: a master that sums its steps, or that
    /// rounds otherwise, does not shift the samples of a unit.
    tolerance: f64,
    /// It ends before its time: the importer asked for it, or an event needs it.
    shortened: bool,
    /// Whether the importer lets it end before its time.
    may_end_early: bool,
    /// Whether the importer handles events itself and lets steps end at them.
    ends_at_events: bool,
}

/// How far a step has come.
#[derive(Debug, PartialEq)]
pub(crate) enum Progress {
    /// An event was carried out at this time \[s\]; the step goes on.
    Event(f64),
    /// The step is complete; whether the importer must enter Event Mode.
    Done { event: bool },
}

impl Step {
    /// The importer wants the step to end at `time` \[s\], or `now` if that has passed.
    pub(crate) fn end_early(&mut self, time: f64, now: f64) {
        // `max` turns a NaN into `now`.
        let end = time.max(now);
        if end < self.end {
            self.end = end;
            self.shortened = true;
        }
    }

    pub(crate) fn may_end_early(&self) -> bool {
        self.may_end_early
    }

    pub(crate) fn is_shortened(&self) -> bool {
        self.shortened
    }
}

impl<U: Unit> Instance<U> {
    /// Begins the step of `size` from `point` \[s\]. The point must be where the last step ended, within
    /// a thousandth of the step: each step adopts the importer's time, so nothing accumulates.
    pub(crate) fn begin_step(&mut self, point: f64, size: f64) -> Result<Step, Failure> {
        let end = point + size;
        if !(size > 0.0 && end.is_finite()) {
            return Err(Failure(format!(
                "step of {size} s from {point} s: the size must be positive and the end finite"
            )));
        }
        if end <= point {
            return Err(Failure(format!(
                "step of {size} s from {point} s: at that time so short a step cannot be told from none"
            )));
        }
        let slack = 1e-3 * size + rounding(point);
        let time = self.now.time;
        if (point - time).abs() > slack {
            return Err(Failure(format!(
                "step from {point} s, but the last one ended at {time} s"
            )));
        }
        // Whatever else is overdue would be made up for, event by event, before the step ends.
        let next = self.next_event()?;
        if next < time - slack - MOST_TOLERANCE {
            return Err(Failure(format!(
                "step from {point} s: the event at {next} s was never carried out; this is no state that steps lead to"
            )));
        }
        if let Some(stop) = self.now.stop
            && end > stop + slack + rounding(stop)
        {
            return Err(Failure(format!(
                "step from {point} s to {end} s goes beyond the stop time {stop} s"
            )));
        }
        Ok(Step {
            end: end.max(time),
            tolerance: f64::min(1e-3 * size, MOST_TOLERANCE) + rounding(end),
            shortened: false,
            may_end_early: self.early_return_allowed,
            ends_at_events: self.handles_events() && self.early_return_allowed,
        })
    }

    /// Goes on to the next event or to the end.
    pub(crate) fn proceed(&mut self, step: &mut Step) -> Result<Progress, Failure> {
        let from = self.now.time;
        let next = self.next_event()?;
        if next < step.end - step.tolerance {
            // An event of the last step's end may be due a little before this step's start.
            let instant = next.max(from);
            if instant > from {
                self.act(|unit, variables, log| unit.advance(variables, from, instant, log))?;
                self.now.time = instant;
                if step.ends_at_events {
                    step.end_early(instant, from);
                    self.refresh();
                    return Ok(Progress::Done { event: true });
                }
            }
            self.timed_event(next)?;
            return Ok(Progress::Event(instant));
        }
        if step.end > from {
            self.act(|unit, variables, log| unit.advance(variables, from, step.end, log))?;
            self.now.time = step.end;
        }
        self.refresh();
        let event = self.handles_events() && self.is_due(next);
        Ok(Progress::Done { event })
    }

    fn handles_events(&self) -> bool {
        self.now.interface == Interface::EventfulCoSimulation
    }

    /// The next event instant \[s\]; infinity for none, or if clocks make the events.
    pub(crate) fn next_event(&mut self) -> Result<f64, Failure> {
        let unit = self.unit.as_ref().filter(|_| !self.now.clocked);
        let next = unit.map_or(f64::INFINITY, U::next_event);
        if next.is_nan() {
            self.now.mode = Mode::Failed;
            return Err(Failure("the next event instant is not a number".into()));
        }
        Ok(next)
    }

    /// Carries out the event that is due at `instant` \[s\]. The next one must come later, lest a step
    /// never end.
    pub(crate) fn timed_event(&mut self, instant: f64) -> Result<(), Failure> {
        self.act(|unit, variables, log| {
            unit.event(variables, instant, log)?;
            let next = unit.next_event();
            if next > instant {
                Ok(())
            } else {
                Err(Failure(format!(
                    "after the event at {instant} s the next one is at {next} s: it must come later"
                )))
            }
        })
    }
}
