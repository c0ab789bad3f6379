//! Runs the command line on two mocks.

use super::mock;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub const CONNECTIONS: &str = "
[[connection]]
from = \"plant.y\"
to = \"controller.u\"
offset = 1.0
[[connection]]
from = \"controller.y\"
to = \"plant.u\"
[[role]]
name = \"angle\"
from = \"plant.y\"
factor = 2.0
";

pub const ROLE: &str = "
[[role]]
name = \"angle\"
from = \"plant.y\"
";

/// Runs in a folder, with its own temporary folder whose name needs care in an URI.
pub fn flexarm(folder: &Path, arguments: &[&str]) -> Output {
    let temporary = folder.join("tmp 50% #1 ä");
    fs::create_dir_all(&temporary).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_flexarm"))
        .args(arguments)
        .current_dir(folder)
        .env("TMPDIR", &temporary)
        .output()
        .unwrap();
    assert_eq!(
        fs::read_dir(&temporary).unwrap().count(),
        0,
        "temporary folders are removed"
    );
    output
}

pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with two mocks and connections.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, version) in [("c.fmu", 2), ("p.fmu", 3)] {
        fs::rename(mock(folder.path(), version), folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("m.toml"), CONNECTIONS).unwrap();
    folder
}

pub const RUN: [&str; 9] = [
    "simulate",
    "--controller",
    "c.fmu",
    "--plant",
    "p.fmu",
    "--connections",
    "m.toml",
    "--step",
    "0.5",
];

pub fn run(folder: &Path, more: &[&str]) -> Output {
    flexarm(folder, &[&RUN, more].concat())
}
