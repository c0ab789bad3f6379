//! The Newton step of a plan: the problem linearised around a rollout, factorised and solved by the Riccati
//! recursion over x = (θr, ωr, T) and, where the cost has an integral, e. O(N).
//!
//! The curvature of a stage's heat q_j = (τ_j/Ki)² at the price π_j of heat is
//!
//! ```text
//! π_j·∇²q_j = 2·π_j/Ki²·(∇τ_j·∇τ_jᵀ + τ_j·g''(θ_j)·∇θ_j·∇θ_jᵀ)
//! ```
//!
//! whose first part is convex, and the whole is if and only if τ_j·g'' ≥ 0. Where the sum over all stages would
//! have no minimum, the second part is left out of those where it is negative.

use arm::{Arithmetic, LANES, Vector};

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
    /// Change of θr at the nodes from 1 on, in groups \[N and what fills the last group\].
    pub angle: Vec<[f64; LANES]>,
    /// Change of T, likewise.
    pub load: Vec<[f64; LANES]>,
    /// Weights, then slopes, of the inequalities of θr at the nodes from 1 on, likewise.
    of_angle: Vec<[f64; LANES]>,
    /// Those of the inequalities of T, likewise.
    of_load: Vec<[f64; LANES]>,
    /// λ of the latter, likewise.
    multipliers: Vec<[f64; LANES]>,
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
            closed_gradient: [0.0; S],
            policy: Policy {
                gain: [0.0; S],
                inverse: 0.0,
            },
            closed: [[0.0; S]; S],
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
            angle: vec![[0.0; LANES]; horizon.div_ceil(LANES)],
            load: vec![[0.0; LANES]; horizon.div_ceil(LANES)],
            of_angle: vec![[0.0; LANES]; horizon.div_ceil(LANES)],
            of_load: vec![[0.0; LANES]; horizon.div_ceil(LANES)],
            multipliers: vec![[0.0; LANES]; horizon.div_ceil(LANES)],
            decrease: 0.0,
        }
    }

    /// Linearises around `rollout` of `moves` and factorises, with all of the curvature of heat or its
    /// `convex` parts; false if there is no minimum.
    #[inline(always)]
    pub fn factorise<A: Arithmetic>(
        &mut self,
        task: &Task<'_>,
        moves: &[f64],
        rollout: &Rollout,
        families: [&Inequalities; 3],
        convex: bool,
    ) -> bool {
        let horizon = moves.len();
        let assembly = Assembly::new(task, convex);
        let [thermal, lower, upper] = families;
        let of_angle = lower.weights::<A>().zip(upper.weights::<A>());
        write(&mut self.of_angle, of_angle.map(|(l, u)| l + u));
        write(&mut self.of_load, thermal.weights::<A>());
        for (own, multipliers) in self.multipliers.iter_mut().zip(thermal.multiplier_groups()) {
            *own = *multipliers;
        }
        let of_angle = self.of_angle.as_flattened();
        let of_load = self.of_load.as_flattened();
        let multipliers = self.multipliers.as_flattened();
        let mut price = [[0.0; S]; S];
        price[0][0] = of_angle[horizon - 1];
        price[LOAD][LOAD] = of_load[horizon - 1];
        // ∂𝓛/∂T after the interval.
        let mut load_price = 0.0;
        for k in (0..horizon).rev() {
            let interval = task.transcription.interval(k);
            let form = &self.forms[k.min(self.forms.len() - 1)];
            let linear = &mut self.linear[k];
            load_price += multipliers[k];
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
            if let Some(node) = k.checked_sub(1) {
                own.xx[0][0] += of_angle[node];
                own.xx[LOAD][LOAD] += of_load[node];
            }
            let imposed = (k + 2).checked_sub(horizon).map(|end| &self.ends[end]);
            if !linear.recur::<A>(&own, &mut price, imposed) {
                return false;
            }
        }
        true
    }

    /// The step for the slopes of the inequalities, with the latest factors.
    #[inline(always)]
    pub fn solve<A: Arithmetic>(&mut self, [thermal, lower, upper]: [&Inequalities; 3]) {
        let mut p = [0.0; S];
        let mut decrease = 0.0;
        let of_angle = lower.slopes::<A>().zip(upper.slopes::<A>());
        write(&mut self.of_angle, of_angle.map(|(l, u)| l + u));
        write(&mut self.of_load, thermal.slopes::<A>());
        let slopes = self.of_angle.as_flattened().iter();
        let slopes = slopes.zip(self.of_load.as_flattened());
        let horizon = self.linear.len();
        let rows = self.linear.iter().zip(&mut self.moves);
        for ((linear, u), (of_angle, of_load)) in rows.zip(slopes.take(horizon)).rev() {
            p[0] += of_angle;
            p[LOAD] += of_load;
            let inverse = linear.policy.inverse;
            let (mut through, mut before) = (linear.gradient_by_move, linear.closed_gradient);
            for r in 0..S {
                through = A::mul_add(linear.by_move[r], p[r], through);
                for c in 0..S {
                    before[c] = A::mul_add(linear.closed[r][c], p[r], before[c]);
                }
            }
            *u = -inverse * through;
            decrease = A::mul_add(0.5 * inverse * through, through, decrease);
            p = before;
        }
        self.decrease = decrease;
        let mut x = [0.0; S];
        let changes = self.angle.as_flattened_mut().iter_mut();
        let changes = changes.zip(self.load.as_flattened_mut());
        let rows = self.linear.iter().zip(&mut self.moves);
        for ((linear, u), (angle, load)) in rows.zip(changes) {
            // B·v for the policy's own part v first, then u = v − K·x.
            let mut after = linear.by_move.map(|by_move| by_move * *u);
            for c in 0..S {
                *u = A::mul_add(-linear.policy.gain[c], x[c], *u);
                for r in 0..S {
                    after[r] = A::mul_add(linear.closed[r][c], x[c], after[r]);
                }
            }
            x = after;
            (*angle, *load) = (x[0], x[LOAD]);
        }
    }
}

/// Fills as many groups as there are vectors.
#[inline(always)]
fn write<V: Vector>(groups: &mut [[f64; LANES]], vectors: impl Iterator<Item = V>) {
    for (group, vector) in groups.iter_mut().zip(vectors) {
        *group = vector.lanes();
    }
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
