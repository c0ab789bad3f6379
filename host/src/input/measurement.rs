//! Measured angle and torque from a CSV file, to identify an arm from.
//!
//! One row a sample at a constant period, the columns named in the header in any order:
//!
//! | column | unit | |
//! |---|---|---|
//! | `time` | s | increasing; may start anywhere; whole periods may be missing |
//! | `angle` | rad, or degrees with [`Options::degrees`] | of the encoder |
//! | `torque` or `current` | N·m or A | of the motor; a current is multiplied by the torque constant (eq 10) |
//! | `reference`, `feedforward_torque`, `feedback_torque` | rad, N·m | optional: of the controller |
//!
//! `results.csv` of `flexarm simulate` is such a file: its columns `plant.angle`, `controller.torque`,
//! `controller.reference.angle`, `controller.feedforward_torque` and `controller.feedback_torque` are known.

use super::rows::Rows;
use super::{Error, Place, read_text};
use identification::{Measurement, Segment, Timing};
use std::path::Path;

/// How a file is to be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Torque constant Ki \[N·m/A\]: turns a current into a torque.
    pub torque_constant: Option<f64>,
    /// Angles are in degrees.
    pub degrees: bool,
    /// When the torque of a sample acts.
    pub timing: Timing,
    /// Headers of columns that are called differently: name in the table above, header in the file.
    pub columns: Vec<(String, String)>,
}

/// Signals of an experiment, one value a sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    /// Time \[s\].
    pub time: Vec<f64>,
    /// Angle \[rad\].
    pub angle: Vec<f64>,
    /// Torque of the motor \[N·m\].
    pub torque: Vec<f64>,
    /// Angle of the reference \[rad\].
    pub reference: Option<Vec<f64>>,
    /// Torque of the feedforward \[N·m\].
    pub feedforward: Option<Vec<f64>>,
    /// Torque of the feedback \[N·m\].
    pub feedback: Option<Vec<f64>>,
}

impl Signals {
    /// Angle minus reference \[rad\]; None without a reference.
    pub fn tracking_error(&self) -> Option<Vec<f64>> {
        let pairs = self.angle.iter().zip(self.reference.as_ref()?);
        Some(pairs.map(|(angle, reference)| angle - reference).collect())
    }
}

/// Names in the table above, and those in `results.csv`.
const COLUMNS: [(&str, &str); 7] = [
    ("time", "time"),
    ("angle", "plant.angle"),
    ("torque", "controller.torque"),
    ("current", "current"),
    ("reference", "controller.reference.angle"),
    ("feedforward_torque", "controller.feedforward_torque"),
    ("feedback_torque", "controller.feedback_torque"),
];
const TIME: usize = 0;
const ANGLE: usize = 1;
const TORQUE: usize = 2;
const CURRENT: usize = 3;
const REFERENCE: usize = 4;
const FEEDFORWARD: usize = 5;
const FEEDBACK: usize = 6;

/// Deviation of a time from a whole number of periods, in periods, that rounding may cause.
const JITTER: f64 = 0.25;
/// A full turn: no flexure bends so far \[rad\].
const LARGEST_SPAN: f64 = std::f64::consts::TAU;
/// Longest period that shows how an arm moves \[s\].
const LONGEST_PERIOD: f64 = 0.02;

/// Reads a file.
///
/// # Errors
/// By file, line and column: values that are no finite numbers, times that do not increase or are not equally
/// spaced; a missing column; units that cannot be meant.
pub fn read(path: &Path, options: &Options) -> Result<(Measurement, Signals), Error> {
    let text = read_text(path)?;
    let mut rows = Rows::new(&text, path.display().to_string())?;
    let (head, header) = (rows.head(), rows.columns.clone());
    let found = positions(&head, &header, options)?;
    let factor = factor(&head, &header, &found, options)?;
    let mut values: [Vec<f64>; COLUMNS.len()] = Default::default();
    let mut lines = Vec::new();
    while rows.read()? {
        rows.complete()?;
        for (column, position) in found.iter().enumerate() {
            if let Some(position) = position {
                values[column].push(rows.number(*position)?);
            }
        }
        lines.push(rows.line());
    }
    if lines.is_empty() {
        return Err(Error::NoRows { place: head });
    }
    for column in [ANGLE, REFERENCE] {
        if options.degrees {
            values[column].iter_mut().for_each(|v| *v = v.to_radians());
        }
    }
    let source = if found[TORQUE].is_some() {
        TORQUE
    } else {
        CURRENT
    };
    let torque: Vec<f64> = values[source].iter().map(|v| v * factor).collect();
    let optional = |column: usize| found[column].map(|_| values[column].clone());
    let signals = Signals {
        reference: optional(REFERENCE),
        feedforward: optional(FEEDFORWARD),
        feedback: optional(FEEDBACK),
        time: std::mem::take(&mut values[TIME]),
        angle: std::mem::take(&mut values[ANGLE]),
        torque,
    };
    plausible(path, &signals)?;
    let at = |row: usize| Place::in_file(path, lines.get(row).copied().unwrap_or(0));
    let measurement = segments(&signals, options.timing, &at)?;
    Ok((measurement, signals))
}

/// Position of each known column in the header.
fn positions(
    place: &Place,
    header: &[String],
    options: &Options,
) -> Result<[Option<usize>; COLUMNS.len()], Error> {
    let at = |name: &str| header.iter().position(|h| h == name);
    let missing = |expected: String| Error::Column {
        place: place.clone(),
        expected,
        found: header.join(", "),
    };
    let mut found = COLUMNS.map(|(name, ours)| at(name).or_else(|| at(ours)));
    for (name, renamed) in &options.columns {
        let Some(column) = COLUMNS.iter().position(|(known, _)| known == name) else {
            return Err(Error::Setting {
                name: "--column".to_owned(),
                value: format!("{name}={renamed}"),
                expected: format!("one of {}", COLUMNS.map(|c| c.0).join(", ")),
            });
        };
        found[column] = Some(at(renamed).ok_or_else(|| missing(renamed.clone()))?);
    }
    for column in [TIME, ANGLE] {
        if found[column].is_none() {
            return Err(missing(COLUMNS[column].0.to_owned()));
        }
    }
    if found[TORQUE].is_none() && found[CURRENT].is_none() {
        return Err(missing("torque or current".to_owned()));
    }
    let chose_current = options.columns.iter().any(|(name, _)| name == "current");
    if chose_current && !options.columns.iter().any(|(name, _)| name == "torque") {
        found[TORQUE] = None;
    }
    Ok(found)
}

/// From the column of torque or current to the torque \[N·m\].
fn factor(
    place: &Place,
    header: &[String],
    found: &[Option<usize>; COLUMNS.len()],
    options: &Options,
) -> Result<f64, Error> {
    let named = |column: usize| found[column].map_or("", |p| header[p].as_str());
    if found[TORQUE].is_some() {
        return match options.torque_constant {
            None => Ok(1.0),
            Some(constant) => Err(Error::Implausible {
                place: place.clone(),
                message: format!(
                    "column {} is a torque, which --torque-constant = {constant} N.m/A has no use for: leave it out, or \
                     name a current by --column current=HEADER",
                    named(TORQUE)
                ),
            }),
        };
    }
    match options.torque_constant {
        Some(constant) if constant.is_finite() && constant != 0.0 => Ok(constant),
        Some(constant) => Err(Error::Setting {
            name: "--torque-constant".to_owned(),
            value: constant.to_string(),
            expected: "a finite number in N.m/A that is not 0".to_owned(),
        }),
        None => Err(Error::Implausible {
            place: place.clone(),
            message: format!(
                "column {} needs --torque-constant, in N.m/A",
                named(CURRENT)
            ),
        }),
    }
}

/// Wrong units are recognised by values that no arm has.
fn plausible(path: &Path, signals: &Signals) -> Result<(), Error> {
    let refuse = |message: String| {
        Err(Error::Implausible {
            place: Place::new(path.display().to_string(), None),
            message,
        })
    };
    let range = |x: &[f64]| {
        x.iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| {
                [l.min(*v), h.max(*v)]
            })
    };
    let angles = [
        ("angle", Some(&signals.angle)),
        ("reference", signals.reference.as_ref()),
    ];
    for (name, values) in angles {
        let [low, high] = values.map_or([0.0; 2], |values| range(values));
        if high - low > LARGEST_SPAN {
            return refuse(format!(
                "{name} goes from {low} to {high}: more than a full turn in rad; are these degrees (--angle-unit deg)?"
            ));
        }
    }
    let steps = signals.time.len().saturating_sub(1).max(1) as f64;
    let [first, last] = range(&signals.time);
    if signals.time.len() > 1 && (last - first) / steps > LONGEST_PERIOD {
        return refuse(format!(
            "samples are {} s apart: at most {LONGEST_PERIOD} s shows how an arm moves; is time not in s?",
            (last - first) / steps
        ));
    }
    let [low, high] = range(&signals.torque);
    if low == high {
        return refuse(format!("torque is {low} N.m all the time"));
    }
    Ok(())
}

/// Cuts a measurement where samples are missing. `place` says where a row is.
pub(crate) fn segments(
    signals: &Signals,
    timing: Timing,
    place: &dyn Fn(usize) -> Place,
) -> Result<Measurement, Error> {
    let time = &signals.time;
    let mut steps: Vec<f64> = Vec::with_capacity(time.len());
    for (row, pair) in time.windows(2).enumerate() {
        if pair[1] <= pair[0] {
            return Err(Error::Time {
                place: place(row + 1),
                value: pair[1],
                previous: Some(pair[0]),
            });
        }
        steps.push(pair[1] - pair[0]);
    }
    // The median first, because of gaps; then the mean, because of rounding.
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let regular = |step: &&f64| (**step / median - 1.0).abs() < 0.5;
    let (count, sum) = steps
        .iter()
        .filter(regular)
        .fold((0.0, 0.0), |(n, s), step| (n + 1.0, s + step));
    let period = if count > 0.0 { sum / count } else { median };
    let mut measurement = Measurement {
        period,
        timing,
        segments: Vec::new(),
    };
    let mut first = 0;
    for row in 1..=time.len() {
        let periods = steps.get(row - 1).map(|step| step / period);
        if let Some(periods) = periods
            && (periods - periods.round()).abs() > JITTER
        {
            return Err(Error::Spacing {
                place: place(row),
                value: time[row],
                previous: time[row - 1],
                period,
            });
        }
        if periods.is_none_or(|p| p > 1.5) {
            measurement.segments.push(Segment {
                start: time[first],
                angle: signals.angle[first..row].to_vec(),
                torque: signals.torque[first..row].to_vec(),
            });
            first = row;
        }
    }
    Ok(measurement)
}
