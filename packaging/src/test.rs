//! `cargo xtask test`: every test there is, in the order in which a failure tells most.

use crate::workspace::{Workspace, announce};
use crate::{cargo, package};
use std::path::PathBuf;
use std::process::Stdio;

/// Where the Python environment is made.
const VENV: &str = "target/venv";

/// Runs all steps; stops at the first that fails. `pytest` are further arguments for pytest.
pub fn run(workspace: &Workspace, pytest: &[String]) -> Result<(), String> {
    tools(workspace)?;
    announce("1/5 Rust: unit, property and documentation tests");
    workspace.run(cargo::command(workspace).args(["test", "--release", "--workspace"]))?;
    announce("2/5 Package");
    package::run(workspace)?;
    announce("3/5 Python environment");
    let python = environment(workspace)?;
    announce("4/5 Python: style");
    let check = ["-m", "ruff", "check", "tests", "benches"];
    workspace.run(workspace.command(&python).args(check))?;
    announce("5/5 Python: independent FMI tools against the packages");
    workspace.run(
        workspace
            .command(&python)
            .args(["-m", "pytest", "tests"])
            .args(pytest),
    )?;
    announce("All tests passed");
    Ok(())
}

/// The interpreter that the environment is made with.
const PYTHON: &str = if cfg!(windows) { "python" } else { "python3" };

/// Checks for what cargo cannot install, before anything is built: a build takes minutes.
fn tools(workspace: &Workspace) -> Result<(), String> {
    let works = |program: &str, arguments: &[&str]| {
        let mut command = workspace.command(program);
        command.args(arguments).stdin(Stdio::null());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let venv = "import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))";
    let missing: Vec<_> = [
        (
            works(PYTHON, &["-c", venv]),
            "Python 3.11 or later with its module venv (python3-venv)",
        ),
        (works("valgrind", &["--version"]), "valgrind"),
        (works("readelf", &["--version"]), "readelf (binutils)"),
    ]
    .into_iter()
    .filter_map(|(found, name)| (!found).then_some(name))
    .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!(
        "the tests need {}; in brackets the package on Debian and Ubuntu",
        missing.join(", ")
    ))
}

/// Makes the Python environment if it is missing and brings it up to tests/requirements.txt.
fn environment(workspace: &Workspace) -> Result<PathBuf, String> {
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    let venv = workspace.path(VENV);
    let python = venv.join(folder).join("python");
    let has_pip = || {
        let mut pip = workspace.command(&python);
        let pip = pip.args(["-m", "pip", "--version"]).stdout(Stdio::null());
        pip.stderr(Stdio::null())
            .status()
            .is_ok_and(|s| s.success())
    };
    if !has_pip() {
        let mut make = workspace.command(PYTHON);
        make.args(["-m", "venv", "--clear"]).arg(&venv);
        workspace.run(&mut make)?;
    }
    workspace.run(workspace.command(&python).args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--requirement",
        "tests/requirements.txt",
    ]))?;
    Ok(python)
}
