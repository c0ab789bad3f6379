//! Hybrid feedforward (sec 3.2.1): computed torque for what depends on the angle, feedforward for the rest.

use arm::Parameters;

use crate::Reference;

/// τ_ff = g_φ(θ) + C·z + d·ωr + J·u \[N·m\].
///
/// The terms of the angle are taken at the *measured* angle θ, because there they leave the feedback a
/// linear error system (eq 16); inertia and damping follow the reference, whose derivatives carry no noise.
pub fn torque(arm: &Parameters, angle: f64, hysteresis: f64, reference: &Reference) -> f64 {
    arm.position_torque(angle)
        + arm.hysteresis * hysteresis
        + arm.damping * reference.velocity
        + arm.inertia * reference.acceleration
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm::{Motor, plant};
    use proptest::prelude::*;

    proptest! {
        /// With the true φ, on the reference, the arm accelerates as the reference does.
        #[test]
        fn inverts_the_arm(
            angle in 0.95..1.5, velocity in -3.0..3.0, acceleration in -40.0..40.0, z in -1.0..1.0,
        ) {
            let p = Parameters::tflex();
            let reference = Reference { angle, velocity, acceleration };
            let torque = torque(&p, angle, z, &reference);
            let state = plant::State { angle, velocity, thermal_load: 0.0, hysteresis: z };
            let got = plant::acceleration(&p, &Motor::tflex(), &state, torque, 0.0);
            prop_assert!((got - acceleration).abs() < 1e-11);
        }
    }
}
