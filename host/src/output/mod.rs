//! Writes a run to a folder: `results.csv`, `summary.json`, `report.html`, and `log.txt` if the FMUs logged.
//!
//! Files appear whole or not at all: they are written beside the folder and moved when all are complete.

mod decimate;
mod report;

use crate::Error;
use crate::run::Outcome;
use crate::run::recording::Recording;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that will hold a run.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    partial: TempDir,
}

impl OutputFolder {
    /// Checks that `path` can be written. An existing folder keeps its other files.
    pub fn prepare(path: &Path) -> Result<Self, Error> {
        let failed = |source| Error::Output {
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
        fs::create_dir_all(beside).map_err(failed)?;
        let partial = tempfile::Builder::new()
            .prefix(".flexarm-")
            .tempdir_in(beside)
            .map_err(failed)?;
        Ok(Self { path, partial })
    }

    /// Writes all files. On an error none of them appears.
    pub fn write(self, outcome: &Outcome) -> Result<(), Error> {
        self.write_files(outcome).map_err(|source| Error::Output {
            path: self.path.clone(),
            source,
        })
    }

    fn write_files(&self, outcome: &Outcome) -> io::Result<()> {
        let file = |name: &str| self.partial.path().join(name);
        write_csv(&outcome.recording, &file("results.csv"))?;
        let mut json = serde_json::to_string_pretty(&outcome.summary)?;
        json.push('\n');
        fs::write(file("summary.json"), json)?;
        fs::write(file("report.html"), report::html(outcome))?;
        let mut log = String::new();
        for (side, message) in &outcome.messages {
            let _ = writeln!(log, "{side}: {}: {message}", message.status);
        }
        if !log.is_empty() {
            fs::write(file("log.txt"), log)?;
        }
        self.publish()
    }

    fn publish(&self) -> io::Result<()> {
        fs::create_dir_all(&self.path)?;
        // The only file that not every run writes: one of an earlier run would pass for this one's.
        match fs::remove_file(self.path.join("log.txt")) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
            _ => {}
        }
        for entry in fs::read_dir(self.partial.path())? {
            let entry = entry?;
            fs::rename(entry.path(), self.path.join(entry.file_name()))?;
        }
        Ok(())
    }
}

/// All rows; numbers read back exactly.
fn write_csv(recording: &Recording, path: &Path) -> io::Result<()> {
    let mut header = csv::Writer::from_writer(Vec::new());
    header.write_record(recording.columns().iter().map(|c| c.name.as_str()))?;
    let mut file = BufWriter::with_capacity(1 << 20, fs::File::create(path)?);
    file.write_all(
        &header
            .into_inner()
            .map_err(|e| io::Error::other(e.to_string()))?,
    )?;
    let mut line = String::new();
    for row in recording.rows() {
        line.clear();
        for (i, value) in row.iter().enumerate() {
            if i > 0 {
                line.push(',');
            }
            // Formatting to a String cannot fail.
            let _ = if value.fract() == 0.0 && value.abs() < 1e15 {
                write!(line, "{}", *value as i64)
            } else {
                write!(line, "{value:?}")
            };
        }
        line.push('\n');
        file.write_all(line.as_bytes())?;
    }
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::recording::Column;
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

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_together() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a/b");
        let output = OutputFolder::prepare(&out).unwrap();
        assert!(!out.exists());
        output.write(&outcome(3)).unwrap();
        assert_eq!(names(&out), ["report.html", "results.csv", "summary.json"]);
        assert_eq!(names(&folder.path().join("a")), ["b"]);
        fs::write(out.join("notes.txt"), "").unwrap();
        OutputFolder::prepare(&out)
            .unwrap()
            .write(&outcome(3))
            .unwrap();
        let all = ["notes.txt", "report.html", "results.csv", "summary.json"];
        assert_eq!(names(&out), all);
        let csv = fs::read_to_string(out.join("results.csv")).unwrap();
        assert_eq!(
            csv,
            "time,setpoint,\"plant.a[1,2]\"\n0,1,0.30000000000000004\n0.00025,1,0.30000000000000004\n\
             0.0005,1,0.30000000000000004\n"
        );
    }

    #[test]
    fn a_run_that_fails_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(OutputFolder::prepare(&folder.path().join("out")).unwrap());
        assert!(names(folder.path()).is_empty());
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(OutputFolder::prepare(&folder.path().join("file")).is_err());
        assert!(OutputFolder::prepare(&folder.path().join("file/below")).is_err());
    }
}
