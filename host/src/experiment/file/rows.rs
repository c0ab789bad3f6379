//! Expected figures and figures to draw, with the runs that they name.

use super::super::lines::Lines;
use super::super::{Curve, Expectation, Figure, FigureKind, Panel, Run, Signal, folder_name};
use super::{ExpectationEntry, FigureEntry, mistake, wrong};
use crate::input::{Error, Place};
use crate::output::PANELS;

/// Position of the run of a name.
fn position(name: &str, runs: &[Run], place: Place) -> Result<usize, Error> {
    let found = runs.iter().position(|run| run.name == name);
    found.ok_or_else(|| {
        let names: Vec<_> = runs.iter().map(|run| format!("{:?}", run.name)).collect();
        mistake(
            place,
            format!("there is no run {name:?}; there are: {}", names.join(", ")),
        )
    })
}

pub(super) fn expectation(
    entry: &ExpectationEntry,
    lines: &Lines<'_>,
    index: usize,
    runs: &[Run],
) -> Result<Expectation, Error> {
    let index = index.to_string();
    let place = |key: &str| lines.place(&["expect", &index, key]);
    let positions = |key: &str, names: &[String]| -> Result<Vec<usize>, Error> {
        let names = names.iter();
        names.map(|name| position(name, runs, place(key))).collect()
    };
    let quantity = entry.quantity.parse();
    let limits = [
        ("tolerance", entry.tolerance),
        ("paper_tolerance", entry.paper_tolerance),
    ];
    for (key, tolerance) in limits {
        if let Some(tolerance) = tolerance
            && !(tolerance.is_finite() && tolerance >= 0.0)
        {
            let expected = "a relative deviation, 0 or more";
            return Err(wrong(place(key), tolerance, expected));
        }
    }
    let numbers = [
        ("paper", entry.paper),
        ("reference", entry.reference),
        ("at_least", entry.at_least),
        ("at_most", entry.at_most),
    ];
    for (key, value) in numbers {
        if let Some(value) = value.filter(|value| !value.is_finite()) {
            return Err(wrong(place(key), value, "a finite number"));
        }
    }
    factor(entry.factor, || place("factor"))?;
    if let (Some(least), Some(most)) = (entry.at_least, entry.at_most)
        && least > most
    {
        let expected = format!("at least at_least = {least}");
        return Err(wrong(place("at_most"), most, &expected));
    }
    if entry.tolerance.is_some() && entry.paper.is_none() && entry.reference.is_none() {
        let message = "needs the figure that it is about: reference or paper";
        return Err(mistake(place("tolerance"), message));
    }
    if entry.paper_tolerance.is_some() && entry.paper.is_none() {
        let message = "needs the figure that it is about: paper";
        return Err(mistake(place("paper_tolerance"), message));
    }
    let about = entry.reference.or(entry.paper);
    let relative = [("tolerance", about), ("paper_tolerance", entry.paper)];
    for ((key, tolerance), (_, figure)) in limits.into_iter().zip(relative) {
        if tolerance.is_some() && figure == Some(0.0) {
            let message =
                "nothing but 0 deviates from 0 by a share of it: use at_least and at_most";
            return Err(mistake(place(key), message));
        }
    }
    let of = match &entry.of {
        Some(of) if of.is_empty() => return Err(mistake(place("of"), "names no run")),
        Some(of) => positions("of", of)?,
        None => positions("name", std::slice::from_ref(&entry.name))?,
    };
    Ok(Expectation {
        of,
        over: positions("over", &entry.over)?,
        quantity: quantity.map_err(|message| mistake(place("quantity"), message))?,
        name: entry.name.clone(),
        table: entry.table.clone(),
        combine: entry.combine,
        factor: entry.factor,
        unit: entry.unit.clone(),
        paper: entry.paper,
        reference: entry.reference,
        tolerance: entry.tolerance,
        paper_tolerance: entry.paper_tolerance,
        at_least: entry.at_least,
        at_most: entry.at_most,
        note: entry.note.clone(),
        place: place("quantity"),
    })
}

fn factor(factor: f64, place: impl FnOnce() -> Place) -> Result<(), Error> {
    if factor.is_finite() && factor != 0.0 {
        return Ok(());
    }
    Err(wrong(place(), factor, "a finite number that is not 0"))
}

pub(super) fn figure(
    entry: &FigureEntry,
    lines: &Lines<'_>,
    index: usize,
    runs: &[Run],
) -> Result<Figure, Error> {
    let index = index.to_string();
    let place = lines.place(&["figure", &index, "name"]);
    if entry.name != folder_name(&entry.name) {
        let message = "the name of a figure names its file: only letters, digits, '.', '-' and '_'";
        return Err(mistake(place, message));
    }
    let at = |key: &str| lines.place(&["figure", &index, key]);
    for (key, value) in [("from", entry.from), ("until", entry.until)] {
        if let Some(value) = value.filter(|value| !value.is_finite()) {
            return Err(wrong(at(key), value, "a finite number"));
        }
        let response = entry.kind == FigureKind::FrequencyResponse;
        if let (Some(value), true) = (value, response)
            && value <= 0.0
        {
            return Err(wrong(at(key), value, "a positive frequency in Hz"));
        }
    }
    if let (Some(from), Some(until)) = (entry.from, entry.until)
        && from >= until
    {
        let expected = format!("more than from = {from}");
        return Err(wrong(at("until"), until, &expected));
    }
    // A frequency response has a second panel for the phase.
    let most = match entry.kind {
        FigureKind::Signals => PANELS,
        FigureKind::FrequencyResponse => PANELS / 2,
    };
    if !(1..=most).contains(&entry.panel.len()) {
        let message = format!("a figure like this has 1 to {most} panels");
        return Err(mistake(place, message));
    }
    let mut panels = Vec::new();
    for (i, panel) in entry.panel.iter().enumerate() {
        let mut curves = Vec::new();
        if panel.curves.is_empty() {
            let place = lines.place(&["figure", &index, "panel", &i.to_string(), "curves"]);
            return Err(mistake(place, "a panel needs at least one curve"));
        }
        for (j, curve) in panel.curves.iter().enumerate() {
            let [i, j] = [i.to_string(), j.to_string()];
            let at = |key| lines.place(&["figure", &index, "panel", &i, "curves", &j, key]);
            factor(curve.factor, || at("factor"))?;
            let Ok(y) = curve.y.parse::<Signal>();
            let Ok(x) = curve.x.as_deref().unwrap_or("time").parse::<Signal>();
            curves.push(Curve {
                run: position(&curve.run, runs, at("run"))?,
                places: [at("x"), at("y")],
                y,
                x,
                factor: curve.factor,
                name: curve.name.clone(),
                style: curve.style,
            });
        }
        panels.push(Panel {
            axis: panel.axis.clone(),
            curves,
        });
    }
    let axis = || match entry.kind {
        FigureKind::Signals => "time [s]".to_owned(),
        FigureKind::FrequencyResponse => "frequency [Hz]".to_owned(),
    };
    Ok(Figure {
        name: entry.name.clone(),
        title: entry.title.clone(),
        kind: entry.kind,
        range: [entry.from, entry.until],
        axis: entry.axis.clone().unwrap_or_else(axis),
        panels,
        place,
    })
}
