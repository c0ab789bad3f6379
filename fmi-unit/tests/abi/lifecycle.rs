//! Instantiation, modes, failures and panics.

use std::cell::Cell;
use std::ffi::{c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use crate::session::{BOTH, ERROR, FATAL, Kind, OK, Options, Session, Version};
use crate::toy::*;
use fmi_unit::{fmi2, fmi3};

#[test]
fn a_run_in_both_versions() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.set(U, 1.0), OK);
        s.initialize(2.0, Some(3.0));
        for i in 0..10 {
            assert_eq!(
                s.do_step(2.0 + f64::from(i) * 0.1, 0.1),
                OK,
                "{:?}",
                s.messages
            );
        }
        assert_eq!(s.get_int(SAMPLES), 10);
        assert!((s.get(X) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
        assert!((s.get(TIME) - 3.0).abs() < 1e-12);
        assert_eq!(s.terminate(), OK);
        assert!(s.get(X) > 0.0);
        assert!(
            s.messages.borrow().iter().all(|m| m.status == OK),
            "{:?}",
            s.messages
        );
    }
}

#[test]
fn instantiation_is_refused_with_a_reason() {
    for version in BOTH {
        for (options, reason) in [
            (
                Options {
                    token: Some(c"{other}"),
                    ..Options::default()
                },
                "{other}, not {toy}",
            ),
            (
                Options {
                    token: None,
                    ..Options::default()
                },
                "null",
            ),
        ] {
            let s = Session::with(version, Kind::CoSimulation, options);
            assert!(s.handle.is_null());
            s.assert_error(&[reason]);
        }
        // The reason goes out although logging is off.
        let options = Options {
            token: None,
            logging: false,
            ..Options::default()
        };
        Session::with(version, Kind::CoSimulation, options).assert_error(&["token"]);
    }
}

#[test]
fn an_importer_may_do_without_a_logger() {
    for version in BOTH {
        let options = Options {
            logger: false,
            ..Options::default()
        };
        let s = Session::with(version, Kind::CoSimulation, options);
        s.initialize(0.0, None);
        assert_eq!(s.do_step(5.0, 0.1), ERROR);
    }
    let component =
        unsafe { fmi2::fmi2Instantiate::<Toy>(null(), 1, c"{toy}".as_ptr(), null(), null(), 0, 1) };
    assert!(!component.is_null());
    unsafe { fmi2::fmi2FreeInstance::<Toy>(component) };
    let kind =
        unsafe { fmi2::fmi2Instantiate::<Toy>(null(), 7, c"{toy}".as_ptr(), null(), null(), 0, 1) };
    assert!(kind.is_null());
}

#[test]
fn null_instances_are_errors() {
    for version in BOTH {
        let s = Session {
            version,
            handle: null_mut(),
            messages: Box::default(),
        };
        assert_eq!(s.do_step(0.0, 0.1), ERROR);
        assert_eq!(s.set(U, 0.0), ERROR);
        assert_eq!(s.reset(), ERROR);
        assert_eq!(s.restore(null_mut()), ERROR);
    }
}

#[test]
fn harmful_calls_are_refused_in_every_mode() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.do_step(0.0, 0.1), ERROR);
        s.assert_error(&["DoStep", "not allowed in Instantiated"]);
        assert_eq!(s.exit_initialization(), ERROR);
        assert_eq!(s.set_states(&[1.0]), ERROR);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        assert_eq!(s.do_step(0.0, 0.1), ERROR);
        s.assert_error(&["not allowed in Initialization Mode"]);
        assert_eq!(s.enter_initialization(0.0, None), ERROR);
        assert_eq!(s.exit_initialization(), OK);
        assert_eq!(s.exit_initialization(), ERROR);
        assert_eq!(s.enter_event_mode(), ERROR);
        assert_eq!(s.enter_continuous_time(), ERROR);
        assert_eq!(s.set_time(0.0), ERROR);
        assert_eq!(s.completed_step(), Err(ERROR));
        assert_eq!(s.update_discrete(), Err(ERROR));
        assert_eq!(s.get_derivatives(&mut [0.0]), ERROR);
        // None of this did any harm.
        assert_eq!(s.do_step(0.0, 0.1), OK);
        assert_eq!(s.terminate(), OK);
        assert_eq!(s.do_step(0.1, 0.1), ERROR);
        s.assert_error(&["not allowed in Terminated"]);
        assert_eq!(s.reset(), OK);
        s.initialize(0.0, None);
        assert_eq!(s.do_step(0.0, 0.1), OK);
    }
}

#[test]
fn harmless_calls_out_of_order_are_accepted_and_reported_once() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        for _ in 0..3 {
            assert_eq!(s.get(TAU), 1.0);
        }
        assert_eq!(s.messages.borrow().len(), 1);
        let message = s.last();
        assert_eq!(
            (message.status, message.category.as_str()),
            (1, "logStatusWarning")
        );
        assert!(
            message.text.contains("out of order in Instantiated"),
            "{message:?}"
        );
        assert_eq!(s.terminate(), OK);
        assert_eq!(s.terminate(), OK);
    }
}

#[test]
fn set_up_times_are_checked() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.enter_initialization(f64::NAN, None), ERROR);
        s.assert_error(&["start time"]);
        assert_eq!(s.enter_initialization(1.0, Some(0.5)), ERROR);
        s.assert_error(&["stop time = 0.5 s", "[1, inf] s"]);
        assert_eq!(s.enter_initialization(1.0, Some(f64::NAN)), ERROR);
        s.initialize(1.0, Some(1.0));
    }
}

#[test]
fn all_reasons_of_a_failed_set_up_are_logged_and_can_be_removed() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.set_int(SEED, 13), OK);
        let gains = if version == Version::Fmi2 {
            vec![GAIN, GAIN + 1, GAIN + 2]
        } else {
            vec![GAIN]
        };
        assert_eq!(
            s.set_reals(&gains, &[10.0, 0.0, 0.0]),
            OK,
            "{:?}",
            s.messages
        );
        assert_eq!(s.enter_initialization(0.0, None), OK);
        assert_eq!(s.exit_initialization(), ERROR);
        let errors = s
            .messages
            .borrow()
            .iter()
            .filter(|m| m.status == ERROR)
            .count();
        assert_eq!(errors, 2);
        assert_eq!(s.set_int(SEED, 14), OK);
        assert_eq!(s.set_reals(&gains, &[1.0, 0.0, 0.0]), OK);
        assert_eq!(s.exit_initialization(), OK);
    }
}

#[test]
fn reset_goes_back_to_the_start_values() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        let run = |u: f64| {
            assert_eq!(s.set(U, u), OK);
            s.initialize(0.0, None);
            assert_eq!(s.do_step(0.0, 1.0), OK);
            (s.get(X), s.get_int(SAMPLES))
        };
        let first = run(1.0);
        assert_eq!(s.set(TAU, 2.0), ERROR);
        assert_eq!(s.reset(), OK);
        assert_eq!(s.get(U), 0.0);
        assert_eq!(s.get(TIME), 0.0);
        assert_eq!(s.set(TAU, 2.0), OK);
        assert_ne!(run(1.0), first);
        assert_eq!(s.reset(), OK);
        assert_eq!(run(1.0), first);
    }
}

#[test]
fn a_failure_ends_the_simulation_until_reset_or_restore() {
    for version in BOTH {
        for behaviour in [FAIL_IN_EVENT, FAIL_IN_ADVANCE, STUCK] {
            let s = Session::new(version, Kind::CoSimulation);
            s.initialize(0.0, None);
            assert_eq!(s.do_step(0.0, 0.1), OK);
            let mut state = null_mut();
            assert_eq!(s.save(&mut state), OK);
            assert_eq!(s.set_enumeration(BEHAVIOUR, behaviour), OK);
            assert_eq!(s.do_step(0.1, 0.1), ERROR);
            s.assert_error(&["DoStep", "0.1 s"]);
            assert_eq!(s.do_step(0.1, 0.1), ERROR);
            s.assert_error(&["not allowed in the state after an error"]);
            assert_eq!(s.save(&mut state), ERROR);
            assert_eq!(s.restore(state), OK);
            assert_eq!(s.do_step(0.1, 0.1), OK);
            assert_eq!(s.get_int(SAMPLES), 2);
            assert_eq!(s.set_enumeration(BEHAVIOUR, behaviour), OK);
            assert_eq!(s.do_step(0.2, 0.1), ERROR);
            assert_eq!(s.free_state(&mut state), OK);
            assert_eq!(s.reset(), OK);
            s.initialize(0.0, None);
            assert_eq!(s.do_step(0.0, 0.1), OK);
        }
    }
}

#[test]
fn a_panic_is_fatal_for_the_instance_alone() {
    for version in BOTH {
        let (s, other) = (
            Session::new(version, Kind::CoSimulation),
            Session::new(version, Kind::CoSimulation),
        );
        s.initialize(0.0, None);
        other.initialize(0.0, None);
        assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_EVENT), OK);
        assert_eq!(s.do_step(0.0, 0.1), FATAL);
        let message = s.last();
        assert_eq!(
            (message.status, message.category.as_str()),
            (FATAL, "logStatusFatal")
        );
        assert!(
            message.text.contains("told to panic at 0 s, 100%s !"),
            "{message:?}"
        );
        // Poisoned: everything is fatal from now on, and nothing is looked at.
        assert_eq!(s.do_step(0.0, 0.1), FATAL);
        assert_eq!(s.reset(), FATAL);
        assert_eq!(s.set(U, 1.0), FATAL);
        assert_eq!(s.get_reals(&[U], &mut [0.0]), FATAL);
        assert_eq!(s.terminate(), FATAL);
        assert_eq!(other.do_step(0.0, 0.1), OK);
    }
}

/// What a logger that calls back sees.
#[derive(Default)]
struct CallsBack {
    handle: Cell<*mut c_void>,
    status: Cell<Option<c_int>>,
}

unsafe extern "C" fn call_back(
    environment: *mut c_void,
    status: c_int,
    _category: *const c_char,
    _message: *const c_char,
) {
    let own = unsafe { &*environment.cast::<CallsBack>() };
    if status == FATAL {
        let handle = own.handle.get();
        let status = unsafe { fmi3::fmi3Terminate::<Toy>(handle) };
        own.status.set(Some(status));
        if status == ERROR {
            unsafe { fmi3::fmi3FreeInstance::<Toy>(handle) };
        }
    }
}

/// The message of a panic uses the instance: until it is out, nobody may have it, not even to free it.
#[test]
fn an_instance_lives_while_its_panic_is_reported() {
    let own = CallsBack::default();
    let environment = (&raw const own).cast_mut().cast();
    let handle = unsafe {
        fmi3::fmi3InstantiateCoSimulation::<Toy>(
            c"toy".as_ptr(),
            c"{toy}".as_ptr(),
            null(),
            0,
            0,
            0,
            0,
            null(),
            0,
            environment,
            Some(call_back),
            None,
        )
    };
    own.handle.set(handle);
    let s = Session {
        version: Version::Fmi3,
        handle,
        messages: Box::default(),
    };
    s.initialize(0.0, None);
    assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_EVENT), OK);
    assert_eq!(s.do_step(0.0, 0.1), FATAL);
    assert_eq!(own.status.get(), Some(ERROR), "in use");
    assert_eq!(s.do_step(0.0, 0.1), FATAL, "poisoned, not freed");
}

#[test]
fn panics_are_caught_wherever_the_unit_runs() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_NEW), OK);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        assert_eq!(s.exit_initialization(), FATAL);

        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_OUTPUTS), OK);
        assert_eq!(s.get_reals(&[X], &mut [0.0]), FATAL);

        let s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_DROP), OK);
        s.initialize(0.0, None);
        assert_eq!(s.reset(), FATAL);

        let mut s = Session::new(version, Kind::CoSimulation);
        assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_DROP), OK);
        s.initialize(0.0, None);
        match version {
            Version::Fmi2 => unsafe { fmi2::fmi2FreeInstance::<Toy>(s.handle) },
            Version::Fmi3 => unsafe { fmi3::fmi3FreeInstance::<Toy>(s.handle) },
        }
        s.handle = null_mut();
        assert!(s.last().text.contains("told to panic in drop"));
    }
}

#[test]
fn instances_live_in_threads_of_their_own() {
    let results: Vec<_> = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..8)
            .map(|i| {
                scope.spawn(move || {
                    let s = Session::new(BOTH[i % 2], Kind::CoSimulation);
                    assert_eq!(s.set(U, 1.0), OK);
                    s.initialize(0.0, None);
                    for k in 0..1000 {
                        assert_eq!(s.do_step(f64::from(k) * 1e-3, 1e-3), OK);
                    }
                    s.get(X).to_bits()
                })
            })
            .collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    assert!(results.windows(2).all(|w| w[0] == w[1]), "{results:?}");
}
