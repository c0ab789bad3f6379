//! The planners under test: both arms of the paper, every solver by name, and what they start from.

/// Shared with the planner's tests: one definition of what a start is.
#[path = "../../control/tests/nmpc_arms/starts.rs"]
pub mod draw;

use control::Settings;
use control::nmpc::planner::Planner;
use control::nmpc::problem::{FeedbackModel, Initial};
use control::nmpc::settings::Method;
use serde_json::Value;

use self::draw::{Class, FAR_OVER, OVER, RANDOM, STARVED, STARVED_FAST};
use crate::Failure;

/// The arms by name.
pub const ARMS: [&str; 2] = ["pendulum", "tflex"];
/// The solvers by name: the default, the one of another kind, and the second where the first fails.
pub const SOLVERS: [&str; 3] = ["riccati", "clarabel", "automatic"];

/// The paper's controller of `arm`, its plans by `solver`.
pub fn settings(arm: &str, solver: &str) -> Result<Settings, Failure> {
    let mut settings = match arm {
        "pendulum" => Settings::pendulum(),
        "tflex" => Settings::tflex(),
        _ => return Err(format!("no arm {arm:?}, only {ARMS:?}").into()),
    };
    settings.nmpc.solver = match solver {
        "automatic" => Method::Automatic,
        "riccati" => Method::Riccati,
        "clarabel" => Method::Clarabel,
        _ => return Err(format!("no solver {solver:?}, only {SOLVERS:?}").into()),
    };
    Ok(settings)
}

/// A planner for `arm` by `solver`.
pub fn planner(arm: &str, solver: &str) -> Result<Planner, Failure> {
    of(&settings(arm, solver)?)
}

/// The planner of a controller.
pub fn of(settings: &Settings) -> Result<Planner, Failure> {
    let feedback = FeedbackModel {
        inertia: settings.feedback.inertia,
        gain_angle: settings.feedback.gains.angle,
        gain_velocity: settings.feedback.gains.velocity,
        gain_integral: 0.0,
        // Others are given the same limit, of which nothing is kept back.
        sample_period: 0.0,
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

/// Classes of starts of `arm`.
pub fn classes(arm: &str) -> [Class; 4] {
    let starved = if arm == "tflex" {
        STARVED_FAST
    } else {
        STARVED
    };
    [RANDOM, starved, OVER, FAR_OVER]
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
