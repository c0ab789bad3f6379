//! Every call in every mode: accepted, accepted with a warning, or refused with an error.

use std::ptr::null_mut;

use crate::session::{BOTH, ERROR, Kind, OK, Session, Version};
use crate::toy::*;
use fmi_unit::fmi2;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Instantiated,
    /// FMI 3.0 only.
    Configuration,
    Initialization,
    Step,
    Event,
    ContinuousTime,
    Terminated,
    Failed,
}
use Mode::*;
const MODES: [Mode; 8] = [
    Instantiated,
    Configuration,
    Initialization,
    Step,
    Event,
    ContinuousTime,
    Terminated,
    Failed,
];

fn arrive(version: Version, mode: Mode) -> Session {
    let kind = if matches!(mode, Event | ContinuousTime) {
        Kind::ModelExchange
    } else {
        Kind::CoSimulation
    };
    let s = Session::new(version, kind);
    match mode {
        Instantiated => return s,
        Configuration => {
            assert_eq!(s.enter_configuration(), OK);
            return s;
        }
        _ => {}
    }
    assert_eq!(s.enter_initialization(0.0, None), OK);
    if mode == Initialization {
        return s;
    }
    assert_eq!(s.exit_initialization(), OK);
    match mode {
        ContinuousTime => {
            s.update_discrete().unwrap();
            assert_eq!(s.enter_continuous_time(), OK);
        }
        Terminated => assert_eq!(s.terminate(), OK),
        Failed => {
            assert_eq!(s.set_enumeration(BEHAVIOUR, FAIL_IN_EVENT), OK);
            assert_eq!(s.do_step(0.0, 0.1), ERROR);
        }
        _ => {}
    }
    s.messages.borrow_mut().clear();
    s
}

type Call = fn(&Session) -> i32;

/// `+` accepted, `~` with a warning, `-` refused; the modes as in [`MODES`].
const EXPECTED: [(&str, Call, &str); 23] = [
    (
        "SetDebugLogging",
        |s| s.set_debug_logging(true, &[]),
        "++++++++",
    ),
    (
        "ExitInitialization",
        Session::exit_initialization,
        "--+-----",
    ),
    ("Terminate", Session::terminate, "~-~+++~~"),
    ("Reset", Session::reset, "++++++++"),
    ("Get", |s| s.get_reals(&[X], &mut [0.0]), "~~++++++"),
    ("Set", |s| s.set(U, 1.0), "+-++++~-"),
    ("GetFMUState", get_state, "+++++++-"),
    ("SetFMUState", set_state, "++++++++"),
    ("EnterEventMode", Session::enter_event_mode, "----~+--"),
    (
        "EnterContinuousTime",
        Session::enter_continuous_time,
        "----+~--",
    ),
    (
        "UpdateDiscrete",
        |s| s.update_discrete().map_or_else(|e| e, |_| OK),
        "----+---",
    ),
    (
        "CompletedStep",
        |s| s.completed_step().map_or_else(|e| e, |_| OK),
        "----~+--",
    ),
    ("SetContinuousStates", |s| s.set_states(&[0.0]), "----~+--"),
    (
        "GetContinuousStates",
        |s| s.get_states(&mut [0.0]),
        "~-+-++~-",
    ),
    (
        "GetDerivatives",
        |s| s.get_derivatives(&mut [0.0]),
        "~-+-++~-",
    ),
    ("DoStep", |s| s.do_step(0.0, 0.1), "---+----"),
    (
        "SetTime, FMI 2.0",
        |s| only(Version::Fmi2, s, |s| s.set_time(0.0)),
        "~-~-++--",
    ),
    (
        "SetTime, FMI 3.0",
        |s| only(Version::Fmi3, s, |s| s.set_time(0.0)),
        "~-~-~+--",
    ),
    ("SetupExperiment", setup_experiment, "+-~-----"),
    ("EnterInitialization", enter_initialization, "+-------"),
    (
        "EnterConfiguration",
        |s| only(Version::Fmi3, s, Session::enter_configuration),
        "+-------",
    ),
    (
        "ExitConfiguration",
        |s| only(Version::Fmi3, s, Session::exit_configuration),
        "-+------",
    ),
    (
        "SetUInt64",
        |s| only(Version::Fmi3, s, |s| s.set_size(SIZE, 3)),
        "-+------",
    ),
];

/// The call or its row is the other version's.
const SKIP: i32 = -1;

/// A call of one version.
fn only(version: Version, s: &Session, call: Call) -> i32 {
    if s.version == version { call(s) } else { SKIP }
}

/// FMI 2.0 has this call too, but tells the start time by another.
fn enter_initialization(s: &Session) -> i32 {
    only(Version::Fmi3, s, |s| s.enter_initialization(0.0, None))
}

fn setup_experiment(s: &Session) -> i32 {
    only(Version::Fmi2, s, |s| unsafe {
        fmi2::fmi2SetupExperiment::<Toy>(s.handle, 0, 0.0, 0.0, 0, 0.0)
    })
}

fn get_state(s: &Session) -> i32 {
    let mut state = null_mut();
    let status = s.save(&mut state);
    assert_eq!(s.free_state(&mut state), OK);
    status
}

/// With a state of an instance of the same kind.
fn set_state(s: &Session) -> i32 {
    [Kind::CoSimulation, Kind::ModelExchange]
        .into_iter()
        .map(|kind| {
            let mut state = null_mut();
            assert_eq!(Session::new(s.version, kind).save(&mut state), OK);
            let status = s.restore(state);
            assert_eq!(s.free_state(&mut state), OK);
            s.messages.borrow_mut().clear();
            status
        })
        .min()
        .unwrap()
}

#[test]
fn every_call_in_every_mode() {
    for version in BOTH {
        for (name, call, expected) in EXPECTED {
            assert_eq!(expected.len(), MODES.len());
            for (mode, expected) in MODES.into_iter().zip(expected.chars()) {
                if (version, mode) == (Version::Fmi2, Configuration) {
                    continue;
                }
                let s = arrive(version, mode);
                let status = call(&s);
                let messages = s.messages.borrow();
                let statuses: Vec<_> = messages
                    .iter()
                    .map(|m| m.status)
                    .filter(|&m| m != OK)
                    .collect();
                let found = match (status, &statuses[..]) {
                    (SKIP, _) => continue,
                    (OK, []) => '+',
                    (OK, [1]) => '~',
                    (ERROR, [.., ERROR]) => '-',
                    _ => '?',
                };
                assert_eq!(
                    found, expected,
                    "{name} in {mode:?}, {version:?}: {messages:?}"
                );
            }
        }
    }
}
