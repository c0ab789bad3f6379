//! A run of a system structure: its FMUs set up, connected, stepped and recorded.

use super::document::{Kind, SystemStructure};
use super::inputs::Table;
use super::layout::Layout;
use super::order::{Link, Sequence, sequence};
use super::package::{Package, syntax};
use super::parameters::{FromUser, Values, constants};
use super::summary::SystemSummary;
use super::wiring::{Owner, Wiring};
use crate::Error;
use crate::fmu::{Experiment, Message, short};
use crate::input::parameters::{Assignment, ParameterFile};
use crate::input::read_text;
use crate::run::instances::{messages, start as start_instance};
use crate::run::master::{Clock, Master};
use crate::run::recording::Recording;
use crate::run::summary::{Stopped, Unit};
use crate::run::{Order, checks};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

/// Communication step where neither the user nor the package nor an FMU names one \[s\].
const STEP: f64 = 0.001;

/// What to run.
#[derive(Clone, Debug)]
pub struct SystemSimulation {
    /// The package.
    pub package: PathBuf,
    /// Name of the system structure in it; none: the default one.
    pub variant: Option<String>,
    /// Parameter files, in order: for an element of the system, or by names of the system.
    pub parameters: Vec<ParameterFile>,
    /// Single values, after the files.
    pub assignments: Vec<Assignment>,
    /// Values over time for inputs of the system. None: those that the package carries.
    pub inputs: Option<PathBuf>,
    /// End of the run \[s\]. None: the end of `inputs`, or else of the package's default experiment, or else
    /// the latest of the FMUs' default stop times, or else 1 s after the start.
    pub until: Option<f64>,
    /// Communication step \[s\]. None: that of the package, or else the shortest of the FMUs' default ones,
    /// or else 1 ms.
    pub step: Option<f64>,
    /// Whether components step one after the other, or all with what was known before.
    pub order: Order,
    /// Records every n-th communication point.
    pub record_every: usize,
    /// Asks the FMUs for debug messages.
    pub logging: bool,
}

impl SystemSimulation {
    /// A package with its default settings, everything recorded.
    pub fn new(package: impl Into<PathBuf>) -> Self {
        Self {
            package: package.into(),
            variant: None,
            parameters: Vec::new(),
            assignments: Vec::new(),
            inputs: None,
            until: None,
            step: None,
            order: Order::Sequential,
            record_every: 1,
            logging: false,
        }
    }
}

/// What a run yields.
#[derive(Debug)]
pub struct SystemOutcome {
    /// Circumstances.
    pub summary: SystemSummary,
    /// The samples: time, inputs of the system that have values, outputs of the components, and those outputs
    /// of the system that are not one of these as they are.
    pub recording: Recording,
    /// Columns that take part in a connection.
    pub connected: Vec<usize>,
    /// What the FMUs logged, by component.
    pub messages: Vec<(String, Message)>,
    /// Why it ended before its time, if it did.
    pub failure: Option<Error>,
}

/// Runs a system. `progress` is as for [`crate::simulate`].
pub fn simulate_system(
    simulation: &SystemSimulation,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<SystemOutcome, Error> {
    let package = Package::open(&simulation.package)?;
    let structure = package.structure(simulation.variant.as_deref())?;
    let mut wiring = Wiring::new(&package, &structure)?;
    let user = FromUser {
        files: &simulation.parameters,
        assignments: &simulation.assignments,
    };
    let mut values = Values::new(&package, &structure, &wiring, user)?;
    constants(&wiring, &mut values)?;
    wiring.configure(&values.parts)?;
    let start = structure.start.unwrap_or(0.0);
    let (table, inputs) = table(simulation, &package, &structure, &wiring, start)?;
    let step = step(simulation, &structure, &wiring);
    checks::points(step, simulation.record_every)?;
    let over_time = (&table, inputs.as_deref());
    let (until, origin) = until(simulation, &structure, &wiring, over_time, start);
    let steps = steps(start, until, step, &origin)?;
    let end = start + steps as f64 * step;

    let layout = Layout::new(&wiring, &values, &table);
    let order = order(&wiring, &layout.links, simulation.order)?;
    let mut warnings = wiring.warnings.clone();
    warnings.extend(values.warnings.iter().cloned());
    warnings.extend(checks::cut(&origin, until, end, step));
    if !order.doubtful.is_empty() && simulation.order == Order::Sequential {
        let paths = order
            .doubtful
            .iter()
            .map(|&part| wiring.parts[part].path.as_str());
        warnings.push(format!(
            "{} wait for each other, as far as they declare what their outputs depend on: in part they take values that \
             are a communication step old",
            paths.collect::<Vec<_>>().join(", ")
        ));
    }
    let last = table.rows.last().map_or(start, |row| row.time);
    if last >= end && table.rows.len() > 1 {
        warnings.push(format!(
            "inputs go on to {last} s, but the run ends at {end} s"
        ));
    }

    let experiment = Experiment {
        start,
        stop: Some(end),
        ..Experiment::default()
    };
    let mut instances = Vec::new();
    for &part in &order.order {
        let of = &wiring.parts[part];
        let values = values.parts[part].iter();
        let values: Vec<_> = values.map(|(at, value)| (*at, value.clone())).collect();
        let instance = start_instance(&of.fmu, &of.path, &values, &experiment, simulation.logging)?;
        instances.push(instance);
    }
    let members = layout.members(&wiring, &order.order);
    let rows = steps.div_ceil(simulation.record_every);
    checks::size(rows, layout.columns.len() + layout.derived.len())?;
    let recording = Recording::new(layout.columns.clone(), BTreeMap::new(), rows);
    let schedule = layout.schedule(&table, start, step);
    let clock = Clock {
        start,
        step,
        order: simulation.order,
        record_every: simulation.record_every,
    };
    let begin = Instant::now();
    let mut master = Master::new(members, recording, schedule, clock, &mut instances)?;
    let failure = match master.run(&mut instances, steps, &mut |_, _| Ok(()), progress) {
        Ok(()) => None,
        // Before the first step is over there is no result.
        Err(error) if master.steps_done() == 0 => return Err(error),
        Err(error) => Some(error),
    };
    let wall = begin.elapsed().as_secs_f64();
    if failure.is_none() {
        for instance in &mut instances {
            instance.terminate()?;
        }
    }
    let done = master.steps_done();
    let (recording, _) = master.finish();
    let component = |&part: &usize| {
        let part = &wiring.parts[part];
        (part.path.clone(), Unit::new(&part.fmu))
    };
    Ok(SystemOutcome {
        summary: SystemSummary {
            package: package.file().display().to_string(),
            name: structure.name.clone(),
            components: order.order.iter().map(component).collect(),
            inputs,
            order: simulation.order,
            start_s: start,
            step_s: step,
            steps: done as u64,
            until_s: start + done as f64 * step,
            stopped: failure.as_ref().map(|error| Stopped {
                reason: error.to_string(),
                planned_s: end,
            }),
            wall_s: wall,
            warnings,
        },
        connected: layout.connected(),
        recording: layout.derive(recording),
        messages: messages(instances.iter().map(|i| (i.name().to_owned(), i))),
        failure,
    })
}

/// Values over time and the file that they are from: the user's, or what the package carries.
fn table(
    simulation: &SystemSimulation,
    package: &Package,
    structure: &SystemStructure,
    wiring: &Wiring,
    start: f64,
) -> Result<(Table, Option<String>), Error> {
    let (text, file) = match (&simulation.inputs, &structure.inputs) {
        (Some(path), _) => (read_text(path)?, path.display().to_string()),
        (None, Some((path, line))) => {
            let place = wiring.place(*line);
            (package.text(path, &place)?, package.name(path))
        }
        (None, None) => return Ok((Table::default(), None)),
    };
    let roots = wiring
        .points
        .iter()
        .filter(|point| point.owner == Owner::Root);
    let inputs: Vec<_> = roots
        .filter(|point| point.kind == Kind::Input)
        .map(|point| point.path.as_str())
        .collect();
    let table = Table::read(&text, &file, start, &inputs)?;
    Ok((table, Some(file)))
}

fn step(simulation: &SystemSimulation, structure: &SystemStructure, wiring: &Wiring) -> f64 {
    let parts = wiring.parts.iter();
    let declared = parts.filter_map(|part| part.description().default_experiment.step_size);
    simulation
        .step
        .or(structure.step)
        .or(declared.filter(|step| *step > 0.0).reduce(f64::min))
        .unwrap_or(STEP)
}

/// The end of the run and who says so.
fn until(
    simulation: &SystemSimulation,
    structure: &SystemStructure,
    wiring: &Wiring,
    (table, inputs): (&Table, Option<&str>),
    start: f64,
) -> (f64, String) {
    if let Some(until) = simulation.until {
        return (until, "--until".to_owned());
    }
    // Those of the user count more than the stop time, those that the package carries less.
    let first = simulation.inputs.is_some() || structure.stop.is_none();
    if let (Some(file), Some(end), true) = (inputs, table.end(), first) {
        return (end, format!("{file}: end of the inputs"));
    }
    if let Some(stop) = structure.stop {
        return (stop, format!("{}: stopTime", structure.file));
    }
    let parts = wiring.parts.iter();
    let stops = parts.filter_map(|part| part.description().default_experiment.stop_time);
    match stops.reduce(f64::max) {
        Some(stop) => (stop, "default stop time of the FMUs".to_owned()),
        None => (start + 1.0, "end of the run".to_owned()),
    }
}

/// Number of communication steps; `origin` says who gives the end.
fn steps(start: f64, until: f64, step: f64, origin: &str) -> Result<usize, Error> {
    checks::whole_steps(until - start, step).ok_or_else(|| {
        let bounds = [checks::STEPS.start(), checks::STEPS.end()];
        let [low, high] = bounds.map(|steps| short(start + steps * step));
        let (start, step) = (short(start), short(step));
        let expected =
            format!("a time in [{low}, {high}] s with steps of {step} s from {start} s on");
        checks::setting(origin.to_owned(), until, expected).into()
    })
}

fn order(wiring: &Wiring, links: &[Link], order: Order) -> Result<Sequence, Error> {
    let undirected = || Sequence {
        order: (0..wiring.parts.len()).collect(),
        doubtful: Vec::new(),
    };
    let circle = match sequence(&wiring.parts, links) {
        Ok(found) => return Ok(found),
        Err(_) if order == Order::SideBySide => return Ok(undirected()),
        Err(circle) => circle,
    };
    let name = |part: usize, scalar| {
        let part = &wiring.parts[part];
        format!("{}.{}", part.path, part.description().name_of(scalar))
    };
    let text = |link: &Link| {
        format!(
            "{} feeds {}",
            name(link.from, link.output),
            name(link.to, link.input)
        )
    };
    let circle_text: Vec<_> = circle.iter().map(text).collect();
    let message = format!(
        "connection: algebraic loop, each of these depends directly on the one before: {}; --order side-by-side breaks it \
         with a delay of one communication step",
        circle_text.join(", ")
    );
    Err(syntax(
        wiring.place(circle.first().map_or(1, |link| link.line)),
        message,
    ))
}
