//! Parameter sets: SSV files for our pair of FMUs.
#![no_main]

use host::input::parameters::{ParameterFile, ParameterSets, StartValues};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let path = fuzz::file("some.ssv", bytes);
    let files = [ParameterFile { side: None, path }];
    if let Some(values) = fuzz::judge(
        ParameterSets::read(&files).and_then(|sets| StartValues::new(fuzz::pair(), &sets, &[])),
    ) {
        for side in host::input::Side::BOTH {
            let _ = values.of(side);
        }
    }
});
