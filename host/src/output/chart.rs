//! Charts: panels above each other with one axis below, as interactive HTML or as SVG ([`super::svg`]).

use super::decimate;
use crate::experiment::Style;
use plotly::common::{DashType, HoverInfo, Line, LineShape, Marker, Mode, Orientation, Title};
use plotly::configuration::Configuration;
use plotly::layout::{Axis, AxisType, HoverMode, Layout, Legend, Margin, RangeMode};
use plotly::{Plot, Scatter};

/// Samples of a trace that are drawn.
const POINTS: usize = 6000;
/// Panels of a chart, at most.
pub(crate) const PANELS: usize = 6;

/// A chart.
pub(super) struct Chart {
    /// Title of the lower axis.
    pub(super) axis: String,
    /// Whether the lower axis is logarithmic.
    pub(super) log: bool,
    /// The panels, at most [`PANELS`].
    pub(super) panels: Vec<Panel>,
}

/// A plot of some signals.
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) traces: Vec<Trace>,
    /// Values of the axis with their names.
    pub(super) ticks: Vec<(i64, String)>,
    /// The axis begins at zero.
    pub(super) from_zero: bool,
}

/// A curve, thinned.
pub(super) struct Trace {
    pub(super) name: String,
    pub(super) color: &'static str,
    pub(super) style: Style,
    /// Whether the legend names it.
    pub(super) named: bool,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Trace {
    pub(super) fn new(
        name: impl Into<String>,
        color: &'static str,
        style: Style,
        x: &[f64],
        y: &[f64],
    ) -> Self {
        let positions = decimate::positions(y, POINTS);
        Self {
            name: name.into(),
            color,
            style,
            named: true,
            x: positions.iter().map(|&i| x[i]).collect(),
            y: positions.iter().map(|&i| y[i]).collect(),
        }
    }
}

/// The plotting library as a script. The crate's sources also hold a formula renderer, which is not used.
pub(super) fn script() -> String {
    let mut sources = Plot::offline_js_sources();
    const END: &str = "</script>";
    if let Some(end) = sources.find(END) {
        sources.truncate(end + END.len());
    }
    sources.push('\n');
    sources
}

impl Panel {
    /// A panel whose axis takes its range and its numbers from the traces.
    pub(super) fn new(title: impl Into<String>, traces: Vec<Trace>) -> Self {
        Self {
            title: title.into(),
            traces,
            ticks: Vec::new(),
            from_zero: false,
        }
    }
}

impl Chart {
    /// A chart over a linear axis.
    pub(super) fn new(axis: &str, panels: Vec<Panel>) -> Self {
        Self {
            axis: axis.to_owned(),
            log: false,
            panels,
        }
    }

    /// The chart as HTML for a page with [`script`]. `id` is unique on the page, `height` that of a panel \[px\].
    pub(super) fn interactive(&self, id: &str, height: usize) -> String {
        self.plot(height).to_inline_html(Some(id))
    }

    fn plot(&self, height: usize) -> Plot {
        let mut plot = Plot::new();
        let count = self.panels.len().max(1);
        let mut layout = Layout::new()
            .height(height * count + 150)
            .hover_mode(HoverMode::X)
            // Room at the top for the legend and, above it, the tools.
            .margin(Margin::new().left(110).right(20).top(90).bottom(50))
            .legend(
                Legend::new()
                    .orientation(Orientation::Horizontal)
                    .y(1.0)
                    .y_anchor(plotly::common::Anchor::Bottom),
            );
        // The panels share a legend.
        let mut listed = Vec::new();
        for (index, panel) in self.panels.iter().enumerate().take(PANELS) {
            let name = match index {
                0 => "y".to_owned(),
                index => format!("y{}", index + 1),
            };
            for trace in &panel.traces {
                let entry = (&trace.name, trace.color);
                let first = !listed.contains(&entry);
                listed.push(entry);
                plot.add_trace(
                    scatter(trace)
                        .show_legend(first && trace.named)
                        .y_axis(&name),
                );
            }
            let axis = y_axis(panel, index, count);
            layout = match index {
                0 => layout.y_axis(axis),
                1 => layout.y_axis2(axis),
                2 => layout.y_axis3(axis),
                3 => layout.y_axis4(axis),
                4 => layout.y_axis5(axis),
                _ => layout.y_axis6(axis),
            };
        }
        let anchor = match count {
            1 => "y".to_owned(),
            count => format!("y{count}"),
        };
        let mut axis = Axis::new()
            .title(Title::with_text(&self.axis))
            .anchor(&anchor)
            .grid_color("#e5e7eb");
        if self.log {
            axis = axis.type_(AxisType::Log);
        }
        plot.set_layout(layout.x_axis(axis));
        plot.set_configuration(Configuration::new().responsive(true).display_logo(false));
        plot
    }
}

fn scatter(trace: &Trace) -> Box<Scatter<f64, f64>> {
    let line = Line::new().color(trace.color).width(1.5);
    let line = match trace.style {
        Style::Line | Style::Points => line,
        Style::Dashed => line.dash(DashType::Dash),
        Style::Steps => line.shape(LineShape::Hv),
        Style::Limit => line.dash(DashType::Dot).width(1.0),
    };
    let scatter = Scatter::new(trace.x.clone(), trace.y.clone())
        .name(&trace.name)
        .mode(match trace.style {
            Style::Points => Mode::Markers,
            _ => Mode::Lines,
        })
        .marker(Marker::new().color(trace.color).size(4))
        .line(line);
    match trace.style {
        Style::Limit => scatter.hover_info(HoverInfo::Skip),
        _ => scatter,
    }
}

fn y_axis(panel: &Panel, index: usize, count: usize) -> Axis {
    let top = 1.0 - index as f64 / count as f64;
    let height = 1.0 / count as f64;
    let axis = Axis::new()
        .title(Title::with_text(&panel.title))
        .domain(&[top - 0.88 * height, top])
        .zero_line(false)
        .range_mode(if panel.from_zero {
            RangeMode::ToZero
        } else {
            RangeMode::Normal
        })
        .grid_color("#e5e7eb");
    if panel.ticks.is_empty() {
        return axis;
    }
    axis.tick_values(panel.ticks.iter().map(|(value, _)| *value as f64).collect())
        .tick_text(panel.ticks.iter().map(|(_, name)| name.clone()).collect())
}
