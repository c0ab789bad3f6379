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

pub(crate) mod checks;
pub(crate) mod instances;
pub(crate) mod master;
pub(crate) mod plan;
mod prepared;
pub mod recording;
pub mod score;
pub mod summary;

pub use prepared::Prepared;
pub(crate) use prepared::angle_limits;

use crate::Error;
use crate::fmu::{Fmu, Message};
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::setpoints::{AngleLimits, Setpoints};
use crate::input::{Place, Side};
use recording::Recording;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::PathBuf;
use summary::Summary;

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

/// Communication step unless another one is given \[s\].
pub const DEFAULT_STEP: f64 = 0.000_25;

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
    pub setpoints: Option<Setpoints>,
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
    /// Stops the run when the angle leaves these.
    pub stop_outside: Option<AngleLimits>,
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
            step: DEFAULT_STEP,
            order: Order::Sequential,
            record_every: 1,
            logging: false,
            stop_outside: None,
        }
    }

    /// Where the setpoints stand; in a file the first line.
    fn setpoints_place(&self) -> Place {
        match &self.setpoints {
            Some(Setpoints::File(path)) => Place::new(path.display().to_string(), None),
            Some(Setpoints::Rows { place, .. }) => place.clone(),
            None => Place::new("", None),
        }
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

/// Opens both FMUs and runs them. `progress` is told before every step, and at the end, which fraction of the
/// run is done, and may stop it: it must be quick.
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
    Prepared::new(simulation, controller, plant)?.run(progress)
}
