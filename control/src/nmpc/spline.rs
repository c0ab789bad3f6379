//! The reference as a spline: the linear rows of the problem, eliminated.
//!
//! Piecewise constant u makes θr a quadratic spline whose knots are the shooting nodes. With one
//! coefficient per node, h_k the length of interval k, h_−1 = h_0 and h_N = h_{N−1},
//!
//! ```text
//! c_k  = θr_k + h_k/2·ωr_k                   for k = 0..N, and  c_−1 = θr_0 − h_0/2·ωr_0
//! θr_k = (h_k·c_{k−1} + h_{k−1}·c_k)/(h_{k−1} + h_k)      ωr_k = 2·(c_k − c_{k−1})/(h_{k−1} + h_k)
//! u_k  = (ωr_{k+1} − ωr_k)/h_k
//! ```
//!
//! the rows dθr/dt = ωr and dωr/dt = u hold for every c. The start fixes c_−1 and c_0, terminal rest
//! (eq 27) fixes c_{N−1} and c_N; the other N − 2 coefficients are free and are all there is to choose. Without
//! terminal rest c_1..c_N are.

use arm::Instructions;
use nalgebra::DMatrix;

use super::problem::{Problem, Terminal};
use super::rollout::{Rollout, Sensitivity};
use super::transcription::Transcription;

/// Coefficients c_−1..c_N \[N + 2\] \[rad\]; the free ones are c_1..c_{N−2}, or c_1..c_N.
#[derive(Clone, Debug)]
pub struct Spline {
    coefficients: Vec<f64>,
    free: usize,
}

/// Number of free coefficients: N − 2 with terminal rest, N without.
pub fn free_coefficients(problem: &Problem) -> usize {
    match problem.terminal {
        Terminal::RestAtGoal => problem.horizon - 2,
        Terminal::SafeSet | Terminal::Free => problem.horizon,
    }
}

/// ∂(θr_k, ωr_k, u_k)/∂(c_{k−1}, c_k, c_{k+1}) of interval `k`.
pub fn stencil(transcription: &Transcription, k: usize) -> [[f64; 3]; 3] {
    let k = k as isize;
    let [before, h, after] = [-1, 0, 1].map(|shift| transcription.length(k + shift));
    let (left, right) = (1.0 / (before + h), 1.0 / (h + after));
    [
        [h * left, before * left, 0.0],
        [-2.0 * left, 2.0 * left, 0.0],
        [2.0 * left / h, -2.0 * (left + right) / h, 2.0 * right / h],
    ]
}

impl Spline {
    /// Space for the splines of a problem, all coefficients zero.
    pub fn new(problem: &Problem) -> Self {
        Self {
            coefficients: vec![0.0; problem.horizon + 2],
            free: free_coefficients(problem),
        }
    }

    /// The free coefficients \[N − 2 or N\].
    pub fn free(&mut self) -> &mut [f64] {
        &mut self.coefficients[2..2 + self.free]
    }

    /// Takes all coefficients over from `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.coefficients.copy_from_slice(&other.coefficients);
    }

    /// Fixes the ends that are not free to start and terminal rest of `transcription`.
    pub fn fix_ends(&mut self, transcription: &Transcription) {
        let initial = transcription.initial();
        let [angle, velocity] = transcription.terminal_reference();
        let last = self.coefficients.len() - 1;
        let end_is_free = self.free + 2 > last;
        let half = 0.5 * transcription.length(0);
        self.coefficients[0] = initial.reference_angle - half * initial.reference_velocity;
        self.coefficients[1] = initial.reference_angle + half * initial.reference_velocity;
        if end_is_free {
            return;
        }
        let half = 0.5 * transcription.length(last as isize);
        self.coefficients[last - 1] = angle - half * velocity;
        self.coefficients[last] = angle + half * velocity;
    }

    /// Takes the free coefficients from the nodes of `rollout`; the ends stay.
    pub fn fit(&mut self, transcription: &Transcription, rollout: &Rollout) {
        let nodes = rollout.reference_angle[1..]
            .iter()
            .zip(&rollout.reference_velocity[1..]);
        for (k, (c, (angle, velocity))) in self.free().iter_mut().zip(nodes).enumerate() {
            *c = angle + 0.5 * transcription.length(k as isize + 1) * velocity;
        }
    }

    /// The moves u \[N\] of the spline.
    pub fn moves(&self, transcription: &Transcription, moves: &mut [f64]) {
        let velocity = |k: usize, change: f64| {
            let k = k as isize;
            2.0 * change / (transcription.length(k - 1) + transcription.length(k))
        };
        for (k, (u, c)) in moves
            .iter_mut()
            .zip(self.coefficients.windows(3))
            .enumerate()
        {
            let change = velocity(k + 1, c[2] - c[1]) - velocity(k, c[1] - c[0]);
            *u = change / transcription.length(k as isize);
        }
    }
}

/// ∂cost/∂c of the free coefficients \[N − 2 or N\].
pub fn gather(transcription: &Transcription, sensitivity: &Sensitivity, gradient: &mut [f64]) {
    gradient.fill(0.0);
    for (k, interval) in sensitivity.gradient.iter().enumerate() {
        let stencil = stencil(transcription, k);
        for (column, m) in free_columns(k, gradient.len()) {
            gradient[m] += (0..3)
                .map(|row| stencil[row][column] * interval[row])
                .sum::<f64>();
        }
    }
}

/// The coefficients that interval `k` depends on and that are free: their column in the stencil and
/// their index among the `free` ones.
pub fn free_columns(k: usize, free: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..3).filter_map(move |column| {
        let m = (k + column).checked_sub(2)?;
        (m < free).then_some((column, m))
    })
}

/// ∂²cost/∂c² of the free coefficients, the cost of heat left out \[free × free\]: the same for every start
/// and goal.
pub fn hessian(transcription: &Transcription) -> DMatrix<f64> {
    // The cost without heat is a quadratic form: differences of its gradient are exact.
    let problem = *transcription.problem();
    let horizon = problem.horizon;
    let homogeneous = Transcription::new(problem, Instructions::Baseline);
    let mut spline = Spline::new(&problem);
    let mut rollout = Rollout::new(horizon);
    let mut sensitivity = Sensitivity::new(horizon);
    let mut moves = vec![0.0; horizon];
    let free = free_coefficients(&problem);
    let mut hessian = DMatrix::zeros(free, free);
    for m in 0..free {
        spline.free().fill(0.0);
        spline.free()[m] = 1.0;
        spline.moves(&homogeneous, &mut moves);
        homogeneous.roll_out(&moves, &mut rollout);
        homogeneous.differentiate(0.0, &moves, &rollout, &mut sensitivity);
        let mut column = hessian.column_mut(m);
        gather(&homogeneous, &sensitivity, column.as_mut_slice());
    }
    // Rounding only: both triangles describe the same form.
    let transposed = hessian.transpose();
    (hessian + transposed) * 0.5
}

#[cfg(test)]
mod tests {
    use super::super::examples::{any_initial, any_moves, pendulum, tflex};
    use super::super::problem::Problem;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn moves_of_any_spline_lead_from_start_to_terminal_rest(
            initial in any_initial(), goal in 0.1..1.4, free in prop::collection::vec(0.0..1.5, 38), growth in 1.0..1.1,
        ) {
            let problem = Problem { period: 0.02, growth, longest: f64::INFINITY, ..pendulum() };
            let mut transcription = Transcription::new(problem, Instructions::best());
            transcription.set(initial, goal);
            let mut spline = Spline::new(&problem);
            spline.free().copy_from_slice(&free);
            spline.fix_ends(&transcription);
            let mut moves = vec![0.0; 40];
            spline.moves(&transcription, &mut moves);
            let mut rollout = Rollout::new(40);
            transcription.roll_out(&moves, &mut rollout);
            prop_assert!((rollout.angle[40] - goal).abs() < 1e-9);
            let [angle, velocity] = transcription.terminal_reference();
            prop_assert!((rollout.reference_angle[40] - angle).abs() < 1e-9);
            prop_assert!((rollout.reference_velocity[40] - velocity).abs() < 1e-9);
            // And back: the rollout's nodes give the coefficients.
            let mut again = spline.clone();
            again.free().fill(0.0);
            again.fit(&transcription, &rollout);
            for (c, expected) in again.free().iter().zip(&free) {
                prop_assert!((c - expected).abs() < 1e-9);
            }
        }

        #[test]
        fn gradient_and_hessian_describe_the_cost(
            initial in any_initial(), goal in 0.1..1.4, step in any_moves(38), integral: bool, growth in 1.0..1.1,
        ) {
            let mut problem = Problem { period: 0.02, growth, longest: f64::INFINITY, ..tflex() };
            problem.weights.thermal = 0.0;
            problem.weights.integral = if integral { 0.5 } else { 0.0 };
            let mut transcription = Transcription::new(problem, Instructions::best());
            transcription.set(initial, goal);
            let mut spline = Spline::new(&problem);
            spline.free().fill(goal);
            spline.fix_ends(&transcription);
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            let mut cost = |spline: &Spline| {
                spline.moves(&transcription, &mut moves);
                transcription.roll_out(&moves, &mut rollout);
                let mut sensitivity = Sensitivity::new(40);
                transcription.differentiate(0.0, &moves, &rollout, &mut sensitivity);
                let mut gradient = nalgebra::DVector::zeros(38);
                gather(&transcription, &sensitivity, gradient.as_mut_slice());
                (rollout.cost, gradient)
            };
            let (before, gradient) = cost(&spline);
            let step = nalgebra::DVector::from_vec(step) * 1e-2;
            for (c, step) in spline.free().iter_mut().zip(step.iter()) {
                *c += step;
            }
            let (after, _) = cost(&spline);
            let curvature = (hessian(&transcription) * &step).dot(&step);
            let expected = before + gradient.dot(&step) + 0.5 * curvature;
            prop_assert!((after - expected).abs() <= 1e-9 * after, "{after} {expected}");
        }
    }
}
