//! `cargo xtask fuzz`: libFuzzer against every reader of what others made.

use crate::archive::{Archive, write_whole};
use crate::package::{self, Platforms};
use crate::workspace::{Workspace, announce};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use zip::ZipArchive;

/// Files of the project or entries of its packages that a reader begins with: folder, then how names end.
type Seeds = &'static [(&'static str, &'static str)];

/// The targets in `fuzz/fuzz_targets`.
const TARGETS: [(&str, Seeds); 8] = [
    ("archive", &[]),
    (
        "description",
        &[
            ("modelDescription", ".xml"),
            ("modelDescription/tests", ".xml"),
            ("dist/fmi2", "modelDescription.xml"),
        ],
    ),
    ("parameters", &[("modelDescription/parameters", ".ssv")]),
    ("snapshot_controller", &[]),
    ("snapshot_plant", &[]),
    (
        "structure",
        &[
            ("fuzz/seeds", ".ssd"),
            ("dist", ".ssd"),
            ("dist/ssp", ".ssd"),
        ],
    ),
    (
        "table",
        &[
            ("fuzz/seeds", ".csv"),
            ("packaging/assets", ".csv"),
            ("dist", ".csv"),
        ],
    ),
    ("toml", &[("fuzz/seeds", ".toml"), ("experiments", ".toml")]),
];
/// Where all that fuzzing makes is kept, the corpus for the next time too.
const FOLDER: &str = "target/fuzz";
/// A reader that takes longer for one input hangs \[s\].
const PATIENCE: u32 = 30;

/// Fuzzes each target for an equal share of `minutes`, and prints what came of it. Errors: something was found.
pub fn run(workspace: &Workspace, minutes: f64, wanted: &[String]) -> Result<(), String> {
    let known: Vec<_> = TARGETS.iter().map(|(name, _)| *name).collect();
    if let Some(name) = wanted.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(format!(
            "{name} is no target; there are: {}",
            known.join(", ")
        ));
    }
    let targets = TARGETS
        .iter()
        .filter(|(name, _)| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name));
    let targets: Vec<_> = targets.collect();
    let seconds = (60.0 * minutes / targets.len() as f64).max(1.0) as u64;
    package::run(workspace, Platforms::This)?;
    announce("Building the fuzz targets");
    let mut build = cargo_fuzz(workspace, "build");
    workspace.run(&mut build).map_err(|error| {
        format!("{error}\nthis needs `cargo install cargo-fuzz` and a C++ compiler")
    })?;
    announce(&format!(
        "Fuzzing, {seconds} s each or until something is found"
    ));
    let mut failed = Vec::new();
    for (target, seeds) in targets {
        let corpus = workspace.path(FOLDER).join("corpus").join(target);
        sow(workspace, target, seeds, &corpus)?;
        let log = workspace.path(FOLDER).join(format!("{target}.log"));
        let output = File::create(&log).map_err(|error| format!("{}: {error}", log.display()))?;
        let mut command = cargo_fuzz(workspace, "run");
        command.arg(target).arg(&corpus).arg("--");
        command.arg(format!("-max_total_time={seconds}"));
        command.arg(format!("-timeout={PATIENCE}"));
        command.args(["-max_len=60000", "-print_final_stats=1"]);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(output);
        let status = command
            .status()
            .map_err(|error| format!("cargo: {error}"))?;
        let text = fs::read_to_string(&log).unwrap_or_default();
        let executed = text
            .lines()
            .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
        let outcome = if status.success() {
            "nothing found".to_owned()
        } else {
            failed.push(*target);
            format!("see {}", log.display())
        };
        let executed = executed.map_or("?", str::trim);
        eprintln!("{target:20} {executed:>12} inputs: {outcome}");
    }
    if failed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "found something in {}; this repeats an input:\n    RUSTC_BOOTSTRAP=1 cargo fuzz run -s none \
         --features libfuzzer --target-dir {FOLDER} TARGET fuzz/artifacts/TARGET/FILE",
        failed.join(", ")
    ))
}

/// cargo-fuzz without a sanitizer: the code is safe but for the C interface, and sanitizers need a nightly compiler.
fn cargo_fuzz(workspace: &Workspace, command: &str) -> std::process::Command {
    let mut cargo = crate::cargo::command(workspace);
    cargo.args(["fuzz", command, "--fuzz-dir", "fuzz", "-s", "none"]);
    cargo.args(["--features", "libfuzzer"]);
    cargo.arg("--target-dir").arg(workspace.path(FOLDER));
    // For names in what a panic prints.
    cargo.env("CARGO_PROFILE_RELEASE_STRIP", "none");
    // Instrumentation is an unstable flag of a stable compiler.
    cargo.env("RUSTC_BOOTSTRAP", "1");
    cargo
}

/// Writes the seeds of a target into its corpus.
fn sow(workspace: &Workspace, target: &str, seeds: Seeds, corpus: &Path) -> Result<(), String> {
    fs::create_dir_all(corpus).map_err(|error| format!("{}: {error}", corpus.display()))?;
    if target == "archive" {
        let mut archive = Archive::default();
        let description = workspace.read_bytes("modelDescription/tests/valid.xml")?;
        archive.add("modelDescription.xml", description);
        return write_whole(&corpus.join("valid.fmu"), &archive.to_bytes()?);
    }
    for (folder, suffix) in seeds {
        for (name, content) in files(&workspace.path(folder), suffix)? {
            write_whole(&corpus.join(name), &content)?;
        }
    }
    Ok(())
}

/// Files of a folder, and of the archives in it, whose names end with `suffix`.
fn files(folder: &Path, suffix: &str) -> Result<Vec<(String, Vec<u8>)>, String> {
    let error = |path: &Path, error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let entries = fs::read_dir(folder).map_err(|e| error(folder, &e))?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if name.ends_with(suffix) {
            found.push((name, fs::read(&path).map_err(|e| error(&path, &e))?));
        } else if name.ends_with(".fmu") || name.ends_with(".ssp") {
            let file = File::open(&path).map_err(|e| error(&path, &e))?;
            let mut archive = ZipArchive::new(file).map_err(|e| error(&path, &e))?;
            for index in 0..archive.len() {
                let mut entry = archive.by_index(index).map_err(|e| error(&path, &e))?;
                let inner = entry.name().map_err(|e| error(&path, &e))?;
                if inner.ends_with(suffix) {
                    let entry_name = format!("{name}-{}", inner.replace('/', "-"));
                    let mut content = Vec::new();
                    entry
                        .read_to_end(&mut content)
                        .map_err(|e| error(&path, &e))?;
                    found.push((entry_name, content));
                }
            }
        }
    }
    Ok(found)
}
