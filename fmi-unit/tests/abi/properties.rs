//! What holds for any steps, any calls and any bytes.

use proptest::prelude::*;
use std::ptr::null_mut;

use crate::session::{ERROR, FATAL, Kind, OK, Session, Version};
use crate::toy::*;

fn version() -> impl Strategy<Value = Version> {
    prop_oneof![Just(Version::Fmi2), Just(Version::Fmi3)]
}

#[derive(Clone, Debug)]
enum Call {
    EnterInitialization,
    ExitInitialization,
    Step(f64),
    Terminate,
    Reset,
    Set(u32, f64),
    SetBehaviour(i64),
    Get(u32),
    Save,
    Restore,
    Serialize,
    SetTime(f64),
    SetStates(f64),
    GetStates,
    EventMode,
    Update,
    ContinuousTime,
    Completed,
}

fn call() -> impl Strategy<Value = Call> {
    let number = prop_oneof![
        -2.0..2.0_f64,
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(1e300),
        Just(0.1)
    ];
    let behaviour = prop_oneof![
        Just(NORMAL),
        Just(FAIL_IN_EVENT),
        Just(STUCK),
        Just(FAIL_IN_ADVANCE),
        Just(99)
    ];
    prop_oneof![
        2 => Just(Call::EnterInitialization),
        2 => Just(Call::ExitInitialization),
        4 => (0.01..0.5_f64).prop_map(Call::Step),
        1 => Just(Call::Terminate),
        1 => Just(Call::Reset),
        3 => (0..30_u32, number.clone()).prop_map(|(vr, v)| Call::Set(vr, v)),
        1 => behaviour.prop_map(Call::SetBehaviour),
        2 => (0..30_u32).prop_map(Call::Get),
        1 => Just(Call::Save),
        2 => Just(Call::Restore),
        1 => Just(Call::Serialize),
        1 => number.clone().prop_map(Call::SetTime),
        1 => number.prop_map(Call::SetStates),
        1 => Just(Call::GetStates),
        1 => Just(Call::EventMode),
        1 => Just(Call::Update),
        1 => Just(Call::ContinuousTime),
        1 => Just(Call::Completed),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// However a stretch of time is divided, each sample is taken once and the lag is exact.
    #[test]
    fn steps_divide_time_at_will(
        version in version(),
        start in -10.0..10.0_f64,
        period in 0.01..0.5_f64,
        sizes in prop::collection::vec(1e-3..0.3_f64, 1..60),
    ) {
        let s = Session::new(version, Kind::CoSimulation);
        prop_assert_eq!(s.set(PERIOD, period), OK);
        prop_assert_eq!(s.set(BIAS, 3.0), OK);
        prop_assert_eq!(s.set(U, 1.0), OK);
        s.initialize(start, None);
        let mut t = start;
        for size in sizes {
            prop_assert_eq!(s.do_step(t, size), OK);
            t += size;
        }
        let periods = (t - start) / period;
        // A sample this close to the end may be on either side.
        prop_assume!((periods - periods.round()).abs() > 1e-4);
        prop_assert_eq!(s.get_int(SAMPLES), periods.ceil() as i32);
        prop_assert!((s.get(X) - 1.0 - 2.0 * (start - t).exp()).abs() < 1e-9);
    }

    /// No sequence of calls is fatal, whatever the importer does.
    #[test]
    fn no_sequence_of_calls_is_fatal(
        version in version(),
        exchange in any::<bool>(),
        calls in prop::collection::vec(call(), 1..60),
    ) {
        let kind = if exchange { Kind::ModelExchange } else { Kind::CoSimulation };
        let s = Session::new(version, kind);
        let mut state = null_mut();
        for call in calls {
            let value = &mut [0.0];
            let status = match call {
                Call::EnterInitialization => s.enter_initialization(0.0, None),
                Call::ExitInitialization => s.exit_initialization(),
                Call::Step(h) => {
                    let t = &mut [0.0];
                    match s.get_reals(&[TIME], t) {
                        OK => s.do_step(t[0], h),
                        status => status,
                    }
                }
                Call::Terminate => s.terminate(),
                Call::Reset => s.reset(),
                Call::Set(vr, v) => s.set(vr, v),
                Call::SetBehaviour(v) => s.set_enumeration(BEHAVIOUR, v),
                Call::Get(vr) => s.get_reals(&[vr], value),
                Call::Save => s.save(&mut state),
                Call::Restore => s.restore(state),
                Call::Serialize if state.is_null() => OK,
                Call::Serialize => {
                    let mut copy = null_mut();
                    let status = s.deserialize(&s.serialize(state), &mut copy);
                    prop_assert_eq!(s.free_state(&mut copy), OK);
                    status
                }
                Call::SetTime(t) => s.set_time(t),
                Call::SetStates(x) => s.set_states(&[x]),
                Call::GetStates => s.get_states(value),
                Call::EventMode => s.enter_event_mode(),
                Call::Update => s.update_discrete().map_or_else(|e| e, |_| OK),
                Call::ContinuousTime => s.enter_continuous_time(),
                Call::Completed => s.completed_step().map_or_else(|e| e, |_| OK),
            };
            prop_assert!(status == OK || status == ERROR, "{:?}", s.messages);
            prop_assert_ne!(status, FATAL);
        }
        prop_assert_eq!(s.free_state(&mut state), OK);
        prop_assert_eq!(s.reset(), OK);
    }

    /// A state saved anywhere brings back every value, bit for bit.
    #[test]
    fn a_saved_state_is_the_whole_state(
        version in version(),
        before in 0..40_u32,
        inputs in prop::collection::vec(-3.0..3.0_f64, 1..40),
        size in 0.01..0.3_f64,
    ) {
        let s = Session::new(version, Kind::CoSimulation);
        s.initialize(0.0, None);
        for k in 0..before {
            prop_assert_eq!(s.do_step(f64::from(k) * size, size), OK);
        }
        let mut state = null_mut();
        prop_assert_eq!(s.save(&mut state), OK);
        let run = |s: &Session| {
            let mut trace = Vec::new();
            for (k, &u) in inputs.iter().enumerate() {
                assert_eq!(s.set(U, u), OK);
                assert_eq!(s.do_step(f64::from(before + k as u32) * size, size), OK);
                trace.push((s.get(X).to_bits(), s.get(SAMPLED).to_bits(), s.get_int(SAMPLES)));
            }
            trace
        };
        let expected = run(&s);
        prop_assert_eq!(s.restore(state), OK);
        prop_assert_eq!(run(&s), expected);
        prop_assert_eq!(s.free_state(&mut state), OK);
    }

    /// Bytes from anywhere are an error.
    #[test]
    fn foreign_bytes_are_an_error(
        version in version(),
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let s = Session::new(version, Kind::CoSimulation);
        let mut state = null_mut();
        prop_assert_eq!(s.deserialize(&bytes, &mut state), ERROR);
        prop_assert!(state.is_null());
    }
}
