//! Debian's compiler, the sources of its standard library and a linker for Windows, below `target/`.
//!
//! For machines whose rustup cannot fetch more than it has. Nothing is installed, so nobody has to
//! be root: apt says what would be, fetches it, and it is unpacked in a folder.

use super::FOLDER;
use super::compiler::LIBRARY_SOURCE;
use crate::workspace::{Workspace, announce};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Of Debian, the packages that follow the current compiler.
const COMPILER: &str = "rustc-web";
const SOURCE: &str = "rust-web-src";
/// The linker for Windows, if it is not installed.
const MINGW: &str = "gcc-mingw-w64-x86-64-win32";

/// Folder with the compiler, fetched if it is not there.
pub fn fetch(workspace: &Workspace) -> Result<PathBuf, String> {
    let folder = workspace.path(FOLDER).join("debian");
    if folder.is_dir() {
        return Ok(folder);
    }
    announce("Fetching Debian's compiler into target/toolchain");
    let packages = packages(workspace)?;
    // Unpacked beside and then renamed: a run that was cut short leaves nothing that looks whole.
    let part = workspace.path(FOLDER).join("debian.part");
    let failed = |path: &Path, e| format!("{}: {e}", path.display());
    if part.exists() {
        fs::remove_dir_all(&part).map_err(|e| failed(&part, e))?;
    }
    fs::create_dir_all(&part).map_err(|e| failed(&part, e))?;
    let mut download = workspace.command("apt-get");
    // apt's own user may not write here; without this it says so for every package.
    download.args(["--quiet=2", "--option=APT::Sandbox::User=root", "download"]);
    download.args(&packages);
    workspace.run(download.current_dir(&part))?;
    for entry in fs::read_dir(&part).map_err(|e| failed(&part, e))?.flatten() {
        let package = entry.path();
        if package.extension().is_some_and(|e| e == "deb") {
            let mut unpack = workspace.command("dpkg-deb");
            workspace.run(unpack.arg("--extract").arg(&package).arg(&part))?;
            fs::remove_file(&package).map_err(|e| failed(&package, e))?;
        }
    }
    for needed in ["usr/bin/rustc", &format!("usr/{LIBRARY_SOURCE}")] {
        if !part.join(needed).exists() {
            return Err(format!("its packages hold no {needed}"));
        }
    }
    // Of the sources only the library's are needed; the rest is half of all that was unpacked.
    for unused in ["compiler", "src"] {
        let path = part.join("usr").join(LIBRARY_SOURCE).with_file_name(unused);
        fs::remove_dir_all(&path).map_err(|e| failed(&path, e))?;
    }
    fs::rename(&part, &folder).map_err(|e| failed(&folder, e))?;
    Ok(folder)
}

/// The compiler, its sources and all that they need and this machine lacks.
fn packages(workspace: &Workspace) -> Result<Vec<String>, String> {
    let mut simulate = workspace.command("apt-get");
    simulate.args(["install", "--simulate", "--no-install-recommends"]);
    simulate.args([COMPILER, SOURCE, MINGW]).env("LC_ALL", "C");
    let output = simulate.stderr(Stdio::inherit()).output();
    let output = output.map_err(|e| format!("apt-get: {e}"))?;
    let packages = missing(&String::from_utf8_lossy(&output.stdout));
    for wanted in [COMPILER, SOURCE] {
        let version = packages.iter().find(|(name, _)| name == wanted);
        let (_, version) = version.ok_or_else(|| {
            format!("apt-get would not fetch {wanted}: it is unknown, or already installed")
        })?;
        if !is_enough(version) {
            return Err(format!(
                "{wanted} {version} is too old, {} is needed: run `apt-get update`",
                env!("CARGO_PKG_RUST_VERSION")
            ));
        }
    }
    Ok(packages.into_iter().map(|(name, _)| name).collect())
}

/// Names and versions in lines such as `Inst rustc-web (1.96.0+dfsg1-1 Debian:12 [amd64])`.
/// A package that would be brought up to date has its old version in between; it stays as it is.
fn missing(simulation: &str) -> Vec<(String, String)> {
    let new = |line: &str| {
        let mut words = line.strip_prefix("Inst ")?.split_whitespace();
        let name = words.next()?;
        Some((name.to_owned(), words.next()?.strip_prefix('(')?.to_owned()))
    };
    simulation.lines().filter_map(new).collect()
}

/// Whether a version of Debian is at least the one that this workspace asks for.
fn is_enough(version: &str) -> bool {
    let numbers = |text: &str| -> Vec<u32> {
        let number = |part: &str| {
            part.split(|c: char| !c.is_ascii_digit())
                .next()?
                .parse()
                .ok()
        };
        text.split('.').take(2).map_while(number).collect()
    };
    numbers(version) >= numbers(env!("CARGO_PKG_RUST_VERSION"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_new_packages_are_fetched() {
        let simulation = "\
Reading package lists...
Inst libc6 [2.36-9] (2.36-10 Debian:12 [amd64])
Inst libllvm22 (1:22.1.8-1 Debian:12 [amd64])
Inst rustc-web (1.96.0+dfsg1-1~deb12u2 Debian:12 [amd64])
Conf rustc-web (1.96.0+dfsg1-1~deb12u2 Debian:12 [amd64])
";
        let names: Vec<_> = missing(simulation).into_iter().map(|(n, _)| n).collect();
        assert_eq!(names, ["libllvm22", "rustc-web"]);
    }

    #[test]
    fn versions_are_numbers() {
        assert!(is_enough("1.196.0+dfsg1-1~deb12u2") && is_enough("2.0"));
        assert!(is_enough(env!("CARGO_PKG_RUST_VERSION")));
        assert!(!is_enough("1.85.0+dfsg3-1") && !is_enough("0.99"));
    }
}
