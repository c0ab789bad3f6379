//! The report: one HTML page that needs no network, with the summary and linked, zoomable plots.

use super::plots::{Dash, HEAD, Panel, TIME, Trace, dashed, escape, plot, plotly, trace};
use crate::input::roles::Role;
use crate::run::Outcome;
use crate::run::recording::Recording;
use std::fmt::Write;

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
    let mut page = String::from(HEAD);
    // Formatting to a String cannot fail.
    let _ = write!(
        page,
        "<title>{}</title>\n{}</head>\n<body>\n<h1>{}</h1>\n",
        escape(&title),
        plotly(),
        escape(&title)
    );
    let _ = writeln!(page, "<p>{}</p>\n<table>", escape(&summary.headline()));
    for [name, value, unit] in summary.rows() {
        let _ = writeln!(
            page,
            "<tr><th>{}</th><td>{}</td><td class=\"unit\">{}</td></tr>",
            escape(&name),
            escape(&value),
            escape(&unit)
        );
    }
    page.push_str("</table>\n");
    for warning in &summary.warnings {
        let _ = writeln!(page, "<p class=\"warning\">{}</p>", escape(warning));
    }
    page.push_str(&plot(&panels(outcome), TIME).to_inline_html(Some("plots")));
    page.push_str("\n</body>\n</html>\n");
    page
}

fn panels(outcome: &Outcome) -> Vec<Panel> {
    let recording = &outcome.recording;
    let time = recording.column(0);
    let span = match time.as_slice() {
        [first, .., last] => vec![*first, *last],
        _ => time.clone(),
    };
    let line = |name, color, value: f64| Trace {
        name,
        color,
        time: span.clone(),
        values: vec![value; span.len()],
        steps: false,
        dash: Dash::Limit,
    };
    let role = |role, name, color| Some(trace(&time, recording.role(role)?, name, color, false));
    let held = |role, name, color| Some(trace(&time, recording.role(role)?, name, color, true));

    let mut angle = vec![trace(
        &time,
        recording.column(1),
        "setpoint",
        SETPOINT,
        true,
    )];
    angle.extend(role(Role::Angle, "angle", ANGLE));
    angle.extend(role(Role::ReferenceAngle, "reference", REFERENCE).map(dashed));
    if let Some(limits) = outcome.angle_limits {
        angle.push(line("lower limit", LOWER, limits.lower));
        angle.push(line("upper limit", UPPER, limits.upper));
    }
    let error = recording
        .role(Role::Angle)
        .zip(recording.role(Role::ReferenceAngle));
    let error = error.map(|(angle, reference)| {
        let values = angle.iter().zip(&reference).map(|(a, r)| 1e3 * (a - r));
        trace(&time, values.collect(), "tracking error", ERROR, false)
    });
    let torque = [
        role(Role::Torque, "torque", TORQUE),
        role(Role::FeedforwardTorque, "feedforward", FEEDFORWARD).map(dashed),
        role(Role::FeedbackTorque, "feedback", FEEDBACK),
    ];
    let mut thermal: Vec<_> = role(Role::ThermalLoad, "thermal load", HEAT)
        .into_iter()
        .collect();
    if let (Some(limit), false) = (outcome.thermal_limit, thermal.is_empty()) {
        thermal.push(line("limit of the thermal load", HEAT_LIMIT, limit));
    }
    let panel = |title, traces| Panel {
        title,
        traces,
        ticks: Vec::new(),
        from_zero: false,
    };
    let mut panels = vec![
        panel("angle [rad]", angle),
        panel("angle - reference [mrad]", error.into_iter().collect()),
        panel("torque [N.m]", torque.into_iter().flatten().collect()),
        panel("thermal load [A2]", thermal),
        panel(
            "plan status",
            held(Role::PlanStatus, "plan status", STATUS)
                .into_iter()
                .collect(),
        ),
        panel(
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
    use super::super::tests::outcome;
    use super::*;

    #[test]
    fn the_page_stands_alone_and_is_thinned() {
        let mut outcome = outcome(80_000);
        outcome.summary.controller.model = "<b>".into();
        let page = html(&outcome);
        assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"));
        assert!(page.contains("&lt;b&gt; with A") && page.contains("251.505"));
        let own = page.replacen(&plotly(), "", 1);
        assert!(own.len() < page.len() && !own.contains("http"));
        let data = page.rsplit("Plotly.newPlot").next().unwrap_or_default();
        assert!(
            data.contains("setpoint") && data.len() < 300_000,
            "{}",
            data.len()
        );
    }
}
