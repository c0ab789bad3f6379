//! Saved states.

use std::ffi::c_void;
use std::ptr::null_mut;

use crate::session::{BOTH, ERROR, Kind, OK, Session, Version};
use crate::toy::*;

/// All outputs, bit for bit.
fn observe(s: &Session) -> [u64; 6] {
    let mut v = [0.0; 5];
    assert_eq!(s.get_reals(&[TIME, X, 3, SAMPLED, TWICE], &mut v), OK);
    let [a, b, c, d, e] = v.map(f64::to_bits);
    [a, b, c, d, e, s.get_int(SAMPLES) as u64]
}

fn run(s: &Session, from: f64, steps: u32) -> Vec<[u64; 6]> {
    (0..steps)
        .map(|k| {
            let t = from + f64::from(k) * 0.033;
            assert_eq!(s.set(U, (7.0 * t).sin()), OK);
            assert_eq!(s.do_step(t, 0.033), OK, "{:?}", s.messages);
            observe(s)
        })
        .collect()
}

fn started(version: Version) -> Session {
    let s = Session::new(version, Kind::CoSimulation);
    assert_eq!(s.set(TAU, 0.3), OK);
    s.initialize(1.0, Some(100.0));
    s
}

#[test]
fn the_simulation_goes_on_bit_for_bit() {
    for version in BOTH {
        let s = started(version);
        run(&s, 1.0, 17);
        let t = s.get(TIME);
        assert_eq!(s.set(U, 0.4), OK);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let bytes = s.serialize(state);
        let expected = run(&s, t, 30);

        // In place, twice.
        for _ in 0..2 {
            assert_eq!(s.restore(state), OK);
            assert_eq!(s.get(U), 0.4);
            assert_eq!(run(&s, t, 30), expected);
        }
        // In an instance that is only instantiated, with other parameters.
        let fresh = Session::new(version, Kind::CoSimulation);
        assert_eq!(fresh.restore(state), OK);
        assert_eq!(run(&fresh, t, 30), expected);
        // In one that runs with other parameters and another start, through bytes.
        let other = Session::new(version, Kind::CoSimulation);
        assert_eq!(other.set(PERIOD, 0.2), OK);
        other.initialize(0.0, None);
        run(&other, 0.0, 3);
        let mut read = null_mut();
        assert_eq!(other.deserialize(&bytes, &mut read), OK);
        assert_eq!(other.restore(read), OK);
        assert_eq!(other.get(TAU), 0.3);
        assert_eq!(run(&other, t, 30), expected);
        assert_eq!(other.serialize(read), bytes);
        assert_eq!(other.free_state(&mut read), OK);
        assert!(read.is_null());
        // The state does not need the instance that made it.
        assert_eq!(fresh.free_state(&mut state), OK);
    }
}

#[test]
fn the_bytes_are_the_same_in_both_versions() {
    let bytes = BOTH.map(|version| {
        let s = started(version);
        run(&s, 1.0, 5);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let bytes = s.serialize(state);
        assert_eq!(s.free_state(&mut state), OK);
        bytes
    });
    assert_eq!(bytes[0], bytes[1]);
}

#[test]
fn a_state_can_be_saved_in_any_mode() {
    for version in BOTH {
        for kind in [Kind::CoSimulation, Kind::ModelExchange] {
            let s = Session::new(version, kind);
            let mut states = [null_mut::<c_void>(); 4];
            assert_eq!(s.save(&mut states[0]), OK);
            assert_eq!(s.set(BIAS, 5.0), OK);
            assert_eq!(s.enter_initialization(0.0, None), OK);
            assert_eq!(s.save(&mut states[1]), OK);
            assert_eq!(s.exit_initialization(), OK);
            assert_eq!(s.save(&mut states[2]), OK);
            if kind == Kind::ModelExchange {
                s.update_discrete().unwrap();
                assert_eq!(s.enter_continuous_time(), OK);
                // A solver may look back.
                assert_eq!(s.set_time(-1.0), OK);
            }
            assert_eq!(s.save(&mut states[3]), OK);
            assert_eq!(s.terminate(), OK);

            for state in states.iter().rev() {
                let mut copy = null_mut();
                assert_eq!(
                    s.deserialize(&s.serialize(*state), &mut copy),
                    OK,
                    "{:?}",
                    s.messages
                );
                assert_eq!(s.restore(copy), OK);
                assert_eq!(s.free_state(&mut copy), OK);
            }
            assert_eq!(s.restore(states[1]), OK);
            assert_eq!(s.get(X), 5.0);
            assert_eq!(s.exit_initialization(), OK);
            assert_eq!(s.restore(states[3]), OK);
            match kind {
                Kind::CoSimulation => assert_eq!(s.do_step(0.0, 0.1), OK),
                _ => assert_eq!(s.enter_event_mode(), OK),
            }
            assert_eq!(s.restore(states[0]), OK);
            assert_eq!(s.get(BIAS), 0.0);
            for state in &mut states {
                assert_eq!(s.free_state(state), OK);
            }
        }
    }
}

#[test]
fn an_existing_state_is_overwritten() {
    for version in BOTH {
        let s = started(version);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let before = state;
        let later = run(&s, 1.0, 3);
        assert_eq!(s.save(&mut state), OK);
        assert_eq!(state, before);
        run(&s, s.get(TIME), 3);
        assert_eq!(s.restore(state), OK);
        assert_eq!(observe(&s), later[2]);
        assert_eq!(s.free_state(&mut state), OK);
        assert_eq!(s.free_state(&mut state), OK);
    }
}

#[test]
fn null_states_are_errors() {
    for version in BOTH {
        let s = started(version);
        assert_eq!(s.restore(null_mut()), ERROR);
        s.assert_error(&["FMU state is a null pointer"]);
    }
}

#[test]
fn a_state_belongs_to_its_interface() {
    for version in BOTH {
        let s = started(version);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let exchange = Session::new(version, Kind::ModelExchange);
        assert_eq!(exchange.restore(state), ERROR);
        exchange.assert_error(&["CoSimulation", "ModelExchange"]);
        assert_eq!(s.free_state(&mut state), OK);
    }
}

#[test]
fn hostile_bytes_are_refused() {
    let s = started(Version::Fmi3);
    run(&s, 1.0, 3);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let bytes = s.serialize(state);
    let mut read = null_mut();
    for n in 0..bytes.len() {
        assert_eq!(s.deserialize(&bytes[..n], &mut read), ERROR);
        let mut damaged = bytes.clone();
        damaged[n] ^= 1 << (n % 8);
        assert_eq!(s.deserialize(&damaged, &mut read), ERROR);
    }
    let longer = [&bytes[..], &[0]].concat();
    assert_eq!(s.deserialize(&longer, &mut read), ERROR);
    assert_eq!(s.deserialize(&[], &mut read), ERROR);
    assert!(read.is_null());

    // With a right check sum: whatever can be read is consistent, or it is refused. Nothing panics.
    let content = &bytes[..bytes.len() - 8];
    for n in 0..content.len() {
        for value in [0, 1, 2, 7, 0x7f, 0x80, 0xff] {
            let mut forged = content.to_vec();
            forged[n] = value;
            let fresh = Session::new(Version::Fmi3, Kind::CoSimulation);
            let mut read = null_mut();
            if fresh.deserialize(&signed(forged), &mut read) == OK {
                let status = fresh.restore(read);
                assert!(status == OK || status == ERROR, "byte {n} = {value}");
                assert_eq!(fresh.free_state(&mut read), OK);
            }
        }
    }
    assert_eq!(s.free_state(&mut state), OK);
}

pub fn signed(mut content: Vec<u8>) -> Vec<u8> {
    let check = content.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, &b| {
        (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    content.extend(check.to_le_bytes());
    content
}

/// A mode that the state cannot have: without a unit that is set up, or of the other interface.
#[test]
fn inconsistent_states_are_refused() {
    let s = started(Version::Fmi3);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let bytes = s.serialize(state);
    // After the format, the token with its length and the interface: the mode, which is Step.
    let mode = 1 + 1 + "{toy}".len() + 1;
    assert_eq!(bytes[mode], 3);
    for (value, expected) in [
        (0, ERROR),
        (1, ERROR),
        (2, ERROR),
        (3, OK),
        (4, ERROR),
        (6, ERROR),
        (7, ERROR),
        (9, ERROR),
    ] {
        let mut content = bytes[..bytes.len() - 8].to_vec();
        content[mode] = value;
        let mut read = null_mut();
        assert_eq!(
            s.deserialize(&signed(content), &mut read),
            expected,
            "mode {value}"
        );
        assert_eq!(s.free_state(&mut read), OK);
    }
    let mut content = bytes[..bytes.len() - 8].to_vec();
    content[mode + 1..mode + 9].copy_from_slice(&f64::NAN.to_le_bytes());
    assert_eq!(s.deserialize(&signed(content), &mut null_mut()), ERROR);
    assert_eq!(s.free_state(&mut state), OK);
}

/// The unit may derive something from the start time.
#[test]
fn the_start_time_belongs_to_the_state() {
    for version in BOTH {
        let s = started(version);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let expected = run(&s, 1.0, 20);
        let other = Session::new(version, Kind::CoSimulation);
        assert_eq!(other.set(TAU, 0.3), OK);
        other.initialize(0.97, Some(100.0));
        assert_eq!(other.restore(state), OK);
        assert_eq!(run(&other, 1.0, 20), expected);
        assert_eq!(s.free_state(&mut state), OK);
    }
}

/// What can be read before the next step is a number too.
#[test]
fn a_state_whose_output_is_no_number_is_not_read() {
    for version in BOTH {
        let s = started(version);
        assert_eq!(s.set(U, 0.7), OK);
        assert_eq!(s.do_step(1.0, 0.1), OK);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let bytes = s.serialize(state);
        let mut content = bytes[..bytes.len() - 8].to_vec();
        let twice = s.get(TWICE).to_le_bytes();
        let at = content.windows(8).position(|w| w == twice);
        let at = at.expect("the output is in the state");
        content[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(s.deserialize(&signed(content), &mut null_mut()), ERROR);
        s.assert_error(&["gives twice = NaN", "must be finite"]);
        assert_eq!(s.free_state(&mut state), OK);
    }
}

/// A time that the unit's count of events knows nothing of: the step must not make up for all of them.
#[test]
fn a_state_whose_events_are_overdue_goes_nowhere() {
    for version in BOTH {
        let s = started(version);
        assert_eq!(s.do_step(1.0, 0.1875), OK);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        let bytes = s.serialize(state);
        let mut content = bytes[..bytes.len() - 8].to_vec();
        let now = 1.1875_f64.to_le_bytes();
        let time = content.windows(8).position(|w| w == now);
        let time = time.expect("the time is in the state");
        content[time..time + 8].copy_from_slice(&50.0_f64.to_le_bytes());
        let mut late = null_mut();
        assert_eq!(s.deserialize(&signed(content), &mut late), OK);
        assert_eq!(s.restore(late), OK);
        assert_eq!(s.do_step(50.0, 0.1), ERROR);
        s.assert_error(&["was never carried out"]);
        assert_eq!(s.restore(state), OK);
        assert_eq!(s.do_step(1.1875, 0.1), OK);
        for mut state in [state, late] {
            assert_eq!(s.free_state(&mut state), OK);
        }
    }
}

#[test]
fn states_of_other_formats_models_or_ranges_are_named() {
    let s = started(Version::Fmi3);
    let mut state = null_mut();
    assert_eq!(s.save(&mut state), OK);
    let bytes = s.serialize(state);
    let content = bytes[..bytes.len() - 8].to_vec();
    let mut read = null_mut();

    let mut other = content.clone();
    other[0] = 3;
    assert_eq!(s.deserialize(&signed(other), &mut read), ERROR);
    s.assert_error(&["format 3"]);

    let mut other = content.clone();
    other[2] = b'<';
    assert_eq!(s.deserialize(&signed(other), &mut read), ERROR);
    s.assert_error(&["another model", "<toy}"]);

    let tau = content
        .windows(8)
        .position(|w| w == 0.3_f64.to_le_bytes())
        .expect("tau is in the state");
    let mut other = content;
    other[tau..tau + 8].copy_from_slice(&(-0.3_f64).to_le_bytes());
    assert_eq!(s.deserialize(&signed(other), &mut read), ERROR);
    s.assert_error(&["tau = -0.3 s is outside"]);
    assert_eq!(s.free_state(&mut state), OK);
}

/// What the importer's solver gave is kept as it is; from elsewhere it is refused.
#[test]
fn a_state_that_is_no_number_is_not_read() {
    for version in BOTH {
        let s = Session::new(version, Kind::ModelExchange);
        s.initialize(0.0, None);
        s.update_discrete().unwrap();
        assert_eq!(s.enter_continuous_time(), OK);
        assert_eq!(s.set_states(&[f64::NAN]), OK);
        let mut state = null_mut();
        assert_eq!(s.save(&mut state), OK);
        assert_eq!(s.restore(state), OK);
        let mut read = null_mut();
        assert_eq!(s.deserialize(&s.serialize(state), &mut read), ERROR);
        s.assert_error(&["none that this model can be in"]);
        assert_eq!(s.set_states(&[1.0]), OK);
        assert_eq!(s.free_state(&mut state), OK);
    }
}
