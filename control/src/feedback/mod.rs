//! Feedback on the tracking error (sec 3.2.2).
//!
//! Computed torque leaves the error of the angle with the linear dynamics of eq 16,
//!
//! ```text
//! I·d²ε/dt² = −d·dε/dt + fb      ε = θ − θr
//! ```
//!
//! and the feedback is fb = −Kθ·ε − Kω·dε/dt − Kint·e_L with de_L/dt = ε (eqs 18, 37, 38), low-passed.
//! All three laws have this form; they differ in where the gains come from.

mod settings;

use arm::Inadmissible;
use serde::{Deserialize, Serialize};

pub use settings::{Design, Gains, Law, Settings, Weights};

use crate::lowpass::Lowpass;

/// What changes in the feedback.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// e_L, integral of the tracking error \[rad·s\] (eq 37).
    pub integral: f64,
    /// Output of the low-pass \[N·m\].
    pub torque: f64,
}

/// The feedback, ready to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// Gains in use.
    pub gains: Gains,
    lowpass: Lowpass,
    sample_period: f64,
}

impl Feedback {
    /// Sets the feedback up for samples every `sample_period` \[s\].
    ///
    /// # Errors
    /// As [`Settings::resolve`].
    pub fn new(settings: &Settings, sample_period: f64) -> Result<Self, Vec<Inadmissible>> {
        Ok(Self {
            gains: settings.resolve()?,
            lowpass: Lowpass::new(settings.lowpass_frequency, sample_period),
            sample_period,
        })
    }

    /// Feedback torque of one sample \[N·m\] (eq 18) from the errors of angle \[rad\] and velocity \[rad/s\].
    /// The integral takes this sample's error into account from the next sample on.
    pub fn sample(&self, state: &mut State, angle_error: f64, velocity_error: f64) -> f64 {
        let Gains {
            angle,
            velocity,
            integral,
        } = self.gains;
        let torque = -angle * angle_error - velocity * velocity_error - integral * state.integral;
        state.torque = self.lowpass.next(state.torque, torque);
        state.integral += angle_error * self.sample_period;
        state.torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integral_removes_a_constant_disturbance() {
        let settings = Settings {
            law: Law::Lqri,
            weights: Weights {
                integral: 10.0,
                ..Settings::tflex().weights
            },
            ..Settings::tflex()
        };
        let h = 2.5e-4;
        let feedback = Feedback::new(&settings, h).unwrap();
        let (mut state, mut angle, mut velocity) = (State::default(), 0.0, 0.0);
        for _ in 0..40_000 {
            let torque = feedback.sample(&mut state, angle, velocity) + 1.0;
            velocity += h * (torque - settings.damping * velocity) / settings.inertia;
            angle += h * velocity;
        }
        assert!(f64::abs(angle) < 1e-9, "{angle}");
        assert!((state.torque + 1.0).abs() < 1e-9);
    }
}
