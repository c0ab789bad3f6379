//! What the settings ask of the motor's torque.

use arm::{Inadmissible, Limits, Motor, Parameters};

use super::super::problem::{Problem, Terminal};
use super::super::torque_bounds::{Scan, TorqueLimit};
use super::Settings;

impl Settings {
    /// The torque limit of the linear model (appendix C.3), which knows no heat: with a thermal limit the torque
    /// that may be given for ever, share·I_lim·Ki, so that the load never rises above the limit; the motor's
    /// peak without, or where that is less.
    pub(super) fn torque_limit(
        &self,
        arm: &Parameters,
        motor: &Motor,
        limits: &Limits,
    ) -> TorqueLimit {
        let scan = Scan::new(arm, limits.angle_lower, limits.angle_upper);
        let [lower, upper] = scan.affine_bounds();
        let for_ever = self.thermal_share * motor.continuous_current * motor.torque_constant;
        let most = if self.thermal_limit {
            motor.peak_torque.min(for_ever)
        } else {
            motor.peak_torque
        };
        TorqueLimit { most, lower, upper }
    }

    /// Notes a motor too weak for the problem: it must be able to hold the arm somewhere, or everywhere if the
    /// arm is to be stopped anywhere.
    pub(super) fn validate_torque(&self, problem: &Problem, errors: &mut Vec<Inadmissible>) {
        let (lower, upper) = (problem.angle_lower, problem.angle_upper);
        let motor = &problem.motor;
        if let Some(limit) = &problem.torque_limit {
            let least = limit.least(lower, upper);
            let thermal = limit.most < motor.peak_torque;
            if least > limit.most && thermal {
                errors.push(Inadmissible {
                    name: "nmpc.thermal_share",
                    value: self.thermal_share,
                    admissible: format!(
                        "at least {:.4}, for nmpc.model = qp to hold the arm somewhere by its bounds of the torque",
                        least / (motor.continuous_current * motor.torque_constant)
                    ),
                    unit: "1",
                });
            } else if least > limit.most {
                errors.push(too_weak(
                    motor,
                    least,
                    "somewhere by the bounds of nmpc.model = qp",
                ));
            }
        } else if self.terminal != Terminal::RestAtGoal {
            let [least, most] = Scan::new(&problem.arm, lower, upper.max(lower + 1e-9)).extremes();
            let needed = most.max(-least);
            if needed >= motor.peak_torque {
                errors.push(too_weak(motor, needed, "everywhere within its bounds"));
            }
        }
    }
}

/// A peak torque that cannot hold the arm `where_`, which takes `needed` \[N·m\].
fn too_weak(motor: &Motor, needed: f64, where_: &str) -> Inadmissible {
    Inadmissible {
        name: "motor.peak_torque",
        value: motor.peak_torque,
        admissible: format!("enough to hold the arm {where_}: more than {needed:.4}"),
        unit: "N.m",
    }
}
