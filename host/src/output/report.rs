//! The report: one HTML page that needs no network, with the summary and linked, zoomable plots.

use super::decimate;
use crate::input::roles::Role;
use crate::run::Outcome;
use crate::run::recording::Recording;
use plotly::common::{DashType, HoverInfo, Line, LineShape, Mode, Orientation, Title};
use plotly::configuration::Configuration;
use plotly::layout::{Axis, HoverMode, Layout, Legend, Margin, RangeMode};
use plotly::{Plot, Scatter};
use std::fmt::Write;

/// Samples of a trace that are drawn.
const POINTS: usize = 6000;
/// Height of one panel \[px\].
const PANEL: usize = 260;

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

/// A plot of some signals over time.
struct Panel {
    title: &'static str,
    traces: Vec<Trace>,
    /// Values of the axis with their names.
    ticks: Vec<(i64, String)>,
    /// The axis begins at zero.
    from_zero: bool,
}

struct Trace {
    name: &'static str,
    color: &'static str,
    time: Vec<f64>,
    values: Vec<f64>,
    /// Held between samples rather than joined.
    steps: bool,
    dash: Dash,
}

#[derive(Clone, Copy, PartialEq)]
enum Dash {
    Solid,
    /// On top of a line that it nearly covers.
    Dashed,
    /// A limit: thin and without a label under the pointer.
    Limit,
}

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
    if let Some(stopped) = &summary.stopped {
        let _ = writeln!(
            page,
            "<p class=\"warning\"><strong>Partial: {}</strong></p>",
            escape(&stopped.reason)
        );
    }
    for warning in &summary.warnings {
        let _ = writeln!(page, "<p class=\"warning\">{}</p>", escape(warning));
    }
    page.push_str(&plot(&panels(outcome)).to_inline_html(Some("plots")));
    page.push_str("\n</body>\n</html>\n");
    page
}

const HEAD: &str = r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2933; background: #fff; max-width: 1200px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.4rem; font-weight: 600; }
table { border-collapse: collapse; columns: 2; margin-bottom: 1rem; }
th { text-align: left; font-weight: 400; color: #52606d; padding: .1rem 1.5rem .1rem 0; }
td { text-align: right; font-variant-numeric: tabular-nums; padding: .1rem .4rem; }
td.unit { text-align: left; color: #52606d; }
p.warning { color: #b45309; margin: .2rem 0; }
</style>
"#;

/// The plotting library as a script. The crate's sources also hold a formula renderer, which is not used.
fn plotly() -> String {
    let mut sources = Plot::offline_js_sources();
    const END: &str = "</script>";
    if let Some(end) = sources.find(END) {
        sources.truncate(end + END.len());
    }
    sources.push('\n');
    sources
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
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

fn trace(
    time: &[f64],
    values: Vec<f64>,
    name: &'static str,
    color: &'static str,
    steps: bool,
) -> Trace {
    let positions = decimate::positions(&values, POINTS);
    Trace {
        name,
        color,
        time: positions.iter().map(|&i| time[i]).collect(),
        values: positions.iter().map(|&i| values[i]).collect(),
        steps,
        dash: Dash::Solid,
    }
}

fn dashed(trace: Trace) -> Trace {
    Trace {
        dash: Dash::Dashed,
        ..trace
    }
}

/// All panels above each other, with one time axis.
fn plot(panels: &[Panel]) -> Plot {
    let mut plot = Plot::new();
    let count = panels.len().max(1);
    let mut layout = Layout::new()
        .height(PANEL * count + 80)
        .hover_mode(HoverMode::X)
        .margin(Margin::new().left(110).right(20).top(20).bottom(50))
        .legend(
            Legend::new()
                .orientation(Orientation::Horizontal)
                .y(1.0)
                .y_anchor(plotly::common::Anchor::Bottom),
        );
    for (index, panel) in panels.iter().enumerate() {
        let name = if index == 0 {
            "y".to_owned()
        } else {
            format!("y{}", index + 1)
        };
        for trace in &panel.traces {
            let mut line = Line::new().color(trace.color).width(1.5);
            if trace.steps {
                line = line.shape(LineShape::Hv);
            }
            line = match trace.dash {
                Dash::Solid => line,
                Dash::Dashed => line.dash(DashType::Dash),
                Dash::Limit => line.dash(DashType::Dot).width(1.0),
            };
            let mut scatter = Scatter::new(trace.time.clone(), trace.values.clone())
                .name(trace.name)
                .mode(Mode::Lines)
                .line(line)
                .y_axis(&name);
            if trace.dash == Dash::Limit {
                scatter = scatter.hover_info(HoverInfo::Skip);
            }
            plot.add_trace(scatter);
        }
        let top = 1.0 - index as f64 / count as f64;
        let height = 1.0 / count as f64;
        let mut axis = Axis::new()
            .title(Title::with_text(panel.title))
            .domain(&[top - 0.88 * height, top])
            .zero_line(false)
            .range_mode(if panel.from_zero {
                RangeMode::ToZero
            } else {
                RangeMode::Normal
            })
            .grid_color("#e5e7eb");
        if !panel.ticks.is_empty() {
            axis = axis
                .tick_values(panel.ticks.iter().map(|(value, _)| *value as f64).collect())
                .tick_text(panel.ticks.iter().map(|(_, name)| name.clone()).collect());
        }
        layout = match index {
            0 => layout.y_axis(axis),
            1 => layout.y_axis2(axis),
            2 => layout.y_axis3(axis),
            3 => layout.y_axis4(axis),
            4 => layout.y_axis5(axis),
            _ => layout.y_axis6(axis),
        };
    }
    let anchor = if count == 1 {
        "y".to_owned()
    } else {
        format!("y{count}")
    };
    layout = layout.x_axis(
        Axis::new()
            .title(Title::with_text("time [s]"))
            .anchor(&anchor)
            .grid_color("#e5e7eb"),
    );
    plot.set_layout(layout);
    plot.set_configuration(Configuration::new().responsive(true).display_logo(false));
    plot
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
