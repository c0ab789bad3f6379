//! An FMU as a file: the archive and what is in it.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let file = fuzz::file("some.fmu", bytes);
    // A small limit: bombs are refused by their size, not by the patience of the fuzzer.
    let limits = host::fmu::Limits {
        total: 1 << 20,
        entry: 1 << 20,
        ..host::fmu::Limits::default()
    };
    fuzz::judge(host::fmu::Fmu::open_within(&file, &limits));
});
