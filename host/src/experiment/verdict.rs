//! Compares runs with what was expected of them.

use super::{Expectation, Experiment};
use crate::{Error, Outcome};
use serde::{Deserialize, Serialize};

/// A row of the experiment's table.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Row {
    /// Name of the row.
    pub name: String,
    /// Table that it belongs to. May be empty.
    pub table: String,
    /// What is measured.
    pub quantity: String,
    /// Unit of the figures. May be empty.
    pub unit: String,
    /// The published figure.
    pub paper: Option<f64>,
    /// A figure from an independent simulation.
    pub reference: Option<f64>,
    /// What the runs come to; None if one of them failed or does not offer the quantity.
    pub ours: Option<f64>,
    /// Ours divided by the paper's.
    pub ratio: Option<f64>,
    /// What is admissible, in words. Empty: the row is shown, not judged.
    pub admissible: String,
    /// Whether ours is; None: not judged.
    pub met: Option<bool>,
    /// What a reader should know about the row. May be empty.
    pub note: String,
}

impl Row {
    /// Like `max(plant.angle) [rad]`.
    pub fn quantity_with_unit(&self) -> String {
        let Self { quantity, unit, .. } = self;
        match unit.as_str() {
            "" => quantity.clone(),
            unit => format!("{quantity} [{unit}]"),
        }
    }
}

/// Title of a column of figures, and the figure of each row.
pub type Column = (&'static str, Vec<Option<f64>>);

/// The figures of a table's rows by column; columns that no row fills are left out.
pub fn columns(rows: &[Row]) -> Vec<Column> {
    let column = |title, figure: &dyn Fn(&Row) -> Option<f64>| {
        let figures: Vec<_> = rows.iter().map(figure).collect();
        figures
            .iter()
            .any(Option::is_some)
            .then_some((title, figures))
    };
    let ours = rows.iter().map(|row| row.ours).collect();
    [
        column("paper", &|row| row.paper),
        column("reference", &|row| row.reference),
        Some(("ours", ours)),
        column("ours / paper", &|row| row.ratio),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The rows of an experiment whose runs came to `outcomes`, in the order of its runs; those of one table follow
/// each other.
pub fn rows(experiment: &Experiment, outcomes: &[Result<Outcome, Error>]) -> Vec<Row> {
    let expectations = &experiment.expectations;
    let mut rows: Vec<Row> = expectations.iter().map(|e| row(e, outcomes)).collect();
    let first = |table: &str| expectations.iter().position(|e| e.table == table);
    rows.sort_by_key(|row| first(&row.table));
    rows
}

fn row(expectation: &Expectation, outcomes: &[Result<Outcome, Error>]) -> Row {
    let Expectation {
        quantity,
        paper,
        reference,
        ..
    } = expectation;
    let number = |runs: &[usize]| {
        let values: Option<Vec<_>> = runs
            .iter()
            .map(|&run| quantity.of(outcomes.get(run)?.as_ref().ok()?))
            .collect();
        expectation.combine.of(&values?)
    };
    let ours = number(&expectation.of).and_then(|value| {
        if expectation.over.is_empty() {
            Some(value)
        } else {
            Some(value / number(&expectation.over)?)
        }
    });
    let ours = ours.map(|value| expectation.factor * value);
    let mut admissible = Vec::new();
    let mut met = true;
    let mut judge = |text: String, holds: &dyn Fn(f64) -> bool| {
        admissible.push(text);
        met &= ours.is_some_and(holds);
    };
    let about = reference.map(|value| (value, "reference"));
    let about = about.or(paper.map(|value| (value, "paper")));
    if let (Some(tolerance), Some((value, name))) = (expectation.tolerance, about) {
        let holds = |ours: f64| (ours - value).abs() <= tolerance * value.abs();
        judge(format!("{name} ± {}", percent(tolerance)), &holds);
    }
    if let (Some(tolerance), Some(value)) = (expectation.paper_tolerance, *paper) {
        let holds = |ours: f64| (ours - value).abs() <= tolerance * value.abs();
        judge(format!("paper ± {}", percent(tolerance)), &holds);
    }
    if let Some(least) = expectation.at_least {
        judge(format!("≥ {least}"), &|ours| ours >= least);
    }
    if let Some(most) = expectation.at_most {
        judge(format!("≤ {most}"), &|ours| ours <= most);
    }
    Row {
        name: expectation.name.clone(),
        table: expectation.table.clone(),
        quantity: quantity.to_string(),
        unit: expectation.unit.clone(),
        paper: *paper,
        reference: *reference,
        ours,
        ratio: ours.zip(*paper).map(|(ours, paper)| ours / paper),
        met: (!admissible.is_empty()).then_some(met),
        admissible: admissible.join(", "),
        note: expectation.note.clone(),
    }
}

/// Like "1 %".
fn percent(share: f64) -> String {
    format!("{} %", crate::fmu::short(100.0 * share))
}
