//! A run: both FMUs set up, connected, stepped, recorded and scored.
//!
//! ```no_run
//! use host::{Simulation, simulate};
//! use std::ops::ControlFlow;
//!
//! # fn main() -> Result<(), host::Error> {
//! let mut simulation = Simulation::new("FlexArmController.fmu", "FlexArmPlant.fmu");
//! simulation.until = Some(2.0);
//! let outcome = simulate(&simulation, &mut |_done| ControlFlow::Continue(()))?;
//! println!("{:?}", outcome.summary.score.squared_error_rad2);
//! # Ok(())
//! # }
//! ```

mod master;
mod plan;
pub mod recording;
pub mod score;
pub mod summary;

use crate::Error;
use crate::fmu::{Experiment, Fmu, Instance, Message};
use crate::input::connections::{Source, Wiring};
use crate::input::parameters::{Assignment, ParameterFile, StartValues};
use crate::input::roles::Role;
use crate::input::setpoints::{AngleLimits, Table};
use crate::input::{self, Pair, Side};
use master::Master;
use plan::Plan;
use recording::Recording;
use score::Terms;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;
use summary::{Given, Summary, Timing, Unit};

/// Which FMU steps first.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// The controller steps first, the plant with its fresh outputs: no delay.
    #[default]
    Sequential,
    /// Both step with what they knew at the communication point: one step of delay.
    SideBySide,
}

impl std::fmt::Display for Order {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Sequential => "sequential",
            Self::SideBySide => "side-by-side",
        })
    }
}

/// What to run. Runs start at time 0.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// FMU of the controller.
    pub controller: PathBuf,
    /// FMU of the plant.
    pub plant: PathBuf,
    /// Parameter files, in order.
    pub parameters: Vec<ParameterFile>,
    /// Single values, after the files.
    pub assignments: Vec<Assignment>,
    /// Setpoints over time. None: the angle at which the plant starts, all the time.
    pub setpoints: Option<PathBuf>,
    /// Connections and roles. None: by the names of the contract.
    pub connections: Option<PathBuf>,
    /// End of the run \[s\]. None: the end of the setpoints, or else the plant's default experiment, or else
    /// the controller's, or else 1 s.
    pub until: Option<f64>,
    /// Communication step \[s\].
    pub step: f64,
    /// Which FMU steps first.
    pub order: Order,
    /// Records every n-th communication point.
    pub record_every: usize,
    /// Asks the FMUs for debug messages.
    pub logging: bool,
}

impl Simulation {
    /// A pair of FMUs with the default settings: steps of 0.25 ms, controller first, everything recorded.
    pub fn new(controller: impl Into<PathBuf>, plant: impl Into<PathBuf>) -> Self {
        Self {
            controller: controller.into(),
            plant: plant.into(),
            parameters: Vec::new(),
            assignments: Vec::new(),
            setpoints: None,
            connections: None,
            until: None,
            step: 0.000_25,
            order: Order::Sequential,
            record_every: 1,
            logging: false,
        }
    }

    fn setpoints_name(&self) -> String {
        self.setpoints
            .as_ref()
            .map_or(String::new(), |path| path.display().to_string())
    }
}

/// What a run yields.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Score and circumstances.
    pub summary: Summary,
    /// The samples.
    pub recording: Recording,
    /// Limits of the angle, if they are known.
    pub angle_limits: Option<AngleLimits>,
    /// Limit of the thermal load \[A²\], if it is known.
    pub thermal_limit: Option<f64>,
    /// What the FMUs logged.
    pub messages: Vec<(Side, Message)>,
}

/// Opens both FMUs and runs them. `progress` is told now and then which fraction of the run is done, and may
/// stop it.
pub fn simulate(
    simulation: &Simulation,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Outcome, Error> {
    let controller = Fmu::open(&simulation.controller)?;
    let plant = Fmu::open(&simulation.plant)?;
    simulate_opened(simulation, &controller, &plant, progress)
}

/// The same with FMUs that are open already: many runs unpack and load them once.
pub fn simulate_opened(
    simulation: &Simulation,
    controller: &Fmu,
    plant: &Fmu,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Outcome, Error> {
    let pair = Pair {
        controller: controller.description(),
        plant: plant.description(),
    };
    let values = StartValues::read(pair, &simulation.parameters, &simulation.assignments)?;
    let wiring = Wiring::read(pair, simulation.connections.as_deref())?;
    let limits = angle_limits(pair, &values);
    let table = match &simulation.setpoints {
        Some(path) => Some(Table::read(path, pair, limits)?),
        None => None,
    };
    let steps = steps(simulation, pair, table.as_ref())?;
    let experiment = Experiment {
        stop: Some(steps as f64 * simulation.step),
        ..Experiment::default()
    };

    let mut instances = Instances {
        controller: start(
            controller,
            Side::Controller,
            &values,
            &experiment,
            simulation.logging,
        )?,
        plant: start(plant, Side::Plant, &values, &experiment, simulation.logging)?,
    };
    let table = match table {
        Some(table) => table,
        None => Table::constant(start_angle(&mut instances, &wiring)?),
    };
    let plan = Plan::new(pair, &wiring, &table, simulation)?;
    let thermal_limit = both(|side| values.number(pair, side, "motor.continuous_current"))
        .map(|current| current * current);
    let terms = Terms {
        step: simulation.step,
        first: table
            .first_change()
            .map_or(0, |time| plan::step_of(time, simulation.step)),
        limits,
        thermal_limit,
        plan_period: values.number(pair, Side::Controller, "nmpc.period"),
    };
    let mut warnings = warnings(pair, &wiring, simulation.step);
    warnings.extend(plan.warnings.iter().cloned());
    let rows = steps.div_ceil(simulation.record_every);
    check_size(rows, plan.columns.len())?;
    let begin = Instant::now();
    let mut master = Master::new(plan, &table, simulation, rows, terms, &mut instances)?;
    master.run(&mut instances, steps, progress)?;
    let wall = begin.elapsed().as_secs_f64();
    instances.controller.terminate()?;
    instances.plant.terminate()?;

    let simulated = steps as f64 * simulation.step;
    let (score, recording, controller_time) = master.finish();
    let messages = instances.messages();
    let summary = Summary {
        controller: Unit::new(controller),
        plant: Unit::new(plant),
        given: Given::new(simulation),
        order: simulation.order,
        step_s: simulation.step,
        steps: steps as u64,
        until_s: simulated,
        score,
        timing: Timing {
            wall_s: wall,
            real_time_factor: simulated / wall,
            controller_mean_us: controller_time.as_secs_f64() * 1e6 / steps as f64,
        },
        warnings,
    };
    Ok(Outcome {
        summary,
        recording,
        angle_limits: limits,
        thermal_limit,
        messages,
    })
}

/// Both instances of a run.
struct Instances {
    controller: Instance,
    plant: Instance,
}

impl Instances {
    fn of(&mut self, side: Side) -> &mut Instance {
        match side {
            Side::Controller => &mut self.controller,
            Side::Plant => &mut self.plant,
        }
    }

    fn messages(&self) -> Vec<(Side, Message)> {
        let of = |side, instance: &Instance| {
            instance
                .messages()
                .into_iter()
                .map(move |message| (side, message))
        };
        of(Side::Controller, &self.controller)
            .chain(of(Side::Plant, &self.plant))
            .collect()
    }
}

/// An instance in Initialization Mode, with the user's values.
fn start(
    fmu: &Fmu,
    side: Side,
    values: &StartValues,
    experiment: &Experiment,
    logging: bool,
) -> Result<Instance, Error> {
    let mut instance = fmu.instantiate(&side.to_string(), logging)?;
    instance.set_start_values(&values.of(side))?;
    instance.enter_initialization(experiment)?;
    Ok(instance)
}

/// What the plant knows, or else the controller.
fn both<T>(known: impl Fn(Side) -> Option<T>) -> Option<T> {
    known(Side::Plant).or_else(|| known(Side::Controller))
}

fn angle_limits(pair: Pair<'_>, values: &StartValues) -> Option<AngleLimits> {
    both(|side| {
        Some(AngleLimits {
            lower: values.number(pair, side, "limits.angle_lower")?,
            upper: values.number(pair, side, "limits.angle_upper")?,
        })
    })
}

/// Where the arm starts, or 0 if nothing tells.
fn start_angle(instances: &mut Instances, wiring: &Wiring) -> Result<f64, Error> {
    let Some(tap) = wiring.roles.get(&Role::Angle) else {
        return Ok(0.0);
    };
    let Source::Output(side, scalar) = tap.source else {
        return Ok(0.0);
    };
    Ok(tap.factor * instances.of(side).value(scalar)? + tap.offset)
}

/// Number of whole communication steps of the run.
fn steps(simulation: &Simulation, pair: Pair<'_>, table: Option<&Table>) -> Result<usize, Error> {
    let setting = |name, value: f64, expected: &str| input::Error::Setting {
        name,
        value: value.to_string(),
        expected: expected.to_owned(),
    };
    if !(simulation.step.is_finite() && simulation.step > 0.0) {
        return Err(setting("--step", simulation.step, "a positive time in s").into());
    }
    if simulation.record_every == 0 {
        return Err(setting("--record", 0.0, "at least 1").into());
    }
    let until = simulation
        .until
        .or_else(|| table.and_then(Table::duration))
        .or(pair.plant.default_experiment.stop_time)
        .or(pair.controller.default_experiment.stop_time)
        .unwrap_or(1.0);
    let steps = (until / simulation.step + 1e-6).floor();
    // A step is counted in f64 without rounding up to 2⁵³; a billion of 0.25 ms is three days.
    if !(1.0..=1e9).contains(&steps) {
        let expected = "a time in s that holds from one to 10⁹ communication steps";
        return Err(setting("--until", until, expected).into());
    }
    Ok(steps as usize)
}

/// Refuses recordings that would not fit in memory.
fn check_size(rows: usize, columns: usize) -> Result<(), Error> {
    const LIMIT: usize = 1 << 29;
    if rows.saturating_mul(columns) <= LIMIT {
        return Ok(());
    }
    Err(input::Error::Setting {
        name: "--record",
        value: format!("{rows} rows of {columns} values"),
        expected: format!("at most {LIMIT} values: record every n-th communication point"),
    }
    .into())
}

fn warnings(pair: Pair<'_>, wiring: &Wiring, step: f64) -> Vec<String> {
    let mut warnings = wiring.warnings.clone();
    if !wiring
        .connections
        .iter()
        .any(|c| c.tap.source == Source::Setpoint)
    {
        warnings.push("the setpoint is connected to no input".to_owned());
    }
    if !wiring.roles.contains_key(&Role::Angle) {
        warnings.push("no signal plays the role of the angle: the run is not scored".to_owned());
    }
    for side in [Side::Controller, Side::Plant] {
        let description = pair.of(side);
        if !description.problems.is_empty() {
            warnings.push(format!(
                "{side}: modelDescription.xml has {} problems (flexarm inspect lists them)",
                description.problems.len()
            ));
        }
        let fixed = description.co_simulation.as_ref().and_then(|c| {
            c.fixed_internal_step
                .filter(|_| !c.can_handle_variable_step)
        });
        if let Some(fixed) = fixed
            && ((step / fixed).round() < 1.0
                || (step / fixed - (step / fixed).round()).abs() > 1e-6)
        {
            warnings.push(format!(
                "{side} steps by {fixed} s: {step} s is no multiple of it"
            ));
        }
    }
    warnings
}
