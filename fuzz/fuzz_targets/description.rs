//! `modelDescription.xml` of FMI 2.0 and 3.0, and what follows from it.
#![no_main]

use host::fmu::Fmu;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let file = fuzz::file("some.fmu", &fuzz::pack(&[("modelDescription.xml", bytes)]));
    let Some(fmu) = fuzz::judge(Fmu::open(&file)) else {
        return;
    };
    let description = fmu.description();
    for variable in &description.variables {
        let Ok(scalar) = description.scalar(&variable.name) else {
            continue;
        };
        assert_eq!(description.variable(scalar).name, variable.name);
        let _ = (
            description.name_of(scalar),
            description.start(&variable.name),
        );
        let _ = variable.range();
    }
});
