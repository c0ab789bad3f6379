//! Everything that can end a run.

use crate::input::setpoints::AngleLimits;
use crate::{Outcome, fmu, input};
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why there is no result.
#[derive(Debug)]
#[allow(missing_docs, reason = "the fields are what Display prints")]
pub enum Error {
    /// An FMU cannot be used or failed.
    Fmu(fmu::Error),
    /// What the user gave is wrong.
    Input(input::Error),
    /// A connected signal is not a number.
    NotFinite { name: String, value: f64, time: f64 },
    /// A connection maps values, but not this one.
    Unmapped { name: String, value: f64, time: f64 },
    /// The folder for the result cannot be used.
    OutputFolder { path: PathBuf, source: io::Error },
    /// The result cannot be written.
    Output { path: PathBuf, source: io::Error },
    /// The run ended before its time; what it has until then is kept.
    Stopped {
        source: Box<Self>,
        partial: Box<Outcome>,
    },
    /// The angle went where a run was told to stop.
    LeftRange {
        angle: f64,
        time: f64,
        limits: AngleLimits,
    },
    /// An experiment on a plant does not identify it.
    Identification {
        experiment: String,
        source: identification::Error,
    },
    /// The user stopped the run.
    Interrupted { time: f64 },
}

impl Error {
    /// Whether the user stopped the run.
    pub fn is_interrupt(&self) -> bool {
        match self {
            Self::Interrupted { .. } => true,
            Self::Stopped { source, .. } => source.is_interrupt(),
            _ => false,
        }
    }

    /// Whether the user's input is to blame, rather than the run.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Fmu(error) => error.is_input(),
            Self::Input(_) | Self::OutputFolder { .. } => true,
            _ => false,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fmu(error) => error.fmt(f),
            Self::Input(error) => error.fmt(f),
            Self::NotFinite { name, value, time } => {
                write!(f, "{name} is {value} at t = {time} s: not a finite number")
            }
            Self::Unmapped { name, value, time } => write!(
                f,
                "{name} is {value} at t = {time} s: the mapping of its connection has no entry for it"
            ),
            Self::OutputFolder { path, source } | Self::Output { path, source } => {
                write!(f, "cannot write {}: {source}", path.display())
            }
            Self::Stopped { source, .. } => source.fmt(f),
            Self::LeftRange {
                angle,
                time,
                limits,
            } => write!(
                f,
                "the angle is {angle} rad at t = {time} s, outside [{}, {}] rad: do torque and angle have opposite \
                 signs, or does the feedback not suit the arm (feedback.inertia)?",
                limits.lower, limits.upper
            ),
            Self::Identification { experiment, source } => write!(f, "{experiment}: {source}"),
            Self::Interrupted { time } => write!(f, "interrupted at t = {time} s"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Fmu(error) => Some(error),
            Self::Input(error) => Some(error),
            Self::OutputFolder { source, .. } | Self::Output { source, .. } => Some(source),
            Self::Stopped { source, .. } => source.source(),
            Self::Identification { source, .. } => Some(source),
            Self::NotFinite { .. }
            | Self::Unmapped { .. }
            | Self::LeftRange { .. }
            | Self::Interrupted { .. } => None,
        }
    }
}

impl From<fmu::Error> for Error {
    fn from(error: fmu::Error) -> Self {
        Self::Fmu(error)
    }
}

impl From<input::Error> for Error {
    fn from(error: input::Error) -> Self {
        Self::Input(error)
    }
}
