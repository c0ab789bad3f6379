//! The planner: a goal in, a plan out, whatever the start.
//!
//! 1. The setpoint moves to the nearest rest point that can be held ([`super::rest`]).
//! 2. The optimum without inequalities comes in closed form ([`super::unconstrained`]); where it keeps
//!    all limits it is the plan.
//! 3. Otherwise the solvers are tried in turn; the first starts from the best of that optimum, the previous
//!    plan, shifted, and, above the thermal limit, plans that wait where the arm takes little torque.
//! 4. Where no plan comes out, the previous plan goes on, shifted: it ends at rest. Where none is left,
//!    the reference is braked to rest.
//!
//! A plan that need not end at rest (`nmpc.terminal`) is remembered with the braking that follows it
//! ([`super::safe_set`]); step 4 then goes on with both. From a safe set that keeps all limits.
//!
//! With a clock ([`Planner::set_clock`]) the solvers stop before the deadline; the best of their iterates is
//! then the plan if it keeps the limits, or exceeds the thermal one little more than step 4 would, or step 4 would
//! leave the angle bounds.
//!
//! Outcomes are statuses, never errors. What is remembered from plan to plan is [`PlannerState`] alone.

mod angle_bounds;
mod braking;
mod fall_back;
mod guess;
mod waiting;

use arm::{Inadmissible, Limits, Motor, Parameters};

use self::angle_bounds::{bound_angle, widen};
use super::conic::Conic;
use super::grid::Grid;
use super::interior_point;
use super::plan::{Plan, PlanStatus, PlannerState};
use super::problem::{FeedbackModel, Initial, Model, Problem, Terminal};
use super::rest::RestPoints;
use super::rollout::{Rollout, are_finite};
use super::safe_set::SafeSet;
use super::settings::{Method, Settings};
use super::solver::{Clock, Solver, SolverStatus, THERMAL_TOLERANCE, Task, TimeLimit};
use super::spline;
use super::transcription::Transcription;
use super::unconstrained::Unconstrained;

/// Price of thermal excess, in units of the inequality-free optimum's cost \[1/A²\]. The multipliers of
/// feasible instances stay below 55.
const EXCESS_WEIGHT: f64 = 1e3;
/// Movement whose cost is the least that counts as 1, so that a plan to stay has a scale \[rad\].
const LEAST_MOVEMENT: f64 = 1e-3;
/// Excess of an unfinished plan that is taken, relative to that of the fallback.
const NEARLY_LEAST: f64 = 1.1;
/// Excess of the linear model's torque that is none of the plan's, in units of the limit: where a plan along
/// the limit goes on, the measured angle is never quite the predicted one.
const TORQUE_SLACK: f64 = 1e-3;

/// Makes plans for one arm.
pub struct Planner {
    transcription: Transcription,
    grid: Grid,
    /// Time for a plan \[s\]; 0: any.
    deadline: f64,
    clock: Option<Box<dyn Clock>>,
    /// When the plan at hand must be ready \[s\].
    end: f64,
    rest: RestPoints,
    /// For every interval of rest points; none where plans end at rest.
    safe_sets: Vec<SafeSet>,
    /// Where the plan at hand may end, if not at rest.
    safe_set: Option<SafeSet>,
    unconstrained: Unconstrained,
    /// Tried in this order; none for N = 2 with terminal rest, which then leaves no choice.
    solvers: Vec<Box<dyn Solver + Send>>,
    least_scale: f64,
    cost_scale: f64,
    angle_bounds: Vec<[f64; 2]>,
    /// Whether these are wider than the problem's.
    widened: bool,
    state: PlannerState,
    plan: Plan,
    shifted: Rollout,
    guess: Vec<f64>,
    guess_trajectory: Rollout,
}

impl Planner {
    /// Sets a planner up. `arm`, `motor`, `limits` and `feedback` are taken to be admissible.
    ///
    /// # Errors
    /// All settings that are not admissible.
    pub fn new(
        settings: &Settings,
        arm: &Parameters,
        motor: &Motor,
        limits: &Limits,
        feedback: &FeedbackModel,
    ) -> Result<Self, Vec<Inadmissible>> {
        let problem = settings.problem(arm, motor, limits, feedback)?;
        let horizon = problem.horizon;
        let transcription = Transcription::new(problem, settings.instructions);
        let grid = Grid::new(&problem);
        let unconstrained = Unconstrained::new(&transcription).ok_or_else(|| {
            vec![Inadmissible {
                name: "nmpc.weight_acceleration",
                value: problem.weights.acceleration,
                admissible: format!(
                    "large enough beside the other weights for a definite cost: more than {:e}",
                    problem.weights.acceleration
                ),
                unit: "s4",
            }]
        })?;
        let least_scale = unconstrained.cost_of_movement(LEAST_MOVEMENT);
        let mut solvers: Vec<Box<dyn Solver + Send>> = Vec::new();
        let ends_at_rest = problem.terminal == Terminal::RestAtGoal;
        if horizon > 2 || !ends_at_rest {
            let structured = problem.model == Model::Nonlinear && ends_at_rest;
            if settings.solver != Method::Clarabel && structured {
                solvers.push(interior_point::new(&transcription));
            }
            if settings.solver != Method::Riccati {
                solvers.push(Box::new(Conic::new(
                    &transcription,
                    spline::hessian(&transcription),
                )));
            }
        }
        let rest = RestPoints::new(&problem);
        let (mut safe_sets, mut braking) = (Vec::new(), 0);
        if !ends_at_rest {
            let intervals = rest.intervals().iter();
            safe_sets.extend(intervals.map(|&[from, to]| SafeSet::new(&problem, from, to)));
            braking = SafeSet::stopping_intervals(horizon);
        }
        Ok(Self {
            rest,
            safe_set: safe_sets.first().copied(),
            safe_sets,
            unconstrained,
            solvers,
            least_scale,
            cost_scale: least_scale,
            angle_bounds: vec![[0.0; 2]; problem.bounded_nodes()],
            widened: false,
            state: PlannerState::new(horizon, braking),
            plan: Plan::new(&grid),
            shifted: Rollout::new(horizon),
            guess: vec![0.0; horizon],
            guess_trajectory: Rollout::new(horizon),
            deadline: settings.deadline,
            clock: None,
            end: f64::INFINITY,
            grid,
            transcription,
        })
    }

    /// Tells the time from now on, without which no deadline is kept.
    pub fn set_clock(&mut self, clock: Box<dyn Clock>) {
        self.clock = Some(clock);
    }

    /// The problem that is solved.
    pub fn problem(&self) -> &Problem {
        self.transcription.problem()
    }

    /// Its shooting nodes in time.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The latest plan.
    pub fn latest(&self) -> &Plan {
        &self.plan
    }

    /// Whether the latest plan was allowed beyond the angle bounds: from a start outside, or because there was no
    /// other way.
    pub fn widened_bounds(&self) -> bool {
        self.widened
    }

    /// What must be remembered to go on from here.
    pub fn state(&self) -> &PlannerState {
        &self.state
    }

    /// Goes on from `state`; one of another horizon counts as none.
    pub fn set_state(&mut self, state: &PlannerState) {
        let horizon = self.problem().horizon;
        let moves = self.state.moves.len();
        if state.moves.len() == moves && state.multipliers.fit(horizon) {
            self.state.clone_from(state);
        } else {
            self.state.age = None;
        }
    }

    /// Plans from `initial` to the rest point nearest to `setpoint` \[rad\], one period after the plan
    /// before. If start or setpoint is not a finite number the previous moves go on and the trajectory
    /// stays.
    pub fn plan(&mut self, initial: &Initial, setpoint: f64) -> &Plan {
        if let Some(clock) = &self.clock {
            self.end = clock.now() + self.deadline;
        }
        self.state.age = self.state.age.map(|age| age.saturating_add(1));
        if self.state.multipliers.known {
            self.grid.shift(&mut self.state.multipliers);
        }
        (self.plan.iterations, self.plan.convex_problems) = (0, 0);
        self.widened = false;
        let finite = initial.is_finite() && setpoint.is_finite();
        if finite {
            let (goal, interval) = self.rest.nearest(setpoint);
            self.plan.goal = goal;
            self.safe_set = self.safe_sets.get(interval).copied();
            self.transcription.set(*initial, goal);
        }
        let status = if finite { self.solve(setpoint) } else { None };
        self.plan.status = status.unwrap_or_else(|| self.fall_back(initial, finite));
        if self.plan.status != PlanStatus::ShiftedPlan {
            self.remember(finite);
        }
        &self.plan
    }

    /// Makes a new plan; none if there is none worth having.
    fn solve(&mut self, setpoint: f64) -> Option<PlanStatus> {
        let plan = &mut self.plan;
        let settled =
            self.unconstrained
                .solve(&self.transcription, &mut plan.moves, &mut plan.trajectory);
        self.cost_scale = plan.trajectory.cost.max(self.least_scale);
        self.widened = bound_angle(
            &mut self.angle_bounds,
            self.transcription.problem(),
            &plan.trajectory,
        );
        if let (Some(set), Some([lower, upper])) = (&mut self.safe_set, self.angle_bounds.last()) {
            // A start from beyond the bounds may still be on its way back at the end.
            let problem = self.transcription.problem();
            set.lower -= (problem.angle_lower - lower).max(0.0);
            set.upper += (upper - problem.angle_upper).max(0.0);
        }
        let status = if settled && self.task().admits(&self.plan.trajectory) {
            self.state.multipliers.known = false;
            SolverStatus::Solved
        } else {
            self.run_solvers()
        };

        let stopped = match status {
            SolverStatus::IterationLimit => Some(PlanStatus::IterationLimit),
            SolverStatus::OutOfTime => Some(PlanStatus::Deadline),
            SolverStatus::Solved | SolverStatus::Infeasible => None,
        };
        if stopped.is_some() {
            self.roll_out_fall_back();
        }
        let Plan {
            moves, trajectory, ..
        } = &self.plan;
        if !trajectory.is_finite() || !are_finite(moves) {
            return None;
        }
        let problem = self.transcription.problem();
        // The limit itself, not what is kept back of it.
        let limit = problem.thermal_limit.unwrap_or(f64::INFINITY);
        let mut loads = trajectory.thermal_load[1..].iter();
        let over = trajectory.excess > THERMAL_TOLERANCE
            && loads.any(|load| load - limit > THERMAL_TOLERANCE);
        let task = self.task();
        // At the plan's end also what stopping takes, if that is to be kept free.
        let over = over
            || (task.safe_set.is_some() && task.excess(trajectory) > THERMAL_TOLERANCE)
            || task.torque_excess(trajectory) > TORQUE_SLACK;
        let widened = self.widened;
        match status {
            SolverStatus::Solved if over => Some(PlanStatus::ThermalSlack),
            SolverStatus::Solved if widened => Some(PlanStatus::AngleSlack),
            SolverStatus::Solved if self.plan.goal != setpoint => Some(PlanStatus::GoalProjected),
            SolverStatus::Solved => Some(PlanStatus::Solved),
            SolverStatus::Infeasible => None,
            _ if task.admits(trajectory) && widened => Some(PlanStatus::AngleSlack),
            _ if task.admits(trajectory) => stopped,
            // Excess is near its least long before the sequence settles; it is taken unless going on as
            // before, or braking, exceeds the limit by less and keeps the bounds too.
            _ if task.keeps_bounds(trajectory)
                && (task.penalty(trajectory) <= NEARLY_LEAST * task.penalty(&self.shifted)
                    || !task.keeps_bounds(&self.shifted)) =>
            {
                stopped
            }
            _ => None,
        }
    }

    /// Improves on the plan without inequalities.
    fn run_solvers(&mut self) -> SolverStatus {
        let guessed = self.guess_from_shifted() | self.guess_waiting();
        if !guessed {
            self.complete_rollout();
        }
        let status = self.run_until_solved();
        if guessed && self.safe_set.is_some() && status == SolverStatus::IterationLimit {
            return self.run_from_unconstrained();
        }
        if status != SolverStatus::Infeasible || self.safe_set.is_some() {
            return status;
        }
        // So short a horizon leaves too little freedom: allow what terminal rest takes.
        let Plan {
            moves, trajectory, ..
        } = &mut self.plan;
        self.unconstrained
            .solve(&self.transcription, moves, trajectory);
        let problem = self.transcription.problem();
        self.widened = widen(&mut self.angle_bounds, problem, trajectory);
        self.complete_rollout();
        self.state.multipliers.known = false;
        match self.run_until_solved() {
            // Unfinished plans are not worth leaving the bounds for when there was no time to try within.
            SolverStatus::OutOfTime => SolverStatus::Infeasible,
            status => status,
        }
    }

    /// Solver after solver until one converges or the time is up; the last one's status.
    fn run_until_solved(&mut self) -> SolverStatus {
        let mut status = SolverStatus::Solved;
        for index in 0..self.solvers.len() {
            status = self.run_solver(index);
            if matches!(status, SolverStatus::Solved | SolverStatus::OutOfTime) {
                break;
            }
        }
        status
    }

    fn run_solver(&mut self, index: usize) -> SolverStatus {
        let plan = &mut self.plan;
        let (clock, end) = (self.clock.as_deref(), self.end);
        let clock = clock.filter(|_| self.deadline > 0.0);
        let time_limit = clock.map(|clock| TimeLimit { clock, end });
        let task = Task {
            time_limit,
            ..task(
                &self.transcription,
                &self.angle_bounds,
                self.safe_set.as_ref(),
                self.cost_scale,
            )
        };
        let outcome = self.solvers[index].solve(
            &task,
            &mut plan.moves,
            &mut plan.trajectory,
            &mut self.state.multipliers,
        );
        plan.iterations += outcome.iterations;
        plan.convex_problems += outcome.convex_problems;
        outcome.status
    }

    /// The task at hand.
    fn task(&self) -> Task<'_> {
        task(
            &self.transcription,
            &self.angle_bounds,
            self.safe_set.as_ref(),
            self.cost_scale,
        )
    }
}

/// A task with the planner's price of thermal excess.
fn task<'a>(
    transcription: &'a Transcription,
    angle_bounds: &'a [[f64; 2]],
    safe_set: Option<&'a SafeSet>,
    cost_scale: f64,
) -> Task<'a> {
    let is_asked_for = transcription.problem().terminal == Terminal::SafeSet;
    Task {
        transcription,
        angle_bounds,
        safe_set: safe_set.filter(|_| is_asked_for),
        cost_scale,
        excess_weight: EXCESS_WEIGHT,
        time_limit: None,
    }
}

#[cfg(test)]
mod tests;
