//! `cargo xtask reproduce`: the paper's experiments from the packaged FMUs.

use crate::archive::write_whole;
use crate::package::Platforms;
use crate::workspace::{Workspace, announce};
use crate::{cargo, package, shooting};
use std::path::Path;

/// The experiments in the order of the paper.
pub const EXPERIMENTS: [&str; 10] = [
    "moving-mass",
    "identification",
    "angle-torque",
    "feedback-response",
    "tracking-tflex",
    "tracking-pendulum",
    "disturbance",
    "solve-time",
    "safe-sets",
    "linear-model",
];
const TITLE: &str = "MPC design for a precision, flexure based, pendulum: every experiment, rerun";
/// Where tables and figures go.
const PAPER: &str = "dist/paper";
/// Figure 1, to which an experiment's page links.
const SHOOTING: &str = "figures/multiple-shooting.svg";
/// What `flexarm run` exits with if all runs are done, but not all figures as expected.
const MISSED: i32 = 3;

/// Packages, makes all runs and says where the page is.
pub fn run(workspace: &Workspace) -> Result<(), String> {
    package::run(workspace, Platforms::This)?;
    let host = cargo::host(workspace)?;
    let figure = workspace.path(PAPER).join(SHOOTING);
    write_whole(&figure, shooting::figure()?.as_bytes())?;
    identify(workspace, &host)?;
    announce("Rerunning the paper's experiments from the packaged FMUs (FMI 3.0)");
    let mut command = workspace.command(&host);
    command.args(["run", "-o", PAPER, "--title", TITLE]);
    command.args(EXPERIMENTS.map(|name| format!("experiments/{name}.toml")));
    let status = command
        .status()
        .map_err(|error| format!("flexarm: {error}"))?;
    match status.code() {
        Some(0) => Ok(()),
        Some(MISSED) => Err(format!(
            "not all figures are as expected: see {PAPER}/index.html"
        )),
        _ => Err(format!("`flexarm run` failed: {status}")),
    }
}

/// Sec 3.1: the T-flex with its drive noise, within the limits of its angle.
fn identify(workspace: &Workspace, host: &Path) -> Result<(), String> {
    announce("Identifying the packaged plant");
    let [controller, plant] =
        ["FlexArmController", "FlexArmPlant"].map(|unit| format!("dist/fmi3/{unit}.fmu"));
    workspace.run(workspace.command(host).args([
        "identify",
        "--controller",
        &controller,
        "--plant",
        &plant,
        "--set",
        "plant:noise.current=3e-4",
        "-o",
        &format!("{PAPER}/identification"),
    ]))
}
