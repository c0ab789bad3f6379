//! `cargo xtask test`: every test there is, in the order in which a failure tells most.

use crate::package::Platforms;
use crate::platform::Platform;
use crate::toolchain::Toolchain;
use crate::workspace::{Workspace, announce};
use crate::{cargo, package, python};
use std::process::Stdio;

/// Where the Python environment is made.
const VENV: &str = "target/venv";
const REQUIREMENTS: &str = "tests/requirements.txt";

/// Runs all steps; stops at the first that fails. `pytest` are further arguments for pytest.
pub fn run(workspace: &Workspace, pytest: &[String]) -> Result<(), String> {
    check(workspace, &TOOLS)?;
    announce("1/5 Rust: unit, property and documentation tests");
    workspace.run(cargo::command(workspace).args(["test", "--release", "--workspace"]))?;
    announce("2/5 Package");
    package::run(workspace, Platforms::This)?;
    announce("3/5 Python environment");
    let python = python::environment(workspace, VENV, REQUIREMENTS)?;
    announce("4/5 Python: style");
    let check = ["-m", "ruff", "check", "tests", "benches"];
    workspace.run(workspace.command(&python).args(check))?;
    announce("5/5 Python: independent FMI tools against the packages");
    let mut tests = workspace.command(&python);
    workspace.run(tests.args(["-m", "pytest", "tests"]).args(pytest))?;
    announce("All tests passed");
    Ok(())
}

/// Builds for every platform and runs that under emulation. `pytest` are further arguments for pytest.
pub fn platforms(workspace: &Workspace, pytest: &[String]) -> Result<(), String> {
    check(workspace, &TOOLS)?;
    check(workspace, &EMULATORS)?;
    announce("1/4 Package for every platform");
    package::run(workspace, Platforms::All)?;
    announce("2/4 The host for the other platforms");
    let this = Platform::host()?;
    let others: Vec<_> = Platform::ALL.into_iter().filter(|p| *p != this).collect();
    Toolchain::prepare(workspace, &others)?.build(workspace, &["flexarm-host"])?;
    announce("3/4 Python environment");
    let python = python::environment(workspace, VENV, REQUIREMENTS)?;
    announce("4/4 Every platform against this one, every client against our host");
    let mut tests = workspace.command(&python);
    tests.args(["-m", "pytest", "--slow"]);
    tests.args(PLATFORM_TESTS.map(|name| format!("tests/test_{name}.py")));
    workspace.run(tests.args(pytest))?;
    announce("All tests of platforms passed");
    Ok(())
}

/// The Python tests that have something to run under emulation.
const PLATFORM_TESTS: [&str; 3] = ["platforms", "modelica_controller", "matrix"];

/// A program, arguments with which it succeeds, and what to install.
type Tool = (&'static str, &'static [&'static str], &'static str);

const VERSION: &[&str] = &["--version"];
const TOOLS: [Tool; 3] = [
    (
        python::SYSTEM,
        &[
            "-c",
            "import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))",
        ],
        "Python 3.11 or later with its module venv (python3-venv)",
    ),
    ("valgrind", VERSION, "valgrind"),
    ("readelf", VERSION, "readelf (binutils)"),
];
const EMULATORS: [Tool; 2] = [
    ("wine", VERSION, "wine (wine, wine64)"),
    (
        "qemu-aarch64",
        VERSION,
        "qemu-aarch64 (qemu-user, libc6-arm64-cross)",
    ),
];

/// Checks for what cargo cannot install, before anything is built: a build takes minutes.
fn check(workspace: &Workspace, tools: &[Tool]) -> Result<(), String> {
    let works = |program: &str, arguments: &[&str]| {
        let mut command = workspace.command(program);
        command.args(arguments).stdin(Stdio::null());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let missing: Vec<_> = tools
        .iter()
        .filter_map(|(program, arguments, name)| (!works(program, arguments)).then_some(*name))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!(
        "the tests need {}; in brackets the packages on Debian and Ubuntu",
        missing.join(", ")
    ))
}
