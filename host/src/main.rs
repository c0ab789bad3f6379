//! `flexarm`: runs, scores and plots pairs of FMUs from the command line.

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    cli::carry_out(cli::Arguments::parse())
}
