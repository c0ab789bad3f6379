//! The frequency response that a transient shows.

use std::f64::consts::{PI, TAU};

/// Amplitude and phase \[deg\] of the response of `y` to `x`, sampled every `step` \[s\], at `frequencies`
/// \[Hz\], which must rise.
///
/// H = Y/X of the z-transforms of the second differences. Both are finite sequences where x goes from one
/// constant to another and y settles to a ramp (an integrator among the dynamics) before the samples end.
/// O(samples · frequencies).
pub fn frequency_response(x: &[f64], y: &[f64], step: f64, frequencies: &[f64]) -> [Vec<f64>; 2] {
    let [x, y] = [x, y].map(second_differences);
    let mut amplitudes = Vec::new();
    let mut phases: Vec<f64> = Vec::new();
    for frequency in frequencies {
        let angle = TAU * frequency * step;
        let [(a, b), (c, d)] = [&x, &y].map(|samples| transform(samples, angle));
        amplitudes.push((c.hypot(d)) / a.hypot(b));
        let mut phase = d.atan2(c) - b.atan2(a);
        let near = phases.last().map_or(0.0, |degrees| degrees.to_radians());
        phase -= TAU * ((phase - near + PI) / TAU).floor();
        phases.push(phase.to_degrees());
    }
    [amplitudes, phases]
}

/// As if the signal had rested at its first value before.
fn second_differences(samples: &[f64]) -> Vec<f64> {
    let first = samples.first().copied().unwrap_or(0.0);
    let before = |k: usize, n: usize| k.checked_sub(n).map_or(first, |k| samples[k]);
    let difference = |k| samples[k] - 2.0 * before(k, 1) + before(k, 2);
    (0..samples.len()).map(difference).collect()
}

/// Σ s_k·e^(−i·k·angle) as real and imaginary part.
fn transform(samples: &[f64], angle: f64) -> (f64, f64) {
    let term = |(k, s): (usize, &f64)| {
        let (sin, cos) = (k as f64 * angle).sin_cos();
        (s * cos, -s * sin)
    };
    let terms = samples.iter().enumerate().filter(|(_, s)| **s != 0.0);
    terms
        .map(term)
        .fold((0.0, 0.0), |(a, b), (c, d)| (a + c, b + d))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PID with a low-pass on its derivative: analytic z-transform against the transient of a step.
    #[test]
    fn a_step_shows_the_response_of_an_integrating_filter() {
        let (step, p, i, d, pole) = (0.01, 2.0, 5.0, 0.3, 0.7);
        let x: Vec<f64> = (0..2000).map(|k| if k < 3 { 0.4 } else { 1.4 }).collect();
        let (mut integral, mut rate, mut before) = (0.0, 0.0, 0.4);
        let y: Vec<f64> = x
            .iter()
            .map(|&x| {
                rate = pole * rate + (1.0 - pole) * (x - before) / step;
                integral += (x - 0.4) * step;
                before = x;
                p * (x - 0.4) + i * integral + d * rate
            })
            .collect();
        let frequencies = [0.1, 1.0, 10.0, 40.0];
        let [amplitude, phase] = frequency_response(&x, &y, step, &frequencies);
        for (k, frequency) in frequencies.iter().enumerate() {
            let angle = TAU * frequency * step;
            // z = e^(i·angle), powers and quotients by hand: w = z⁻¹.
            let (wr, wi) = (angle.cos(), -angle.sin());
            let divide = |(a, b): (f64, f64), (c, d): (f64, f64)| {
                let n = c * c + d * d;
                ((a * c + b * d) / n, (b * c - a * d) / n)
            };
            let integral = divide((i * step, 0.0), (1.0 - wr, -wi));
            let share = d * (1.0 - pole) / step;
            let rate = divide(
                (share * (1.0 - wr), -share * wi),
                (1.0 - pole * wr, -pole * wi),
            );
            let (re, im) = (p + integral.0 + rate.0, integral.1 + rate.1);
            assert!(
                (amplitude[k] / re.hypot(im) - 1.0).abs() < 1e-9,
                "{frequency}"
            );
            assert!(
                (phase[k] - im.atan2(re).to_degrees()).abs() < 1e-6,
                "{frequency}"
            );
        }
    }
}
