//! Co-Simulation: communication points, events inside steps, early return.

use std::cell::RefCell;
use std::ffi::c_void;
use std::ptr::null_mut;

use crate::session::{BOTH, ERROR, FATAL, Kind, OK, Options, Session, Version};
use crate::toy::*;
use fmi_unit::{fmi2, fmi3};

/// A run of `steps` steps; the step's start as the master computes it.
fn samples(version: Version, period: f64, h: f64, start: f64, steps: u32, summed: bool) -> i32 {
    let s = Session::new(version, Kind::CoSimulation);
    assert_eq!(s.set(PERIOD, period), OK);
    assert_eq!(s.set_debug_logging(false, &[]), OK);
    s.initialize(start, Some(start + f64::from(steps) * h));
    let mut t = start;
    for k in 0..steps {
        assert_eq!(s.do_step(t, h), OK, "step {k} from {t}");
        t = if summed {
            t + h
        } else {
            start + f64::from(k + 1) * h
        };
    }
    s.get_int(SAMPLES)
}

#[test]
fn a_million_steps_neither_drift_nor_fail() {
    for version in BOTH {
        for summed in [true, false] {
            // One sample a step, whether or not the master's time rounds up or down.
            assert_eq!(
                samples(version, 1e-4, 1e-4, 0.0, 1_000_000, summed),
                1_000_000
            );
        }
    }
    let sixtieth = 1.0 / 60.0;
    assert_eq!(
        samples(Version::Fmi3, sixtieth, sixtieth, 0.0, 1_000_000, true),
        1_000_000
    );
    assert_eq!(
        samples(Version::Fmi2, sixtieth, sixtieth, 100.0, 1_000_000, true),
        1_000_000
    );
    assert_eq!(
        samples(Version::Fmi2, 1e-4, 1e-4, -7.3, 1_000_000, true),
        1_000_000
    );
}

#[test]
fn steps_need_not_be_multiples_of_the_period() {
    for (period, h, steps) in [
        (0.1, 0.03, 1000),
        (0.1, 0.7, 100),
        (0.1, 1e-3, 5000),
        (0.3, 0.1, 999),
    ] {
        for start in [0.0, 12.5] {
            let end = f64::from(steps) * h;
            let expected = (end / period - 1e-6).ceil() as i32;
            for summed in [true, false] {
                assert_eq!(
                    samples(Version::Fmi3, period, h, start, steps, summed),
                    expected
                );
            }
        }
    }
}

#[test]
fn the_result_does_not_depend_on_the_steps() {
    let run = |h: f64, n: u32| {
        let s = Session::new(Version::Fmi3, Kind::CoSimulation);
        assert_eq!(s.set(U, 1.0), OK);
        assert_eq!(s.set(BIAS, 3.0), OK);
        s.initialize(0.0, None);
        for k in 0..n {
            assert_eq!(s.do_step(f64::from(k) * h, h), OK);
        }
        s.get(X)
    };
    let exact = 1.0 + 2.0 * (-2.0_f64).exp();
    for (h, n) in [(2.0, 1), (0.1, 20), (0.025, 80), (0.004, 500)] {
        assert!((run(h, n) - exact).abs() < 1e-12);
    }
}

#[test]
fn communication_points_must_follow_each_other() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(1.0, None);
        assert_eq!(s.do_step(0.0, 0.1), ERROR);
        s.assert_error(&["from 0 s", "ended at 1 s"]);
        assert_eq!(s.do_step(1.0, 0.1), OK);
        assert_eq!(s.do_step(1.0, 0.1), ERROR);
        assert_eq!(s.do_step(1.2, 0.1), ERROR);
        for (t, h) in [
            (1.1, 0.0),
            (1.1, -0.1),
            (1.1, f64::NAN),
            (1.1, f64::INFINITY),
            (f64::NAN, 0.1),
            (f64::INFINITY, 0.1),
        ] {
            assert_eq!(s.do_step(t, h), ERROR, "{t} {h}");
        }
        // Rounding, of nanoseconds say, is no reason to stop.
        assert_eq!(s.do_step(1.1 + 3e-9, 0.1), OK);
    }
}

#[test]
fn the_stop_time_binds_up_to_rounding() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, Some(0.3));
        assert_eq!(s.do_step(0.0, 0.1), OK);
        assert_eq!(s.do_step(0.1, 0.1), OK);
        assert_eq!(s.do_step(0.2, 0.15), ERROR);
        s.assert_error(&["stop time 0.3 s"]);
        assert_eq!(s.do_step(0.2, 0.1 + 1e-12), OK);
        assert_eq!(s.do_step(0.3, 0.1), ERROR);
    }
}

#[test]
fn inquiries_after_a_step() {
    use crate::session::DISCARD;
    let s = Session::new(Version::Fmi2, Kind::CoSimulation);
    s.initialize(0.0, None);
    assert_eq!(s.do_step(0.0, 0.1), OK);
    let (mut status, mut real, mut integer, mut boolean) = (7, 0.0, 0, 7);
    let mut string = std::ptr::null();
    unsafe {
        assert_eq!(fmi2::fmi2GetStatus::<Toy>(s.handle, 0, &mut status), OK);
        assert_eq!(fmi2::fmi2GetRealStatus::<Toy>(s.handle, 2, &mut real), OK);
        assert_eq!(
            fmi2::fmi2GetBooleanStatus::<Toy>(s.handle, 3, &mut boolean),
            OK
        );
        assert_eq!((status, real, boolean), (OK, 0.1, 0));
        assert_eq!(
            fmi2::fmi2GetIntegerStatus::<Toy>(s.handle, 0, &mut integer),
            DISCARD
        );
        assert_eq!(
            fmi2::fmi2GetStringStatus::<Toy>(s.handle, 1, &mut string),
            DISCARD
        );
        assert_eq!(
            fmi2::fmi2GetRealStatus::<Toy>(s.handle, 99, &mut real),
            DISCARD
        );
        assert_eq!(
            fmi2::fmi2GetRealStatus::<Toy>(s.handle, 2, null_mut()),
            ERROR
        );
        assert_eq!(fmi2::fmi2CancelStep::<Toy>(s.handle), ERROR);
        assert_eq!(s.set_enumeration(BEHAVIOUR, FAIL_IN_EVENT), OK);
        assert_eq!(s.do_step(0.1, 0.1), ERROR);
        assert_eq!(fmi2::fmi2GetStatus::<Toy>(s.handle, 0, &mut status), OK);
    }
    assert_eq!(status, ERROR);
}

/// What the importer does in its intermediate updates.
#[derive(Default)]
struct Visits {
    handle: RefCell<*mut c_void>,
    /// Time, samples, early return allowed.
    seen: RefCell<Vec<(f64, f64, i32, bool)>>,
    /// Return early at the visit with this number, to end at this time.
    end: Option<(usize, f64)>,
    /// What else to try: calls that are forbidden here.
    misuse: bool,
    /// Set the unit to panic when it makes its outputs.
    panic: bool,
}

unsafe extern "C" fn visit(
    environment: *mut c_void,
    time: f64,
    set: u8,
    get: u8,
    finished: u8,
    can_return_early: u8,
    requested: *mut u8,
    end: *mut f64,
) {
    let visits = unsafe { &*environment.cast::<Visits>() };
    let handle = *visits.handle.borrow();
    assert_eq!((set, get, finished), (0, 1, 1));
    let (mut t, mut samples) = (0.0, -1);
    let status = unsafe { fmi3::fmi3GetFloat64::<Toy>(handle, &TIME, 1, &mut t, 1) };
    assert_eq!(status, OK);
    let status = unsafe { fmi3::fmi3GetInt32::<Toy>(handle, &SAMPLES, 1, &mut samples, 1) };
    assert_eq!(status, if visits.panic { FATAL } else { OK });
    let mut seen = visits.seen.borrow_mut();
    if let Some((number, time)) = visits.end
        && number == seen.len()
    {
        unsafe {
            *requested = 1;
            *end = time;
        }
    }
    seen.push((time, t, samples, can_return_early != 0));
    if visits.misuse {
        let mut state = null_mut();
        unsafe {
            assert_eq!(fmi3::fmi3SetFloat64::<Toy>(handle, &U, 1, &1.0, 1), ERROR);
            assert_eq!(fmi3::fmi3Reset::<Toy>(handle), ERROR);
            assert_eq!(fmi3::fmi3GetFMUState::<Toy>(handle, &mut state), ERROR);
            let (mut a, mut b, mut c, mut d) = (0, 0, 0, 0.0);
            let status =
                fmi3::fmi3DoStep::<Toy>(handle, 0.0, 0.1, 1, &mut a, &mut b, &mut c, &mut d);
            assert_eq!(status, ERROR);
            fmi3::fmi3FreeInstance::<Toy>(handle);
        }
    }
}

fn visited(visits: &Visits, early_return: bool) -> Session {
    let s = Session::with(
        Version::Fmi3,
        Kind::CoSimulation,
        Options {
            intermediate: Some(visit),
            early_return,
            environment: (&raw const *visits).cast_mut().cast(),
            logger: false,
            ..Options::default()
        },
    );
    *visits.handle.borrow_mut() = s.handle;
    s.initialize(0.0, None);
    s
}

#[test]
fn the_importer_sees_every_event_inside_a_step() {
    let visits = Visits {
        misuse: true,
        ..Visits::default()
    };
    let s = visited(&visits, false);
    assert_eq!(s.do_step3(0.0, 0.35), (OK, false, 0.35));
    let seen = visits.seen.borrow();
    assert_eq!(seen.len(), 4);
    for (k, &(time, t, samples, early)) in seen.iter().enumerate() {
        assert!((time - 0.1 * k as f64).abs() < 1e-12);
        assert_eq!((t, samples, early), (time, k as i32 + 1, false));
    }
    assert_eq!(s.get_int(SAMPLES), 4);
}

/// An event a little before the end of a step belongs to the next one, and is seen at its start.
#[test]
fn no_update_lies_before_the_step() {
    let visits = Visits::default();
    let s = visited(&visits, false);
    let end = 0.1 + 5e-8;
    assert_eq!(s.do_step3(0.0, end), (OK, false, end));
    assert_eq!(visits.seen.borrow().len(), 1);
    assert_eq!(s.do_step(end, 0.05), OK);
    assert_eq!(visits.seen.borrow()[1], (end, end, 2, false));
}

#[test]
fn the_importer_can_return_early() {
    // Now, later within the step, never (beyond the end), at a time that is no number.
    for (end, expected) in [
        (0.2, 0.2),
        (0.25, 0.25),
        (0.9, 0.35),
        (f64::NAN, 0.2),
        (-1.0, 0.2),
    ] {
        let visits = Visits {
            end: Some((2, end)),
            ..Visits::default()
        };
        let s = visited(&visits, true);
        let (status, early, last) = s.do_step3(0.0, 0.35);
        assert_eq!((status, early), (OK, expected < 0.35));
        assert!((last - expected).abs() < 1e-12, "{last} {expected}");
        assert_eq!(s.get(TIME), last);
        // The simulation goes on from there, and nothing is sampled twice.
        assert_eq!(s.do_step3(last, 0.5 - last).0, OK);
        assert_eq!(s.get_int(SAMPLES), 5);
    }
}

#[test]
fn an_early_return_must_be_allowed() {
    let visits = Visits {
        end: Some((2, 0.2)),
        ..Visits::default()
    };
    let s = visited(&visits, false);
    assert_eq!(s.do_step3(0.0, 0.35), (OK, false, 0.35));
}

#[test]
fn a_failed_step_tells_how_far_it_came() {
    let s = Session::new(Version::Fmi3, Kind::CoSimulation);
    s.initialize(0.0, None);
    assert_eq!(s.do_step(0.0, 0.1), OK);
    assert_eq!(s.set_enumeration(BEHAVIOUR, FAIL_IN_ADVANCE), OK);
    assert_eq!(s.do_step3(0.1, 0.35), (ERROR, false, 0.1));
}

#[test]
fn a_panic_in_a_callback_poisons_the_step() {
    let visits = Visits {
        panic: true,
        ..Visits::default()
    };
    let s = visited(&visits, true);
    assert_eq!(s.set_enumeration(BEHAVIOUR, PANIC_IN_OUTPUTS), OK);
    assert_eq!(s.do_step3(0.0, 0.35).0, FATAL);
}

/// Found by random calls: a step that rounding swallows would end where it began, with nothing done.
#[test]
fn steps_that_time_is_too_coarse_for_are_refused() {
    for version in BOTH {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(1e300, None);
        assert_eq!(s.do_step(1e300, 0.1), ERROR);
        s.assert_error(&["step of 0.1 s from", "cannot be told from none"]);
    }
}
