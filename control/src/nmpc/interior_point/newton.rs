//! The Newton step of a plan: the problem linearised around a rollout, factorised and solved by the Riccati
//! recursion over x = (θr, ωr, T) and, where the cost has an integral, e. O(N).
//!
//! The curvature of a stage's heat q_j = (τ_j/Ki)² at the price π_j of heat is
//!
//! ```text
//! π_j·∇²q_j = 2·π_j/Ki²·(∇τ_j·∇τ_jᵀ + τ_j·g''(θ_j)·∇θ_j·∇θ_jᵀ)
//! ```
//!
//! whose first part is convex. The second is left out where the whole would have no minimum.

use arm::Arithmetic;

use self::assembly::Assembly;
use self::linear::Linear;
use super::super::linear_quadratic::{Form, Policy, STATES, deadbeat};
use super::super::rollout::Rollout;
use super::super::solver::Task;
use super::super::transcription::Transcription;
use super::inequality::Inequalities;

mod assembly;
mod linear;

/// Index of T in the state.
const LOAD: usize = 2;

/// The Newton step, set up for `S` states.
#[derive(Clone, Debug)]
pub struct Newton<const S: usize> {
    /// Step and cost of the intervals without heat \[N\], or a single one if all are equal.
    forms: Vec<Form<S>>,
    /// K of the last two intervals.
    ends: [[f64; S]; 2],
    linear: Vec<Linear<S>>,
    /// Change of u \[N\].
    pub moves: Vec<f64>,
    /// Change of θr at the nodes 1..N−1 \[N − 1\].
    pub angle: Vec<f64>,
    /// Change of T at the nodes 1..N \[N\].
    pub load: Vec<f64>,
    /// Decrease of the linearised cost to expect.
    pub decrease: f64,
}

/// Where the states of the full form are among the `S`.
fn place(state: usize) -> usize {
    if state < LOAD { state } else { state + 1 }
}

impl<const S: usize> Newton<S> {
    /// Sets up for the problem of `transcription`.
    pub fn new(transcription: &Transcription) -> Self {
        let problem = transcription.problem();
        let horizon = problem.horizon;
        let last = transcription.interval(horizon - 1).length;
        let ends = deadbeat(transcription.interval(horizon - 2).length, last);
        let idle = Linear {
            h: 0.0,
            load: [0.0; 3],
            integral: [0.0; 2],
            by_move: [0.0; S],
            gradient: [0.0; S],
            gradient_by_move: 0.0,
            policy: Policy {
                gain: [0.0; S],
                inverse: 0.0,
            },
        };
        Self {
            forms: transcription
                .intervals()
                .iter()
                .map(|interval| reduced(&Form::new(problem, interval)))
                .collect(),
            ends: ends.map(|end| {
                let mut gain = [0.0; S];
                gain[..2].copy_from_slice(&end);
                gain
            }),
            linear: vec![idle; horizon],
            moves: vec![0.0; horizon],
            angle: vec![0.0; horizon - 1],
            load: vec![0.0; horizon],
            decrease: 0.0,
        }
    }

    /// Linearises around `rollout` of `moves` and factorises, with the curvature of g or without; false if
    /// there is no minimum.
    #[inline(always)]
    pub fn factorise<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &[f64],
        rollout: &Rollout,
        families: [&Inequalities; 3],
        with_curvature: bool,
    ) -> bool {
        let horizon = moves.len();
        let assembly = Assembly::new(task, with_curvature);
        let mut price = [[0.0; S]; S];
        let [angle_weight, load_weight] = weights(families, horizon);
        price[0][0] = angle_weight;
        price[LOAD][LOAD] = load_weight;
        // ∂𝓛/∂T after the interval.
        let mut load_price = 0.0;
        for k in (0..horizon).rev() {
            let interval = task.transcription.interval(k);
            let form = &self.forms[k.min(self.forms.len() - 1)];
            let linear = &mut self.linear[k];
            load_price += families[0].multiplier_after(k);
            let (mut own, own_load_price) = assembly.linearise::<A, S>(
                interval,
                form,
                &rollout.stages[k],
                moves[k],
                load_price,
                linear,
            );
            load_price = A::mul_add(load_price, interval.thermal.decay(), own_load_price);
            // Inequalities of the node at the interval's start; at the first nothing is left to decide.
            let [angle_weight, load_weight] = weights(families, k);
            own.xx[0][0] += angle_weight;
            own.xx[LOAD][LOAD] += load_weight;
            let imposed = (k + 2).checked_sub(horizon).map(|end| &self.ends[end]);
            if !linear.recur::<A>(&own, &mut price, imposed) {
                return false;
            }
        }
        true
    }

    /// The step for the slopes of the inequalities, with the latest factors.
    #[inline(always)]
    pub fn solve<A: Arithmetic>(&mut self, families: [&Inequalities; 3]) {
        let horizon = self.linear.len();
        let mut p = [0.0; S];
        let mut decrease = 0.0;
        let rows = self.linear.iter().zip(&mut self.moves).enumerate();
        for (k, (linear, u)) in rows.rev() {
            let [angle_slope, load_slope] = slopes(families, k + 1);
            p[0] += angle_slope;
            p[LOAD] += load_slope;
            let Policy { gain, inverse } = &linear.policy;
            let mut through = linear.gradient_by_move;
            let mut next = linear.transposed::<A>(&p);
            for i in 0..S {
                through = A::mul_add(linear.by_move[i], p[i], through);
            }
            for c in 0..S {
                next[c] = A::mul_add(-gain[c], through, linear.gradient[c] + next[c]);
            }
            *u = -inverse * through;
            decrease = A::mul_add(0.5 * inverse * through, through, decrease);
            p = next;
        }
        self.decrease = decrease;
        let mut x = [0.0; S];
        for k in 0..horizon {
            let linear = &self.linear[k];
            let mut u = self.moves[k];
            for i in 0..S {
                u = A::mul_add(-linear.policy.gain[i], x[i], u);
            }
            self.moves[k] = u;
            x = linear.advance::<A>(&x, u);
            self.load[k] = x[LOAD];
            if k + 1 < horizon {
                self.angle[k] = x[0];
            }
        }
    }
}

/// Σ of the inequalities of θr and T at node `node`.
#[inline(always)]
fn weights([thermal, lower, upper]: [&Inequalities; 3], node: usize) -> [f64; 2] {
    let at = |weights: &[f64]| weights.get(node.wrapping_sub(1)).copied().unwrap_or(0.0);
    [at(&lower.weight) + at(&upper.weight), at(&thermal.weight)]
}

/// Slopes of the inequalities in θr and T at node `node`.
#[inline(always)]
fn slopes([thermal, lower, upper]: [&Inequalities; 3], node: usize) -> [f64; 2] {
    let at = |slopes: &[f64]| slopes.get(node.wrapping_sub(1)).copied().unwrap_or(0.0);
    [at(&upper.slope) - at(&lower.slope), at(&thermal.slope)]
}

/// The form without z, and with T in its place.
fn reduced<const S: usize>(full: &Form<STATES>) -> Form<S> {
    let states = if S > LOAD + 1 { 3 } else { 2 };
    let mut form = Form {
        a: [[0.0; S]; S],
        b: [0.0; S],
        xx: [[0.0; S]; S],
        xu: [0.0; S],
        uu: full.uu,
    };
    for r in 0..states {
        for c in 0..states {
            form.a[place(r)][place(c)] = full.a[r][c];
            form.xx[place(r)][place(c)] = full.xx[r][c];
        }
        form.b[place(r)] = full.b[r];
        form.xu[place(r)] = full.xu[r];
    }
    form
}

#[cfg(test)]
mod tests;
