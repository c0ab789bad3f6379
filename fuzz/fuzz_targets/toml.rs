//! Connections and experiments.
#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::readers::toml(bytes);
});
