//! Where things lie, and how other programs are run there.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The project's folder.
pub struct Workspace {
    root: PathBuf,
}

impl Workspace {
    /// The workspace whose `cargo xtask` this is.
    pub fn find() -> Result<Self, String> {
        let package = env::var_os("CARGO_MANIFEST_DIR").ok_or("run me as `cargo xtask`")?;
        let root = Path::new(&package)
            .parent()
            .ok_or("the package has no parent folder")?;
        Ok(Self {
            root: root.to_owned(),
        })
    }

    /// A path in the project.
    pub fn path(&self, relative: &str) -> PathBuf {
        self.root.join(relative)
    }

    /// A file of the project as text; errors name it.
    pub fn read(&self, relative: &str) -> Result<String, String> {
        fs::read_to_string(self.path(relative)).map_err(|e| format!("{relative}: {e}"))
    }

    /// A file of the project as bytes; errors name it.
    pub fn read_bytes(&self, relative: &str) -> Result<Vec<u8>, String> {
        fs::read(self.path(relative)).map_err(|e| format!("{relative}: {e}"))
    }

    /// A program that will run in the project's folder.
    pub fn command(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// Runs a program to its end and shows what it prints. Errors: it cannot run, or it fails.
    pub fn run(&self, command: &mut Command) -> Result<(), String> {
        let name = Path::new(command.get_program()).display().to_string();
        let status = command.status().map_err(|e| format!("{name}: {e}"))?;
        if status.success() {
            Ok(())
        } else {
            let words: Vec<_> = command.get_args().map(OsStr::to_string_lossy).collect();
            Err(format!("`{name} {}` failed: {status}", words.join(" ")))
        }
    }
}

/// Announces a step.
pub fn announce(step: &str) {
    eprintln!("\n==> {step}");
}
