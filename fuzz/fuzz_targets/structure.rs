//! System structures: an SSP with this description and FMUs without binaries, read and wired until the first of
//! them is to be instantiated.
#![no_main]

use host::ssp::{SystemSimulation, simulate_system};
use libfuzzer_sys::fuzz_target;
use std::ops::ControlFlow;

fuzz_target!(|bytes: &[u8]| {
    let [controller, plant] = fuzz::fmus();
    let package = fuzz::pack(&[
        ("SystemStructure.ssd", bytes),
        ("resources/FlexArmController.fmu", controller),
        ("resources/FlexArmPlant.fmu", plant),
        ("resources/T-flex.csv", b"time,setpoint\n0,1.3\n1,1.2\n"),
        ("resources/T-flex-start.ssv", fuzz::PARAMETERS),
    ]);
    let simulation = SystemSimulation::new(fuzz::file("some.ssp", &package));
    let run = simulate_system(&simulation, &mut |_| ControlFlow::Continue(()));
    fuzz::judge(run);
});
