//! What to leave to the feedback: the margin of the angle and the share of the current (eqs 25, 26).
//!
//! Sec 4.1.1 reads both off figures 5a and 6b by eye. Here they come from the same signals by rule.

/// Times what was seen.
const SAFETY: f64 = 2.0;
/// The plan never gets less of the current than this.
const LEAST_SHARE: f64 = 0.5;
/// The feedback never gets less of the current than this: a share of a few hours' luck is no design.
const LEAST_FEEDBACK: f64 = 0.05;

/// A proposal for the planner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    /// σ_θ \[rad\] (eq 25): twice the largest tracking error seen.
    pub angle_margin: f64,
    /// Share of the continuous current that plans may use (eq 26).
    pub thermal_share: f64,
    /// Largest tracking error seen \[rad\].
    pub largest_error: f64,
    /// Root mean square of the feedback's torque by that of feedforward and feedback together, each on its own.
    pub feedback_share: f64,
}

/// From tracking error \[rad\], feedforward and feedback torque \[N·m\] of an experiment with both.
///
/// Heat goes with the mean square of the torque, and the root mean square of a sum is at most the sum of both:
/// a plan that keeps to 1 − rms(fb)/(rms(ff) + rms(fb)) leaves enough for the feedback. Twice that is left.
/// None: no samples, no torque, values beyond arithmetic, or a feedback that did more than the feedforward, so that its error would not be
/// that of the identified arm.
pub fn propose(error: &[f64], feedforward: &[f64], feedback: &[f64]) -> Option<Tube> {
    if error.is_empty() || feedforward.is_empty() || feedback.is_empty() {
        return None;
    }
    let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
    let (ff, fb) = (rms(feedforward), rms(feedback));
    let largest = error.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
    if !(ff + fb + largest).is_finite() || ff <= fb {
        return None;
    }
    let share = fb / (ff + fb);
    let left = (SAFETY * share).clamp(LEAST_FEEDBACK, 1.0 - LEAST_SHARE);
    Some(Tube {
        angle_margin: SAFETY * largest,
        thermal_share: 1.0 - left,
        largest_error: largest,
        feedback_share: share,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A plan within its share and the feedback seen together stay within the continuous current.
        #[test]
        fn plan_and_feedback_together_keep_the_limit(
            ff in prop::collection::vec(-5.0..5.0_f64, 50), fb in prop::collection::vec(-0.8..0.8_f64, 50),
        ) {
            let Some(tube) = propose(&[1e-3, -2e-3], &ff, &fb) else { return Ok(()) };
            prop_assert_eq!(tube.angle_margin, 4e-3);
            prop_assert!((0.5..=0.95).contains(&tube.thermal_share));
            let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
            // A plan at its limit, torque scaled so that the limit is 1.
            let scale = tube.thermal_share / rms(&ff);
            let together: Vec<f64> = ff.iter().zip(&fb).map(|(a, b)| scale * (a + b)).collect();
            if tube.thermal_share > 0.5 {
                prop_assert!(rms(&together) <= 1.0 + 1e-12, "{}", rms(&together));
            }
        }
    }

    #[test]
    fn feedback_alone_proposes_nothing() {
        assert_eq!(propose(&[0.1], &[0.0], &[1.0]), None);
        assert_eq!(propose(&[], &[1.0], &[0.1]), None);
        assert_eq!(propose(&[0.1], &[1e200], &[0.1]), None);
    }
}
