//! `cargo xtask test`: every test there is, in the order in which a failure tells most.

use crate::package::Platforms;
use crate::workspace::{Workspace, announce};
use crate::{cargo, package, python};
use std::process::Stdio;

/// Where the Python environment is made.
const VENV: &str = "target/venv";

/// Runs all steps; stops at the first that fails. `pytest` are further arguments for pytest.
pub fn run(workspace: &Workspace, platforms: Platforms, pytest: &[String]) -> Result<(), String> {
    tools(workspace)?;
    announce("1/5 Rust: unit, property and documentation tests");
    workspace.run(cargo::command(workspace).args(["test", "--release", "--workspace"]))?;
    announce("2/5 Package");
    package::run(workspace, platforms)?;
    announce("3/5 Python environment");
    let python = python::environment(workspace, VENV, "tests/requirements.txt")?;
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
            works(python::SYSTEM, &["-c", venv]),
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
