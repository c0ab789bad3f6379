//! The plot of a run of the packaged pair, as SVG for the documentation.

use crate::run;
use crate::workspace::Workspace;
use plotters::prelude::*;
use std::ffi::OsStr;

/// How many of the demo's setpoints the run has, when it ends \[s\], and which of its samples are drawn.
const MOVES: usize = 10;
const UNTIL: &str = "5";
const EVERY: &str = "10";

/// The time axis goes on to make room for the legend.
const LEGEND: f64 = 1.2;

const BLUE: RGBColor = RGBColor(0x1f, 0x6f, 0xb2);
const ORANGE: RGBColor = RGBColor(0xe0, 0x8a, 0x1e);
const RED: RGBColor = RGBColor(0xc0, 0x39, 0x2b);
const GREEN: RGBColor = RGBColor(0x2f, 0x85, 0x5a);
const PURPLE: RGBColor = RGBColor(0x7c, 0x3a, 0xed);
const BROWN: RGBColor = RGBColor(0x8b, 0x5e, 0x3c);
const GREY: RGBColor = RGBColor(0x94, 0xa7, 0xb8);

/// A panel and what its axis says.
struct Panel {
    axis: &'static str,
    curves: &'static [Curve],
}

/// A column of the results, or the difference of two, with a factor.
struct Curve {
    column: &'static str,
    less: Option<&'static str>,
    factor: f64,
    legend: &'static str,
    colour: RGBColor,
    dashed: bool,
}

const fn curve(column: &'static str, legend: &'static str, colour: RGBColor) -> Curve {
    Curve {
        column,
        less: None,
        factor: 1.0,
        legend,
        colour,
        dashed: false,
    }
}

const PANELS: [Panel; 4] = [
    Panel {
        axis: "angle [rad]",
        curves: &[
            curve("setpoint", "setpoint", GREY),
            curve("plant.angle", "angle", BLUE),
            // Dashed and on top: the angle follows it to a line's width.
            Curve {
                dashed: true,
                ..curve(REFERENCE, "reference", ORANGE)
            },
        ],
    },
    Panel {
        axis: "angle − reference [mrad]",
        curves: &[Curve {
            less: Some(REFERENCE),
            factor: 1e3,
            ..curve("plant.angle", "error", PURPLE)
        }],
    },
    Panel {
        axis: "torque [N·m]",
        curves: &[
            curve("controller.feedforward_torque", "feedforward", GREEN),
            curve("controller.feedback_torque", "feedback", RED),
        ],
    },
    Panel {
        axis: "thermal load / limit",
        curves: &[curve("plant.thermal_fraction", "thermal load", BROWN)],
    },
];

const REFERENCE: &str = "controller.reference.angle";

/// Runs the packaged FMUs of FMI 3.0 with the host and draws what they did.
pub fn of_a_run(workspace: &Workspace, host: &OsStr) -> Result<String, String> {
    let arguments = ["--until", UNTIL, "--record", EVERY];
    let results = run::pair(workspace, host, MOVES, &arguments)?;
    draw(&|name| results.column(name))
}

/// Draws all panels over time.
fn draw(column: &dyn Fn(&str) -> Result<Vec<f64>, String>) -> Result<String, String> {
    let time = column("time")?;
    let end = time.last().copied().ok_or("the run has no samples")?;
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (900, 780)).into_drawing_area();
        for (panel, area) in PANELS.iter().zip(root.split_evenly((PANELS.len(), 1))) {
            let mut curves = Vec::new();
            for curve in panel.curves {
                let mut values = column(curve.column)?;
                let less = curve.less.map(column).transpose()?;
                for (i, value) in values.iter_mut().enumerate() {
                    let less = less.as_ref().and_then(|l| l.get(i)).unwrap_or(&0.0);
                    *value = curve.factor * (*value - less);
                }
                curves.push((values, curve));
            }
            let values = || {
                curves
                    .iter()
                    .flat_map(|(values, ..)| values.iter().copied())
            };
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            let margin = 0.06 * (high - low).max(1e-6);
            let failed = |e: &dyn std::fmt::Display| format!("plot: {e}");
            let mut chart = ChartBuilder::on(&area)
                .margin(8)
                .x_label_area_size(32)
                .y_label_area_size(62)
                .build_cartesian_2d(0.0..end * LEGEND, low - margin..high + margin)
                .map_err(|e| failed(&e))?;
            chart
                .configure_mesh()
                .x_desc("time [s]")
                .y_desc(panel.axis)
                .y_labels(5)
                .light_line_style(TRANSPARENT)
                .bold_line_style(GREY.mix(0.35))
                .axis_style(GREY)
                .label_style(("sans-serif", 13))
                .draw()
                .map_err(|e| failed(&e))?;
            for (values, curve) in curves {
                let points = time.iter().copied().zip(values);
                let style = curve.colour.stroke_width(2);
                let drawn = if curve.dashed {
                    chart.draw_series(DashedLineSeries::new(points, 6, 5, style))
                } else {
                    chart.draw_series(LineSeries::new(points, style))
                };
                drawn
                    .map_err(|e| failed(&e))?
                    .label(curve.legend)
                    .legend(move |(x, y)| {
                        // A gap in the middle for a dashed line.
                        let gap = if curve.dashed { 4 } else { 0 };
                        let half = |from, to| PathElement::new([(x + from, y), (x + to, y)], style);
                        EmptyElement::at((0, 0)) + half(0, 9 - gap) + half(9 + gap, 18)
                    });
            }
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::MiddleRight)
                .background_style(WHITE.mix(0.8))
                .border_style(GREY)
                .label_font(("sans-serif", 13))
                .draw()
                .map_err(|e| failed(&e))?;
        }
        root.present().map_err(|e| format!("plot: {e}"))?;
    }
    Ok(svg)
}
