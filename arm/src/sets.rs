//! Parameter sets of the paper.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use crate::parameters::{HARMONICS, Limits, Motor, Parameters};

impl Parameters {
    /// The T-flex (eqs 14, 56, 57).
    ///
    /// The paper does not print the cogging frequency; 9.72 is inferred from its remarks on fig 8,
    /// with the angle counted so that the middle of the workspace is 1.30 rad.
    pub const fn tflex() -> Self {
        Self {
            inertia: 0.0818,
            damping: 0.0161,
            stiffness: 1.76,
            offset: 1.07,
            hysteresis: 0.0732,
            cogging_frequency: 9.72,
            cogging_cos: [
                0.1172, -0.2366, 0.0746, -0.0354, 0.0043, -0.0091, -0.0094, 0.0013, 0.0005,
            ],
            cogging_sin: [
                -0.1447, -0.0494, 0.0189, 0.0015, -0.0210, -0.0079, 0.0027, -0.0228, 0.0031,
            ],
        }
    }

    /// The simplified pendulum (eqs 32, 33): gravity is the first cosine, the spring rests at 45°.
    pub const fn pendulum() -> Self {
        let mut cogging_cos = [0.0; HARMONICS];
        cogging_cos[0] = 1.0;
        Self {
            inertia: 1.0,
            damping: 0.0,
            stiffness: 3.0,
            offset: -3.0 * FRAC_PI_4,
            hysteresis: 0.0,
            cogging_frequency: 1.0,
            cogging_cos,
            cogging_sin: [0.0; HARMONICS],
        }
    }

    /// What the controller takes the pendulum for: 0.92 of its stiffness, 0.97 of its inertia (eq 32).
    pub const fn pendulum_mismodelled() -> Self {
        Self {
            inertia: 0.97,
            stiffness: 2.76,
            offset: -2.76 * FRAC_PI_4,
            ..Self::pendulum()
        }
    }
}

impl Motor {
    /// Motor of the T-flex (sec 3.2.3, appendix B.1).
    pub const fn tflex() -> Self {
        Self {
            torque_constant: 5.57,
            thermal_time_constant: 29.0,
            continuous_current: 3.92,
            peak_torque: 35.3,
        }
    }

    /// Motor of the pendulum (eq 33). The paper gives no peak torque; 100 N·m leaves the largest
    /// torque of the reference runs, 48 N·m, untouched.
    pub const fn pendulum() -> Self {
        Self {
            torque_constant: 1.25,
            peak_torque: 100.0,
            ..Self::tflex()
        }
    }
}

impl Limits {
    /// T-flex: setpoint range −20° to 12° about 1.30 rad (sec 3.1.1), widened by 0.025 rad.
    pub const fn tflex() -> Self {
        Self {
            angle_lower: 0.925_934_149_601_134_1,
            angle_upper: 1.534_439_510_239_319_6,
        }
    }

    /// Pendulum: a quarter turn (sec 4.1.2).
    pub const fn pendulum() -> Self {
        Self {
            angle_lower: 0.0,
            angle_upper: FRAC_PI_2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sets_are_admissible() {
        let mut errors = Vec::new();
        Parameters::tflex().validate(&mut errors);
        Parameters::pendulum().validate(&mut errors);
        Parameters::pendulum_mismodelled().validate(&mut errors);
        Motor::tflex().validate(&mut errors);
        Motor::pendulum().validate(&mut errors);
        Limits::tflex().validate(&mut errors);
        Limits::pendulum().validate(&mut errors);
        assert_eq!(errors, []);
    }

    /// eq 32: ff(θ) = cos(θ)·m·g − 0.92·(π/4 − θ)·k.
    #[test]
    fn pendulum_is_equation_32() {
        for angle in [0.0, 0.3, 1.0, 1.5] {
            let gravity = f64::cos(angle);
            let spring = (FRAC_PI_4 - angle) * 3.0;
            let true_torque = Parameters::pendulum().position_torque(angle);
            let modelled = Parameters::pendulum_mismodelled().position_torque(angle);
            assert!((true_torque - (gravity - spring)).abs() < 1e-14);
            assert!((modelled - (gravity - 0.92 * spring)).abs() < 1e-14);
        }
    }

    /// The remarks on fig 8 from which the cogging frequency is inferred.
    #[test]
    fn tflex_torque_falls_between_1_15_and_1_30_and_rises_at_1_40() {
        let slope = |angle| Parameters::tflex().at::<2>(angle)[1];
        for i in 0..=150 {
            let angle = 1.15 + 0.001 * f64::from(i);
            assert!(slope(angle) < 0.0, "slope at {angle}");
        }
        assert!(slope(1.4) > 0.0);
    }

    #[test]
    fn tflex_limits_are_the_setpoint_range_widened() {
        let limits = Limits::tflex();
        let lower = 1.30 - 20_f64.to_radians() - 0.025;
        let upper = 1.30 + 12_f64.to_radians() + 0.025;
        assert!((limits.angle_lower - lower).abs() < 1e-15);
        assert!((limits.angle_upper - upper).abs() < 1e-15);
    }
}
