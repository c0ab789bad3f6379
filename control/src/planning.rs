//! What makes the plans: taken out of the controller while it works, so that samples can go on meanwhile.

use serde::{Deserialize, Serialize};

use crate::latency::Prediction;
use crate::nmpc::planner::Planner;
use crate::nmpc::problem::Initial;

/// The planner, and what it plans from.
pub struct Planning {
    pub(crate) planner: Planner,
    /// None where plans are applied at once, or start from the state as measured.
    pub(crate) prediction: Option<Prediction>,
    pub(crate) from: Origin,
}

/// A sample, as a plan begins with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Origin {
    /// Its number.
    pub(crate) sample: u64,
    /// State as measured.
    pub(crate) measured: Initial,
    /// Move in force \[rad/s²\].
    pub(crate) acceleration: f64,
    /// Rest point of the plan in force \[rad\].
    pub(crate) goal: f64,
    /// Setpoint in force \[rad\].
    pub(crate) setpoint: f64,
}

impl Planning {
    /// Makes the plan.
    pub fn run(&mut self) {
        let Origin {
            measured,
            acceleration,
            goal,
            setpoint,
            ..
        } = self.from;
        let initial = match &mut self.prediction {
            Some(prediction) => prediction.predict(&measured, acceleration, goal),
            None => measured,
        };
        self.planner.plan(&initial, setpoint);
    }
}

/// Whether a sample makes a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// When `nmpc.period` has gone by since the plan before.
    Due,
    /// Now.
    Now,
    /// Plans are made by somebody else's clock.
    Never,
}
