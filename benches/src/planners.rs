//! The planners under test: both arms of the paper, every solver by name.

use control::Settings;
use control::nmpc::planner::Planner;
use control::nmpc::problem::{FeedbackModel, Initial};
use control::nmpc::settings::Method;
use serde_json::Value;

use crate::Failure;

/// The arms by name.
pub const ARMS: [&str; 2] = ["pendulum", "tflex"];
/// The solvers by name; the first is the default of the settings.
pub const SOLVERS: [&str; 3] = ["automatic", "riccati", "clarabel"];

/// The paper's controller of `arm`.
pub fn settings(arm: &str) -> Result<Settings, Failure> {
    match arm {
        "pendulum" => Ok(Settings::pendulum()),
        "tflex" => Ok(Settings::tflex()),
        _ => Err(format!("no arm {arm:?}, only {ARMS:?}").into()),
    }
}

/// A planner for `arm` by `solver`.
pub fn planner(arm: &str, solver: &str) -> Result<Planner, Failure> {
    let mut settings = settings(arm)?;
    settings.nmpc.solver = match solver {
        "automatic" => Method::Automatic,
        "riccati" => Method::Riccati,
        "clarabel" => Method::Clarabel,
        _ => return Err(format!("no solver {solver:?}, only {SOLVERS:?}").into()),
    };
    let feedback = FeedbackModel {
        inertia: settings.feedback.inertia,
        gain_angle: settings.feedback.gains.angle,
        gain_velocity: settings.feedback.gains.velocity,
        gain_integral: 0.0,
    };
    let planner = Planner::new(
        &settings.nmpc,
        &settings.arm,
        &settings.motor,
        &settings.limits,
        &feedback,
    );
    Ok(planner.map_err(|errors| errors[0].to_string())?)
}

/// A start from (θ, ω, θr, ωr, e, T), the order of eq 23.
pub fn initial(x: &Value) -> Result<Initial, Failure> {
    let at = |i: usize| {
        x[i].as_f64()
            .ok_or_else(|| format!("component {i} of a start is missing"))
    };
    Ok(Initial {
        angle: at(0)?,
        velocity: at(1)?,
        reference_angle: at(2)?,
        reference_velocity: at(3)?,
        integral: at(4)?,
        feedback_integral: 0.0,
        thermal_load: at(5)?,
    })
}
