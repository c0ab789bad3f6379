//! The command line and its exit codes.

mod export;
mod identify;
mod inspect;
mod progress;
mod run;
mod simulate;
mod system;

use clap::{Parser, Subcommand};
use host::Error;
use std::io::{self, Write};

/// Runs, scores and plots a controller FMU with a plant FMU, ours or a vendor's (FMI 2.0 and 3.0), and identifies arms.
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
    Export(export::Arguments),
    Identify(Box<identify::Arguments>),
    Inspect(inspect::Arguments),
}

const EXAMPLES: &str = "\
Examples:
  flexarm inspect FlexArmPlant.fmu
  flexarm simulate --controller FlexArmController.fmu --plant FlexArmPlant.fmu --setpoints steps.csv -o out/
  flexarm simulate FlexArm.ssp --setpoints steps.csv -o out/
  flexarm run experiments/*.toml -o out/
  flexarm identify --measurement log.csv -o out/

Exit codes: 0 done; 1 the run failed or its result could not be written; 2 wrong usage or input, which includes
values that an FMU refuses before the first step and a folder for -o that cannot be used; 3 all runs of
`flexarm run` are done, but not all figures are as expected. Messages go to standard error.";

/// Carries out a command and returns the exit code.
pub(crate) fn carry_out(arguments: Arguments) -> u8 {
    let result = match arguments.command {
        Command::Simulate(arguments) => simulate::run(*arguments).map(|()| 0),
        Command::Run(arguments) => run::run(&arguments),
        Command::Export(arguments) => export::run(arguments).map(|()| 0),
        Command::Identify(arguments) => identify::run(*arguments).map(|()| 0),
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
