//! Panels of plots above each other on a page that needs no network.

use super::decimate;
use plotly::common::{DashType, HoverInfo, Line, LineShape, Mode, Orientation, Title};
use plotly::configuration::Configuration;
use plotly::layout::{Axis, HoverMode, Layout, Legend, Margin, RangeMode};
use plotly::{Plot, Scatter};

/// Samples of a trace that are drawn.
const POINTS: usize = 6000;
/// Height of one panel \[px\].
const PANEL: usize = 260;

/// Title of an axis of time.
pub(super) const TIME: &str = "time [s]";

/// A plot of some signals over time.
pub(super) struct Panel {
    pub(super) title: &'static str,
    pub(super) traces: Vec<Trace>,
    /// Values of the axis with their names.
    pub(super) ticks: Vec<(i64, String)>,
    /// The axis begins at zero.
    pub(super) from_zero: bool,
}

pub(super) struct Trace {
    pub(super) name: &'static str,
    pub(super) color: &'static str,
    pub(super) time: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Held between samples rather than joined.
    pub(super) steps: bool,
    pub(super) dash: Dash,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Dash {
    Solid,
    /// On top of a line that it nearly covers.
    Dashed,
    /// A limit: thin and without a label under the pointer.
    Limit,
}

/// Beginning of a page.
pub(super) const HEAD: &str = r#"<!doctype html>
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
pub(super) fn plotly() -> String {
    let mut sources = Plot::offline_js_sources();
    const END: &str = "</script>";
    if let Some(end) = sources.find(END) {
        sources.truncate(end + END.len());
    }
    sources.push('\n');
    sources
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// A thinned trace.
pub(super) fn trace(
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

pub(super) fn dashed(trace: Trace) -> Trace {
    Trace {
        dash: Dash::Dashed,
        ..trace
    }
}

/// All panels above each other, with one axis below them.
pub(super) fn plot(panels: &[Panel], abscissa: &str) -> Plot {
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
            .title(Title::with_text(abscissa))
            .anchor(&anchor)
            .grid_color("#e5e7eb"),
    );
    plot.set_layout(layout);
    plot.set_configuration(Configuration::new().responsive(true).display_logo(false));
    plot
}
