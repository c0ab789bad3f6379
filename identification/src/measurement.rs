//! What is measured: angle and torque at a constant period, possibly with gaps.

use crate::Error;

/// When the torque of a sample acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// From its sample until the next one: what a sampled controller asks of its drive (zero-order hold).
    #[default]
    Held,
    /// At the instant of its sample: what a sensor measured.
    Sampled,
}

/// Samples without a gap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Segment {
    /// Time of the first sample \[s\].
    pub start: f64,
    /// θ \[rad\].
    pub angle: Vec<f64>,
    /// τ of the motor \[N·m\], as many (eq 10).
    pub torque: Vec<f64>,
}

/// A measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Time between two samples \[s\].
    pub period: f64,
    /// When the torque of a sample acts.
    pub timing: Timing,
    /// Stretches without a gap, in order.
    pub segments: Vec<Segment>,
}

impl Measurement {
    /// A measurement without gaps from time 0 on, its torque held.
    pub fn new(period: f64, angle: Vec<f64>, torque: Vec<f64>) -> Self {
        Self {
            period,
            timing: Timing::Held,
            segments: vec![Segment {
                start: 0.0,
                angle,
                torque,
            }],
        }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.segments.iter().map(|s| s.angle.len()).sum()
    }

    /// # Errors
    /// A period that is not positive and samples that are not finite.
    pub fn validate(&self) -> Result<(), Error> {
        if !(self.period.is_finite() && self.period > 0.0) {
            return Err(Error::Period { value: self.period });
        }
        let mut first = 0;
        for segment in &self.segments {
            for (signal, values) in [("angle", &segment.angle), ("torque", &segment.torque)] {
                if let Some(position) = values.iter().position(|v| !v.is_finite()) {
                    return Err(Error::NotFinite {
                        signal,
                        index: first + position,
                        value: values[position],
                    });
                }
            }
            first += segment.angle.len();
        }
        Ok(())
    }
}
