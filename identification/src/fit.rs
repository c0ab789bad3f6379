//! How a parameter vector fits a measurement (figs 4b, 5b).

use crate::regression::{LINEAR, Regression};
use arm::{HARMONICS, Parameters};
use nalgebra::DVector;

/// Measures of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Rows compared.
    pub rows: usize,
    /// Root mean square of measured minus reconstructed torque \[N·m\].
    pub residual: f64,
    /// Standard deviation of the measured torque \[N·m\].
    pub torque: f64,
    /// Largest absolute residual \[N·m\].
    pub largest: f64,
    /// `residual` divided by `torque`: 0 is perfect, 1 no better than the mean.
    pub nrmse: f64,
}

/// Filtered torque over time, measured and reconstructed by eq 15 from the measured motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Time \[s\].
    pub time: Vec<f64>,
    /// Measured torque \[N·m\].
    pub measured: Vec<f64>,
    /// Reconstructed torque \[N·m\].
    pub reconstructed: Vec<f64>,
    /// Whether the arm moves.
    pub moving: Vec<bool>,
}

impl Fit {
    /// From measured torques and their residuals \[N·m\].
    pub fn of(torque: &[f64], residuals: &[f64]) -> Self {
        let n = torque.len().max(1) as f64;
        let mean = torque.iter().sum::<f64>() / n;
        let scale = (torque.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / n).sqrt();
        let residual = (residuals.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
        Self {
            rows: torque.len(),
            residual,
            torque: scale,
            largest: residuals.iter().fold(0.0, |most, r| r.abs().max(most)),
            nrmse: residual / scale,
        }
    }
}

impl Series {
    /// Reconstructs the torque of a measurement.
    pub fn new(parameters: &Parameters, regression: &Regression) -> Self {
        let p = parameters;
        let linear = [p.inertia, p.damping, p.stiffness, p.offset, p.hysteresis];
        let mut torque = DVector::zeros(regression.rows());
        for i in 0..LINEAR {
            torque += DVector::from_vec(regression.linear(i)) * linear[i];
        }
        let harmonics = p.harmonics();
        if harmonics > 0 {
            let pairs = p
                .cogging_cos
                .iter()
                .zip(&p.cogging_sin)
                .take(HARMONICS.min(harmonics));
            let amplitudes =
                DVector::from_iterator(2 * harmonics, pairs.flat_map(|(a, b)| [*a, *b]));
            torque += regression.cogging(p.cogging_frequency, harmonics) * amplitudes;
        }
        Self {
            time: regression.times(),
            measured: regression.torque().as_slice().to_vec(),
            reconstructed: torque.as_slice().to_vec(),
            moving: regression.motion(),
        }
    }

    /// Measured minus reconstructed torque \[N·m\].
    pub fn residuals(&self) -> Vec<f64> {
        let pairs = self.measured.iter().zip(&self.reconstructed);
        pairs.map(|(m, r)| m - r).collect()
    }

    /// Its measures.
    pub fn fit(&self) -> Fit {
        Fit::of(&self.measured, &self.residuals())
    }

    /// The same in motion only: for an arm that friction holds at rest.
    pub fn fit_in_motion(&self) -> Fit {
        let moving = |values: &[f64]| -> Vec<f64> {
            let pairs = values.iter().zip(&self.moving);
            pairs
                .filter(|(_, moves)| **moves)
                .map(|(value, _)| *value)
                .collect()
        };
        Fit::of(&moving(&self.measured), &moving(&self.residuals()))
    }
}
