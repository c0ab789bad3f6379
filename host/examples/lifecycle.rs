//! Loads an FMU, makes and frees many instances of it one after the other, and unloads it: a subject for
//! memory checkers. With a second number the instances are reset and run again that often; further arguments
//! set start values. Says how many iterations the hardest plan took, so that a check knows what it covered.
//!
//!     cargo run --release -p flexarm-host --example lifecycle -- FlexArmPlant.fmu 100
//!     valgrind --leak-check=full target/release/examples/lifecycle FlexArmController.fmu 5 1 setpoint=1.4

use host::Error;
use host::fmu::{Causality, Experiment, Fmu, Instance, Scalar, Signals, Value};
use host::input::parameters::{Assignment, ParameterSets, StartValues};
use host::input::{Pair, Side};
use std::path::Path;
use std::process::ExitCode;

const STEP: f64 = 0.000_25;
const STEPS: u32 = 400;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else {
        eprintln!("usage: lifecycle FMU [INSTANCES [RESETS [NAME=VALUE ...]]]");
        return ExitCode::from(2);
    };
    let mut count = |default| {
        arguments
            .next()
            .and_then(|n| n.parse().ok())
            .unwrap_or(default)
    };
    let (instances, resets) = (count(100), count(0));
    let assignments: Result<Vec<Assignment>, _> = arguments.map(|a| a.parse()).collect();
    let outcome = assignments
        .map_err(Error::from)
        .and_then(|sets| run(Path::new(&file), instances, resets, &sets));
    match outcome {
        Ok(iterations) => {
            eprintln!("most iterations of a plan: {iterations}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(
    file: &Path,
    instances: usize,
    resets: usize,
    assignments: &[Assignment],
) -> Result<f64, Error> {
    let fmu = Fmu::open(file)?;
    let description = fmu.description();
    let pair = Pair {
        controller: description,
        plant: description,
    };
    let values =
        StartValues::new(pair, &ParameterSets::read(&[])?, assignments)?.of(Side::Controller);
    let mut most = 0.0f64;
    for _ in 0..instances {
        let mut instance = fmu.instantiate("lifecycle", false)?;
        most = most.max(experiment(&mut instance, &values)?);
        for _ in 0..resets {
            instance.reset()?;
            most = most.max(experiment(&mut instance, &values)?);
        }
    }
    Ok(most)
}

/// Returns the most iterations of a plan; 0 without a planner.
fn experiment(instance: &mut Instance, values: &[(Scalar, Value)]) -> Result<f64, Error> {
    instance.set_start_values(values)?;
    let iterations = instance.description().scalar("nmpc.iterations").ok();
    let outputs: Vec<_> = instance
        .description()
        .numeric_scalars(Causality::Output)
        .collect();
    let mut signals = Signals::new(instance.description(), &outputs);
    let iterations = outputs
        .iter()
        .position(|&output| Some(output) == iterations);
    let mut most = 0.0f64;
    let mut values = vec![0.0; outputs.len()];
    instance.enter_initialization(&Experiment::default())?;
    instance.exit_initialization()?;
    for k in 0..STEPS {
        instance.do_step(f64::from(k) * STEP, STEP)?;
        signals.read(instance, &mut values)?;
        most = most.max(iterations.map_or(0.0, |i| values[i]));
    }
    instance.terminate()?;
    Ok(most)
}
