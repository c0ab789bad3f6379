//! What a run of a system comes to: for people a table, for scripts JSON.

use crate::run::Order;
use crate::run::summary::{Stopped, Unit, number};
use crate::table::quantities;
use serde::{Deserialize, Serialize};

/// What a run comes to. Everything but the wall-clock time is the same in every repetition.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct SystemSummary {
    /// The package.
    pub package: String,
    /// Name that the system structure gives itself.
    pub name: String,
    /// The components in the order in which they step, with their FMUs.
    pub components: Vec<(String, Unit)>,
    /// File with values over time for the inputs of the system.
    pub inputs: Option<String>,
    /// How values travel.
    pub order: Order,
    /// Start \[s\].
    pub start_s: f64,
    /// Communication step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: u64,
    /// End \[s\].
    pub until_s: f64,
    /// Why it ended before its time, if it did.
    pub stopped: Option<Stopped>,
    /// Duration by the wall clock without set-up \[s\].
    pub wall_s: f64,
    /// What may be meant but looks wrong.
    pub warnings: Vec<String>,
}

impl SystemSummary {
    /// What ran, in one sentence.
    pub fn headline(&self) -> String {
        format!(
            "{} of {}, {}, communication step {} ms",
            self.name,
            self.package,
            self.order,
            self.step_s * 1e3
        )
    }

    /// Name, value and unit of every quantity, as text.
    pub fn rows(&self) -> Vec<[String; 3]> {
        let mut rows = Vec::new();
        let mut row = |name: &str, value: String, unit: &str| {
            rows.push([name.to_owned(), value, unit.to_owned()]);
        };
        for (path, unit) in &self.components {
            row(path, format!("{} (FMI {})", unit.model, unit.fmi), "");
        }
        row("simulated until", number(self.until_s), "s");
        if let Some(stopped) = &self.stopped {
            row("PARTIAL: planned", number(stopped.planned_s), "s");
        }
        let simulated = self.until_s - self.start_s;
        row("real-time factor", number(simulated / self.wall_s), "");
        rows
    }

    /// All quantities, aligned, under the headline.
    pub fn table(&self) -> String {
        let table = quantities(self.rows());
        format!("{}\n{}", self.headline(), table.trim_fmt())
    }
}
