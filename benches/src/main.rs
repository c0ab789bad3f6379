//! Speed of the controller and of its packaged FMUs. All figures of one run on one machine; compare within a
//! run. `flexarm-benches --help` tells what there is; `peers/run.py` compares with other tools.

#![allow(clippy::print_stdout, reason = "the tables are the product")]

/// Shared with the tests of the controller.
#[path = "../../control/tests/common/mod.rs"]
mod closed_loop;
mod growth;
mod instructions;
mod models;
mod output;
mod packages;
mod planners;
mod rates;
mod sample;
mod serve;
mod solve;
mod starts;
mod statistics;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Anything that stops the benchmark; it is shown and the program ends.
type Failure = Box<dyn std::error::Error>;

/// Speed of the controller: plans, samples, the packaged FMUs.
///
/// Without a command: reference plans by every solver, one 4 kHz sample, and the FMUs in dist/, which
/// `cargo xtask package` writes.
#[derive(Parser)]
#[command(
    version,
    after_help = "\
Wall-clock times are of this machine and of what else it does: compare figures of one run, and keep the process
on one core where others work, `taskset -c 1 flexarm-benches starts`. Instruction counts are the same every time."
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Starts(starts::Options),
    Growth(growth::Options),
    Rates(rates::Options),
    Models(models::Options),
    /// Count the instructions of a plan with valgrind, by every instruction set
    ///
    /// Closed form, cold at a limit, and warm at a limit, N = 40, by the Riccati solver: without and with fused
    /// multiply-add (AVX2 and FMA on x86-64). The difference of two runs of valgrind's callgrind, so that
    /// set-up does not count. Unlike times, the figures change only with code and compiler. Takes a minute;
    /// skipped where valgrind is not installed.
    Instructions,
    #[command(hide = true)]
    Work(instructions::Work),
    /// Answer requests for plans, one JSON object a line in, one out
    ///
    /// For benchmarks in other languages. {"problem": "pendulum"} answers the problem's numbers;
    /// {"arm": "pendulum", "solver": "riccati", "initial": [θ, ω, θr, ωr, e, T], "goal": 1, "warm": false,
    /// "repeats": 5} a plan, timed. `starts` prints its worst starts in this form.
    Serve,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        None => all(),
        Some(Command::Starts(options)) => starts::run(&options),
        Some(Command::Growth(options)) => growth::run(&options),
        Some(Command::Rates(options)) => rates::run(&options),
        Some(Command::Models(options)) => models::run(&options),
        Some(Command::Instructions) => instructions::run(),
        Some(Command::Work(work)) => instructions::work(&work),
        Some(Command::Serve) => serve::run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn all() -> Result<(), Failure> {
    let root = root()?;
    println!("{}\n", machine());
    solve::run(&root.join("control/tests/golden"))?;
    sample::run()?;
    packages::run(root)
}

/// Folder of the workspace.
fn root() -> Result<&'static Path, Failure> {
    Ok(Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .ok_or("the workspace has no folder")?)
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
    let cores = match std::thread::available_parallelism().map_or(1, usize::from) {
        1 => "1 core".to_owned(),
        cores => format!("{cores} cores"),
    };
    format!(
        "{model}, {cores}, {} {}, flexarm {}",
        std::env::consts::OS,
        std::env::consts::ARCH,
        env!("CARGO_PKG_VERSION")
    )
}
