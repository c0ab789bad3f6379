//! `flexarm simulate`.

use super::progress::Progress;
use clap::{Args, ValueEnum};
use host::fmu::Message;
use host::input::parameters::{Assignment, ParameterFile};
use host::input::setpoints::Setpoints;
use host::output::OutputFolder;
use host::ssp::SystemSimulation;
use host::{Error, Simulation, simulate};
use std::fmt::Display;
use std::io::{self, Write};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The pair with its defaults, at rest:
    flexarm simulate --controller FlexArmController.fmu --plant FlexArmPlant.fmu --until 2
  Setpoints from a file, another parameter set, results in out/:
    flexarm simulate --controller FlexArmController.fmu --plant FlexArmPlant.fmu \\
      --parameters pendulum.ssv --setpoints steps.csv -o out/
  One thing changed, for one FMU or both:
    flexarm simulate ... --set nmpc.horizon=30 --set plant:arm.inertia=0.09
  A vendor's plant with other names and degrees:
    flexarm simulate --controller FlexArmController.fmu --plant Vendor.fmu --connections vendor.toml
    # vendor.toml:
    [[connection]]                     # to = factor * from + offset
    from = \"plant.phi_deg\"
    to = \"controller.angle\"
    factor = 0.017453292519943295
    [[connection]]
    from = \"controller.torque\"
    to = \"plant.tau\"
    [[connection]]
    from = \"setpoint\"
    to = \"controller.setpoint\"
    [[role]]                           # what is scored and plotted under which name:
    name = \"thermal_load\"              # angle, torque, thermal_load, thermal_fraction, violations,
    from = \"plant.i2t\"                 # reference_angle, feedforward_torque, feedback_torque,
                                       # plan_status, plan_iterations
  A system structure, ours or another's, of any number of FMUs:
    flexarm simulate FlexArm.ssp --setpoints steps.csv -o out/
    flexarm simulate FlexArm.ssp --variant pendulum --set controller:nmpc.horizon=20

Setpoint files are CSV: header time,setpoint and optional columns named like inputs (disturbance_torque). Each
row holds until the next one; the first is at time 0.

The folder of -o gets results.csv (every communication point: about 20 MB for 20 s, see --record),
summary.json, report.html (which shows it all) and, if an FMU logs, log.txt. A row of results.csv holds the setpoint
and the outputs of both FMUs at its time, from which on the plant gets those of the controller: where the controller
steps first it made them of the same row, side by side of the row before. Torque and angle are a measurement for
flexarm identify in either order. Enumerations are numbers, arrays are left out unless they are connected. A run that
ends before its time leaves what it has in files called *-partial.*, one that does not begin leaves nothing.

An SSP (System Structure and Parameterization 1.0 or 2.0) says itself who is connected, which parameters hold, how
long it runs and with which step. Its parameter bindings are applied first, then --parameters and --set. The columns
of a file for --setpoints are time and names of inputs of its root system. Components step so that who depends
directly on others comes after them. -o gets the same files, and plot.svg, of all signals that are connected.";

/// Runs a controller with a plant and scores it, or runs a system structure (SSP) of any FMUs.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// System structure to run instead of a pair of FMUs.
    #[arg(value_name = "SSP", conflicts_with_all = ["controller", "plant", "connections"])]
    system: Option<PathBuf>,
    /// FMU of the controller.
    #[arg(long, value_name = "FMU", required_unless_present = "system")]
    controller: Option<PathBuf>,
    /// FMU of the plant.
    #[arg(long, value_name = "FMU", required_unless_present = "system")]
    plant: Option<PathBuf>,
    /// Which system structure of the SSP: the name of its .ssd file. Default: SystemStructure.
    #[arg(long, value_name = "NAME", requires = "system")]
    variant: Option<String>,
    /// Parameter file (SSV) for both FMUs, or for one: controller=X.ssv, plant=X.ssv; of an SSP for all elements or
    /// one: ELEMENT=X.ssv. Later ones win.
    #[arg(long, value_name = "[SIDE=]SSV")]
    parameters: Vec<ParameterFile>,
    /// Single value, after the files: NAME=VALUE, controller:NAME=VALUE, plant:NAME=VALUE (or controller.NAME,
    /// plant.NAME); of an SSP ELEMENT:NAME=VALUE.
    #[arg(long = "set", value_name = "[SIDE:]NAME=VALUE")]
    assignments: Vec<Assignment>,
    /// Setpoints over time (CSV). Default: the angle at which the plant starts. Of an SSP: values over time for
    /// inputs of the system. Default: those that it carries.
    #[arg(long, value_name = "CSV")]
    setpoints: Option<PathBuf>,
    /// Connections, factors, offsets and roles (TOML). Default: outputs feed inputs of the same name.
    #[arg(long, value_name = "TOML")]
    connections: Option<PathBuf>,
    /// End of the run in seconds. Default: the end of the setpoints, the last of which holds as long as the
    /// longest before it, or else the plant's own default; of an SSP its own default.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Communication step in seconds. Default: 0.00025; of an SSP its own default.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    step: Option<f64>,
    /// Which FMU steps first.
    #[arg(long, value_enum, default_value_t = Order::Sequential)]
    order: Order,
    /// Folder for the results.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Records every n-th communication point; scoring still sees all.
    #[arg(long, value_name = "N", default_value_t = 1)]
    record: usize,
    /// Asks the FMUs for debug messages.
    #[arg(long)]
    log: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Order {
    /// The controller steps first, the plant with its fresh outputs: no delay. Of an SSP: who depends on others
    /// directly steps after them.
    Sequential,
    /// All step with what they knew at the communication point: one step of delay.
    SideBySide,
}

/// Log messages that are shown.
const SHOWN: usize = 20;

pub(super) fn run(arguments: Arguments) -> Result<(), Error> {
    let order = match arguments.order {
        Order::Sequential => host::Order::Sequential,
        Order::SideBySide => host::Order::SideBySide,
    };
    if let Some(package) = arguments.system {
        let simulation = SystemSimulation {
            variant: arguments.variant,
            parameters: arguments.parameters,
            assignments: arguments.assignments,
            inputs: arguments.setpoints,
            until: arguments.until,
            step: arguments.step,
            order,
            record_every: arguments.record,
            logging: arguments.log,
            ..SystemSimulation::new(package)
        };
        return super::system::run(&simulation, arguments.output.as_deref());
    }
    // The command line has both where it has no system.
    let [controller, plant] =
        [arguments.controller, arguments.plant].map(Option::unwrap_or_default);
    let simulation = Simulation {
        parameters: arguments.parameters,
        assignments: arguments.assignments,
        setpoints: arguments.setpoints.map(Setpoints::File),
        connections: arguments.connections,
        until: arguments.until,
        step: arguments.step.unwrap_or(host::run::DEFAULT_STEP),
        order,
        record_every: arguments.record,
        logging: arguments.log,
        ..Simulation::new(controller, plant)
    };
    let output = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    let mut progress = Progress::new();
    let outcome = simulate(&simulation, &mut |done| progress.tell(done));
    progress.finish();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(Error::Stopped { source, partial }) => {
            report_messages(&partial.summary.warnings, &partial.messages);
            if let Some(output) = output {
                let report = output.write(&partial)?;
                let _ = writeln!(io::stderr(), "partial report: {}", report.display());
            }
            return Err(Error::Stopped { source, partial });
        }
        Err(error) => return Err(error),
    };
    report_messages(&outcome.summary.warnings, &outcome.messages);
    if let Some(output) = output {
        let report = output.write(&outcome)?;
        let _ = writeln!(io::stderr(), "report: {}", report.display());
    }
    super::print(&format!("{}\n", outcome.summary.table()))
}

/// Warnings and log messages go to standard error; nothing can be done if that is closed.
pub(super) fn report_messages(warnings: &[String], messages: &[(impl Display, Message)]) {
    let mut stderr = io::stderr();
    for warning in warnings {
        let _ = writeln!(stderr, "warning: {warning}");
    }
    for (of, message) in messages.iter().take(SHOWN) {
        let _ = writeln!(stderr, "{of}: {}: {message}", message.status);
    }
    if messages.len() > SHOWN {
        let more = messages.len() - SHOWN;
        let _ = writeln!(
            stderr,
            "{more} more messages; log.txt in the folder of -o has them all"
        );
    }
}
