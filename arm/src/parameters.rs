//! φ, motor and limits of an arm.

use crate::admissible::{Inadmissible, require};

/// Number of cogging harmonics in eq 12.
pub const HARMONICS: usize = 9;

/// Parameter vector φ of eq 12.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Moment of inertia J about the joint \[kg·m²\].
    pub inertia: f64,
    /// Viscous damping d \[N·m·s/rad\].
    pub damping: f64,
    /// Joint stiffness k, from angle zero \[N·m/rad\].
    pub stiffness: f64,
    /// Constant torque o \[N·m\].
    pub offset: f64,
    /// Amplitude C of the Dahl hysteresis torque \[N·m\].
    pub hysteresis: f64,
    /// Spatial frequency w of the first cogging harmonic \[1/rad\].
    pub cogging_frequency: f64,
    /// Cosine amplitudes a_1 to a_9 \[N·m\].
    pub cogging_cos: [f64; HARMONICS],
    /// Sine amplitudes b_1 to b_9 \[N·m\].
    pub cogging_sin: [f64; HARMONICS],
}

/// Motor and drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Torque constant Ki \[N·m/A\].
    pub torque_constant: f64,
    /// Time constant T_tc of the thermal load \[s\] (eq 20).
    pub thermal_time_constant: f64,
    /// Current I_lim that may flow for ever \[A\] (eq 19).
    pub continuous_current: f64,
    /// Torque beyond which the drive saturates \[N·m\].
    pub peak_torque: f64,
}

/// Hard limits of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lower limit of the angle \[rad\].
    pub angle_lower: f64,
    /// Upper limit of the angle \[rad\].
    pub angle_upper: f64,
}

impl Parameters {
    /// Notes every value that is not admissible in `errors`.
    pub fn validate(&self, errors: &mut Vec<Inadmissible>) {
        const TORQUE: [f64; 2] = [-1e6, 1e6];
        require(errors, "arm.inertia", self.inertia, [1e-9, 1e6], "kg.m2");
        require(errors, "arm.damping", self.damping, [0.0, 1e6], "N.m.s/rad");
        require(errors, "arm.stiffness", self.stiffness, TORQUE, "N.m/rad");
        require(errors, "arm.offset", self.offset, TORQUE, "N.m");
        require(errors, "arm.hysteresis", self.hysteresis, [0.0, 1e6], "N.m");
        require(
            errors,
            "arm.cogging_frequency",
            self.cogging_frequency,
            [0.0, 1e3],
            "1/rad",
        );
        for (name, value) in COS_NAMES.into_iter().zip(self.cogging_cos) {
            require(errors, name, value, TORQUE, "N.m");
        }
        for (name, value) in SIN_NAMES.into_iter().zip(self.cogging_sin) {
            require(errors, name, value, TORQUE, "N.m");
        }
    }
}

const COS_NAMES: [&str; HARMONICS] = [
    "arm.cogging_cos[1]",
    "arm.cogging_cos[2]",
    "arm.cogging_cos[3]",
    "arm.cogging_cos[4]",
    "arm.cogging_cos[5]",
    "arm.cogging_cos[6]",
    "arm.cogging_cos[7]",
    "arm.cogging_cos[8]",
    "arm.cogging_cos[9]",
];

const SIN_NAMES: [&str; HARMONICS] = [
    "arm.cogging_sin[1]",
    "arm.cogging_sin[2]",
    "arm.cogging_sin[3]",
    "arm.cogging_sin[4]",
    "arm.cogging_sin[5]",
    "arm.cogging_sin[6]",
    "arm.cogging_sin[7]",
    "arm.cogging_sin[8]",
    "arm.cogging_sin[9]",
];

impl Motor {
    /// Torque that the drive gives when asked for `torque` \[N·m\].
    pub fn saturate(&self, torque: f64) -> f64 {
        torque.clamp(-self.peak_torque, self.peak_torque)
    }

    /// Slope of [`Motor::saturate`]: 1 below the peak, 0 beyond.
    pub fn passes(&self, torque: f64) -> f64 {
        f64::from(u8::from(torque.abs() < self.peak_torque))
    }

    /// Largest admissible thermal load I_lim² \[A²\] (eq 19).
    pub fn thermal_limit(&self) -> f64 {
        self.continuous_current * self.continuous_current
    }

    /// What a thermal load leaves below its limit, negative beyond it \[A²\] (eq 19).
    pub fn thermal_margin(&self, thermal_load: f64) -> f64 {
        self.thermal_limit() - thermal_load
    }

    /// Notes every value that is not admissible in `errors`.
    pub fn validate(&self, errors: &mut Vec<Inadmissible>) {
        let mut positive = |name, value, lowest, unit| {
            require(errors, name, value, [lowest, 1e6], unit);
        };
        positive("motor.torque_constant", self.torque_constant, 1e-6, "N.m/A");
        positive(
            "motor.thermal_time_constant",
            self.thermal_time_constant,
            1e-3,
            "s",
        );
        positive(
            "motor.continuous_current",
            self.continuous_current,
            1e-6,
            "A",
        );
        positive("motor.peak_torque", self.peak_torque, 1e-6, "N.m");
    }
}

impl Limits {
    /// Whether `angle` lies within the limits.
    pub fn contains(&self, angle: f64) -> bool {
        (self.angle_lower..=self.angle_upper).contains(&angle)
    }

    /// What `angle` leaves above the lower and below the upper limit, negative beyond it \[rad\].
    pub fn margins(&self, angle: f64) -> [f64; 2] {
        [angle - self.angle_lower, self.angle_upper - angle]
    }

    /// Notes every value that is not admissible in `errors`.
    pub fn validate(&self, errors: &mut Vec<Inadmissible>) {
        let Self {
            angle_lower,
            angle_upper,
        } = *self;
        const RANGE: [f64; 2] = [-1e3, 1e3];
        require(errors, "limits.angle_lower", angle_lower, RANGE, "rad");
        require(errors, "limits.angle_upper", angle_upper, RANGE, "rad");
        if angle_upper <= angle_lower {
            errors.push(Inadmissible {
                name: "limits.angle_upper",
                value: angle_upper,
                admissible: format!("> limits.angle_lower = {angle_lower}"),
                unit: "rad",
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn every_value_that_is_not_admissible_is_reported_at_once() {
        let mut p = Parameters {
            inertia: 0.0,
            damping: f64::NAN,
            ..Parameters::tflex()
        };
        p.cogging_sin[8] = f64::INFINITY;
        let mut errors = Vec::new();
        p.validate(&mut errors);
        let motor = Motor {
            peak_torque: -1.0,
            ..Motor::tflex()
        };
        motor.validate(&mut errors);
        let limits = Limits {
            angle_lower: 1.0,
            angle_upper: 1.0,
        };
        limits.validate(&mut errors);
        let names: Vec<_> = errors.iter().map(|e| e.name).collect();
        assert_eq!(
            names,
            [
                "arm.inertia",
                "arm.damping",
                "arm.cogging_sin[9]",
                "motor.peak_torque",
                "limits.angle_upper",
            ]
        );
    }

    #[test]
    fn the_drive_saturates_on_both_sides() {
        let motor = Motor::tflex();
        assert_eq!(motor.saturate(1e3), 35.3);
        assert_eq!(motor.saturate(-1e3), -35.3);
        assert_eq!(motor.saturate(1.0), 1.0);
        assert_eq!([-1e3, 1.0, 1e3].map(|t| motor.passes(t)), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn margins_are_negative_beyond_the_limits() {
        let limits = Limits {
            angle_lower: -0.5,
            angle_upper: 1.0,
        };
        for (angle, margins) in [
            (0.0, [0.5, 1.0]),
            (1.5, [2.0, -0.5]),
            (-0.75, [-0.25, 1.75]),
        ] {
            assert_eq!(limits.margins(angle), margins);
            assert_eq!(limits.contains(angle), margins.iter().all(|m| *m >= 0.0));
        }
        let motor = Motor::tflex();
        assert_eq!(motor.thermal_margin(motor.thermal_limit() + 2.0), -2.0);
    }
}
