//! Makes the runs of experiments, several at a time.

use super::{Experiment, Figure, Quantity, Run, Signal};
use crate::fmu::{Fmu, similar};
use crate::input::{self, Place};
use crate::run::recording::Column;
use crate::{Error, Outcome, Prepared, Simulation};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// Who watches the runs, from several threads.
pub trait Watch: Sync {
    /// Told which share of all runs is done, from 0 to 1; may stop them. Must be quick.
    fn progress(&self, done: f64) -> ControlFlow<()>;

    /// A run of an experiment is over.
    fn finished(&self, experiment: &Experiment, run: &Run, outcome: &Result<Outcome, Error>);
}

/// What the runs of one experiment come to, in their order.
pub type Outcomes = Vec<Result<Outcome, Error>>;

/// Makes all runs, `jobs` at a time, and returns what each comes to. One that fails leaves the others alone.
///
/// # Errors
/// All that is wrong with what the user gave, before the first run begins; or that the user stopped.
pub fn execute(
    experiments: &[Experiment],
    jobs: usize,
    watch: &dyn Watch,
) -> Result<Vec<Outcomes>, Error> {
    let fmus = Fmus::open(experiments)?;
    let jobs = if fmus.any_is_single() { 1 } else { jobs };
    let mut prepared = Vec::new();
    let mut mistakes = Vec::new();
    for experiment in experiments {
        let first = prepared.len();
        for named in &experiment.runs {
            let (controller, plant) = fmus.of(named)?;
            match Prepared::new(&named.simulation, controller, plant) {
                Ok(run) => prepared.push(run),
                Err(Error::Input(mistake)) => mistakes.push(named.blame(mistake)),
                Err(error) => return Err(error),
            }
        }
        if mistakes.is_empty() {
            mistakes.extend(unknown_columns(experiment, &prepared[first..])?);
        }
    }
    if let Some(mistakes) = input::Error::several(mistakes) {
        return Err(Error::Input(mistakes));
    }
    let runs = experiments
        .iter()
        .flat_map(|experiment| experiment.runs.iter().map(move |run| (experiment, run)));
    let all: Vec<_> = runs
        .zip(prepared)
        .map(|((experiment, run), prepared)| Job {
            experiment,
            run,
            duration: prepared.duration(),
            prepared: Mutex::new(Some(prepared)),
            done: Mutex::new(0.0),
            outcome: Mutex::new(None),
        })
        .collect();
    let outcomes = make(&all, jobs, watch)?;
    let mut outcomes = outcomes.into_iter();
    let of = |experiment: &Experiment| outcomes.by_ref().take(experiment.runs.len()).collect();
    Ok(experiments.iter().map(of).collect())
}

/// The FMUs of all runs, each unpacked and loaded once.
struct Fmus(BTreeMap<PathBuf, Fmu>);

impl Fmus {
    fn open(experiments: &[Experiment]) -> Result<Self, Error> {
        let mut fmus = BTreeMap::new();
        let mut mistakes = Vec::new();
        let mut tried = BTreeSet::new();
        for run in experiments.iter().flat_map(|e| &e.runs) {
            let Simulation {
                controller, plant, ..
            } = &run.simulation;
            for (key, path) in [("controller", controller), ("plant", plant)] {
                if !tried.insert(path) {
                    continue;
                }
                match Fmu::open(path).map_err(|error| run.blame_fmu(key, error)) {
                    Ok(fmu) => drop(fmus.insert(path.clone(), fmu)),
                    Err(Error::Input(mistake)) => mistakes.push(mistake),
                    Err(error) => return Err(error),
                }
            }
        }
        match input::Error::several(mistakes) {
            Some(mistakes) => Err(Error::Input(mistakes)),
            None => Ok(Self(fmus)),
        }
    }

    /// Whether one of them allows one instance in a process only.
    fn any_is_single(&self) -> bool {
        self.0.values().any(|fmu| {
            let description = fmu.description();
            let co_simulation = description.co_simulation.as_ref();
            co_simulation.is_some_and(|c| c.can_be_instantiated_only_once_per_process)
        })
    }

    fn of(&self, run: &Run) -> Result<(&Fmu, &Fmu), Error> {
        let fmu = |path: &Path| match self.0.get(path) {
            Some(fmu) => Ok(fmu),
            // Not reached: `open` saw the same runs.
            None => Err(Error::Input(input::Error::Read {
                file: path.to_owned(),
                source: std::io::ErrorKind::NotFound.into(),
            })),
        };
        let simulation = &run.simulation;
        Ok((fmu(&simulation.controller)?, fmu(&simulation.plant)?))
    }
}

/// Signals of expectations and figures that the runs do not record.
fn unknown_columns(
    experiment: &Experiment,
    prepared: &[Prepared<'_>],
) -> Result<Vec<input::Error>, Error> {
    let columns: Vec<Vec<Column>> = prepared
        .iter()
        .map(Prepared::columns)
        .collect::<Result<_, _>>()?;
    let mut unknown_statuses = Vec::new();
    let mut mistakes = Vec::new();
    let mut check = |run: usize, signal: &Signal, place: &Place| {
        for name in signal.columns() {
            let known = || columns[run].iter().map(|column| column.name.as_str());
            if !known().any(|known| known == name) {
                mistakes.push(input::Error::Unrecorded {
                    place: place.clone(),
                    name: name.to_owned(),
                    similar: similar(name, known()),
                    existing: known().map(str::to_owned).collect(),
                });
            }
        }
    };
    for expectation in &experiment.expectations {
        for &run in expectation.of.iter().chain(&expectation.over) {
            if let Quantity::Plans(status) = &expectation.quantity {
                unknown_statuses.extend(unknown_status(prepared, run, status, &expectation.place));
            }
            if let Some(signal) = expectation.quantity.signal() {
                check(run, signal, &expectation.place);
            }
        }
    }
    for Figure { panels, .. } in &experiment.figures {
        for curve in panels.iter().flat_map(|panel| &panel.curves) {
            let [x, y] = &curve.places;
            check(curve.run, &curve.x, x);
            check(curve.run, &curve.y, y);
        }
    }
    mistakes.extend(unknown_statuses);
    Ok(mistakes)
}

/// A mistake if the planner of a run knows no such status; one without statuses has none to name.
fn unknown_status(
    prepared: &[Prepared<'_>],
    run: usize,
    status: &str,
    place: &Place,
) -> Option<input::Error> {
    let names = prepared.get(run)?.statuses();
    (!names.iter().any(|name| name == status)).then(|| input::Error::Syntax {
        place: place.clone(),
        message: format!(
            "plans have no status {status:?}; there are: {}",
            names.join(", ")
        ),
    })
}

/// A run that is ready, and what it is part of.
struct Job<'a> {
    experiment: &'a Experiment,
    run: &'a Run,
    prepared: Mutex<Option<Prepared<'a>>>,
    duration: f64,
    /// How much of it is done \[s\].
    done: Mutex<f64>,
    outcome: Mutex<Option<Result<Outcome, Error>>>,
}

/// Makes all runs: `jobs` at a time, then one by one those that want to be alone.
fn make(all: &[Job<'_>], jobs: usize, watch: &dyn Watch) -> Result<Outcomes, Error> {
    let total: f64 = all.iter().map(|job| job.duration).sum();
    let stopped = AtomicBool::new(false);
    let progress = || {
        let done = all
            .iter()
            .filter_map(|job| job.done.lock().ok().map(|d| *d));
        watch.progress(done.sum::<f64>() / total)
    };
    let make_one = |job: &Job<'_>| {
        let Some(prepared) = take(&job.prepared) else {
            return;
        };
        let mut reported = 0.0;
        let outcome = prepared.run(&mut |fraction| {
            // Locks for every hundredth of a run only.
            if fraction < 1.0 && fraction - reported < 0.01 {
                return ControlFlow::Continue(());
            }
            reported = fraction;
            if let Ok(mut done) = job.done.lock() {
                *done = fraction * job.duration;
            }
            progress()
        });
        let outcome = outcome.map_err(|error| job.run.blame_start(error));
        if outcome.as_ref().is_err_and(Error::is_interrupt) {
            stopped.store(true, Ordering::Relaxed);
        }
        watch.finished(job.experiment, job.run, &outcome);
        if let Ok(mut slot) = job.outcome.lock() {
            *slot = Some(outcome);
        }
    };
    for (alone, threads) in [(false, jobs), (true, 1)] {
        let queue: Vec<_> = all
            .iter()
            .filter(|job| job.experiment.alone == alone)
            .collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(job) = queue.get(next.fetch_add(1, Ordering::Relaxed))
                && !stopped.load(Ordering::Relaxed)
            {
                make_one(job);
            }
        };
        thread::scope(|scope| {
            for _ in 0..threads.clamp(1, queue.len().max(1)) {
                scope.spawn(work);
            }
        });
    }
    let outcomes = all.iter().map(|job| match take(&job.outcome) {
        Some(Err(error)) if error.is_interrupt() => Err(error),
        Some(outcome) => Ok(outcome),
        // A run that the end of another kept from beginning.
        None => Err(Error::Interrupted { time: 0.0 }),
    });
    outcomes.collect()
}

fn take<T>(slot: &Mutex<Option<T>>) -> Option<T> {
    slot.lock().ok()?.take()
}
