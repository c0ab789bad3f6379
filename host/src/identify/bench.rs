//! Both FMUs of the experiments: where their angle stays, what they are given, and what a run of them shows.

use super::checks::{NO_ANGLE, NO_TORQUE, complete, purposeless, range};
use super::experiment::{Experiment, Failed, identification_error};
use super::overshoot::{Kept, Overshoot};
use super::{Kind, Made, parameter_set};
use crate::Error;
use crate::fmu::Fmu;
use crate::input::connections::Wiring;
use crate::input::measurement::Signals;
use crate::input::parameters::{Assignment, ParameterFile, ParameterSets, StartValues};
use crate::input::roles::Role;
use crate::input::setpoints::{AngleLimits, Setpoints};
use crate::input::{self, Pair, Place, Side};
use crate::run::recording::Recording;
use crate::run::{Outcome, Simulation, simulate_opened};
use ::identification::{Identification, Measurement, Segment, Settings, Timing, identify};
use arm::random::uniform;
use model_description::ssv::{self, Parameter, ParameterSet, Value};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Time at the start of an experiment that is left out \[s\]: the arm comes to rest at the first setpoint.
pub(super) const START: f64 = 5.0;
/// Weight of the integral in the feedback \[1/s²\] when nothing else holds the arm.
const INTEGRAL: f64 = 0.25;
/// Of so many setpoints the first three go from end to end: what chance leaves out is not identified.
const ROUND: usize = 8;

/// Names of the arm's parameters begin so.
const ARM: &str = "arm.";
/// Names of the feedback's parameters begin so.
const FEEDBACK: &str = "feedback.";
/// No model of the arm: feedforward of nothing. The contract demands some inertia.
const NO_ARM: arm::Parameters = arm::Parameters {
    inertia: 1e-9,
    damping: 0.0,
    stiffness: 0.0,
    offset: 0.0,
    hysteresis: 0.0,
    cogging_frequency: 0.0,
    cogging_cos: [0.0; arm::HARMONICS],
    cogging_sin: [0.0; arm::HARMONICS],
};

/// What the controller is told about the arm.
#[derive(Clone, Copy)]
pub(super) enum Knowledge<'a> {
    /// Nothing.
    Nothing,
    /// Inertia and damping, for the design of the feedback.
    Design(&'a Identification),
    /// The same, and no feedforward even if the user gives it a model.
    Feedback(&'a Identification),
    /// All.
    Identified(&'a Identification),
}

/// Where setpoints lie between their ends.
#[derive(Clone, Copy)]
pub(super) enum Places {
    /// From one end to the other and back.
    Ends,
    /// Random ones by a seed, now and then both ends.
    Random(u64),
}

/// Both FMUs and a place for what they are given.
pub(super) struct Bench<'a> {
    experiment: &'a Experiment,
    /// Where the angle stays.
    pub(super) range: AngleLimits,
    controller: Fmu,
    plant: Fmu,
    folder: tempfile::TempDir,
}

impl<'a> Bench<'a> {
    pub(super) fn new(experiment: &'a Experiment) -> Result<Self, Error> {
        let controller = Fmu::open(&experiment.controller)?;
        let plant = Fmu::open(&experiment.plant)?;
        let pair = Pair::new(&controller, &plant);
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
        complete(&wiring)?;
        let values = StartValues::new(
            pair,
            &ParameterSets::read(&experiment.parameters)?,
            &experiment.assignments,
        )?;
        let range = range(experiment, pair, &values)?;
        let folder = tempfile::Builder::new()
            .prefix("flexarm-identify-")
            .tempdir()
            .map_err(|source| Error::OutputFolder {
                path: std::env::temp_dir(),
                source,
            })?;
        Ok(Self {
            experiment,
            range,
            controller,
            plant,
            folder,
        })
    }

    /// A file of setpoints between `ends`, in whose middle the arm rests first.
    pub(super) fn setpoints(
        &self,
        ends: AngleLimits,
        places: Places,
        interval: f64,
        duration: f64,
    ) -> Result<PathBuf, Error> {
        let AngleLimits { lower, upper } = ends;
        let mut random = match places {
            Places::Random(seed) => seed,
            Places::Ends => 0,
        };
        let mut text = format!("time,setpoint\n0,{:?}\n", 0.5 * (lower + upper));
        let count = (duration / interval).ceil() as usize;
        for k in 0..count.max(1) {
            let place = match (places, k % ROUND) {
                (Places::Random(_), 3..) => uniform(&mut random),
                (_, k) => (k % 2) as f64,
            };
            let setpoint = (lower + place * (upper - lower)).clamp(lower, upper);
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

    pub(super) fn run(
        &self,
        kind: Kind,
        knowledge: Knowledge<'_>,
        setpoints: &Path,
        until: f64,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Outcome, Failed> {
        let e = self.experiment;
        let start = self.file("experiment.ssv", &ssv::write(&self.defaults()))?;
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
            place: Place::new("identify", None),
        };
        simulation
            .assignments
            .push(forced("reference.source", "profile"));
        let mut force = |arm: &arm::Parameters, prefix: &str| {
            let set = parameter_set(arm, None, "");
            let values = set.parameters.iter().filter(|p| p.name.starts_with(prefix));
            simulation
                .assignments
                .extend(values.map(|p| forced(&p.name, &p.value.to_string())));
        };
        match knowledge {
            Knowledge::Nothing => {}
            Knowledge::Design(known) => force(&known.parameters, FEEDBACK),
            Knowledge::Feedback(known) => {
                force(&known.parameters, FEEDBACK);
                force(&NO_ARM, ARM);
            }
            Knowledge::Identified(known) => force(&known.parameters, ""),
        }
        simulation.setpoints = Some(Setpoints::File(setpoints.to_owned()));
        simulation.connections.clone_from(&e.connections);
        simulation.until = Some(until);
        simulation.step = e.step;
        simulation.order = e.order;
        simulation.stop_outside = Some(self.range);
        simulate_opened(&simulation, &self.controller, &self.plant, progress).map_err(|error| {
            let Error::Stopped { source, partial } = error else {
                return error.into();
            };
            let source = self.explained(source);
            let signals = self.signals(&partial.recording, 0.0).ok();
            let partial = signals.filter(|signals| !signals.time.is_empty());
            Failed {
                error: source,
                partial: partial.map(|signals| Box::new((kind, signals))),
            }
        })
    }

    /// An arm that starts outside the range has not left it.
    fn explained(&self, error: Box<Error>) -> Box<Error> {
        match *error {
            Error::LeftRange {
                angle, time: 0.0, ..
            } => {
                let AngleLimits { lower, upper } = self.range;
                let (name, value, side) = if angle < lower {
                    ("--lower", lower, "most")
                } else {
                    ("--upper", upper, "least")
                };
                Box::new(Error::Input(input::Error::Setting {
                    name: name.to_owned(),
                    value: value.to_string(),
                    expected: format!("at {side} {angle} rad, where the plant starts"),
                }))
            }
            _ => error,
        }
    }

    /// What the controller gets before the user's own values: no model of the arm, and a feedback with integral,
    /// without which an arm on feedback alone would sag by the torque that holds it divided by the gain: the T-flex
    /// by 0.1 rad.
    fn defaults(&self) -> ParameterSet {
        let nothing = parameter_set(&NO_ARM, None, "");
        let of_the_arm = nothing.parameters.into_iter();
        let mut set = ParameterSet {
            name: "experiment".to_owned(),
            units: nothing.units,
            parameters: of_the_arm.filter(|p| p.name.starts_with(ARM)).collect(),
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
        // The controller keeps its own setpoints off its limits; here they are chosen with that in mind.
        let AngleLimits { lower, upper } = self.range;
        let beyond = upper - lower;
        add("limits.angle_lower", Value::Real(lower - beyond));
        add("limits.angle_upper", Value::Real(upper + beyond));
        add("feedback.law", Value::Enumeration("lqri".to_owned()));
        add("feedback.weight_integral", Value::Real(INTEGRAL));
        set
    }

    /// What a recording shows from `first` \[s\] on.
    pub(super) fn signals(&self, recording: &Recording, first: f64) -> Result<Signals, Error> {
        let role = |role: Role, missing| recording.role(role).ok_or(purposeless(missing));
        let time = recording.column(0);
        let skip = time.partition_point(|t| *t < first);
        let cut = |mut values: Vec<f64>| values.split_off(skip.min(values.len()));
        Ok(Signals {
            angle: cut(role(Role::Angle, NO_ANGLE)?),
            torque: cut(role(Role::Torque, NO_TORQUE)?),
            reference: recording.role(Role::ReferenceAngle).map(cut),
            feedforward: recording.role(Role::FeedforwardTorque).map(cut),
            feedback: recording.role(Role::FeedbackTorque).map(cut),
            time: cut(time),
        })
    }

    /// How far the arm overshot once it had come to rest at the first setpoint.
    pub(super) fn overshoot(&self, kept: &Kept<Outcome>) -> Result<Overshoot, Error> {
        let signals = self.signals(&kept.result.recording, START)?;
        Ok(Overshoot::seen(kept.ends, &signals.angle))
    }

    /// What was made of an experiment.
    pub(super) fn made(&self, kind: Kind, kept: &Kept<Outcome>) -> Result<Made, Error> {
        let recording = &kept.result.recording;
        let angles = self.signals(recording, 0.0)?.angle;
        let outside = angles.iter().filter(|angle| !self.range.contains(**angle));
        let fold = |start, pick: fn(f64, f64) -> f64| angles.iter().copied().fold(start, pick);
        Ok(Made {
            kind,
            setpoints: [kept.ends.lower, kept.ends.upper],
            angles: [
                fold(f64::INFINITY, f64::min),
                fold(f64::NEG_INFINITY, f64::max),
            ],
            outside: outside.count() as u64,
            violations: recording
                .slot(Role::Violations)
                .and(kept.result.summary.score.violations),
            attempts: kept.attempts,
        })
    }

    pub(super) fn measurement(&self, signals: &Signals) -> Measurement {
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

    pub(super) fn identify(
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
