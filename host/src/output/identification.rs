//! An identification in a folder: parameters, numbers, report and measurements.

use super::chart::{Chart, Panel, Trace};
use super::html::{END, RESULT, escape, head, row, warnings};
use super::report::{PANEL, TIME};
use super::{
    IDENTIFICATION, MEASUREMENTS, OF_AN_IDENTIFICATION, OutputFolder, PARAMETERS,
    PARTIAL_MEASUREMENTS, WHOLE, json_text,
};
use crate::Error;
use crate::experiment::Style;
use crate::identify::{Compared, Identified, Kind, Summary, parameter_set};
use crate::input::measurement::Signals;
use model_description::ssv;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Points of the curve of the torque over the angle.
const CURVE: usize = 400;

// One for each trace: the panels share a legend.
const MEASURED: &str = "#1f3a5f";
const RECONSTRUCTED: &str = "#f59e0b";
const RESIDUAL: &str = "#7c3aed";
const ANGLE: &str = "#0f766e";
const REFERENCE: &str = "#9ca3af";
const ERROR: &str = "#dc2626";
const ERROR_ALONE: &str = "#fca5a5";
const FEEDFORWARD: &str = "#16a34a";
const FEEDBACK: &str = "#db2777";
const CURVE_COLOR: &str = "#0891b2";

impl OutputFolder {
    /// Writes `identified.ssv`, `identification.json`, `report.html` and, if asked for, what was measured. Returns
    /// the path of the report. On an error no file appears.
    pub fn write_identification(
        mut self,
        identified: &Identified,
        summary: &Summary,
        measurements: bool,
    ) -> Result<PathBuf, Error> {
        self.identification_files(identified, summary, measurements)
            .map_err(|source| Error::Output {
                path: self.path.clone(),
                source,
            })?;
        Ok(self.path.join(WHOLE[2]))
    }

    fn identification_files(
        &mut self,
        identified: &Identified,
        summary: &Summary,
        measurements: bool,
    ) -> io::Result<()> {
        let file = |name: &str| self.partial.path().join(name);
        let set = parameter_set(
            &identified.identification.parameters,
            identified.tube.as_ref(),
            &description(summary),
        );
        fs::write(file(PARAMETERS), ssv::write(&set))?;
        fs::write(file(IDENTIFICATION), json_text(summary)?)?;
        fs::write(file(WHOLE[2]), html(identified, summary))?;
        if measurements {
            let compared = [
                Some(&identified.measurement),
                identified.validation.as_ref(),
                identified.feedback_alone.as_ref(),
            ];
            for (name, compared) in MEASUREMENTS.into_iter().zip(compared) {
                if let Some(compared) = compared {
                    write_signals(&compared.signals, &file(name))?;
                }
            }
        }
        self.publish(&OF_AN_IDENTIFICATION)
    }

    /// Writes what a failing experiment recorded, as `EXPERIMENT-partial.csv`, and `identification.json` that says so.
    /// Returns the path of the former.
    pub fn write_partial(
        mut self,
        experiment: Kind,
        signals: &Signals,
        error: &Error,
    ) -> Result<PathBuf, Error> {
        let name = PARTIAL_MEASUREMENTS[experiment as usize];
        let mut files = || {
            let json = serde_json::json!({
                "partial": true,
                "experiment": experiment.name(),
                "file": name,
                "error": error.to_string(),
                "recorded_until_s": signals.time.last(),
                "samples": signals.time.len(),
            });
            let text = json_text(&json)?;
            fs::write(self.partial.path().join(IDENTIFICATION), text)?;
            write_signals(signals, &self.partial.path().join(name))?;
            self.publish(&OF_AN_IDENTIFICATION)
        };
        files().map_err(|source| Error::Output {
            path: self.path.clone(),
            source,
        })?;
        Ok(self.path.join(name))
    }
}

/// What an SSV file can say beside its values.
fn description(summary: &Summary) -> String {
    let mut text = format!(
        "Identified from {} rows, {} cogging harmonics, NRMSE of the torque {:.3} %",
        summary.fit.rows,
        summary.harmonics,
        100.0 * summary.fit.nrmse
    );
    // Formatting to a String cannot fail.
    if let Some(tube) = &summary.tube {
        let _ = write!(
            text,
            ". nmpc.angle_margin is twice the largest tracking error seen; nmpc.thermal_share leaves the feedback \
             twice its share of {:.2} % seen",
            100.0 * tube.feedback_share
        );
    }
    for p in summary.parameters.iter().filter(|p| !p.identifiable) {
        let _ = write!(
            text,
            ". Not identifiable: {} (sigma {:.1e})",
            p.name, p.sigma
        );
    }
    text
}

/// In the format that `flexarm identify --measurement` reads; numbers read back exactly.
fn write_signals(signals: &Signals, path: &Path) -> io::Result<()> {
    let optional = [
        ("reference", &signals.reference),
        ("feedforward_torque", &signals.feedforward),
        ("feedback_torque", &signals.feedback),
    ];
    let present: Vec<(&str, &Vec<f64>)> = optional
        .iter()
        .filter_map(|(name, values)| Some((*name, values.as_ref()?)))
        .collect();
    let mut file = BufWriter::with_capacity(1 << 20, fs::File::create(path)?);
    let mut line = String::from("time,angle,torque");
    for (name, _) in &present {
        let _ = write!(line, ",{name}");
    }
    line.push('\n');
    file.write_all(line.as_bytes())?;
    for row in 0..signals.time.len() {
        line.clear();
        let [time, angle, torque] =
            [&signals.time, &signals.angle, &signals.torque].map(|signal| signal[row]);
        let _ = write!(line, "{time:?},{angle:?},{torque:?}");
        for (_, values) in &present {
            let _ = write!(line, ",{:?}", values[row]);
        }
        line.push('\n');
        file.write_all(line.as_bytes())?;
    }
    file.flush()
}

/// The page.
fn html(identified: &Identified, summary: &Summary) -> String {
    let title = format!("Identification from {}", identified.measurement.name);
    let mut page = head(&title, RESULT);
    page.push_str("<table>\n");
    for [name, value, unit] in summary.rows() {
        row(&mut page, [&name, &value, &unit]);
    }
    page.push_str("</table>\n");
    warnings(&mut page, &summary.warnings);
    page.push_str("<h2>Parameters</h2>\n<table>\n");
    for [name, value, sigma, unit] in summary.parameter_rows() {
        row(&mut page, [&name, &format!("{value} ± {sigma}"), &unit]);
    }
    page.push_str("</table>\n");
    if !summary.experiments.is_empty() {
        page.push_str("<h2>Experiments</h2>\n<table>\n");
        for made in &summary.experiments {
            let ([first, last], [low, high]) = (made.setpoints_rad, made.angles_rad);
            let value = format!("angle {low:.4} to {high:.4}, setpoints {first:.4} to {last:.4}");
            row(&mut page, [&made.name, &value, "rad"]);
            let name = format!("{}: outside the range", made.name);
            row(&mut page, [&name, &made.outside.to_string(), "samples"]);
            let name = format!("{}: outside its limits by the plant's count", made.name);
            match made.violations {
                Some(count) => row(&mut page, [&name, &count.to_string(), "samples"]),
                None => row(&mut page, [&name, "not reported by the plant", ""]),
            }
            let name = format!("{}: attempts", made.name);
            row(&mut page, [&name, &made.attempts.to_string(), ""]);
        }
        page.push_str("</table>\n");
    }
    let curve = curve(identified);
    let mut section = |heading: &str, id: &str, panels: Vec<Panel>, axis: &str| {
        let _ = writeln!(page, "<h2>{}</h2>", escape(heading));
        let chart = Chart::new(axis, panels);
        page.push_str(&chart.interactive(id, PANEL));
        page.push('\n');
    };
    section("Torque over the angle", "curve", vec![curve], "angle [rad]");
    let feedback_alone = identified.feedback_alone.as_ref();
    let first = if identified.experiments.is_empty() {
        "Measurement"
    } else {
        "Excitation"
    };
    let named = [
        (first, Some(&identified.measurement)),
        ("Feedback alone", feedback_alone),
        ("Validation", identified.validation.as_ref()),
    ];
    for (index, (heading, compared)) in named.into_iter().enumerate() {
        let Some(compared) = compared else { continue };
        let without = feedback_alone.filter(|_| heading == "Validation");
        // Files have names of their own, experiments those of their kinds.
        let heading = match identified.experiments.is_empty() {
            true => format!("{heading}: {}", compared.name),
            false => heading.to_owned(),
        };
        section(
            &heading,
            &format!("plots{index}"),
            panels(compared, without),
            TIME,
        );
    }
    page.push_str(END);
    page
}

/// g(θ) over the angles that were measured.
fn curve(identified: &Identified) -> Panel {
    let found = &identified.identification;
    let [low, high] = found.range;
    let angle: Vec<f64> = (0..=CURVE)
        .map(|i| low + (high - low) * i as f64 / CURVE as f64)
        .collect();
    let torque = angle.iter().map(|a| found.parameters.position_torque(*a));
    let torque: Vec<f64> = torque.collect();
    let name = "torque that holds the arm";
    Panel::new(
        "g [N.m]",
        vec![Trace::new(name, CURVE_COLOR, Style::Line, &angle, &torque)],
    )
}

/// Figures 4, 5 and 6 of the paper, as far as the signals go. The tracking error is shown beside that of
/// `without` feedforward.
fn panels(compared: &Compared, without: Option<&Compared>) -> Vec<Panel> {
    let (series, signals) = (&compared.series, &compared.signals);
    let fitted = |values: &[f64], name: &str, color, style| {
        Trace::new(name, color, style, &series.time, values)
    };
    let raw = |values: &[f64], name: &str, color, style| {
        Trace::new(name, color, style, &signals.time, values)
    };
    let (line, dashed) = (Style::Line, Style::Dashed);
    let milli: Vec<f64> = series.residuals().iter().map(|r| 1e3 * r).collect();
    let reconstructed = &series.reconstructed;
    let mut panels = vec![
        Panel::new(
            "torque, filtered [N.m]",
            vec![
                fitted(&series.measured, "measured torque", MEASURED, line),
                fitted(reconstructed, "reconstructed torque", RECONSTRUCTED, dashed),
            ],
        ),
        Panel::new(
            "residual [mN.m]",
            vec![fitted(&milli, "residual", RESIDUAL, line)],
        ),
    ];
    let mut angle = vec![raw(&signals.angle, "angle", ANGLE, line)];
    if let Some(reference) = &signals.reference {
        angle.push(raw(reference, "reference", REFERENCE, dashed));
    }
    panels.push(Panel::new("angle [rad]", angle));
    let milli = |compared: &Compared| {
        let error = compared.signals.tracking_error()?;
        Some(error.iter().map(|e| 1e3 * e).collect::<Vec<_>>())
    };
    let mut errors = Vec::new();
    if let Some(without) = without
        && let Some(error) = milli(without)
    {
        let (name, time) = ("tracking error, feedback alone", &without.signals.time);
        errors.push(Trace::new(name, ERROR_ALONE, line, time, &error));
    }
    if let Some(error) = milli(compared) {
        errors.push(raw(&error, "tracking error", ERROR, line));
    }
    if !errors.is_empty() {
        panels.push(Panel::new("angle - reference [mrad]", errors));
    }
    let split: Vec<Trace> = [
        (&signals.feedforward, "feedforward", FEEDFORWARD),
        (&signals.feedback, "feedback", FEEDBACK),
    ]
    .into_iter()
    .filter_map(|(values, name, color)| Some(raw(values.as_ref()?, name, color, line)))
    .collect();
    if !split.is_empty() {
        panels.push(Panel::new("torque [N.m]", split));
    }
    panels
}
