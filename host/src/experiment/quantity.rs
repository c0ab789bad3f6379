//! Numbers that a run comes to: fields of its score, and statistics of recorded signals.

use crate::Outcome;
use crate::run::recording::Recording;
use std::fmt;
use std::str::FromStr;

/// A number that a run comes to.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// A field of the score, by its name in `summary.json`.
    Score(ScoreField),
    /// Number of plans of a status: `plans.STATUS`.
    Plans(String),
    /// A statistic of a signal over the recorded points: `max(plant.angle)`.
    Statistic(Statistic, Signal),
}

/// Fields of [`crate::run::score::Score`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as the fields that they read")]
pub enum ScoreField {
    SquaredError,
    Violations,
    MaxError,
    MaxTorque,
    MaxThermalFraction,
    Plans,
    MeanIterations,
    MaxIterations,
}

const SCORE_FIELDS: [(&str, ScoreField); 8] = [
    ("squared_error_rad2", ScoreField::SquaredError),
    ("violations", ScoreField::Violations),
    ("max_error_rad", ScoreField::MaxError),
    ("max_torque_n_m", ScoreField::MaxTorque),
    ("max_thermal_fraction", ScoreField::MaxThermalFraction),
    ("plans", ScoreField::Plans),
    ("mean_iterations", ScoreField::MeanIterations),
    ("max_iterations", ScoreField::MaxIterations),
];

/// A statistic over samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Statistic {
    Max,
    Min,
    MaxAbs,
    Mean,
    Median,
    Rms,
    Last,
}

const STATISTICS: [(&str, Statistic); 7] = [
    ("max", Statistic::Max),
    ("min", Statistic::Min),
    ("max_abs", Statistic::MaxAbs),
    ("mean", Statistic::Mean),
    ("median", Statistic::Median),
    ("rms", Statistic::Rms),
    ("last", Statistic::Last),
];

/// A recorded column, or the difference of two: `plant.angle - setpoint`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Name of the column.
    pub column: String,
    /// Name of the column that is taken off.
    pub less: Option<String>,
}

impl FromStr for Signal {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (column, less) = match text.split_once(" - ") {
            Some((column, less)) => (column, Some(less.trim().to_owned())),
            None => (text, None),
        };
        Ok(Self {
            column: column.trim().to_owned(),
            less,
        })
    }
}

impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.column)?;
        self.less.iter().try_for_each(|less| write!(f, " - {less}"))
    }
}

impl Signal {
    /// Names of the columns it reads.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        [Some(&self.column), self.less.as_ref()]
            .into_iter()
            .flatten()
            .map(String::as_str)
    }

    /// Its samples; None where a column is missing.
    pub fn samples(&self, recording: &Recording) -> Option<Vec<f64>> {
        let column = |name: &str| {
            let index = recording.columns().iter().position(|c| c.name == name)?;
            Some(recording.column(index))
        };
        let mut samples = column(&self.column)?;
        if let Some(less) = &self.less {
            for (sample, less) in samples.iter_mut().zip(column(less)?) {
                *sample -= less;
            }
        }
        Some(samples)
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, field)) = SCORE_FIELDS.iter().find(|(name, _)| *name == text) {
            return Ok(Self::Score(*field));
        }
        if let Some(status) = text.strip_prefix("plans.") {
            return Ok(Self::Plans(status.to_owned()));
        }
        let statistic = text.split_once('(').and_then(|(name, rest)| {
            let (_, statistic) = STATISTICS.iter().find(|(known, _)| *known == name.trim())?;
            let Ok(signal) = rest.strip_suffix(')')?.parse();
            Some(Self::Statistic(*statistic, signal))
        });
        statistic.ok_or_else(|| {
            let names = |list: &[&str]| list.join(", ");
            format!(
                "{text:?} is no quantity: use {}, plans.STATUS, or a statistic of a column, like \
                 max(plant.angle) or rms(plant.angle - setpoint), with {}",
                names(&SCORE_FIELDS.map(|(name, _)| name)),
                names(&STATISTICS.map(|(name, _)| name))
            )
        })
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Score(field) => {
                let known = SCORE_FIELDS.iter().find(|(_, f)| f == field);
                f.write_str(known.map_or("", |(name, _)| name))
            }
            Self::Plans(status) => write!(f, "plans.{status}"),
            Self::Statistic(statistic, signal) => {
                let known = STATISTICS.iter().find(|(_, s)| s == statistic);
                write!(f, "{}({signal})", known.map_or("", |(name, _)| name))
            }
        }
    }
}

impl Quantity {
    /// The number; None if the run does not offer it.
    pub fn of(&self, outcome: &Outcome) -> Option<f64> {
        let score = &outcome.summary.score;
        let planner = score.planner.as_ref();
        match self {
            Self::Score(field) => match field {
                ScoreField::SquaredError => score.squared_error_rad2,
                ScoreField::Violations => score.violations.map(|n| n as f64),
                ScoreField::MaxError => score.max_error_rad,
                ScoreField::MaxTorque => score.max_torque_n_m,
                ScoreField::MaxThermalFraction => score.max_thermal_fraction,
                ScoreField::Plans => planner.map(|p| p.plans as f64),
                ScoreField::MeanIterations => planner?.mean_iterations,
                ScoreField::MaxIterations => planner?.max_iterations.map(|n| n as f64),
            },
            Self::Plans(status) => {
                planner.map(|p| p.statuses.get(status).copied().unwrap_or(0) as f64)
            }
            Self::Statistic(statistic, signal) => statistic.of(signal.samples(&outcome.recording)?),
        }
    }

    /// The signal that must be recorded for it.
    pub fn signal(&self) -> Option<&Signal> {
        match self {
            Self::Statistic(_, signal) => Some(signal),
            _ => None,
        }
    }
}

impl Statistic {
    fn of(self, mut samples: Vec<f64>) -> Option<f64> {
        let count = samples.len() as f64;
        match self {
            Self::Max => samples.into_iter().reduce(f64::max),
            Self::Min => samples.into_iter().reduce(f64::min),
            Self::MaxAbs => samples.into_iter().map(f64::abs).reduce(f64::max),
            Self::Last => samples.last().copied(),
            _ if samples.is_empty() => None,
            Self::Mean => Some(samples.iter().sum::<f64>() / count),
            Self::Rms => Some((samples.iter().map(|x| x * x).sum::<f64>() / count).sqrt()),
            Self::Median => {
                samples.sort_unstable_by(f64::total_cmp);
                let middle = samples.len() / 2;
                let below = if samples.len().is_multiple_of(2) {
                    middle - 1
                } else {
                    middle
                };
                Some(0.5 * (samples[below] + samples[middle]))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_written_as_they_are_read() {
        for text in [
            "squared_error_rad2",
            "plans.goal_projected",
            "max(plant.angle)",
            "rms(plant.angle - controller.reference.angle)",
        ] {
            assert_eq!(text.parse::<Quantity>().unwrap().to_string(), text);
        }
        let message = "maximum(plant.angle)".parse::<Quantity>().unwrap_err();
        assert!(
            message.contains("max_abs") && message.contains("violations"),
            "{message}"
        );
    }

    #[test]
    fn statistics_of_samples() {
        let samples = || vec![3.0, -4.0, 1.0];
        for (statistic, value) in [
            (Statistic::Max, 3.0),
            (Statistic::Min, -4.0),
            (Statistic::MaxAbs, 4.0),
            (Statistic::Mean, 0.0),
            (Statistic::Median, 1.0),
            (Statistic::Rms, (26.0_f64 / 3.0).sqrt()),
            (Statistic::Last, 1.0),
        ] {
            assert_eq!(statistic.of(samples()), Some(value), "{statistic:?}");
            assert_eq!(statistic.of(Vec::new()), None);
        }
        assert_eq!(Statistic::Median.of(vec![4.0, 1.0, 2.0, 9.0]), Some(3.0));
    }
}
