//! The planner: a goal in, a plan out, whatever the start.
//!
//! 1. The setpoint moves to the nearest rest point that can be held ([`super::rest`]).
//! 2. The optimum without inequalities comes in closed form ([`super::unconstrained`]); where it keeps
//!    all limits it is the plan.
//! 3. Otherwise the solver starts from the better of that optimum and the previous plan, shifted.
//! 4. Where no plan comes out, the previous plan goes on, shifted: it ends at rest. Where none is left,
//!    the reference is braked to rest.
//!
//! Outcomes are statuses, never errors. What is remembered from plan to plan is [`PlannerState`] alone.

use arm::{Inadmissible, Limits, Motor, Parameters};
use serde::{Deserialize, Serialize};

use super::conic::Conic;
use super::problem::{FeedbackModel, Initial, Problem};
use super::rest::RestPoints;
use super::settings::Settings;
use super::solver::{ANGLE_TOLERANCE, Solver, SolverStatus, THERMAL_TOLERANCE, Task};
use super::spline::{self, Spline};
use super::transcription::{Rollout, Transcription};
use super::unconstrained::Unconstrained;

/// Price of thermal excess, in units of the inequality-free optimum's cost \[1/A²\]. The multipliers of
/// feasible instances stay below 55.
const EXCESS_WEIGHT: f64 = 1e3;
/// Movement whose cost is the least that counts as 1, so that a plan to stay has a scale \[rad\].
const LEAST_MOVEMENT: f64 = 1e-4;
/// Velocity left at the end of a shifted plan that counts as rest, relative to the plan's largest.
const REST_TOLERANCE: f64 = 1e-6;

/// How the plan in use came to be; numbered as `PlanStatus` in the contract.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum PlanStatus {
    /// No plan.
    #[default]
    Idle = 0,
    /// Solved to tolerance.
    Solved = 1,
    /// Solved for the admissible rest point nearest to the setpoint.
    GoalProjected = 2,
    /// Solved, but the thermal limit could not be kept: the least excess was planned.
    ThermalSlack = 3,
    /// Admissible, but the sequence of convex problems was stopped before it converged.
    IterationLimit = 4,
    /// No new plan was found: the previous plan, shifted.
    ShiftedPlan = 5,
    /// No plan was found and none is left: the reference is brought to rest.
    Rest = 6,
    /// A measurement was not a number: the last good command is held.
    MeasurementHeld = 7,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How it came to be.
    pub status: PlanStatus,
    /// Interior-point iterations.
    pub iterations: u32,
    /// Convex problems.
    pub convex_problems: u32,
    /// Rest point at the end \[rad\].
    pub goal: f64,
    /// u \[N\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// Trajectory and cost in the true model.
    pub trajectory: Rollout,
}

/// What the planner remembers from plan to plan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannerState {
    /// Moves of the previous plan \[N\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// How many of the moves are still to come once the first was made; 0 before the first plan.
    pub left: usize,
}

/// Makes plans for one arm.
pub struct Planner {
    transcription: Transcription,
    rest: RestPoints,
    unconstrained: Unconstrained,
    /// None for N = 2, where terminal rest leaves no choice.
    solver: Option<Box<dyn Solver + Send>>,
    least_scale: f64,
    angle_bounds: Vec<[f64; 2]>,
    state: PlannerState,
    plan: Plan,
    spline: Spline,
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
        let (horizon, period) = (problem.horizon, problem.period);
        let transcription = Transcription::new(problem);
        let hessian = spline::hessian(&transcription);
        let unconstrained = Unconstrained::new(&transcription, &hessian).ok_or_else(|| {
            vec![Inadmissible {
                name: "nmpc.weight_acceleration",
                value: problem.weights.acceleration,
                admissible: "large enough beside the other weights for a definite cost".to_owned(),
                unit: "s4",
            }]
        })?;
        let least_scale = match hessian.diagonal().iter().copied().reduce(f64::max) {
            Some(curvature) => curvature * LEAST_MOVEMENT * LEAST_MOVEMENT,
            None => f64::MIN_POSITIVE,
        };
        let solver = (horizon > 2)
            .then(|| Box::new(Conic::new(&transcription, hessian)) as Box<dyn Solver + Send>);
        Ok(Self {
            rest: RestPoints::new(&problem),
            unconstrained,
            solver,
            least_scale,
            angle_bounds: vec![[0.0; 2]; horizon - 1],
            state: PlannerState {
                moves: vec![0.0; horizon],
                left: 0,
            },
            plan: Plan {
                status: PlanStatus::Idle,
                iterations: 0,
                convex_problems: 0,
                goal: 0.0,
                moves: vec![0.0; horizon],
                trajectory: Rollout::new(horizon),
            },
            spline: Spline::new(horizon, period),
            shifted: Rollout::new(horizon),
            guess: vec![0.0; horizon],
            guess_trajectory: Rollout::new(horizon),
            transcription,
        })
    }

    /// The problem that is solved.
    pub fn problem(&self) -> &Problem {
        self.transcription.problem()
    }

    /// The latest plan.
    pub fn latest(&self) -> &Plan {
        &self.plan
    }

    /// What must be remembered to go on from here.
    pub fn state(&self) -> &PlannerState {
        &self.state
    }

    /// Goes on from `state`; one of another horizon counts as none.
    pub fn set_state(&mut self, state: &PlannerState) {
        if state.moves.len() == self.state.moves.len() {
            self.state.clone_from(state);
        } else {
            self.state.left = 0;
        }
    }

    /// Plans from `initial` to the rest point nearest to `setpoint` \[rad\], one period after the plan
    /// before. If start or setpoint is not a finite number the previous moves go on and the trajectory
    /// stays.
    pub fn plan(&mut self, initial: &Initial, setpoint: f64) -> &Plan {
        self.state.moves.rotate_left(1);
        if let Some(last) = self.state.moves.last_mut() {
            *last = 0.0;
        }
        let finite = initial.is_finite() && setpoint.is_finite();
        if finite {
            self.plan.goal = self.rest.nearest(setpoint);
            self.transcription.set(*initial, self.plan.goal);
        }
        let status = if finite { self.solve(setpoint) } else { None };
        match status {
            Some(status) => {
                self.plan.status = status;
                self.state.left = self.plan.moves.len();
            }
            None => self.fall_back(initial, finite),
        }
        self.state.moves.copy_from_slice(&self.plan.moves);
        &self.plan
    }

    /// Makes a new plan; none if there is none worth having.
    fn solve(&mut self, setpoint: f64) -> Option<PlanStatus> {
        let transcription = &self.transcription;
        let Plan {
            iterations,
            convex_problems,
            goal,
            moves,
            trajectory,
            ..
        } = &mut self.plan;
        (*iterations, *convex_problems) = (0, 1);
        let settled = self.unconstrained.solve(transcription, moves, trajectory);
        let cost_scale = trajectory.cost.max(self.least_scale);
        bound_angle(&mut self.angle_bounds, transcription.problem(), trajectory);
        let mut status = SolverStatus::Solved;
        if let Some(solver) = &mut self.solver
            && !(settled && task(transcription, &self.angle_bounds, cost_scale).admits(trajectory))
        {
            if self.state.left > 0 {
                transcription.roll_out(&self.state.moves, &mut self.shifted);
                self.spline.fit(&self.shifted);
                self.spline.fix_ends(transcription);
                self.spline.moves(&mut self.guess);
                transcription.roll_out(&self.guess, &mut self.guess_trajectory);
                let task = task(transcription, &self.angle_bounds, cost_scale);
                if task.merit(&self.guess_trajectory) < task.merit(trajectory) {
                    moves.copy_from_slice(&self.guess);
                    trajectory.clone_from(&self.guess_trajectory);
                }
            }
            let mut outcome = solver.solve(
                &task(transcription, &self.angle_bounds, cost_scale),
                moves,
                trajectory,
            );
            (*iterations, *convex_problems) = (outcome.iterations, outcome.convex_problems);
            if outcome.status == SolverStatus::Infeasible {
                // So short a horizon leaves too little freedom: allow what terminal rest takes.
                self.unconstrained.solve(transcription, moves, trajectory);
                widen(&mut self.angle_bounds, trajectory);
                outcome = solver.solve(
                    &task(transcription, &self.angle_bounds, cost_scale),
                    moves,
                    trajectory,
                );
                *iterations += outcome.iterations;
                *convex_problems += outcome.convex_problems;
            }
            status = outcome.status;
        }
        if !trajectory.is_finite() || moves.iter().any(|u| !u.is_finite()) {
            return None;
        }
        let task = task(transcription, &self.angle_bounds, cost_scale);
        let over = trajectory.excess > THERMAL_TOLERANCE;
        match status {
            SolverStatus::Solved if over => Some(PlanStatus::ThermalSlack),
            SolverStatus::Solved if *goal != setpoint => Some(PlanStatus::GoalProjected),
            SolverStatus::Solved => Some(PlanStatus::Solved),
            SolverStatus::IterationLimit if task.admits(trajectory) => {
                Some(PlanStatus::IterationLimit)
            }
            // Excess is near its least long before the sequence settles; it is taken where the shifted
            // plan would exceed the limit as well.
            SolverStatus::IterationLimit
                if task.angle_excess(trajectory) <= ANGLE_TOLERANCE
                    && (self.state.left == 0 || self.shifted.excess > THERMAL_TOLERANCE) =>
            {
                Some(PlanStatus::ThermalSlack)
            }
            SolverStatus::IterationLimit | SolverStatus::Infeasible => None,
        }
    }

    /// Goes on with the previous moves if they still end at rest, else brakes.
    fn fall_back(&mut self, initial: &Initial, finite: bool) {
        let transcription = &self.transcription;
        let Plan {
            status,
            moves,
            trajectory,
            ..
        } = &mut self.plan;
        self.state.left = self.state.left.saturating_sub(1);
        moves.copy_from_slice(&self.state.moves);
        let gained: f64 = moves.iter().sum::<f64>() * transcription.problem().period;
        let rest = initial.reference_velocity + gained;
        let speed = moves
            .iter()
            .fold(initial.reference_velocity.abs(), |most, u| {
                most.max((u * transcription.problem().period).abs())
            });
        *status = PlanStatus::ShiftedPlan;
        if self.state.left == 0 || (finite && rest.abs() > REST_TOLERANCE * speed.max(1.0)) {
            *status = PlanStatus::Rest;
            self.state.left = moves.len();
            brake(transcription.problem(), initial, moves);
        }
        if finite {
            transcription.roll_out(moves, trajectory);
        }
    }
}

/// The task at hand, with the planner's price of thermal excess.
fn task<'a>(
    transcription: &'a Transcription,
    angle_bounds: &'a [[f64; 2]],
    cost_scale: f64,
) -> Task<'a> {
    Task {
        transcription,
        angle_bounds,
        cost_scale,
        excess_weight: EXCESS_WEIGHT,
    }
}

/// Bounds of θr at the nodes 1..N−1 (eq 25). A start outside may return as slowly as the optimum without
/// inequalities does; once that is inside, the bounds hold.
fn bound_angle(bounds: &mut [[f64; 2]], problem: &Problem, unbounded: &Rollout) {
    let (lower, upper) = (problem.angle_lower, problem.angle_upper);
    let start = unbounded.reference_angle[0];
    let (mut below, mut above) = (start < lower, start > upper);
    for (bound, &angle) in bounds.iter_mut().zip(&unbounded.reference_angle[1..]) {
        below &= angle < lower;
        above &= angle > upper;
        *bound = [
            if below { angle } else { lower },
            if above { angle } else { upper },
        ];
    }
}

/// Widens the bounds so that `trajectory` keeps them.
fn widen(bounds: &mut [[f64; 2]], trajectory: &Rollout) {
    for ([lower, upper], &angle) in bounds.iter_mut().zip(&trajectory.reference_angle[1..]) {
        (*lower, *upper) = (lower.min(angle), upper.max(angle));
    }
}

/// Brakes the reference to rest, evenly and no faster than the angle bound ahead demands.
fn brake(problem: &Problem, initial: &Initial, moves: &mut [f64]) {
    let (angle, velocity) = (initial.reference_angle, initial.reference_velocity);
    moves.fill(0.0);
    if !velocity.is_finite() || velocity == 0.0 {
        return;
    }
    let room = if velocity > 0.0 {
        problem.angle_upper - angle
    } else {
        angle - problem.angle_lower
    };
    let per_period = 0.5 * velocity.abs() * problem.period;
    let periods = ((room / per_period) as usize).clamp(1, moves.len());
    moves[..periods].fill(-velocity / (periods as f64 * problem.period));
}
