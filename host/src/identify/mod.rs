//! Identification of an arm from measurements in files, or from experiments on a plant (sec 3.1).
//!
//! The mathematics is that of the crate `identification`; here its input is made and its result described.

mod bench;
mod checks;
pub mod experiment;
mod overshoot;
mod parameters;
mod summary;

pub use experiment::{Experiment, Failed, from_plant};
pub use parameters::parameter_set;
pub use summary::Summary;

use crate::Error;
use crate::input;
use crate::input::measurement::{self, Options, Signals};
use ::identification::tube::{self, Tube};
use ::identification::{Identification, Measurement, Series, Settings};
use std::path::{Path, PathBuf};

/// Signals of an experiment with the torque that the identified arm gives for its motion.
#[derive(Clone, Debug)]
pub struct Compared {
    /// What the experiment is called.
    pub name: String,
    /// What was measured.
    pub signals: Signals,
    /// Filtered torque, measured and reconstructed (figs 4b, 5b).
    pub series: Series,
    /// Which samples do not count, and why.
    pub unused: Vec<String>,
}

/// An experiment on a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Of an arm that nothing is known of.
    Approach,
    /// From end to end.
    Reach,
    /// The parameters come from it.
    Excitation,
    /// The motion of the validation without feedforward.
    FeedbackAlone,
    /// Judges the parameters.
    Validation,
}

impl Kind {
    /// All, in order.
    pub const ALL: [Self; 5] = [
        Self::Approach,
        Self::Reach,
        Self::Excitation,
        Self::FeedbackAlone,
        Self::Validation,
    ];

    /// What it is called, also as a file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Reach => "reach",
            Self::Excitation => "excitation",
            Self::FeedbackAlone => "feedback-alone",
            Self::Validation => "validation",
        }
    }
}

/// An experiment that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Which one.
    pub kind: Kind,
    /// Least and greatest setpoint \[rad\].
    pub setpoints: [f64; 2],
    /// Least and greatest angle, from the start \[rad\].
    pub angles: [f64; 2],
    /// Samples whose angle was outside the range that was asked for.
    pub outside: u64,
    /// Samples outside its limits that the plant counted; None of one that does not count.
    pub violations: Option<u64>,
    /// How often it was run; all runs but the last one left the range and were stopped there.
    pub attempts: u32,
}

/// An identified arm.
#[derive(Clone, Debug)]
pub struct Identified {
    /// φ, its errors and how it was found.
    pub identification: Identification,
    /// How the measurement was filtered.
    pub settings: Settings,
    /// Time between two samples \[s\].
    pub period: f64,
    /// The measurement that φ comes from.
    pub measurement: Compared,
    /// Another one.
    pub validation: Option<Compared>,
    /// The motion of the validation by feedback alone.
    pub feedback_alone: Option<Compared>,
    /// The experiments that were made, in order.
    pub experiments: Vec<Made>,
    /// What to leave to the feedback.
    pub tube: Option<Tube>,
    /// What to know before the result is used.
    pub warnings: Vec<String>,
}

/// Length of the filter if none is given \[s\]: the paper's 101 taps at 4 kHz.
const FILTER: f64 = 0.025_25;

/// An odd number of taps, which delays by whole samples, that lasts as long as the paper's filter.
pub fn taps(period: f64) -> usize {
    2 * (0.5 * FILTER / period).floor().clamp(1.0, 5000.0) as usize + 1
}

/// Measurements in files.
#[derive(Clone, Debug)]
pub struct Files {
    /// What to identify from.
    pub measurement: PathBuf,
    /// What to validate with.
    pub validation: Option<PathBuf>,
    /// How they are to be read.
    pub options: Options,
}

/// Identifies from files. Without `taps` in the settings the filter lasts as long as the paper's.
///
/// # Errors
/// Files that are not measurements, and measurements that do not identify an arm.
pub fn from_files(
    files: &Files,
    settings: &Settings,
    taps_given: bool,
) -> Result<Identified, Error> {
    let read = |path: &Path| measurement::read(path, &files.options);
    let (measured, signals) = read(&files.measurement)?;
    let second = files.validation.as_deref().map(read).transpose()?;
    let mut settings = settings.clone();
    if !taps_given {
        settings.taps = taps(measured.period);
    }
    let name = |path: &Path| path.display().to_string();
    let blame = |path: &Path| {
        let file = name(path);
        move |source| Error::Input(input::Error::Measurement { file, source })
    };
    let identification =
        ::identification::identify(&measured, &settings).map_err(blame(&files.measurement))?;
    let compare = |path: &Path, m: &Measurement, signals: Signals| {
        let compared = compare(name(path), &identification, m, &settings, signals);
        compared.map_err(blame(path))
    };
    let first = compare(&files.measurement, &measured, signals)?;
    let validation = match (files.validation.as_deref(), second) {
        (Some(path), Some((measurement, signals))) => Some(compare(path, &measurement, signals)?),
        _ => None,
    };
    let tube = propose(&validation.as_ref().unwrap_or(&first).signals);
    let mut warnings = identification.warnings.clone();
    if let Some(Compared { name, unused, .. }) = &validation {
        warnings.extend(unused.iter().map(|warning| format!("{name}: {warning}")));
    }
    Ok(Identified {
        warnings,
        period: measured.period,
        identification,
        settings,
        measurement: first,
        validation,
        feedback_alone: None,
        experiments: Vec::new(),
        tube,
    })
}

fn compare(
    name: String,
    identification: &Identification,
    measurement: &Measurement,
    settings: &Settings,
    signals: Signals,
) -> Result<Compared, ::identification::Error> {
    let regression = settings.regression(measurement)?;
    let series = Series::new(&identification.parameters, &regression);
    let residual = series.fit().residual;
    if !residual.is_finite() {
        return Err(::identification::Error::Result {
            name: "the residual".to_owned(),
            value: residual,
        });
    }
    Ok(Compared {
        name,
        series,
        unused: regression.unused(),
        signals,
    })
}

/// A tube from an experiment that shows reference, feedforward and feedback.
fn propose(signals: &Signals) -> Option<Tube> {
    tube::propose(
        &signals.tracking_error()?,
        signals.feedforward.as_ref()?,
        signals.feedback.as_ref()?,
    )
}
