//! Writes experiments to a folder:
//!
//! ```text
//! index.html                         tables and figures of all experiments, offline
//! figures/EXPERIMENT/FIGURE.svg      every figure
//! EXPERIMENT/experiment.json         table and runs, for scripts
//! EXPERIMENT/RUN/results.csv, summary.json, and log.txt if an FMU logs
//! ```
//!
//! A run is written as soon as it is done; the rest when all are. Files appear whole or not at all.

use super::figures::chart;
use super::{Made, OutputFolder, json_text, page};
use crate::experiment::verdict::Row;
use crate::experiment::{Experiment, Run};
use crate::run::summary::Summary;
use crate::whole::write_whole;
use crate::{Error, Outcome};
use serde::Serialize;
use std::io;
use std::path::{Path, PathBuf};

/// A folder that will hold experiments.
#[derive(Debug)]
pub struct ExperimentsFolder {
    path: PathBuf,
    /// Goes with the folder if nothing was written.
    _made: Made,
}

/// An experiment whose runs are over.
#[derive(Clone, Copy, Debug)]
pub struct Finished<'a> {
    /// What was to run.
    pub experiment: &'a Experiment,
    /// What its runs came to, in their order.
    pub outcomes: &'a [Result<Outcome, Error>],
    /// The rows of its table.
    pub rows: &'a [Row],
}

/// `experiment.json`.
#[derive(Serialize)]
struct Json<'a> {
    name: &'a str,
    title: &'a str,
    source: &'a str,
    runs: Vec<RunJson<'a>>,
    table: &'a [Row],
}

#[derive(Serialize)]
struct RunJson<'a> {
    name: &'a str,
    folder: &'a str,
    summary: Option<&'a Summary>,
    error: Option<String>,
}

impl ExperimentsFolder {
    /// Makes the folder, which goes again if nothing comes to be written.
    pub fn prepare(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::OutputFolder {
            path: path.to_owned(),
            source,
        };
        let path = std::path::absolute(path).map_err(failed)?;
        let mut made = Made::default();
        made.folder(&path).map_err(failed)?;
        Ok(Self { path, _made: made })
    }

    /// Writes the samples of a run, partial ones too.
    pub fn write_run(
        &self,
        experiment: &Experiment,
        run: &Run,
        outcome: &Result<Outcome, Error>,
    ) -> Result<(), Error> {
        let folder = self.path.join(&experiment.name).join(&run.folder);
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(Error::Stopped { partial, .. }) => partial,
            // Samples of an earlier run would pass for this one's.
            Err(_) => return OutputFolder::remove_run(&folder),
        };
        OutputFolder::prepare(&folder)?.write_samples(outcome)
    }

    /// Writes tables, figures and the page, and returns the path of the page.
    pub fn write(&self, title: &str, experiments: &[Finished<'_>]) -> Result<PathBuf, Error> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| Error::Output { path, source }
        };
        let charts: Vec<Vec<_>> = experiments
            .iter()
            .map(|finished| {
                let figures = finished.experiment.figures.iter();
                figures.map(|f| chart(f, finished.outcomes)).collect()
            })
            .collect();
        for (finished, charts) in experiments.iter().zip(&charts) {
            let experiment = finished.experiment;
            let file = self.path.join(&experiment.name).join("experiment.json");
            let json = json_text(&json(finished)).map_err(failed(&file))?;
            write_whole(&file, json.as_bytes()).map_err(failed(&file))?;
            for (figure, chart) in experiment.figures.iter().zip(charts) {
                let file = self.path.join(svg_path(experiment, &figure.name));
                let svg = chart
                    .svg()
                    .map_err(|error| failed(&file)(io::Error::other(error)))?;
                write_whole(&file, svg.as_bytes()).map_err(failed(&file))?;
            }
        }
        let file = self.path.join("index.html");
        let page = page::html(title, experiments, &charts);
        write_whole(&file, page.as_bytes()).map_err(failed(&file))?;
        Ok(file)
    }
}

/// Where a figure is, from the page.
pub(super) fn svg_path(experiment: &Experiment, figure: &str) -> String {
    format!("figures/{}/{figure}.svg", experiment.name)
}

fn json<'a>(finished: &Finished<'a>) -> Json<'a> {
    let Finished {
        experiment,
        outcomes,
        rows,
    } = *finished;
    let runs = experiment.runs.iter().zip(outcomes);
    Json {
        name: &experiment.name,
        title: &experiment.title,
        source: &experiment.source,
        runs: runs
            .map(|(run, outcome)| RunJson {
                name: &run.name,
                folder: &run.folder,
                summary: outcome.as_ref().ok().map(|outcome| &outcome.summary),
                error: outcome.as_ref().err().map(ToString::to_string),
            })
            .collect(),
        table: rows,
    }
}
