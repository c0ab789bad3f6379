//! Linear and quadratic forms of an interval around a rollout. The four stages are the lanes of vectors; what
//! is summed over them is collected and summed four at a time.

use arm::{Arithmetic, Vector};

use super::LOAD;
use super::linear::{Curvature, Linear};
use crate::nmpc::linear_quadratic::Form;
use crate::nmpc::problem::Problem;
use crate::nmpc::rk4::{Interval, STAGES};
use crate::nmpc::rollout::Stages;
use crate::nmpc::solver::Task;

/// What all intervals have in common.
pub struct Assembly<'a> {
    problem: &'a Problem,
    /// Unit of the cost, inverted.
    scale: f64,
    /// 2/Ki².
    per_torque: f64,
    /// Whether to leave out what bends down.
    convex: bool,
}

impl<'a> Assembly<'a> {
    /// Of `task`, with all of the curvature of heat or its `convex` parts.
    pub fn new(task: &Task<'a>, convex: bool) -> Self {
        let problem = task.transcription.problem();
        let constant = problem.motor.torque_constant;
        Self {
            problem,
            scale: 1.0 / task.cost_scale,
            per_torque: 2.0 / (constant * constant),
            convex,
        }
    }

    /// Step and gradient of `interval`, to `linear`; its curvature; and the price of T at its start in its own
    /// cost. `form` is the cost but for heat, `load_price` that of T at its end.
    #[inline(always)]
    pub fn linearise<A: Arithmetic, const S: usize>(
        &self,
        interval: &Interval,
        form: &Form<S>,
        stage: &Stages,
        u: f64,
        load_price: f64,
        linear: &mut Linear<S>,
    ) -> (Curvature<S>, f64) {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let (arm, weights) = (&self.problem.arm, &self.problem.weights);
        let (h, thermal) = (interval.length, &interval.thermal);
        let (elapsed, curved) = (vector(&interval.elapsed), vector(&interval.curved));
        let share = splat(2.0 * self.scale) * vector(&interval.quadrature);

        // ∂τ/∂(θr, ωr, u), and ∂q/∂τ.
        let damping = splat(arm.damping);
        let angle = vector(&stage.slope);
        let velocity = angle.mul_add(elapsed, damping);
        let inertia = damping.mul_add(elapsed, splat(arm.inertia));
        let move_ = angle.mul_add(curved, inertia);
        let slope = splat(self.per_torque) * vector(&stage.torque);

        // Price of heat in the interval's own cost, and in all.
        let weight_heat = vector(thermal.weights());
        let mut own_load = 0.0;
        let own = interval.heat_price::<A>(stage, self.scale * weights.thermal, &mut own_load);
        let total = splat(load_price).mul_add(weight_heat, own);

        // The gradient of the cost.
        let mut by_distance = share * splat(weights.angle) * vector(&stage.distance);
        let mut by_integral = 0.0;
        if S > LOAD + 1 {
            // e_j sees the distance of the stage before.
            let by_sum = share * splat(weights.integral) * vector(&stage.integral);
            let [_, second, third, last] = (by_sum * elapsed).lanes();
            by_distance = by_distance + vector(&[second, third, last, 0.0]);
            by_integral = by_sum.sum();
        }
        let by_speed = share * splat(weights.velocity) * vector(&stage.velocity);
        let by_heat = own * slope;
        let by_velocity = by_distance.mul_add(elapsed, by_speed);
        let by_move = by_distance.mul_add(curved, by_speed * elapsed);

        // Curvature of heat.
        let bend = splat(self.per_torque) * total;
        let (bent_angle, bent_velocity) = (bend * angle, bend * velocity);
        let mut xx = [
            bent_angle * angle,
            bent_angle * velocity,
            bent_velocity * velocity,
        ];
        let mut xu = [bent_angle * move_, bent_velocity * move_];
        let mut uu = bend * move_ * move_;
        let mut bend = total * slope * vector(&stage.curvature);
        if self.convex {
            bend = bend.larger(splat(0.0));
        }
        let (timed, curving) = (bend * elapsed, bend * curved);
        xx[0] = xx[0] + bend;
        xx[1] = xx[1] + timed;
        xx[2] = timed.mul_add(elapsed, xx[2]);
        xu[0] = xu[0] + curving;
        xu[1] = curving.mul_add(elapsed, xu[1]);
        uu = curving.mul_add(curved, uu);
        let mut by_load = [0.0; STAGES];
        if weights.thermal > 0.0 {
            let per_load = share * splat(weights.thermal);
            // Curvature of T² in T, whose stages have seen the heat of those before.
            let warmed = [slope * angle, slope * velocity, slope * move_];
            let mut row = [splat(0.0); 3];
            for i in 0..3 {
                let [first, second, third, _] = warmed[i].lanes();
                row[i] = vector(&thermal.warming[0]) * splat(first);
                row[i] = vector(&thermal.warming[1]).mul_add(splat(second), row[i]);
                row[i] = vector(&thermal.warming[2]).mul_add(splat(third), row[i]);
            }
            let load = vector(thermal.stage_load());
            let [of_angle, of_velocity, of_move] = row;
            let (weighed_angle, weighed_velocity) = (per_load * of_angle, per_load * of_velocity);
            let (weighed_move, weighed_load) = (per_load * of_move, per_load * load);
            xx[0] = weighed_angle.mul_add(of_angle, xx[0]);
            xx[1] = weighed_angle.mul_add(of_velocity, xx[1]);
            xx[2] = weighed_velocity.mul_add(of_velocity, xx[2]);
            xu[0] = weighed_angle.mul_add(of_move, xu[0]);
            xu[1] = weighed_velocity.mul_add(of_move, xu[1]);
            uu = weighed_move.mul_add(of_move, uu);
            by_load = A::Vector::sums([
                weighed_load * of_angle,
                weighed_load * of_velocity,
                weighed_load * load,
                weighed_load * of_move,
            ])
            .lanes();
        }

        // The step of T and the gradient, then the curvature.
        let warming = weight_heat * slope;
        let [
            load_by_angle,
            load_by_velocity,
            load_by_move,
            gradient_angle,
        ] = A::Vector::sums([
            warming * angle,
            warming * velocity,
            warming * move_,
            by_heat.mul_add(angle, by_distance),
        ])
        .lanes();
        let [gradient_velocity, gradient_move, xu_angle, xu_velocity] = A::Vector::sums([
            by_heat.mul_add(velocity, by_velocity),
            by_heat.mul_add(move_, by_move),
            xu[0],
            xu[1],
        ])
        .lanes();
        let [angle_angle, angle_velocity, velocity_velocity, move_move] =
            A::Vector::sums([xx[0], xx[1], xx[2], uu]).lanes();

        linear.h = h;
        linear.load = [load_by_angle, load_by_velocity, thermal.decay()];
        linear.by_move = form.b;
        linear.by_move[LOAD] = load_by_move;
        linear.gradient[0] = gradient_angle;
        linear.gradient[1] = gradient_velocity;
        linear.gradient[LOAD] = own_load;
        let effort = 2.0 * self.scale * weights.acceleration * h;
        linear.gradient_by_move = A::mul_add(effort, u, gradient_move);
        if S > LOAD + 1 {
            linear.integral = [form.a[S - 1][0], form.a[S - 1][1]];
            linear.gradient[S - 1] = by_integral;
        }
        // Of the form only what is not zero: T has no part in it.
        let add = |form: f64, heat: f64| A::mul_add(form, self.scale, heat);
        let mut own = Curvature {
            xx: [[0.0; S]; S],
            xu: [0.0; S],
            uu: add(form.uu, move_move),
        };
        own.xx[0][0] = add(form.xx[0][0], angle_angle);
        own.xx[0][1] = add(form.xx[0][1], angle_velocity);
        own.xx[1][1] = add(form.xx[1][1], velocity_velocity);
        own.xu[0] = add(form.xu[0], xu_angle);
        own.xu[1] = add(form.xu[1], xu_velocity);
        [
            own.xx[0][LOAD],
            own.xx[1][LOAD],
            own.xx[LOAD][LOAD],
            own.xu[LOAD],
        ] = by_load;
        if S > LOAD + 1 {
            for r in [0, 1, S - 1] {
                own.xx[r][S - 1] = form.xx[r][S - 1] * self.scale;
            }
            own.xu[S - 1] = form.xu[S - 1] * self.scale;
        }
        (own, own_load)
    }
}
