//! First-order low-pass on a sampled signal.

use arm::elementary;
use std::f64::consts::TAU;

/// y_k = x_k + β·(y_{k−1} − x_k) with β = exp(−2π·f·Δ): from one sample to the next the output goes
/// exactly as that of the continuous filter 1/(1 + s/(2π·f)) under the held input x_k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowpass {
    /// β, in [0, 1).
    memory: f64,
}

impl Lowpass {
    /// Low-pass with cut-off `frequency` \[Hz\] for samples every `sample_period` \[s\]; 0 Hz lets everything through.
    pub fn new(frequency: f64, sample_period: f64) -> Self {
        let memory = if frequency == 0.0 {
            0.0
        } else {
            elementary::exp(-TAU * frequency * sample_period)
        };
        Self { memory }
    }

    /// The next output, from the last one and the new input.
    pub fn next(&self, output: f64, input: f64) -> f64 {
        input + self.memory * (output - input)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The step response is that of the continuous filter at every sample, whatever the sample period.
        #[test]
        fn step_response_is_exact(frequency in 1.0..1000.0, period in 1e-5..1e-3, n in 1..200_i32) {
            let filter = Lowpass::new(frequency, period);
            let output = (0..n).fold(0.0, |y, _| filter.next(y, 1.0));
            let exact = 1.0 - (-TAU * frequency * period * f64::from(n)).exp();
            prop_assert!((output - exact).abs() < 1e-12);
        }
    }

    #[test]
    fn zero_frequency_switches_the_filter_off() {
        let filter = Lowpass::new(0.0, 2.5e-4);
        assert_eq!(filter.next(3.0, 0.1), 0.1);
    }
}
