//! White noise of the motor drive (sec 4.1.1), as a function of seed and sample number alone, so that
//! a snapshot needs no generator state and equal seeds give equal runs on every machine thread.

use arm::elementary::{cos, log};
use arm::random::{GOLDEN, mix};
use std::f64::consts::TAU;

/// Uniform in (0, 1].
fn uniform(bits: u64) -> f64 {
    ((bits >> 11) + 1) as f64 / (1_u64 << 53) as f64
}

/// Standard normal draw number `sample` of the sequence `seed`, by Box and Muller.
pub fn standard_normal(seed: u64, sample: u64) -> f64 {
    let stream = mix(seed.wrapping_mul(GOLDEN).wrapping_add(GOLDEN));
    let first = uniform(mix(stream.wrapping_add((2 * sample).wrapping_mul(GOLDEN))));
    let second = uniform(mix(
        stream.wrapping_add((2 * sample + 1).wrapping_mul(GOLDEN))
    ));
    (-2.0 * log(first)).sqrt() * cos(TAU * second)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_standard_normal_and_white() {
        let n = 200_000_u64;
        let x: Vec<f64> = (0..n).map(|k| standard_normal(7, k)).collect();
        let mean = x.iter().sum::<f64>() / n as f64;
        let variance = x.iter().map(|v| v * v).sum::<f64>() / n as f64;
        let lagged = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n as f64;
        // Standard errors are 1/sqrt(n) = 0.0022 (twice that for the variance, over sqrt 2).
        assert!(mean.abs() < 0.01, "{mean}");
        assert!((variance - 1.0).abs() < 0.015, "{variance}");
        assert!(lagged.abs() < 0.01, "{lagged}");
    }

    #[test]
    fn seeds_differ_and_repeat() {
        assert_eq!(standard_normal(1, 5), standard_normal(1, 5));
        assert_ne!(standard_normal(1, 5), standard_normal(2, 5));
        assert_ne!(standard_normal(1, 5), standard_normal(1, 6));
    }
}
