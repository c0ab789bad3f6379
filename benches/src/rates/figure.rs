//! A push at four planning rates on both arms, and a step by late plans.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::Failure;

/// From the paper's rate to that of the feedback.
const COLOURS: [RGBColor; 4] = [
    RGBColor(0x5b, 0x67, 0x70),
    RGBColor(0xe0, 0x8a, 0x1e),
    RGBColor(0x2f, 0x85, 0x5a),
    RGBColor(0x1f, 0x6f, 0xb2),
];
const GREY: RGBColor = RGBColor(0x94, 0xa7, 0xb8);
const FONT: (&str, i32) = ("sans-serif", 13);
const SIZE: (u32, u32) = (960, 360);

/// A curve of errors \[rad\] over time \[s\].
type Errors = Vec<(f64, f64)>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The figure, as SVG.
pub fn draw(pushes: &[(String, f64, Errors)], late: &[(&str, Errors)]) -> Result<String, Failure> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let areas = root.split_evenly((1, 3));
        for (area, name) in areas.iter().zip(["T-flex, push", "pendulum, push"]) {
            let curves: Vec<_> = pushes
                .iter()
                .filter(|(of, ..)| of == name)
                .map(|(_, rate, errors)| (format!("{rate} Hz"), errors.as_slice()))
                .collect();
            panel(
                area,
                &format!("{name}: error [mrad]"),
                1.5..4.0,
                1e3,
                &curves,
            )?;
        }
        let curves: Vec<_> = late
            .iter()
            .map(|(name, errors)| ((*name).to_owned(), errors.as_slice()))
            .collect();
        panel(
            &areas[2],
            "T-flex, late plans: error [rad]",
            0.0..2.0,
            1.0,
            &curves,
        )?;
        root.present()?;
    }
    Ok(svg)
}

/// Errors times `factor` over the times `shown`.
fn panel(
    area: &Area<'_>,
    caption: &str,
    shown: Range<f64>,
    factor: f64,
    curves: &[(String, &[(f64, f64)])],
) -> Result<(), Failure> {
    let within = |errors: &[(f64, f64)]| -> Errors {
        let errors = errors.iter().filter(|(time, _)| shown.contains(time));
        errors
            .map(|(time, error)| (*time, factor * error))
            .collect()
    };
    let curves: Vec<_> = curves
        .iter()
        .map(|(name, errors)| (name, within(errors)))
        .collect();
    let all = curves
        .iter()
        .flat_map(|(_, errors)| errors.iter().map(|(_, error)| *error));
    let (low, high) = all.fold((0.0, 0.0), |(low, high), error| {
        (f64::min(low, error), f64::max(high, error))
    });
    // Room for the legend below.
    let range = (low - 0.45 * (high - low))..(high + 0.05 * (high - low));
    let mut chart = ChartBuilder::on(area)
        .caption(caption, ("sans-serif", 15))
        .margin(8)
        .x_label_area_size(34)
        .y_label_area_size(46)
        .build_cartesian_2d(shown.clone(), range)?;
    chart
        .configure_mesh()
        .x_desc("time [s]")
        .x_labels(6)
        .y_labels(7)
        .y_label_formatter(&|error| format!("{:.1}", error + 0.0))
        .light_line_style(TRANSPARENT)
        .bold_line_style(GREY.mix(0.35))
        .axis_style(GREY)
        .label_style(FONT)
        .draw()?;
    let colours: &[RGBColor] = if curves.len() == 2 {
        &[COLOURS[3], COLOURS[1]]
    } else {
        &COLOURS
    };
    for ((name, errors), colour) in curves.into_iter().zip(colours) {
        let style = colour.stroke_width(2);
        chart
            .draw_series(LineSeries::new(errors, style))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.8))
        .border_style(GREY)
        .label_font(FONT)
        .draw()?;
    Ok(())
}
