//! The paper's arms as planners see them, shared by the tests of the planner.
#![allow(dead_code)]

use arm::{Limits, Motor, Parameters};
use control::nmpc::planner::Planner;
use control::nmpc::problem::{FeedbackModel, Weights};
use control::nmpc::settings::Settings;

/// All a planner is made of.
#[derive(Clone)]
pub struct Arm {
    pub settings: Settings,
    pub arm: Parameters,
    pub motor: Motor,
    pub limits: Limits,
    pub feedback: FeedbackModel,
}

impl Arm {
    pub fn planner(&self) -> Planner {
        Planner::new(
            &self.settings,
            &self.arm,
            &self.motor,
            &self.limits,
            &self.feedback,
        )
        .expect("admissible settings")
    }

    /// Thermal limit of the plan (eq 26) [A²].
    pub fn thermal_limit(&self) -> f64 {
        (self.settings.thermal_share * self.motor.continuous_current).powi(2)
    }
}

/// Eqs 14, 29, 31.
pub fn tflex() -> Arm {
    Arm {
        settings: Settings::default(),
        arm: Parameters::tflex(),
        motor: Motor::tflex(),
        limits: Limits::tflex(),
        feedback: FeedbackModel {
            inertia: 0.0818,
            gain_angle: 31.62,
            gain_velocity: 2.756,
            gain_integral: 0.0,
        },
    }
}

/// Eqs 32 to 34; the controller's φ is mis-modelled.
pub fn pendulum() -> Arm {
    Arm {
        settings: Settings {
            weights: Weights {
                angle: 1.0,
                velocity: 1e-3,
                integral: 0.0,
                thermal: 0.0,
                acceleration: 1e-4,
            },
            ..Settings::default()
        },
        arm: Parameters::pendulum_mismodelled(),
        motor: Motor::pendulum(),
        limits: Limits::pendulum(),
        feedback: FeedbackModel {
            inertia: 1.0,
            gain_angle: 100.0,
            gain_velocity: 14.4914,
            gain_integral: 0.0,
        },
    }
}
