//! Saved states of the plant, changed as scripts say.

use flexarm_plant::Plant;
use fuzz::snapshot::go_on_from;
use proptest::collection::vec;
use proptest::prelude::*;

#[test]
fn unchanged_states_are_accepted() {
    for base in 0..3 {
        assert!(go_on_from::<Plant>(&[base]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_script_is_survived(script in vec(any::<u8>(), 6..20)) {
        go_on_from::<Plant>(&script);
    }
}
