//! What is drawn of the runs.

use super::Signal;
use crate::input::Place;
use serde::Deserialize;

/// A figure: panels above each other with one axis below.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name, unique in the experiment; also that of its SVG file.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// What it draws.
    pub kind: FigureKind,
    /// Range of the lower axis; none: all there is.
    pub range: [Option<f64>; 2],
    /// Title of the lower axis.
    pub axis: String,
    /// The panels.
    pub panels: Vec<Panel>,
    /// Where it is described.
    pub place: Place,
}

/// What a figure draws.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum FigureKind {
    /// Signals over another one, by default time.
    #[default]
    Signals,
    /// Amplitude and phase of the response of `y` to `x` over frequency \[Hz\]: one panel becomes two.
    FrequencyResponse,
}

/// One panel.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Title of its axis.
    pub axis: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// One curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Position of the run.
    pub run: usize,
    /// What is drawn.
    pub y: Signal,
    /// Over what.
    pub x: Signal,
    /// Factor of `y`.
    pub factor: f64,
    /// Name in the legend.
    pub name: String,
    /// How.
    pub style: Style,
    /// Where `x` and `y` are given.
    pub places: [Place; 2],
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Style {
    /// A line.
    #[default]
    Line,
    /// A dashed line.
    Dashed,
    /// A value that holds until the next one.
    Steps,
    /// A thin dotted line, for limits.
    Limit,
    /// Points.
    Points,
}
