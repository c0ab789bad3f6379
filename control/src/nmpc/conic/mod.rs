//! The plan as a sequence of convex problems, each solved by Clarabel.
//!
//! # The convex problem
//! Around the last trajectory (marked ¯) g_φ is linearised, which makes τ_j affine in the spline's free
//! coefficients c. The thermal step T⁺ = a·T + Σ_j w_j·(τ_j/Ki)² is relaxed to
//!
//! ```text
//! T_{k+1} − a·T_k ≥ Σ_j w_j·(τ_kj/Ki)²        w_j > 0
//! ```
//!
//! a second-order cone that holds all four RK4 stages. Where the limit does not bind, T may float above
//! the true load at no cost, so it is never reported; where it binds, the relaxation is tight. The cost
//! of heat does not use the relaxed T: its gradient and the curvature Σ_j λ_j·∇τ_j·∇τ_jᵀ·2/Ki² come from
//! the true rollout ([`super::transcription`]), so a trajectory that no longer moves is a stationary
//! point of the true problem. Each node has its slack s_k ≥ 0 on the thermal limit.
//!
//! # Scaling
//! Done here instead of by Clarabel's equilibration, so that it follows from task and parameters:
//!
//! ```text
//! ∇²J = H + heat: the Hessian of the cost without heat, and the curvature above
//! c = c̄ + σ·x,  σ² = cost_scale/max(∇²J_ii)  ζ_k = (T_k − T̄_k)/(W·L)    W = Σ_j w_j,  L = T_limit
//! minimise   ½·xᵀPx + qᵀx + ρ·Σ s_k          P = ∇²J·σ²/cost_scale ,  ρ = excess_weight·W·L
//! subject to (x_{k−1} + x_k)/2 within (bounds − θ̄r_k)/σ                                  k = 1..N−1
//!            ζ_k − s_k ≤ (L − T̄_k)/(W·L),   s_k ≥ 0                                      k = 1..N
//!            ‖(y − 1, 2·√(w_j/W)·i_j)‖ ≤ y + 1                                           k = 0..N−1
//!            y   = ȳ + ζ_{k+1} − a·ζ_k ,     i_j = (τ̄_j + σ·∇τ_j·x)/(Ki·√L)
//! ```
//!
//! Where the problem has them there are also rows of the torque limit (appendix C.3) and variables, rows and
//! cones of the safe sets at the last node (appendix B); neither needs a linearisation. The linear model,
//! without loads, is one quadratic programme, exact as posed, and the sequence ends with its first member.
//!
//! # The sequence
//! The next problem is posed around the last answer until true cost and true thermal load agree with what
//! the convex problem promised (its prices weigh the loads), or until there is nothing left to gain. An
//! answer whose true merit is worse than that of the trajectory it started from is dropped, and the step
//! shortened by P·(1 + damping), a trust region in the metric of the cost; this is needed where the thermal
//! budget is starved.

mod convex;
mod pattern;
mod safe_rows;
mod torque_rows;

use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus as Ended};
use nalgebra::DMatrix;

use self::convex::{Convex, Promise};
use super::rollout::Rollout;
use super::solver::{Multipliers, Outcome, Pace, Solver, SolverStatus, Task, TimeLimit};
use super::spline::Spline;
use super::transcription::Transcription;

/// Convex problems per plan at most.
const MAX_CONVEX_PROBLEMS: u32 = 8;
/// What the true cost may miss the promised one by at the end of the sequence, in units of the larger of
/// the cost and its scale.
const COST_TOLERANCE: f64 = 1e-7;
/// The same for the penalty on thermal excess, relative to it.
const PENALTY_TOLERANCE: f64 = 1e-5;
/// Thermal excess beyond the promised one that ends the sequence \[A²\].
const EXCESS_TOLERANCE: f64 = 1e-8;

/// Solver of plans on Clarabel.
pub struct Conic {
    clarabel: DefaultSolver<f64>,
    convex: Convex,
    spline: Spline,
    trial: Spline,
    trial_moves: Vec<f64>,
    trial_rollout: Rollout,
    pace: Pace,
}

impl Conic {
    /// Sets Clarabel up for the problem of `transcription`, whose cost without heat has the Hessian
    /// `hessian` \[free × free\], with at least one free coefficient.
    pub fn new(transcription: &Transcription, hessian: DMatrix<f64>) -> Self {
        let horizon = transcription.problem().horizon;
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 60,
            max_threads: 1,
            direct_solve_method: "qdldl".to_owned(),
            // The data are scaled by us and updated in place.
            presolve_enable: false,
            equilibrate_enable: false,
            ..DefaultSettings::default()
        };
        let convex = Convex::new(transcription, hessian);
        let ((p, a), (q, b)) = (convex.matrices(), convex.vectors());
        // Set-up, not a sample; Clarabel refuses only dimensions and settings that contradict each other.
        let clarabel = DefaultSolver::new(p, q, a, b, &convex.cones(), settings)
            .expect("dimensions and settings agree by construction");
        Self {
            clarabel,
            convex,
            spline: Spline::new(transcription.problem()),
            trial: Spline::new(transcription.problem()),
            trial_moves: vec![0.0; horizon],
            trial_rollout: Rollout::new(horizon),
            pace: Pace::default(),
        }
    }

    /// Leaves Clarabel the time until the limit.
    fn limit_time(&mut self, limit: Option<TimeLimit<'_>>) {
        let time_limit = limit.map_or(f64::INFINITY, |limit| limit.end - limit.clock.now());
        if self.clarabel.settings().time_limit != time_limit {
            let settings = DefaultSettings {
                time_limit,
                ..self.clarabel.settings().clone()
            };
            // Refused only where it touches what was fixed at set-up, which time is not.
            let _ = self.clarabel.update_settings(settings);
        }
    }

    /// Solves the convex problem around `rollout` of `moves`; its answer, in the true model, is the trial.
    /// None if Clarabel refuses the data.
    fn try_step(
        &mut self,
        task: &Task<'_>,
        moves: &[f64],
        rollout: &Rollout,
        damping: f64,
    ) -> Option<(Ended, Promise)> {
        self.convex.pose(task, moves, rollout, damping);
        self.convex.update(&mut self.clarabel).ok()?;
        self.clarabel.solve();
        let solution = &self.clarabel.solution;
        let sigma = self.convex.sigma();
        self.trial.copy_from(&self.spline);
        for (c, x) in self.trial.free().iter_mut().zip(&solution.x) {
            *c += sigma * x;
        }
        self.trial.moves(task.transcription, &mut self.trial_moves);
        task.transcription
            .roll_out(&self.trial_moves, &mut self.trial_rollout);
        let promise = self
            .convex
            .promise(task, solution, rollout, &self.trial_rollout);
        Some((solution.status, promise))
    }
}

impl Solver for Conic {
    fn solve(
        &mut self,
        task: &Task<'_>,
        moves: &mut [f64],
        rollout: &mut Rollout,
        multipliers: &mut Multipliers,
    ) -> Outcome {
        multipliers.known = false;
        self.spline.fit(task.transcription, rollout);
        self.spline.fix_ends(task.transcription);
        self.spline.moves(task.transcription, moves);
        task.transcription.roll_out(moves, rollout);

        let mut outcome = Outcome {
            status: SolverStatus::IterationLimit,
            iterations: 0,
            convex_problems: 0,
        };
        let mut merit = task.merit(rollout);
        let mut bounded = task.keeps_bounds(rollout);
        let mut damping = 0.0;
        self.pace.restart();
        while outcome.convex_problems < MAX_CONVEX_PROBLEMS {
            if !self.pace.allows(task.time_limit) {
                outcome.status = SolverStatus::OutOfTime;
                break;
            }
            self.limit_time(task.time_limit);
            let Some((ended, promise)) = self.try_step(task, moves, rollout, damping) else {
                break;
            };
            outcome.iterations += self.clarabel.solution.iterations;
            outcome.convex_problems += 1;
            if matches!(
                ended,
                Ended::PrimalInfeasible | Ended::AlmostPrimalInfeasible
            ) {
                outcome.status = SolverStatus::Infeasible;
                break;
            }
            let trial = &mut self.trial_rollout;
            let trial_merit = task.merit(trial);
            let trial_bounded = task.keeps_bounds(trial);
            let penalty = task.penalty(trial);
            let tolerance =
                COST_TOLERANCE * f64::max(1.0, trial_merit - penalty) + PENALTY_TOLERANCE * penalty;

            let kept = damping == 0.0
                && promise.misjudged <= tolerance
                && task.excess(trial) <= promise.excess + EXCESS_TOLERANCE;
            let idle = damping == 0.0 && (merit - trial_merit).abs() <= tolerance;
            let nothing_left = bounded && (idle || promise.decrease * (1.0 + damping) <= tolerance);
            // An almost solved problem misses its rows a little; the true model judges that.
            let answered = matches!(ended, Ended::Solved | Ended::AlmostSolved);
            let optimal = answered && self.clarabel.info.gap_abs <= tolerance;
            let settled = optimal && trial_bounded && (kept || nothing_left);

            let gain = (merit - trial_merit) / promise.decrease.max(tolerance);
            let better = trial_merit < merit + tolerance;
            if (answered && !bounded && trial_bounded) || (bounded == trial_bounded && better) {
                self.spline.copy_from(&self.trial);
                moves.copy_from_slice(&self.trial_moves);
                std::mem::swap(rollout, trial);
                merit = trial_merit;
                if bounded && gain > 0.75 {
                    damping = if damping > 1.0 { 0.1 * damping } else { 0.0 };
                } else if bounded && gain < 0.25 {
                    damping = f64::max(10.0 * damping, 1.0);
                }
                bounded = trial_bounded;
            } else {
                damping = f64::max(10.0 * damping, 1.0);
            }
            if settled {
                outcome.status = SolverStatus::Solved;
                break;
            }
        }
        outcome
    }
}
