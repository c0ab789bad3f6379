//! Saved states of the controller, changed as scripts say.

use flexarm_controller::Controller;
use fuzz::snapshot::go_on_from;
use proptest::collection::vec;
use proptest::prelude::*;

/// Found by libFuzzer: more samples measured than taken.
#[test]
fn a_measurement_after_the_last_sample_is_refused() {
    assert!(!go_on_from::<Controller>(&[167, 43, 91, 90, 37, 0, 255, 3]));
}

/// Found by libFuzzer: numbers whose squares are none.
#[test]
fn numbers_that_are_far_too_large_are_refused() {
    assert!(!go_on_from::<Controller>(&[28, 17, 43, 35, 17, 73, 93]));
}

#[test]
fn unchanged_states_are_accepted() {
    for base in 0..3 {
        assert!(go_on_from::<Controller>(&[base]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_script_is_survived(script in vec(any::<u8>(), 6..20)) {
        go_on_from::<Controller>(&script);
    }
}
