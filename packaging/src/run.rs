//! A run of the packaged pair by the host, for what the packages say of themselves.

use crate::archive::write_whole;
use crate::demo::SETPOINTS;
use crate::workspace::Workspace;
use std::ffi::OsStr;
use std::path::PathBuf;

/// What was recorded.
pub struct Results {
    file: PathBuf,
    header: csv::StringRecord,
    rows: Vec<Vec<f64>>,
}

/// Runs the packaged FMUs of FMI 3.0 over the first `moves` setpoints of the demo, with further `arguments`.
pub fn pair(
    workspace: &Workspace,
    host: &OsStr,
    moves: usize,
    arguments: &[&str],
) -> Result<Results, String> {
    let folder = tempfile::tempdir().map_err(|e| format!("temporary folder: {e}"))?;
    let out = folder.path().join("run");
    let setpoints = folder.path().join("setpoints.csv");
    let text = workspace.read(SETPOINTS)?;
    let rows: Vec<_> = text.lines().take(1 + moves).collect();
    write_whole(&setpoints, rows.join("\n").as_bytes())?;
    let mut command = workspace.command(host);
    command.args([
        "simulate",
        "--controller",
        "dist/fmi3/FlexArmController.fmu",
        "--plant",
        "dist/fmi3/FlexArmPlant.fmu",
    ]);
    command.args(arguments);
    command.arg("--setpoints").arg(&setpoints);
    command.arg("-o").arg(&out);
    // Where its report was does not matter to anyone; why it failed does.
    let run = command.output().map_err(|e| format!("flexarm: {e}"))?;
    if !run.status.success() {
        let reason = String::from_utf8_lossy(&run.stderr);
        return Err(format!("running the packaged units: {}", reason.trim_end()));
    }
    let file = out.join("results.csv");
    let error = |e| format!("{}: {e}", file.display());
    let mut table = csv::Reader::from_path(&file).map_err(error)?;
    let header = table.headers().map_err(error)?.clone();
    let rows = table.deserialize().collect::<Result<_, _>>();
    Ok(Results {
        rows: rows.map_err(error)?,
        header,
        file,
    })
}

impl Results {
    /// The values of a column.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, String> {
        let index = self.header.iter().position(|h| h == name);
        let index = index.ok_or_else(|| format!("{}: no column {name}", self.file.display()))?;
        let rows = self.rows.iter();
        Ok(rows.filter_map(|row| row.get(index).copied()).collect())
    }
}
