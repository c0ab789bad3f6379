//! `cargo xtask`: builds, packages, documents, demonstrates and tests the FMUs.
//!
//! Needs nothing but cargo (and, for `test`, Python). Knows the units only as crates that build a
//! shared library and as model descriptions; runs them with the `flexarm` host like any user.

mod archive;
mod cargo;
mod demo;
mod fmu;
mod fuzz;
mod imports;
mod licences;
mod modelica;
mod package;
mod page;
mod parameters;
mod platform;
mod plot;
mod python;
mod reference;
mod reproduce;
mod run;
mod shooting;
mod ssp;
mod test;
mod toolchain;
mod workspace;

use clap::{Parser, Subcommand};
use package::Platforms;
use std::process::ExitCode;
use workspace::Workspace;

/// Builds, packages, demonstrates and tests the FMUs of the flexure arm.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
#[command(after_help = "\
Start with `cargo xtask demo`: it builds everything, runs the controller against the arm and says where
the report is. The FMUs are then in dist/fmi2 and dist/fmi3, the parameter sets in dist/parameters; drop the
FMUs into your tool and connect torque and angle, or open dist/FlexArm.ssp, where they are connected.")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build both units and write the FMUs, parameter sets and system structures to dist/
    ///
    /// Writes dist/fmi2/*.fmu, dist/fmi3/*.fmu (the same binaries, described for each version of the
    /// standard), dist/parameters/*.ssv, connected dist/FlexArm.ssp and dist/ssp/, and the Modelica package
    /// dist/FlexArm. Equal inputs give equal bytes.
    Package {
        /// Carry binaries for 64-bit Windows, Linux and Linux on ARM, on systems since 2012
        ///
        /// Fetches what it needs into target/toolchain, 1.5 GB: zig from PyPI and, for a standard
        /// library that your compiler does not have, Debian's compiler. See docs/platforms.md.
        #[arg(long)]
        all_platforms: bool,
    },
    /// Package, then simulate 20 s of setpoints on the T-flex and write a report
    ///
    /// The report is dist/demo/report.html, the result beside it; packaging/assets/tflex-setpoints.csv
    /// holds the setpoints.
    Demo,
    /// Package, then rerun every experiment of the paper and compare
    ///
    /// The experiments are experiments/*.toml; tables and figures, paper beside ours, are in
    /// dist/paper/index.html. Fails if a figure is not as expected.
    Reproduce,
    /// Run all tests: Rust, packaging, and independent FMI tools in Python
    ///
    /// Makes a Python environment in target/venv with what tests/requirements.txt pins. Stops at the
    /// first step that fails.
    Test {
        /// Instead build for every platform and compare them under emulation
        ///
        /// Windows in Wine, Linux on ARM in qemu: both must do what this platform does, to the last bit.
        /// Ends with a table of every client's scores, those of the Rust crates that import FMUs among them.
        #[arg(long)]
        platforms: bool,
        /// Arguments for pytest, after `--`: for example `-- -k snapshots`
        #[arg(last = true)]
        pytest: Vec<String>,
    },
    /// Fuzz every reader of what others made: archives, descriptions, SSV, SSP, CSV, TOML, saved states
    ///
    /// Needs `cargo install cargo-fuzz` and a C++ compiler. Each target gets an equal share of the time; what
    /// crashes or hangs one is kept in fuzz/artifacts, the corpus in target/fuzz.
    Fuzz {
        /// Time for all targets together, in minutes
        #[arg(long, default_value_t = 60.0)]
        minutes: f64,
        /// Targets, by name; none: all
        targets: Vec<String>,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = Workspace::find().and_then(|workspace| match arguments.command {
        Command::Package { all_platforms } => package::run(
            &workspace,
            if all_platforms {
                Platforms::All
            } else {
                Platforms::This
            },
        ),
        Command::Demo => demo::run(&workspace),
        Command::Reproduce => reproduce::run(&workspace),
        Command::Test { platforms, pytest } if platforms => test::platforms(&workspace, &pytest),
        Command::Test { pytest, .. } => test::run(&workspace, &pytest),
        Command::Fuzz { minutes, targets } => fuzz::run(&workspace, minutes, &targets),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
