//! Figure 1 of the paper: multiple shooting of a double integrator before its nodes are joined.

use plotters::prelude::*;

/// Length of a shooting interval \[s\].
const INTERVAL: f64 = 1.0;
/// A guess of position, velocity and acceleration at each node, as an optimiser may have it on its way.
const NODES: [[f64; 3]; 4] = [
    [0.0, 0.0, 1.0],
    [1.0, 0.8, 0.4],
    [2.6, 1.6, -0.6],
    [3.4, 0.7, -0.9],
];
/// Points of an interval that are drawn.
const POINTS: usize = 50;
const COLOURS: [RGBColor; 4] = [
    RGBColor(0x1f, 0x6f, 0xb2),
    RGBColor(0xe0, 0x8a, 0x1e),
    RGBColor(0x2f, 0x85, 0x5a),
    RGBColor(0x7c, 0x3a, 0xed),
];
const GAP: RGBColor = RGBColor(0xc0, 0x39, 0x2b);

/// Position `time` seconds after a node (eq 8).
fn position([x, v, a]: [f64; 3], time: f64) -> f64 {
    x + v * time + 0.5 * a * time * time
}

/// The figure as SVG.
pub fn figure() -> Result<String, String> {
    let mut svg = String::new();
    draw(&mut svg).map_err(|error| format!("figure 1: {error}"))?;
    Ok(svg)
}

fn draw(svg: &mut String) -> Result<(), Box<dyn std::error::Error + '_>> {
    let root = SVGBackend::with_string(svg, (900, 360)).into_drawing_area();
    let end = INTERVAL * NODES.len() as f64;
    let mut chart = ChartBuilder::on(&root)
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(60)
        .build_cartesian_2d(0.0..end, -0.3..4.5)?;
    chart
        .configure_mesh()
        .x_desc("time [s]")
        .y_desc("position [m]")
        .light_line_style(TRANSPARENT)
        .label_style(("sans-serif", 13))
        .draw()?;
    for (k, (node, colour)) in NODES.iter().zip(COLOURS).enumerate() {
        let start = INTERVAL * k as f64;
        let point = |i: usize| {
            let time = INTERVAL * i as f64 / POINTS as f64;
            (start + time, position(*node, time))
        };
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new((0..=POINTS).map(point), style))?
            .label(format!("from node {}", k + 1))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        chart.draw_series([Circle::new((start, node[0]), 4, colour.filled())])?;
        if let Some(next) = NODES.get(k + 1) {
            let gap = [point(POINTS), (start + INTERVAL, next[0])];
            chart.draw_series(DashedLineSeries::new(gap, 3, 3, GAP.stroke_width(2)))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 13))
        .draw()?;
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_interval_ends_where_the_next_begins() {
        for pair in NODES.windows(2) {
            assert!((position(pair[0], INTERVAL) - pair[1][0]).abs() > 0.1);
        }
        assert!(figure().unwrap().contains("from node 4"));
    }
}
