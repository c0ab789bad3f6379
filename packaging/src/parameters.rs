//! The parameter sets that ship: the start values of both units, with the changes of each set.

use crate::archive::write_whole;
use crate::workspace::Workspace;
use model_description::{Diagnostic, ModelDescription, parameters, ssv};

/// Where the changes of the sets are kept; `tflex` has none.
const SOURCES: &str = "modelDescription/parameters";

/// Writes dist/parameters/*.ssv.
///
/// `tflex` and `pendulum` are complete: one file for both units. `pendulum-model-error` holds only
/// what the controller is to believe wrongly (eq 32).
pub fn write(workspace: &Workspace, units: &[ModelDescription]) -> Result<(), String> {
    let mut tflex = parameters::start_values(units, "tflex").map_err(lines)?;
    tflex.description = "T-flex arm and its controller: the start values of both units".to_owned();

    let mut pendulum = tflex.clone();
    let own = changes(workspace, "pendulum")?;
    apply(&mut pendulum, units, &own)?;
    pendulum.name = own.1.name;
    pendulum.description = own.1.description;

    let model_error = changes(workspace, "pendulum-model-error")?;
    let mut partial = pendulum.clone();
    apply(&mut partial, units, &model_error)?;
    partial.name = model_error.1.name;
    partial.description = model_error.1.description;
    let changed = |name: &str| model_error.1.parameters.iter().any(|p| p.name == name);
    partial.parameters.retain(|p| changed(&p.name));
    let used = |name: &String| {
        partial
            .parameters
            .iter()
            .any(|p| p.unit.as_ref() == Some(name))
    };
    partial.units.retain(|u| used(&u.name));

    for set in [&tflex, &pendulum, &partial] {
        let path = workspace.path(&format!("dist/parameters/{}.ssv", set.name));
        write_whole(&path, ssv::write(set).as_bytes())?;
    }
    Ok(())
}

/// A file of changes and its name.
fn changes(workspace: &Workspace, name: &str) -> Result<(String, ssv::ParameterSet), String> {
    let file = format!("{SOURCES}/{name}.ssv");
    let set = ssv::read(&workspace.read(&file)?, &file).map_err(lines)?;
    Ok((file, set))
}

fn apply(
    set: &mut ssv::ParameterSet,
    units: &[ModelDescription],
    (file, changes): &(String, ssv::ParameterSet),
) -> Result<(), String> {
    parameters::change(set, units, changes, file).map_err(lines)
}

/// All diagnostics, one a line.
pub fn lines(diagnostics: Vec<Diagnostic>) -> String {
    let lines: Vec<_> = diagnostics.iter().map(ToString::to_string).collect();
    format!("inconsistent contract\n{}", lines.join("\n"))
}
