//! Charts as SVG files, for print and for documents.

use super::chart::{Chart, Panel, Trace};
use crate::experiment::Style;
use plotters::prelude::*;
use std::ops::Range;

/// Width of a chart and height of a panel \[px\].
const WIDTH: u32 = 900;
const PANEL: u32 = 250;
/// Width of a letter of the legend, and of what is around its text \[px\].
const LETTER: f64 = 6.6;
const FRAME: f64 = 60.0;

const GREY: RGBColor = RGBColor(0x94, 0xa7, 0xb8);

impl Chart {
    /// The chart as SVG; the reason if it cannot be drawn.
    pub(super) fn svg(&self) -> Result<String, String> {
        let mut svg = String::new();
        let count = self.panels.len().max(1);
        {
            let size = (WIDTH, PANEL * count as u32);
            let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            let x = self
                .panels
                .iter()
                .flat_map(|p| &p.traces)
                .flat_map(|t| &t.x);
            let x = range(x.map(|x| self.position(*x)), 0.0);
            for (panel, area) in self.panels.iter().zip(root.split_evenly((count, 1))) {
                self.draw(panel, &area, x.clone())
                    .map_err(|error| error.to_string())?;
            }
            root.present().map_err(|error| error.to_string())?;
        }
        Ok(svg)
    }

    /// Where a value stands on the lower axis.
    fn position(&self, x: f64) -> f64 {
        if self.log { x.log10() } else { x }
    }

    /// Text of a position on the lower axis; a logarithmic one names the powers of ten.
    fn label(&self, x: f64) -> String {
        if !self.log {
            return tick(x);
        }
        if (x - x.round()).abs() < 1e-9 {
            tick(10_f64.powf(x.round()))
        } else {
            String::new()
        }
    }

    /// Room for the legend at the right, in shares of the lower axis.
    fn legend(&self) -> f64 {
        let names = self.panels.iter().flat_map(|panel| &panel.traces);
        let longest = names.map(|trace| trace.name.chars().count()).max();
        let legend = FRAME + LETTER * longest.unwrap_or(0) as f64;
        let legend = legend.min(0.5 * f64::from(WIDTH));
        legend / (f64::from(WIDTH) - 90.0 - legend)
    }

    fn draw(
        &self,
        panel: &Panel,
        area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
        x: Range<f64>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let values = panel.traces.iter().flat_map(|trace| &trace.y).copied();
        let zero = panel.from_zero.then_some(0.0);
        let y = range(values.chain(zero), 0.06);
        let end = x.end + self.legend() * (x.end - x.start);
        let mut chart = ChartBuilder::on(area)
            .margin(8)
            .x_label_area_size(34)
            .y_label_area_size(66)
            .build_cartesian_2d(x.start..end, y)?;
        let label = |x: &f64| self.label(*x);
        chart
            .configure_mesh()
            .x_desc(&self.axis)
            .y_desc(&panel.title)
            .x_label_formatter(&label)
            .y_label_formatter(&|y| tick(*y))
            .y_labels(5)
            .light_line_style(TRANSPARENT)
            .bold_line_style(GREY.mix(0.35))
            .axis_style(GREY)
            .label_style(("sans-serif", 13))
            .draw()?;
        for trace in &panel.traces {
            let style = colour(trace.color).stroke_width(match trace.style {
                Style::Limit => 1,
                _ => 2,
            });
            let points: Vec<_> = points(trace).map(|(x, y)| (self.position(x), y)).collect();
            let points = || points.iter().copied();
            let drawn = match trace.style {
                Style::Dashed => chart.draw_series(DashedLineSeries::new(points(), 6, 5, style))?,
                Style::Limit => chart.draw_series(DashedLineSeries::new(points(), 2, 4, style))?,
                Style::Points => chart
                    .draw_series(points().map(|point| Circle::new(point, 2, style.filled())))?,
                Style::Line | Style::Steps => {
                    chart.draw_series(LineSeries::new(points(), style))?
                }
            };
            let dashed = matches!(trace.style, Style::Dashed | Style::Limit);
            if !trace.named {
                continue;
            }
            drawn.label(&trace.name).legend(move |(x, y)| {
                // A gap in the middle for a dashed line.
                let gap = if dashed { 4 } else { 0 };
                let half = |from, to| PathElement::new([(x + from, y), (x + to, y)], style);
                EmptyElement::at((0, 0)) + half(0, 9 - gap) + half(9 + gap, 18)
            });
        }
        if !panel.traces.iter().any(|trace| trace.named) {
            return Ok(());
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::MiddleRight)
            .background_style(WHITE.mix(0.8))
            .border_style(GREY)
            .label_font(("sans-serif", 12))
            .draw()?;
        Ok(())
    }
}

/// Points of a curve, with corners where values hold.
fn points(trace: &Trace) -> impl Iterator<Item = (f64, f64)> {
    let held = trace.style == Style::Steps;
    let mut before = None;
    trace.x.iter().zip(&trace.y).flat_map(move |(&x, &y)| {
        let corner = before.filter(|_| held).map(|before| (x, before));
        before = Some(y);
        corner.into_iter().chain([(x, y)])
    })
}

/// From the least to the largest, widened by a share at both ends.
fn range(values: impl Iterator<Item = f64>, share: f64) -> Range<f64> {
    let finite = values.filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    if low > high {
        return 0.0..1.0;
    }
    let least = 1e-9 * low.abs().max(high.abs()).max(1e-6);
    let margin = share * (high - low).max(least);
    low - margin..(high + margin).max(low + least)
}

/// A short number; no minus at zero.
fn tick(value: f64) -> String {
    crate::fmu::short((value * 1e9).round() / 1e9 + 0.0)
}

/// A colour like `#1f3a5f`.
fn colour(code: &str) -> RGBColor {
    let part = |from: usize| {
        let digits = code.get(from..from + 2).unwrap_or("0");
        u8::from_str_radix(digits, 16).unwrap_or(0)
    };
    RGBColor(part(1), part(3), part(5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_hold_have_corners() {
        let trace = Trace::new(
            "a",
            "#000000",
            Style::Steps,
            &[0.0, 1.0, 2.0],
            &[3.0, 4.0, 5.0],
        );
        let corners = [(0.0, 3.0), (1.0, 3.0), (1.0, 4.0), (2.0, 4.0), (2.0, 5.0)];
        assert_eq!(points(&trace).collect::<Vec<_>>(), corners);
    }

    #[test]
    fn charts_are_drawn_with_one_value_or_none() {
        for y in [vec![], vec![1.0], vec![f64::NAN]] {
            let x = vec![0.0; y.len()];
            let chart = Chart {
                axis: "x".into(),
                log: false,
                panels: vec![Panel {
                    title: "y".into(),
                    traces: vec![Trace::new("a", "#1f3a5f", Style::Line, &x, &y)],
                    ticks: Vec::new(),
                    from_zero: false,
                }],
            };
            assert!(chart.svg().unwrap().ends_with("</svg>\n"));
        }
        assert_eq!(tick(-1e-17), "0");
        assert_eq!(colour("#1f3a5f"), RGBColor(0x1f, 0x3a, 0x5f));
    }
}
