//! Structural parameters and the arrays whose size follows them (FMI 3.0 sec 2.3.3).

use std::ptr::null_mut;

use crate::session::{BOTH, ERROR, Kind, OK, Session, Version};
use crate::states::signed;
use crate::toy::*;

fn session() -> Session {
    Session::new(Version::Fmi3, Kind::CoSimulation)
}

/// As many values as the array has elements, and no other number.
fn weights(s: &Session, n: usize) -> Vec<f64> {
    for wrong in [n - 1, n + 1] {
        let mut values = vec![0.0; wrong];
        assert_eq!(s.get_reals(&[WEIGHT], &mut values), ERROR);
        s.assert_error(&[&format!("{wrong} values for {n} elements: weight has {n}")]);
        assert_eq!(s.set_reals(&[WEIGHT], &values), ERROR);
    }
    let mut values = vec![f64::NAN; n];
    assert_eq!(s.get_reals(&[WEIGHT], &mut values), OK, "{:?}", s.messages);
    values
}

#[test]
fn arrays_follow_their_parameter() {
    let s = session();
    assert_eq!(weights(&s, 2), [1.0; 2]);
    assert_eq!(s.set_reals(&[WEIGHT], &[3.0, 4.0]), OK);
    assert_eq!(s.enter_configuration(), OK);
    assert_eq!(s.set_size(SIZE, 5), OK);
    assert_eq!(s.get_size(SIZE), 5);
    // The arrays follow when the mode is left.
    assert_eq!(weights(&s, 2), [3.0, 4.0]);
    assert_eq!(s.exit_configuration(), OK);
    // What was there stays, the rest starts.
    assert_eq!(weights(&s, 5), [3.0, 4.0, 1.0, 1.0, 1.0]);
    s.configure(SIZE, 1);
    assert_eq!(weights(&s, 1), [3.0]);
    s.configure(SIZE, 3);
    assert_eq!(s.set_reals(&[WEIGHT, TAU], &[2.0, 0.5, 0.0, 9.0]), OK);
    s.initialize(0.0, None);
    assert_eq!(s.set(U, 4.0), OK);
    assert_eq!(s.do_step(0.0, 0.1), OK);
    let mut ramp = [f64::NAN; 3];
    assert_eq!(s.get_reals(&[RAMP], &mut ramp), OK);
    assert_eq!(ramp, [8.0, 2.0, 0.0]);
}

#[test]
fn values_are_refused_by_name_range_and_mode() {
    let s = session();
    assert_eq!(s.set_size(SIZE, 3), ERROR);
    s.assert_error(&["size is a structural parameter", "not in Instantiated"]);
    // What changes nothing does no harm.
    assert_eq!(s.set_size(SIZE, 2), OK);
    assert_eq!(s.enter_configuration(), OK);
    for outside in [0, 1001, u64::MAX] {
        assert_eq!(s.set_size(SIZE, outside), ERROR);
        s.assert_error(&["size = ", " is outside [1, 1000]"]);
    }
    assert_eq!(s.set(TAU, 2.0), ERROR);
    s.assert_error(&["tau cannot be set in Configuration Mode: it is no structural parameter"]);
    assert_eq!(s.set_reals(&[SIZE], &[3.0]), ERROR);
    s.assert_error(&["size is of type UInt64"]);
    assert_eq!(s.exit_configuration(), OK);
    assert_eq!(weights(&s, 2), [1.0; 2]);
    s.initialize(0.0, None);
    assert_eq!(s.set_size(SIZE, 3), ERROR);
    s.assert_error(&["not in Step Mode"]);
    // There is no tunable one, so that sizes cannot change any more.
    assert_eq!(s.enter_configuration(), ERROR);
    s.assert_error(&["fmi3EnterConfigurationMode", "not allowed in Step Mode"]);
}

#[test]
fn reset_goes_back_to_the_start() {
    let s = session();
    s.configure(SIZE, 7);
    s.initialize(0.0, None);
    assert_eq!(s.reset(), OK);
    assert_eq!(s.get_size(SIZE), 2);
    assert_eq!(weights(&s, 2), [1.0; 2]);
    // Out of the middle of a configuration too.
    assert_eq!(s.enter_configuration(), OK);
    assert_eq!(s.set_size(SIZE, 9), OK);
    assert_eq!(s.reset(), OK);
    s.initialize(0.0, None);
    assert_eq!(weights(&s, 2), [1.0; 2]);
}

#[test]
fn states_carry_the_sizes() {
    let s = session();
    s.configure(SIZE, 4);
    assert_eq!(s.set_reals(&[WEIGHT], &[1.0, 2.0, 3.0, 4.0]), OK);
    s.initialize(0.0, None);
    assert_eq!(s.set(U, 0.5), OK);
    assert_eq!(s.do_step(0.0, 0.1), OK);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let bytes = s.serialize(state);
    for (size, steps) in [(None, 0), (Some(6), 0), (Some(6), 3), (Some(1), 3)] {
        let other = session();
        if let Some(size) = size {
            other.configure(SIZE, size);
        }
        if steps > 0 {
            other.initialize(0.0, None);
        }
        for k in 0..steps {
            assert_eq!(other.do_step(f64::from(k) * 0.1, 0.1), OK);
        }
        let mut read = null_mut();
        assert_eq!(
            other.deserialize(&bytes, &mut read),
            OK,
            "{:?}",
            other.messages
        );
        assert_eq!(other.restore(read), OK);
        assert_eq!(other.get_size(SIZE), 4);
        assert_eq!(weights(&other, 4), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(other.do_step(0.1, 0.1), OK, "{:?}", other.messages);
        assert_eq!(s.restore(state), OK);
        assert_eq!(s.do_step(0.1, 0.1), OK);
        let mut ramps = [[f64::NAN; 4], [0.0; 4]];
        assert_eq!(other.get_reals(&[RAMP], &mut ramps[0]), OK);
        assert_eq!(s.get_reals(&[RAMP], &mut ramps[1]), OK);
        assert_eq!(ramps[0], ramps[1]);
        assert_eq!(other.get(X).to_bits(), s.get(X).to_bits());
        assert_eq!(other.free_state(&mut read), OK);
    }
    assert_eq!(s.free_state(&mut state), OK);
}

/// A state in the middle of a configuration: the arrays have not followed yet.
#[test]
fn a_configuration_is_saved_too() {
    let s = session();
    assert_eq!(s.enter_configuration(), OK);
    assert_eq!(s.set_size(SIZE, 6), OK);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let bytes = s.serialize(state);
    assert_eq!(s.free_state(&mut state), OK);
    let other = session();
    assert_eq!(other.deserialize(&bytes, &mut state), OK);
    assert_eq!(other.restore(state), OK);
    assert_eq!(other.exit_configuration(), OK);
    assert_eq!(weights(&other, 6), [1.0; 6]);
    assert_eq!(other.free_state(&mut state), OK);
}

/// Bytes that say another size than their arrays have.
#[test]
fn inconsistent_states_are_refused() {
    let s = session();
    s.configure(SIZE, 77);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let mut bytes = s.serialize(state);
    assert_eq!(s.free_state(&mut state), OK);
    // Size, length of weight and length of ramp are the bytes 77.
    let size = bytes.iter().position(|&byte| byte == 77).unwrap();
    bytes[size] = 78;
    bytes.truncate(bytes.len() - 8);
    assert_eq!(s.deserialize(&signed(bytes), &mut state), ERROR);
    s.assert_error(&["the serialized state is damaged"]);
}

/// Derivatives of arrays of the new size, in one instance before the unit is set up and in one after.
#[test]
fn derivatives_follow_the_sizes() {
    for set_up in [false, true] {
        let s = Session::new(Version::Fmi3, Kind::ModelExchange);
        s.configure(SIZE, 3);
        assert_eq!(s.set_reals(&[WEIGHT], &[2.0, 3.0, 5.0]), OK);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        if set_up {
            assert_eq!(s.exit_initialization(), OK);
        }
        let mut out = [f64::NAN; 3];
        let status = s.directional([&[RAMP], &[U]], &[1.0], &mut out);
        assert_eq!(status, OK, "{:?}", s.messages);
        for (value, expected) in out.iter().zip([2.0, 3.0, 5.0]) {
            assert!((value - expected).abs() < 1e-9, "{out:?}");
        }
        assert_eq!(s.directional([&[RAMP], &[U]], &[1.0], &mut out[..2]), ERROR);
        s.assert_error(&["2 values for 3 unknowns"]);
    }
}

/// FMI 2.0 has the array in its size at the start, element by element, and no structural parameter.
#[test]
fn fmi2_has_the_size_at_the_start() {
    let s = Session::new(Version::Fmi2, Kind::CoSimulation);
    let mut values = [f64::NAN; 2];
    assert_eq!(s.get_reals(&[WEIGHT, WEIGHT + 1], &mut values), OK);
    assert_eq!(values, [1.0; 2]);
    assert_eq!(s.set_int(SIZE, 3), ERROR);
    s.assert_error(&["size is of type UInt64"]);
    // The states of both versions are the same, so that one may bring a smaller array.
    let small = session();
    small.configure(SIZE, 1);
    let mut state = null_mut();
    assert_eq!(small.save(&mut state), OK);
    assert_eq!(s.restore(state), OK);
    assert_eq!(s.get_reals(&[WEIGHT + 1], &mut [0.0]), ERROR);
    s.assert_error(&["value reference 16 is unknown: weight has 1 element"]);
    assert_eq!(s.free_state(&mut state), OK);
}

#[test]
fn both_versions_make_the_same_of_the_start() {
    let ramps = BOTH.map(|version| {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        assert_eq!(s.set(U, 3.0), OK);
        let mut ramp = [f64::NAN; 2];
        match version {
            Version::Fmi2 => assert_eq!(s.get_reals(&[RAMP, RAMP + 1], &mut ramp), OK),
            Version::Fmi3 => assert_eq!(s.get_reals(&[RAMP], &mut ramp), OK),
        }
        ramp
    });
    assert_eq!(ramps, [[3.0; 2]; 2]);
}
