//! Experiments on a plant: our controller moves it between random setpoints on third-order profiles (sec 3.1.1).
//!
//! 1. Approach: the feedback alone moves the arm within the middle half of the range. That shows wrong signs
//!    and units early, and gives the inertia that the feedback is designed for from then on.
//! 2. Excitation: setpoints across the whole range, each held for 1.5 s, by feedback alone as in the paper. The
//!    parameters come from here. The arm overshoots, which helps: the T-flex's range is shorter than a period of
//!    its cogging, and the condition number falls from 34 000 without overshoot to 600.
//! 3. Validation: new setpoints every 0.66 s, with the identified feedforward. Parameters are judged here, and
//!    the tube comes from its tracking error and feedback.
//!
//! What the user sets of the controller's model of the arm holds in the first two.

use super::bench::{Bench, Knowledge, START};
use super::{Identified, compare, propose};
use crate::Error;
use crate::input;
use crate::input::measurement::Signals;
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::setpoints::AngleLimits;
use crate::run::{Order, Outcome};
use ::identification::Settings;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// What to do to a plant.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// FMU of our controller.
    pub controller: PathBuf,
    /// FMU of the plant.
    pub plant: PathBuf,
    /// Parameter files, in order.
    pub parameters: Vec<ParameterFile>,
    /// Single values, after the files.
    pub assignments: Vec<Assignment>,
    /// Connections and roles. None: by the names of the contract.
    pub connections: Option<PathBuf>,
    /// Communication step \[s\].
    pub step: f64,
    /// Which FMU steps first.
    pub order: Order,
    /// Setpoints lie between these.
    pub range: AngleLimits,
    /// Duration of excitation and of validation \[s\].
    pub duration: f64,
    /// How long a setpoint of the excitation holds \[s\].
    pub interval: f64,
    /// How long a setpoint of the validation holds \[s\].
    pub validation_interval: f64,
    /// Seed of the setpoints: equal seeds give equal experiments.
    pub seed: u64,
}

impl Experiment {
    /// The paper's experiments.
    pub fn new(
        controller: impl Into<PathBuf>,
        plant: impl Into<PathBuf>,
        range: AngleLimits,
    ) -> Self {
        Self {
            controller: controller.into(),
            plant: plant.into(),
            parameters: Vec::new(),
            assignments: Vec::new(),
            connections: None,
            step: crate::run::DEFAULT_STEP,
            order: Order::Sequential,
            range,
            duration: 100.0,
            interval: 1.5,
            validation_interval: 0.66,
            seed: 1,
        }
    }
}

/// Experiments that did not come to their end.
#[derive(Debug)]
pub struct Failed {
    /// Why.
    pub error: Box<Error>,
    /// The experiment under way and what was recorded of it.
    pub partial: Option<Box<(String, Signals)>>,
}

impl<E: Into<Error>> From<E> for Failed {
    fn from(error: E) -> Self {
        Self {
            error: Box::new(error.into()),
            partial: None,
        }
    }
}

/// Duration of the approach \[s\].
const APPROACH: f64 = 30.0;

/// Runs the experiments and identifies the plant. `progress` is told which fraction of all is done.
///
/// # Errors
/// As [`crate::simulate`], and a plant that the experiments do not identify.
pub fn from_plant(
    experiment: &Experiment,
    settings: &Settings,
    taps_given: bool,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Identified, Failed> {
    check(experiment)?;
    let bench = Bench::new(experiment)?;
    let mut settings = settings.clone();
    if !taps_given {
        settings.taps = super::taps(experiment.step);
    }
    let total = APPROACH + 2.0 * experiment.duration + 3.0 * START;
    let mut done = 0.0;
    let mut run = |name: &str,
                   knowledge: Knowledge<'_>,
                   seed: u64,
                   share: f64,
                   interval: f64,
                   duration: f64| {
        let setpoints = bench.setpoints(seed, share, interval, duration)?;
        let length = START + duration;
        let outcome = bench.run(name, knowledge, &setpoints, length, &mut |part| {
            progress((done + part * length) / total)
        })?;
        done += length;
        Ok::<_, Failed>(outcome)
    };
    let seed = experiment.seed;
    let approach = run(
        "approach",
        Knowledge::Nothing,
        seed,
        0.5,
        experiment.interval,
        APPROACH,
    )?;
    let (first, _) = bench.identify("approach", &approach, &settings)?;
    let (interval, duration) = (experiment.interval, experiment.duration);
    let excitation = run(
        "excitation",
        Knowledge::Design(&first),
        seed.wrapping_add(1),
        1.0,
        interval,
        duration,
    )?;
    let (identification, measured) = bench.identify("excitation", &excitation, &settings)?;
    let validation = run(
        "validation",
        Knowledge::Identified(&identification),
        seed.wrapping_add(2),
        1.0,
        experiment.validation_interval,
        duration,
    )?;
    let mut warnings = identification.warnings.clone();
    for (name, outcome) in [
        ("approach", &approach),
        ("excitation", &excitation),
        ("validation", &validation),
    ] {
        for warning in &outcome.summary.warnings {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        if let Some(count) = outcome.summary.score.violations.filter(|count| *count > 0) {
            warnings.push(format!(
                "{name}: the arm was outside its limits in {count} samples: choose setpoints further from them"
            ));
        }
    }
    let describe = |name: &str, outcome: &Outcome| {
        let signals = bench.signals(&outcome.recording, START)?;
        let measurement = bench.measurement(&signals);
        compare(
            name.to_owned(),
            &identification,
            &measurement,
            &settings,
            signals,
        )
        .map_err(|source| identification_error(name, source))
    };
    let first = describe("excitation", &excitation)?;
    let second = describe("validation", &validation)?;
    Ok(Identified {
        tube: propose(&second.signals),
        period: measured.period,
        measurement: first,
        validation: Some(second),
        identification,
        settings,
        warnings,
    })
}

pub(super) fn identification_error(experiment: &str, source: ::identification::Error) -> Error {
    Error::Identification {
        experiment: experiment.to_owned(),
        source,
    }
}

fn check(experiment: &Experiment) -> Result<(), input::Error> {
    let setting = |name: &str, value: f64, expected: String| {
        Err(input::Error::Setting {
            name: name.to_owned(),
            value: value.to_string(),
            expected,
        })
    };
    let AngleLimits { lower, upper } = experiment.range;
    if !(lower.is_finite() && upper.is_finite() && lower < upper) {
        return setting(
            "--upper",
            upper,
            format!("an angle in rad above --lower = {lower}"),
        );
    }
    for (name, value, least) in [
        ("--duration", experiment.duration, 10.0),
        ("--interval", experiment.interval, 0.05),
        (
            "--validation-interval",
            experiment.validation_interval,
            0.05,
        ),
    ] {
        if !(value.is_finite() && value >= least) {
            return setting(name, value, format!("at least {least} s"));
        }
    }
    Ok(())
}
