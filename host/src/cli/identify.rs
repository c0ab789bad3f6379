//! `flexarm identify`.

use super::progress::Progress;
use clap::{Args, ValueEnum};
use host::Error;
use host::identify::{Experiment, Failed, Files, Identified, Summary, from_files, from_plant};
use host::input;
use host::input::measurement::Options;
use host::input::parameters::{Assignment, ParameterFile};
use host::output::OutputFolder;
use identification::regression::Order as FilterOrder;
use identification::{Settings, Timing};
use std::io::{self, Write};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  From a measurement, judged by another one:
    flexarm identify --measurement slow.csv --validation fast.csv -o out/
    flexarm simulate --parameters controller=out/identified.ssv ...
  A current instead of a torque, degrees instead of rad, other headers:
    flexarm identify --measurement log.csv --torque-constant 5.57 --angle-unit deg \\
      --column angle=Encoder1 --column current=Iq
  From experiments on a plant FMU, which our controller makes, within the limits that the plant has:
    flexarm identify --plant FlexArmPlant.fmu --controller FlexArmController.fmu -o out/
  A vendor's plant with other names, whose angle is to stay between two values, and a rough idea of its inertia for the first feedback:
    flexarm identify --plant Vendor.fmu --controller FlexArmController.fmu --connections vendor.toml \\
      --set feedback.inertia=0.5 --set profile.max_acceleration=20 --lower -0.4 --upper 0.4 -o out/

Measurements are CSV with one row a sample, the columns named in the header: time [s], angle [rad], torque [N.m] or
current [A] (with --torque-constant), and if there are any reference [rad], feedforward_torque and feedback_torque [N.m], from which margins
for the planner are proposed. The paper takes 100 s at 4 kHz with a new random setpoint every 1.5 s. results.csv of
flexarm simulate will do. Where samples are missing the measurement is cut.

Experiments on a plant: 30 s on feedback alone in the middle half of the range, eight moves that show the overshoot,
then --duration with a setpoint every --interval for the parameters. Then as long with one every --validation-interval,
once on feedback alone and once with the identified feedforward, to judge them. Parameters and assignments are as for
flexarm simulate; the controller's model of the arm starts empty unless they say otherwise.
The angle stays in [--lower, --upper]. Setpoints lie inside by the overshoot that the experiment before showed; where
the arm leaves the range all the same, the experiment stops there and is repeated further inside, at most five times.
An experiment that fails, or that Ctrl-C ends, leaves what it recorded as EXPERIMENT-partial.csv in the folder of -o.

The folder of -o gets identified.ssv (for --parameters), identification.json (all numbers) and report.html.";

/// Options that say how a measurement is read, and mean nothing to experiments.
const OF_MEASUREMENTS: [&str; 5] = [
    "validation",
    "torque_constant",
    "angle_unit",
    "torque_timing",
    "columns",
];

/// Options that mean nothing beside a measurement.
const OF_EXPERIMENTS: [&str; 12] = [
    "plant",
    "controller",
    "lower",
    "upper",
    "parameters",
    "assignments",
    "connections",
    "duration",
    "interval",
    "validation_interval",
    "seed",
    "step",
];

/// Finds the parameters of an arm from measurements, or from experiments on a plant.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// Measured angle and torque (CSV).
    #[arg(long, value_name = "CSV", required_unless_present = "plant", conflicts_with_all = OF_EXPERIMENTS)]
    measurement: Option<PathBuf>,
    /// Another measurement to judge the parameters by (CSV).
    #[arg(long, value_name = "CSV")]
    validation: Option<PathBuf>,
    /// Torque constant in N.m/A, for measurements with a current.
    #[arg(long, value_name = "N.m/A", allow_negative_numbers = true)]
    torque_constant: Option<f64>,
    /// Unit of angle and reference in measurements.
    #[arg(long, value_enum, default_value_t = AngleUnit::Rad)]
    angle_unit: AngleUnit,
    /// When the torque of a row acts.
    #[arg(long, value_enum, default_value_t = TorqueTiming::Held)]
    torque_timing: TorqueTiming,
    /// Header of a column that is called differently: NAME=HEADER.
    #[arg(long = "column", value_name = "NAME=HEADER", value_parser = column)]
    columns: Vec<(String, String)>,
    /// FMU of a plant to make experiments on.
    #[arg(long, value_name = "FMU", requires = "controller", conflicts_with_all = OF_MEASUREMENTS)]
    plant: Option<PathBuf>,
    /// FMU of our controller, which moves the plant.
    #[arg(long, value_name = "FMU")]
    controller: Option<PathBuf>,
    /// Angle in rad that no experiment goes below, overshoot included. Default: the plant's limits.angle_lower.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    lower: Option<f64>,
    /// Angle in rad that no experiment goes above, overshoot included. Default: the plant's limits.angle_upper.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true)]
    upper: Option<f64>,
    /// Parameter file (SSV) for the FMUs of experiments, or for one: controller=X.ssv, plant=X.ssv. Later ones win.
    #[arg(long, value_name = "[SIDE=]SSV")]
    parameters: Vec<ParameterFile>,
    /// Single value, after the files: NAME=VALUE, controller:NAME=VALUE, plant:NAME=VALUE.
    #[arg(long = "set", value_name = "[SIDE:]NAME=VALUE")]
    assignments: Vec<Assignment>,
    /// Connections, factors, offsets and roles (TOML), as for flexarm simulate.
    #[arg(long, value_name = "TOML")]
    connections: Option<PathBuf>,
    /// Duration in seconds of the experiment for the parameters, and of each of those that judge them.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 100.0,
        allow_negative_numbers = true
    )]
    duration: f64,
    /// How long a setpoint holds in seconds.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 1.5,
        allow_negative_numbers = true
    )]
    interval: f64,
    /// How long a setpoint holds in seconds when the parameters are judged, with feedforward and without.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.66,
        allow_negative_numbers = true
    )]
    validation_interval: f64,
    /// Seed of the random setpoints.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Communication step in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = host::run::DEFAULT_STEP, allow_negative_numbers = true)]
    step: f64,
    /// Number of cogging harmonics, 0 to 9. Default: by cross-validation.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=9))]
    harmonics: Option<u8>,
    /// Where the cogging frequency is searched, in 1/rad.
    #[arg(long, value_names = ["LOWEST", "HIGHEST"], num_args = 2)]
    frequency_range: Vec<f64>,
    /// Taps of the filter. Default: as many as last 25 ms, 101 at 4 kHz.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_001))]
    filter_taps: Option<u32>,
    /// What is filtered.
    #[arg(long, value_enum, default_value_t = Filtered::Regressors)]
    filtered: Filtered,
    /// Folder for the results.
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Writes the measured signals too, as excitation.csv, validation.csv and feedback-alone.csv (about 40 MB each for 100 s).
    #[arg(long, requires = "output")]
    save_measurements: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum AngleUnit {
    /// Radians.
    Rad,
    /// Degrees.
    Deg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TorqueTiming {
    /// From its row until the next one, as a sampled controller asks for it.
    Held,
    /// At the time of its row, as a sensor measures it.
    Sampled,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Filtered {
    /// Every regressor, computed from the angle as measured: unbiased.
    Regressors,
    /// Angle and torque, from which regressors are then computed: as the paper does.
    Signals,
}

fn column(text: &str) -> Result<(String, String), String> {
    let (name, header) = text.split_once('=').ok_or("must be NAME=HEADER")?;
    Ok((name.trim().to_owned(), header.trim().to_owned()))
}

pub(super) fn run(arguments: Arguments) -> Result<(), Error> {
    let settings = settings(&arguments)?;
    let output = arguments
        .output
        .as_deref()
        .map(OutputFolder::prepare)
        .transpose()?;
    let identified = match &arguments.plant {
        None => from_files(
            &files(&arguments),
            &settings,
            arguments.filter_taps.is_some(),
        ),
        Some(plant) => match experiments(&arguments, plant, &settings) {
            Ok(identified) => Ok(identified),
            Err(failed) => return Err(keep(failed, output)),
        },
    }?;
    let summary = Summary::new(&identified);
    let mut stderr = io::stderr();
    for warning in &summary.warnings {
        let _ = writeln!(stderr, "warning: {warning}");
    }
    if let Some(output) = output {
        let report =
            output.write_identification(&identified, &summary, arguments.save_measurements)?;
        let _ = writeln!(stderr, "report: {}", report.display());
    }
    super::print(&format!("{}\n", summary.table()))
}

fn settings(arguments: &Arguments) -> Result<Settings, Error> {
    let frequency_range = match arguments.frequency_range[..] {
        [lowest, highest] if 0.0 < lowest && lowest < highest && highest.is_finite() => {
            Some([lowest, highest])
        }
        [lowest, highest] => {
            return Err(Error::Input(input::Error::Setting {
                name: "--frequency-range".to_owned(),
                value: format!("{lowest} {highest}"),
                expected: "two positive numbers in 1/rad, the lower one first".to_owned(),
            }));
        }
        _ => None,
    };
    if frequency_range.is_some() && arguments.harmonics == Some(0) {
        return Err(Error::Input(input::Error::Setting {
            name: "--harmonics".to_owned(),
            value: "0".to_owned(),
            expected: "at least 1 with --frequency-range: without harmonics there is no frequency to search".to_owned(),
        }));
    }
    let mut settings = Settings {
        order: match arguments.filtered {
            Filtered::Regressors => FilterOrder::Regressors,
            Filtered::Signals => FilterOrder::Signals,
        },
        harmonics: arguments.harmonics.map(usize::from),
        frequency_range,
        ..Settings::default()
    };
    if let Some(taps) = arguments.filter_taps {
        settings.taps = taps as usize;
    }
    Ok(settings)
}

fn files(arguments: &Arguments) -> Files {
    Files {
        measurement: arguments.measurement.clone().unwrap_or_default(),
        validation: arguments.validation.clone(),
        options: Options {
            torque_constant: arguments.torque_constant,
            degrees: arguments.angle_unit == AngleUnit::Deg,
            timing: match arguments.torque_timing {
                TorqueTiming::Held => Timing::Held,
                TorqueTiming::Sampled => Timing::Sampled,
            },
            columns: arguments.columns.clone(),
        },
    }
}

fn experiments(
    arguments: &Arguments,
    plant: &PathBuf,
    settings: &Settings,
) -> Result<Identified, Failed> {
    // The command line demands one with a plant.
    let controller = arguments.controller.clone().unwrap_or_default();
    let experiment = Experiment {
        parameters: arguments.parameters.clone(),
        assignments: arguments.assignments.clone(),
        connections: arguments.connections.clone(),
        step: arguments.step,
        lower: arguments.lower,
        upper: arguments.upper,
        duration: arguments.duration,
        interval: arguments.interval,
        validation_interval: arguments.validation_interval,
        seed: arguments.seed,
        ..Experiment::new(controller, plant)
    };
    let mut progress = Progress::new();
    let taps_given = arguments.filter_taps.is_some();
    let result = from_plant(&experiment, settings, taps_given, &mut |done| {
        progress.tell(done)
    });
    progress.finish();
    result
}

/// Saves what was recorded before an experiment failed.
fn keep(failed: Failed, output: Option<OutputFolder>) -> Error {
    if let (Some(partial), Some(output)) = (failed.partial, output) {
        let (experiment, signals) = *partial;
        let until = signals.time.last().copied().unwrap_or(0.0);
        let _ = match output.write_partial(experiment, &signals, &failed.error) {
            Ok(path) => writeln!(
                io::stderr(),
                "the {} stopped at t = {until} s; what it recorded is in {}",
                experiment.name(),
                path.display()
            ),
            Err(error) => writeln!(io::stderr(), "warning: {error}"),
        };
    }
    *failed.error
}
