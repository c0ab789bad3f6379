//! What is expected of the runs.

use super::Quantity;
use crate::input::Place;
use serde::Deserialize;

/// How the numbers of several runs become one.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// Their sum.
    #[default]
    Sum,
    /// Their mean.
    Mean,
    /// The largest.
    Max,
}

impl Combine {
    /// One number of many; None of none.
    pub fn of(self, values: &[f64]) -> Option<f64> {
        let sum = || values.iter().sum::<f64>();
        match self {
            _ if values.is_empty() => None,
            Self::Sum => Some(sum()),
            Self::Mean => Some(sum() / values.len() as f64),
            Self::Max => values.iter().copied().reduce(f64::max),
        }
    }
}

/// A row of the experiment's table: a quantity of some runs, perhaps divided by that of others.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// Name of the row.
    pub name: String,
    /// Table that the row belongs to. May be empty.
    pub table: String,
    /// What is measured.
    pub quantity: Quantity,
    /// Positions of the runs.
    pub of: Vec<usize>,
    /// Positions of the runs whose quantity divides; empty: nothing does.
    pub over: Vec<usize>,
    /// How several runs become one number.
    pub combine: Combine,
    /// Factor of the number, for units that read well.
    pub factor: f64,
    /// Unit of the number. May be empty.
    pub unit: String,
    /// The published figure.
    pub paper: Option<f64>,
    /// A figure from an independent simulation.
    pub reference: Option<f64>,
    /// Largest relative deviation from the reference, or from the paper where there is none.
    pub tolerance: Option<f64>,
    /// Largest relative deviation from the published figure.
    pub paper_tolerance: Option<f64>,
    /// The least admissible value.
    pub at_least: Option<f64>,
    /// The largest admissible value.
    pub at_most: Option<f64>,
    /// What a reader should know about the row. May be empty.
    pub note: String,
    /// Where it is described.
    pub place: Place,
}
