//! The plan by one primal-dual interior point method on the nonlinear problem, its Newton steps solved by
//! a Riccati recursion. O(N) an iteration, a bounded number of iterations, no allocation after set-up.
//!
//! # Method
//! The moves are the only variables: every iterate is rolled out in the true model, so that θr, ωr and T
//! are exact and the last two moves lead to rest (eq 27). What remains are the inequalities of eqs 25 and
//! 26 (`inequality`), the thermal ones with an excess at the price of [`Task::merit`]. An iteration
//!
//! 1. linearises around the rollout and factorises once (`newton`), with the exact curvature of heat if
//!    that has a minimum, with the convex parts of it otherwise;
//! 2. solves for complementarity products of zero, then again for μ·(the ratio of products left)², with
//!    Mehrotra's correction; a plan that goes on from the previous one and is nearly there only once, for
//!    the last products;
//! 3. shortens the step until the merit
//!    `cost/cost_scale + Σ ρ·t − μ·Σ(ln s + ln t) + Σ η·|r|` falls, η of each row above its multiplier;
//! 4. lets the slacks take in what the true T is below its linearisation.
//!
//! It ends when products, residuals and the decrease that the step promised are within tolerance; where there is
//! excess, with the products that belong to the true c instead of the first two.
//!
//! Small products reach an optimum with excess, where multipliers climb to the price, only slowly or not at
//! all. What a plan with excess makes of a step that is `STALLED` is worse than the step before: it goes on with
//! large products instead. So does, as from scratch, a plan that goes on from the previous one and stalls without excess.
//!
//! # Excess that cannot be avoided
//! Where T exceeds its limit even without any heat, T₀·Π a_k > T_limit, the excess is T_k − T_limit for
//! every plan: its price is linear in T, λ_k = ρ, and nothing is left for an inequality to decide. A start
//! far above the limit so becomes a smooth problem, that of the least heat.
//!
//! # Start
//! A plan that goes on from the previous one brings its multipliers along and starts with small products;
//! any other starts from the guess with large ones.

mod inequality;
mod newton;
mod start;
mod step;

use arm::{Arithmetic, Kernel};

use self::inequality::{Inequalities, Measure};
use self::newton::Newton;
use self::start::COLD;
use self::step::Step;
use super::rollout::Rollout;
use super::solver::{Multipliers, Outcome, Pace, Solver, SolverStatus, Task};
use super::transcription::Transcription;

/// Iterations at most.
const MAX_ITERATIONS: u32 = 60;
/// Step lengths tried in an iteration at most.
const MAX_TRIALS: u32 = 4;
/// Length of a step in units of the one that was too long.
const SHORTER: f64 = 0.5;
/// Sum of the products at the end, in units of the larger of cost and its scale.
const GAP: f64 = 2e-7;
/// Decrease that the last step promised, in the same units.
const DECREASE: f64 = 1e-6;
/// What more steps gain beyond what the last one promised, where it had only the convex parts of the curvature.
const SADDLE: f64 = 10.0;
/// Largest residual at the end \[A², rad\].
const RESIDUAL: f64 = 1e-8;
/// Part of the penalty on excess that a plan may miss; its price exceeds all costs by so much.
const PENALTY: f64 = 3e-5;
/// Length of a step that is not taken: a plan with excess goes on with products of [`CENTRAL`], one that the previous
/// plan led astray with those of a first plan.
const STALLED: f64 = 0.02;
/// The same in a plan that has taken [`MANY`] iterations: it may go round in circles.
const STALLED_LATE: f64 = 0.3;
/// Iterations that most plans do without.
const MANY: u32 = 22;
/// Iterations at least between two such restarts.
const AGAIN: u32 = 10;
/// Products that reach any optimum with excess, if slowly.
const CENTRAL: f64 = 300.0;
/// Products of a restart in units of those of the one before: equal ones may lead to where they led before.
const FADING: f64 = 0.1;

/// The interior point solver for `S` states.
struct InteriorPoint<const S: usize> {
    newton: Newton<S>,
    thermal: Inequalities,
    lower: Inequalities,
    upper: Inequalities,
    /// Of all inequalities at the latest iterate.
    measured: Measure,
    trial: Vec<f64>,
    trial_rollout: Rollout,
    /// Moves of the best plan among the iterates [N].
    best: Vec<f64>,
    pace: Pace,
    /// Whether the latest step is that of the convex parts of the curvature.
    convex: bool,
    /// Whether the plan goes on from the previous one.
    warm: bool,
}

impl<const S: usize> InteriorPoint<S> {
    fn new(transcription: &Transcription) -> Self {
        let problem = transcription.problem();
        let horizon = problem.horizon;
        let loads = problem.thermal_limit.map_or(0, |_| horizon);
        let mut thermal = Inequalities::new(loads, 1.0, 1.0);
        thermal.set_bounds((0..horizon).map(|k| transcription.interval(k).thermal_limit));
        Self {
            newton: Newton::new(transcription),
            thermal,
            lower: Inequalities::new(horizon - 1, f64::INFINITY, -1.0),
            upper: Inequalities::new(horizon - 1, f64::INFINITY, 1.0),
            measured: Measure::default(),
            trial: vec![0.0; horizon],
            trial_rollout: Rollout::new(horizon),
            best: vec![0.0; horizon],
            pace: Pace::default(),
            convex: false,
            warm: false,
        }
    }

    #[inline(always)]
    fn families(&mut self) -> [&mut Inequalities; 3] {
        [&mut self.thermal, &mut self.lower, &mut self.upper]
    }

    #[inline(always)]
    fn measure<A: Arithmetic>(&self) -> Measure {
        let angle = self.lower.measure::<A>().and(self.upper.measure::<A>());
        self.thermal.measure::<A>().and(angle)
    }

    /// Σ η·|r| over all inequalities.
    #[inline(always)]
    fn residual_penalty<A: Arithmetic>(&self) -> f64 {
        self.thermal.residual_penalty::<A>()
            + self.lower.residual_penalty::<A>()
            + self.upper.residual_penalty::<A>()
    }

    /// Shortens the step until the merit falls, or [`MAX_TRIALS`] times, and takes it; false if it leads
    /// nowhere finite.
    #[inline(always)]
    fn search<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        step: Step,
        moves: &mut [f64],
        rollout: &mut Rollout,
    ) -> bool {
        let scale = 1.0 / task.cost_scale;
        let merit = |cost: f64, measured: &Measure, penalty: f64| {
            cost * scale + measured.price_and_barrier(step.mu) + penalty
        };
        // η follows from the step.
        let before = merit(rollout.cost, &self.measured, self.residual_penalty::<A>());
        let tolerance = 1e-12 * before.abs();
        let (mut primal, mut taken) = (step.primal, 0.0);
        let mut after = f64::NAN;
        for _ in 0..MAX_TRIALS {
            let steps = moves.iter().zip(&self.newton.moves);
            for (trial, (u, step)) in self.trial.iter_mut().zip(steps) {
                *trial = A::mul_add(primal, *step, *u);
            }
            task.transcription
                .roll_out_with::<A, 3>(&self.trial, &mut self.trial_rollout);
            let families = [&mut self.thermal, &mut self.lower, &mut self.upper];
            evaluate::<A>(families, &self.trial_rollout);
            self.thermal.advance::<A>(primal - taken);
            self.lower.advance::<A>(primal - taken);
            self.upper.advance::<A>(primal - taken);
            taken = primal;
            let (cost, penalty) = (self.trial_rollout.cost, self.residual_penalty::<A>());
            after = merit(cost, &self.measure::<A>(), penalty);
            if after <= before + tolerance {
                break;
            }
            primal *= SHORTER;
        }
        if !after.is_finite() {
            return false;
        }
        self.thermal.settle::<A>(step.dual);
        self.lower.settle::<A>(step.dual);
        self.upper.settle::<A>(step.dual);
        self.measured = self.measure::<A>();
        moves.copy_from_slice(&self.trial);
        std::mem::swap(rollout, &mut self.trial_rollout);
        true
    }

    #[inline(always)]
    fn converged<A: Arithmetic>(&self, task: &Task<'_>, rollout: &Rollout) -> bool {
        let unit = f64::max(1.0, rollout.cost / task.cost_scale);
        let penalty = PENALTY * task.excess_weight * rollout.total_excess;
        let promised = if self.convex {
            SADDLE * self.newton.decrease
        } else {
            self.newton.decrease
        };
        if promised > DECREASE * unit + penalty {
            return false;
        }
        let most = GAP * unit + penalty;
        if self.measured.gap <= most && self.measured.residual <= RESIDUAL {
            return true;
        }
        // What the excess leaves to gain is known without s and t.
        let angle = self.lower.measure::<A>().and(self.upper.measure::<A>());
        penalty > 0.0
            && angle.residual <= RESIDUAL
            && angle.gap + self.thermal.true_gap::<A>() <= most
    }

    #[inline(always)]
    fn solve_with<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &mut Multipliers,
    ) -> Outcome {
        self.start::<A>(task, rollout, multipliers);
        self.warm = multipliers.known;
        self.pace.restart();
        self.best.copy_from_slice(moves);
        let mut best = task.rank(rollout);
        let mut iterations = 0;
        // When a restart may be at the earliest, and its products.
        let (mut earliest, mut central) = (0, CENTRAL);
        let mut status = SolverStatus::IterationLimit;
        while iterations < MAX_ITERATIONS {
            if !self.pace.allows(task.time_limit) {
                status = SolverStatus::OutOfTime;
                break;
            }
            let Some(step) = self.step::<A>(task, moves, rollout) else {
                break;
            };
            iterations += 1;
            let least = if iterations < MANY {
                STALLED
            } else {
                STALLED_LATE
            };
            let stalled = step.primal.min(step.dual) < least && iterations >= earliest;
            let exceeded = self.thermal.exceeded(RESIDUAL);
            if stalled && (exceeded || self.warm) {
                // Without excess it was the previous plan that led astray: on as from scratch.
                let products = if exceeded { central } else { COLD };
                self.restart::<A>(task.transcription.problem(), products);
                earliest = iterations + AGAIN;
                if exceeded {
                    central *= FADING;
                }
                continue;
            }
            if !self.search::<A>(task, step, moves, rollout) {
                break;
            }
            if self.converged::<A>(task, rollout) {
                status = SolverStatus::Solved;
                break;
            }
            let rank = task.rank(rollout);
            if rank < best {
                best = rank;
                self.best.copy_from_slice(moves);
            }
        }
        if status != SolverStatus::Solved && best < task.rank(rollout) {
            moves.copy_from_slice(&self.best);
            task.transcription.roll_out_with::<A, 3>(moves, rollout);
        }
        if status != SolverStatus::OutOfTime && !task.keeps_angle_bounds(rollout) {
            status = SolverStatus::Infeasible;
        }
        // Multipliers of an unfinished plan would lead the next one astray.
        multipliers.known = status == SolverStatus::Solved;
        let known = [
            &mut multipliers.thermal,
            &mut multipliers.lower,
            &mut multipliers.upper,
        ];
        for (family, known) in self.families().into_iter().zip(known) {
            for (known, multiplier) in known.iter_mut().zip(family.multipliers()) {
                *known = multiplier * task.cost_scale;
            }
        }
        Outcome {
            status,
            iterations,
            convex_problems: 0,
        }
    }
}

/// Sets c of all inequalities along `rollout`.
#[inline(always)]
fn evaluate<A: Arithmetic>([thermal, lower, upper]: [&mut Inequalities; 3], rollout: &Rollout) {
    let [_, angles @ .., _] = &rollout.reference_angle[..] else {
        return;
    };
    thermal.evaluate::<A>(&rollout.thermal_load[1..]);
    lower.evaluate::<A>(angles);
    upper.evaluate::<A>(angles);
}

/// The solver for the problem of `transcription`.
pub fn new(transcription: &Transcription) -> Box<dyn Solver + Send> {
    if transcription.problem().weights.integral > 0.0 {
        Box::new(InteriorPoint::<4>::new(transcription))
    } else {
        Box::new(InteriorPoint::<3>::new(transcription))
    }
}

struct Solve<'a, const S: usize> {
    solver: &'a mut InteriorPoint<S>,
    task: &'a Task<'a>,
    moves: &'a mut [f64],
    rollout: &'a mut Rollout,
    multipliers: &'a mut Multipliers,
}

impl<const S: usize> Kernel for Solve<'_, S> {
    type Output = Outcome;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> Outcome {
        let Self {
            solver,
            task,
            moves,
            rollout,
            multipliers,
        } = self;
        solver.solve_with::<A>(task, moves, rollout, multipliers)
    }
}

impl<const S: usize> Solver for InteriorPoint<S> {
    fn solve(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &mut Multipliers,
    ) -> Outcome {
        task.transcription.instructions().run(Solve {
            solver: self,
            task,
            moves,
            rollout,
            multipliers,
        })
    }
}
