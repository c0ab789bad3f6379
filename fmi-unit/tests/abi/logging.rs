//! Log switches and categories.

use crate::session::{BOTH, ERROR, Kind, OK, Options, Session};
use crate::toy::*;
use fmi_unit::{fmi2, fmi3};

/// Categories of what one step and one refused step write.
fn categories(s: &Session) -> Vec<String> {
    let t = s.get(TIME);
    s.messages.borrow_mut().clear();
    assert_eq!(s.set(U, f64::NAN), OK);
    assert_eq!(s.do_step(t, 0.1), OK);
    assert_eq!(s.do_step(t + 77.0, 0.1), ERROR);
    s.messages
        .borrow()
        .iter()
        .map(|m| m.category.clone())
        .collect()
}

#[test]
fn switches_select_categories() {
    const ALL: [&str; 3] = ["logStatusWarning", "logEvents", "logStatusError"];
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        assert_eq!(categories(&s), ALL);
        assert_eq!(s.set_debug_logging(true, &["logEvents"]), OK);
        assert_eq!(categories(&s), ["logEvents"]);
        assert_eq!(s.set_debug_logging(true, &[]), OK);
        assert_eq!(categories(&s), ALL);
        assert_eq!(s.set_debug_logging(false, &[]), OK);
        assert!(categories(&s).is_empty());
        assert_eq!(
            s.set_debug_logging(true, &["logStatusWarning", "logStatusError"]),
            OK
        );
        assert_eq!(categories(&s), ["logStatusWarning", "logStatusError"]);
        // The switches outlive a reset.
        assert_eq!(s.reset(), OK);
        s.initialize(0.0, None);
        assert_eq!(categories(&s), ["logStatusWarning", "logStatusError"]);
    }
}

#[test]
fn errors_go_out_unless_switched_off() {
    for version in BOTH {
        let options = Options {
            logging: false,
            ..Options::default()
        };
        let s = Session::with(version, Kind::CoSimulation, options);
        s.initialize(0.0, None);
        assert_eq!(categories(&s), ["logStatusError"]);
    }
}

#[test]
fn unknown_categories_are_errors_and_change_nothing() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        assert_eq!(s.set_debug_logging(true, &["logEvents"]), OK);
        assert_eq!(s.set_debug_logging(true, &["logEvents", "logAll"]), ERROR);
        assert_eq!(categories(&s), ["logEvents"]);
        assert_eq!(s.set_debug_logging(true, &[]), OK);
        assert_eq!(s.set_debug_logging(true, &["logAll"]), ERROR);
        s.assert_error(&["SetDebugLogging", "\"logAll\"", "logEvents"]);
    }
    let s = Session::new(BOTH[0], Kind::CoSimulation);
    let status = unsafe { fmi2::fmi2SetDebugLogging::<Toy>(s.handle, 1, 1, &std::ptr::null()) };
    assert_eq!(status, ERROR);
    let s = Session::new(BOTH[1], Kind::CoSimulation);
    let status = unsafe { fmi3::fmi3SetDebugLogging::<Toy>(s.handle, 1, 1, std::ptr::null()) };
    assert_eq!(status, ERROR);
}

/// Categories that the model does not declare cannot be asked for by name: they come with all.
#[test]
fn undeclared_categories_come_with_all() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        assert_eq!(s.set(U, f64::NEG_INFINITY), OK);
        let heard = |k: f64| {
            s.messages.borrow_mut().clear();
            assert_eq!(s.do_step(k * 0.1, 0.1), OK);
            s.messages
                .borrow()
                .iter()
                .any(|m| m.category == "undeclared")
        };
        assert!(heard(0.0));
        assert_eq!(s.set_debug_logging(true, &["logEvents"]), OK);
        assert!(!heard(1.0));
        assert_eq!(s.set_debug_logging(true, &[]), OK);
        assert!(heard(2.0));
        assert_eq!(s.set_debug_logging(false, &[]), OK);
        assert!(!heard(3.0));
    }
}
