//! Controllers of the paper.

use arm::{Limits, Motor, Parameters};

use crate::feedback::{self, Design, Gains, Law};
use crate::nmpc::problem::Weights;
use crate::nmpc::settings;
use crate::settings::{ReferenceSource, Settings};

impl Settings {
    /// The T-flex (sec 4.1.1).
    ///
    /// The paper's profile acceleration cannot be reconstructed from eq 35; 46.5 rad/s² is fitted to
    /// the ratios of its table 1.
    pub fn tflex() -> Self {
        Self {
            arm: Parameters::tflex(),
            motor: Motor::tflex(),
            limits: Limits::tflex(),
            sample_period: 2.5e-4,
            initial_thermal_load: 0.0,
            reference: ReferenceSource::Nmpc,
            profile_max_acceleration: 46.5,
            nmpc: settings::Settings::default(),
            feedback: feedback::Settings::tflex(),
        }
    }

    /// The simplified pendulum (sec 4.1.2), with the model errors of eq 32 and a warm motor.
    ///
    /// The profile acceleration is 0.85·I_lim·Ki − max g over the limits, divided by I (eq 35).
    pub fn pendulum() -> Self {
        Self {
            arm: Parameters::pendulum_mismodelled(),
            motor: Motor::pendulum(),
            limits: Limits::pendulum(),
            sample_period: 2.5e-4,
            initial_thermal_load: f64::powi(0.8 * 3.92, 2),
            reference: ReferenceSource::Nmpc,
            profile_max_acceleration: 1.9973,
            nmpc: settings::Settings {
                weights: Weights {
                    angle: 1.0,
                    velocity: 1e-3,
                    integral: 0.0,
                    thermal: 0.0,
                    acceleration: 1e-4,
                },
                ..settings::Settings::default()
            },
            feedback: feedback::Settings::pendulum(),
        }
    }
}

impl feedback::Settings {
    /// The LQR of the T-flex (sec 4.1.1): eq 29 with its low-pass.
    pub const fn tflex() -> Self {
        Self {
            law: Law::Lqr,
            design: Design::Weights,
            weights: feedback::Weights {
                angle: 1.0,
                velocity: 1.0 / 400.0,
                integral: 0.0,
                torque: 1e-3,
            },
            gains: Gains {
                angle: 31.62,
                velocity: 2.756,
                integral: 31.62,
            },
            lowpass_frequency: 150.0,
            inertia: 0.0818,
            damping: 0.0161,
        }
    }

    /// The LQR of the pendulum (eqs 33, 34).
    pub const fn pendulum() -> Self {
        Self {
            law: Law::Lqr,
            design: Design::Weights,
            weights: feedback::Weights {
                angle: 1.0,
                velocity: 1e-3,
                integral: 0.0,
                torque: 1e-4,
            },
            gains: Gains {
                angle: 100.0,
                velocity: 14.4914,
                integral: 100.0,
            },
            lowpass_frequency: 0.0,
            inertia: 1.0,
            damping: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pendulum_profile_is_equation_35() {
        let settings = Settings::pendulum();
        let largest = (0..=1000)
            .map(|i| settings.limits.angle_upper * f64::from(i) / 1000.0)
            .map(|angle| settings.arm.position_torque(angle))
            .fold(f64::MIN, f64::max);
        let acceleration = 0.85 * 3.92 * 1.25 - largest;
        assert!((settings.profile_max_acceleration - acceleration).abs() < 5e-5);
    }
}
