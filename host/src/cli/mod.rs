//! The command line and its exit codes.

mod inspect;
mod run;
mod simulate;

use clap::{Parser, Subcommand};
use host::Error;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs, scores and plots a controller FMU with a plant FMU, ours or a vendor's (FMI 2.0 and 3.0).
#[derive(Debug, Parser)]
#[command(name = "flexarm", version, after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Simulate(Box<simulate::Arguments>),
    Run(run::Arguments),
    Inspect(inspect::Arguments),
}

const EXAMPLES: &str = "\
Examples:
  flexarm inspect FlexArmPlant.fmu
  flexarm simulate --controller FlexArmController.fmu --plant FlexArmPlant.fmu --setpoints steps.csv -o out/
  flexarm run experiments/*.toml -o out/

Exit codes: 0 done; 1 the run failed or its result could not be written; 2 wrong usage or input, which includes
values that an FMU refuses before the first step and a folder for -o that cannot be used; 3 all runs of
`flexarm run` are done, but not all figures are as expected. Messages go to standard error.";

/// Carries out a command and returns the exit code.
pub(crate) fn carry_out(arguments: Arguments) -> u8 {
    let result = match arguments.command {
        Command::Simulate(arguments) => simulate::run(*arguments).map(|()| 0),
        Command::Run(arguments) => run::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments).map(|()| 0),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            let _ = writeln!(io::stderr(), "error: {error}");
            if error.is_input() { 2 } else { 1 }
        }
    }
}

/// Prints to standard output. A reader that went away is no error of ours.
fn print(text: &str) -> Result<(), Error> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => Err(Error::Output {
            path: "standard output".into(),
            source,
        }),
        _ => Ok(()),
    }
}

/// Set by the first Ctrl-C, so that the run ends and temporary folders go; the second one ends the process,
/// should an FMU not return.
fn watch_for_interrupts() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // Without a handler Ctrl-C works as usual.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    interrupted
}

/// A bar of a thousand parts. Hidden by the crate if standard error is no terminal.
fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    bar
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
