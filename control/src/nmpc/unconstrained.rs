//! The plan without inequalities: the optimum as a policy, the yardstick and first guess of every solver,
//! and the final answer wherever it keeps the limits. Where the end need not be at rest the last two moves
//! follow the cheapest policy like all others.
//!
//! Without q_T the optimum is u_k = −K_k·(θr−θ_goal, ωr, e, z), with gains that depend on the problem alone
//! ([`super::linear_quadratic`]). With q_T Newton steps follow, with the true gradient and the same
//! curvature, which q_T·T² hardly bends, while one promises a decrease that counts: with the weights of the
//! paper none does. O(N) a plan.

use arm::{Arithmetic, Kernel, LANES, Separate, Vector};

use super::linear_quadratic::{Form, Policy, STATES, deadbeat};
use super::problem::{Problem, Terminal};
use super::rk4::STAGES;
use super::rollout::{Rollout, Sensitivity};
use super::transcription::Transcription;

/// Steps after which a cost that does not settle is left to the solver.
const MAX_STEPS: u32 = 12;
/// Decrease expected of a step, relative to the cost, that is not worth the step: a hundredth of what the
/// interior point leaves. The moves then miss the optimum's by √2e-8 in the norm of the cost.
const SETTLED: f64 = 1e-8;

/// What an interval does to (θr, ωr, e) where its move follows the policy u = −K·x + v.
#[derive(Clone, Copy, Debug)]
struct Governed {
    /// A − B·K, and B in the last lane \[3 × 4\].
    step: [[f64; LANES]; 3],
    /// K.
    gain: [f64; LANES],
    /// 1/H_uu; 0 where the policy is imposed.
    inverse: f64,
}

impl Governed {
    fn new(form: &Form<STATES>, policy: &Policy<STATES>) -> Self {
        let Policy { gain, inverse } = policy;
        let row = |r: usize| {
            let by_state = |c: usize| form.a[r][c] - form.b[r] * gain[c];
            [by_state(0), by_state(1), by_state(2), form.b[r]]
        };
        Self {
            step: [0, 1, 2].map(row),
            gain: [gain[0], gain[1], gain[2], 0.0],
            inverse: *inverse,
        }
    }

    /// From the `gradient` of the interval's own cost in (θr, ωr, e, u) and that of the cost to go after it, that of
    /// the cost to go before it in (θr, ωr, e, v).
    #[inline(always)]
    fn back<A: Arithmetic>(&self, gradient: A::Vector, after: A::Vector) -> A::Vector {
        let [angle, velocity, integral, _] = after.lanes().map(A::Vector::splat);
        let [.., by_move] = gradient.lanes();
        let [by_angle, by_velocity, by_integral] = self.step.each_ref().map(A::Vector::new);
        let own = A::Vector::splat(by_move).neg_mul_add(A::Vector::new(&self.gain), gradient);
        let through = integral.mul_add(by_integral, own);
        velocity.mul_add(by_velocity, angle.mul_add(by_angle, through))
    }
}

/// Minimiser of the cost subject to dynamics and terminal rest alone.
#[derive(Clone, Debug)]
pub struct Unconstrained {
    /// The intervals \[N\].
    governed: Vec<Governed>,
    /// P at the start.
    price: [[f64; STATES]; STATES],
    /// The moves for every unit of the state at the start, four side by side \[⌈N/4⌉ × 6 × 4\].
    moves_of_units: Vec<[[f64; LANES]; STATES]>,
    sensitivity: Sensitivity,
    /// Change of the moves in a Newton step \[N\].
    step: Vec<f64>,
}

impl Unconstrained {
    /// Solves the Riccati recursion; none if the cost has no unique minimum.
    pub fn new(transcription: &Transcription) -> Option<Self> {
        let problem = transcription.problem();
        let horizon = problem.horizon;
        let last = transcription.interval(horizon - 1);
        let ends = deadbeat(transcription.interval(horizon - 2).length, last.length);
        // z at the end as a linear form of z at the start of the last interval, then of the one before.
        let end = last.deviation[STAGES];
        let before = transcription.interval(horizon - 2).deviation[STAGES];
        let ends_of = [
            std::array::from_fn(|r| {
                std::array::from_fn(|c| (0..3).map(|i| end[r][i] * before[i][c]).sum())
            }),
            end,
        ];
        let mut price = [[0.0; STATES]; STATES];
        let idle = Policy {
            gain: [0.0; STATES],
            inverse: 0.0,
        };
        let mut policies = vec![idle; horizon];
        let forms: Vec<_> = (0..horizon)
            .map(|k| Form::new(problem, transcription.interval(k)))
            .collect();
        for (k, form) in forms.iter().enumerate().rev() {
            let at_rest = (k + 2).checked_sub(horizon);
            let at_rest = at_rest.filter(|_| problem.terminal == Terminal::RestAtGoal);
            let imposed = at_rest.map(|index| {
                let [angle, velocity] = ends[index];
                let left = (horizon - 1 - k) as f64;
                imposed(
                    angle,
                    velocity,
                    left * last.length + transcription.interval(k).length,
                    &ends_of[index],
                )
            });
            policies[k] = form.policy::<Separate>(&mut price, imposed)?;
        }
        let governed = forms.iter().zip(&policies);
        Some(Self {
            governed: governed
                .map(|(form, policy)| Governed::new(form, policy))
                .collect(),
            moves_of_units: moves_of_units(&forms, &policies),
            price,
            sensitivity: Sensitivity::new(horizon),
            step: vec![0.0; horizon],
        })
    }

    /// Least cost of a movement by `distance` \[rad\] from rest to rest \[rad²·s\].
    pub fn cost_of_movement(&self, distance: f64) -> f64 {
        0.5 * self.price[0][0] * distance * distance
    }

    /// Writes the optimum's `moves` \[N\] and their `rollout`, without the curvature of g; whether the cost
    /// settled.
    pub fn solve(
        &mut self,
        transcription: &Transcription,
        moves: &mut [f64],
        rollout: &mut Rollout,
    ) -> bool {
        transcription.instructions().run(Solve {
            unconstrained: self,
            transcription,
            moves,
            rollout,
        })
    }

    #[inline(always)]
    fn solve_with<A: Arithmetic>(
        &mut self,
        transcription: &Transcription,
        moves: &mut [f64],
        rollout: &mut Rollout,
    ) -> bool {
        self.follow_policies::<A>(transcription, moves);
        let mut steps = 0;
        loop {
            let before = rollout.cost;
            transcription.roll_out_with::<A, 2>(moves, rollout);
            let weight_thermal = transcription.problem().weights.thermal;
            if weight_thermal == 0.0 {
                return true;
            }
            if steps > 0 && (rollout.cost.is_nan() || rollout.cost > before) {
                // q_T bends the cost too much for these policies.
                self.add_step(-1.0, moves);
                transcription.roll_out_with::<A, 2>(moves, rollout);
                return false;
            }
            // Where the policies lead the rest of the gradient is zero.
            if steps == 0
                && self.promised_by_heat::<A>(transcription, rollout) <= SETTLED * rollout.cost
            {
                return true;
            }
            let sensitivity = &mut self.sensitivity;
            transcription.differentiate_with::<A>(weight_thermal, moves, rollout, sensitivity);
            if self.descend::<A>() <= SETTLED * rollout.cost {
                return true;
            }
            if steps == MAX_STEPS {
                return false;
            }
            self.complete_step::<A>();
            self.add_step(1.0, moves);
            steps += 1;
        }
    }

    /// The moves of the policies.
    #[inline(always)]
    fn follow_policies<A: Arithmetic>(&self, transcription: &Transcription, moves: &mut [f64]) {
        let initial = transcription.initial();
        let [angle, velocity, integral] = transcription.deviation_at(0);
        let x = [
            initial.reference_angle - transcription.goal(),
            initial.reference_velocity,
            initial.integral,
            angle,
            velocity,
            integral,
        ];
        let x = x.map(A::Vector::splat);
        let (whole, rest) = moves.as_chunks_mut();
        let (of_whole, of_rest) = self.moves_of_units.split_at(whole.len());
        for (moves, of_units) in whole.iter_mut().zip(of_whole) {
            *moves = combined::<A>(of_units, &x);
        }
        for of_units in of_rest {
            rest.copy_from_slice(&combined::<A>(of_units, &x)[..rest.len()]);
        }
    }

    /// From the gradient of the cost, that of the cost to go in (θr, ωr, e), and the moves that answer it; the
    /// decrease of the cost to expect of the Newton step with the curvature without q_T.
    #[inline(always)]
    fn descend<A: Arithmetic>(&mut self) -> f64 {
        let (mut decrease, mut p) = (0.0, A::Vector::splat(0.0));
        let rows = self.step.iter_mut().zip(&self.governed);
        for ((step, governed), gradient) in rows.zip(&self.sensitivity.gradient).rev() {
            let [angle, velocity, by_move] = *gradient;
            p = governed.back::<A>(A::Vector::new(&[angle, velocity, 0.0, by_move]), p);
            let [.., slope] = p.lanes();
            *step = -governed.inverse * slope;
            decrease = A::mul_add(0.5 * governed.inverse * slope, slope, decrease);
        }
        decrease
    }

    /// [`Self::descend`] for the gradient of q_T alone, without the moves; ∫T² by the trapezoidal rule.
    #[inline(always)]
    fn promised_by_heat<A: Arithmetic>(
        &self,
        transcription: &Transcription,
        rollout: &Rollout,
    ) -> f64 {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let Problem {
            arm,
            motor,
            weights,
            ..
        } = transcription.problem();
        let per_torque = splat(2.0 / (motor.torque_constant * motor.torque_constant));
        let (damping, inertia, zero) = (splat(arm.damping), splat(arm.inertia), splat(0.0));
        let (mut load_price, mut decrease, mut p) = (0.0, 0.0, zero);
        for (interval, stretch) in transcription.stretches().rev() {
            let (elapsed, curved) = (vector(&interval.elapsed), vector(&interval.curved));
            let thermal = &interval.thermal;
            let (weights_of_heat, decay) =
                (per_torque * vector(thermal.weights()), thermal.decay());
            let weight = weights.thermal * interval.length;
            let loads = rollout.thermal_load[stretch.start..=stretch.end].windows(2);
            let rows = rollout.stages[stretch.clone()].iter().zip(loads);
            for ((stage, load), governed) in rows.zip(&self.governed[stretch]).rev() {
                let [before, after] = *load else { continue };
                load_price = A::mul_add(weight, after, load_price);
                let torque = splat(load_price) * weights_of_heat * vector(&stage.torque);
                load_price = A::mul_add(weight, before, decay * load_price);
                let by_angle = torque * vector(&stage.slope);
                let drag = torque * damping;
                let by_move = by_angle.mul_add(curved, drag * elapsed);
                let gradient = A::Vector::sums([
                    by_angle,
                    by_angle.mul_add(elapsed, drag),
                    zero,
                    torque.mul_add(inertia, by_move),
                ]);
                p = governed.back::<A>(gradient, p);
                let [.., slope] = p.lanes();
                decrease = A::mul_add(0.5 * governed.inverse * slope, slope, decrease);
            }
        }
        decrease
    }

    /// Completes the step by what the policies make of the states that it changes.
    #[inline(always)]
    fn complete_step<A: Arithmetic>(&mut self) {
        let mut x = [0.0; 3];
        for (step, governed) in self.step.iter_mut().zip(&self.governed) {
            let own = *step;
            for i in 0..3 {
                *step = A::mul_add(-governed.gain[i], x[i], *step);
            }
            x = governed.step.map(|[a, b, c, by_move]| {
                let free = A::mul_add(a, x[0], A::mul_add(b, x[1], c * x[2]));
                A::mul_add(by_move, own, free)
            });
        }
    }

    /// Adds `factor` times the step to the moves.
    fn add_step(&self, factor: f64, moves: &mut [f64]) {
        for (u, step) in moves.iter_mut().zip(&self.step) {
            *u += factor * step;
        }
    }
}

/// Σ x_i·of_units_i, `x` the same in all lanes.
#[inline(always)]
fn combined<A: Arithmetic>(
    of_units: &[[f64; LANES]; STATES],
    x: &[A::Vector; STATES],
) -> [f64; LANES] {
    let vector = A::Vector::new;
    let [a, b, c, d, e, f] = of_units;
    let reference = vector(c).mul_add(x[2], vector(b).mul_add(x[1], vector(a) * x[0]));
    let deviation = vector(f).mul_add(x[5], vector(e).mul_add(x[4], vector(d) * x[3]));
    (reference + deviation).lanes()
}

/// The moves that `policies` make of every unit of the state at the start.
fn moves_of_units(
    forms: &[Form<STATES>],
    policies: &[Policy<STATES>],
) -> Vec<[[f64; LANES]; STATES]> {
    let mut moves = vec![[[0.0; LANES]; STATES]; forms.len().div_ceil(LANES)];
    for unit in 0..STATES {
        let mut x = [0.0; STATES];
        x[unit] = 1.0;
        let dot = |row: &[f64; STATES], x: &[f64; STATES]| -> f64 {
            row.iter().zip(x).map(|(a, b)| a * b).sum()
        };
        for (k, (form, policy)) in forms.iter().zip(policies).enumerate() {
            let u = -dot(&policy.gain, &x);
            moves[k / LANES][unit][k % LANES] = u;
            x = std::array::from_fn(|i| dot(&form.a[i], &x) + form.b[i] * u);
        }
    }
    moves
}

/// The deadbeat policy of `angle` and `velocity` for the whole state, `left` \[s\] before the end and with
/// z at the end = `end`·z: rest of the arm, θr−θ_goal = −z_1 and ωr = −z_2.
fn imposed(angle: f64, velocity: f64, left: f64, end: &[[f64; 3]; 3]) -> [f64; STATES] {
    let mut gain = [angle, velocity, 0.0, 0.0, 0.0, 0.0];
    for i in 0..3 {
        let (end_angle, end_velocity) = (-end[0][i], -end[1][i]);
        // As in `Transcription::end_at_rest`: relative to coasting into the end.
        gain[3 + i] = -velocity * end_velocity + angle * (left * end_velocity - end_angle);
    }
    gain
}

struct Solve<'a> {
    unconstrained: &'a mut Unconstrained,
    transcription: &'a Transcription,
    moves: &'a mut [f64],
    rollout: &'a mut Rollout,
}

impl Kernel for Solve<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<A: Arithmetic>(self) -> bool {
        let Self {
            unconstrained,
            transcription,
            moves,
            rollout,
        } = self;
        unconstrained.solve_with::<A>(transcription, moves, rollout)
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{any_initial, pendulum, tflex};
    use super::*;
    use arm::Instructions;
    use proptest::prelude::*;

    proptest! {
        /// No other moves with the same end are cheaper: the gradient is zero along all that keep it.
        #[test]
        fn the_optimum_is_stationary(
            initial in any_initial(), goal in 0.1..1.4, flexure: bool, integral: bool, growth in prop_oneof![Just(1.0), 1.0..1.05],
            heat in prop_oneof![Just(1.0), 1.0..100.0],
        ) {
            let mut problem = if flexure { tflex() } else { pendulum() };
            problem.weights.thermal *= heat;
            problem.weights.integral = if integral { 1.0 } else { 0.0 };
            (problem.growth, problem.longest) = (growth, f64::INFINITY);
            let mut transcription = Transcription::new(problem, Instructions::best());
            transcription.set(initial, goal);
            let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            prop_assert!(unconstrained.solve(&transcription, &mut moves, &mut rollout));
            prop_assert!((rollout.angle[40] - goal).abs() < 1e-9);
            // What further Newton steps gain, to the end.
            let weight = problem.weights.thermal;
            let (mut best, mut better) = (moves.clone(), rollout.clone());
            for _ in 0..6 {
                let mut sensitivity = Sensitivity::new(40);
                transcription.differentiate(weight, &best, &better, &mut sensitivity);
                unconstrained.sensitivity = sensitivity;
                unconstrained.descend::<Separate>();
                unconstrained.complete_step::<Separate>();
                unconstrained.add_step(1.0, &mut best);
                transcription.roll_out(&best, &mut better);
            }
            let left = (rollout.cost - better.cost).max(0.0);
            prop_assert!(left <= 1.1e-8 * better.cost, "{left} of {}", better.cost);
            // Any change of a move, with the end kept.
            let optimum = rollout.cost;
            for k in [0, 7, 30, 37] {
                let change = |du: f64| {
                    let mut moves = moves.clone();
                    moves[k] += du;
                    transcription.end_at_rest(&mut moves);
                    let mut rollout = Rollout::new(40);
                    transcription.roll_out(&moves, &mut rollout);
                    rollout.cost - optimum
                };
                let (up, down) = (change(1e-2), change(-1e-2));
                prop_assert!(up > 0.0 && down > 0.0);
                // Cauchy–Schwarz: no slope is above that of the Newton step in units of their curvatures.
                let slope = 2.0 * (2.0 * left * (up + down)).sqrt();
                prop_assert!((up - down).abs() <= 1.1 * slope + 1e-3 * (up + down) + 1e-9 * optimum, "{k}: {up} {down}");
            }
        }

        /// Where the policies lead the gradient of q_T is the whole gradient.
        #[test]
        fn heat_promises_what_the_whole_cost_does(
            initial in any_initial(), goal in 0.1..1.4, flexure: bool, integral: bool, growth in prop_oneof![Just(1.0), 1.0..1.05],
            heat in 1e-6..1e-3_f64,
        ) {
            let mut problem = if flexure { tflex() } else { pendulum() };
            problem.weights.thermal = heat;
            problem.weights.integral = if integral { 1.0 } else { 0.0 };
            (problem.growth, problem.longest) = (growth, f64::INFINITY);
            let mut transcription = Transcription::new(problem, Instructions::Baseline);
            transcription.set(initial, goal);
            let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            unconstrained.follow_policies::<Separate>(&transcription, &mut moves);
            transcription.roll_out(&moves, &mut rollout);
            let promised = unconstrained.promised_by_heat::<Separate>(&transcription, &rollout);
            transcription.differentiate(heat, &moves, &rollout, &mut unconstrained.sensitivity);
            let expected = unconstrained.descend::<Separate>();
            prop_assert!(promised > 0.0);
            // But for the trapezoidal rule, beside what is asked of it.
            let most = 0.1 * (expected + SETTLED * rollout.cost);
            prop_assert!((promised - expected).abs() <= most, "{promised} {expected}");
        }

        /// The weight of the paper is too small for a step: the moves are those without it.
        #[test]
        fn the_thermal_weight_of_the_paper_takes_no_step(initial in any_initial(), goal in 0.95..1.5) {
            let plan = |weight: f64| {
                let mut problem = tflex();
                problem.weights.thermal = weight;
                let mut transcription = Transcription::new(problem, Instructions::best());
                transcription.set(initial, goal);
                let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
                let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
                unconstrained.solve(&transcription, &mut moves, &mut rollout);
                moves
            };
            prop_assert_eq!(plan(1e-6), plan(0.0));
        }

        /// ½·xᵀPx is the cost, where z = 0 and e = 0.
        #[test]
        fn the_price_is_the_cost_of_the_optimum(distance in -1.0..1.0_f64) {
            let mut transcription = Transcription::new(pendulum(), Instructions::best());
            let initial = super::super::problem::Initial {
                angle: 0.7 + distance,
                reference_angle: 0.7 + distance,
                ..Default::default()
            };
            transcription.set(initial, 0.7);
            let mut unconstrained = Unconstrained::new(&transcription).expect("definite");
            let (mut moves, mut rollout) = (vec![0.0; 40], Rollout::new(40));
            unconstrained.solve(&transcription, &mut moves, &mut rollout);
            let expected = unconstrained.cost_of_movement(distance);
            prop_assert!((rollout.cost - expected).abs() <= 1e-9 * expected);
        }
    }
}
