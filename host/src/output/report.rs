//! The report: one HTML page that needs no network, with the summary and linked, zoomable plots.

use super::chart::{Chart, Panel, Trace};
use super::html::{END, RESULT, circumstances, head};
use crate::experiment::Style;
use crate::input::roles::Role;
use crate::run::Outcome;
use crate::run::recording::Recording;

/// Height of one panel \[px\].
pub(super) const PANEL: usize = 260;

/// Title of an axis of time.
pub(super) const TIME: &str = "time [s]";

// One for each trace: the panels share a legend.
const SETPOINT: &str = "#9ca3af";
const ANGLE: &str = "#1f3a5f";
const REFERENCE: &str = "#f59e0b";
const LOWER: &str = "#dc2626";
const UPPER: &str = "#991b1b";
const ERROR: &str = "#7c3aed";
const TORQUE: &str = "#0891b2";
const FEEDFORWARD: &str = "#16a34a";
const FEEDBACK: &str = "#db2777";
const HEAT: &str = "#92400e";
const HEAT_LIMIT: &str = "#f87171";
const STATUS: &str = "#4d7c0f";
const ITERATIONS: &str = "#6366f1";

/// The page.
pub(super) fn html(outcome: &Outcome) -> String {
    let summary = &outcome.summary;
    let title = format!("{} with {}", summary.controller.model, summary.plant.model);
    let mut page = head(&title, RESULT);
    circumstances(
        &mut page,
        &summary.headline(),
        &summary.rows(),
        summary.stopped.as_ref(),
        &summary.warnings,
    );
    let chart = Chart::new(TIME, panels(outcome));
    page.push_str(&chart.interactive("plots", PANEL));
    page.push('\n');
    page.push_str(END);
    page
}

fn panels(outcome: &Outcome) -> Vec<Panel> {
    let recording = &outcome.recording;
    let time = recording.column(0);
    let span = match time.as_slice() {
        [first, .., last] => vec![*first, *last],
        _ => time.clone(),
    };
    let line = |name, color, value: f64| {
        Trace::new(name, color, Style::Limit, &span, &vec![value; span.len()])
    };
    let styled = |role, name, color, style| {
        let values = recording.role(role)?;
        Some(Trace::new(name, color, style, &time, &values))
    };
    let role = |role, name, color| styled(role, name, color, Style::Line);
    // On top of a line that it nearly covers.
    let dashed = |role, name, color| styled(role, name, color, Style::Dashed);
    let held = |role, name, color| styled(role, name, color, Style::Steps);

    let setpoint = recording.column(1);
    let mut angle = vec![Trace::new(
        "setpoint",
        SETPOINT,
        Style::Steps,
        &time,
        &setpoint,
    )];
    angle.extend(role(Role::Angle, "angle", ANGLE));
    angle.extend(dashed(Role::ReferenceAngle, "reference", REFERENCE));
    if let Some(limits) = outcome.angle_limits {
        angle.push(line("lower limit", LOWER, limits.lower));
        angle.push(line("upper limit", UPPER, limits.upper));
    }
    let error = recording
        .role(Role::Angle)
        .zip(recording.role(Role::ReferenceAngle));
    let error = error.map(|(angle, reference)| {
        let values = angle.iter().zip(&reference).map(|(a, r)| 1e3 * (a - r));
        let values: Vec<_> = values.collect();
        Trace::new("tracking error", ERROR, Style::Line, &time, &values)
    });
    let torque = [
        role(Role::Torque, "torque", TORQUE),
        dashed(Role::FeedforwardTorque, "feedforward", FEEDFORWARD),
        role(Role::FeedbackTorque, "feedback", FEEDBACK),
    ];
    let mut thermal: Vec<_> = role(Role::ThermalLoad, "thermal load", HEAT)
        .into_iter()
        .collect();
    if let (Some(limit), false) = (outcome.thermal_limit, thermal.is_empty()) {
        thermal.push(line("limit of the thermal load", HEAT_LIMIT, limit));
    }
    let mut panels = vec![
        Panel::new("angle [rad]", angle),
        Panel::new("angle - reference [mrad]", error.into_iter().collect()),
        Panel::new("torque [N.m]", torque.into_iter().flatten().collect()),
        Panel::new("thermal load [A2]", thermal),
        Panel::new(
            "plan status",
            held(Role::PlanStatus, "plan status", STATUS)
                .into_iter()
                .collect(),
        ),
        Panel::new(
            "iterations",
            held(Role::PlanIterations, "iterations per plan", ITERATIONS)
                .into_iter()
                .collect(),
        ),
    ];
    panels[4].ticks = status_names(recording);
    panels[5].from_zero = true;
    panels.retain(|panel| !panel.traces.is_empty());
    panels
}

/// Names of the statuses that occur.
fn status_names(recording: &Recording) -> Vec<(i64, String)> {
    let Some(slot) = recording.slot(Role::PlanStatus) else {
        return Vec::new();
    };
    let mut items = recording.columns()[slot.column].items.clone();
    items.retain(|(value, _)| {
        recording
            .rows()
            .any(|row| row[slot.column] == *value as f64)
    });
    items
}

#[cfg(test)]
mod tests {
    use super::super::chart::script;
    use super::super::tests::outcome;
    use super::*;

    #[test]
    fn the_page_stands_alone_and_is_thinned() {
        let mut outcome = outcome(80_000);
        outcome.summary.controller.model = "<b>".into();
        let page = html(&outcome);
        assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"));
        assert!(page.contains("&lt;b&gt; with A") && page.contains("251.505"));
        let own = page.replacen(&script(), "", 1);
        assert!(own.len() < page.len() && !own.contains("http"));
        let data = page.rsplit("Plotly.newPlot").next().unwrap_or_default();
        assert!(
            data.contains("setpoint") && data.len() < 300_000,
            "{}",
            data.len()
        );
    }
}
