//! `cargo xtask demo`: the packaged controller moves the packaged arm.

use crate::package::Platforms;
use crate::workspace::{Workspace, announce};
use crate::{cargo, package};

/// Setpoints within −20 … +12° about 1.30 rad, a new one every 0.5 s.
pub const SETPOINTS: &str = "packaging/assets/tflex-setpoints.csv";

/// Packages, simulates 20 s and says where the report is.
pub fn run(workspace: &Workspace) -> Result<(), String> {
    package::run(workspace, Platforms::This)?;
    announce("Simulating 20 s of the T-flex from the packaged FMUs (FMI 3.0)");
    let host = cargo::host(workspace)?;
    workspace.run(workspace.command(host).args([
        "simulate",
        "--controller",
        "dist/fmi3/FlexArmController.fmu",
        "--plant",
        "dist/fmi3/FlexArmPlant.fmu",
        "--parameters",
        "dist/parameters/tflex.ssv",
        "--setpoints",
        SETPOINTS,
        "--until",
        "20",
        "-o",
        "dist/demo",
    ]))
}
