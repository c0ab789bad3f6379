//! `flexarm run`.

use clap::Args;
use host::experiment::execute::{Watch, execute};
use host::experiment::verdict::{self, Row};
use host::experiment::{Experiment, Run};
use host::output::experiments::{ExperimentsFolder, Finished};
use host::run::summary::number;
use host::table::aligned;
use host::{Error, Outcome};
use indicatif::ProgressBar;
use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

const EXAMPLES: &str = "\
Examples:
  One experiment, its table on the terminal:
    flexarm run experiments/disturbance.toml
  All of them, with samples, figures and one page:
    flexarm run experiments/*.toml -o out/

An experiment names two FMUs, what its runs have in common and how they differ, and may say which figures are expected:
    title = \"How far may the mass be off?\"
    [common]
    controller = \"../dist/fmi3/FlexArmController.fmu\"    # relative to this file
    plant = \"../dist/fmi3/FlexArmPlant.fmu\"
    sequence = { every = 1.0, setpoints = [1.3, 1.1, 1.4] }
    [[run]]
    name = \"as known\"
    [[run]]
    name = \"heavier by a tenth\"
    set = { \"plant:arm.inertia\" = 0.09 }
    [[expect]]
    name = \"what it costs\"
    quantity = \"squared_error_rad2\"
    of = [\"heavier by a tenth\"]
    over = [\"as known\"]
    at_most = 1.1
experiments/README.md describes every key.

The folder of -o gets index.html, figures/*.svg, and for each experiment a folder with experiment.json and a folder for each
run (results.csv, summary.json). A run that fails before its time leaves *-partial.* there; the others go on. Ctrl-C leaves
the samples of the runs that are over, and *-partial.* of those under way. experiments/identification.toml needs what `cargo xtask reproduce` identifies.";

/// Makes the runs of experiments that files describe and compares them with what is expected.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// Experiments (TOML).
    #[arg(required = true, value_name = "EXPERIMENT")]
    experiments: Vec<PathBuf>,
    /// Folder for results, figures and the page.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Title of the page.
    #[arg(long, value_name = "TEXT", default_value = "Experiments")]
    title: String,
    /// Runs at a time. Default: one for each processor.
    #[arg(short, long, value_name = "N")]
    jobs: Option<usize>,
}

/// Draws the progress, notices an interrupt, writes runs as they end.
struct Watcher<'a> {
    bar: ProgressBar,
    interrupted: &'a AtomicBool,
    folder: Option<&'a ExperimentsFolder>,
    failure: Mutex<Option<Error>>,
}

impl Watch for Watcher<'_> {
    fn progress(&self, done: f64) -> ControlFlow<()> {
        self.bar.set_position((done * 1000.0) as u64);
        let failed = self.failure.lock().is_ok_and(|failure| failure.is_some());
        if failed || self.interrupted.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn finished(&self, experiment: &Experiment, run: &Run, outcome: &Result<Outcome, Error>) {
        let name = format!("{}, {}", experiment.name, run.name);
        let messages = match outcome {
            Ok(outcome) => outcome
                .summary
                .warnings
                .iter()
                .map(|warning| format!("warning: {name}: {warning}"))
                .collect(),
            // Says itself where its run is described.
            Err(error @ Error::Input(_)) => vec![error.to_string()],
            Err(error) => vec![format!("{name}: {error}")],
        };
        self.bar.suspend(|| {
            for message in messages {
                let _ = writeln!(io::stderr(), "{message}");
            }
        });
        let written = self
            .folder
            .map_or(Ok(()), |f| f.write_run(experiment, run, outcome));
        if let (Err(error), Ok(mut failure)) = (written, self.failure.lock()) {
            *failure = Some(error);
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<u8, Error> {
    let experiments = read(&arguments.experiments)?;
    let folder = arguments.output.as_deref();
    let folder = folder.map(ExperimentsFolder::prepare).transpose()?;
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let interrupted = super::progress::watch_for_interrupts();
    let watcher = Watcher {
        bar: super::progress::bar(),
        interrupted: &interrupted,
        folder: folder.as_ref(),
        failure: Mutex::new(None),
    };
    let outcomes = execute(&experiments, arguments.jobs.unwrap_or(available), &watcher);
    watcher.bar.finish_and_clear();
    if let Ok(Some(failure)) = watcher.failure.into_inner() {
        return Err(failure);
    }
    let outcomes = outcomes?;
    let rows: Vec<_> = experiments
        .iter()
        .zip(&outcomes)
        .map(|(experiment, outcomes)| verdict::rows(experiment, outcomes))
        .collect();
    for ((experiment, outcomes), rows) in experiments.iter().zip(&outcomes).zip(&rows) {
        super::print(&text(experiment, outcomes, rows))?;
    }
    if let Some(folder) = &folder {
        let all = experiments.iter().zip(&outcomes).zip(&rows);
        let all: Vec<_> = all
            .map(|((experiment, outcomes), rows)| Finished {
                experiment,
                outcomes,
                rows,
            })
            .collect();
        let page = folder.write(&arguments.title, &all)?;
        let _ = writeln!(io::stderr(), "page: {}", page.display());
    }
    let mut failures = outcomes.iter().flatten().filter_map(|o| o.as_ref().err());
    Ok(if let Some(first) = failures.next() {
        let input = first.is_input() && failures.all(Error::is_input);
        if input { 2 } else { 1 }
    } else if rows.iter().flatten().any(|row| row.met == Some(false)) {
        3
    } else {
        0
    })
}

/// Reads all files; their names make folders, so they must differ.
fn read(files: &[PathBuf]) -> Result<Vec<Experiment>, Error> {
    let mut experiments: Vec<Experiment> = Vec::new();
    for file in files {
        let experiment = Experiment::read(file)?;
        if let Some(other) = experiments.iter().find(|e| e.name == experiment.name) {
            return Err(Error::Input(host::input::Error::Setting {
                name: "EXPERIMENT".to_owned(),
                value: file.display().to_string(),
                expected: format!("a name that differs from that of {}", other.file.display()),
            }));
        }
        experiments.push(experiment);
    }
    Ok(experiments)
}

/// Title and table of an experiment; without expectations the squared error of its runs.
fn text(experiment: &Experiment, outcomes: &[Result<Outcome, Error>], rows: &[Row]) -> String {
    let mut text = format!("{}\n", experiment.title);
    for rows in rows.chunk_by(|a, b| a.table == b.table) {
        let heading = rows.first().map_or(String::new(), |row| row.table.clone());
        let columns = verdict::columns(rows);
        let judged = rows.iter().any(|row| row.met.is_some());
        let titles = columns.iter().map(|(title, _)| *title);
        let header = [heading.as_str(), "quantity"].into_iter().chain(titles);
        let header = header.chain(judged.then_some("expected"));
        let mut table = aligned(header, 2..2 + columns.len());
        for (i, row) in rows.iter().enumerate() {
            let value = |value: Option<f64>| value.map_or("-".to_owned(), number);
            let mark = match row.met {
                Some(true) => "met: ",
                Some(false) => "MISSED: ",
                None => "",
            };
            let figures = columns.iter().map(|(_, figures)| value(figures[i]));
            let cells = [row.name.clone(), row.quantity_with_unit()].into_iter();
            let expected = judged.then(|| format!("{mark}{}", row.admissible));
            table.add_row(cells.chain(figures).chain(expected));
        }
        text.push_str(&format!("{}\n", table.trim_fmt()));
    }
    if rows.is_empty() {
        let mut table = aligned(["run", "squared error [rad2]", "violations"], [1, 2]);
        for (run, outcome) in experiment.runs.iter().zip(outcomes) {
            let score = outcome.as_ref().ok().map(|outcome| &outcome.summary.score);
            let error = score.and_then(|score| score.squared_error_rad2);
            let violations = score.and_then(|score| score.violations);
            table.add_row([
                run.name.clone(),
                error.map_or("-".to_owned(), number),
                violations.map_or("-".to_owned(), |n| n.to_string()),
            ]);
        }
        text.push_str(&format!("{}\n", table.trim_fmt()));
    }
    text.push('\n');
    text
}
