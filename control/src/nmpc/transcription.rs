//! The transcription: how the optimal control problem becomes numbers. RK4 for dynamics and cost, one
//! step per shooting interval (eq 24), with every state eliminated that need not be a variable.
//!
//! # Exact reductions
//! Write h for the period and let j = 1..4 count the RK4 stages of an interval that starts at θr, ωr, e,
//! T and holds u.
//!
//! - **Deviation.** z = (θ−θr, ω−ωr, e_L) obeys dz/dt = F·z whatever u is: both rows of eq 22 get the same
//!   u, the feedback sees only their difference. Its stage values are M_j·z, its next value M_5·z, with
//!   M_j the RK4 polynomials of h·F: linear forms of the start, known at set-up.
//! - **Reference.** θr_j = θr + c_j·h·ωr + d_j·h²·u and ωr_j = ωr + c_j·h·u with c = (0, ½, ½, 1) and
//!   d = (0, 0, ¼, ½); the step itself is exact: θr⁺ = θr + h·ωr + h²·u/2.
//! - **Integral.** e_1 = e, e_2 = e + h/2·ϑ_1, e_3 = e + h/2·ϑ_2, e_4 = e + h·ϑ_3, with ϑ = θ − θ_goal.
//! - **Thermal load.** With q_j = (τ_j/Ki)² eq 20 is linear: T_j = α_j·T + Σ_i γ_ji·q_i and
//!   T⁺ = a·T + Σ_i w_i·q_i. All w_i are positive for h ≤ T_tc, hence "≥" in place of "=" is convex in τ.
//!
//! What remains free is (θr, ωr, e, T) and u. The cost of an interval is h/6·(L_1 + 2·L_2 + 2·L_3 + L_4).

mod sensitivities;

use std::ops::Range;

use arm::{Arithmetic, Instructions, Kernel, PositionTorque, Vector};

use super::deviation::Deviation;
use super::linear_quadratic::deadbeat;
use super::problem::{Initial, Problem};
use super::rk4::{CURVED, ELAPSED, Interval};
use super::rollout::{Rollout, Stages};

/// The problem in numbers, for one start and goal at a time.
#[derive(Clone, Debug)]
pub struct Transcription {
    problem: Problem,
    instructions: Instructions,
    /// g and its first two derivatives.
    position_torque: PositionTorque<3>,
    /// One for every shooting interval, or a single one if all are equally long.
    intervals: Vec<Interval>,
    initial: Initial,
    goal: f64,
    deviation: Deviation,
}

impl Transcription {
    /// Transcribes `problem`; start and goal are zero until [`Self::set`].
    pub fn new(problem: Problem, instructions: Instructions) -> Self {
        let horizon = problem.horizon;
        let intervals = Interval::all(&problem);
        Self {
            instructions,
            position_torque: PositionTorque::new(&problem.arm),
            deviation: Deviation::new(&intervals, horizon),
            intervals,
            initial: Initial::default(),
            goal: 0.0,
            problem,
        }
    }

    /// The problem.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How kernels are run.
    pub fn instructions(&self) -> Instructions {
        self.instructions
    }

    /// Interval `k`.
    #[inline(always)]
    pub fn interval(&self, k: usize) -> &Interval {
        &self.intervals[k.min(self.intervals.len() - 1)]
    }

    /// The intervals \[N\], or a single one if all are equally long.
    pub fn intervals(&self) -> &[Interval] {
        &self.intervals
    }

    /// Each interval with the range of k that it stands for: all if all are equal.
    #[inline(always)]
    pub fn stretches(&self) -> impl DoubleEndedIterator<Item = (&Interval, Range<usize>)> {
        let each = self.problem.horizon / self.intervals.len();
        let stretch = move |(index, interval)| (interval, index * each..(index + 1) * each);
        self.intervals.iter().enumerate().map(stretch)
    }

    /// h_k, length of interval `k`, the first and the last one repeated beyond the ends \[s\].
    pub fn length(&self, k: isize) -> f64 {
        let last = self.problem.horizon as isize - 1;
        self.interval(k.clamp(0, last) as usize).length
    }

    /// The goal \[rad\].
    pub fn goal(&self) -> f64 {
        self.goal
    }

    /// The start.
    pub fn initial(&self) -> &Initial {
        &self.initial
    }

    /// Sets start and goal, and precomputes the deviation.
    pub fn set(&mut self, initial: Initial, goal: f64) {
        self.initial = initial;
        self.goal = goal;
        let start = [
            initial.angle - initial.reference_angle,
            initial.velocity - initial.reference_velocity,
            initial.feedback_integral,
        ];
        self.instructions.run(Deviate(&mut self.deviation, start));
    }

    /// The deviation.
    pub fn deviation(&self) -> &Deviation {
        &self.deviation
    }

    /// (θr, ωr) at the end that put the arm to rest at the goal (eq 27) \[rad, rad/s\].
    pub fn terminal_reference(&self) -> [f64; 2] {
        let [angle, velocity, _] = self.deviation.at(self.problem.horizon);
        [self.goal - angle, -velocity]
    }

    /// Replaces the last two moves by those that lead to [`Self::terminal_reference`], N ≥ 2. O(N).
    pub fn end_at_rest(&self, moves: &mut [f64]) {
        let last = moves.len() - 1;
        let (mut angle, mut velocity) = (
            self.initial.reference_angle,
            self.initial.reference_velocity,
        );
        for (interval, stretch) in self.stretches() {
            let h = interval.length;
            let free = moves[..last - 1].iter().skip(stretch.start);
            for u in free.take(stretch.len()) {
                angle += h * velocity + 0.5 * h * h * u;
                velocity += h * u;
            }
        }
        let [end_angle, end_velocity] = self.terminal_reference();
        let (h, next) = (self.interval(last - 1).length, self.interval(last).length);
        // Both relative to coasting into the end.
        velocity -= end_velocity;
        angle += (h + next) * end_velocity - end_angle;
        let [first, second] = deadbeat(h, next);
        moves[last - 1] = -(first[0] * angle + first[1] * velocity);
        moves[last] = -second[1] * (velocity + h * moves[last - 1]);
    }

    /// Follows `moves` u \[N\] through the true model (eqs 22, 24, 28).
    pub fn roll_out(&self, moves: &[f64], rollout: &mut Rollout) {
        self.instructions.run(RollOut {
            transcription: self,
            moves,
            rollout,
        });
    }

    /// [`Self::roll_out`] inside another kernel, with the first `E` of g and its two derivatives. The stages
    /// of an interval are the lanes of vectors.
    #[inline(always)]
    pub fn roll_out_with<A: Arithmetic, const E: usize>(
        &self,
        moves: &[f64],
        rollout: &mut Rollout,
    ) {
        self.follow::<A>(moves, rollout);
        // Two intervals at a time, as their torque is a long chain of operations.
        let (pairs, rest) = rollout.stages.as_chunks_mut();
        for pair in pairs {
            self.add_position_torque::<A, 2, E>(pair);
        }
        for stage in rest {
            self.add_position_torque::<A, 1, E>(std::array::from_mut(stage));
        }
        self.heat::<A>(rollout);
    }

    /// Nodes, stages and cost, but for g, the thermal load and its cost.
    #[inline(always)]
    fn follow<A: Arithmetic>(&self, moves: &[f64], rollout: &mut Rollout) {
        let Problem { arm, weights, .. } = self.problem;
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let (damping, inertia) = (splat(arm.damping), splat(arm.inertia));
        let goal = self.goal;
        let initial = &self.initial;
        let (mut angle, mut velocity) = (initial.reference_angle, initial.reference_velocity);
        let mut integral = initial.integral;
        rollout.reference_angle[0] = angle;
        rollout.reference_velocity[0] = velocity;
        rollout.angle[0] = initial.angle;
        let weighs_integral = weights.integral > 0.0;
        let (mut cost, mut effort) = (splat(0.0), 0.0);
        for (interval, stretch) in self.stretches() {
            let (h, after) = (interval.length, stretch.start + 1..stretch.end + 1);
            let elapsed = vector(&interval.elapsed);
            let quadrature = vector(&interval.quadrature);
            let nodes = rollout.reference_angle[after.clone()].iter_mut();
            let nodes = nodes.zip(&mut rollout.reference_velocity[after.clone()]);
            let nodes = nodes.zip(&mut rollout.angle[after]);
            let stages = rollout.stages[stretch.clone()].iter_mut();
            let stages = stages.zip(&self.deviation.along()[stretch.clone()]);
            let stages = stages.zip(&moves[stretch]);
            for (((stage, deviation), &u), node) in stages.zip(nodes) {
                let move_ = splat(u);
                let curve = vector(&interval.curved).mul_add(move_, splat(angle - goal));
                let d = elapsed.mul_add(splat(velocity), curve) + vector(&deviation[0]);
                let reference_velocity = elapsed.mul_add(move_, splat(velocity));
                let v = reference_velocity + vector(&deviation[1]);
                let moving = damping.mul_add(reference_velocity, inertia * move_);
                let by_angle = splat(weights.angle) * d * d;
                let mut loss = (splat(weights.velocity) * v).mul_add(v, by_angle);
                stage.distance = d.lanes();
                stage.velocity = v.lanes();
                stage.torque = moving.lanes();
                if weighs_integral {
                    let [first, second, third, _] = stage.distance;
                    let seen = vector(&[0.0, first, second, third]);
                    let e = elapsed.mul_add(seen, splat(integral));
                    loss = (splat(weights.integral) * e).mul_add(e, loss);
                    stage.integral = e.lanes();
                    integral += (quadrature * d).sum();
                }
                cost = quadrature.mul_add(loss, cost);
                effort = A::mul_add(h * u, u, effort);

                angle += A::mul_add(0.5 * h * h, u, h * velocity);
                velocity = A::mul_add(h, u, velocity);
                let ((reference_angle, reference_velocity), true_angle) = node;
                (*reference_angle, *reference_velocity) = (angle, velocity);
                *true_angle = angle + deviation[2][0];
            }
        }
        rollout.cost = A::mul_add(weights.acceleration, effort, cost.sum());
    }

    /// Completes the torque of `M` intervals (eq 21), with the first `E` of g and its derivatives.
    #[inline(always)]
    fn add_position_torque<A: Arithmetic, const M: usize, const E: usize>(
        &self,
        stages: &mut [Stages; M],
    ) {
        let goal = A::Vector::splat(self.goal);
        let mut angle = [goal; M];
        for m in 0..M {
            angle[m] = A::Vector::new(&stages[m].distance) + goal;
        }
        let torque = self.position_torque.derivatives::<A, M, E>(angle);
        for m in 0..M {
            let stage = &mut stages[m];
            stage.torque = (torque[0][m] + A::Vector::new(&stage.torque)).lanes();
            if E > 1 {
                stage.slope = torque[1][m].lanes();
            }
            if E > 2 {
                stage.curvature = torque[2][m].lanes();
            }
        }
    }

    /// The thermal load along a rollout whose other states are known, and its cost (eqs 20, 21).
    #[inline(always)]
    fn heat<A: Arithmetic>(&self, rollout: &mut Rollout) {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let constant = self.problem.motor.torque_constant;
        let per_torque = splat(1.0 / (constant * constant));
        let price = self.problem.weights.thermal;
        let is_weighed = price > 0.0;
        let (mut load, mut cost) = (self.initial.thermal_load, splat(0.0));
        let (mut excess, mut total_excess) = (0.0, 0.0);
        rollout.thermal_load[0] = load;
        for (interval, stretch) in self.stretches() {
            let (thermal, quadrature) = (&interval.thermal, vector(&interval.quadrature));
            let nodes = &mut rollout.thermal_load[stretch.start + 1..stretch.end + 1];
            for (stage, node) in rollout.stages[stretch].iter_mut().zip(nodes) {
                let torque = vector(&stage.torque);
                let heat = per_torque * torque * torque;
                if is_weighed {
                    let mut t = vector(thermal.stage_load()) * splat(load);
                    for (warming, heat) in thermal.warming.iter().zip(heat.lanes()) {
                        t = vector(warming).mul_add(splat(heat), t);
                    }
                    cost = (quadrature * t).mul_add(t, cost);
                    stage.thermal_load = t.lanes();
                }
                let warmed = (vector(thermal.weights()) * heat).sum();
                load = A::mul_add(thermal.decay(), load, warmed);
                *node = load;
                let beyond = load - interval.thermal_limit;
                let above = if beyond > 0.0 { beyond } else { 0.0 };
                excess = if above > excess { above } else { excess };
                total_excess += above;
            }
        }
        rollout.cost = A::mul_add(price, cost.sum(), rollout.cost);
        (rollout.excess, rollout.total_excess) = (excess, total_excess);
    }

    /// ∂τ_j/∂(θr, ωr, u) of a stage of an interval of length `h`, g linearised at the stage (eq 21).
    #[inline(always)]
    pub fn torque_gradient(&self, stage: &Stages, h: f64, j: usize) -> [f64; 3] {
        let (arm, time) = (&self.problem.arm, ELAPSED[j] * h);
        let slope = stage.slope[j];
        [
            slope,
            slope * time + arm.damping,
            slope * CURVED[j] * h * h + arm.damping * time + arm.inertia,
        ]
    }
}

/// Sets the deviation at the start.
struct Deviate<'a>(&'a mut Deviation, [f64; 3]);

impl Kernel for Deviate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        self.0.set::<A>(self.1);
    }
}

struct RollOut<'a> {
    transcription: &'a Transcription,
    moves: &'a [f64],
    rollout: &'a mut Rollout,
}

impl Kernel for RollOut<'_> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        self.transcription
            .roll_out_with::<A, 3>(self.moves, self.rollout);
    }
}

#[cfg(test)]
mod tests;
