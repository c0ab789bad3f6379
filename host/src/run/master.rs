//! The co-simulation master: moves values between the FMUs and steps them.
//!
//! It knows any number of members, what feeds their inputs and in which order they step; who is connected to
//! whom was decided before: by [`super::plan`] for a controller with a plant, by [`crate::ssp`] for a system
//! structure. Time is an integer count of communication steps. Nothing in a step looks up a name or allocates.

use super::Order;
use super::recording::{Recording, Slot};
use crate::Error;
use crate::fmu::{Instance, Signals};
use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

/// What an input takes from the row: a value scaled, or, where it has entries, mapped and then scaled.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Feed {
    pub(crate) slot: Slot,
    /// Values of the source with what stands for them; empty: all values are taken as they are.
    pub(crate) map: Vec<(f64, f64)>,
}

impl Feed {
    /// The value in a row; none if the map has no entry for it.
    pub(crate) fn value(&self, row: &[f64]) -> Option<f64> {
        if self.map.is_empty() {
            return Some(self.slot.value(row));
        }
        let source = row[self.slot.column];
        let entry = self.map.iter().find(|(from, _)| *from == source);
        entry.map(|(_, to)| self.slot.factor * to + self.slot.offset)
    }
}

/// The inputs of one FMU and what feeds them.
#[derive(Debug)]
pub(crate) struct Inputs {
    pub(crate) signals: Signals,
    pub(crate) feeds: Vec<Feed>,
    pub(crate) values: Vec<f64>,
}

/// The outputs of one FMU and their place in the row.
#[derive(Debug)]
pub(crate) struct Outputs {
    pub(crate) signals: Signals,
    pub(crate) range: Range<usize>,
}

/// An FMU of the run. Members stand in the order in which they step.
#[derive(Debug)]
pub(crate) struct Member {
    pub(crate) inputs: Inputs,
    pub(crate) outputs: Outputs,
    /// Whether a later member takes its outputs: they are read after its step. Those of the others are
    /// read before the first step, since nobody needs them sooner.
    pub(crate) leads: bool,
}

/// When communication points are, and how values travel between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    /// Time of the first communication point \[s\].
    pub(crate) start: f64,
    /// Communication step \[s\].
    pub(crate) step: f64,
    pub(crate) order: Order,
    /// Every n-th communication point is recorded.
    pub(crate) record_every: usize,
}

/// Is shown every row with the number of its step, and may end the run.
pub(crate) type Observe<'a> = &'a mut dyn FnMut(usize, &[f64]) -> Result<(), Error>;

/// Position in a row of the first value that comes from outside.
const OUTSIDE: usize = 1;

/// Steps the members. A row is the time, the values from outside, then outputs of the members.
pub(crate) struct Master {
    members: Vec<Member>,
    row: Vec<f64>,
    /// First step and values of each change from outside.
    schedule: Vec<(usize, Vec<f64>)>,
    next: usize,
    done: usize,
    clock: Clock,
    recording: Recording,
    times: Vec<Duration>,
}

impl Master {
    /// Takes over instances in Initialization Mode, exchanges their first values and leaves that mode.
    pub(crate) fn new(
        members: Vec<Member>,
        recording: Recording,
        schedule: Vec<(usize, Vec<f64>)>,
        clock: Clock,
        instances: &mut [Instance],
    ) -> Result<Self, Error> {
        let mut master = Self {
            row: vec![0.0; recording.columns().len()],
            times: vec![Duration::ZERO; members.len()],
            members,
            schedule,
            next: 0,
            done: 0,
            clock,
            recording,
        };
        master.row[0] = clock.start;
        master.apply_schedule(0);
        master.initialise(instances)?;
        Ok(master)
    }

    /// Outputs that depend on inputs in Initialization Mode settle after as many exchanges as there are
    /// members, unless they depend on each other in a circle.
    fn initialise(&mut self, instances: &mut [Instance]) -> Result<(), Error> {
        for _ in 0..self.members.len() {
            let before = self.row.clone();
            self.read(instances, |member| !member.leads)?;
            for (i, instance) in instances.iter_mut().enumerate() {
                self.write(i, instance)?;
                if self.members[i].leads {
                    self.read_one(i, instance)?;
                }
            }
            let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
            if before.iter().zip(&self.row).all(same) {
                break;
            }
        }
        for instance in instances.iter_mut() {
            instance.exit_initialization()?;
        }
        self.read(instances, |member| member.leads)
    }

    /// Makes all steps.
    pub(crate) fn run(
        &mut self,
        instances: &mut [Instance],
        steps: usize,
        observe: Observe<'_>,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        for k in 0..steps {
            let time = self.time(k);
            if progress(k as f64 / steps as f64).is_break() {
                return Err(Error::Interrupted { time });
            }
            self.apply_schedule(k);
            self.row[0] = time;
            self.read(instances, |member| !member.leads)?;
            if self.clock.order == Order::SideBySide {
                for (i, instance) in instances.iter_mut().enumerate() {
                    self.write(i, instance)?;
                }
                self.record(k);
            }
            for (i, instance) in instances.iter_mut().enumerate() {
                if self.clock.order == Order::Sequential {
                    self.write(i, instance)?;
                }
                let begin = Instant::now();
                instance.do_step(time, self.clock.step)?;
                self.times[i] += begin.elapsed();
                if self.members[i].leads {
                    self.read_one(i, instance)?;
                }
            }
            if self.clock.order == Order::Sequential {
                self.record(k);
            }
            self.done = k + 1;
            observe(k, &self.row)?;
        }
        self.read(instances, |member| !member.leads)?;
        // Who stops a run during its last step means to stop what follows, too.
        match progress(1.0) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Interrupted {
                time: self.time(steps),
            }),
        }
    }

    /// Time of a communication point \[s\].
    fn time(&self, k: usize) -> f64 {
        self.clock.start + k as f64 * self.clock.step
    }

    /// Number of steps that all members have made.
    pub(crate) fn steps_done(&self) -> usize {
        self.done
    }

    /// The row as it is now: after a run, with the outputs at its end.
    pub(crate) fn row(&self) -> &[f64] {
        &self.row
    }

    /// The samples, and how long the steps of each member took together.
    pub(crate) fn finish(self) -> (Recording, Vec<Duration>) {
        (self.recording, self.times)
    }

    fn record(&mut self, k: usize) {
        if k.is_multiple_of(self.clock.record_every) {
            self.recording.push(&self.row);
        }
    }

    fn apply_schedule(&mut self, k: usize) {
        while let Some((first, values)) = self.schedule.get(self.next)
            && *first <= k
        {
            self.row[OUTSIDE..OUTSIDE + values.len()].copy_from_slice(values);
            self.next += 1;
        }
    }

    fn read(
        &mut self,
        instances: &mut [Instance],
        which: impl Fn(&Member) -> bool,
    ) -> Result<(), Error> {
        for (i, instance) in instances.iter_mut().enumerate() {
            if which(&self.members[i]) {
                self.read_one(i, instance)?;
            }
        }
        Ok(())
    }

    fn read_one(&mut self, member: usize, instance: &mut Instance) -> Result<(), Error> {
        let outputs = &mut self.members[member].outputs;
        let row = &mut self.row[outputs.range.clone()];
        Ok(outputs.signals.read(instance, row)?)
    }

    fn write(&mut self, member: usize, instance: &mut Instance) -> Result<(), Error> {
        let inputs = &mut self.members[member].inputs;
        for (value, feed) in inputs.values.iter_mut().zip(&inputs.feeds) {
            match feed.value(&self.row) {
                Some(number) if number.is_finite() => *value = number,
                found => {
                    let column = feed.slot.column;
                    return Err(self.unusable(column, found.is_none()));
                }
            }
        }
        Ok(inputs.signals.write(instance, &inputs.values)?)
    }

    #[cold]
    fn unusable(&self, column: usize, unmapped: bool) -> Error {
        let name = self.recording.columns()[column].name.clone();
        let (value, time) = (self.row[column], self.row[0]);
        if unmapped {
            Error::Unmapped { name, value, time }
        } else {
            Error::NotFinite { name, value, time }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feeds_are_mapped_then_scaled() {
        let slot = Slot {
            column: 1,
            factor: 2.0,
            offset: 1.0,
        };
        let feed = |map| Feed { slot, map };
        assert_eq!(feed(vec![]).value(&[0.0, 3.0]), Some(7.0));
        let mapped = feed(vec![(0.0, 5.0), (1.0, 6.0)]);
        assert_eq!(mapped.value(&[0.0, 1.0]), Some(13.0));
        assert_eq!(mapped.value(&[0.0, 2.0]), None);
    }
}
