//! Makes an SSP of an experiment: each run a system structure of its own, with its parameter sets, its inputs
//! over time and the FMUs. The first run is the default one.

use super::drawing::{self, Drawing};
use super::package::syntax;
use crate::experiment::{Experiment, Run, folder_name};
use crate::fmu::{Description, Fmu, Value};
use crate::input::Side;
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::read_text;
use crate::run::Order;
use crate::{Error, Prepared};
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
        for count in 1.. {
            let path = match count {
                1 => format!("resources/{name}"),
                count => format!("resources/{stem}-{count}.{extension}"),
            };
            match self.0.get(&path) {
                Some(present) if *present != bytes => {}
                _ => {
                    self.0.insert(path.clone(), bytes);
                    return path;
                }
            }
        }
        unreachable!("counting does not end")
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
                Error::Input(error) => Error::Input(error.of_run(&run.place, &run.name)),
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
        write_whole(file, &content).map_err(|source| Error::Output {
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
        for file in &simulation.parameters {
            let bytes = read_text(&file.path)?.into_bytes();
            let path = content.resource(&file_name(&file.path), bytes);
            for side in sides(file) {
                drawing.bindings[side as usize].push(path.clone());
            }
        }
        let stem = folder_name(&run.name);
        for side in [Side::Controller, Side::Plant] {
            let description = prepared.pair().of(side);
            let set = assigned(&run.name, side, description, &simulation.assignments)?;
            if !set.parameters.is_empty() {
                let text = ssv::write(&set).into_bytes();
                let path = content.resource(&format!("{stem}-{side}.ssv"), text);
                drawing.bindings[side as usize].push(path);
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
        Ok(drawing::write(&drawing))
    }
}

fn sides(file: &ParameterFile) -> Vec<Side> {
    match file.side {
        Some(side) => vec![side],
        None => vec![Side::Controller, Side::Plant],
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned())
}

/// The single values that are for one FMU, as a parameter set. They were checked with the run.
fn assigned(
    run: &str,
    side: Side,
    description: &Description,
    assignments: &[Assignment],
) -> Result<ParameterSet, Error> {
    let mut values: BTreeMap<String, ssv::Value> = BTreeMap::new();
    for assignment in assignments {
        let name = match (assignment.side, &assignment.name) {
            (Some(of), _) if of != side => continue,
            (_, name) => name,
        };
        let prefix = format!("{side}.");
        let bare = name
            .strip_prefix(&prefix)
            .filter(|_| assignment.side.is_none());
        let found = description
            .scalar(name)
            .map(|scalar| (name.as_str(), scalar));
        let found = found.or_else(|error| match bare {
            Some(bare) => description.scalar(bare).map(|scalar| (bare, scalar)),
            None => Err(error),
        });
        let Ok((name, scalar)) = found else { continue };
        let variable = description.variable(scalar);
        let value = Value::parse(&assignment.value, variable).map_err(|expected| {
            let message = format!("{name} = {:?}: expected {expected}", assignment.value);
            syntax(assignment.place.clone(), message)
        })?;
        let value = match value {
            Value::Float(number) => ssv::Value::Real(number),
            Value::Boolean(truth) => ssv::Value::Boolean(truth),
            Value::Text(text) => ssv::Value::String(text),
            Value::Integer(number) => {
                let item = variable
                    .items
                    .iter()
                    .find(|i| i128::from(i.value) == number);
                match item {
                    Some(item) => ssv::Value::Enumeration(item.name.clone()),
                    None => ssv::Value::Integer(number as i64),
                }
            }
        };
        values.insert(name.to_owned(), value);
    }
    let parameter = |(name, value)| Parameter {
        name,
        value,
        unit: None,
        line: 0,
    };
    Ok(ParameterSet {
        name: format!("{run}, {side}"),
        parameters: values.into_iter().map(parameter).collect(),
        ..ParameterSet::default()
    })
}

/// Writes beside the final place and then moves there. Makes missing folders.
fn write_whole(file: &Path, content: &Content) -> io::Result<()> {
    let bytes = content.to_bytes()?;
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let mut part = tempfile::Builder::new()
        .prefix(".flexarm-")
        .tempfile_in(folder)?;
    part.write_all(&bytes)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A temporary file is for its owner only; this one is for all who may read the folder.
        fs::set_permissions(part.path(), fs::Permissions::from_mode(0o644))?;
    }
    part.persist(file).map_err(|error| error.error)?;
    Ok(())
}
