//! Setpoints from which an arm overshoots up to the limits of its angle, but not beyond.
//!
//! On feedback alone an arm overshoots about in proportion to the length of a move. What one experiment shows
//! decides where the setpoints of the next one end. Where an arm leaves its range all the same, the experiment stops
//! there and is repeated with setpoints further inside.

use super::bench::START;
use super::experiment::Failed;
use crate::Error;
use crate::input::setpoints::AngleLimits;

/// Runs of an experiment until one keeps the range, at most.
const ATTEMPTS: u32 = 6;
/// The first repetition expects so much more overshoot; each further one twice as much more as the one before.
const MORE: f64 = 0.1;
/// Overshoot that is always expected: noise and friction leave no arm without.
const LEAST: f64 = 0.01;

/// How far the angle goes beyond the lower and the upper end of its setpoints, by the distance between both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overshoot {
    pub(super) below: f64,
    pub(super) above: f64,
}

/// An experiment that kept the range.
#[derive(Debug)]
pub(super) struct Kept<T> {
    pub(super) result: T,
    /// Ends of the setpoints \[rad\].
    pub(super) ends: AngleLimits,
    /// How often it was run.
    pub(super) attempts: u32,
}

impl Overshoot {
    /// Of an arm that nothing is known of: half the length of a move, so that setpoints keep to the middle half.
    pub(super) const UNKNOWN: Self = Self {
        below: 0.5,
        above: 0.5,
    };

    /// What angles \[rad\] show whose setpoints reached both ends.
    pub(super) fn seen(ends: AngleLimits, angles: &[f64]) -> Self {
        let length = ends.upper - ends.lower;
        let lowest = angles.iter().copied().fold(ends.lower, f64::min);
        let highest = angles.iter().copied().fold(ends.upper, f64::max);
        Self {
            below: (ends.lower - lowest) / length,
            above: (highest - ends.upper) / length,
        }
    }

    /// Times `factor`.
    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            below: factor * self.below,
            above: factor * self.above,
        }
    }

    /// Ends of setpoints from which an arm overshoots just to the ends of `range` \[rad\].
    fn ends(self, range: AngleLimits) -> AngleLimits {
        let [below, above] = [self.below, self.above].map(|part| part.max(LEAST));
        let length = (range.upper - range.lower) / (1.0 + below + above);
        AngleLimits {
            lower: range.lower + below * length,
            upper: range.upper - above * length,
        }
    }

    /// What to expect after `attempts` runs, of which the last one left the range at `angle` \[rad\].
    fn after_leaving(self, angle: f64, range: AngleLimits, attempts: u32) -> Self {
        let factor = 1.0 + MORE * 2.0_f64.powi(attempts as i32 - 1);
        let more = |part: f64, left: bool| {
            if left { factor * part.max(LEAST) } else { part }
        };
        Self {
            below: more(self.below, angle < range.lower),
            above: more(self.above, angle > range.upper),
        }
    }
}

/// Runs an experiment with setpoints inside `range` \[rad\] until the angle keeps `range`.
///
/// # Errors
/// Those of the experiment; [`Error::LeftRange`] of its last run if no run kept the range, or of the first one if the
/// arm left it while it should have rested: setpoints do not change that.
pub(super) fn keep_range<T>(
    range: AngleLimits,
    expected: Overshoot,
    mut run: impl FnMut(AngleLimits) -> Result<T, Failed>,
) -> Result<Kept<T>, Failed> {
    let mut overshoot = expected;
    let mut attempts = 1;
    loop {
        let ends = overshoot.ends(range);
        let failed = match run(ends) {
            Ok(result) => {
                return Ok(Kept {
                    result,
                    ends,
                    attempts,
                });
            }
            Err(failed) => failed,
        };
        match *failed.error {
            Error::LeftRange { angle, time, .. } if time > START && attempts < ATTEMPTS => {
                overshoot = overshoot.after_leaving(angle, range, attempts);
                attempts += 1;
            }
            _ => return Err(failed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RANGE: AngleLimits = AngleLimits {
        lower: 0.9,
        upper: 1.5,
    };

    /// An arm that overshoots by shares of the distance between the ends, and stops where it leaves the range.
    fn arm(overshoot: Overshoot, ends: AngleLimits) -> Result<[f64; 2], Failed> {
        let length = ends.upper - ends.lower;
        let angles = [
            ends.lower - overshoot.below * length,
            ends.upper + overshoot.above * length,
        ];
        match angles.into_iter().find(|angle| !RANGE.contains(*angle)) {
            None => Ok(angles),
            Some(angle) => Err(left(angle, START + 1.0)),
        }
    }

    fn left(angle: f64, time: f64) -> Failed {
        Failed::from(Error::LeftRange {
            angle,
            time,
            limits: RANGE,
        })
    }

    #[test]
    fn nothing_known_means_the_middle_half() {
        let ends = Overshoot::UNKNOWN.ends(RANGE);
        assert!((ends.lower - 1.05).abs() < 1e-12 && (ends.upper - 1.35).abs() < 1e-12);
    }

    proptest! {
        /// What was seen takes the arm exactly to both limits.
        #[test]
        fn what_was_seen_is_used_up(below in LEAST..1.0, above in LEAST..1.0, low in -1.0..0.0, high in 0.1..2.0) {
            let truth = Overshoot { below, above };
            let elsewhere = AngleLimits { lower: low, upper: high };
            let length = high - low;
            let angles = [low - below * length, 0.5 * (low + high), high + above * length];
            let ends = Overshoot::seen(elsewhere, &angles).ends(RANGE);
            let length = ends.upper - ends.lower;
            prop_assert!((ends.lower - truth.below * length - RANGE.lower).abs() < 1e-12);
            prop_assert!((ends.upper + truth.above * length - RANGE.upper).abs() < 1e-12);
        }

        /// An arm that overshoots up to twice as far as expected is kept inside all the same, each attempt further
        /// inside than the one before; beyond that it may take all attempts.
        #[test]
        fn attempts_contract_until_the_range_is_kept(
            below in 0.0..0.3_f64, above in 0.0..0.3_f64, wrong in 1.0..6.0_f64,
        ) {
            let truth = Overshoot { below, above };
            let expected = truth.times(1.0 / wrong);
            let mut lengths = Vec::new();
            let kept = keep_range(RANGE, expected, |ends| {
                lengths.push(ends.upper - ends.lower);
                arm(truth, ends)
            });
            // One side alone may take all attempts.
            let kept = match kept {
                Ok(kept) => kept,
                Err(_) => {
                    prop_assert_eq!(lengths.len(), ATTEMPTS as usize);
                    prop_assert!(wrong > 2.0);
                    return Ok(());
                }
            };
            prop_assert!(kept.result.iter().all(|angle| RANGE.contains(*angle)));
            prop_assert_eq!(kept.attempts as usize, lengths.len());
            prop_assert!(lengths.windows(2).all(|pair| pair[1] < pair[0]));
        }
    }

    #[test]
    fn attempts_are_bounded_and_runaways_are_not_repeated() {
        for (time, runs) in [(START + 0.1, ATTEMPTS), (0.5 * START, 1)] {
            let mut count = 0;
            let kept = keep_range(RANGE, Overshoot::UNKNOWN, |_| {
                count += 1;
                Err::<(), _>(left(2.0, time))
            });
            assert!(matches!(*kept.unwrap_err().error, Error::LeftRange { .. }));
            assert_eq!(count, runs);
        }
        // Other errors are no reason to try again.
        let mut count = 0;
        let kept = keep_range(RANGE, Overshoot::UNKNOWN, |_| {
            count += 1;
            Err::<(), _>(Failed::from(Error::Interrupted { time: 9.0 }))
        });
        assert!(kept.is_err() && count == 1);
    }
}
