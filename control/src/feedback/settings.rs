//! Where the gains of the feedback come from: weights and a Riccati equation, or the user.

use arm::{Inadmissible, require};
use nalgebra::DMatrix;

use crate::riccati::{self, Unsolvable};

/// Law of the feedback.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// State feedback (eq 18).
    Lqr,
    /// State feedback with the integral of the tracking error (eqs 37, 38).
    Lqri,
    /// The form of [`Law::Lqri`] with the gains given: P = Kθ, I = Kint, D = Kω.
    Pid,
}

/// Where the gains of [`Law::Lqr`] and [`Law::Lqri`] come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Riccati equation with [`Settings::weights`] (eq 17).
    Weights,
    /// [`Settings::gains`].
    Gains,
}

/// Weights of the Riccati equation (eqs 17, 36).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// On the squared angle error \[1\].
    pub angle: f64,
    /// On the squared velocity error \[s²\].
    pub velocity: f64,
    /// On the squared integral of the angle error \[1/s²\]; only [`Law::Lqri`] has it.
    pub integral: f64,
    /// On the squared torque \[rad²/(N·m)²\].
    pub torque: f64,
}

/// Feedback gains (eqs 18, 38).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains {
    /// Kθ \[N·m/rad\].
    pub angle: f64,
    /// Kω \[N·m·s/rad\].
    pub velocity: f64,
    /// Kint \[N·m/(rad·s)\].
    pub integral: f64,
}

/// Set-up of the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Law.
    pub law: Law,
    /// Where the gains come from.
    pub design: Design,
    /// Weights, used if the gains come from them.
    pub weights: Weights,
    /// Gains, used if they are given.
    pub gains: Gains,
    /// Cut-off of the low-pass \[Hz\]; 0 switches it off.
    pub lowpass_frequency: f64,
    /// Inertia I of the design model \[kg·m²\] (eq 16).
    pub inertia: f64,
    /// Damping d of the design model \[N·m·s/rad\] (eq 16).
    pub damping: f64,
}

impl Settings {
    /// The gains of the law: designed or given.
    ///
    /// # Errors
    /// Every value in use that is not admissible, or the design weights if they admit no stabilising gains.
    pub fn resolve(&self) -> Result<Gains, Vec<Inadmissible>> {
        let mut errors = Vec::new();
        self.validate(&mut errors);
        if !errors.is_empty() {
            return Err(errors);
        }
        let given = self.gains;
        match (self.law, self.design) {
            (Law::Pid, _) | (Law::Lqri, Design::Gains) => Ok(given),
            (Law::Lqr, Design::Gains) => Ok(Gains {
                integral: 0.0,
                ..given
            }),
            (_, Design::Weights) => self.optimal().map_err(|reason| {
                vec![Inadmissible {
                    name: "feedback.weight_angle",
                    value: self.weights.angle,
                    admissible: format!(
                        "such that all of feedback.weight_* and feedback.inertia give gains; {reason}"
                    ),
                    unit: "1",
                }]
            }),
        }
    }

    /// Notes every value in use that is not admissible in `errors`.
    fn validate(&self, errors: &mut Vec<Inadmissible>) {
        let mut check = |name, value, range, unit| require(errors, name, value, range, unit);
        check(
            "feedback.lowpass_frequency",
            self.lowpass_frequency,
            [0.0, 1e6],
            "Hz",
        );
        check("feedback.inertia", self.inertia, [1e-9, 1e6], "kg.m2");
        check("feedback.damping", self.damping, [0.0, 1e6], "N.m.s/rad");
        if self.law == Law::Pid || self.design == Design::Gains {
            const GAIN: [f64; 2] = [0.0, 1e9];
            let Gains {
                angle,
                velocity,
                integral,
            } = self.gains;
            check("feedback.gain_angle", angle, GAIN, "N.m/rad");
            check("feedback.gain_velocity", velocity, GAIN, "N.m.s/rad");
            check("feedback.gain_integral", integral, GAIN, "N.m/(rad.s)");
            return;
        }
        // The Riccati equation must see the position: by its own weight, or by that of its integral.
        const POSITIVE: [f64; 2] = [1e-12, 1e12];
        const ANY: [f64; 2] = [0.0, 1e12];
        let integrates = self.law == Law::Lqri;
        let w = self.weights;
        let angle = if integrates { ANY } else { POSITIVE };
        let integral = if integrates { POSITIVE } else { ANY };
        check("feedback.weight_angle", w.angle, angle, "1");
        check("feedback.weight_velocity", w.velocity, ANY, "s2");
        check("feedback.weight_integral", w.integral, integral, "1/s2");
        check("feedback.weight_torque", w.torque, POSITIVE, "rad2/(N.m)2");
    }

    /// Gains from the Riccati equation of eq 16, augmented by eq 37 for [`Law::Lqri`] (eq 17).
    fn optimal(&self) -> Result<Gains, Unsolvable> {
        let n = if self.law == Law::Lqri { 3 } else { 2 };
        // States ε, dε/dt and e_L.
        let mut a = DMatrix::zeros(n, n);
        a[(0, 1)] = 1.0;
        a[(1, 1)] = -self.damping / self.inertia;
        let mut b = DMatrix::zeros(n, 1);
        b[1] = 1.0 / self.inertia;
        let mut q = DMatrix::zeros(n, n);
        q[(0, 0)] = self.weights.angle;
        q[(1, 1)] = self.weights.velocity;
        if n == 3 {
            a[(2, 0)] = 1.0;
            q[(2, 2)] = self.weights.integral;
        }
        let r = DMatrix::from_element(1, 1, self.weights.torque);
        let gain = riccati::solve(&a, &b, &q, &r)?.gain;
        Ok(Gains {
            angle: gain[0],
            velocity: gain[1],
            integral: if n == 3 { gain[2] } else { 0.0 },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gains(law: Law, weights: [f64; 4], inertia: f64, damping: f64) -> Gains {
        let [angle, velocity, integral, torque] = weights;
        let settings = Settings {
            law,
            weights: Weights {
                angle,
                velocity,
                integral,
                torque,
            },
            inertia,
            damping,
            ..Settings::pendulum()
        };
        settings.resolve().unwrap()
    }

    /// To all digits that the sources print: eqs 29, 33 and the gains that follow from eq 36.
    #[test]
    fn gains_of_the_paper() {
        let close = |got: f64, printed: f64, digit: f64| {
            assert!((got - printed).abs() <= 0.5 * digit, "{got} for {printed}");
        };
        let pendulum = Settings::pendulum().resolve().unwrap();
        close(pendulum.angle, 100.0, 1e-9);
        close(pendulum.velocity, 14.4914, 1e-4);

        let tflex = Settings::tflex().resolve().unwrap();
        close(tflex.angle, 31.623, 1e-3);
        close(tflex.velocity, 2.7541, 1e-4);

        let disturbed = gains(Law::Lqr, [1.0, 1e-3, 0.0, 1e-3], 1.0, 0.0);
        close(disturbed.angle, 31.623, 1e-3);
        close(disturbed.velocity, 8.0153, 1e-4);
        assert_eq!(disturbed.integral, 0.0);

        let integrating = gains(Law::Lqri, [1.0, 1e-3, 10.0, 1e-3], 1.0, 0.0);
        close(integrating.angle, 55.8929, 1e-4);
        close(integrating.velocity, 10.6201, 1e-4);
        close(integrating.integral, 100.0, 1e-9);
    }

    proptest! {
        /// Without the integral, eq 17 has the closed form Kθ = √(qθ/r), Kω = −d + √(d² + qω/r + 2·I·Kθ).
        #[test]
        fn state_feedback_has_its_closed_form(
            q_angle in 1e-3..1e3, q_velocity in 0.0..10.0, decade in -5.0..0.0,
            inertia in 1e-3..10.0, damping in 0.0..5.0,
        ) {
            let r = f64::powf(10.0, decade);
            let got = gains(Law::Lqr, [q_angle, q_velocity, 0.0, r], inertia, damping);
            let k_angle = f64::sqrt(q_angle / r);
            let under_root = damping * damping + q_velocity / r + 2.0 * inertia * k_angle;
            let k_velocity = -damping + f64::sqrt(under_root);
            prop_assert!((got.angle / k_angle - 1.0).abs() < 1e-9);
            prop_assert!((got.velocity / k_velocity - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn given_gains_are_used_as_given() {
        let given = Gains {
            angle: 5.0,
            velocity: 2.0,
            integral: 3.0,
        };
        let with = |law, design| {
            let settings = Settings {
                law,
                design,
                gains: given,
                ..Settings::tflex()
            };
            settings.resolve().unwrap()
        };
        assert_eq!(with(Law::Pid, Design::Weights), given);
        assert_eq!(with(Law::Lqri, Design::Gains), given);
        assert_eq!(with(Law::Lqr, Design::Gains).integral, 0.0);
    }

    #[test]
    fn only_values_in_use_are_checked_and_all_of_them_are_reported() {
        let mut settings = Settings::tflex();
        settings.gains.angle = f64::NAN;
        assert!(settings.resolve().is_ok());
        settings.weights.torque = 0.0;
        settings.weights.angle = 0.0;
        settings.inertia = -1.0;
        let names: Vec<_> = settings
            .resolve()
            .unwrap_err()
            .iter()
            .map(|e| e.name)
            .collect();
        assert_eq!(
            names,
            [
                "feedback.inertia",
                "feedback.weight_angle",
                "feedback.weight_torque"
            ]
        );
        settings.law = Law::Lqri;
        let names: Vec<_> = settings
            .resolve()
            .unwrap_err()
            .iter()
            .map(|e| e.name)
            .collect();
        assert!(names.contains(&"feedback.weight_integral"), "{names:?}");
    }

    #[test]
    fn extreme_admissible_weights_give_gains_or_an_error_but_never_nonsense() {
        for angle in [1e-12, 1.0, 1e12] {
            for torque in [1e-12, 1.0, 1e12] {
                for inertia in [1e-9, 1.0, 1e6] {
                    let settings = Settings {
                        weights: Weights {
                            angle,
                            torque,
                            ..Settings::tflex().weights
                        },
                        inertia,
                        damping: 0.0,
                        ..Settings::tflex()
                    };
                    if let Ok(gains) = settings.resolve() {
                        assert!((gains.angle / (angle / torque).sqrt() - 1.0).abs() < 1e-6);
                    }
                }
            }
        }
    }
}
