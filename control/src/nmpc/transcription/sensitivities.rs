//! First derivatives of the cost along a rollout.
//!
//! [`Transcription::differentiate`] eliminates e and T by their adjoints ν^e and ν^T: it returns
//! ∂cost/∂(θr, ωr, u) per interval and the price λ_j = ∂cost/∂q_j of heat. The cost of heat enters only
//! through q_T·T², so λ_j ≥ 0, and Σ λ_j·q_j is convex where τ is affine.

use arm::{Arithmetic, Kernel, Vector};

use super::Transcription;
use crate::nmpc::problem::Problem;
use crate::nmpc::rollout::{Rollout, Sensitivity};

impl Transcription {
    /// ∂cost/∂(θr, ωr, u) and the price of heat along `rollout` of `moves`, with the weight
    /// `weight_thermal`, which is q_T, or 0 to leave the cost of heat out.
    pub fn differentiate(
        &self,
        weight_thermal: f64,
        moves: &[f64],
        rollout: &Rollout,
        out: &mut Sensitivity,
    ) {
        self.instructions.run(Differentiate {
            transcription: self,
            weight_thermal,
            moves,
            rollout,
            out,
        });
    }

    /// [`Self::differentiate`] inside another kernel.
    #[inline(always)]
    pub fn differentiate_with<A: Arithmetic>(
        &self,
        weight_thermal: f64,
        moves: &[f64],
        rollout: &Rollout,
        out: &mut Sensitivity,
    ) {
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let Problem {
            arm,
            weights,
            motor,
            ..
        } = &self.problem;
        let per_torque = splat(2.0 / (motor.torque_constant * motor.torque_constant));
        let (damping, inertia) = (splat(arm.damping), splat(arm.inertia));
        let (mut integral_price, mut load_price) = (0.0, 0.0);
        let prices = out.gradient.iter_mut().zip(&mut out.heat_price);
        let intervals = rollout.stages.iter().zip(moves).zip(prices).enumerate();
        for (k, ((stage, &u), (gradient, heat_price))) in intervals.rev() {
            let interval = self.interval(k);
            let (elapsed, curved) = (vector(&interval.elapsed), vector(&interval.curved));
            let quadrature = vector(&interval.quadrature);
            let share = quadrature + quadrature;

            let price = interval.heat_price::<A>(stage, weight_thermal, &mut load_price);
            *heat_price = price.lanes();

            // Integral: e_j sees the distance of the stage before, e⁺ all of them.
            let mut by_distance = share * splat(weights.angle) * vector(&stage.distance);
            let mut by_integral = splat(0.0);
            if weights.integral > 0.0 {
                by_integral = share * splat(weights.integral) * vector(&stage.integral);
                let [_, second, third, last] = (by_integral * elapsed).lanes();
                by_distance = splat(integral_price).mul_add(quadrature, by_distance)
                    + vector(&[second, third, last, 0.0]);
            }
            let by_speed = share * splat(weights.velocity) * vector(&stage.velocity);
            let torque = price * per_torque * vector(&stage.torque);
            let slope = vector(&stage.slope);
            let by_angle = torque.mul_add(slope, by_distance);
            let drag = torque.mul_add(damping, by_speed);
            let effort = share * splat(weights.acceleration * u);
            let by_move = by_angle.mul_add(curved, drag.mul_add(elapsed, effort));
            let sums = A::Vector::sums([
                by_angle,
                by_angle.mul_add(elapsed, drag),
                torque.mul_add(inertia, by_move),
                by_integral,
            ]);
            let [angle, velocity, move_, integral] = sums.lanes();
            *gradient = [angle, velocity, move_];
            integral_price += integral;
        }
    }
}

struct Differentiate<'a> {
    transcription: &'a Transcription,
    weight_thermal: f64,
    moves: &'a [f64],
    rollout: &'a Rollout,
    out: &'a mut Sensitivity,
}

impl Kernel for Differentiate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arithmetic>(self) {
        let Self {
            transcription,
            weight_thermal,
            moves,
            rollout,
            out,
        } = self;
        transcription.differentiate_with::<A>(weight_thermal, moves, rollout, out);
    }
}
