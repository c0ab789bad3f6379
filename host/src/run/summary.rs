//! What a run comes to: for people a table, for scripts JSON.

use super::score::Score;
use super::{Order, Simulation};
use crate::fmu::Fmu;
use crate::table::quantities;
use serde::{Deserialize, Serialize};

/// One of the two FMUs of a run.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Unit {
    /// File.
    pub file: String,
    /// `modelName`.
    pub model: String,
    /// `version` of the model; may be empty.
    pub version: String,
    /// Version of the standard.
    pub fmi: String,
}

impl Unit {
    pub(crate) fn new(fmu: &Fmu) -> Self {
        let description = fmu.description();
        Self {
            file: fmu.file().display().to_string(),
            model: description.model_name.clone(),
            version: description.model_version.clone(),
            fmi: description.fmi_version.clone(),
        }
    }
}

/// What the user gave beside the FMUs.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
pub struct Given {
    /// Parameter files, in order.
    pub parameters: Vec<String>,
    /// Single values, in order.
    pub assignments: Vec<String>,
    /// Setpoint file, or where the setpoints stand.
    pub setpoints: Option<String>,
    /// Connections file.
    pub connections: Option<String>,
}

impl Given {
    pub(super) fn new(simulation: &Simulation) -> Self {
        Self {
            parameters: simulation
                .parameters
                .iter()
                .map(ToString::to_string)
                .collect(),
            assignments: simulation
                .assignments
                .iter()
                .map(ToString::to_string)
                .collect(),
            setpoints: simulation.setpoints.as_ref().map(ToString::to_string),
            connections: simulation
                .connections
                .as_ref()
                .map(|path| path.display().to_string()),
        }
    }
}

/// How fast the run was, by the wall clock.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Timing {
    /// Duration of the run without set-up \[s\].
    pub wall_s: f64,
    /// Simulated time by wall-clock time.
    pub real_time_factor: f64,
    /// Mean duration of a step of the controller \[µs\].
    pub controller_mean_us: f64,
}

/// The end of a run before its time.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Stopped {
    /// What went wrong.
    pub reason: String,
    /// When the run should have ended \[s\].
    pub planned_s: f64,
}

/// What a run comes to. Everything but `timing` is the same in every repetition.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Summary {
    /// The controller.
    pub controller: Unit,
    /// The plant.
    pub plant: Unit,
    /// What the user gave beside them.
    pub given: Given,
    /// Which FMU stepped first.
    pub order: Order,
    /// Communication step \[s\].
    pub step_s: f64,
    /// Number of steps.
    pub steps: u64,
    /// End of the run \[s\].
    pub until_s: f64,
    /// Why it ended before its time, if it did: the result is partial then.
    #[serde(default)]
    pub stopped: Option<Stopped>,
    /// Score.
    pub score: Score,
    /// Speed.
    pub timing: Timing,
    /// What may be meant but looks wrong.
    pub warnings: Vec<String>,
}

impl Summary {
    /// What ran, in one sentence.
    pub fn headline(&self) -> String {
        let unit = |u: &Unit| {
            let version = if u.version.is_empty() {
                String::new()
            } else {
                format!(" {}", u.version)
            };
            format!("{}{version} (FMI {})", u.model, u.fmi)
        };
        format!(
            "{} with {}, {}, communication step {} ms",
            unit(&self.controller),
            unit(&self.plant),
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
        row("simulated", number(self.until_s), "s");
        if let Some(stopped) = &self.stopped {
            row("PARTIAL: planned", number(stopped.planned_s), "s");
        }
        let score = &self.score;
        let cost = score.squared_error_rad2;
        row(
            "squared error (4 kHz)",
            cost.map_or("-".to_owned(), number),
            "rad2",
        );
        if cost.is_some() {
            row("scored from", number(score.scored_from_s), "s");
        }
        for (name, value, unit) in [
            ("largest scored error", score.max_error_rad, "rad"),
            ("largest torque", score.max_torque_n_m, "N.m"),
            ("largest thermal fraction", score.max_thermal_fraction, "1"),
        ] {
            if let Some(value) = value {
                row(name, number(value), unit);
            }
        }
        if let Some(violations) = score.violations {
            row("limit violations", violations.to_string(), "samples");
        }
        if let Some(planner) = &score.planner {
            row("plans", planner.plans.to_string(), "");
            for (status, count) in &planner.statuses {
                row(&format!("plans: {status}"), count.to_string(), "");
            }
            if let Some(mean) = planner.mean_iterations {
                row(
                    "interior-point iterations (0: closed form), mean",
                    number(mean),
                    "per plan",
                );
            }
            if let Some(max) = planner.max_iterations {
                row(
                    "interior-point iterations, most",
                    max.to_string(),
                    "per plan",
                );
            }
        }
        row(
            "controller step, mean",
            number(self.timing.controller_mean_us),
            "us",
        );
        row("real-time factor", number(self.timing.real_time_factor), "");
        rows
    }

    /// All quantities, aligned, under the headline.
    pub fn table(&self) -> String {
        let table = quantities(self.rows());
        format!("{}\n{}", self.headline(), table.trim_fmt())
    }
}

/// A number with six significant digits.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = 5 - value.abs().log10().floor() as i32;
    if (0..=12).contains(&digits) {
        let text = format!("{value:.*}", digits as usize);
        match text.split_once('.') {
            Some(_) => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            None => text,
        }
    } else {
        format!("{value:.5e}")
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::score::Planner;
    use super::*;

    pub(crate) fn summary() -> Summary {
        let unit = Unit {
            file: "a.fmu".into(),
            model: "A".into(),
            version: "1".into(),
            fmi: "3.0".into(),
        };
        Summary {
            controller: unit.clone(),
            plant: unit,
            given: Given::default(),
            order: Order::SideBySide,
            step_s: 0.000_25,
            steps: 4000,
            until_s: 1.0,
            stopped: None,
            score: Score {
                squared_error_rad2: Some(251.505_447_6),
                planner: Some(Planner {
                    plans: 20,
                    statuses: [("solved".to_owned(), 20)].into(),
                    ..Planner::default()
                }),
                ..Score::default()
            },
            timing: Timing {
                wall_s: 0.01,
                real_time_factor: 100.0,
                controller_mean_us: 2.0,
            },
            warnings: vec!["w".into()],
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (251.505_447_6, "251.505"),
            (0.0, "0"),
            (-1.5, "-1.5"),
            (1e-9, "1.00000e-9"),
            (123_456.7, "123457"),
            (0.000_25, "0.00025"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn the_summary_survives_json() {
        let json = serde_json::to_string_pretty(&summary()).unwrap();
        assert!(
            json.contains(r#""order": "side-by-side""#)
                && json.contains(r#""max_torque_n_m": null"#)
        );
        assert_eq!(serde_json::from_str::<Summary>(&json).unwrap(), summary());
    }

    #[test]
    fn the_table_shows_what_is_known() {
        let table = summary().table();
        assert!(
            table.contains("251.505")
                && table.contains("side-by-side")
                && table.contains("plans: solved")
        );
        assert!(!table.contains("largest torque"));
        let mut nothing = summary();
        nothing.score.squared_error_rad2 = None;
        assert_eq!(nothing.rows()[1][..2], ["squared error (4 kHz)", "-"]);
        let headline = "A 1 (FMI 3.0) with A 1 (FMI 3.0), side-by-side, communication step 0.25 ms";
        assert!(table.starts_with(headline));
    }
}
