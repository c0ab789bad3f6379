//! The planner: a goal in, a plan out, whatever the start.
//!
//! 1. The setpoint moves to the nearest rest point that can be held ([`super::rest`]).
//! 2. The optimum without inequalities comes in closed form ([`super::unconstrained`]); where it keeps
//!    all limits it is the plan.
//! 3. Otherwise the solvers are tried in turn; the first starts from the better of that optimum and the previous plan, shifted.
//! 4. Where no plan comes out, the previous plan goes on, shifted: it ends at rest. Where none is left,
//!    the reference is braked to rest.
//!
//! Outcomes are statuses, never errors. What is remembered from plan to plan is [`PlannerState`] alone.

use arm::{Inadmissible, Limits, Motor, Parameters};
use serde::{Deserialize, Serialize};

use super::conic::Conic;
use super::interior_point;
use super::problem::{FeedbackModel, Initial, Problem};
use super::rest::RestPoints;
use super::rollout::Rollout;
use super::settings::{Method, Settings};
use super::solver::{ANGLE_TOLERANCE, Multipliers, Solver, SolverStatus, THERMAL_TOLERANCE, Task};
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
/// Velocity left at the end of a shifted plan that counts as rest \[rad/s\]; relative to the start's where
/// that is above 1.
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
    /// Admissible, but the solver was stopped before it converged.
    IterationLimit = 4,
    /// No new plan was found: the previous plan, shifted.
    ShiftedPlan = 5,
    /// No plan was found and none is left: the reference is brought to rest.
    Rest = 6,
    /// A measurement was not a number: the last good command is held.
    MeasurementHeld = 7,
    /// Solved, but start and terminal rest left no way within the angle bounds: they were widened.
    AngleSlack = 8,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How it came to be.
    pub status: PlanStatus,
    /// Interior-point iterations; 0 for a plan in closed form.
    pub iterations: u32,
    /// Convex problems that Clarabel solved.
    pub convex_problems: u32,
    /// Rest point at the end \[rad\].
    pub goal: f64,
    /// u \[N\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// Trajectory and cost in the true model.
    pub trajectory: Rollout,
}

/// What the planner remembers from plan to plan.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannerState {
    /// Moves of the previous plan \[N\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// How many of the moves are still to come once the first was made; 0 before the first plan.
    pub left: usize,
    /// Multipliers of the previous plan.
    pub multipliers: Multipliers,
}

impl Clone for PlannerState {
    fn clone(&self) -> Self {
        Self {
            moves: self.moves.clone(),
            left: self.left,
            multipliers: self.multipliers.clone(),
        }
    }

    /// Without allocation where the horizons agree.
    fn clone_from(&mut self, source: &Self) {
        self.moves.clone_from(&source.moves);
        self.left = source.left;
        self.multipliers.copy_from(&source.multipliers);
    }
}

/// Makes plans for one arm.
pub struct Planner {
    transcription: Transcription,
    rest: RestPoints,
    unconstrained: Unconstrained,
    /// Tried in this order; none for N = 2, where terminal rest leaves no choice.
    solvers: Vec<Box<dyn Solver + Send>>,
    least_scale: f64,
    cost_scale: f64,
    angle_bounds: Vec<[f64; 2]>,
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
        if horizon > 2 {
            if settings.solver != Method::Clarabel {
                solvers.push(interior_point::new(&transcription));
            }
            if settings.solver != Method::Riccati {
                solvers.push(Box::new(Conic::new(
                    &transcription,
                    spline::hessian(&transcription),
                )));
            }
        }
        Ok(Self {
            rest: RestPoints::new(&problem),
            unconstrained,
            solvers,
            least_scale,
            cost_scale: least_scale,
            angle_bounds: vec![[0.0; 2]; horizon - 1],
            state: PlannerState {
                moves: vec![0.0; horizon],
                left: 0,
                multipliers: Multipliers::new(horizon),
            },
            plan: Plan {
                status: PlanStatus::Idle,
                iterations: 0,
                convex_problems: 0,
                goal: 0.0,
                moves: vec![0.0; horizon],
                trajectory: Rollout::new(horizon),
            },
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
        self.state.multipliers.shift();
        (self.plan.iterations, self.plan.convex_problems) = (0, 0);
        let finite = initial.is_finite() && setpoint.is_finite();
        if finite {
            self.plan.goal = self.rest.nearest(setpoint);
            self.transcription.set(*initial, self.plan.goal);
        }
        let status = if finite { self.solve(setpoint) } else { None };
        self.state.left = match status {
            Some(_) => self.plan.moves.len(),
            None => self.state.left.saturating_sub(1),
        };
        self.plan.status = status.unwrap_or_else(|| self.fall_back(initial, finite));
        self.state.moves.copy_from_slice(&self.plan.moves);
        &self.plan
    }

    /// Makes a new plan; none if there is none worth having.
    fn solve(&mut self, setpoint: f64) -> Option<PlanStatus> {
        let plan = &mut self.plan;
        let settled =
            self.unconstrained
                .solve(&self.transcription, &mut plan.moves, &mut plan.trajectory);
        self.cost_scale = plan.trajectory.cost.max(self.least_scale);
        bound_angle(
            &mut self.angle_bounds,
            self.transcription.problem(),
            &plan.trajectory,
        );
        let status = if settled && self.task().admits(&self.plan.trajectory) {
            self.state.multipliers.known = false;
            SolverStatus::Solved
        } else {
            self.run_solvers()
        };

        if status == SolverStatus::IterationLimit {
            self.roll_out_fall_back();
        }
        let Plan {
            moves, trajectory, ..
        } = &self.plan;
        if !trajectory.is_finite() || moves.iter().any(|u| !u.is_finite()) {
            return None;
        }
        let over = trajectory.excess > THERMAL_TOLERANCE;
        let problem = self.transcription.problem();
        let (lowest, highest) = (problem.angle_lower, problem.angle_upper);
        let widened = self
            .angle_bounds
            .iter()
            .any(|&[l, u]| l < lowest - ANGLE_TOLERANCE || u > highest + ANGLE_TOLERANCE);
        match status {
            SolverStatus::Solved if over => Some(PlanStatus::ThermalSlack),
            SolverStatus::Solved if widened => Some(PlanStatus::AngleSlack),
            SolverStatus::Solved if self.plan.goal != setpoint => Some(PlanStatus::GoalProjected),
            SolverStatus::Solved => Some(PlanStatus::Solved),
            SolverStatus::IterationLimit if self.task().admits(trajectory) => {
                Some(PlanStatus::IterationLimit)
            }
            // Excess is near its least long before the sequence settles; it is taken unless going on as
            // before, or braking, exceeds the limit by less.
            SolverStatus::IterationLimit
                if self.task().angle_excess(trajectory) <= ANGLE_TOLERANCE
                    && trajectory.total_excess <= NEARLY_LEAST * self.shifted.total_excess =>
            {
                Some(PlanStatus::ThermalSlack)
            }
            SolverStatus::IterationLimit | SolverStatus::Infeasible => None,
        }
    }

    /// Rolls out what there is without a new plan: the previous one, shifted, or braking.
    fn roll_out_fall_back(&mut self) {
        let transcription = &self.transcription;
        if self.state.left > 0 {
            self.guess.copy_from_slice(&self.state.moves);
        } else {
            brake(
                transcription.problem(),
                transcription.initial(),
                &mut self.guess,
            );
        }
        transcription.roll_out(&self.guess, &mut self.shifted);
    }

    /// Improves on the plan without inequalities.
    fn run_solvers(&mut self) -> SolverStatus {
        self.guess_from_shifted();
        let status = self.run_until_solved();
        if status != SolverStatus::Infeasible {
            return status;
        }
        // So short a horizon leaves too little freedom: allow what terminal rest takes.
        let Plan {
            moves, trajectory, ..
        } = &mut self.plan;
        self.unconstrained
            .solve(&self.transcription, moves, trajectory);
        widen(&mut self.angle_bounds, trajectory);
        self.state.multipliers.known = false;
        self.run_until_solved()
    }

    /// Solver after solver until one converges; the last one's status.
    fn run_until_solved(&mut self) -> SolverStatus {
        let mut status = SolverStatus::Solved;
        for index in 0..self.solvers.len() {
            status = self.run_solver(index);
            if status == SolverStatus::Solved {
                break;
            }
        }
        status
    }

    fn run_solver(&mut self, index: usize) -> SolverStatus {
        let plan = &mut self.plan;
        let task = task(&self.transcription, &self.angle_bounds, self.cost_scale);
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

    /// Replaces the plan by the previous one, shifted and led to the goal, if that is better.
    fn guess_from_shifted(&mut self) {
        if self.state.left == 0 {
            self.state.multipliers.known = false;
            return;
        }
        let transcription = &self.transcription;
        self.guess.copy_from_slice(&self.state.moves);
        transcription.end_at_rest(&mut self.guess);
        transcription.roll_out(&self.guess, &mut self.guess_trajectory);
        let task = self.task();
        if task.merit(&self.guess_trajectory) < task.merit(&self.plan.trajectory) {
            self.plan.moves.copy_from_slice(&self.guess);
            std::mem::swap(&mut self.plan.trajectory, &mut self.guess_trajectory);
        } else {
            self.state.multipliers.known = false;
        }
    }

    /// The task at hand.
    fn task(&self) -> Task<'_> {
        task(&self.transcription, &self.angle_bounds, self.cost_scale)
    }

    /// Goes on with the previous moves if they still end at rest, else brakes.
    fn fall_back(&mut self, initial: &Initial, finite: bool) -> PlanStatus {
        let transcription = &self.transcription;
        let Plan {
            moves, trajectory, ..
        } = &mut self.plan;
        moves.copy_from_slice(&self.state.moves);
        let gained = moves.iter().sum::<f64>() * transcription.problem().period;
        let ends_at_rest = if finite {
            let start = initial.reference_velocity;
            (start + gained).abs() <= REST_TOLERANCE * (1.0 + start.abs())
        } else {
            gained.is_finite()
        };
        let mut status = PlanStatus::ShiftedPlan;
        if self.state.left == 0 || !ends_at_rest {
            status = PlanStatus::Rest;
            self.state.left = moves.len();
            brake(transcription.problem(), initial, moves);
        }
        if finite {
            transcription.roll_out(moves, trajectory);
        }
        status
    }
}

/// A task with the planner's price of thermal excess.
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

#[cfg(test)]
mod tests {
    use super::super::examples::{pendulum_feedback, pendulum_settings};
    use super::super::solver::Outcome;
    use super::*;

    /// A solver that finds nothing, or stops too early.
    struct Unable(SolverStatus);

    impl Solver for Unable {
        fn solve(
            &mut self,
            _: &Task<'_>,
            _: &mut [f64],
            _: &mut Rollout,
            _: &mut Multipliers,
        ) -> Outcome {
            Outcome {
                status: self.0,
                iterations: 7,
                convex_problems: 1,
            }
        }
    }

    fn planner() -> Planner {
        let (arm, motor) = (Parameters::pendulum_mismodelled(), Motor::pendulum());
        let (settings, feedback) = (pendulum_settings(), pendulum_feedback());
        Planner::new(&settings, &arm, &motor, &Limits::pendulum(), &feedback).expect("admissible")
    }

    /// Starved, so that a solver is needed.
    fn starved() -> Initial {
        Initial {
            angle: 0.3,
            reference_angle: 0.3,
            thermal_load: 10.9,
            ..Initial::default()
        }
    }

    fn next(plan: &Plan, initial: &Initial) -> Initial {
        Initial {
            angle: plan.trajectory.angle[1],
            velocity: plan.trajectory.reference_velocity[1],
            reference_angle: plan.trajectory.reference_angle[1],
            reference_velocity: plan.trajectory.reference_velocity[1],
            thermal_load: plan.trajectory.thermal_load[1],
            ..*initial
        }
    }

    #[test]
    fn without_a_new_plan_the_previous_one_goes_on_to_its_end() {
        let mut planner = planner();
        let plan = planner.plan(&starved(), 1.2);
        assert_eq!(plan.status, PlanStatus::Solved);
        let (first, mut initial) = (plan.clone(), next(plan, &starved()));
        planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
        for k in 1..40 {
            // Too hot for the plan without inequalities.
            initial.thermal_load = 12.0;
            let plan = planner.plan(&initial, 0.3);
            assert_eq!(plan.status, PlanStatus::ShiftedPlan, "{k}");
            assert_eq!(plan.moves[..40 - k], first.moves[k..]);
            initial = next(plan, &initial);
        }
        assert!((initial.angle - 1.2).abs() < 1e-9);
        assert!(initial.reference_velocity.abs() < 1e-9);
    }

    #[test]
    fn an_unfinished_plan_that_exceeds_the_limit_gives_way_to_one_that_does_not() {
        let mut planner = planner();
        let plan = planner.plan(&starved(), 1.2);
        let initial = next(plan, &starved());
        planner.solvers = vec![Box::new(Unable(SolverStatus::IterationLimit))];
        let plan = planner.plan(&initial, 1.4);
        assert_eq!(plan.status, PlanStatus::ShiftedPlan);
        assert!(plan.trajectory.excess <= THERMAL_TOLERANCE);
    }

    #[test]
    fn without_any_plan_the_reference_is_braked_within_the_bounds() {
        let mut planner = planner();
        planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
        let initial = Initial {
            reference_velocity: 2.0,
            velocity: 2.0,
            ..starved()
        };
        let plan = planner.plan(&initial, 1.2);
        assert_eq!(plan.status, PlanStatus::Rest);
        let (angles, velocities) = (
            &plan.trajectory.reference_angle,
            &plan.trajectory.reference_velocity,
        );
        assert!(velocities[40].abs() < 1e-12);
        let upper = Limits::pendulum().angle_upper - 0.02;
        assert!(angles.iter().all(|&angle| angle <= upper + 1e-12));
        // The braking is a plan like others: it goes on.
        let second = next(plan, &initial);
        assert_eq!(planner.plan(&second, 1.2).status, PlanStatus::ShiftedPlan);
    }

    #[test]
    fn a_shifted_plan_from_another_reference_is_not_followed() {
        let mut planner = planner();
        planner.plan(&starved(), 1.2);
        planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
        let elsewhere = Initial {
            reference_velocity: -1.0,
            ..starved()
        };
        assert_eq!(planner.plan(&elsewhere, 1.2).status, PlanStatus::Rest);
    }

    #[test]
    fn a_state_that_is_not_made_of_numbers_does_no_harm() {
        let mut planner = planner();
        let state = PlannerState {
            moves: vec![f64::NAN; 40],
            left: 40,
            multipliers: Multipliers::new(40),
        };
        planner.set_state(&state);
        assert_eq!(planner.plan(&starved(), 1.2).status, PlanStatus::Solved);
        planner.set_state(&state);
        planner.solvers = vec![Box::new(Unable(SolverStatus::Infeasible))];
        let plan = planner.plan(&starved(), 1.2);
        assert_eq!(plan.status, PlanStatus::Rest);
        assert!(plan.moves.iter().all(|u| u.is_finite()));
    }

    #[test]
    fn the_solvers_work_is_reported() {
        let mut planner = planner();
        planner.solvers = vec![Box::new(Unable(SolverStatus::Solved))];
        let plan = planner.plan(&starved(), 1.2);
        assert_eq!((plan.iterations, plan.convex_problems), (7, 1));
    }
}
