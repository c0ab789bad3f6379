//! The Modelica package `dist/FlexArm`: the sources in `modelica/`, what they repeat of the contracts, and the
//! controller's binaries.
//!
//! Records of parameters, enumerations and the order of what crosses the C interface derive from the contracts, so
//! that names, units, ranges and defaults are those of the FMUs.

mod class;
mod contract;
mod parameters;

use crate::archive::write_whole;
use crate::fmu::Content;
use crate::workspace::{Workspace, announce};
use model_description::ModelDescription;
use std::collections::BTreeMap;
use std::fs;

/// Hand-written classes.
const SOURCES: &str = "modelica/FlexArm";
/// Where the package is written, in the project.
const PACKAGE: &str = "dist/FlexArm";

/// Files of the package by path.
type Files = BTreeMap<String, Vec<u8>>;

/// Writes the package anew, and nothing else into its folder; returns its path in the project.
pub fn write(
    workspace: &Workspace,
    plant: &ModelDescription,
    content: &Content,
) -> Result<String, String> {
    announce("Writing the Modelica package");
    let controller = &content.description;
    let mut files = Files::new();
    sources(workspace, "", &mut files)?;
    for text in files.values_mut() {
        if let Ok(source) = std::str::from_utf8(text) {
            *text = source
                .replace("@version@", &controller.version)
                .into_bytes();
        }
    }
    parameters::add(workspace, [plant, controller], &mut files)?;
    contract::add(controller, &mut files)?;
    for (platform, binary) in &content.binaries {
        // Modelica names the platforms as FMI 2.0 does, libraries as the linker of each knows them.
        let prefix = if platform.is_linux() { "lib" } else { "" };
        let (folder, suffix) = (platform.fmi2, platform.suffix);
        let path = format!("Resources/Library/{folder}/{prefix}FlexArmController{suffix}");
        files.insert(path, binary.clone());
    }
    for (name, text) in content.licences.files() {
        files.insert(format!("Resources/Licenses/{name}"), text.to_vec());
    }

    let folder = workspace.path(PACKAGE);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| format!("{PACKAGE}: {e}"))?;
    }
    for (path, content) in &files {
        write_whole(&folder.join(path), content)?;
    }
    Ok(format!("{PACKAGE}/package.mo"))
}

/// Reads the hand-written files of a folder and those below it.
fn sources(workspace: &Workspace, folder: &str, files: &mut Files) -> Result<(), String> {
    let error = |e| format!("{SOURCES}/{folder}: {e}");
    for entry in fs::read_dir(workspace.path(SOURCES).join(folder)).map_err(error)? {
        let entry = entry.map_err(error)?;
        let name = entry.file_name().into_string();
        let name = name.map_err(|name| format!("{SOURCES}/{folder}: {name:?} is no UTF-8"))?;
        let path = if folder.is_empty() {
            name
        } else {
            format!("{folder}/{name}")
        };
        if entry.file_type().map_err(error)?.is_dir() {
            sources(workspace, &path, files)?;
        } else {
            let content = workspace.read_bytes(&format!("{SOURCES}/{path}"))?;
            files.insert(path, content);
        }
    }
    Ok(())
}
