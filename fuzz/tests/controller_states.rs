//! Saved states of the controller, changed as scripts say.

use flexarm_controller::Controller;
use fuzz::snapshot::{SAMPLES, go_on_from};
use proptest::collection::vec;
use proptest::prelude::*;

#[test]
fn unchanged_states_go_on() {
    for base in 0..3 {
        assert_eq!(
            go_on_from::<Controller>(&[base]),
            Some(SAMPLES),
            "state {base}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_script_is_survived(script in vec(any::<u8>(), 6..20)) {
        go_on_from::<Controller>(&script);
    }
}
