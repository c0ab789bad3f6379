//! Reading and writing of variables.

use std::ptr::{null, null_mut};

use crate::session::{BOTH, ERROR, Kind, OK, Session, Version};
use crate::toy::*;
use fmi_unit::{fmi2, fmi3};

fn session(version: Version) -> Session {
    Session::new(version, Kind::CoSimulation)
}

#[test]
fn ranges_are_named_with_value_and_unit() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set(PERIOD, -1.0), ERROR);
        s.assert_error(&["period = -1 s is outside [1e-6, 1e6] s"]);
        assert_eq!(s.set(TAU, f64::INFINITY), ERROR);
        s.assert_error(&["tau = inf s is outside [1e-9, inf] s"]);
        assert_eq!(s.set(BIAS, f64::NAN), ERROR);
        s.assert_error(&["bias = NaN s is outside [-inf, inf] s"]);
        assert_eq!(s.set_int(SEED, 101), ERROR);
        s.assert_error(&["seed = 101 is outside [0, 100]"]);
        assert_eq!(s.set_enumeration(BEHAVIOUR, 9), ERROR);
        s.assert_error(&["behaviour = 9 is none of 1 (normal), 2 (fail_in_event)"]);
        assert_eq!(s.get(PERIOD), 0.1);
        // Inputs are the unit's business.
        assert_eq!(s.set(U, f64::NAN), OK);
        assert!(s.get(U).is_nan());
    }
}

#[test]
fn a_refused_set_changes_nothing() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set_reals(&[U, TAU, PERIOD], &[5.0, 3.0, 0.0]), ERROR);
        assert_eq!((s.get(U), s.get(TAU), s.get(PERIOD)), (0.0, 1.0, 0.1));
    }
}

#[test]
fn fixed_parameters_are_fixed_after_initialization() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set(TAU, 2.0), OK);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        assert_eq!(s.set(TAU, 3.0), OK);
        assert_eq!(s.exit_initialization(), OK);
        assert_eq!(s.set(TAU, 4.0), ERROR);
        s.assert_error(&["tau is fixed"]);
        // The present value may be sent again, as OpenModelica does; tunable ones may change.
        assert_eq!(s.set(TAU, 3.0), OK);
        assert_eq!(s.set(BIAS, 3.0), OK);
        assert_eq!(s.get(BIAS), 3.0);
    }
}

#[test]
fn outputs_and_time_cannot_be_set() {
    for version in BOTH {
        let s = session(version);
        for vr in [TIME, X, SAMPLED, 3] {
            assert_eq!(s.set(vr, 1.0), ERROR);
            s.assert_error(&["cannot be set"]);
        }
    }
}

#[test]
fn outputs_follow_inputs_at_once() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        for u in [1.0, -2.0] {
            assert_eq!(s.set(U, u), OK);
            assert_eq!((s.get(TWICE), s.get(3)), (2.0 * u, u));
        }
        assert_eq!(s.exit_initialization(), OK);
        assert_eq!(s.set(U, 4.0), OK);
        assert_eq!(s.get(TWICE), 8.0);
        assert_eq!(s.do_step(0.0, 0.1), OK);
        assert_eq!(s.set(U, 5.0), OK);
        assert_eq!(s.get(TWICE), 10.0);
    }
}

#[test]
fn wrong_types_and_references_are_errors() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.get_reals(&[SAMPLES], &mut [0.0]), ERROR);
        s.assert_error(&["samples is of type Int32"]);
        assert_eq!(s.set_int(U, 1), ERROR);
        s.assert_error(&["u is of type Float64"]);
        assert_eq!(s.set_boolean(BEHAVIOUR, 1), ERROR);
        s.assert_error(&["behaviour is of type Enumeration"]);
        assert_eq!(s.get_reals(&[99], &mut [0.0]), ERROR);
        s.assert_error(&["value reference 99 is unknown"]);
    }
    let s = session(Version::Fmi2);
    let status = unsafe { fmi2::fmi2GetString::<Toy>(s.handle, &U, 1, &mut null()) };
    assert_eq!(status, ERROR);
    let s = session(Version::Fmi3);
    let status = unsafe { fmi3::fmi3GetFloat32::<Toy>(s.handle, &U, 1, &mut 0.0, 1) };
    assert_eq!(status, ERROR);
    s.assert_error(&["fmi3GetFloat32", "u is of type Float64"]);
    let status = unsafe { fmi3::fmi3GetInt64::<Toy>(s.handle, &SAMPLES, 1, &mut 0, 1) };
    assert_eq!(status, ERROR);
    let status = unsafe { fmi3::fmi3SetInt32::<Toy>(s.handle, &BEHAVIOUR, 1, &1, 1) };
    assert_eq!(status, ERROR);
    let status = unsafe { fmi3::fmi3GetBinary::<Toy>(s.handle, &U, 1, &mut 0, &mut null(), 1) };
    assert_eq!(status, ERROR);
    let status =
        unsafe { fmi3::fmi3GetBinary::<Toy>(s.handle, null(), 0, null_mut(), null_mut(), 0) };
    assert_eq!(status, OK);
}

#[test]
fn arrays_go_whole_in_fmi3_and_by_element_in_fmi2() {
    let s = session(Version::Fmi3);
    assert_eq!(s.set_reals(&[GAIN, TAU], &[1.0, 2.0, 3.0, 4.0]), OK);
    let mut v = [0.0; 4];
    assert_eq!(s.get_reals(&[TAU, GAIN], &mut v), OK);
    assert_eq!(v, [4.0, 1.0, 2.0, 3.0]);
    for n in [2, 4] {
        assert_eq!(s.set_reals(&[GAIN], &vec![0.0; n]), ERROR);
        s.assert_error(&[&format!("{n} values for 3 elements")]);
        assert_eq!(s.get_reals(&[GAIN], &mut vec![0.0; n]), ERROR);
    }
    assert_eq!(s.get_reals(&[GAIN + 1], &mut [0.0]), ERROR);
    s.assert_error(&["value reference 11 is unknown", "gain"]);
    assert_eq!(s.set_reals(&[GAIN], &[0.0, 0.0, 11.0]), ERROR);
    s.assert_error(&["gain[3] = 11 N.m is outside [0, 10] N.m"]);

    let s = session(Version::Fmi2);
    assert_eq!(s.set_reals(&[GAIN + 2, GAIN], &[3.0, 1.0]), OK);
    let mut v = [0.0; 3];
    assert_eq!(s.get_reals(&[GAIN, GAIN + 1, GAIN + 2], &mut v), OK);
    assert_eq!(v, [1.0, 0.0, 3.0]);
    assert_eq!(s.set(GAIN + 1, -1.0), ERROR);
    s.assert_error(&["gain[2] = -1 N.m"]);
    assert_eq!(s.get_reals(&[GAIN + 3], &mut [0.0]), ERROR);
}

#[test]
fn booleans_and_enumerations() {
    for version in BOTH {
        let s = session(version);
        // Anything but zero is true.
        assert_eq!(s.set_boolean(HOLD, 200), OK);
        s.initialize(0.0, None);
        assert_eq!(s.do_step(0.0, 0.5), OK);
        assert_eq!(s.get_int(SAMPLES), 0);
        assert_eq!(s.set_boolean(HOLD, 0), OK);
        assert_eq!(s.do_step(0.5, 0.5), OK);
        assert_eq!(s.get_int(SAMPLES), 5);
    }
    let s = session(Version::Fmi2);
    assert_eq!(s.set_boolean(HOLD, 200), OK);
    let (mut hold, mut behaviour) = (7, 7);
    unsafe {
        assert_eq!(
            fmi2::fmi2GetBoolean::<Toy>(s.handle, &HOLD, 1, &mut hold),
            OK
        );
        assert_eq!(
            fmi2::fmi2GetInteger::<Toy>(s.handle, &BEHAVIOUR, 1, &mut behaviour),
            OK
        );
    }
    assert_eq!((hold, behaviour), (1, 1));
    let s = session(Version::Fmi3);
    assert_eq!(s.set_boolean(HOLD, 200), OK);
    let (mut hold, mut behaviour) = (7, 7);
    unsafe {
        assert_eq!(
            fmi3::fmi3GetBoolean::<Toy>(s.handle, &HOLD, 1, &mut hold, 1),
            OK
        );
        assert_eq!(
            fmi3::fmi3GetInt64::<Toy>(s.handle, &BEHAVIOUR, 1, &mut behaviour, 1),
            OK
        );
    }
    assert_eq!((hold, behaviour), (1, 1));
}

#[test]
fn null_with_zero_length_is_legal_and_null_otherwise_an_error() {
    let s = session(Version::Fmi2);
    unsafe {
        assert_eq!(
            fmi2::fmi2GetReal::<Toy>(s.handle, null(), 0, null_mut()),
            OK
        );
        assert_eq!(fmi2::fmi2SetString::<Toy>(s.handle, null(), 0, null()), OK);
        assert_eq!(fmi2::fmi2SetReal::<Toy>(s.handle, null(), 1, &0.0), ERROR);
        s.assert_error(&["null pointer"]);
        assert_eq!(fmi2::fmi2GetReal::<Toy>(s.handle, &U, 1, null_mut()), ERROR);
        assert_eq!(
            fmi2::fmi2GetReal::<Toy>(s.handle, &U, usize::MAX, &mut 0.0),
            ERROR
        );
    }
    let s = session(Version::Fmi3);
    unsafe {
        assert_eq!(
            fmi3::fmi3GetFloat64::<Toy>(s.handle, null(), 0, null_mut(), 0),
            OK
        );
        assert_eq!(
            fmi3::fmi3SetUInt8::<Toy>(s.handle, null(), 0, null(), 0),
            OK
        );
        assert_eq!(
            fmi3::fmi3SetFloat64::<Toy>(s.handle, &U, 1, null(), 1),
            ERROR
        );
        assert_eq!(
            fmi3::fmi3SetFloat64::<Toy>(s.handle, &U, 1, null(), 0),
            ERROR
        );
    }
}
