//! The reference that the arm follows.

use serde::{Deserialize, Serialize};

/// Reference of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// θr \[rad\].
    pub angle: f64,
    /// ωr \[rad/s\].
    pub velocity: f64,
    /// u \[rad/s²\].
    pub acceleration: f64,
}

impl Reference {
    /// Every component, in the order and units of the fields.
    pub(crate) fn numbers(&self) -> [f64; 3] {
        [self.angle, self.velocity, self.acceleration]
    }

    /// At rest at `angle` \[rad\].
    pub fn at_rest(angle: f64) -> Self {
        Self {
            angle,
            ..Self::default()
        }
    }

    /// The reference after its acceleration was held for `step` \[s\]; exact.
    pub fn advanced(self, step: f64) -> Self {
        Self {
            angle: self.angle + self.velocity * step + 0.5 * self.acceleration * step * step,
            velocity: self.velocity + self.acceleration * step,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn two_half_steps_are_one_step(
            angle in -2.0..2.0, velocity in -5.0..5.0, acceleration in -60.0..60.0, step in 0.0..0.1,
        ) {
            let start = Reference { angle, velocity, acceleration };
            let whole = start.advanced(step);
            let halves = start.advanced(0.5 * step).advanced(0.5 * step);
            prop_assert!((whole.angle - halves.angle).abs() < 1e-14);
            prop_assert!((whole.velocity - halves.velocity).abs() < 1e-14);
        }
    }
}
