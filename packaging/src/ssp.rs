//! The system structures that ship: the connected pair, and each experiment that needs nothing but the package.
//!
//! `flexarm export` makes them, as it does for a user's own experiments.

use crate::fmu::Version;
use crate::reproduce::EXPERIMENTS;
use crate::workspace::{Workspace, announce};
use std::ffi::OsStr;

/// What FlexArm.ssp holds.
const SYSTEM: &str = "packaging/assets/system.toml";
/// The experiment whose parameters `cargo xtask reproduce` identifies first.
const NEEDS_RESULTS: &str = "identification";

/// Writes dist/FlexArm.ssp and dist/ssp/fmi2/*.ssp with the FMUs of FMI 2.0, which all tools that know SSP 1.0
/// read, and dist/ssp/fmi3/*.ssp with those of FMI 3.0. Returns their paths in the project.
pub fn write(workspace: &Workspace, host: &OsStr) -> Result<Vec<String>, String> {
    announce("Connecting the units: system structures (SSP)");
    let mut paths = vec!["dist/FlexArm.ssp".to_owned()];
    export(workspace, host, SYSTEM, Version::Fmi2, &paths[0])?;
    for version in Version::ALL {
        let folder = format!("dist/ssp/{}", version.folder());
        if version == Version::Fmi3 {
            let path = format!("{folder}/FlexArm.ssp");
            export(workspace, host, SYSTEM, version, &path)?;
            paths.push(path);
        }
        for name in EXPERIMENTS.into_iter().filter(|n| *n != NEEDS_RESULTS) {
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
