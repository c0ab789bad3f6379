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

use super::super::linear_quadratic::{Form, Policy, STATES, deadbeat};
use super::super::rk4::{CURVED, ELAPSED, Lanes, QUADRATURE, STAGES};
use super::super::rollout::Rollout;
use super::super::solver::Task;
use super::super::transcription::Transcription;
use super::inequality::Inequalities;

/// Index of T in the state.
const LOAD: usize = 2;

/// An interval around the rollout: the step
///
/// ```text
/// dθr⁺ = dθr + h·dωr + h²/2·du      dωr⁺ = dωr + h·du
/// dT⁺  = t_θ·dθr + t_ω·dωr + a·dT + t_u·du
/// de⁺  = e_θ·dθr + e_ω·dωr + de + e_u·du
/// ```
///
/// whose structure the recursion makes use of, the gradient of the cost, and the policy.
#[derive(Clone, Copy, Debug)]
struct Linear<const S: usize> {
    h: f64,
    /// t_θ, t_ω and a.
    load: [f64; 3],
    /// e_θ and e_ω.
    integral: [f64; 2],
    /// ∂x⁺/∂u = (h²/2, h, t_u, e_u).
    by_move: [f64; S],
    /// Gradient of the cost in x.
    gradient: [f64; S],
    /// Gradient of the cost in u.
    gradient_by_move: f64,
    policy: Policy<S>,
}

/// Curvature of an interval's cost: the parts Q, S and R of H; of Q only the upper triangle counts.
struct Curvature<const S: usize> {
    xx: [[f64; S]; S],
    xu: [f64; S],
    uu: f64,
}

impl<const S: usize> Linear<S> {
    /// Aᵀ·p, the transpose of ∂x⁺/∂x times a column.
    #[inline(always)]
    fn transposed<A: Arithmetic>(&self, p: &[f64; S]) -> [f64; S] {
        let mut product = *p;
        product[0] = A::mul_add(self.load[0], p[LOAD], p[0]);
        product[1] = A::mul_add(self.load[1], p[LOAD], A::mul_add(self.h, p[0], p[1]));
        product[LOAD] = self.load[2] * p[LOAD];
        if S > LOAD + 1 {
            product[0] = A::mul_add(self.integral[0], p[S - 1], product[0]);
            product[1] = A::mul_add(self.integral[1], p[S - 1], product[1]);
        }
        product
    }

    /// A·x + B·u.
    #[inline(always)]
    fn advance<A: Arithmetic>(&self, x: &[f64; S], u: f64) -> [f64; S] {
        let mut next = *x;
        next[0] = A::mul_add(self.h, x[1], x[0]);
        let warmed = A::mul_add(self.load[0], x[0], self.load[1] * x[1]);
        next[LOAD] = A::mul_add(self.load[2], x[LOAD], warmed);
        if S > LOAD + 1 {
            let grown = A::mul_add(self.integral[0], x[0], x[S - 1]);
            next[S - 1] = A::mul_add(self.integral[1], x[1], grown);
        }
        for i in 0..S {
            next[i] = A::mul_add(self.by_move[i], u, next[i]);
        }
        next
    }

    /// One step of the recursion, as [`Form::policy`] does it for any A.
    #[inline(always)]
    fn recur<A: Arithmetic>(
        &mut self,
        own: &Curvature<S>,
        price: &mut [[f64; S]; S],
        imposed: Option<[f64; S]>,
    ) -> bool {
        // Rows of P are its columns: (P·A)ᵀ by rows.
        let (mut ap, mut pb) = ([[0.0; S]; S], [0.0; S]);
        for r in 0..S {
            ap[r] = self.transposed::<A>(&price[r]);
            for i in 0..S {
                pb[r] = A::mul_add(price[r][i], self.by_move[i], pb[r]);
            }
        }
        let mut h_uu = own.uu;
        let mut h_ux = self.transposed::<A>(&pb);
        for i in 0..S {
            h_uu = A::mul_add(self.by_move[i], pb[i], h_uu);
            h_ux[i] += own.xu[i];
        }
        let (gain, inverse) = match imposed {
            Some(gain) => (gain, 0.0),
            None if h_uu > 0.0 => {
                let inverse = 1.0 / h_uu;
                (h_ux.map(|h| h * inverse), inverse)
            }
            None => return false,
        };
        // Column c of P·A, then of AᵀPA.
        for c in 0..S {
            let column = self.transposed::<A>(&std::array::from_fn(|r| ap[r][c]));
            for r in 0..=c {
                // For the cheapest policy h_ux − h_uu·gain is zero.
                let rest = A::mul_add(-h_uu, gain[r], h_ux[r]);
                let value = A::mul_add(-gain[c], rest, own.xx[r][c] + column[r]);
                price[r][c] = A::mul_add(-gain[r], h_ux[c], value);
                price[c][r] = price[r][c];
            }
        }
        self.policy = Policy { gain, inverse };
        true
    }
}

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
        [thermal, lower, upper]: [&Inequalities; 3],
        with_curvature: bool,
    ) -> bool {
        let transcription = task.transcription;
        let problem = transcription.problem();
        let scale = 1.0 / task.cost_scale;
        let constant = problem.motor.torque_constant;
        let per_torque = 2.0 / (constant * constant);
        let horizon = moves.len();
        let has_limit = !thermal.value.is_empty();
        let weight_thermal = 2.0 * scale * problem.weights.thermal;
        let mut price = [[0.0; S]; S];
        // ∂𝓛/∂T after the interval.
        let mut load_price = 0.0;
        for k in (0..horizon).rev() {
            if has_limit {
                load_price += thermal.multiplier[k];
                price[LOAD][LOAD] += thermal.weight[k];
            }
            if k + 1 < horizon {
                price[0][0] += lower.weight[k] + upper.weight[k];
            }
            let interval = transcription.interval(k);
            let h = interval.length;
            let heat = &interval.thermal.heat;
            let stage = &rollout.stages[k];
            let form = &self.forms[k.min(self.forms.len() - 1)];

            // Cost of the load, and the price of heat in it and in all.
            let mut own: Lanes = [0.0; STAGES];
            let mut own_load = 0.0;
            if weight_thermal > 0.0 {
                for j in 0..STAGES {
                    let slope = weight_thermal * QUADRATURE[j] * h * stage.thermal_load[j];
                    own_load = A::mul_add(slope, interval.thermal.load[j], own_load);
                    for i in 0..STAGES {
                        own[i] = A::mul_add(slope, heat[j][i], own[i]);
                    }
                }
            }
            let slopes: Lanes = std::array::from_fn(|j| per_torque * stage.torque[j]);
            let total: Lanes =
                std::array::from_fn(|j| A::mul_add(load_price, heat[STAGES][j], own[j]));
            let gradients: [[f64; 3]; STAGES] =
                std::array::from_fn(|j| transcription.torque_gradient(stage, h, j));

            let mut own_curvature = Curvature {
                xx: form.xx.map(|row| row.map(|x| x * scale)),
                xu: form.xu.map(|x| x * scale),
                uu: form.uu * scale,
            };
            let now = &mut own_curvature;
            let mut load = [0.0, 0.0, interval.thermal.decay()];
            let mut load_by_move = 0.0;
            let mut gradient = [0.0; S];
            let mut by_move = 2.0 * scale * problem.weights.acceleration * h * moves[k];
            gradient[LOAD] = own_load;
            for j in 0..STAGES {
                let [angle, velocity, move_] = gradients[j];
                // The step of T, and the gradient of the cost.
                let warming = heat[STAGES][j] * slopes[j];
                load[0] = A::mul_add(warming, angle, load[0]);
                load[1] = A::mul_add(warming, velocity, load[1]);
                load_by_move = A::mul_add(warming, move_, load_by_move);
                let weights = &problem.weights;
                let share = 2.0 * scale * QUADRATURE[j] * h;
                let mut distance = share * weights.angle * stage.distance[j];
                if S > LOAD + 1 {
                    if j + 1 < STAGES {
                        let share = 2.0 * scale * QUADRATURE[j + 1] * h;
                        let slope = share * weights.integral * stage.integral[j + 1];
                        distance = A::mul_add(slope, ELAPSED[j + 1] * h, distance);
                    }
                    gradient[S - 1] += share * weights.integral * stage.integral[j];
                }
                let speed = share * weights.velocity * stage.velocity[j];
                let (time, curved) = (ELAPSED[j] * h, CURVED[j] * h * h);
                let own = own[j] * slopes[j];
                gradient[0] += A::mul_add(own, angle, distance);
                gradient[1] += A::mul_add(own, velocity, A::mul_add(distance, time, speed));
                let by_reference = A::mul_add(distance, curved, speed * time);
                by_move += A::mul_add(own, move_, by_reference);
                // Curvature of heat.
                let bend = total[j] * per_torque;
                now.xx[0][0] = A::mul_add(bend * angle, angle, now.xx[0][0]);
                now.xx[0][1] = A::mul_add(bend * angle, velocity, now.xx[0][1]);
                now.xx[1][1] = A::mul_add(bend * velocity, velocity, now.xx[1][1]);
                now.xu[0] = A::mul_add(bend * angle, move_, now.xu[0]);
                now.xu[1] = A::mul_add(bend * velocity, move_, now.xu[1]);
                now.uu = A::mul_add(bend * move_, move_, now.uu);
                if with_curvature {
                    let bend = total[j] * slopes[j] * stage.curvature[j];
                    now.xx[0][0] += bend;
                    now.xx[0][1] = A::mul_add(bend, time, now.xx[0][1]);
                    now.xx[1][1] = A::mul_add(bend * time, time, now.xx[1][1]);
                    now.xu[0] = A::mul_add(bend, curved, now.xu[0]);
                    now.xu[1] = A::mul_add(bend * time, curved, now.xu[1]);
                    now.uu = A::mul_add(bend * curved, curved, now.uu);
                }
            }
            if weight_thermal > 0.0 {
                // Curvature of T² in T.
                for j in 0..STAGES {
                    let mut row = [0.0; 4];
                    row[LOAD] = interval.thermal.load[j];
                    for i in 0..j {
                        let warming = heat[j][i] * slopes[i];
                        row[0] = A::mul_add(warming, gradients[i][0], row[0]);
                        row[1] = A::mul_add(warming, gradients[i][1], row[1]);
                        row[3] = A::mul_add(warming, gradients[i][2], row[3]);
                    }
                    let weight = weight_thermal * QUADRATURE[j] * h;
                    for r in 0..3 {
                        for c in r..3 {
                            now.xx[r][c] = A::mul_add(weight * row[r], row[c], now.xx[r][c]);
                        }
                        now.xu[r] = A::mul_add(weight * row[r], row[3], now.xu[r]);
                    }
                    now.uu = A::mul_add(weight * row[3], row[3], now.uu);
                }
            }
            load_price = A::mul_add(load_price, interval.thermal.decay(), own_load);

            let linear = &mut self.linear[k];
            linear.h = h;
            linear.load = load;
            linear.by_move = form.b;
            linear.by_move[LOAD] = load_by_move;
            if S > LOAD + 1 {
                linear.integral = [form.a[S - 1][0], form.a[S - 1][1]];
            }
            linear.gradient = gradient;
            linear.gradient_by_move = by_move;
            let imposed = (k + 2).checked_sub(horizon).map(|end| self.ends[end]);
            if !linear.recur::<A>(&own_curvature, &mut price, imposed) {
                return false;
            }
        }
        true
    }

    /// The step for the slopes of the inequalities, with the latest factors.
    #[inline(always)]
    pub fn solve<A: Arithmetic>(&mut self, [thermal, lower, upper]: [&Inequalities; 3]) {
        let horizon = self.linear.len();
        let has_limit = !thermal.value.is_empty();
        let mut p = [0.0; S];
        let mut decrease = 0.0;
        for k in (0..horizon).rev() {
            if has_limit {
                p[LOAD] += thermal.slope[k];
            }
            if k + 1 < horizon {
                p[0] += upper.slope[k] - lower.slope[k];
            }
            let linear = &self.linear[k];
            let Policy { gain, inverse } = &linear.policy;
            let mut through = linear.gradient_by_move;
            let mut next = linear.transposed::<A>(&p);
            for i in 0..S {
                through = A::mul_add(linear.by_move[i], p[i], through);
            }
            for c in 0..S {
                next[c] = A::mul_add(-gain[c], through, linear.gradient[c] + next[c]);
            }
            self.moves[k] = -inverse * through;
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
