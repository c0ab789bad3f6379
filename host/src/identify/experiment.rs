//! Experiments on a plant: our controller moves it between random setpoints on third-order profiles (sec 3.1.1).
//!
//! 1. Approach: feedback alone moves the arm, of which nothing is known, within the middle half of its range. That
//!    shows wrong signs and units early, and gives the inertia that the feedback is designed for from then on.
//! 2. Reach: from end to end and back, to see how far the arm overshoots.
//! 3. Excitation: setpoints each held for 1.5 s, by feedback alone as in the paper. The parameters come from here.
//!    Overshoot takes the arm through the whole range, which counts: the T-flex's is shorter than a period of its
//!    cogging, and 4 % less of it doubles the condition number.
//! 4. Feedback alone: new setpoints every 0.66 s (figs 5b, 6).
//! 5. Validation: the same setpoints and feedback, with the identified feedforward. Parameters are judged here, and
//!    the tube comes from its tracking error and feedback.
//!
//! No experiment leaves the range (see `overshoot`). What the user sets of the controller's model of the arm
//! holds in the first three.

use super::bench::{Bench, Knowledge, Places, START};
use super::checks::ordered;
use super::overshoot::{Kept, Overshoot, keep_range};
use super::{Identified, Kind, compare, propose};
use crate::Error;
use crate::input;
use crate::input::measurement::Signals;
use crate::input::parameters::{Assignment, ParameterFile};
use crate::run::{Order, Outcome};
use ::identification::Settings;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

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
    /// The angle stays above this \[rad\]. None: the plant's `limits.angle_lower`.
    pub lower: Option<f64>,
    /// The angle stays below this \[rad\]. None: the plant's `limits.angle_upper`.
    pub upper: Option<f64>,
    /// Duration of excitation, feedback alone and validation, of each \[s\].
    pub duration: f64,
    /// How long a setpoint of the excitation holds \[s\].
    pub interval: f64,
    /// How long a setpoint of feedback alone and validation holds \[s\].
    pub validation_interval: f64,
    /// Seed of the setpoints: equal seeds give equal experiments.
    pub seed: u64,
}

impl Experiment {
    /// The paper's experiments, within the plant's limits.
    pub fn new(controller: impl Into<PathBuf>, plant: impl Into<PathBuf>) -> Self {
        Self {
            controller: controller.into(),
            plant: plant.into(),
            parameters: Vec::new(),
            assignments: Vec::new(),
            connections: None,
            step: crate::run::DEFAULT_STEP,
            order: Order::Sequential,
            lower: None,
            upper: None,
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
    pub partial: Option<Box<(Kind, Signals)>>,
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
/// Moves from end to end that show the overshoot.
const MOVES: f64 = 8.0;
/// Times the overshoot that another motion showed.
const OTHER_MOTION: f64 = 1.5;
/// Times the overshoot that the same feedback at the same pace showed.
const SAME_MOTION: f64 = 1.0;

/// Runs the experiments and identifies the plant. `progress` is told which fraction of all is done.
///
/// # Errors
/// As [`crate::simulate`], a plant that the experiments do not identify, and one that does not keep its range.
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
    let (interval, duration) = (experiment.interval, experiment.duration);
    let reach = MOVES * interval;
    let mut course = Course {
        bench: &bench,
        total: APPROACH + reach + 3.0 * duration + 5.0 * START,
        done: 0.0,
        progress,
    };
    let random = |further: u64| Places::Random(experiment.seed.wrapping_add(further));

    let kind = Kind::Approach;
    let approach = keep_range(bench.range, Overshoot::UNKNOWN, |ends| {
        let setpoints = bench.setpoints(ends, random(0), interval, APPROACH)?;
        course.run(kind, Knowledge::Nothing, &setpoints, APPROACH)
    })?;
    let (first, _) = bench.identify(kind.name(), &approach.result, &settings)?;
    let knowledge = Knowledge::Design(&first);
    let seen = bench.overshoot(&approach)?.times(OTHER_MOTION);
    let reach = keep_range(bench.range, seen, |ends| {
        let setpoints = bench.setpoints(ends, Places::Ends, interval, reach)?;
        course.run(Kind::Reach, knowledge, &setpoints, reach)
    })?;
    let seen = bench.overshoot(&reach)?.times(SAME_MOTION);
    let kind = Kind::Excitation;
    let excitation = keep_range(bench.range, seen, |ends| {
        let setpoints = bench.setpoints(ends, random(1), interval, duration)?;
        course.run(kind, knowledge, &setpoints, duration)
    })?;
    let (identification, measured) = bench.identify(kind.name(), &excitation.result, &settings)?;
    // Both have the same setpoints, so that they are repeated together.
    let seen = bench.overshoot(&excitation)?.times(OTHER_MOTION);
    let pair = keep_range(bench.range, seen, |ends| {
        let interval = experiment.validation_interval;
        let setpoints = bench.setpoints(ends, random(2), interval, duration)?;
        let done = course.done;
        let mut run = |kind, knowledge| course.run(kind, knowledge, &setpoints, duration);
        let alone = run(Kind::FeedbackAlone, Knowledge::Feedback(&identification))?;
        match run(Kind::Validation, Knowledge::Identified(&identification)) {
            Ok(validation) => Ok((alone, validation)),
            Err(failed) => {
                course.done = done;
                Err(failed)
            }
        }
    })?;
    let Kept {
        result: (alone, validation),
        ends,
        attempts,
    } = pair;
    let [alone, validation] = [alone, validation].map(|result| Kept {
        result,
        ends,
        attempts,
    });

    let mut warnings = identification.warnings.clone();
    let mut experiments = Vec::new();
    for (kind, kept) in [
        (Kind::Approach, &approach),
        (Kind::Reach, &reach),
        (Kind::Excitation, &excitation),
        (Kind::FeedbackAlone, &alone),
        (Kind::Validation, &validation),
    ] {
        let made = bench.made(kind, kept)?;
        for warning in &kept.result.summary.warnings {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        if let Some(violations @ 1..) = made.violations {
            warnings.push(format!(
                "{}: the plant counts {violations} samples outside its limits, though the angle kept its range",
                kind.name()
            ));
        }
        experiments.push(made);
    }
    let describe = |kind: Kind, kept: &Kept<Outcome>| {
        let signals = bench.signals(&kept.result.recording, START)?;
        let measurement = bench.measurement(&signals);
        let name = kind.name();
        compare(
            name.to_owned(),
            &identification,
            &measurement,
            &settings,
            signals,
        )
        .map_err(|source| identification_error(name, source))
    };
    let second = describe(Kind::Validation, &validation)?;
    Ok(Identified {
        tube: propose(&second.signals),
        period: measured.period,
        measurement: describe(Kind::Excitation, &excitation)?,
        feedback_alone: Some(describe(Kind::FeedbackAlone, &alone)?),
        validation: Some(second),
        experiments,
        identification,
        settings,
        warnings,
    })
}

/// Runs one experiment after the other.
struct Course<'a> {
    bench: &'a Bench<'a>,
    /// Time of all experiments, and of those that are done \[s\].
    total: f64,
    done: f64,
    progress: &'a mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Course<'_> {
    fn run(
        &mut self,
        kind: Kind,
        knowledge: Knowledge<'_>,
        setpoints: &Path,
        duration: f64,
    ) -> Result<Outcome, Failed> {
        let length = START + duration;
        let Self { done, total, .. } = *self;
        let progress = &mut self.progress;
        let outcome = self
            .bench
            .run(kind, knowledge, setpoints, length, &mut |part| {
                progress((done + part * length) / total)
            })?;
        self.done += length;
        Ok(outcome)
    }
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
    if let (Some(lower), Some(upper)) = (experiment.lower, experiment.upper) {
        ordered(lower, upper)?;
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
