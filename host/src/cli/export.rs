//! `flexarm export`.

use clap::Args;
use host::Error;
use host::experiment::Experiment;
use host::ssp::Export;
use std::io::{self, Write};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
    flexarm export experiments/disturbance.toml -o disturbance.ssp
    flexarm export my-experiment.toml --plant Vendor.fmu -o mine.ssp
    flexarm simulate mine.ssp --variant LQRI-MPC -o out/

Each run of the experiment is a system structure of the SSP with controller, plant, connections, units, parameter sets,
setpoints and geometry, in a file called like the run; the first one is SystemStructure.ssd, which tools open by
default. The setpoints are resources/RUN.csv: other tools show the inputs of the system, which start with the first
values and have to be driven by a source of the tool.";

/// Makes an SSP of an experiment, for tools that read system structures.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// The experiment (TOML), as for `flexarm run`.
    #[arg(value_name = "EXPERIMENT")]
    experiment: PathBuf,
    /// FMU that takes the place of the experiment's controller.
    #[arg(long, value_name = "FMU")]
    controller: Option<PathBuf>,
    /// FMU that takes the place of the experiment's plant.
    #[arg(long, value_name = "FMU")]
    plant: Option<PathBuf>,
    /// The SSP.
    #[arg(short, long, value_name = "SSP")]
    output: PathBuf,
}

pub(super) fn run(arguments: Arguments) -> Result<(), Error> {
    let experiment = Experiment::read(&arguments.experiment)?;
    let export = Export {
        controller: arguments.controller,
        plant: arguments.plant,
    };
    for warning in export.write(&experiment, &arguments.output)? {
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
    Ok(())
}
