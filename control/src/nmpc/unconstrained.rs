//! The plan without inequalities: the optimum as a policy, the yardstick and first guess of every solver,
//! and the final answer wherever it keeps the limits. Where the end need not be at rest the last two moves
//! follow the cheapest policy like all others.
//!
//! Without q_T the optimum is u_k = −K_k·(θr−θ_goal, ωr, e, z), with gains that depend on the problem alone
//! ([`super::linear_quadratic`]): a linear form of the start, known at set-up. With q_T Newton steps follow, with
//! the true gradient and the same curvature, which q_T·T² hardly bends, while one promises a decrease that counts:
//! with the weights of the paper none does. O(N) a plan.

mod closed_loop;
mod initial_response;

use arm::{Arithmetic, Kernel, Separate, Vector};

use self::closed_loop::ClosedLoop;
use self::initial_response::InitialResponse;
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

/// Minimiser of the cost subject to dynamics and terminal rest alone.
#[derive(Clone, Debug)]
pub struct Unconstrained {
    /// The intervals under their policies \[N\].
    closed: Vec<ClosedLoop>,
    /// P at the start.
    price: [[f64; STATES]; STATES],
    /// The moves of the policies.
    response: InitialResponse,
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
        let closed = forms.iter().zip(&policies);
        Some(Self {
            closed: closed
                .map(|(form, policy)| ClosedLoop::new(form, policy))
                .collect(),
            response: InitialResponse::new(&forms, &policies),
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
        let [angle, velocity, integral] = transcription.deviation().at(0);
        let start = [
            initial.reference_angle - transcription.goal(),
            initial.reference_velocity,
            initial.integral,
            angle,
            velocity,
            integral,
        ];
        self.response.write::<A>(start, moves);
    }

    /// From the gradient of the cost, that of the cost to go in (θr, ωr, e), and the moves that answer it; the
    /// decrease of the cost to expect of the Newton step with the curvature without q_T.
    #[inline(always)]
    fn descend<A: Arithmetic>(&mut self) -> f64 {
        let (mut decrease, mut p) = (0.0, A::Vector::splat(0.0));
        let rows = self.step.iter_mut().zip(&self.closed);
        for ((step, closed), gradient) in rows.zip(&self.sensitivity.gradient).rev() {
            let [angle, velocity, by_move] = *gradient;
            p = closed.back::<A>(A::Vector::new(&[angle, velocity, 0.0, by_move]), p);
            let [.., slope] = p.lanes();
            *step = -closed.inverse * slope;
            decrease = A::mul_add(0.5 * closed.inverse * slope, slope, decrease);
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
            for ((stage, load), closed) in rows.zip(&self.closed[stretch]).rev() {
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
                p = closed.back::<A>(gradient, p);
                let [.., slope] = p.lanes();
                decrease = A::mul_add(0.5 * closed.inverse * slope, slope, decrease);
            }
        }
        decrease
    }

    /// Completes the step by what the policies make of the states that it changes.
    #[inline(always)]
    fn complete_step<A: Arithmetic>(&mut self) {
        let mut x = [0.0; 3];
        for (step, closed) in self.step.iter_mut().zip(&self.closed) {
            let own = *step;
            for i in 0..3 {
                *step = A::mul_add(-closed.gain[i], x[i], *step);
            }
            x = closed.step.map(|[a, b, c, by_move]| {
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
mod tests;
