//! Problems, starts and moves for the unit tests of this module.

use arm::{Limits, Motor, Parameters};
use proptest::prelude::*;

use super::problem::{FeedbackModel, Initial, Problem, Weights};
use super::settings::Settings;

/// The paper's T-flex (eqs 14, 29, 31).
pub fn tflex() -> Problem {
    let feedback = FeedbackModel {
        inertia: 0.0818,
        gain_angle: 31.62,
        gain_velocity: 2.756,
        gain_integral: 0.0,
    };
    Settings::default()
        .problem(
            &Parameters::tflex(),
            &Motor::tflex(),
            &Limits::tflex(),
            &feedback,
        )
        .expect("admissible")
}

/// Settings of the paper's pendulum (eq 34).
pub fn pendulum_settings() -> Settings {
    Settings {
        weights: Weights {
            angle: 1.0,
            velocity: 1e-3,
            integral: 0.0,
            thermal: 0.0,
            acceleration: 1e-4,
        },
        ..Settings::default()
    }
}

/// Feedback of the paper's pendulum (eq 33).
pub fn pendulum_feedback() -> FeedbackModel {
    FeedbackModel {
        inertia: 1.0,
        gain_angle: 100.0,
        gain_velocity: 14.4914,
        gain_integral: 0.0,
    }
}

/// The paper's pendulum (eqs 32 to 34).
pub fn pendulum() -> Problem {
    pendulum_settings()
        .problem(
            &Parameters::pendulum_mismodelled(),
            &Motor::pendulum(),
            &Limits::pendulum(),
            &pendulum_feedback(),
        )
        .expect("admissible")
}

/// Starts within the pendulum's workspace, a little off the reference.
pub fn any_initial() -> impl Strategy<Value = Initial> {
    (
        0.1..1.4,
        -1.0..1.0,
        -0.02..0.02,
        -0.2..0.2,
        -0.01..0.01,
        -0.1..0.1,
        0.0..11.0,
    )
        .prop_map(
            |(angle, velocity, error, velocity_error, feedback_integral, integral, load)| Initial {
                angle: angle + error,
                velocity: velocity + velocity_error,
                reference_angle: angle,
                reference_velocity: velocity,
                integral,
                feedback_integral,
                thermal_load: load,
            },
        )
}

/// Moves of a plausible size.
pub fn any_moves(horizon: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-20.0..20.0, horizon)
}
