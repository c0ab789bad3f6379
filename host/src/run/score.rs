//! Scores a run while it goes on: the sum of squared errors, limits, the planner's work.
//!
//! The cost is Σ (setpoint − θ)² over 4 kHz samples, as in the tables of the paper; other communication
//! steps are weighted by their length. While the first of several setpoints holds, nothing is scored: the
//! arm only goes to its starting point.

use super::recording::{Recording, Slot};
use crate::input::roles::Role;
use crate::input::setpoints::AngleLimits;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Samples per second that the cost is defined by.
pub const COST_RATE: f64 = 4000.0;

/// What is measured of a run. A quantity is None if the FMUs do not offer it.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
pub struct Score {
    /// Σ (setpoint − θ)² over 4 kHz samples \[rad²\]; None also if no sample was scored.
    pub squared_error_rad2: Option<f64>,
    /// Time from which errors are scored \[s\].
    pub scored_from_s: f64,
    /// Samples at which a limit was violated: the plant's count, or samples outside the limits of the angle.
    pub violations: Option<u64>,
    /// Largest distance from the setpoint while it was scored \[rad\]; None also if no sample was.
    pub max_error_rad: Option<f64>,
    /// Largest absolute torque \[N·m\].
    pub max_torque_n_m: Option<f64>,
    /// Largest thermal load divided by its limit.
    pub max_thermal_fraction: Option<f64>,
    /// How the planner fared.
    pub planner: Option<Planner>,
}

/// How the planner fared, counted once for each plan that a communication point shows.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
pub struct Planner {
    /// Number of plans. A communication step that is longer than the planner's period counts as one.
    pub plans: u64,
    /// Plans by the name of their status.
    pub statuses: BTreeMap<String, u64>,
    /// Mean iterations of a plan.
    pub mean_iterations: Option<f64>,
    /// Most iterations of a plan.
    pub max_iterations: Option<u64>,
}

impl Score {
    /// The squared error, if it is beyond what a number can hold.
    pub(super) fn not_finite(&self) -> Option<f64> {
        self.squared_error_rad2.filter(|error| !error.is_finite())
    }
}

/// What scoring needs to know beside the samples.
#[derive(Clone, Debug, Default)]
pub(super) struct Terms {
    /// Communication step \[s\].
    pub(super) step: f64,
    /// First step that is scored.
    pub(super) first: usize,
    /// Limits of the angle, if they are known.
    pub(super) limits: Option<AngleLimits>,
    /// Largest admissible thermal load \[A²\], if it is known.
    pub(super) thermal_limit: Option<f64>,
    /// Period of the planner \[s\]; without it every step counts as a plan.
    pub(super) plan_period: Option<f64>,
}

/// Takes the samples.
pub(super) struct Scorer {
    terms: Terms,
    angle: Option<Slot>,
    torque: Option<Slot>,
    thermal: Option<(Slot, f64)>,
    violations: Option<Slot>,
    status: Option<Slot>,
    iterations: Option<Slot>,
    names: Vec<(i64, String)>,
    scored: bool,
    squared_error: f64,
    max_error: f64,
    max_torque: f64,
    max_thermal: f64,
    outside: u64,
    counted: f64,
    /// Plans by status, in the order of `names`; the last is for statuses without a name.
    plans: Vec<u64>,
    total_iterations: f64,
    max_iterations: f64,
    plan: f64,
}

impl Scorer {
    pub(super) fn new(recording: &Recording, terms: Terms) -> Self {
        let thermal = recording
            .slot(Role::ThermalFraction)
            .map(|slot| (slot, 1.0))
            .or_else(|| Some((recording.slot(Role::ThermalLoad)?, terms.thermal_limit?)));
        let status = recording.slot(Role::PlanStatus);
        let names = status.map_or(Vec::new(), |s| recording.columns()[s.column].items.clone());
        Self {
            angle: recording.slot(Role::Angle),
            torque: recording.slot(Role::Torque),
            thermal,
            violations: recording.slot(Role::Violations),
            iterations: recording.slot(Role::PlanIterations),
            plans: vec![0; names.len() + 1],
            status,
            names,
            terms,
            scored: false,
            squared_error: 0.0,
            max_error: 0.0,
            max_torque: 0.0,
            max_thermal: 0.0,
            outside: 0,
            counted: 0.0,
            total_iterations: 0.0,
            max_iterations: 0.0,
            plan: f64::NEG_INFINITY,
        }
    }

    /// Takes the sample of step `k`. Does not allocate.
    pub(super) fn sample(&mut self, k: usize, setpoint: f64, row: &[f64]) {
        if let Some(angle) = self.angle {
            let angle = angle.value(row);
            if k >= self.terms.first {
                let error = setpoint - angle;
                self.scored = true;
                self.squared_error += error * error;
                self.max_error = self.max_error.max(error.abs());
            }
            if let Some(limits) = self.terms.limits {
                self.outside += u64::from(!(limits.lower..=limits.upper).contains(&angle));
            }
        }
        if let Some(torque) = self.torque {
            self.max_torque = self.max_torque.max(torque.value(row).abs());
        }
        self.limits(row);
        if let Some(status) = self.status {
            let plan = self.terms.plan_period.map_or(k as f64, |period| {
                (k as f64 * self.terms.step / period + 1e-6).floor()
            });
            if plan != self.plan {
                self.plan = plan;
                self.count_plan(status.value(row), row);
            }
        }
    }

    /// Takes what the plant says after the last step.
    pub(super) fn last(&mut self, row: &[f64]) {
        self.limits(row);
    }

    fn limits(&mut self, row: &[f64]) {
        if let Some((slot, limit)) = self.thermal {
            self.max_thermal = self.max_thermal.max(slot.value(row) / limit);
        }
        if let Some(violations) = self.violations {
            self.counted = violations.value(row);
        }
    }

    fn count_plan(&mut self, status: f64, row: &[f64]) {
        let known = self
            .names
            .iter()
            .position(|(value, _)| *value as f64 == status);
        self.plans[known.unwrap_or(self.names.len())] += 1;
        if let Some(iterations) = self.iterations {
            let iterations = iterations.value(row);
            self.total_iterations += iterations;
            self.max_iterations = self.max_iterations.max(iterations);
        }
    }

    pub(super) fn finish(self) -> Score {
        let plans: u64 = self.plans.iter().sum();
        let names = self
            .names
            .iter()
            .map(|(_, name)| name.as_str())
            .chain(["unknown"]);
        let planner = self.status.map(|_| Planner {
            plans,
            statuses: names
                .zip(&self.plans)
                .filter(|(_, count)| **count > 0)
                .map(|(name, count)| (name.to_owned(), *count))
                .collect(),
            mean_iterations: self
                .iterations
                .filter(|_| plans > 0)
                .map(|_| self.total_iterations / plans as f64),
            max_iterations: self.iterations.map(|_| self.max_iterations as u64),
        });
        let scale = self.terms.step * COST_RATE;
        let scored = self.angle.filter(|_| self.scored);
        Score {
            squared_error_rad2: scored.map(|_| self.squared_error * scale),
            scored_from_s: self.terms.first as f64 * self.terms.step,
            violations: match (self.violations, self.angle, self.terms.limits) {
                (Some(_), _, _) => Some(self.counted as u64),
                (None, Some(_), Some(_)) => Some(self.outside),
                _ => None,
            },
            max_error_rad: scored.map(|_| self.max_error),
            max_torque_n_m: self.torque.map(|_| self.max_torque),
            max_thermal_fraction: self.thermal.map(|_| self.max_thermal),
            planner,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::recording::Column;
    use super::*;

    fn recording(roles: &[Role]) -> Recording {
        let mut columns = vec![Column::new("time", None), Column::new("setpoint", None)];
        let mut slots = BTreeMap::new();
        for role in roles {
            let slot = Slot {
                column: columns.len(),
                factor: 1.0,
                offset: 0.0,
            };
            slots.insert(*role, slot);
            let mut column = Column::new(format!("{role:?}"), None);
            column.items = vec![(0, "idle".into()), (1, "solved".into())];
            columns.push(column);
        }
        Recording::new(columns, slots, 0)
    }

    #[test]
    fn the_cost_is_a_sum_over_4_khz_samples_after_the_first_setpoint() {
        for (step, steps) in [(0.000_25, 40), (0.000_5, 20)] {
            let recording = recording(&[Role::Angle, Role::Torque]);
            let terms = Terms {
                step,
                first: steps / 2,
                ..Terms::default()
            };
            let mut scorer = Scorer::new(&recording, terms);
            for k in 0..steps {
                let error = if k < steps / 2 { 100.0 } else { 0.1 };
                scorer.sample(k, 1.0, &[0.0, 1.0, 1.0 - error, -3.0]);
            }
            let score = scorer.finish();
            assert!((score.squared_error_rad2.unwrap() - 20.0 * 0.01).abs() < 1e-12);
            assert_eq!(score.max_torque_n_m, Some(3.0));
            assert_eq!((score.violations, score.planner), (None, None));
        }
    }

    #[test]
    fn nothing_scored_is_no_perfect_score() {
        let terms = |first| Terms {
            step: 0.000_25,
            first,
            ..Terms::default()
        };
        let row = [0.0, 1.0, 1e300];
        let mut scorer = Scorer::new(&recording(&[Role::Angle]), terms(1));
        scorer.sample(0, 1.0, &row);
        let score = scorer.finish();
        assert_eq!(
            (score.squared_error_rad2, score.max_error_rad),
            (None, None)
        );
        assert_eq!(score.not_finite(), None);
        let mut scorer = Scorer::new(&recording(&[Role::Angle]), terms(0));
        scorer.sample(0, 1.0, &row);
        assert_eq!(scorer.finish().not_finite(), Some(f64::INFINITY));
    }

    #[test]
    fn limits_are_counted_where_the_plant_does_not() {
        let limits = Some(AngleLimits {
            lower: 0.0,
            upper: 1.0,
        });
        let terms = |thermal_limit| Terms {
            step: 1.0,
            limits,
            thermal_limit,
            ..Terms::default()
        };
        let mut scorer = Scorer::new(
            &recording(&[Role::Angle, Role::ThermalLoad]),
            terms(Some(4.0)),
        );
        for (k, angle) in [0.5, 1.5, -0.5, 1.0].into_iter().enumerate() {
            scorer.sample(k, 0.0, &[0.0, 0.0, angle, 3.0]);
        }
        let score = scorer.finish();
        assert_eq!(
            (score.violations, score.max_thermal_fraction),
            (Some(2), Some(0.75))
        );
        let mut scorer = Scorer::new(&recording(&[Role::Angle, Role::Violations]), terms(None));
        scorer.sample(0, 0.0, &[0.0, 0.0, 9.0, 0.0]);
        scorer.last(&[0.0, 0.0, 9.0, 7.0]);
        assert_eq!(scorer.finish().violations, Some(7));
    }

    #[test]
    fn plans_are_counted_once_a_period() {
        let terms = Terms {
            step: 0.000_25,
            plan_period: Some(0.05),
            ..Terms::default()
        };
        let mut scorer = Scorer::new(&recording(&[Role::PlanStatus, Role::PlanIterations]), terms);
        for k in 0..1000 {
            let plan = k / 200;
            let row = [0.0, 0.0, if plan == 4 { 9.0 } else { 1.0 }, plan as f64];
            scorer.sample(k, 0.0, &row);
        }
        let planner = scorer.finish().planner.unwrap();
        assert_eq!(planner.plans, 5);
        assert_eq!(
            planner.statuses,
            BTreeMap::from([("solved".into(), 4), ("unknown".into(), 1)])
        );
        assert_eq!(
            (planner.mean_iterations, planner.max_iterations),
            (Some(2.0), Some(4))
        );
    }
}
