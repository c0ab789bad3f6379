//! Time of a plan over N, both axes logarithmic, one panel per arm.

use plotters::prelude::*;

use super::Curve;
use crate::Failure;
use crate::planners::ARMS;

/// Colours by order of the curves; those who see red and green alike can tell them apart.
const COLOURS: [RGBColor; 3] = [
    RGBColor(0xe0, 0x8a, 0x1e),
    RGBColor(0x1f, 0x6f, 0xb2),
    RGBColor(0x5b, 0x67, 0x70),
];
const GREY: RGBColor = RGBColor(0x94, 0xa7, 0xb8);
const NOTE: RGBColor = RGBColor(0x55, 0x5f, 0x68);
const FONT: (&str, i32) = ("sans-serif", 13);
const SIZE: (u32, u32) = (900, 420);
/// N that are drawn.
const X: std::ops::Range<f64> = 8.0..400.0;
/// µs that are drawn at most; leaves room for the legend.
const SLOWEST: f64 = 1e6;

/// The figure, as SVG.
pub fn draw(curves: &[Curve]) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let note = format!("{}; medians over the starts", crate::machine());
        let at = (12, SIZE.1 as i32 - 16);
        root.draw(&Text::new(
            note,
            at,
            ("sans-serif", 11).into_font().color(&NOTE),
        ))?;
        let (root, _) = root.split_vertically(SIZE.1 - 18);
        for (arm, area) in ARMS.iter().zip(root.split_evenly((1, ARMS.len()))) {
            let of: Vec<_> = curves.iter().filter(|curve| curve.arm == *arm).collect();
            panel(arm, &of, &area)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn panel(
    arm: &str,
    curves: &[&Curve],
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
) -> Result<(), Failure> {
    let marks = super::HORIZONS.map(f64::from).to_vec();
    let plans = curves.iter().flat_map(|curve| curve.plans());
    let fastest = plans.fold(SLOWEST, |least, (_, us)| least.min(us));
    let lowest = fastest.log10().floor() as i32;
    let decades = (lowest..7).map(|power| 10_f64.powi(power)).collect();
    let mut chart = ChartBuilder::on(area)
        .caption(arm, ("sans-serif", 15))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(62)
        .build_cartesian_2d(
            X.log_scale().with_key_points(marks),
            (10_f64.powi(lowest)..SLOWEST)
                .log_scale()
                .with_key_points(decades),
        )?;
    chart
        .configure_mesh()
        .x_desc("N, intervals in 2 s")
        .y_desc("a plan [µs]")
        .x_label_formatter(&|n| format!("{n:.0}"))
        .y_label_formatter(&|us| us.to_string())
        .light_line_style(TRANSPARENT)
        .bold_line_style(GREY.mix(0.35))
        .axis_style(GREY)
        .label_style(FONT)
        .draw()?;
    for (curve, colour) in curves.iter().zip(COLOURS) {
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(curve.plans(), style))?
            .label(&curve.kind)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        chart.draw_series(curve.plans().map(|at| Circle::new(at, 3, colour.filled())))?;
    }
    // What linear growth looks like, a little above the first curve.
    if let Some((n, us)) = curves.first().and_then(|curve| curve.plans().nth(2)) {
        let linear = [10.0, 320.0].map(|x| (x, 3.0 * us * x / n));
        let style = GREY.stroke_width(1);
        chart
            .draw_series(DashedLineSeries::new(linear, 4, 4, style))?
            .label("linear")
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(GREY)
        .label_font(FONT)
        .draw()?;
    Ok(())
}
