//! The state at the time when a plan is applied, predicted from that at which it is begun.
//!
//! A plan takes time. Until it is there the moves before it go on, so that the reference is known exactly;
//! the tracking error follows the feedback's linear model (eqs 22, 37), whatever the moves are; integral and
//! thermal load follow from both. All by the transcription that plans are made with, in steps of one sample:
//! feedback that is stable when sampled is stable in them.

use arm::{Instructions, Motor, Parameters};

use crate::nmpc::problem::{FeedbackModel, Initial, Model, Problem, Terminal, Weights};
use crate::nmpc::rk4::QUADRATURE;
use crate::nmpc::rollout::Rollout;
use crate::nmpc::transcription::Transcription;

/// Steps of a prediction at most.
const MOST_STEPS: usize = 4000;

/// Predicts over a fixed time.
pub struct Prediction {
    transcription: Transcription,
    moves: Vec<f64>,
    rollout: Rollout,
}

impl Prediction {
    /// Predicts `samples` > 0 of `sample_period` \[s\] ahead, with the whole feedback, whether plans know it or
    /// not.
    pub fn new(
        arm: &Parameters,
        motor: &Motor,
        feedback: &FeedbackModel,
        samples: usize,
        sample_period: f64,
    ) -> Self {
        let steps = samples.clamp(1, MOST_STEPS);
        let period = samples as f64 * sample_period / steps as f64;
        let problem = Problem {
            horizon: steps,
            period,
            growth: 1.0,
            longest: period,
            // The rollout counts e and T only where they have a weight.
            weights: Weights {
                angle: 0.0,
                velocity: 0.0,
                integral: 1.0,
                thermal: 1.0,
                acceleration: 0.0,
            },
            angle_lower: f64::NEG_INFINITY,
            angle_upper: f64::INFINITY,
            thermal_limit: None,
            arm: *arm,
            motor: *motor,
            feedback: *feedback,
            model: Model::Nonlinear,
            terminal: Terminal::Free,
            torque_limit: None,
        };
        Self {
            transcription: Transcription::new(problem, Instructions::Baseline),
            moves: vec![0.0; steps],
            rollout: Rollout::new(steps),
        }
    }

    /// The state after `initial`, the reference moving with `acceleration` \[rad/s²\], the integral counted
    /// from `goal` \[rad\]. O(steps).
    pub fn predict(&mut self, initial: &Initial, acceleration: f64, goal: f64) -> Initial {
        self.transcription.set(*initial, goal);
        self.moves.fill(acceleration);
        self.transcription.roll_out(&self.moves, &mut self.rollout);
        let rollout = &self.rollout;
        let end = self.moves.len();
        let [angle, velocity, feedback_integral] = self.transcription.deviation().at(end);
        let period = self.transcription.problem().period;
        let distances = rollout.stages.iter().map(|stage| {
            let weighted = stage.distance.iter().zip(QUADRATURE);
            weighted
                .map(|(distance, weight)| distance * weight * period)
                .sum::<f64>()
        });
        Initial {
            angle: rollout.reference_angle[end] + angle,
            velocity: rollout.reference_velocity[end] + velocity,
            reference_angle: rollout.reference_angle[end],
            reference_velocity: rollout.reference_velocity[end],
            integral: initial.integral + distances.sum::<f64>(),
            feedback_integral,
            thermal_load: rollout.thermal_load[end],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Reference, Settings};
    use arm::thermal;
    use proptest::prelude::*;

    proptest! {
        /// Against small Euler steps of eqs 20, 22 and 37.
        #[test]
        fn predictions_follow_the_model(
            error in -0.01..0.01, velocity in -1.0..1.0, acceleration in -5.0..5.0, samples in 4..200_usize,
            gain_velocity in prop_oneof![Just(2.756), Just(98.0)],
        ) {
            // The larger gain is too stiff for RK4 in steps of 5 ms.
            let settings = Settings::tflex();
            let model = FeedbackModel {
                inertia: 0.0818, gain_angle: 31.62, gain_velocity, gain_integral: 5.0, sample_period: 0.0,
            };
            let initial = Initial {
                angle: 1.2 + error, velocity: velocity + 0.1, reference_angle: 1.2,
                reference_velocity: velocity, integral: 0.3, feedback_integral: 0.01, thermal_load: 2.0,
            };
            let latency = samples as f64 * settings.sample_period;
            let mut prediction =
                Prediction::new(&settings.arm, &settings.motor, &model, samples, settings.sample_period);
            let predicted = prediction.predict(&initial, acceleration, 1.1);

            let (steps, mut x) = (20_000, initial);
            let h = latency / f64::from(steps);
            for _ in 0..steps {
                let [d, v] = [x.angle - x.reference_angle, x.velocity - x.reference_velocity];
                let feedback = -31.62 * d - gain_velocity * v - 5.0 * x.feedback_integral;
                let torque = settings.arm.position_torque(x.angle)
                    + settings.arm.damping * x.reference_velocity + settings.arm.inertia * acceleration;
                let reference = Reference {
                    angle: x.reference_angle, velocity: x.reference_velocity, acceleration,
                }.advanced(h);
                x = Initial {
                    angle: x.angle + h * x.velocity + 0.5 * h * h * acceleration,
                    velocity: x.velocity + h * (acceleration + feedback / model.inertia),
                    reference_angle: reference.angle,
                    reference_velocity: reference.velocity,
                    integral: x.integral + h * (x.angle - 1.1),
                    feedback_integral: x.feedback_integral + h * d,
                    thermal_load: thermal::update(&settings.motor, x.thermal_load, torque, h),
                };
            }
            for (got, expected, tolerance) in [
                (predicted.angle, x.angle, 2e-6), (predicted.velocity, x.velocity, 1e-4),
                (predicted.reference_angle, x.reference_angle, 1e-9),
                (predicted.reference_velocity, x.reference_velocity, 1e-9),
                (predicted.integral, x.integral, 1e-6),
                (predicted.feedback_integral, x.feedback_integral, 1e-6),
                (predicted.thermal_load, x.thermal_load, 1e-4),
            ] {
                prop_assert!((got - expected).abs() < tolerance, "{predicted:?} {x:?}");
            }
        }
    }
}
