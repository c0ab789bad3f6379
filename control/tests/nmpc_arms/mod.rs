//! The paper's arms as planners see them, shared by the tests of the planner.

use arm::{Limits, Motor, Parameters};
use control::nmpc::plan::Plan;
use control::nmpc::planner::Planner;
use control::nmpc::problem::FeedbackModel;
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
}

/// What a controller of the paper plans with, the printed gains of its feedback included.
fn of(settings: &control::Settings) -> Arm {
    let feedback = &settings.feedback;
    Arm {
        settings: settings.nmpc,
        arm: settings.arm,
        motor: settings.motor,
        limits: settings.limits,
        feedback: FeedbackModel {
            inertia: feedback.inertia,
            gain_angle: feedback.gains.angle,
            gain_velocity: feedback.gains.velocity,
            gain_integral: 0.0,
            sample_period: 0.0,
        },
    }
}

/// Eqs 14, 29, 31.
pub fn tflex() -> Arm {
    of(&control::Settings::tflex())
}

/// Eqs 32 to 34; the controller's φ is mis-modelled.
pub fn pendulum() -> Arm {
    of(&control::Settings::pendulum())
}

/// No number of a plan is none.
#[allow(dead_code, reason = "every test file uses a part")]
pub fn assert_finite(plan: &Plan) {
    let nodes = [
        &plan.trajectory.angle,
        &plan.trajectory.reference_angle,
        &plan.trajectory.reference_velocity,
        &plan.trajectory.thermal_load,
    ];
    let mut all = nodes.into_iter().flatten();
    assert!(all.all(|x| x.is_finite()) && plan.trajectory.cost.is_finite());
    assert!(plan.moves.iter().all(|u| u.is_finite()));
}
