//! Reference results inside each FMU, by which an importer can see that it runs the FMU as it was meant:
//! inputs and outputs of one run, in the layout of FMI-LS-REF 1.0.0-alpha.1.

use crate::run::{self, Results};
use crate::workspace::Workspace;
use std::ffi::OsStr;
use std::fmt::Write;

/// Setpoints of the run, which is one move, its end \[s\] and its communication step \[s\]: that of the samples,
/// as longer ones make the loop unstable. Inputs hold for a step, so that a row for each makes a repetition exact.
const MOVES: usize = 1;
const UNTIL: &str = "0.25";
const STEP: &str = "0.00025";

/// Steps from one row of the outputs to the next.
const EVERY: usize = 20;

/// Folder in an FMU.
const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";

/// Columns of the run that are the inputs of a unit and its outputs, and the row of a step in which the
/// outputs at its end stand.
struct Unit {
    name: &'static str,
    prefix: &'static str,
    inputs: &'static [(&'static str, &'static str)],
    outputs: &'static [&'static str],
    /// The host records what the plant has at a row's time, and of the controller what it passed on.
    row_of_end: usize,
}

const UNITS: [Unit; 2] = [
    Unit {
        name: "FlexArmPlant",
        prefix: "plant",
        inputs: &[("controller.torque", "torque")],
        outputs: &["angle", "velocity", "current", "thermal_load"],
        row_of_end: 1,
    },
    Unit {
        name: "FlexArmController",
        prefix: "controller",
        inputs: &[("plant.angle", "angle"), ("setpoint", "setpoint")],
        outputs: &[
            "torque",
            "reference.angle",
            "reference.velocity",
            "thermal_load",
        ],
        row_of_end: 0,
    },
];

/// Files of an FMU with their paths in it.
pub type Files = Vec<(String, String)>;

/// Runs the packaged pair and makes the files of each unit, by its name.
pub fn of_a_run(workspace: &Workspace, host: &OsStr) -> Result<Vec<(&'static str, Files)>, String> {
    let arguments = [
        "--until",
        UNTIL,
        "--step",
        STEP,
        // Equal on all machines.
        "--set",
        "controller:nmpc.instruction_set=baseline",
    ];
    let results = run::pair(workspace, host, MOVES, &arguments)?;
    let files = UNITS
        .iter()
        .map(|unit| Ok((unit.name, unit.files(&results)?)));
    files.collect()
}

impl Unit {
    fn files(&self, results: &Results) -> Result<Files, String> {
        let time = results.column("time")?;
        let steps = time.len().checked_sub(1).ok_or("the run has no samples")?;
        let mut inputs = Vec::new();
        for (column, name) in self.inputs {
            inputs.push((*name, results.column(column)?));
        }
        let mut outputs = Vec::new();
        for name in self.outputs {
            let mut values = results.column(&format!("{}.{name}", self.prefix))?;
            values.drain(..self.row_of_end);
            outputs.push((*name, values));
        }
        let name = self.name;
        Ok(vec![
            (format!("{FOLDER}/fmi-ls-manifest.xml"), self.manifest()),
            (
                format!("{FOLDER}/{name}_in.csv"),
                csv(&time[..steps], &inputs, 0, 1),
            ),
            (
                format!("{FOLDER}/{name}_out.csv"),
                csv(&time[1..], &outputs, EVERY - 1, EVERY),
            ),
        ])
    }

    fn manifest(&self) -> String {
        let name = self.name;
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiReferences xmlns:fmi-ls=\"http://fmi-standard.org/fmi-ls-manifest\"\n    \
             fmi-ls:fmi-ls-name=\"org.fmi-standard.fmi-ls-ref\"\n    \
             fmi-ls:fmi-ls-version=\"1.0.0-alpha.1\"\n    \
             fmi-ls:fmi-ls-description=\"Layered Standard providing information on related files included in an FMU.\">\n  \
             <Related type=\"text/csv\" source=\"{name}_in.csv\" role=\"testcase\"\n      \
             description=\"Inputs from 0 s on, held from row to row: the rows are communication points {STEP} s apart\"/>\n  \
             <Related type=\"text/csv\" source=\"{name}_out.csv\" role=\"result\"\n      \
             description=\"Outputs of Co-Simulation after every {EVERY}th of these communication steps, all parameters at their start\"/>\n\
             </fmiReferences>\n"
        )
    }
}

/// The rows from `first` on, each `every`-th. Numbers read back exactly.
fn csv(time: &[f64], columns: &[(&str, Vec<f64>)], first: usize, every: usize) -> String {
    let mut text = "time".to_owned();
    for (name, _) in columns {
        let _ = write!(text, ",{name}"); // writing to a String does not fail
    }
    text.push('\n');
    for (row, time) in time.iter().enumerate().skip(first).step_by(every) {
        let _ = write!(text, "{time}");
        for (_, values) in columns {
            let _ = write!(text, ",{}", values[row]);
        }
        text.push('\n');
    }
    text
}
