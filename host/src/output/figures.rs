//! The figures of an experiment, drawn from its runs.

use super::chart::{Chart, Panel, Trace};
use crate::experiment::{self, Curve, Figure, FigureKind};
use crate::{Error, Outcome};

/// Colours of the curves of a figure, in order.
pub(super) const COLOURS: [&str; 8] = [
    "#1f6fb2", "#e08a1e", "#2f855a", "#c0392b", "#7c3aed", "#0891b2", "#8b5e3c", "#64748b",
];
/// Frequencies of a response for each decade.
const PER_DECADE: i32 = 60;

/// The chart of a figure. Curves of runs that failed are left out.
pub(super) fn chart(figure: &Figure, outcomes: &[Result<Outcome, Error>]) -> Chart {
    let mut named: Vec<&str> = Vec::new();
    let mut panels = Vec::new();
    for panel in &figure.panels {
        // Curves of one name have one colour in all panels.
        for curve in &panel.curves {
            if !named.contains(&curve.name.as_str()) {
                named.push(&curve.name);
            }
        }
        let colour = |curve: &Curve| {
            let position = named.iter().position(|name| *name == curve.name);
            COLOURS[position.unwrap_or(0) % COLOURS.len()]
        };
        let curves = panel.curves.iter().map(|curve| (curve, colour(curve)));
        match figure.kind {
            FigureKind::Signals => {
                let traces = curves.filter_map(|(curve, colour)| {
                    let [x, y] = samples(curve, outcomes)?;
                    let (x, y) = within(figure.range, &x, &y);
                    Some(Trace::new(&curve.name, colour, curve.style, &x, &y))
                });
                panels.push(Panel::new(&panel.axis, traces.collect()));
            }
            FigureKind::FrequencyResponse => {
                let mut amplitudes = Vec::new();
                let mut phases = Vec::new();
                for (curve, colour) in curves {
                    let Some([frequency, amplitude, phase]) =
                        response(figure.range, curve, outcomes)
                    else {
                        continue;
                    };
                    let trace =
                        |y: &[f64]| Trace::new(&curve.name, colour, curve.style, &frequency, y);
                    amplitudes.push(trace(&amplitude));
                    phases.push(Trace {
                        named: false,
                        ..trace(&phase)
                    });
                }
                panels.push(Panel::new(format!("{} [dB]", panel.axis), amplitudes));
                panels.push(Panel::new("phase [deg]", phases));
            }
        }
    }
    Chart {
        axis: figure.axis.clone(),
        log: figure.kind == FigureKind::FrequencyResponse,
        panels,
    }
}

/// Samples of a curve's x and y.
fn samples(curve: &Curve, outcomes: &[Result<Outcome, Error>]) -> Option<[Vec<f64>; 2]> {
    let recording = &outcomes.get(curve.run)?.as_ref().ok()?.recording;
    let x = curve.x.samples(recording)?;
    let mut y = curve.y.samples(recording)?;
    y.iter_mut().for_each(|y| *y *= curve.factor);
    Some([x, y])
}

/// The samples whose x lies in a range.
fn within(range: [Option<f64>; 2], x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let [from, until] = range;
    let from = from.unwrap_or(f64::NEG_INFINITY);
    let until = until.unwrap_or(f64::INFINITY);
    let points = x.iter().zip(y);
    points.filter(|(x, _)| (from..=until).contains(*x)).unzip()
}

/// Frequency \[Hz\], amplitude \[dB\] and phase \[deg\] of the response of y to x, from one transient.
fn response(
    range: [Option<f64>; 2],
    curve: &Curve,
    outcomes: &[Result<Outcome, Error>],
) -> Option<[Vec<f64>; 3]> {
    let [x, y] = samples(curve, outcomes)?;
    let recording = &outcomes.get(curve.run)?.as_ref().ok()?.recording;
    let time = recording.column(0);
    let step = time.get(1)? - time.first()?;
    let nyquist = 0.5 / step;
    let low = range[0].unwrap_or(nyquist * 1e-4);
    let high = range[1].unwrap_or(nyquist);
    let first = (low.log10() * f64::from(PER_DECADE)).ceil() as i32;
    let last = (high.min(nyquist).log10() * f64::from(PER_DECADE)).floor() as i32;
    let frequencies = (first..=last).map(|k| 10_f64.powf(f64::from(k) / f64::from(PER_DECADE)));
    let frequencies: Vec<f64> = frequencies.collect();
    let [amplitude, phase] = experiment::frequency_response(&x, &y, step, &frequencies);
    let decibels = amplitude.iter().map(|a| 20.0 * a.log10()).collect();
    Some([frequencies, decibels, phase])
}
