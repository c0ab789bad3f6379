//! Serialized states of the plant.
#![no_main]

use flexarm_plant::Plant;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzz::snapshot::go_on_from::<Plant>(bytes));
