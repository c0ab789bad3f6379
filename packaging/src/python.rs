//! Python environments in `target/`.

use crate::workspace::Workspace;
use std::path::PathBuf;
use std::process::Stdio;

/// The interpreter that environments are made with.
pub const SYSTEM: &str = if cfg!(windows) { "python" } else { "python3" };

/// Makes the environment in `folder` if it is missing, brings it up to what the file `requirements`
/// pins and returns its interpreter.
pub fn environment(
    workspace: &Workspace,
    folder: &str,
    requirements: &str,
) -> Result<PathBuf, String> {
    let venv = workspace.path(folder);
    let programs = venv.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = programs.join("python");
    let has_pip = || {
        let mut pip = workspace.command(&python);
        let pip = pip.args(["-m", "pip", "--version"]).stdout(Stdio::null());
        pip.stderr(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    if !has_pip() {
        let mut make = workspace.command(SYSTEM);
        make.args(["-m", "venv", "--clear"]).arg(&venv);
        workspace.run(&mut make).map_err(|e| {
            format!("{e}\na Python with its module venv is needed (python3-venv on Debian)")
        })?;
    }
    workspace.run(workspace.command(&python).args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--requirement",
        requirements,
    ]))?;
    Ok(python)
}
