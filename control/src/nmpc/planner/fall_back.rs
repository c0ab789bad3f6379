//! What is done without a new plan, and what is remembered for that.

use super::super::plan::{Plan, PlanStatus};
use super::super::problem::Initial;
use super::Planner;
use super::braking::brake;

/// Velocity left at the end of a shifted plan that counts as rest \[rad/s\]; relative to the start's where
/// that is above 1.
const REST_TOLERANCE: f64 = 1e-6;

impl Planner {
    /// Remembers the plan at hand, and the braking that follows it if it need not end at rest; `finite`:
    /// whether it has a trajectory.
    pub(super) fn remember(&mut self, finite: bool) {
        self.state.age = Some(0);
        let (moves, braking) = self.state.moves.split_at_mut(self.plan.moves.len());
        moves.copy_from_slice(&self.plan.moves);
        if let Some(set) = &self.safe_set {
            let lengths = std::iter::repeat(set.interval);
            // Without a start the trajectory is that of an earlier plan.
            let [angle, velocity] = if finite { self.plan.end() } else { [0.0; 2] };
            set.brake(angle, velocity, lengths, braking);
        }
    }

    /// When the moves in memory began; infinite: never \[s\] ago.
    fn ago(&self) -> f64 {
        self.state.age.map_or(f64::INFINITY, f64::from) * self.problem().period
    }

    /// The moves in memory as they go on from now, in `guess`; false if there are none any more.
    pub(super) fn shift_moves(&mut self) -> bool {
        let ago = self.ago();
        // A whole number of periods misses the end by rounding.
        let left = ago < self.grid.duration_of(&self.state.moves) * (1.0 - 1e-9);
        if left {
            self.grid.shifted(&self.state.moves, ago, &mut self.guess);
        }
        left
    }

    /// Rolls out what there is without a new plan: the previous one, shifted, or braking.
    pub(super) fn roll_out_fall_back(&mut self) {
        let left = self.shift_moves();
        let transcription = &self.transcription;
        if !left {
            let (problem, nodes) = (transcription.problem(), self.grid.nodes());
            let (initial, set) = (transcription.initial(), self.safe_set.as_ref());
            brake(problem, set, nodes, initial, &mut self.guess);
        }
        transcription.roll_out(&self.guess, &mut self.shifted);
    }

    /// Goes on with the previous moves if they still end at rest, else brakes.
    pub(super) fn fall_back(&mut self, initial: &Initial, finite: bool) -> PlanStatus {
        let left = self.shift_moves();
        let ago = self.ago();
        let transcription = &self.transcription;
        let Plan {
            moves,
            trajectory,
            time,
            ..
        } = &mut self.plan;
        moves.copy_from_slice(&self.guess);
        let gained = self.grid.gain_left(&self.state.moves, ago);
        let ends_at_rest = if finite {
            let start = initial.reference_velocity;
            (start + gained).abs() <= REST_TOLERANCE * (1.0 + start.abs())
        } else {
            gained.is_finite()
        };
        let mut status = PlanStatus::ShiftedPlan;
        if !left || !ends_at_rest {
            status = PlanStatus::Rest;
            let set = self.safe_set.as_ref();
            brake(transcription.problem(), set, time, initial, moves);
        }
        if finite {
            transcription.roll_out(moves, trajectory);
        }
        status
    }
}
