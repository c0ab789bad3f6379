//! Why there is no result.

use std::fmt;

/// Why a measurement does not identify an arm.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the fields are what Display prints")]
pub enum Error {
    /// The period is not a positive number.
    Period { value: f64 },
    /// A sample is not a number.
    NotFinite {
        signal: &'static str,
        index: usize,
        value: f64,
    },
    /// Too few samples, or stretches without gaps that are too short.
    TooShort {
        rows: usize,
        needed: usize,
        samples: usize,
        period: f64,
    },
    /// Parameters that the measurement says nothing about: their regressors depend on each other.
    NotExcited {
        parameters: Vec<String>,
        condition: f64,
    },
    /// A moment of inertia that is not positive.
    Inertia { value: f64, sigma: f64 },
    /// Cogging frequencies \[1/rad\] that the measurement cannot show: its angles \[rad\] span too little for them.
    FrequencyRange {
        given: [f64; 2],
        finest: f64,
        span: f64,
        harmonics: usize,
    },
    /// A result that is not a number.
    Result { name: String, value: f64 },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Period { value } => {
                write!(
                    f,
                    "the period between samples is {value} s: must be positive"
                )
            }
            Self::NotFinite {
                signal,
                index,
                value,
            } => write!(
                f,
                "{signal} is {value} in sample {index}: not a finite number"
            ),
            Self::TooShort {
                rows,
                needed,
                samples,
                period,
            } => write!(
                f,
                "the measurement is too short: {samples} samples of {period} s leave {rows} filtered rows, and \
                 {needed} are needed; measure for longer and without gaps (the paper takes 100 s)"
            ),
            Self::NotExcited {
                parameters,
                condition,
            } => write!(
                f,
                "the measurement does not excite the arm enough to tell {} apart (condition number {condition:.1e}): \
                 move it between setpoints across its whole range",
                parameters.join(", ")
            ),
            Self::Inertia { value, sigma } => write!(
                f,
                "arm.inertia = {value:.4e} kg.m2 (sigma {sigma:.1e}): must be positive; do torque and angle have \
                 opposite signs, or is their timing wrong?"
            ),
            Self::FrequencyRange {
                given: [low, high],
                finest,
                span,
                harmonics,
            } => write!(
                f,
                "the range of cogging frequencies, {low} to {high} 1/rad, is beyond {finest:.4} 1/rad, the finest that angles \
                 over {span:.4} rad show with harmonics up to {harmonics}"
            ),
            Self::Result { name, value } => write!(
                f,
                "{name} comes out as {value}: torque or angle is too large for arithmetic; are the units right?"
            ),
        }
    }
}

impl std::error::Error for Error {}
