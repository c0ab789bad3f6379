//! What signals mean to scoring and plotting.

use super::Side;
use serde::{Deserialize, Serialize};

/// What a signal means to scoring and plotting.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Angle of the arm \[rad\].
    Angle,
    /// Torque asked of the motor \[N·m\].
    Torque,
    /// Thermal load \[A²\].
    ThermalLoad,
    /// Thermal load divided by its limit.
    ThermalFraction,
    /// Count of samples at which a limit was violated.
    Violations,
    /// Angle of the reference \[rad\].
    ReferenceAngle,
    /// Torque of the feedforward \[N·m\].
    FeedforwardTorque,
    /// Torque of the feedback \[N·m\].
    FeedbackTorque,
    /// How the plan in use came to be (enumeration).
    PlanStatus,
    /// Iterations of the latest plan.
    PlanIterations,
}

/// The names of the contract for each role, the first that exists counts.
pub(super) const DEFAULT_ROLES: [(Role, Side, &str); 11] = [
    (Role::Angle, Side::Plant, "angle"),
    (Role::Torque, Side::Controller, "torque"),
    (Role::ThermalLoad, Side::Plant, "thermal_load"),
    (Role::ThermalLoad, Side::Controller, "thermal_load"),
    (Role::ThermalFraction, Side::Plant, "thermal_fraction"),
    (Role::Violations, Side::Plant, "violations"),
    (Role::ReferenceAngle, Side::Controller, "reference.angle"),
    (
        Role::FeedforwardTorque,
        Side::Controller,
        "feedforward_torque",
    ),
    (Role::FeedbackTorque, Side::Controller, "feedback_torque"),
    (Role::PlanStatus, Side::Controller, "nmpc.status"),
    (Role::PlanIterations, Side::Controller, "nmpc.iterations"),
];
