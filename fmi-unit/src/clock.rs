//! Input clocks of FMI 3.0 (sec 2.2.8): the importer ticks them, in intervals that are parameters.
//!
//! An importer that ticks no clock gets the same unit, driven by its time events. With the first tick the
//! importer takes over, and time events are no more.

use serde::{Deserialize, Serialize};

use crate::access::check_parameters;
use crate::instance::Instance;
use crate::model::Variables;
use crate::unit::{Failure, Unit};

/// Clocks that tick at an instant, by their position in [`Model::clocks`](crate::Model::clocks).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ticks(u64);

impl Ticks {
    /// Whether the clock at `index` ticks.
    pub fn contains(self, index: usize) -> bool {
        self.0 & bit(index) != 0
    }

    /// Whether no clock ticks.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    fn set(&mut self, index: usize, on: bool) {
        if on {
            self.0 |= bit(index);
        } else {
            self.0 &= !bit(index);
        }
    }
}

/// No unit has more than 64 clocks.
fn bit(index: usize) -> u64 {
    u32::try_from(index).map_or(0, |index| 1_u64.checked_shl(index).unwrap_or(0))
}

/// Position of a clock.
pub(crate) fn locate<U: Unit>(reference: u32) -> Result<usize, Failure> {
    let clocks = U::Variables::MODEL.clocks;
    clocks
        .binary_search_by_key(&reference, |clock| clock.value_reference)
        .map_err(|_| Failure(format!("value reference {reference} is no clock")))
}

impl<U: Unit> Instance<U> {
    /// Activates or deactivates clocks until the discrete states are updated.
    pub(crate) fn set_clocks(&mut self, references: &[u32], active: &[u8]) -> Result<(), Failure> {
        let mut ticks = self.now.ticks;
        for (&reference, &active) in references.iter().zip(active) {
            ticks.set(locate::<U>(reference)?, active != 0);
        }
        self.now.ticks = ticks;
        self.now.clocked |= !ticks.is_empty();
        Ok(())
    }

    /// Whether each clock is active.
    pub(crate) fn get_clock(&self, reference: u32) -> Result<bool, Failure> {
        Ok(self.now.ticks.contains(locate::<U>(reference)?))
    }

    /// Fixes the interval of a clock \[s\]: of the parameter that it follows from.
    pub(crate) fn set_interval(&mut self, reference: u32, interval: f64) -> Result<(), Failure> {
        let clock = locate::<U>(reference)?;
        let before = U::clock_interval(&self.now.variables, clock);
        U::set_clock_interval(&mut self.now.variables, clock, interval);
        let outcome = check_parameters(&self.now.variables);
        if outcome.is_err() {
            U::set_clock_interval(&mut self.now.variables, clock, before);
        }
        self.now.stale = true;
        outcome
    }

    /// Interval of a clock \[s\].
    pub(crate) fn interval(&self, reference: u32) -> Result<f64, Failure> {
        Ok(U::clock_interval(
            &self.now.variables,
            locate::<U>(reference)?,
        ))
    }
}
