//! FMI 3.0: Event Mode in Co-Simulation, clocks that the importer ticks, and Scheduled Execution.

use std::cell::Cell;
use std::ffi::{c_char, c_int, c_void};
use std::ptr::null;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use fmi_unit::fmi3;

use crate::session::*;
use crate::toy::*;

fn eventful(early_return: bool) -> Session {
    let options = Options {
        event_mode: true,
        early_return,
        ..Options::default()
    };
    let s = Session::with(Version::Fmi3, Kind::CoSimulation, options);
    s.initialize(0.0, None);
    s
}

/// The toy samples u at k·0.1 s, in Event Mode, where the importer has just set it.
#[test]
fn steps_end_at_events() {
    let s = eventful(true);
    assert_eq!(s.set(U, 1.0), OK);
    assert_eq!(s.update_discrete(), Ok((false, false, Some(0.1))));
    assert_eq!(s.get(SAMPLED), 1.0);
    assert_eq!(s.enter_step_mode(), OK);
    // Inside a step: it ends there, and the event waits for the importer.
    assert_eq!(s.step_to_event(0.0, 0.15), (true, true, 0.1));
    assert_eq!(s.get_int(SAMPLES), 1);
    assert_eq!(s.enter_event_mode(), OK);
    assert_eq!(s.set(U, 2.0), OK);
    assert_eq!(s.update_discrete(), Ok((false, false, Some(0.2))));
    assert_eq!((s.get(SAMPLED), s.get_int(SAMPLES)), (2.0, 2));
    assert_eq!(s.enter_step_mode(), OK);
    // At the end of a step.
    assert_eq!(
        s.step_to_event(0.1, 0.05),
        (false, false, 0.15000000000000002)
    );
    assert_eq!(s.step_to_event(0.15, 0.05), (true, false, 0.2));
    assert_eq!(s.get_int(SAMPLES), 2);
    // Who steps on all the same loses nothing.
    assert_eq!(s.step_to_event(0.2, 0.05), (false, false, 0.25));
    assert_eq!(s.get_int(SAMPLES), 3);
    assert_eq!(s.step_to_event(0.25, 0.2).2, 0.30000000000000004);
    assert_eq!(s.terminate(), OK);
}

#[test]
fn events_inside_a_step_are_the_units_own_if_it_may_not_return_early() {
    let s = eventful(false);
    s.update_discrete().unwrap();
    assert_eq!(s.enter_step_mode(), OK);
    assert_eq!(s.step_to_event(0.0, 0.35), (false, false, 0.35));
    assert_eq!(s.get_int(SAMPLES), 4);
    assert_eq!(
        s.step_to_event(0.35, 0.05),
        (true, false, 0.39999999999999997)
    );
}

/// An event that Event Mode would not find due is not announced, however near it is.
#[test]
fn events_are_announced_when_they_are_due() {
    let s = eventful(true);
    s.update_discrete().unwrap();
    assert_eq!(s.enter_step_mode(), OK);
    let before = 0.1 - 5e-8;
    assert_eq!(s.step_to_event(0.0, before), (false, false, before));
    assert_eq!(s.step_to_event(before, 0.05), (true, true, 0.1));
    assert_eq!(s.enter_event_mode(), OK);
    assert_eq!(s.update_discrete(), Ok((false, false, Some(0.2))));
    assert_eq!(s.get_int(SAMPLES), 2);
}

/// The same trajectory in both, as the inputs are the same.
#[test]
fn event_mode_changes_nothing_but_who_handles_events() {
    let plain = Session::new(Version::Fmi3, Kind::CoSimulation);
    plain.initialize(0.0, None);
    let s = eventful(true);
    s.update_discrete().unwrap();
    assert_eq!(s.enter_step_mode(), OK);
    let h = 0.07;
    for k in 0..100 {
        let (t, end) = (f64::from(k) * h, f64::from(k + 1) * h);
        assert_eq!(plain.set(U, t.sin()), OK);
        assert_eq!(plain.do_step(t, h), OK);
        assert_eq!(s.set(U, t.sin()), OK);
        let mut at = t;
        while at < end - 1e-9 {
            let (event, _, last) = s.step_to_event(at, end - at);
            at = last;
            if event {
                assert_eq!(s.enter_event_mode(), OK);
                s.update_discrete().unwrap();
                assert_eq!(s.enter_step_mode(), OK);
            }
        }
        assert!((s.get(X) - plain.get(X)).abs() < 1e-12);
        // Without Event Mode an event at the end belongs to the next step.
        if ((end * 10.0).round() - end * 10.0).abs() > 1e-6 {
            assert_eq!(s.get_int(SAMPLES), plain.get_int(SAMPLES), "at {end}");
        }
    }
}

#[test]
fn modes_of_the_other_interfaces_are_refused() {
    let s = eventful(true);
    assert_eq!(s.enter_continuous_time(), ERROR);
    s.assert_error(&["this is for Model Exchange"]);
    let s = Session::new(Version::Fmi3, Kind::CoSimulation);
    s.initialize(0.0, None);
    for refused in [Session::enter_event_mode, Session::enter_step_mode] {
        assert_eq!(refused(&s), ERROR);
        s.assert_error(&["eventModeUsed was false"]);
    }
    let s = Session::new(Version::Fmi3, Kind::ModelExchange);
    s.initialize(0.0, None);
    assert_eq!(s.enter_step_mode(), ERROR);
    s.assert_error(&["this is for Co-Simulation"]);
    assert_eq!(s.activate(FAST, 0.0), ERROR);
    s.assert_error(&["fmi3ActivateModelPartition", "not allowed in Event Mode"]);
}

/// `fmi3IntervalChanged` in Initialization Mode, `fmi3IntervalUnchanged` ever after (FMI 3.0 sec 2.2.8.5).
const CHANGED: i32 = 2;
const UNCHANGED: i32 = 1;

#[test]
fn intervals_follow_from_parameters() {
    let s = Session::new(Version::Fmi3, Kind::CoSimulation);
    assert_eq!(s.interval(FAST), Err(ERROR));
    assert_eq!(s.set(PERIOD, 0.02), OK);
    assert_eq!(s.enter_initialization(0.0, None), OK);
    assert_eq!(s.interval(FAST), Ok((0.02, 0.0, CHANGED)));
    assert_eq!(s.interval(SLOW), Ok((0.2, 0.0, CHANGED)));
    assert_eq!(s.interval(X), Err(ERROR));
    s.assert_error(&["value reference 2 is no clock"]);
    // The other way round, within the range of the parameter.
    assert_eq!(s.set_interval(SLOW, 5.0), OK);
    assert_eq!(s.get(PERIOD), 0.5);
    assert_eq!(s.set_interval(FAST, -1.0), ERROR);
    s.assert_error(&["period = -1 s is outside [1e-6, 1e6] s"]);
    assert_eq!(
        (s.get(PERIOD), s.interval(FAST)),
        (0.5, Ok((0.5, 0.0, CHANGED)))
    );
    assert_eq!(s.exit_initialization(), OK);
    assert_eq!(s.set_interval(FAST, 0.1), ERROR);
    assert_eq!(s.interval(FAST), Ok((0.5, 0.0, UNCHANGED)));
}

/// From its first tick on the importer alone makes events.
#[test]
fn ticks_take_the_place_of_time_events() {
    for kind in [Kind::ModelExchange, Kind::CoSimulation] {
        let options = Options {
            event_mode: true,
            early_return: true,
            ..Options::default()
        };
        let s = Session::with(Version::Fmi3, kind, options);
        assert_eq!(s.set_reals(&[GAIN], &[5.0, 0.0, 0.0]), OK);
        s.initialize(0.0, None);
        assert_eq!(s.set(U, 3.0), OK);
        assert_eq!(s.set_clocks(&[FAST, X], &[1, 1]), ERROR);
        assert_eq!(s.get_clock(FAST), Ok(false));
        assert_eq!(s.set_clocks(&[FAST, SLOW], &[1, 0]), OK);
        assert_eq!(
            (s.get_clock(FAST), s.get_clock(SLOW)),
            (Ok(true), Ok(false))
        );
        assert_eq!(s.get_int(SAMPLES), 0);
        assert_eq!(s.update_discrete(), Ok((false, false, None)));
        assert_eq!(
            (s.get_int(SAMPLES), s.get(SAMPLED), s.get(X)),
            (1, 3.0, 0.0)
        );
        assert_eq!(s.get_clock(FAST), Ok(false));
        // Nothing ticks, nothing happens.
        assert_eq!(s.update_discrete(), Ok((false, false, None)));
        assert_eq!(s.get_int(SAMPLES), 1);
        assert_eq!(s.set_clocks(&[SLOW], &[1]), OK);
        assert_eq!(s.update_discrete(), Ok((false, true, None)));
        assert_eq!((s.get_int(SAMPLES), s.get(X)), (1, 5.0));
        if kind == Kind::CoSimulation {
            assert_eq!(s.enter_step_mode(), OK);
            assert_eq!(s.step_to_event(0.0, 1.0), (false, false, 1.0));
            assert_eq!(s.get_int(SAMPLES), 1);
            assert_eq!(s.set_clocks(&[FAST], &[1]), ERROR);
        }
    }
}

thread_local! {
    static LOCKED: Cell<i32> = const { Cell::new(0) };
    static LOCKS: Cell<u32> = const { Cell::new(0) };
}

unsafe extern "C" fn lock() {
    LOCKED.set(LOCKED.get() + 1);
    LOCKS.set(LOCKS.get() + 1);
}

unsafe extern "C" fn unlock() {
    LOCKED.set(LOCKED.get() - 1);
}

fn scheduled() -> Session {
    let options = Options {
        lock: Some(lock),
        unlock: Some(unlock),
        ..Options::default()
    };
    LOCKS.set(0);
    let s = Session::with(Version::Fmi3, Kind::ScheduledExecution, options);
    s.initialize(0.0, None);
    s
}

#[test]
fn partitions_run_when_they_are_activated() {
    let s = scheduled();
    assert_eq!(s.set(U, 3.0), OK);
    assert_eq!(s.activate(FAST, 0.0), OK);
    assert_eq!(
        (s.get_int(SAMPLES), s.get(SAMPLED), s.get(TIME)),
        (1, 3.0, 0.0)
    );
    assert_eq!(s.activate(SLOW, 0.1), OK);
    assert_eq!((s.get(X), s.get(TIME)), (6.0, 0.1));
    assert_eq!((LOCKED.get(), LOCKS.get()), (0, 3));
    assert_eq!(s.activate(X, 0.1), ERROR);
    s.assert_error(&["value reference 2 is no clock"]);
    assert_eq!(s.activate(FAST, f64::NAN), ERROR);
    s.assert_error(&["activation at NaN s"]);
    assert_eq!(s.do_step(0.1, 0.1), ERROR);
    s.assert_error(&["not allowed in Clock Activation Mode"]);
    assert_eq!(s.terminate(), OK);
    assert_eq!(s.activate(FAST, 0.2), ERROR);
}

/// While one partition works, the importer sets inputs, runs the other and reads outputs.
#[test]
fn a_partition_at_work_can_be_preempted() {
    let s = std::rc::Rc::new(scheduled());
    let inner = s.clone();
    let mut ran = 0;
    WORK.set(Some(Box::new(move || {
        assert_eq!(LOCKED.get(), 0, "work holds no lock");
        ran += 1;
        assert_eq!(inner.set(U, 7.0), OK);
        assert_eq!(inner.activate(FAST, 0.1 * f64::from(ran)), OK);
        assert_eq!((inner.get_int(SAMPLES), inner.get(SAMPLED)), (ran, 7.0));
    })));
    assert_eq!(s.set(U, 3.0), OK);
    assert_eq!(s.activate(SLOW, 0.0), OK);
    WORK.set(None);
    // What the slow partition saw is what there was when it began.
    assert_eq!((s.get(X), s.get_int(SAMPLES)), (6.0, 1));
    assert_eq!((LOCKED.get(), LOCKS.get()), (0, 3));
}

#[test]
fn failures_and_panics_of_a_partition_stay_in_the_instance() {
    let s = scheduled();
    assert_eq!(s.set_enumeration(BEHAVIOUR, FAIL_IN_EVENT), OK);
    assert_eq!(s.activate(FAST, 0.0), ERROR);
    s.assert_error(&["told to fail at 0 s"]);
    assert_eq!(s.activate(FAST, 0.1), ERROR);
    s.assert_error(&["not allowed in the state after an error"]);
    let s = scheduled();
    WORK.set(Some(Box::new(|| panic!("told to panic at work"))));
    assert_eq!(s.activate(SLOW, 0.0), FATAL);
    WORK.set(None);
    assert_eq!(LOCKED.get(), 0);
    assert!(
        s.messages
            .borrow()
            .iter()
            .any(|m| m.text.contains("told to panic at work"))
    );
    assert_eq!(s.set(U, 1.0), FATAL);
}

/// Where states are saved by pointer, one of another use of the unit does not fit.
#[test]
fn states_of_other_interfaces_are_refused() {
    let (s, plain) = (
        eventful(true),
        Session::new(Version::Fmi3, Kind::CoSimulation),
    );
    plain.initialize(0.0, None);
    let mut state = std::ptr::null_mut();
    assert_eq!(s.save(&mut state), OK);
    assert_eq!(plain.restore(state), ERROR);
    assert_eq!(s.restore(state), OK);
    assert_eq!(s.free_state(&mut state), OK);
    let s = scheduled();
    assert_eq!(s.save(&mut state), ERROR);
    s.assert_error(&["not allowed in Clock Activation Mode"]);
}

/// What was set but not carried out before Event Mode was left does not tick in the next one.
#[test]
fn ticks_do_not_outlive_event_mode() {
    let s = Session::new(Version::Fmi3, Kind::ModelExchange);
    s.initialize(0.0, None);
    assert_eq!(s.set_clocks(&[FAST], &[1]), OK);
    assert_eq!(s.enter_continuous_time(), OK);
    assert_eq!(s.enter_event_mode(), OK);
    assert_eq!(s.get_clock(FAST), Ok(false));
    s.update_discrete().unwrap();
    assert_eq!(s.get_int(SAMPLES), 0);
}

/// The job of a unit that is gone goes with it.
#[test]
fn a_reset_while_a_partition_works_drops_its_job() {
    let s = std::rc::Rc::new(scheduled());
    let inner = s.clone();
    WORK.set(Some(Box::new(move || {
        assert_eq!(inner.reset(), OK);
        inner.initialize(0.0, None);
    })));
    assert_eq!(s.set(U, 3.0), OK);
    assert_eq!(s.activate(SLOW, 0.0), OK);
    WORK.set(None);
    assert_eq!(s.get(X), 0.0);
}

/// Messages that the slow logger has begun to write.
static WRITING: AtomicU32 = AtomicU32::new(0);

unsafe extern "C" fn slow_log(_: *mut c_void, _: c_int, _: *const c_char, _: *const c_char) {
    WRITING.fetch_add(1, Ordering::SeqCst);
    std::thread::sleep(Duration::from_millis(300));
}

/// A finished job waits for a call of another thread, however long that holds the instance: here for a message.
#[test]
fn a_finished_job_is_not_lost_to_a_slow_call() {
    let handle = unsafe {
        let (name, token) = (c"toy".as_ptr(), c"{toy}".as_ptr());
        let (log, environment) = (Some(slow_log as _), std::ptr::null_mut());
        let (lock, unlock) = (Some(lock as _), Some(unlock as _));
        fmi3::fmi3InstantiateScheduledExecution::<Toy>(
            name,
            token,
            null(),
            0,
            1,
            environment,
            log,
            None,
            lock,
            unlock,
        )
    };
    let s = Session {
        version: Version::Fmi3,
        handle,
        messages: Box::default(),
    };
    s.initialize(0.0, None);
    let address = handle as usize;
    WORK.set(Some(Box::new(move || {
        std::thread::spawn(move || {
            let (handle, nothing) = (address as *mut c_void, [0.0]);
            let status = unsafe {
                fmi3::fmi3SetFloat64::<Toy>(handle, [99].as_ptr(), 1, nothing.as_ptr(), 1)
            };
            assert_eq!(status, ERROR);
        });
        while WRITING.load(Ordering::SeqCst) == 0 {
            std::thread::yield_now();
        }
    })));
    assert_eq!(s.set(U, 3.0), OK);
    assert_eq!(s.activate(SLOW, 0.0), OK);
    WORK.set(None);
    assert_eq!((s.get(X), WRITING.load(Ordering::SeqCst)), (6.0, 1));
}
