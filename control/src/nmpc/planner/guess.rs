//! Where solvers start.

use super::super::plan::Plan;
use super::super::solver::SolverStatus;
use super::Planner;
use super::waiting::wait;

impl Planner {
    /// Replaces the plan by the previous one, shifted and led to the goal, if that is better; whether it is.
    pub(super) fn guess_from_shifted(&mut self) -> bool {
        if !self.shift_moves() {
            self.state.multipliers.known = false;
            return false;
        }
        let is_better = self.take_guess(false);
        self.state.multipliers.known &= is_better;
        is_better
    }

    /// From above the thermal limit, replaces the plan by one that waits where that takes little torque, if that
    /// is better; whether one is. A plan with multipliers gives way to one within the bounds only.
    pub(super) fn guess_waiting(&mut self) -> bool {
        let transcription = &self.transcription;
        let limit = transcription.problem().thermal_limit;
        let load = transcription.initial().thermal_load;
        if self.safe_set.is_some() || limit.is_none_or(|limit| load <= limit) {
            return false;
        }
        let must = self.state.multipliers.known;
        let mut guessed = false;
        for index in 0..self.rest.calm().len() {
            let place = self.rest.calm()[index];
            let nodes = self.grid.nodes();
            if wait(&self.transcription, place, nodes, &mut self.guess) && self.take_guess(must) {
                self.state.multipliers.known = false;
                guessed = true;
            }
        }
        guessed
    }

    /// Adds what solvers need to the rollout of the plan without inequalities.
    pub(super) fn complete_rollout(&mut self) {
        let Plan {
            moves, trajectory, ..
        } = &mut self.plan;
        self.transcription.roll_out(moves, trajectory);
    }

    /// Replaces the plan by the guess, led to the goal, if that is better and, where that `must`, keeps the angle
    /// bounds; whether it is.
    fn take_guess(&mut self, must: bool) -> bool {
        let transcription = &self.transcription;
        if self.safe_set.is_none() {
            transcription.end_at_rest(&mut self.guess);
        }
        transcription.roll_out(&self.guess, &mut self.guess_trajectory);
        let task = self.task();
        // NaN is not better.
        let is_better = task.merit(&self.guess_trajectory) < task.merit(&self.plan.trajectory)
            && (!must || task.keeps_angle_bounds(&self.guess_trajectory));
        if is_better {
            self.plan.moves.copy_from_slice(&self.guess);
            std::mem::swap(&mut self.plan.trajectory, &mut self.guess_trajectory);
        }
        is_better
    }

    /// Once more from the plan without inequalities. The previous plan, unlike one that ends at rest, is not led to
    /// the goal, and may be too far from it to be a start: one that stays at rest, if the goal moved.
    pub(super) fn run_from_unconstrained(&mut self) -> SolverStatus {
        let plan = &mut self.plan;
        self.guess.copy_from_slice(&plan.moves);
        std::mem::swap(&mut plan.trajectory, &mut self.guess_trajectory);
        self.unconstrained
            .solve(&self.transcription, &mut plan.moves, &mut plan.trajectory);
        self.complete_rollout();
        self.state.multipliers.known = false;
        let status = self.run_until_solved();
        let task = self.task();
        let is_better = task.rank(&self.guess_trajectory) < task.rank(&self.plan.trajectory);
        if status == SolverStatus::Solved || !is_better {
            return status;
        }
        self.plan.moves.copy_from_slice(&self.guess);
        std::mem::swap(&mut self.plan.trajectory, &mut self.guess_trajectory);
        SolverStatus::IterationLimit
    }
}
