//! From the variables of the contract to the settings of the controller.

use arm::Instructions;
use control::nmpc::settings::Method;
use control::{ReferenceSource, Settings};
use control::{feedback, nmpc};
use fmi_unit::Failure;

use crate::variables::{self as declared, Variables};

/// The settings that the parameters say. Errors: an enumeration value without an item.
pub fn settings(variables: &Variables) -> Result<Settings, Failure> {
    let (a, m, l) = (&variables.arm, &variables.motor, &variables.limits);
    Ok(Settings {
        arm: arm::Parameters {
            inertia: a.inertia,
            damping: a.damping,
            stiffness: a.stiffness,
            offset: a.offset,
            hysteresis: a.hysteresis,
            cogging_frequency: a.cogging_frequency,
            cogging_cos: a.cogging_cos,
            cogging_sin: a.cogging_sin,
        },
        motor: arm::Motor {
            torque_constant: m.torque_constant,
            thermal_time_constant: m.thermal_time_constant,
            continuous_current: m.continuous_current,
            peak_torque: m.peak_torque,
        },
        limits: arm::Limits {
            angle_lower: l.angle_lower,
            angle_upper: l.angle_upper,
        },
        sample_period: variables.sample_period,
        initial_thermal_load: variables.initial.thermal_load,
        reference: match item("reference.source", variables.reference.source)? {
            declared::ReferenceSource::Nmpc => ReferenceSource::Nmpc,
            declared::ReferenceSource::Profile => ReferenceSource::Profile,
        },
        profile_max_acceleration: variables.profile.max_acceleration,
        nmpc: planner(variables)?,
        feedback: feedback(variables)?,
    })
}

fn planner(variables: &Variables) -> Result<nmpc::settings::Settings, Failure> {
    let n = &variables.nmpc;
    Ok(nmpc::settings::Settings {
        period: n.period,
        horizon: n.horizon,
        duration: n.duration,
        deadline: n.deadline,
        latency: n.latency,
        models_latency: n.models_latency,
        model: match item("nmpc.model", n.model)? {
            declared::NmpcModel::Nonlinear => nmpc::problem::Model::Nonlinear,
            declared::NmpcModel::Qp => nmpc::problem::Model::Qp,
        },
        terminal: match item("nmpc.terminal", n.terminal)? {
            declared::NmpcTerminal::RestAtGoal => nmpc::problem::Terminal::RestAtGoal,
            declared::NmpcTerminal::SafeSet => nmpc::problem::Terminal::SafeSet,
            declared::NmpcTerminal::Free => nmpc::problem::Terminal::Free,
        },
        weights: nmpc::problem::Weights {
            angle: n.weight_angle,
            velocity: n.weight_velocity,
            integral: n.weight_integral,
            thermal: n.weight_thermal,
            acceleration: n.weight_acceleration,
        },
        angle_margin: n.angle_margin,
        thermal_share: n.thermal_share,
        thermal_limit: n.thermal_limit,
        models_feedback: n.models_feedback,
        models_integrator: n.models_integrator,
        solver: match item("nmpc.solver", n.solver)? {
            declared::NmpcSolver::Automatic => Method::Automatic,
            declared::NmpcSolver::Riccati => Method::Riccati,
            declared::NmpcSolver::Clarabel => Method::Clarabel,
        },
        instructions: instructions(variables)?,
    })
}

/// What plans are computed with. Errors: a value without an item.
pub fn instructions(variables: &Variables) -> Result<Instructions, Failure> {
    let set = variables.nmpc.instruction_set;
    Ok(match item("nmpc.instruction_set", set)? {
        declared::InstructionSet::Automatic => Instructions::best(),
        declared::InstructionSet::Baseline => Instructions::Baseline,
    })
}

fn feedback(variables: &Variables) -> Result<feedback::Settings, Failure> {
    let f = &variables.feedback;
    Ok(feedback::Settings {
        law: match item("feedback.law", f.law)? {
            declared::FeedbackLaw::Lqr => feedback::Law::Lqr,
            declared::FeedbackLaw::Lqri => feedback::Law::Lqri,
            declared::FeedbackLaw::Pid => feedback::Law::Pid,
        },
        design: match item("feedback.design", f.design)? {
            declared::FeedbackDesign::Weights => feedback::Design::Weights,
            declared::FeedbackDesign::Gains => feedback::Design::Gains,
        },
        weights: feedback::Weights {
            angle: f.weight_angle,
            velocity: f.weight_velocity,
            integral: f.weight_integral,
            torque: f.weight_torque,
        },
        gains: feedback::Gains {
            angle: f.gain_angle,
            velocity: f.gain_velocity,
            integral: f.gain_integral,
        },
        lowpass_frequency: f.lowpass_frequency,
        inertia: f.inertia,
        damping: f.damping,
    })
}

/// The item of an enumeration that a value stands for.
fn item<E: TryFrom<i64>>(name: &str, value: i64) -> Result<E, Failure> {
    E::try_from(value).map_err(|_| Failure(format!("{name} = {value} is none of its items")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_of_the_contract_are_the_tflex() {
        assert_eq!(settings(&Variables::default()), Ok(Settings::tflex()));
    }

    /// Refusals name items by number, which only the contract knows.
    #[test]
    fn refusals_name_the_items_of_the_contract() {
        for (ours, declared) in [
            (Method::Automatic, declared::NmpcSolver::Automatic),
            (Method::Riccati, declared::NmpcSolver::Riccati),
            (Method::Clarabel, declared::NmpcSolver::Clarabel),
        ] {
            assert_eq!(ours as i64, declared as i64);
        }
        let mut variables = Variables::default();
        variables.nmpc.model = declared::NmpcModel::Qp as i64;
        let settings = settings(&variables).expect("items");
        let refused = control::Controller::new(&settings)
            .err()
            .expect("riccati cannot");
        let message = refused[0].to_string();
        for item in [
            format!("{} (automatic)", declared::NmpcSolver::Automatic as i64),
            format!("{} (clarabel)", declared::NmpcSolver::Clarabel as i64),
            format!(
                "nmpc.model = {} (nonlinear)",
                declared::NmpcModel::Nonlinear as i64
            ),
            format!(
                "nmpc.terminal = {} (rest_at_goal)",
                declared::NmpcTerminal::RestAtGoal as i64
            ),
        ] {
            assert!(message.contains(&item), "{message}");
        }
    }
}
