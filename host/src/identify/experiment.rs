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

use super::{Identified, compare, parameter_set, propose};
use crate::Error;
use crate::fmu::Fmu;
use crate::input::connections::Wiring;
use crate::input::measurement::Signals;
use crate::input::parameters::{Assignment, ParameterFile, StartValues};
use crate::input::roles::Role;
use crate::input::setpoints::AngleLimits;
use crate::input::{self, Pair, Place, Side};
use crate::run::recording::Recording;
use crate::run::{Order, Outcome, Simulation, Stopped, angle_limits, simulate_keeping};
use ::identification::{Identification, Measurement, Segment, Settings, Timing, identify};
use model_description::ssv::{self, Parameter, ParameterSet, Value};
use std::fmt::Write;
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
    pub error: Error,
    /// The experiment under way and what was recorded of it.
    pub partial: Option<(String, Signals)>,
}

impl<E: Into<Error>> From<E> for Failed {
    fn from(error: E) -> Self {
        Self {
            error: error.into(),
            partial: None,
        }
    }
}

/// Time at the start of an experiment that is left out \[s\]: the arm comes to rest at the first setpoint.
const START: f64 = 5.0;
/// Duration of the approach \[s\].
const APPROACH: f64 = 30.0;
/// Weight of the integral in the feedback \[1/s²\] when nothing else holds the arm.
const INTEGRAL: f64 = 0.25;

/// Of so many setpoints two are the ends of the range.
const ENDS: usize = 8;

/// What the controller is told about the arm.
#[derive(Clone, Copy)]
enum Knowledge<'a> {
    /// Nothing.
    Nothing,
    /// Inertia and damping, for the design of the feedback.
    Design(&'a Identification),
    /// All.
    Identified(&'a Identification),
}

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

fn identification_error(experiment: &str, source: ::identification::Error) -> Error {
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

/// Both FMUs and a place for what they are given.
struct Bench<'a> {
    experiment: &'a Experiment,
    controller: Fmu,
    plant: Fmu,
    folder: tempfile::TempDir,
}

impl<'a> Bench<'a> {
    fn new(experiment: &'a Experiment) -> Result<Self, Error> {
        let controller = Fmu::open(&experiment.controller)?;
        let plant = Fmu::open(&experiment.plant)?;
        let pair = Pair {
            controller: controller.description(),
            plant: plant.description(),
        };
        let option = Place::new("--controller", None);
        for name in ["reference.source", "feedback.law", "arm.inertia"] {
            if controller.description().scalar(name).is_err() {
                return Err(input::Error::Unknown {
                    place: option,
                    owner: Some(Side::Controller),
                    name: name.to_owned(),
                    similar: vec!["FlexArmController.fmu, which can follow a profile".to_owned()],
                    existing: Vec::new(),
                }
                .into());
            }
        }
        let wiring = Wiring::read(pair, experiment.connections.as_deref())?;
        if !wiring.roles.contains_key(&Role::Angle) {
            return Err(input::Error::Purposeless {
                file: "--plant".to_owned(),
                missing: "no signal plays the role of the angle",
                swapped: false,
            }
            .into());
        }
        let values = StartValues::read(pair, &experiment.parameters, &experiment.assignments)?;
        if pair.plant.scalar("limits.angle_lower").is_ok()
            && let Some(limits) = angle_limits(pair, &values)
        {
            for (name, value) in [
                ("--lower", experiment.range.lower),
                ("--upper", experiment.range.upper),
            ] {
                if !limits.contains(value) {
                    return Err(input::Error::Setting {
                        name: name.to_owned(),
                        value: value.to_string(),
                        expected: format!(
                            "an angle in [{}, {}] rad, the limits of the plant",
                            limits.lower, limits.upper
                        ),
                    }
                    .into());
                }
            }
        }
        let folder = tempfile::Builder::new()
            .prefix("flexarm-identify-")
            .tempdir()
            .map_err(|source| Error::OutputFolder {
                path: std::env::temp_dir(),
                source,
            })?;
        Ok(Self {
            experiment,
            controller,
            plant,
            folder,
        })
    }

    /// A file of random setpoints within a share of the range about its middle, where the arm rests first. Now
    /// and then the arm goes from one end of the range to the other: what chance leaves out is not identified.
    fn setpoints(
        &self,
        seed: u64,
        share: f64,
        interval: f64,
        duration: f64,
    ) -> Result<PathBuf, Error> {
        let AngleLimits { lower, upper } = self.experiment.range;
        let (middle, half) = (0.5 * (lower + upper), 0.5 * share * (upper - lower));
        let mut random = Random(seed);
        let mut text = format!("time,setpoint\n0,{middle:?}\n");
        let count = (duration / interval).ceil() as usize;
        for k in 0..count.max(1) {
            let place = match k % ENDS {
                0 => -1.0,
                1 => 1.0,
                _ => 2.0 * random.next() - 1.0,
            };
            let setpoint = (middle + half * place).clamp(lower, upper);
            // Formatting to a String cannot fail.
            let _ = writeln!(text, "{:?},{setpoint:?}", START + k as f64 * interval);
        }
        self.file("setpoints.csv", &text)
    }

    fn file(&self, name: &str, text: &str) -> Result<PathBuf, Error> {
        let path = self.folder.path().join(name);
        std::fs::write(&path, text).map_err(|source| Error::Output {
            path: path.clone(),
            source,
        })?;
        Ok(path)
    }

    fn run(
        &self,
        name: &str,
        knowledge: Knowledge<'_>,
        setpoints: &Path,
        until: f64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Outcome, Failed> {
        let e = self.experiment;
        let start = self.file("experiment.ssv", &ssv::write(&self.defaults(knowledge)))?;
        let mut simulation = Simulation::new(&e.controller, &e.plant);
        simulation.parameters = vec![ParameterFile {
            side: Some(Side::Controller),
            path: start,
        }];
        simulation.parameters.extend(e.parameters.iter().cloned());
        simulation.assignments = e.assignments.clone();
        let forced = |name: &str, value: &str| Assignment {
            side: Some(Side::Controller),
            name: name.to_owned(),
            value: value.to_owned(),
        };
        simulation
            .assignments
            .push(forced("reference.source", "profile"));
        let (known, prefix) = match knowledge {
            Knowledge::Nothing => (None, ""),
            Knowledge::Design(known) => (Some(known), "feedback."),
            Knowledge::Identified(known) => (Some(known), ""),
        };
        if let Some(known) = known {
            let set = parameter_set(&known.parameters, None, "");
            let values = set.parameters.iter().filter(|p| p.name.starts_with(prefix));
            simulation
                .assignments
                .extend(values.map(|p| forced(&p.name, &p.value.to_string())));
        }
        simulation.setpoints = Some(setpoints.to_owned());
        simulation.connections.clone_from(&e.connections);
        simulation.until = Some(until);
        simulation.step = e.step;
        simulation.order = e.order;
        let beyond = e.range.upper - e.range.lower;
        simulation.stop_outside = Some(AngleLimits {
            lower: e.range.lower - beyond,
            upper: e.range.upper + beyond,
        });
        simulate_keeping(&simulation, &self.controller, &self.plant, progress).map_err(
            |Stopped { error, recording }| {
                let signals = self.signals(&recording, 0.0).ok();
                let partial = signals.filter(|s| !s.time.is_empty());
                Failed {
                    error,
                    partial: partial.map(|signals| (name.to_owned(), signals)),
                }
            },
        )
    }

    /// What the controller gets before the user's own values: no model of the arm, and a feedback that does
    /// without; or the feedback of the paper.
    fn defaults(&self, knowledge: Knowledge<'_>) -> ParameterSet {
        let mut set = ParameterSet {
            name: "experiment".to_owned(),
            ..ParameterSet::default()
        };
        let mut add = |name: &str, value: Value| {
            set.parameters.push(Parameter {
                name: name.to_owned(),
                value,
                unit: None,
                line: 0,
            });
        };
        let AngleLimits { lower, upper } = self.experiment.range;
        let beyond = upper - lower;
        add("limits.angle_lower", Value::Real(lower - beyond));
        add("limits.angle_upper", Value::Real(upper + beyond));
        let alone = !matches!(knowledge, Knowledge::Identified(_));
        let law = if alone { "lqri" } else { "lqr" };
        add("feedback.law", Value::Enumeration(law.to_owned()));
        if alone {
            add("feedback.weight_integral", Value::Real(INTEGRAL));
            let nothing = parameter_set(
                &arm::Parameters {
                    inertia: 1e-9,
                    damping: 0.0,
                    stiffness: 0.0,
                    offset: 0.0,
                    hysteresis: 0.0,
                    cogging_frequency: 0.0,
                    cogging_cos: [0.0; arm::HARMONICS],
                    cogging_sin: [0.0; arm::HARMONICS],
                },
                None,
                "",
            );
            let of_the_arm = nothing.parameters.into_iter();
            set.units = nothing.units;
            set.parameters
                .extend(of_the_arm.filter(|p| p.name.starts_with("arm.")));
        }
        set
    }

    /// What a recording shows from `first` \[s\] on.
    fn signals(&self, recording: &Recording, first: f64) -> Result<Signals, Error> {
        let role = |role: Role, missing: &'static str| {
            recording
                .role(role)
                .ok_or(Error::Input(input::Error::Purposeless {
                    file: "--connections".to_owned(),
                    missing,
                    swapped: false,
                }))
        };
        let mut torque = role(Role::Torque, "no signal plays the role of the torque")?;
        if self.experiment.order == Order::SideBySide && !torque.is_empty() {
            // The plant gets the torque of a step in the next one.
            torque.rotate_right(1);
            torque[0] = 0.0;
        }
        let time = recording.column(0);
        let skip = time.partition_point(|t| *t < first);
        let cut = |mut values: Vec<f64>| values.split_off(skip.min(values.len()));
        Ok(Signals {
            angle: cut(role(Role::Angle, "no signal plays the role of the angle")?),
            torque: cut(torque),
            reference: recording.role(Role::ReferenceAngle).map(cut),
            feedforward: recording.role(Role::FeedforwardTorque).map(cut),
            feedback: recording.role(Role::FeedbackTorque).map(cut),
            time: cut(time),
        })
    }

    fn measurement(&self, signals: &Signals) -> Measurement {
        Measurement {
            period: self.experiment.step,
            timing: Timing::Held,
            segments: vec![Segment {
                start: signals.time.first().copied().unwrap_or(0.0),
                angle: signals.angle.clone(),
                torque: signals.torque.clone(),
            }],
        }
    }

    fn identify(
        &self,
        name: &str,
        outcome: &Outcome,
        settings: &Settings,
    ) -> Result<(Identification, Measurement), Error> {
        let measurement = self.measurement(&self.signals(&outcome.recording, START)?);
        let identification = identify(&measurement, settings)
            .map_err(|source| identification_error(name, source))?;
        Ok((identification, measurement))
    }
}

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
struct Random(u64);

impl Random {
    /// Uniform in [0, 1).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
