//! Where solvers start.

use super::super::solver::SolverStatus;
use super::Planner;

impl Planner {
    /// Replaces the plan by the previous one, shifted and led to the goal, if that is better; whether it is.
    pub(super) fn guess_from_shifted(&mut self) -> bool {
        if !self.shift_moves() {
            self.state.multipliers.known = false;
            return false;
        }
        let transcription = &self.transcription;
        if self.safe_set.is_none() {
            transcription.end_at_rest(&mut self.guess);
        }
        transcription.roll_out(&self.guess, &mut self.guess_trajectory);
        let task = self.task();
        if task.merit(&self.guess_trajectory) < task.merit(&self.plan.trajectory) {
            self.plan.moves.copy_from_slice(&self.guess);
            std::mem::swap(&mut self.plan.trajectory, &mut self.guess_trajectory);
            true
        } else {
            self.state.multipliers.known = false;
            false
        }
    }

    /// Once more from the plan without inequalities. The previous plan, unlike one that ends at rest, is not led to
    /// the goal, and may be too far from it to be a start: one that stays at rest, if the goal moved.
    pub(super) fn run_from_unconstrained(&mut self) -> SolverStatus {
        let plan = &mut self.plan;
        self.guess.copy_from_slice(&plan.moves);
        std::mem::swap(&mut plan.trajectory, &mut self.guess_trajectory);
        self.unconstrained
            .solve(&self.transcription, &mut plan.moves, &mut plan.trajectory);
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
