//! The packaged FMUs: one step through the C interface, instantiation, sizes, the whole demo.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use host::Simulation;
use host::fmu::{Experiment, Fmu, Instance, Scalar, Signals, Value};
use host::input::setpoints::Setpoints;

use crate::Failure;
use crate::statistics::{Durations, text, time};

const SAMPLE: f64 = 0.000_25;
const STEPS: u32 = 39_900;
const BATCH: u32 = 100;

/// Prints what the FMUs in `dist/` cost.
pub fn run(root: &Path) -> Result<(), Failure> {
    for version in ["fmi2", "fmi3"] {
        let fmu = Fmu::open(&root.join(format!("dist/{version}/FlexArmController.fmu")))?;
        println!(
            "  through the C ABI of {version}       {}",
            steps(&fmu)?.row()
        );
    }
    println!("\nInstantiate, initialise, free           median        p99        max");
    for version in ["fmi2", "fmi3"] {
        for unit in ["FlexArmPlant", "FlexArmController"] {
            let fmu = Fmu::open(&root.join(format!("dist/{version}/{unit}.fmu")))?;
            println!(
                "  {:<32} {}",
                format!("{version} {unit}"),
                lives(&fmu)?.row()
            );
        }
    }
    println!("\nSizes                                   binary        FMU");
    for unit in ["FlexArmPlant", "FlexArmController"] {
        let path = root.join(format!("dist/fmi3/{unit}.fmu"));
        let fmu = Fmu::open(&path)?;
        let binary = fmu
            .folder()
            .join(format!("binaries/x86_64-linux/{unit}.so"));
        let size = |path: &Path| Ok::<_, Failure>(std::fs::metadata(path)?.len() / 1024);
        println!(
            "  {unit:<32} {:>8} kB {:>8} kB",
            size(&binary)?,
            size(&path)?
        );
    }
    demo(root)
}

fn scalar(fmu: &Fmu, name: &str) -> Result<Scalar, Failure> {
    let found = fmu.description().scalar(name);
    Ok(found.map_err(|_| format!("{} has no variable {name}", fmu.file().display()))?)
}

fn initialised(fmu: &Fmu, values: &[(&str, Value)]) -> Result<Instance, Failure> {
    let mut instance = fmu.instantiate("bench", false)?;
    let mut set = Vec::new();
    for (name, value) in values {
        set.push((scalar(fmu, name)?, value.clone()));
    }
    instance.set_start_values(&set)?;
    instance.enter_initialization(&Experiment::default())?;
    instance.exit_initialization()?;
    Ok(instance)
}

/// Set the angle, step, get the torque; plans are 10 s apart.
fn steps(fmu: &Fmu) -> Result<Durations, Failure> {
    let values = [
        ("nmpc.period", Value::Float(10.0)),
        ("nmpc.models_feedback", Value::Boolean(false)),
        ("setpoint", Value::Float(1.3)),
        ("angle", Value::Float(1.3)),
    ];
    let mut instance = initialised(fmu, &values)?;
    let mut angle = Signals::new(fmu.description(), &[scalar(fmu, "angle")?]);
    let mut torque = Signals::new(fmu.description(), &[scalar(fmu, "torque")?]);
    let mut number = [1.3];
    instance.do_step(0.0, SAMPLE)?;
    let mut durations = Vec::new();
    for batch in 0..STEPS / BATCH {
        let (duration, result) = time(|| -> Result<(), Failure> {
            for sample in 0..BATCH {
                let step = 1 + batch * BATCH + sample;
                number[0] = 1.3 + 1e-7 * f64::from(step % 97);
                angle.write(&mut instance, &number)?;
                instance.do_step(f64::from(step) * SAMPLE, SAMPLE)?;
                torque.read(&mut instance, &mut number)?;
            }
            Ok(())
        });
        result?;
        durations.push(duration / BATCH);
    }
    Ok(Durations::new(durations))
}

fn lives(fmu: &Fmu) -> Result<Durations, Failure> {
    drop(initialised(fmu, &[])?);
    let mut durations = Vec::new();
    for _ in 0..50 {
        let (duration, instance) = time(|| initialised(fmu, &[]).map(drop));
        instance?;
        durations.push(duration);
    }
    Ok(Durations::new(durations))
}

/// 20 s of the T-flex demo, without report.
fn demo(root: &Path) -> Result<(), Failure> {
    let simulation = Simulation {
        setpoints: Some(Setpoints::File(
            root.join("packaging/assets/tflex-setpoints.csv"),
        )),
        until: Some(20.0),
        ..Simulation::new(
            root.join("dist/fmi3/FlexArmController.fmu"),
            root.join("dist/fmi3/FlexArmPlant.fmu"),
        )
    };
    let (duration, outcome) =
        time(|| host::simulate(&simulation, &mut |_| ControlFlow::Continue(())));
    let timing = outcome?.summary.timing;
    let wall = Duration::from_secs_f64(timing.wall_s);
    println!(
        "\nDemo, 20 s of T-flex setpoints: {} with set-up, {} without, {:.0} x real time",
        text(duration),
        text(wall),
        timing.real_time_factor
    );
    Ok(())
}
