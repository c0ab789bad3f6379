//! The smoothing filter of eq 11.

use std::f64::consts::TAU;

/// Taps of the paper's filter.
pub const TAPS: usize = 101;

/// Finite impulse response filter with a Hann window, of gain one at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Hann {
    taps: Vec<f64>,
}

impl Hann {
    /// w(n) = 0.5·(1 − cos(2π·n/(taps − 1))) for 0 ≤ n < taps (eq 11), divided by the sum of all w.
    ///
    /// Eq 11 prints n − 2 where n counts from 1; with n − 1 the window is symmetric, so that it delays by
    /// exactly half its length. Every signal passes the same filter: only the delay depends on this.
    /// Windows below three taps are the identity.
    pub fn new(taps: usize) -> Self {
        if taps < 3 {
            return Self { taps: vec![1.0] };
        }
        let last = (taps - 1) as f64;
        let mut window: Vec<f64> = (0..taps)
            .map(|n| 0.5 * (1.0 - (TAU * n as f64 / last).cos()))
            .collect();
        let sum: f64 = window.iter().sum();
        window.iter_mut().for_each(|w| *w /= sum);
        Self { taps: window }
    }

    /// Weights, oldest sample first; symmetric.
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// Delay in samples.
    pub fn delay(&self) -> usize {
        self.taps.len() / 2
    }

    /// Number of outputs that `samples` inputs yield, one every `stride`.
    pub fn outputs(&self, samples: usize, stride: usize) -> usize {
        match samples.checked_sub(self.taps.len()) {
            Some(rest) => rest / stride.max(1) + 1,
            None => 0,
        }
    }

    /// Output number j, the weighted mean of the inputs from j·`stride` on: only those that need no input from
    /// before the first or after the last.
    pub fn apply<'a>(&'a self, input: &'a [f64], stride: usize) -> impl Iterator<Item = f64> + 'a {
        let stride = stride.max(1);
        (0..self.outputs(input.len(), stride)).map(move |j| {
            let window = &input[j * stride..j * stride + self.taps.len()];
            dot(window, &self.taps)
        })
    }
}

/// Four partial sums, which the compiler turns into vector instructions.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let (x4, y4) = (x.chunks_exact(4), y.chunks_exact(4));
    let rest: f64 = x4
        .remainder()
        .iter()
        .zip(y4.remainder())
        .map(|(a, b)| a * b)
        .sum();
    let mut sums = [0.0; 4];
    for (a, b) in x4.zip(y4) {
        for l in 0..4 {
            sums[l] += a[l] * b[l];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    #[test]
    fn the_window_is_equation_11() {
        let filter = Hann::new(TAPS);
        // The sum of a Hann window of N taps is (N − 1)/2.
        for (n, w) in filter.taps().iter().enumerate() {
            assert!((w - (PI * n as f64 / 100.0).sin().powi(2) / 50.0).abs() < 1e-16);
        }
        assert!((filter.taps().iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert_eq!(filter.delay(), 50);
        assert_eq!(Hann::new(2).taps(), [1.0]);
    }

    proptest! {
        #[test]
        fn outputs_are_the_defining_sum(
            input in prop::collection::vec(-1e3..1e3_f64, 0..150), taps in 1..40_usize, stride in 1..9_usize,
        ) {
            let filter = Hann::new(taps);
            let output: Vec<f64> = filter.apply(&input, stride).collect();
            let n = filter.taps().len();
            prop_assert_eq!(output.len(), filter.outputs(input.len(), stride));
            let mut expected = Vec::new();
            let mut first = 0;
            while first + n <= input.len() {
                expected.push((0..n).map(|i| filter.taps()[i] * input[first + i]).sum::<f64>());
                first += stride;
            }
            prop_assert_eq!(output.len(), expected.len());
            for (a, b) in output.iter().zip(&expected) {
                prop_assert!((a - b).abs() < 1e-10);
            }
        }

        /// Delay and nothing else for a straight line: the window is symmetric.
        #[test]
        fn a_line_is_only_delayed(slope in -1e2..1e2_f64, start in -1e2..1e2_f64) {
            let line: Vec<f64> = (0..200).map(|k| start + slope * k as f64).collect();
            let filter = Hann::new(TAPS);
            for (j, y) in filter.apply(&line, 7).enumerate() {
                prop_assert!((y - line[7 * j + filter.delay()]).abs() < 1e-9);
            }
        }
    }
}
