//! The system structures that ship: the connected pair, and each experiment that needs nothing but the package.
//!
//! `flexarm export` makes them, as it does for a user's own experiments.

use crate::fmu::Version;
use crate::workspace::{Workspace, announce};
use std::ffi::OsStr;

/// What FlexArm.ssp holds.
const SYSTEM: &str = "packaging/assets/system.toml";
/// Experiments whose runs need no results of others.
const EXPERIMENTS: [&str; 9] = [
    "angle-torque",
    "disturbance",
    "feedback-response",
    "linear-model",
    "moving-mass",
    "safe-sets",
    "solve-time",
    "tracking-pendulum",
    "tracking-tflex",
];

/// Writes dist/FlexArm.ssp and dist/ssp/fmi2/*.ssp with the FMUs of FMI 2.0, which all tools that know SSP 1.0
/// read, and dist/ssp/fmi3/*.ssp with those of FMI 3.0. Returns their paths in the project.
pub fn write(workspace: &Workspace, host: &OsStr) -> Result<Vec<String>, String> {
    announce("Connecting the units: system structures (SSP)");
    let mut paths = vec!["dist/FlexArm.ssp".to_owned()];
    export(workspace, host, SYSTEM, Version::Fmi2, &paths[0])?;
    for version in Version::ALL {
        let folder = format!("dist/ssp/{}", version.folder());
        if version == Version::Fmi3 {
            paths.push(format!("{folder}/FlexArm.ssp"));
            export(workspace, host, SYSTEM, version, &paths[paths.len() - 1])?;
        }
        for name in EXPERIMENTS {
            let experiment = format!("experiments/{name}.toml");
            let path = format!("{folder}/{name}.ssp");
            export(workspace, host, &experiment, version, &path)?;
        }
        paths.push(format!("{folder}/*.ssp"));
    }
    Ok(paths)
}

fn export(
    workspace: &Workspace,
    host: &OsStr,
    experiment: &str,
    version: Version,
    path: &str,
) -> Result<(), String> {
    let unit = |unit: &str| format!("dist/{}/{unit}.fmu", version.folder());
    workspace.run(workspace.command(host).args([
        "export",
        experiment,
        "--controller",
        &unit("FlexArmController"),
        "--plant",
        &unit("FlexArmPlant"),
        "-o",
        path,
    ]))
}
