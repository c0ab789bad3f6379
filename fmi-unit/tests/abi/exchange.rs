//! Model Exchange: states, derivatives and events.

use crate::session::{BOTH, ERROR, Kind, OK, Session, Version};
use crate::toy::*;
use fmi_unit::{fmi2, fmi3};

fn session(version: Version) -> Session {
    Session::new(version, Kind::ModelExchange)
}

/// Integrates with the classical Runge-Kutta method to `end`, stopping at time events.
fn integrate(s: &Session, end: f64, h: f64) {
    let iterate = || {
        loop {
            let (again, _, next) = s.update_discrete().unwrap();
            if !again {
                assert_eq!(s.enter_continuous_time(), OK);
                return next.unwrap_or(f64::INFINITY);
            }
        }
    };
    let mut next = iterate();
    let mut t = s.get(TIME);
    let derivative = |t: f64, x: f64| {
        let mut d = [f64::NAN];
        assert_eq!(s.set_time(t), OK);
        assert_eq!(s.set_states(&[x]), OK);
        assert_eq!(s.get_derivatives(&mut d), OK);
        assert_eq!(s.get(3).to_bits(), d[0].to_bits());
        d[0]
    };
    while t < end - 1e-9 {
        let step = h.min(next - t).min(end - t);
        let mut x = [f64::NAN];
        assert_eq!(s.get_states(&mut x), OK);
        let x = x[0];
        let k1 = derivative(t, x);
        let k2 = derivative(t + step / 2.0, x + step / 2.0 * k1);
        let k3 = derivative(t + step / 2.0, x + step / 2.0 * k2);
        let k4 = derivative(t + step, x + step * k3);
        t += step;
        assert_eq!(s.set_time(t), OK);
        assert_eq!(
            s.set_states(&[x + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)]),
            OK
        );
        let asked = s.completed_step().unwrap();
        assert_eq!(asked, t >= next - 1e-9);
        if asked {
            assert_eq!(s.enter_event_mode(), OK);
            next = iterate();
        }
    }
}

#[test]
fn the_importers_solver_finds_the_analytic_solution() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set(U, 1.0), OK);
        assert_eq!(s.set(BIAS, 3.0), OK);
        s.initialize(5.0, None);
        integrate(&s, 7.0, 0.03);
        let exact = 1.0 + 2.0 * (-2.0_f64).exp();
        assert!((s.get(X) - exact).abs() < 1e-7, "{}", s.get(X) - exact);
        // Samples at 5.0, 5.1, ..., 7.0: here the event at the end has happened.
        assert_eq!(s.get_int(SAMPLES), 21);
        assert_eq!(s.terminate(), OK);
        assert!(
            s.messages.borrow().iter().all(|m| m.status == OK),
            "{:?}",
            s.messages
        );
    }
}

#[test]
fn states_and_derivatives_are_known_in_initialization_mode() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set(BIAS, 3.0), OK);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        let (mut x, mut d) = ([0.0], [0.0]);
        assert_eq!((s.get_states(&mut x), s.get_derivatives(&mut d)), (OK, OK));
        assert_eq!((x, d), ([3.0], [-3.0]));
        assert_eq!(s.exit_initialization(), OK);
        let (mut x, mut d) = ([0.0], [0.0]);
        assert_eq!((s.get_states(&mut x), s.get_derivatives(&mut d)), (OK, OK));
        assert_eq!((x, d), ([3.0], [-3.0]));
    }
}

#[test]
fn events_tell_jumps_and_their_successor() {
    for version in BOTH {
        let s = session(version);
        let gain: &[f64] = if version == Version::Fmi2 {
            &[0.5]
        } else {
            &[0.5, 0.0, 0.0]
        };
        assert_eq!(s.set_reals(&[GAIN], gain), OK);
        s.initialize(0.0, None);
        assert_eq!(s.update_discrete(), Ok((false, true, Some(0.1))));
        assert_eq!(s.get(X), 0.5);
        // Nothing is due now.
        assert_eq!(s.update_discrete(), Ok((false, false, Some(0.1))));
        assert_eq!(s.get_int(SAMPLES), 1);
        assert_eq!(s.enter_continuous_time(), OK);
        // An importer that overlooks events is told, and can catch up.
        assert_eq!(s.set_time(0.35), OK);
        assert_eq!(s.completed_step(), Ok(true));
        assert_eq!(s.enter_event_mode(), OK);
        for again in [true, true, false] {
            assert_eq!(s.update_discrete().unwrap().0, again);
        }
        assert_eq!(s.get_int(SAMPLES), 4);
        assert_eq!(s.get(X), 2.0);
    }
}

#[test]
fn a_step_event_is_carried_out_once() {
    for version in BOTH {
        let s = session(version);
        let references: &[u32] = if version == Version::Fmi2 {
            &[GAIN, GAIN + 1, GAIN + 2]
        } else {
            &[GAIN]
        };
        assert_eq!(s.set_reals(references, &[0.0, 2.0, 0.0]), OK);
        s.initialize(0.0, None);
        s.update_discrete().unwrap();
        assert_eq!(s.enter_continuous_time(), OK);
        assert_eq!(s.set_time(0.05), OK);
        assert_eq!(s.set_states(&[1.5]), OK);
        assert_eq!(s.completed_step(), Ok(false));
        assert_eq!(s.set_states(&[2.5]), OK);
        assert_eq!(s.completed_step(), Ok(true));
        assert_eq!(s.enter_event_mode(), OK);
        assert_eq!(s.update_discrete(), Ok((false, true, Some(0.1))));
        assert_eq!(s.get(X), 0.5);
        assert_eq!(s.update_discrete(), Ok((false, false, Some(0.1))));
        assert_eq!(s.get_int(SAMPLES), 1);
    }
}

/// The order of calls of the Modelica code that OpenModelica makes of an FMU.
#[test]
fn the_order_of_openmodelica_is_accepted() {
    let s = session(Version::Fmi2);
    unsafe {
        assert_eq!(s.set_time(2.0), OK);
        assert_eq!(fmi2::fmi2EnterInitializationMode::<Toy>(s.handle), OK);
    }
    assert_eq!(s.set(TAU, 2.0), OK);
    assert_eq!(s.exit_initialization(), OK);
    let mut x = [0.0];
    assert_eq!(s.get_states(&mut x), OK);
    assert_eq!(s.set(TAU, 2.0), OK);
    assert_eq!(s.set_time(2.0), OK);
    assert_eq!(s.set_states(&x), OK);
    assert_eq!(s.enter_event_mode(), OK);
    // One iteration only, and on.
    assert!(s.update_discrete().is_ok());
    assert_eq!(s.enter_continuous_time(), OK);
    assert_eq!(s.enter_continuous_time(), OK);
    assert_eq!(s.set(TAU, 2.0), OK);
    assert_eq!(s.terminate(), OK);
    assert_eq!(s.terminate(), OK);
    let messages = s.messages.borrow();
    assert!(messages.iter().all(|m| m.status <= 1), "{messages:?}");
    assert!(
        messages
            .iter()
            .any(|m| m.text.contains("fmi2SetContinuousStates"))
    );
}

#[test]
fn counts_are_checked() {
    for version in BOTH {
        let s = session(version);
        s.initialize(0.0, None);
        assert_eq!(s.get_states(&mut [0.0; 2]), ERROR);
        s.assert_error(&["2 values for 1 continuous states"]);
        assert_eq!(s.set_states(&[]), ERROR);
        assert_eq!(s.set_time(f64::NAN), ERROR);
        assert_eq!(s.do_step(0.0, 0.1), ERROR);
    }
    let s = session(Version::Fmi3);
    let (mut n, mut nominal) = (9, [0.0]);
    unsafe {
        assert_eq!(
            fmi3::fmi3GetNumberOfContinuousStates::<Toy>(s.handle, &mut n),
            OK
        );
        assert_eq!(n, 1);
        assert_eq!(
            fmi3::fmi3GetNumberOfEventIndicators::<Toy>(s.handle, &mut n),
            OK
        );
        assert_eq!(n, 1);
        s.initialize(0.0, None);
        let p = nominal.as_mut_ptr();
        assert_eq!(
            fmi3::fmi3GetNominalsOfContinuousStates::<Toy>(s.handle, p, 1),
            OK
        );
        assert_eq!(nominal, [1.0]);
        let null = std::ptr::null_mut();
        assert_eq!(
            fmi3::fmi3GetEventIndicators::<Toy>(s.handle, null, 0),
            ERROR
        );
        s.assert_error(&["0 values for 1 event indicators"]);
        // The indicator is 2·u.
        assert_eq!(s.set(U, -3.0), OK);
        assert_eq!(fmi3::fmi3GetEventIndicators::<Toy>(s.handle, p, 1), OK);
        assert_eq!(nominal, [-6.0]);
    }
}

#[test]
fn a_failing_event_is_an_error() {
    for version in BOTH {
        for behaviour in [FAIL_IN_EVENT, STUCK] {
            let s = session(version);
            assert_eq!(s.set_enumeration(BEHAVIOUR, behaviour), OK);
            s.initialize(0.0, None);
            assert_eq!(s.update_discrete(), Err(ERROR));
            assert_eq!(s.enter_continuous_time(), ERROR);
            s.assert_error(&["not allowed in the state after an error"]);
        }
    }
}

/// FMI 3.0.2 sec 3.2.1 has it, and CasADi knows no other way, in FMI 2.0 too.
#[test]
fn a_state_can_be_set_as_a_variable_in_continuous_time() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set(X, 1.5), ERROR, "before initialization");
        let s = session(version);
        s.initialize(0.0, None);
        assert_eq!(s.set(X, 1.5), ERROR, "in Event Mode");
        s.assert_error(&["x is a continuous state", "cannot be set in Event Mode"]);
        s.update_discrete().unwrap();
        assert_eq!(s.enter_continuous_time(), OK);
        let (mut x, mut by_value, mut by_state) = ([0.0], [0.0], [0.0]);
        assert_eq!(s.set(X, 1.5), OK);
        assert_eq!(s.get(X), 1.5);
        assert_eq!(s.get_states(&mut x), OK);
        assert_eq!(x, [1.5]);
        assert_eq!(s.get_derivatives(&mut by_value), OK);
        assert_eq!(s.set_states(&[0.5]), OK);
        assert_eq!(s.set_states(&[1.5]), OK);
        assert_eq!(s.get_derivatives(&mut by_state), OK);
        assert_eq!(by_value, by_state);
        assert_eq!(s.set(TWICE, 1.0), ERROR, "no state");
    }
}
