//! What a controller gives at a sample, and what it remembers from one to the next.

use serde::{Deserialize, Serialize};

use crate::nmpc::plan::{PlanStatus, PlannerState};
use crate::planning::Origin;
use crate::{Reference, feedback, profile};

/// Far beyond what any arm does, and its fourth power, as in q_T·T², is still a number.
const LARGEST_NUMBER: f64 = 1e60;
/// Samples that can be told apart as instants; at 4 kHz they last for 70 000 years.
const MOST_SAMPLES: u64 = 1 << 53;

/// Result of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Command {
    /// Torque asked of the motor, within its peak \[N·m\].
    pub torque: f64,
    /// Current that gives the torque \[A\].
    pub current: f64,
    /// Reference of this sample.
    pub reference: Reference,
    /// Part of the torque from feedforward and computed torque \[N·m\].
    pub feedforward_torque: f64,
    /// Part of the torque from the feedback \[N·m\].
    pub feedback_torque: f64,
    /// Thermal load at this sample, reckoned from the torques so far \[A²\].
    pub thermal_load: f64,
    /// How the plan in use came to be.
    pub plan_status: PlanStatus,
    /// Whether a plan was made at this sample; it applies once its latency has gone by.
    pub new_plan: bool,
    /// Whether an input was not usable: the last good command, or the last good setpoint, is held.
    pub measurement_held: bool,
}

/// A plan that is made but not yet applied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pending {
    /// Number of the sample from which it applies.
    pub(crate) sample: u64,
    /// Its first move \[rad/s²\].
    pub(crate) acceleration: f64,
    /// Its rest point \[rad\].
    pub(crate) goal: f64,
    pub(crate) status: PlanStatus,
}

/// Everything that changes while a controller runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Samples taken.
    pub(crate) samples: u64,
    /// Samples taken up to and including the last usable measurement; 0 before the first.
    pub(crate) measured: u64,
    /// Last usable measured angle \[rad\].
    pub(crate) angle: f64,
    /// Last usable setpoint \[rad\].
    pub(crate) setpoint: Option<f64>,
    /// Number of the plan period with which the next plan is due.
    pub(crate) next_plan: u64,
    /// The last sample with a usable angle, as a plan begins with it.
    pub(crate) origin: Origin,
    /// The plan that waits for its latency to go by.
    pub(crate) pending: Option<Pending>,
    /// Number of the sample from which the plan in force applies.
    pub(crate) in_force: u64,
    /// How the plan in force came to be.
    pub(crate) plan_status: PlanStatus,
    /// Reference of the next sample, with the move in force.
    pub(crate) reference: Reference,
    /// Rest point of the plan in force, or the setpoint \[rad\].
    pub(crate) goal: f64,
    /// e, integral of the distance to the goal \[rad·s\] (eq 22).
    pub(crate) integral: f64,
    /// z of the Dahl hysteresis (eq 13).
    pub(crate) hysteresis: f64,
    /// T \[A²\] (eq 20).
    pub(crate) thermal_load: f64,
    pub(crate) feedback: feedback::State,
    pub(crate) profile: profile::State,
    pub(crate) planner: PlannerState,
    pub(crate) command: Command,
}

impl State {
    /// Before the first sample.
    pub(crate) fn new(thermal_load: f64, planner: &PlannerState) -> Self {
        Self {
            samples: 0,
            measured: 0,
            angle: 0.0,
            setpoint: None,
            next_plan: 0,
            origin: Origin::default(),
            in_force: 0,
            pending: None,
            plan_status: PlanStatus::Idle,
            reference: Reference::default(),
            goal: 0.0,
            integral: 0.0,
            hysteresis: 0.0,
            thermal_load,
            feedback: feedback::State::default(),
            profile: profile::State::default(),
            planner: planner.clone(),
            command: Command::default(),
        }
    }

    /// Whether a controller can be in this state: what one from elsewhere must be checked for.
    pub fn is_admissible(&self) -> bool {
        self.is_within_bounds() && self.is_in_order()
    }

    /// Whether measurement, origin and plan in force are of samples that were taken, and counting can go on.
    fn is_in_order(&self) -> bool {
        let counts = [self.measured, self.origin.sample, self.in_force];
        let within = self.samples.max(self.next_plan) <= MOST_SAMPLES;
        within && counts.iter().all(|&count| count <= self.samples)
    }

    /// Whether every number is one that can be worked with.
    fn is_within_bounds(&self) -> bool {
        let Origin {
            measured,
            acceleration,
            goal,
            setpoint,
            ..
        } = self.origin;
        let Command {
            torque,
            current,
            reference,
            feedforward_torque,
            feedback_torque,
            thermal_load,
            ..
        } = self.command;
        let pending = self.pending.map_or([0.0; 2], |p| [p.acceleration, p.goal]);
        let PlannerState {
            moves, multipliers, ..
        } = &self.planner;
        let own = [
            self.angle,
            self.setpoint.unwrap_or_default(),
            self.goal,
            self.integral,
            self.hysteresis,
            self.thermal_load,
            self.feedback.integral,
            self.feedback.torque,
        ];
        let lists: [&[f64]; 13] = [
            &own,
            &self.reference.numbers(),
            &self.profile.angles(),
            &measured.numbers(),
            &[acceleration, goal, setpoint],
            &[torque, current, thermal_load],
            &[feedforward_torque, feedback_torque],
            &reference.numbers(),
            &pending,
            moves,
            &multipliers.thermal,
            &multipliers.lower,
            &multipliers.upper,
        ];
        let mut numbers = lists.into_iter().flatten();
        numbers.all(|number| number.abs() <= LARGEST_NUMBER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_none_is_seen_wherever_it_stands() {
        let state = State::new(1.0, &PlannerState::new(3, 0));
        assert!(state.is_admissible());
        let edits: [fn(&mut State, f64); 10] = [
            |s, x| s.angle = x,
            |s, x| s.setpoint = Some(x),
            |s, x| s.thermal_load = x,
            |s, x| s.feedback.torque = x,
            |s, x| s.origin.measured.velocity = x,
            |s, x| s.reference.acceleration = x,
            |s, x| s.command.torque = x,
            |s, x| s.planner.moves[2] = x,
            |s, x| s.planner.multipliers.upper[1] = x,
            |s, x| {
                s.pending = Some(Pending {
                    sample: 1,
                    acceleration: 0.0,
                    goal: x,
                    status: PlanStatus::Idle,
                });
            },
        ];
        for (index, edit) in edits.iter().enumerate() {
            for bad in [f64::NAN, f64::INFINITY, -1e61] {
                let mut edited = state.clone();
                edit(&mut edited, bad);
                assert!(!edited.is_admissible(), "edit {index}");
            }
        }
    }

    #[test]
    fn what_comes_after_the_samples_taken_is_seen() {
        let mut state = State::new(1.0, &PlannerState::new(3, 0));
        state.samples = 7;
        let edits: [fn(&mut State, u64); 5] = [
            |s, n| s.measured = n,
            |s, n| s.origin.sample = n,
            |s, n| s.in_force = n,
            |s, n| s.samples = if n > 7 { u64::MAX } else { n },
            |s, n| s.next_plan = if n > 7 { u64::MAX } else { n },
        ];
        for (index, edit) in edits.iter().enumerate() {
            for (count, expected) in [(7, true), (8, false)] {
                let mut edited = state.clone();
                edit(&mut edited, count);
                assert_eq!(edited.is_admissible(), expected, "edit {index}");
            }
        }
    }
}
