//! Problems, starts and moves for the unit tests of this module.

use proptest::prelude::*;

use super::problem::{FeedbackModel, Initial, Problem};
use crate::Settings;

/// Feedback of a controller as the plan knows it, with the printed gains.
pub fn feedback(settings: &Settings) -> FeedbackModel {
    FeedbackModel {
        inertia: settings.feedback.inertia,
        gain_angle: settings.feedback.gains.angle,
        gain_velocity: settings.feedback.gains.velocity,
        gain_integral: 0.0,
        sample_period: 0.0,
    }
}

fn problem(settings: &Settings) -> Problem {
    let Settings {
        arm, motor, limits, ..
    } = settings;
    let problem = settings
        .nmpc
        .problem(arm, motor, limits, &feedback(settings));
    problem.expect("admissible")
}

/// The paper's T-flex (eqs 14, 29, 31).
pub fn tflex() -> Problem {
    problem(&Settings::tflex())
}

/// The paper's pendulum (eqs 32 to 34).
pub fn pendulum() -> Problem {
    problem(&Settings::pendulum())
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
