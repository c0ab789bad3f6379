//! Set-up of a controller.

use arm::{Inadmissible, Limits, Motor, Parameters, require};

use crate::feedback;
use crate::nmpc::settings;

/// Who makes the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceSource {
    /// The nonlinear model predictive controller (sec 3.2.3).
    Nmpc,
    /// The third-order profile (sec 4.2).
    Profile,
}

/// Set-up of a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The arm as the controller knows it.
    pub arm: Parameters,
    /// The motor.
    pub motor: Motor,
    /// Hard limits of the joint.
    pub limits: Limits,
    /// Period Δ between two samples \[s\].
    pub sample_period: f64,
    /// Thermal load at the start \[A²\].
    pub initial_thermal_load: f64,
    /// Who makes the reference.
    pub reference: ReferenceSource,
    /// Peak acceleration of the profile \[rad/s²\] (eq 35).
    pub profile_max_acceleration: f64,
    /// The planner.
    pub nmpc: settings::Settings,
    /// The feedback.
    pub feedback: feedback::Settings,
}

impl Settings {
    /// Notes in `errors` what is not admissible among the settings that belong to no part of the controller.
    pub(crate) fn validate_own(&self, errors: &mut Vec<Inadmissible>) {
        let sample_period = self.sample_period;
        require(errors, "sample_period", sample_period, [1e-6, 1.0], "s");
        require(
            errors,
            "initial.thermal_load",
            self.initial_thermal_load,
            [0.0, 1e9],
            "A2",
        );
        require(
            errors,
            "profile.max_acceleration",
            self.profile_max_acceleration,
            [1e-6, 1e6],
            "rad/s2",
        );
        if self.nmpc.period < sample_period {
            errors.push(Inadmissible {
                name: "nmpc.period",
                value: self.nmpc.period,
                admissible: format!(">= sample_period = {sample_period}"),
                unit: "s",
            });
        }
    }
}
