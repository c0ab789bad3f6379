//! Saved states of the plant.
#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::snapshot::go_on_from::<flexarm_plant::Plant>(bytes);
});
