//! Reads an experiment from its TOML file. Every mistake names file, line and key.

use super::lines::Lines;
use super::{
    Combine, Curve, Expectation, Experiment, Figure, FigureKind, Panel, Run, Signal, Style,
    folder_name,
};
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::setpoints::Setpoints;
use crate::input::{Error, Place, read_text};
use crate::output::PANELS;
use crate::{Order, Simulation};
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

/// A mistake at a key.
fn mistake(place: Place, message: impl Into<String>) -> Error {
    Error::Syntax {
        place,
        message: message.into(),
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
        let runs = runs(&file, &lines, path.parent().unwrap_or(Path::new("")))?;
        let expectations = file.expect.iter().enumerate();
        let figures = file.figure.iter().enumerate();
        let experiment = Self {
            expectations: expectations
                .map(|(i, entry)| expectation(entry, &lines, i, &runs))
                .collect::<Result<_, _>>()?,
            figures: figures
                .map(|(i, entry)| figure(entry, &lines, i, &runs))
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
            experiment.runs.iter().map(|r| (&r.folder, &r.place)),
            "run (names may differ in letters, digits, points, minus and underscores)",
        )?;
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
        if name.is_empty() || !seen.insert(name) {
            let message = format!("{name:?} is the name of another {what}");
            return Err(mistake(place.clone(), message));
        }
    }
    Ok(())
}

/// One layer of a run's description with the keys that lead to it.
struct Layer<'a> {
    entry: &'a Entry,
    keys: Vec<String>,
}

impl Layer<'_> {
    fn place(&self, lines: &Lines<'_>, more: &[&str]) -> Place {
        let keys = self.keys.iter().map(String::as_str);
        let keys: Vec<_> = keys.chain(more.iter().copied()).collect();
        lines.place(&keys)
    }
}

fn runs(file: &File, lines: &Lines<'_>, folder: &Path) -> Result<Vec<Run>, Error> {
    let layers = |key: &str, entries: &'_ [Entry]| -> Vec<Vec<String>> {
        (0..entries.len())
            .map(|i| vec![key.to_owned(), i.to_string()])
            .collect()
    };
    if file.common.name.is_some() {
        let place = lines.place(&["common", "name"]);
        return Err(mistake(place, "name belongs to runs and variants"));
    }
    let mut runs = Vec::new();
    for (entry, keys) in file.run.iter().zip(layers("run", &file.run)) {
        let run = Layer { entry, keys };
        let variants: Vec<_> = if file.variant.is_empty() {
            vec![None]
        } else {
            let keys = layers("variant", &file.variant);
            let entries = file.variant.iter().zip(keys);
            entries
                .map(|(entry, keys)| Some(Layer { entry, keys }))
                .collect()
        };
        for variant in variants {
            let common = Layer {
                entry: &file.common,
                keys: vec!["common".to_owned()],
            };
            let mut layers = vec![&common];
            layers.extend(&variant);
            layers.push(&run);
            let named = [Some(&run), variant.as_ref()];
            let mut names = Vec::new();
            for layer in named.into_iter().flatten() {
                let missing = || mistake(layer.place(lines, &[]), "missing field `name`");
                names.push(layer.entry.name.clone().ok_or_else(missing)?);
            }
            let name = names.join(", ");
            runs.push(Run {
                folder: folder_name(&name),
                simulation: simulation(&layers, lines, folder)?,
                place: run.place(lines, &["name"]),
                name,
            });
        }
    }
    Ok(runs)
}

fn simulation(
    layers: &[&Layer<'_>],
    lines: &Lines<'_>,
    folder: &Path,
) -> Result<Simulation, Error> {
    let last = |value: &dyn Fn(&Entry) -> Option<String>| {
        layers.iter().rev().find_map(|layer| value(layer.entry))
    };
    let fmu = |key: &str, value: Option<String>| {
        value.map(|path| folder.join(path)).ok_or_else(|| {
            let place = layers.last().map_or(lines.at(0), |l| l.place(lines, &[]));
            mistake(
                place,
                format!("the run has no {key}: name its FMU, here or in [common]"),
            )
        })
    };
    let mut simulation = Simulation::new(
        fmu("controller", last(&|e| e.controller.clone()))?,
        fmu("plant", last(&|e| e.plant.clone()))?,
    );
    simulation.connections = last(&|e| e.connections.clone()).map(|path| folder.join(path));
    for layer in layers {
        let entry = layer.entry;
        for file in &entry.parameters {
            let Ok(mut file) = file.parse::<ParameterFile>();
            file.path = folder.join(file.path);
            simulation.parameters.push(file);
        }
        assignments(
            &entry.set,
            "",
            &mut vec!["set"],
            layer,
            lines,
            &mut simulation.assignments,
        )?;
        if let Some(setpoints) = setpoints(layer, lines, folder)? {
            simulation.setpoints = Some(setpoints);
        }
        simulation.until = entry.until.or(simulation.until);
        simulation.step = entry.step.unwrap_or(simulation.step);
        simulation.order = entry.order.unwrap_or(simulation.order);
        simulation.record_every = entry.record.unwrap_or(simulation.record_every);
    }
    Ok(simulation)
}

/// Values by name; dotted names may be nested tables, and an array sets all elements of an array.
fn assignments<'a>(
    table: &'a toml::Table,
    prefix: &str,
    keys: &mut Vec<&'a str>,
    layer: &Layer<'_>,
    lines: &Lines<'_>,
    found: &mut Vec<Assignment>,
) -> Result<(), Error> {
    for (key, value) in table {
        let name = format!("{prefix}{key}");
        keys.push(key);
        let place = layer.place(lines, keys);
        let mut give = |name: &str, value: &toml::Value| -> Result<(), Error> {
            let value = match value {
                toml::Value::String(text) => text.clone(),
                toml::Value::Integer(number) => number.to_string(),
                toml::Value::Float(number) => number.to_string(),
                toml::Value::Boolean(flag) => flag.to_string(),
                _ => {
                    let message = format!("{name}: expected a number, true, false or a text");
                    return Err(mistake(place.clone(), message));
                }
            };
            let mut assignment: Assignment = format!("{name}={value}").parse()?;
            assignment.place = place.clone();
            found.push(assignment);
            Ok(())
        };
        match value {
            toml::Value::Table(inner) => {
                assignments(inner, &format!("{name}."), keys, layer, lines, found)?;
            }
            toml::Value::Array(elements) => {
                for (i, element) in elements.iter().enumerate() {
                    give(&format!("{name}[{}]", i + 1), element)?;
                }
            }
            value => give(&name, value)?,
        }
        keys.pop();
    }
    Ok(())
}

fn setpoints(
    layer: &Layer<'_>,
    lines: &Lines<'_>,
    folder: &Path,
) -> Result<Option<Setpoints>, Error> {
    let Entry {
        setpoints,
        schedule,
        sequence,
        ..
    } = layer.entry;
    let given = [setpoints.is_some(), schedule.is_some(), sequence.is_some()];
    if given.into_iter().filter(|given| *given).count() > 1 {
        let message = "only one of setpoints, schedule and sequence can drive a run";
        return Err(mistake(layer.place(lines, &[]), message));
    }
    if let Some(path) = setpoints {
        return Ok(Some(Setpoints::File(folder.join(path))));
    }
    if let Some(Schedule { columns, rows }) = schedule {
        let row = |i: usize| layer.place(lines, &["schedule", "rows", &i.to_string()]);
        return Ok(Some(Setpoints::Rows {
            place: layer.place(lines, &["schedule", "columns"]),
            columns: columns.clone(),
            rows: (0..).map(row).zip(rows.iter().cloned()).collect(),
        }));
    }
    let Some(Sequence { every, setpoints }) = sequence else {
        return Ok(None);
    };
    if !(every.is_finite() && *every > 0.0) {
        let place = layer.place(lines, &["sequence", "every"]);
        return Err(mistake(
            place,
            format!("every = {every}: expected a positive time in s"),
        ));
    }
    let row = |(i, setpoint): (usize, &f64)| {
        let place = layer.place(lines, &["sequence", "setpoints", &i.to_string()]);
        (place, vec![i as f64 * every, *setpoint])
    };
    Ok(Some(Setpoints::Rows {
        place: layer.place(lines, &["sequence"]),
        columns: ["time", "setpoint"].map(str::to_owned).to_vec(),
        rows: setpoints.iter().enumerate().map(row).collect(),
    }))
}

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

fn expectation(
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
        if tolerance.is_some_and(|t| !(t.is_finite() && t >= 0.0)) {
            let message = format!("{key} must be a relative deviation, 0 or more");
            return Err(mistake(place(key), message));
        }
    }
    if !entry.factor.is_finite() || entry.factor == 0.0 {
        return Err(mistake(
            place("factor"),
            "factor must be a finite number and not 0",
        ));
    }
    if entry.tolerance.is_some() && entry.paper.is_none() && entry.reference.is_none() {
        let message = "a tolerance needs the figure that it is about: reference or paper";
        return Err(mistake(place("tolerance"), message));
    }
    if entry.paper_tolerance.is_some() && entry.paper.is_none() {
        let message = "paper_tolerance needs the figure paper";
        return Err(mistake(place("paper_tolerance"), message));
    }
    let of = entry.of.clone().unwrap_or_else(|| vec![entry.name.clone()]);
    Ok(Expectation {
        of: positions("of", &of)?,
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

fn figure(
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
        for (j, curve) in panel.curves.iter().enumerate() {
            let [i, j] = [i.to_string(), j.to_string()];
            let keys = ["figure", &index, "panel", &i, "curves", &j];
            let Ok(y) = curve.y.parse::<Signal>();
            let Ok(x) = curve.x.as_deref().unwrap_or("time").parse::<Signal>();
            curves.push(Curve {
                run: position(&curve.run, runs, lines.place(&keys))?,
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
