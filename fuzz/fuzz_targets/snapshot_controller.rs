//! Serialized states of the controller.
#![no_main]

use flexarm_controller::Controller;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| fuzz::snapshot::go_on_from::<Controller>(bytes));
