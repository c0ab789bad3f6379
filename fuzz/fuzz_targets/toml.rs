//! Files of connections and of experiments.
#![no_main]

use host::experiment::Experiment;
use host::input::connections::Wiring;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let file = fuzz::file("some.toml", bytes);
    fuzz::judge(Wiring::read(fuzz::pair(), Some(&file)));
    fuzz::judge(Experiment::read(&file));
});
