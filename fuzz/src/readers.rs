//! The readers of files; each target says whether anything came of the bytes.

use host::experiment::Experiment;
use host::fmu::{Fmu, Limits};
use host::input::connections::Wiring;
use host::input::measurement::{self, Options};
use host::input::parameters::{ParameterFile, ParameterSets, StartValues};
use host::input::setpoints::Table;
use host::ssp::{SystemSimulation, simulate_system};
use std::ops::ControlFlow;

use crate::{PARAMETERS, file, fmus, judge, pack, pair};

/// Bytes in an archive, and in an entry of it, at most.
const SMALL: u64 = 1 << 20;

/// An FMU as a file: the archive and what is in it.
pub fn archive(bytes: &[u8]) -> bool {
    let file = file("some.fmu", bytes);
    // A small limit: bombs are refused by their size, not by the patience of the fuzzer.
    let limits = Limits {
        total: SMALL,
        entry: SMALL,
        ..Limits::default()
    };
    judge(Fmu::open_within(&file, &limits)).is_some()
}

/// `modelDescription.xml` of FMI 2.0 and 3.0, and what follows from it.
pub fn description(bytes: &[u8]) -> bool {
    let file = file("some.fmu", &pack(&[("modelDescription.xml", bytes)]));
    let Some(fmu) = judge(Fmu::open(&file)) else {
        return false;
    };
    let description = fmu.description();
    for variable in &description.variables {
        let Ok(scalar) = description.scalar(&variable.name) else {
            continue;
        };
        assert_eq!(description.variable(scalar).name, variable.name);
        let _ = description.name_of(scalar);
        let _ = description.start(&variable.name);
        let _ = variable.range();
    }
    true
}

/// Parameter sets: SSV files for our pair of FMUs.
pub fn parameters(bytes: &[u8]) -> bool {
    let path = file("some.ssv", bytes);
    let files = [ParameterFile { side: None, path }];
    let values = ParameterSets::read(&files);
    let values = values.and_then(|sets| StartValues::new(pair(), &sets, &[]));
    let Some(values) = judge(values) else {
        return false;
    };
    for side in host::input::Side::BOTH {
        let _ = values.of(side);
    }
    true
}

/// System structures: an SSP with this description and FMUs without binaries, read and wired until the first of
/// them is to be instantiated.
pub fn structure(bytes: &[u8]) -> bool {
    let [controller, plant] = fmus();
    let package = pack(&[
        ("SystemStructure.ssd", bytes),
        ("resources/FlexArmController.fmu", controller),
        ("resources/FlexArmPlant.fmu", plant),
        ("resources/T-flex.csv", b"time,setpoint\n0,1.3\n1,1.2\n"),
        ("resources/T-flex-start.ssv", PARAMETERS),
    ]);
    let simulation = SystemSimulation::new(file("some.ssp", &package));
    let run = simulate_system(&simulation, &mut |_| ControlFlow::Continue(()));
    match run {
        Ok(_) => true,
        // As far as any structure comes.
        Err(error) if error.to_string().contains("no binary") => true,
        error => judge(error).is_some(),
    }
}

/// CSV files: setpoints and measurements.
pub fn table(bytes: &[u8]) -> bool {
    let file = file("some.csv", bytes);
    let table = judge(Table::read(&file, pair(), None));
    if let Some(table) = &table {
        let mut values = table.rows.iter().flat_map(|row| &row.values);
        assert!(values.all(|value| value.is_finite()));
        let _ = (table.duration(), table.first_change());
    }
    let measured = judge(measurement::read(&file, &Options::default()));
    if let Some((_, signals)) = &measured {
        let mut values = signals.angle.iter().chain(&signals.torque);
        assert!(values.all(|value| value.is_finite()));
    }
    table.is_some() || measured.is_some()
}

/// Files of connections and of experiments.
pub fn toml(bytes: &[u8]) -> bool {
    let file = file("some.toml", bytes);
    let wiring = judge(Wiring::read(pair(), Some(&file)));
    let experiment = judge(Experiment::read(&file));
    wiring.is_some() || experiment.is_some()
}
