//! Reads an experiment from its TOML file. Every mistake names file, line and key.

mod rows;
mod runs;

use super::lines::Lines;
use super::{Combine, Experiment, FigureKind, Style, folder_name};
use crate::Order;
use crate::input::{Error, Place, read_text};
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    #[serde(default)]
    source: String,
    #[serde(default)]
    description: String,
    #[serde(default)]
    see: Vec<See>,
    #[serde(default)]
    alone: bool,
    #[serde(default)]
    common: Entry,
    #[serde(default)]
    variant: Vec<Entry>,
    run: Vec<Entry>,
    #[serde(default)]
    expect: Vec<ExpectationEntry>,
    #[serde(default)]
    figure: Vec<FigureEntry>,
}

/// What a run is made of; a variant or a run adds to what is common, and what comes later wins.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Entry {
    name: Option<String>,
    controller: Option<String>,
    plant: Option<String>,
    connections: Option<String>,
    parameters: Vec<String>,
    set: toml::Table,
    setpoints: Option<String>,
    schedule: Option<Schedule>,
    sequence: Option<Sequence>,
    until: Option<f64>,
    step: Option<f64>,
    order: Option<Order>,
    record: Option<usize>,
}

/// A link on the page.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct See {
    title: String,
    path: String,
}

/// Rows of time and values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Schedule {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

/// Setpoints at equal intervals.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sequence {
    every: f64,
    setpoints: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExpectationEntry {
    name: String,
    #[serde(default)]
    table: String,
    quantity: String,
    of: Option<Vec<String>>,
    #[serde(default)]
    over: Vec<String>,
    #[serde(default)]
    combine: Combine,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    unit: String,
    paper: Option<f64>,
    reference: Option<f64>,
    tolerance: Option<f64>,
    paper_tolerance: Option<f64>,
    at_least: Option<f64>,
    at_most: Option<f64>,
    #[serde(default)]
    note: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FigureEntry {
    name: String,
    title: String,
    #[serde(default)]
    kind: FigureKind,
    from: Option<f64>,
    until: Option<f64>,
    axis: Option<String>,
    panel: Vec<PanelEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PanelEntry {
    axis: String,
    curves: Vec<CurveEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveEntry {
    run: String,
    y: String,
    x: Option<String>,
    #[serde(default = "one")]
    factor: f64,
    name: String,
    #[serde(default)]
    style: Style,
}

fn one() -> f64 {
    1.0
}

/// Names that runs and figures cannot have, since their folders would be in the way.
const RESERVED: [&str; 1] = ["experiment.json"];

/// A mistake at a key.
fn mistake(place: Place, message: impl Into<String>) -> Error {
    Error::Syntax {
        place,
        message: message.into(),
    }
}

/// A number that cannot be meant.
fn wrong(place: Place, value: f64, expected: &str) -> Error {
    Error::Key {
        place,
        value: value.to_string(),
        expected: expected.to_owned(),
    }
}

impl Experiment {
    /// Reads a file. Paths in it are relative to its folder.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = read_text(path)?;
        let lines = Lines::new(path, &text);
        let file: File = toml::from_str(&text).map_err(|error| Error::Syntax {
            place: lines.at(error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        let runs = runs::runs(&file, &lines, path.parent().unwrap_or(Path::new("")))?;
        unique(runs.iter().map(|run| (&run.folder, &run.place)), "run")?;
        let expectations = file.expect.iter().enumerate();
        let figures = file.figure.iter().enumerate();
        let experiment = Self {
            expectations: expectations
                .map(|(i, entry)| rows::expectation(entry, &lines, i, &runs))
                .collect::<Result<_, _>>()?,
            figures: figures
                .map(|(i, entry)| rows::figure(entry, &lines, i, &runs))
                .collect::<Result<_, _>>()?,
            name: path
                .file_stem()
                .map_or(String::new(), |stem| folder_name(&stem.to_string_lossy())),
            file: path.to_owned(),
            title: file.title,
            source: file.source,
            description: file.description,
            see: file
                .see
                .into_iter()
                .map(|see| (see.title, see.path))
                .collect(),
            alone: file.alone,
            runs,
        };
        unique(
            experiment.figures.iter().map(|f| (&f.name, &f.place)),
            "figure",
        )?;
        Ok(experiment)
    }
}

fn unique<'a>(
    names: impl Iterator<Item = (&'a String, &'a Place)>,
    what: &str,
) -> Result<(), Error> {
    let mut seen = std::collections::BTreeSet::new();
    for (name, place) in names {
        if name.is_empty() {
            return Err(mistake(place.clone(), format!("a {what} needs a name")));
        }
        if RESERVED.contains(&name.as_str()) {
            let message = format!("{name:?} is the name of a file that is written too");
            return Err(mistake(place.clone(), message));
        }
        if !seen.insert(name) {
            let message = format!(
                "{name:?} is the name of another {what}; names must differ in letters, digits, points, minus and \
                 underscores"
            );
            return Err(mistake(place.clone(), message));
        }
    }
    Ok(())
}
