//! Dahl hysteresis of the flexure (eq 13): a state z in [−1, 1] that follows the direction of motion.
//!
//! ```text
//! dz/dθ = (1 − sign(dθ)·z) / (2·δ)      δ = 1.5e-2 rad
//! ```

/// Displacement δ of eq 13 \[rad\].
pub const DISPLACEMENT: f64 = 1.5e-2;

/// z after the arm moved by `move_` \[rad\] (eq 13).
///
/// Eq 13 is an explicit Euler step and leaves [−1, 1] for moves beyond 2·δ; such a move counts as
/// 2·δ, which brings z to the end of its range.
pub fn update(z: f64, move_: f64) -> f64 {
    let share = (move_.abs() / (2.0 * DISPLACEMENT)).min(1.0);
    z + share * (move_.signum() - z)
}

/// dz/dt at velocity ω \[1/s\]: eq 13 in continuous time.
pub fn rate(z: f64, velocity: f64) -> f64 {
    (velocity - velocity.abs() * z) / (2.0 * DISPLACEMENT)
}

/// Change of [`rate`] with that of z and ω, each given as value and change \[1/s\].
pub fn rate_tangent((z, z_change): (f64, f64), (velocity, change): (f64, f64)) -> f64 {
    let direction = if velocity == 0.0 {
        0.0
    } else {
        velocity.signum()
    };
    ((1.0 - direction * z) * change - velocity.abs() * z_change) / (2.0 * DISPLACEMENT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn stays_within_one(z in -1.0..=1.0, move_ in -10.0..10.0) {
            let next = update(z, move_);
            prop_assert!((-1.0..=1.0).contains(&next), "{next}");
        }

        #[test]
        fn is_equation_13_for_moves_below_twice_the_displacement(
            z in -1.0..=1.0, move_ in -0.03..0.03_f64,
        ) {
            let printed = z + move_ / (2.0 * 1.5e-2) * (1.0 - move_.signum() * z);
            prop_assert!((update(z, move_) - printed).abs() < 1e-14);
        }

        /// Many small moves in one direction approach the exponential that solves eq 13.
        #[test]
        fn small_moves_converge_to_the_continuous_form(z in -1.0..=1.0, travel in -0.1..0.1_f64) {
            let exact = travel.signum()
                + (z - travel.signum()) * (-travel.abs() / (2.0 * DISPLACEMENT)).exp();
            let error = |n: u32| {
                let mut state = z;
                for _ in 0..n {
                    state = update(state, travel / f64::from(n));
                }
                (state - exact).abs()
            };
            prop_assert!(error(1000) < 1.5e-3);
            prop_assert!(error(10_000) < 1.5e-4);
        }

        #[test]
        fn rate_is_the_limit_of_the_update(z in -1.0..=1.0, velocity in -2.0..2.0) {
            let h = 1e-7;
            let difference = (update(z, velocity * h) - z) / h;
            prop_assert!((difference - rate(z, velocity)).abs() < 1e-5);
        }
    }

    #[test]
    fn rest_changes_nothing() {
        assert_eq!(update(0.3, 0.0), 0.3);
        assert_eq!(rate(0.3, 0.0), 0.0);
    }
}
