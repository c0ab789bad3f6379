//! Speed of the controller and of its packaged FMUs: `cargo run --release -p flexarm-benches`, after
//! `cargo xtask package`. All figures of one run on one machine; compare within a run.
//!
//! `flexarm-benches serve` answers requests for plans instead; `peers/run.py` compares them with other tools'.

#![allow(clippy::print_stdout, reason = "the table is the product")]

mod packages;
mod planners;
mod sample;
mod serve;
mod solve;
mod statistics;

use std::path::Path;
use std::process::ExitCode;

/// Anything that stops the benchmark; it is shown and the program ends.
type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    if std::env::args().nth(1).as_deref() == Some("serve") {
        return serve::run();
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .ok_or("the workspace has no folder")?;
    println!("{}\n", machine());
    solve::run(&root.join("control/tests/golden"))?;
    sample::run()?;
    packages::run(root)
}

/// Processor and build, as far as they can be told.
fn machine() -> String {
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu
        .lines()
        .find_map(|line| line.strip_prefix("model name"))
        .map_or("unknown processor", |rest| {
            rest.trim_start_matches([' ', '\t', ':'])
        });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!(
        "{model}, {cores} cores, {} {}, flexarm {}",
        std::env::consts::OS,
        std::env::consts::ARCH,
        env!("CARGO_PKG_VERSION")
    )
}
