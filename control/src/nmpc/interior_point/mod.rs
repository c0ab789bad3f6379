//! The plan by one primal-dual interior point method on the nonlinear problem, its Newton steps solved by
//! a Riccati recursion. O(N) an iteration, a bounded number of iterations, no allocation after set-up.
//!
//! # Method
//! The moves are the only variables: every iterate is rolled out in the true model, so that θr, ωr and T
//! are exact and the last two moves lead to rest (eq 27). What remains are the inequalities of eqs 25 and
//! 26 ([`inequality`]), the thermal ones with an excess at the price of [`Task::merit`]. An iteration
//!
//! 1. linearises around the rollout and factorises once ([`newton`]), with the exact curvature of heat if
//!    that has a minimum, with its convex part otherwise;
//! 2. solves for complementarity products of zero, then again for μ·(the ratio of products left)², with
//!    Mehrotra's correction;
//! 3. shortens the step until the merit
//!    `cost/cost_scale + Σ ρ·t − μ·Σ(ln s + ln t) + η·Σ|r|` falls, η above all multipliers;
//! 4. lets the slacks take in what the true T is below its linearisation.
//!
//! It ends when products, residuals and the decrease that the step promised are within tolerance.
//!
//! # Start
//! A plan that goes on from the previous one brings its multipliers along and starts with small products;
//! any other starts from the guess with large ones.

pub mod inequality;
pub mod newton;

use arm::{Arithmetic, Kernel};

use self::inequality::Inequalities;
use self::newton::Newton;
use super::rollout::Rollout;
use super::solver::{ANGLE_TOLERANCE, Multipliers, Outcome, Solver, SolverStatus, Task};
use super::transcription::Transcription;

/// Iterations at most.
const MAX_ITERATIONS: u32 = 60;
/// Step lengths tried in an iteration at most.
const MAX_TRIALS: u32 = 8;
/// Length of a step in units of the one that was too long.
const SHORTER: f64 = 0.7;
/// Part of the products that is aimed at, at least, for each part of the predictor that cannot be taken.
const UNFINISHED: f64 = 0.3;
/// Sum of the products at the end, in units of the larger of cost and its scale.
const GAP: f64 = 2e-7;
/// Decrease that the last step promised, in the same units.
const DECREASE: f64 = 1e-6;
/// Largest residual at the end \[A², rad\].
const RESIDUAL: f64 = 1e-8;
/// Product of a start from scratch.
const COLD: f64 = 1e-2;
/// Product of a start from the previous plan.
const WARM: f64 = 1e-6;

/// The interior point solver for `S` states.
pub struct InteriorPoint<const S: usize> {
    newton: Newton<S>,
    thermal: Inequalities,
    lower: Inequalities,
    upper: Inequalities,
    trial: Vec<f64>,
    trial_rollout: Rollout,
}

impl<const S: usize> InteriorPoint<S> {
    fn new(transcription: &Transcription) -> Self {
        let problem = transcription.problem();
        let horizon = problem.horizon;
        let loads = problem.thermal_limit.map_or(0, |_| horizon);
        Self {
            newton: Newton::new(transcription),
            thermal: Inequalities::new(loads, 1.0),
            lower: Inequalities::new(horizon - 1, f64::INFINITY),
            upper: Inequalities::new(horizon - 1, f64::INFINITY),
            trial: vec![0.0; horizon],
            trial_rollout: Rollout::new(horizon),
        }
    }

    /// c of all inequalities along the trial.
    #[inline(always)]
    fn evaluate_trial(&mut self, task: &Task<'_>) {
        let rollout = &self.trial_rollout;
        let limit = task.transcription.problem().thermal_limit.unwrap_or(0.0);
        for (c, load) in self
            .thermal
            .value
            .iter_mut()
            .zip(&rollout.thermal_load[1..])
        {
            *c = load - limit;
        }
        let angles = &rollout.reference_angle[1..];
        for (k, [lowest, highest]) in task.angle_bounds.iter().enumerate() {
            self.lower.value[k] = lowest - angles[k];
            self.upper.value[k] = angles[k] - highest;
        }
    }

    /// Number of nodes after the first where T exceeds its limit even without any heat.
    fn lost(&self, transcription: &Transcription) -> usize {
        let limit = transcription.problem().thermal_limit.unwrap_or(0.0);
        let mut load = transcription.initial().thermal_load;
        let cooled = (0..self.thermal.value.len()).take_while(|&k| {
            load *= transcription.interval(k).thermal.decay();
            load > limit
        });
        cooled.count()
    }

    #[inline(always)]
    fn gap(&self) -> f64 {
        self.thermal.gap() + self.lower.gap() + self.upper.gap()
    }

    #[inline(always)]
    fn families(&mut self) -> [&mut Inequalities; 3] {
        [&mut self.thermal, &mut self.lower, &mut self.upper]
    }

    #[inline(always)]
    fn merit(&self, cost: f64, mu: f64, weights: [f64; 3]) -> f64 {
        cost + self.thermal.merit(mu, weights[0])
            + self.lower.merit(mu, weights[1])
            + self.upper.merit(mu, weights[2])
    }

    /// Steps of the inequalities that go with the Newton step; the largest primal and dual step lengths.
    #[inline(always)]
    fn steps<A: Arithmetic>(&mut self, mu: f64, corrected: bool) -> [f64; 2] {
        let thermal = self
            .thermal
            .step::<A>(mu, corrected, 1.0, &self.newton.load);
        let lower = self
            .lower
            .step::<A>(mu, corrected, -1.0, &self.newton.angle);
        let upper = self.upper.step::<A>(mu, corrected, 1.0, &self.newton.angle);
        std::array::from_fn(|i| thermal[i].min(lower[i]).min(upper[i]))
    }

    #[inline(always)]
    fn solve_with<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &mut Multipliers,
    ) -> Outcome {
        let transcription = task.transcription;
        transcription.end_at_rest(moves);
        transcription.roll_out_with::<A>(moves, &mut self.trial_rollout);
        self.evaluate_trial(task);
        std::mem::swap(rollout, &mut self.trial_rollout);
        self.thermal.price = task.excess_weight;
        self.thermal.lost = self.lost(transcription);
        let warm = multipliers.known;
        let range = {
            let problem = transcription.problem();
            problem.angle_upper - problem.angle_lower
        };
        let leasts = [
            1e-2 * transcription.problem().thermal_limit.unwrap_or(0.0),
            1e-2 * range,
            1e-2 * range,
        ];
        let scale = 1.0 / task.cost_scale;
        let guesses = [&multipliers.thermal, &multipliers.lower, &multipliers.upper];
        for ((family, least), guess) in self.families().into_iter().zip(leasts).zip(guesses) {
            for (multiplier, guess) in family.multiplier.iter_mut().zip(guess) {
                *multiplier = if warm { guess * scale } else { 0.0 };
            }
            family.start(if warm { WARM } else { COLD }, least);
        }
        let products = self.thermal.products() + self.lower.products() + self.upper.products();
        let mut iterations = 0;
        let mut status = SolverStatus::IterationLimit;
        while iterations < MAX_ITERATIONS {
            iterations += 1;
            let gap = self.gap();
            for family in self.families() {
                family.predict();
            }
            let Self {
                newton,
                thermal,
                lower,
                upper,
                ..
            } = self;
            let families = [&*thermal, &*lower, &*upper];
            let exact = newton.factorise::<A>(task, moves, rollout, families, true);
            if !exact && !newton.factorise::<A>(task, moves, rollout, families, false) {
                break;
            }
            newton.solve::<A>(families);
            let [primal, dual] = self.steps::<A>(0.0, false);
            let after = self.thermal.gap_after(primal, dual)
                + self.lower.gap_after(primal, dual)
                + self.upper.gap_after(primal, dual);
            let ratio = (after / gap).clamp(0.0, 1.0);
            let share = f64::max(ratio * ratio, UNFINISHED * (1.0 - primal.min(dual)));
            let mu = f64::max(share * gap, 0.1 * GAP) / products;
            for family in self.families() {
                family.correct(mu);
            }
            let Self {
                newton,
                thermal,
                lower,
                upper,
                ..
            } = self;
            newton.solve::<A>([&*thermal, &*lower, &*upper]);
            let [mut primal, dual] = self.steps::<A>(mu, true);
            let decrease = self.newton.decrease;

            // Shorten until the merit falls.
            let weights = [
                self.thermal.steepest(),
                self.lower.steepest(),
                self.upper.steepest(),
            ]
            .map(|steepest| 1.1 * steepest);
            let before = self.merit(rollout.cost * scale, mu, weights);
            let tolerance = 1e-12 * before.abs();
            let mut trials = 0;
            let mut taken = 0.0;
            loop {
                trials += 1;
                for ((trial, u), step) in self.trial.iter_mut().zip(&*moves).zip(&self.newton.moves)
                {
                    *trial = A::mul_add(primal, *step, *u);
                }
                transcription.roll_out_with::<A>(&self.trial, &mut self.trial_rollout);
                self.evaluate_trial(task);
                for family in self.families() {
                    family.advance(primal - taken);
                }
                taken = primal;
                let after = self.merit(self.trial_rollout.cost * scale, mu, weights);
                if after <= before + tolerance || trials >= MAX_TRIALS {
                    break;
                }
                primal *= SHORTER;
            }
            self.thermal.reset_slack();
            self.lower.reset_slack();
            self.upper.reset_slack();
            for family in self.families() {
                family.advance_multipliers(dual);
            }
            moves.copy_from_slice(&self.trial);
            std::mem::swap(rollout, &mut self.trial_rollout);

            if std::env::var_os("TRACE").is_some() { #[allow(clippy::print_stdout)] { println!("{iterations:3} gap {gap:.2e} mu {mu:.2e} ratio {ratio:.2e} primal {primal:.3} dual {dual:.3} trials {trials} exact {exact} decrease {decrease:.2e} res {:.2e} {:.2e} cost {:.6} excess {:.3e} steep {:?}", self.thermal.residuals()[1], self.lower.residuals()[1].max(self.upper.residuals()[1]), rollout.cost*scale, rollout.excess, weights); } }
            let unit = f64::max(1.0, rollout.cost * scale);
            let residual = self.thermal.residuals()[1]
                .max(self.lower.residuals()[1])
                .max(self.upper.residuals()[1]);
            if self.gap() <= GAP * unit && residual <= RESIDUAL && decrease <= DECREASE * unit {
                status = SolverStatus::Solved;
                break;
            }
        }
        if task.angle_excess(rollout) > ANGLE_TOLERANCE {
            status = SolverStatus::Infeasible;
        }
        multipliers.known = true;
        let known = [
            &mut multipliers.thermal,
            &mut multipliers.lower,
            &mut multipliers.upper,
        ];
        for (family, known) in self.families().into_iter().zip(known) {
            for (known, multiplier) in known.iter_mut().zip(&family.multiplier) {
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
