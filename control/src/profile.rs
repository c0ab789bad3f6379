//! Third-order motion profile between two rest points (sec 4.2).
//!
//! Four quarters of constant jerk ±j make two triangles of acceleration with peak a. The distance is
//! a·t²/8, so the motion takes t = √(8·|Δθ|/a) (eq 35).

use serde::{Deserialize, Serialize};

use crate::Reference;

/// Maker of profiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// Peak acceleration a \[rad/s²\].
    pub max_acceleration: f64,
    /// Period between two samples \[s\].
    pub sample_period: f64,
}

/// The motion under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Where it starts \[rad\].
    start: f64,
    /// Where it ends \[rad\].
    goal: f64,
    /// Samples since it started.
    samples: u64,
}

impl State {
    /// Both angles \[rad\].
    pub(crate) fn angles(&self) -> [f64; 2] {
        [self.start, self.goal]
    }

    /// At rest.
    pub fn at(angle: f64) -> Self {
        Self {
            start: angle,
            goal: angle,
            samples: 0,
        }
    }
}

impl Profile {
    /// The reference at this sample. A new setpoint starts a new motion at the *previous setpoint*, even
    /// if that was not reached yet: the reference then jumps, as it does in the paper (sec 4.3.1).
    pub fn sample(&self, state: &mut State, setpoint: f64) -> Reference {
        if setpoint != state.goal {
            *state = State {
                start: state.goal,
                goal: setpoint,
                samples: 0,
            };
        }
        let time = state.samples as f64 * self.sample_period;
        state.samples = state.samples.saturating_add(1);
        self.at(state.start, state.goal, time)
    }

    /// Duration of a motion over `distance` \[rad\], in s (eq 35).
    pub fn duration(&self, distance: f64) -> f64 {
        (8.0 * distance.abs() / self.max_acceleration).sqrt()
    }

    /// The motion from `start` to `goal` \[rad\], `time` \[s\] after its beginning.
    pub fn at(&self, start: f64, goal: f64, time: f64) -> Reference {
        let distance = goal - start;
        let duration = self.duration(distance);
        if time >= duration {
            return Reference::at_rest(goal);
        }
        let quarter = 0.25 * duration;
        let jerk = self.max_acceleration.copysign(distance) / quarter;
        // Point symmetric about its middle: the second half is the first one, backwards.
        let half = 0.5 * duration;
        let t = if time <= half { time } else { duration - time };
        let begun = if t <= quarter {
            Reference {
                angle: jerk * t.powi(3) / 6.0,
                velocity: jerk * t.powi(2) / 2.0,
                acceleration: jerk * t,
            }
        } else {
            let left = half - t;
            let peak = jerk * quarter.powi(2);
            Reference {
                angle: 0.5 * distance - peak * left + jerk * left.powi(3) / 6.0,
                velocity: peak - jerk * left.powi(2) / 2.0,
                acceleration: jerk * left,
            }
        };
        if time <= half {
            Reference {
                angle: start + begun.angle,
                ..begun
            }
        } else {
            Reference {
                angle: goal - begun.angle,
                velocity: begun.velocity,
                acceleration: -begun.acceleration,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PROFILE: Profile = Profile {
        max_acceleration: 2.0,
        sample_period: 2.5e-4,
    };

    proptest! {
        #[test]
        fn begins_and_ends_at_rest(start in -1.0..1.0, goal in -1.0..1.0) {
            let end = PROFILE.duration(goal - start);
            prop_assert_eq!(PROFILE.at(start, goal, 0.0).angle, start);
            prop_assert_eq!(PROFILE.at(start, goal, end), Reference::at_rest(goal));
            let nearly = PROFILE.at(start, goal, end * (1.0 - 1e-9));
            prop_assert!((nearly.angle - goal).abs() < 1e-9 && nearly.velocity.abs() < 1e-6);
        }

        /// Velocity and acceleration are the derivatives of the angle, the quarters' seams included.
        #[test]
        fn is_consistent_and_within_the_acceleration(
            start in -1.0..1.0_f64, goal in -1.0..1.0_f64, share in 0.01..0.99_f64,
        ) {
            prop_assume!((goal - start).abs() > 1e-2);
            let (time, h) = (share * PROFILE.duration(goal - start), 1e-5);
            let [before, now, after] = [-h, 0.0, h].map(|dt| PROFILE.at(start, goal, time + dt));
            let jerk_h = 4.0 * 2.0 / PROFILE.duration(goal - start) * h;
            prop_assert!(((after.angle - before.angle) / (2.0 * h) - now.velocity).abs() < 1e-6);
            let slope = (after.velocity - before.velocity) / (2.0 * h);
            prop_assert!((slope - now.acceleration).abs() < jerk_h + 1e-6);
            prop_assert!(now.acceleration.abs() <= 2.0);
        }
    }

    #[test]
    fn peak_acceleration_is_reached_after_a_quarter() {
        let duration = PROFILE.duration(0.5);
        assert!((duration - f64::sqrt(2.0)).abs() < 1e-15);
        assert!((PROFILE.at(0.0, 0.5, 0.25 * duration).acceleration - 2.0).abs() < 1e-12);
        assert!((PROFILE.at(0.0, 0.5, 0.75 * duration).acceleration + 2.0).abs() < 1e-12);
        assert!((PROFILE.at(0.0, 0.5, 0.5 * duration).angle - 0.25).abs() < 1e-12);
    }

    #[test]
    fn new_setpoint_restarts_at_the_previous_setpoint() {
        let mut state = State::at(0.2);
        assert_eq!(PROFILE.sample(&mut state, 1.0).angle, 0.2);
        for _ in 0..100 {
            PROFILE.sample(&mut state, 1.0);
        }
        assert_eq!(PROFILE.sample(&mut state, 0.5).angle, 1.0);
    }
}
