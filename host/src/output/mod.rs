//! Writes a result to a folder: a run as `results.csv`, `summary.json`, `report.html`, and `log.txt` if the FMUs
//! logged; that of a system structure with `plot.svg` besides; an identification as `identified.ssv`, `identification.json`, `report.html` and, if asked for, its
//! measurements.
//!
//! Files appear whole or not at all: they are written beside the folder and moved when all are complete. A run
//! that fails leaves no folders either; one that ends before its time leaves its samples until then in
//! `results-partial.csv`, `summary-partial.json` and `report-partial.html`.

mod chart;
mod decimate;
pub mod experiments;
mod figures;
mod html;
mod identification;
mod page;
mod report;
mod samples;
mod svg;
mod system;

pub(crate) use chart::PANELS;

use crate::Error;
use crate::fmu::Message;
use crate::run::Outcome;
use crate::run::recording::Recording;
use samples::write_csv;
use serde::Serialize;
use std::fmt::{Display, Write as _};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that will hold a run.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    partial: TempDir,
    // Last: what is made for the partial files can go only after them.
    made: Made,
}

/// Folders that were made on the way and go again if they are still empty in the end.
#[derive(Debug, Default)]
struct Made(Vec<PathBuf>);

impl Made {
    /// Makes `folder` with all its parents.
    fn folder(&mut self, folder: &Path) -> io::Result<()> {
        let missing: Vec<_> = folder.ancestors().take_while(|f| !f.exists()).collect();
        self.0
            .extend(missing.into_iter().rev().map(Path::to_path_buf));
        fs::create_dir_all(folder)
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // Fails for folders that hold something by now: those stay.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// What a run writes: samples, score, report.
const WHOLE: [&str; 3] = ["results.csv", "summary.json", "report.html"];
/// The same of a run that ended before its time.
const PARTIAL: [&str; 3] = [
    "results-partial.csv",
    "summary-partial.json",
    "report-partial.html",
];
/// The signals of a system structure.
const PLOT: &str = "plot.svg";
/// What the FMUs logged, if they did.
const LOG: &str = "log.txt";
/// What an identification writes beside its report.
const PARAMETERS: &str = "identified.ssv";
const IDENTIFICATION: &str = "identification.json";
const MEASUREMENTS: [&str; 3] = ["excitation.csv", "validation.csv", "feedback-alone.csv"];
const PARTIAL_MEASUREMENTS: [&str; 5] = [
    "approach-partial.csv",
    "reach-partial.csv",
    "excitation-partial.csv",
    "feedback-alone-partial.csv",
    "validation-partial.csv",
];
/// What not every run or identification writes: a file of an earlier one would pass for this one's.
const OF_A_RUN: [&str; 5] = [LOG, PLOT, PARTIAL[0], PARTIAL[1], PARTIAL[2]];
const OF_AN_IDENTIFICATION: [&str; 10] = [
    PARAMETERS,
    WHOLE[2],
    MEASUREMENTS[0],
    MEASUREMENTS[1],
    MEASUREMENTS[2],
    PARTIAL_MEASUREMENTS[0],
    PARTIAL_MEASUREMENTS[1],
    PARTIAL_MEASUREMENTS[2],
    PARTIAL_MEASUREMENTS[3],
    PARTIAL_MEASUREMENTS[4],
];

impl OutputFolder {
    /// Checks that `path` can be written. An existing folder keeps its other files.
    pub fn prepare(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::OutputFolder {
            path: path.to_owned(),
            source,
        };
        if path.exists() && !path.is_dir() {
            return Err(failed(io::ErrorKind::NotADirectory.into()));
        }
        let path = std::path::absolute(path).map_err(failed)?;
        // On the same file system as the folder, so that files can be moved.
        let beside = if path.is_dir() {
            &path
        } else {
            path.parent().unwrap_or(&path)
        };
        check_targets(&path).map_err(failed)?;
        let mut made = Made::default();
        made.folder(beside).map_err(failed)?;
        let partial = tempfile::Builder::new()
            .prefix(".flexarm-")
            .tempdir_in(beside)
            .map_err(failed)?;
        Ok(Self {
            path,
            partial,
            made,
        })
    }

    /// Writes all files and returns the path of the report. On an error none of them appears.
    pub fn write(mut self, outcome: &Outcome) -> Result<PathBuf, Error> {
        self.write_files(outcome, true)?;
        let [_, _, report] = names(outcome.summary.stopped.is_some());
        Ok(self.path.join(report))
    }

    /// Removes the files of a run from `folder`; others stay.
    fn remove_run(folder: &Path) -> Result<(), Error> {
        for name in WHOLE.into_iter().chain(PARTIAL).chain([LOG, PLOT]) {
            let path = folder.join(name);
            match fs::remove_file(&path) {
                Err(source) if source.kind() != io::ErrorKind::NotFound => {
                    return Err(Error::Output { path, source });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes all files but the report, which is large. On an error none of them appears.
    pub fn write_samples(mut self, outcome: &Outcome) -> Result<(), Error> {
        self.write_files(outcome, false)
    }

    fn write_files(&mut self, outcome: &Outcome, reported: bool) -> Result<(), Error> {
        self.try_write(outcome, reported)
            .map_err(|source| Error::Output {
                path: self.path.clone(),
                source,
            })
    }

    fn try_write(&mut self, outcome: &Outcome, reported: bool) -> io::Result<()> {
        let page = reported.then(|| report::html(outcome));
        self.run_files(
            &outcome.recording,
            &outcome.summary,
            outcome.summary.stopped.is_some(),
            page.as_deref(),
        )?;
        self.write_log(&outcome.messages)?;
        self.publish(&OF_A_RUN)
    }

    /// The samples, the summary and, if there is one, the report of a run.
    fn run_files(
        &self,
        recording: &Recording,
        summary: &impl Serialize,
        partial: bool,
        report: Option<&str>,
    ) -> io::Result<()> {
        let file = |name: &str| self.partial.path().join(name);
        let [results, numbers, page] = names(partial);
        write_csv(recording, &file(results))?;
        fs::write(file(numbers), json_text(summary)?)?;
        report.map_or(Ok(()), |report| fs::write(file(page), report))
    }

    fn write_log(&self, messages: &[(impl Display, Message)]) -> io::Result<()> {
        let mut log = String::new();
        for (of, message) in messages {
            let _ = writeln!(log, "{of}: {}: {message}", message.status);
        }
        if log.is_empty() {
            return Ok(());
        }
        fs::write(self.partial.path().join(LOG), log)
    }

    /// Moves all files to their places; those of `stale` that are not written now go.
    fn publish(&mut self, stale: &[&str]) -> io::Result<()> {
        check_targets(&self.path)?;
        self.made.folder(&self.path)?;
        for name in stale {
            match fs::remove_file(self.path.join(name)) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
                _ => {}
            }
        }
        for entry in fs::read_dir(self.partial.path())? {
            let entry = entry?;
            fs::rename(entry.path(), self.path.join(entry.file_name()))?;
        }
        Ok(())
    }
}

/// The files that hold a run.
fn names(partial: bool) -> [&'static str; 3] {
    if partial { PARTIAL } else { WHOLE }
}

/// Whether files can take their places in `folder`: found out before the first one does.
fn check_targets(folder: &Path) -> io::Result<()> {
    let names = WHOLE.into_iter().chain(PARTIAL).chain([LOG, PLOT]);
    for name in names.chain(OF_AN_IDENTIFICATION).chain([IDENTIFICATION]) {
        if folder.join(name).is_dir() {
            let why = format!("{name} is a folder there");
            return Err(io::Error::new(io::ErrorKind::IsADirectory, why));
        }
    }
    Ok(())
}

/// JSON that ends with a new line.
fn json_text(value: &impl Serialize) -> io::Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::recording::Column;
    use crate::run::summary::Stopped;
    use crate::run::summary::tests::summary;

    pub(super) fn outcome(rows: usize) -> Outcome {
        let columns = ["time", "setpoint", "plant.a[1,2]"]
            .map(|n| Column::new(n, None))
            .to_vec();
        let mut recording = Recording::new(columns, Default::default(), rows);
        for k in 0..rows {
            recording.push(&[k as f64 * 0.000_25, 1.0, 0.1 + 0.2]);
        }
        Outcome {
            summary: summary(),
            recording,
            angle_limits: None,
            thermal_limit: None,
            messages: Vec::new(),
        }
    }

    fn listing(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn every_experiment_has_its_file() {
        for kind in crate::identify::Kind::ALL {
            let file = PARTIAL_MEASUREMENTS[kind as usize];
            assert_eq!(file, format!("{}-partial.csv", kind.name()));
        }
    }

    #[test]
    fn files_appear_together() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a/b");
        let output = OutputFolder::prepare(&out).unwrap();
        assert!(!out.exists());
        output.write(&outcome(3)).unwrap();
        assert_eq!(
            listing(&out),
            ["report.html", "results.csv", "summary.json"]
        );
        assert_eq!(listing(&folder.path().join("a")), ["b"]);
        fs::write(out.join("notes.txt"), "").unwrap();
        OutputFolder::prepare(&out)
            .unwrap()
            .write(&outcome(3))
            .unwrap();
        let all = ["notes.txt", "report.html", "results.csv", "summary.json"];
        assert_eq!(listing(&out), all);
        let csv = fs::read_to_string(out.join("results.csv")).unwrap();
        assert_eq!(
            csv,
            "time,setpoint,\"plant.a[1,2]\"\n0,1,0.30000000000000004\n0.00025,1,0.30000000000000004\n\
             0.0005,1,0.30000000000000004\n"
        );
    }

    #[test]
    fn partial_results_are_marked_and_spare_those_of_an_earlier_run() {
        let folder = tempfile::tempdir().unwrap();
        let write = |outcome: &Outcome| {
            let output = OutputFolder::prepare(folder.path()).unwrap();
            output.write(outcome).unwrap()
        };
        write(&outcome(3));
        let mut partial = outcome(2);
        partial.summary.stopped = Some(Stopped {
            reason: "the plant <failed>".into(),
            planned_s: 3.0,
        });
        let report = write(&partial);
        assert!(report.ends_with("report-partial.html"));
        let report = fs::read_to_string(report).unwrap();
        assert!(report.contains("Partial: the plant &lt;failed&gt;"));
        assert_eq!(listing(folder.path()).len(), 6);
        // The next whole run leaves no doubt.
        write(&outcome(3));
        assert_eq!(
            listing(folder.path()),
            ["report.html", "results.csv", "summary.json"]
        );
    }

    #[test]
    fn a_run_that_fails_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(OutputFolder::prepare(&folder.path().join("out")).unwrap());
        assert!(listing(folder.path()).is_empty());
        drop(OutputFolder::prepare(&folder.path().join("deep/deeper/out")).unwrap());
        assert!(listing(folder.path()).is_empty());
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(OutputFolder::prepare(&folder.path().join("file")).is_err());
        assert!(OutputFolder::prepare(&folder.path().join("file/below")).is_err());
        assert_eq!(listing(folder.path()), ["file"]);
    }

    #[test]
    fn a_target_that_cannot_be_replaced_keeps_all_others() {
        let folder = tempfile::tempdir().unwrap();
        let output = OutputFolder::prepare(folder.path()).unwrap();
        fs::write(folder.path().join(WHOLE[0]), "old").unwrap();
        fs::create_dir(folder.path().join(WHOLE[1])).unwrap();
        let message = output.write(&outcome(3)).unwrap_err().to_string();
        assert!(
            message.ends_with("summary.json is a folder there"),
            "{message}"
        );
        assert_eq!(listing(folder.path()), WHOLE[..2]);
        assert_eq!(
            fs::read_to_string(folder.path().join(WHOLE[0])).unwrap(),
            "old"
        );
        assert!(OutputFolder::prepare(folder.path()).is_err());
    }
}
