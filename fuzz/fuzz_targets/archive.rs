//! FMUs as files.
#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    fuzz::readers::archive(bytes);
});
