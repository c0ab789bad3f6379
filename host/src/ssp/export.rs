//! Makes an SSP of an experiment: each run a system structure of its own, with its parameter sets, its inputs
//! over time and the FMUs. The first run is the default one.

use super::drawing::Drawing;
use super::ssd;
use crate::experiment::{Experiment, Run};
use crate::fmu::{Fmu, Scalar, Value};
use crate::input::Side;
use crate::run::Order;
use crate::whole::write_whole;
use crate::{Error, Prepared};
use model_description::Unit;
use model_description::ssv::{self, Parameter, ParameterSet};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// What to make.
#[derive(Clone, Debug)]
pub struct Export {
    /// FMU that takes the place of the experiment's controller in all runs.
    pub controller: Option<PathBuf>,
    /// FMU that takes the place of the experiment's plant in all runs.
    pub plant: Option<PathBuf>,
}

/// The content of a package by path.
#[derive(Default)]
struct Content(BTreeMap<String, Vec<u8>>);

impl Content {
    /// Adds a file of the user; returns its path. Files of one name and other content get a number.
    fn resource(&mut self, name: &str, bytes: Vec<u8>) -> String {
        let (stem, extension) = name.rsplit_once('.').unwrap_or((name, ""));
        let mut path = format!("resources/{name}");
        let mut count = 1;
        while self.0.get(&path).is_some_and(|present| *present != bytes) {
            count += 1;
            path = format!("resources/{stem}-{count}.{extension}");
        }
        self.0.insert(path.clone(), bytes);
        path
    }

    /// The archive: entries by name, all of one date, so that equal content gives equal bytes.
    fn to_bytes(&self) -> io::Result<Vec<u8>> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (path, content) in &self.0 {
            // FMUs are compressed already.
            let method = if path.ends_with(".fmu") {
                CompressionMethod::Stored
            } else {
                CompressionMethod::Deflated
            };
            let options = SimpleFileOptions::default()
                .compression_method(method)
                .last_modified_time(DateTime::default())
                .unix_permissions(0o644);
            zip.start_file(path.as_str(), options)?;
            zip.write_all(content)?;
        }
        Ok(zip.finish()?.into_inner())
    }
}

/// FMUs that are open, by file.
type Opened = BTreeMap<PathBuf, Fmu>;

impl Export {
    /// Writes the package to `file`, whole or not at all. Returns what it cannot express.
    pub fn write(&self, experiment: &Experiment, file: &Path) -> Result<Vec<String>, Error> {
        let mut content = Content::default();
        let mut opened = Opened::new();
        let mut warnings = Vec::new();
        for (index, run) in experiment.runs.iter().enumerate() {
            let name = match index {
                0 => "SystemStructure".to_owned(),
                _ => run.folder.clone(),
            };
            let of_run = |error| match error {
                Error::Input(mistake) => Error::Input(run.blame(mistake)),
                other => other,
            };
            let structure = self
                .structure(run, &mut content, &mut opened)
                .map_err(of_run)?;
            content
                .0
                .insert(format!("{name}.ssd"), structure.into_bytes());
            if run.simulation.order == Order::SideBySide {
                warnings.push(format!(
                    "{}: {}: an SSP cannot say that its components step side by side",
                    run.place, run.name
                ));
            }
        }
        let written = content.to_bytes();
        let written = written.and_then(|bytes| write_whole(file, &bytes));
        written.map_err(|source| Error::Output {
            path: file.to_owned(),
            source,
        })?;
        Ok(warnings)
    }

    /// The `.ssd` of a run; what it refers to goes to `content`.
    fn structure(
        &self,
        run: &Run,
        content: &mut Content,
        opened: &mut Opened,
    ) -> Result<String, Error> {
        let mut simulation = run.simulation.clone();
        if let Some(controller) = &self.controller {
            simulation.controller.clone_from(controller);
        }
        if let Some(plant) = &self.plant {
            simulation.plant.clone_from(plant);
        }
        let mut open = |file: &PathBuf| -> Result<Fmu, Error> {
            if let Some(fmu) = opened.get(file) {
                return Ok(fmu.clone());
            }
            let fmu = Fmu::open(file)?;
            opened.insert(file.clone(), fmu.clone());
            Ok(fmu)
        };
        let fmus = [open(&simulation.controller)?, open(&simulation.plant)?];
        let prepared = Prepared::new(&simulation, &fmus[0], &fmus[1])?;
        let mut sources = Vec::new();
        for fmu in &fmus {
            let bytes = fs::read(fmu.file()).map_err(|source| {
                Error::Input(crate::input::Error::Read {
                    file: fmu.file().to_owned(),
                    source,
                })
            })?;
            sources.push(content.resource(&file_name(fmu.file()), bytes));
        }
        let mut drawing = Drawing::new(&run.name, &fmus, sources, &prepared, simulation.step);
        let stem = &run.folder;
        for side in Side::BOTH {
            let set = parameters(&run.name, &prepared, side, &drawing);
            if !set.parameters.is_empty() {
                let text = ssv::write(&set).into_bytes();
                let path = content.resource(&format!("{stem}-{side}.ssv"), text);
                drawing.parameters[side as usize] = Some(path);
            }
        }
        if let Some(csv) = drawing.inputs_over_time() {
            let path = content.resource(&format!("{stem}.csv"), csv.into_bytes());
            drawing.inputs = Some(path);
        }
        if let Some(set) = drawing.start_values() {
            let text = ssv::write(&set).into_bytes();
            drawing.start = Some(content.resource(&format!("{stem}-start.ssv"), text));
        }
        Ok(ssd::write(&drawing))
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned())
}

/// All values that a component is given, from files and single ones, as one set. Other tools know no
/// enumerations in parameter sets, so their items are given by number, which is their underlying type (SSP 1.0
/// sec 4.4.1).
fn parameters(
    run: &str,
    prepared: &Prepared<'_>,
    side: Side,
    drawing: &Drawing<'_>,
) -> ParameterSet {
    let description = prepared.pair().of(side);
    let mut units = BTreeMap::new();
    let mut one = |(scalar, value): (Scalar, Value)| {
        let unit = description.variable(scalar).unit.as_ref();
        let base = unit.and_then(|unit| drawing.base_unit(unit));
        if let (Some(name), Some(base)) = (unit, base) {
            let unit = Unit {
                name: name.clone(),
                base: Some(base.clone()),
                display_units: Vec::new(),
                line: 0,
            };
            units.insert(name.clone(), unit);
        }
        let is_real = matches!(value, Value::Float(_));
        Parameter {
            name: description.name_of(scalar),
            value: match value {
                Value::Float(number) => ssv::Value::Real(number),
                Value::Integer(number) => ssv::Value::Integer(number as i64),
                Value::Boolean(truth) => ssv::Value::Boolean(truth),
                Value::Text(text) => ssv::Value::String(text),
            },
            unit: unit.filter(|_| is_real && base.is_some()).cloned(),
            line: 0,
        }
    };
    let values = prepared.values().of(side);
    let parameters = values.into_iter().map(&mut one).collect();
    ParameterSet {
        name: run.to_owned(),
        description: format!("Parameters of the {side}"),
        parameters,
        units: units.into_values().collect(),
    }
}
