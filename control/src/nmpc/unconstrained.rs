//! The plan without inequalities: the optimum in closed form, the yardstick and first guess of every
//! solver, and the final answer wherever it keeps the limits.
//!
//! Without q_T the cost is a quadratic form ½·cᵀHc + … of the free coefficients with a constant H, so
//! one Newton step is exact. With q_T more steps follow, with the true gradient and the same H, which
//! q_T·T² hardly bends, until the cost settles.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::rollout::{Rollout, Sensitivity};
use super::spline::{Spline, gather};
use super::transcription::Transcription;

/// Steps after which a cost that does not settle is left to the solver.
const MAX_STEPS: usize = 12;
/// Decrease expected of a step, relative to the cost, after which the cost has settled.
const SETTLED: f64 = 1e-9;

/// Minimiser of the cost subject to dynamics and terminal rest alone.
#[derive(Clone, Debug)]
pub struct Unconstrained {
    factor: Cholesky<f64, Dyn>,
    spline: Spline,
    step: DVector<f64>,
    sensitivity: Sensitivity,
}

impl Unconstrained {
    /// Factorises the Hessian `hessian` of the free coefficients; none if it is not positive definite.
    pub fn new(transcription: &Transcription, hessian: &DMatrix<f64>) -> Option<Self> {
        let problem = transcription.problem();
        Some(Self {
            factor: Cholesky::new(hessian.clone())?,
            spline: Spline::new(problem.horizon, problem.period),
            step: DVector::zeros(problem.horizon - 2),
            sensitivity: Sensitivity::new(problem.horizon),
        })
    }

    /// Writes the optimum's `moves` \[N\] and their `rollout`; whether the cost settled.
    pub fn solve(
        &mut self,
        transcription: &Transcription,
        moves: &mut [f64],
        rollout: &mut Rollout,
    ) -> bool {
        let weight_thermal = transcription.problem().weights.thermal;
        self.spline.free().fill(transcription.goal());
        self.spline.fix_ends(transcription);
        self.spline.moves(moves);
        transcription.roll_out(moves, rollout);
        self.find_step(0.0, transcription, moves, rollout);
        self.take_step(-1.0, transcription, moves, rollout);
        if weight_thermal == 0.0 {
            return true;
        }
        for _ in 0..MAX_STEPS {
            let decrease = self.find_step(weight_thermal, transcription, moves, rollout);
            let before = rollout.cost;
            self.take_step(-1.0, transcription, moves, rollout);
            if decrease <= SETTLED * rollout.cost {
                return true;
            }
            if rollout.cost.is_nan() || rollout.cost > before {
                // q_T bends the cost too much for this H.
                self.take_step(1.0, transcription, moves, rollout);
                return false;
            }
        }
        false
    }

    /// The step H⁻¹g, with g the gradient for the given q_T; the decrease of the cost to expect, ½·gᵀH⁻¹g.
    fn find_step(
        &mut self,
        weight_thermal: f64,
        transcription: &Transcription,
        moves: &[f64],
        rollout: &Rollout,
    ) -> f64 {
        let period = transcription.problem().period;
        transcription.differentiate(weight_thermal, moves, rollout, &mut self.sensitivity);
        gather(period, &self.sensitivity, self.step.as_mut_slice());
        // With H = L·Lᵀ: gᵀH⁻¹g = ‖L⁻¹g‖².
        let lower = self.factor.l_dirty();
        lower.solve_lower_triangular_mut(&mut self.step);
        let decrement = self.step.norm_squared();
        lower.tr_solve_lower_triangular_mut(&mut self.step);
        0.5 * decrement
    }

    /// Adds `factor` times the step to the spline and rolls out.
    fn take_step(
        &mut self,
        factor: f64,
        transcription: &Transcription,
        moves: &mut [f64],
        rollout: &mut Rollout,
    ) {
        for (c, step) in self.spline.free().iter_mut().zip(self.step.iter()) {
            *c += factor * step;
        }
        self.spline.moves(moves);
        transcription.roll_out(moves, rollout);
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{any_initial, pendulum, tflex};
    use super::super::spline::hessian;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No other spline with the same ends is cheaper, nor is the gradient anything but zero.
        #[test]
        fn the_optimum_is_stationary(
            initial in any_initial(), goal in 0.1..1.4, flexure: bool, integral: bool,
        ) {
            let mut problem = if flexure { tflex() } else { pendulum() };
            problem.weights.integral = if integral { 1.0 } else { 0.0 };
            let mut transcription = Transcription::new(problem);
            transcription.set(initial, goal);
            let hessian = hessian(&transcription);
            let mut unconstrained = Unconstrained::new(&transcription, &hessian).expect("definite");
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            prop_assert!(unconstrained.solve(&transcription, &mut moves, &mut rollout));
            prop_assert!((rollout.angle[40] - goal).abs() < 1e-9);
            // What another Newton step would still gain.
            let weight = problem.weights.thermal;
            let left = unconstrained.find_step(weight, &transcription, &moves, &rollout);
            prop_assert!(left <= 1e-10 * rollout.cost, "{left} of {}", rollout.cost);
        }
    }
}
