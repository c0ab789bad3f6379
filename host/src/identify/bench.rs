//! Both FMUs of the experiments: what they are given, and what a run of them shows.

use super::experiment::{Experiment, Failed, identification_error};
use super::parameter_set;
use crate::Error;
use crate::fmu::Fmu;
use crate::input::connections::Wiring;
use crate::input::measurement::Signals;
use crate::input::parameters::{Assignment, ParameterFile, StartValues};
use crate::input::roles::Role;
use crate::input::setpoints::{AngleLimits, Setpoints};
use crate::input::{self, Pair, Place, Side};
use crate::run::recording::Recording;
use crate::run::{Order, Outcome, Simulation, angle_limits, simulate_opened};
use ::identification::{Identification, Measurement, Segment, Settings, Timing, identify};
use model_description::ssv::{self, Parameter, ParameterSet, Value};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Time at the start of an experiment that is left out \[s\]: the arm comes to rest at the first setpoint.
pub(super) const START: f64 = 5.0;
/// Weight of the integral in the feedback \[1/s²\] when nothing else holds the arm.
const INTEGRAL: f64 = 0.25;
/// Of so many setpoints two are the ends of the range.
const ENDS: usize = 8;

/// What the controller is told about the arm.
#[derive(Clone, Copy)]
pub(super) enum Knowledge<'a> {
    /// Nothing.
    Nothing,
    /// Inertia and damping, for the design of the feedback.
    Design(&'a Identification),
    /// All.
    Identified(&'a Identification),
}

/// Both FMUs and a place for what they are given.
pub(super) struct Bench<'a> {
    experiment: &'a Experiment,
    controller: Fmu,
    plant: Fmu,
    folder: tempfile::TempDir,
}

impl<'a> Bench<'a> {
    pub(super) fn new(experiment: &'a Experiment) -> Result<Self, Error> {
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
    pub(super) fn setpoints(
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

    pub(super) fn run(
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
            place: Place::new("identify", None),
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
        simulation.setpoints = Some(Setpoints::File(setpoints.to_owned()));
        simulation.connections.clone_from(&e.connections);
        simulation.until = Some(until);
        simulation.step = e.step;
        simulation.order = e.order;
        let beyond = e.range.upper - e.range.lower;
        simulation.stop_outside = Some(AngleLimits {
            lower: e.range.lower - beyond,
            upper: e.range.upper + beyond,
        });
        simulate_opened(&simulation, &self.controller, &self.plant, progress).map_err(|error| {
            let Error::Stopped { source, partial } = error else {
                return error.into();
            };
            let signals = self.signals(&partial.recording, 0.0).ok();
            let partial = signals.filter(|signals| !signals.time.is_empty());
            Failed {
                error: source,
                partial: partial.map(|signals| Box::new((name.to_owned(), signals))),
            }
        })
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
    pub(super) fn signals(&self, recording: &Recording, first: f64) -> Result<Signals, Error> {
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
