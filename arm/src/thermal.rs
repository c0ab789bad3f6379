//! Thermal load of the motor (eq 20): the square of the current, filtered by a first-order lag.
//!
//! ```text
//! dT/dt = ((τ/Ki)² − T)/T_tc ,   T ≤ I_lim²   (eq 19)
//! ```

use crate::elementary;
use crate::parameters::Motor;

/// dT/dt under a motor torque \[A²/s\].
pub fn rate(motor: &Motor, thermal_load: f64, torque: f64) -> f64 {
    (heating(motor, torque) - thermal_load) / motor.thermal_time_constant
}

/// Change of [`rate`] with that of T and of the torque, which is given as value and change \[A²/s\].
pub fn rate_tangent(motor: &Motor, load_change: f64, (torque, change): (f64, f64)) -> f64 {
    let constant = motor.torque_constant;
    (2.0 * torque * change / (constant * constant) - load_change) / motor.thermal_time_constant
}

/// T after the motor torque was held for `step` \[s\]: the exact solution of eq 20 \[A²\].
pub fn update(motor: &Motor, thermal_load: f64, torque: f64, step: f64) -> f64 {
    let missing = heating(motor, torque) - thermal_load;
    thermal_load - missing * elementary::expm1(-step / motor.thermal_time_constant)
}

/// (τ/Ki)² \[A²\].
fn heating(motor: &Motor, torque: f64) -> f64 {
    let current = torque / motor.torque_constant;
    current * current
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn update_is_exact_for_any_step(
            load in 0.0..20.0, torque in -40.0..40.0, step in 1e-4..100.0,
        ) {
            let motor = Motor::tflex();
            let whole = update(&motor, load, torque, step);
            let half = update(&motor, load, torque, 0.5 * step);
            let halves = update(&motor, half, torque, 0.5 * step);
            let current_squared = (torque / 5.57_f64).powi(2);
            let solution = current_squared + (load - current_squared) * (-step / 29.0).exp();
            prop_assert!((whole - halves).abs() < 1e-12);
            prop_assert!((whole - solution).abs() < 1e-12);
            prop_assert!(whole >= 0.0);
        }

        #[test]
        fn rate_is_the_limit_of_the_update(load in 0.0..20.0, torque in -40.0..40.0) {
            let motor = Motor::pendulum();
            let h = 1e-6;
            let difference = (update(&motor, load, torque, h) - load) / h;
            let rate = rate(&motor, load, torque);
            prop_assert!((difference - rate).abs() < 1e-6 * (1.0 + rate.abs()));
        }
    }

    #[test]
    fn the_continuous_current_leads_to_the_limit_and_no_further() {
        let motor = Motor::tflex();
        let torque = motor.continuous_current * motor.torque_constant;
        let load = update(&motor, 0.0, torque, 1e4);
        assert!((load - motor.thermal_limit()).abs() < 1e-12);
    }
}
