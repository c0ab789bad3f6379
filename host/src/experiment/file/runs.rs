//! Runs of an experiment: what is common, what its variant says, what it says itself.

use super::super::lines::Lines;
use super::super::{Run, folder_name};
use super::{Entry, File, Schedule, Sequence, mistake, wrong};
use crate::Simulation;
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::setpoints::Setpoints;
use crate::input::{Error, Place};
use std::collections::BTreeMap;
use std::path::Path;

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

pub(super) fn runs(file: &File, lines: &Lines<'_>, folder: &Path) -> Result<Vec<Run>, Error> {
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
                let name = layer.entry.name.clone().ok_or_else(missing)?;
                if folder_name(&name).is_empty() {
                    let message = format!("{name:?} names no folder: it needs letters or digits");
                    return Err(mistake(layer.place(lines, &["name"]), message));
                }
                names.push(name);
            }
            let name = names.join(", ");
            let (simulation, keys) = simulation(&layers, lines, folder)?;
            runs.push(Run {
                folder: folder_name(&name),
                simulation,
                place: run.place(lines, &["name"]).at_key(format!("run {name:?}")),
                keys,
                name,
            });
        }
    }
    Ok(runs)
}

/// What runs, and where each setting and file of it is given.
fn simulation(
    layers: &[&Layer<'_>],
    lines: &Lines<'_>,
    folder: &Path,
) -> Result<(Simulation, BTreeMap<String, Place>), Error> {
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
    Ok((simulation, keys(layers, lines, folder)))
}

/// Where settings and files are given: by key, and by path those whose mistakes name the path.
fn keys(layers: &[&Layer<'_>], lines: &Lines<'_>, folder: &Path) -> BTreeMap<String, Place> {
    let mut keys = BTreeMap::new();
    for layer in layers {
        let entry = layer.entry;
        for (key, given) in [
            ("controller", entry.controller.is_some()),
            ("plant", entry.plant.is_some()),
            ("until", entry.until.is_some()),
            ("step", entry.step.is_some()),
            ("record", entry.record.is_some()),
        ] {
            if given {
                keys.insert(key.to_owned(), layer.place(lines, &[key]));
            }
        }
        let mut file = |path: &Path, key: &[&str]| {
            let path = folder.join(path).display().to_string();
            keys.insert(path, layer.place(lines, key));
        };
        for (key, path) in [
            ("connections", &entry.connections),
            ("setpoints", &entry.setpoints),
        ] {
            path.iter().for_each(|path| file(Path::new(path), &[key]));
        }
        for (i, parameters) in entry.parameters.iter().enumerate() {
            let Ok(parameters) = parameters.parse::<ParameterFile>();
            file(&parameters.path, &["parameters", &i.to_string()]);
        }
    }
    keys
}

/// Values by name; dotted names may be nested tables, and a list sets the first elements of an array.
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
        // The message goes on with the variable.
        let table = layer.keys.first().map_or("", String::as_str);
        let place = layer.place(lines, keys).at_key(format!("{table}.set"));
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
        return Err(wrong(place, *every, "a positive time in s"));
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
