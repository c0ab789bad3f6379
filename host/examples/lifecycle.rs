//! Loads an FMU, makes and frees many instances of it one after the other, and unloads it: a subject for
//! memory checkers. With a second number the instances are reset and run again that often.
//!
//!     cargo run --release -p flexarm-host --example lifecycle -- FlexArmPlant.fmu 100
//!     valgrind --leak-check=full target/release/examples/lifecycle FlexArmPlant.fmu 5

use host::fmu::{Causality, Error, Experiment, Fmu, Instance, Signals};
use std::path::Path;
use std::process::ExitCode;

const STEP: f64 = 0.000_25;
const STEPS: u32 = 400;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(file) = arguments.next() else {
        eprintln!("usage: lifecycle FMU [INSTANCES [RESETS]]");
        return ExitCode::from(2);
    };
    let mut count = |default| {
        arguments
            .next()
            .and_then(|n| n.parse().ok())
            .unwrap_or(default)
    };
    let (instances, resets) = (count(100), count(0));
    match run(Path::new(&file), instances, resets) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(file: &Path, instances: usize, resets: usize) -> Result<(), Error> {
    let fmu = Fmu::open(file)?;
    for _ in 0..instances {
        let mut instance = fmu.instantiate("lifecycle", false)?;
        experiment(&mut instance)?;
        for _ in 0..resets {
            instance.reset()?;
            experiment(&mut instance)?;
        }
    }
    Ok(())
}

fn experiment(instance: &mut Instance) -> Result<(), Error> {
    let outputs: Vec<_> = instance
        .description()
        .numeric_scalars(Causality::Output)
        .collect();
    let mut signals = Signals::new(instance.description(), &outputs);
    let mut values = vec![0.0; outputs.len()];
    instance.enter_initialization(&Experiment::default())?;
    instance.exit_initialization()?;
    for k in 0..STEPS {
        instance.do_step(f64::from(k) * STEP, STEP)?;
        signals.read(instance, &mut values)?;
    }
    instance.terminate()
}
