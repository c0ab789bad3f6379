//! Serialized states that were changed behind their check sum. One unit in a program: each defines the same
//! functions of the standard.

#![allow(non_upper_case_globals, reason = "the names are the standard's")]

use fmi_unit::fmi3::*;
use fmi_unit::model::{Causality, Kind, Variables};
use fmi_unit::{Unit, abi::fmi3::*};
use std::ffi::{CString, c_void};
use std::ptr::{null, null_mut};

const STEP: f64 = 0.00025;
/// Samples before the last of the valid states is saved.
const RUN: u32 = 450;
/// Samples after a state.
pub const SAMPLES: u32 = 3;

/// Numbers that are not what is expected.
const NUMBERS: [f64; 8] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e300,
    -1e300,
    5e-324,
    -1.0,
    0.0,
];

/// An instance for Co-Simulation.
struct Instance<U: Unit>(fmi3Instance, std::marker::PhantomData<U>);

impl<U: Unit> Instance<U> {
    fn new() -> Self {
        let token = CString::new(U::Variables::MODEL.token).expect("a token");
        // SAFETY: the strings live long enough; no callback is asked for.
        let handle = unsafe {
            fmi3InstantiateCoSimulation::<U>(
                c"fuzz".as_ptr(),
                token.as_ptr(),
                null(),
                0,
                0,
                0,
                0,
                null(),
                0,
                null_mut(),
                None,
                None,
            )
        };
        assert!(!handle.is_null());
        Self(handle, std::marker::PhantomData)
    }

    fn initialize(&self) {
        // SAFETY: the instance is alive until it is dropped, here and below.
        unsafe {
            assert_eq!(
                fmi3EnterInitializationMode::<U>(self.0, 0, 0.0, 0.0, 0, 0.0),
                fmi3OK
            );
            assert_eq!(fmi3ExitInitializationMode::<U>(self.0), fmi3OK);
        }
    }

    fn step(&self, at: f64) -> fmi3Status {
        let (mut event, mut end, mut early, mut last) = (0, 0, 0, 0.0);
        // SAFETY: see above.
        unsafe {
            fmi3DoStep::<U>(
                self.0,
                at,
                STEP,
                1,
                &raw mut event,
                &raw mut end,
                &raw mut early,
                &raw mut last,
            )
        }
    }

    fn serialized(&self) -> Vec<u8> {
        let (mut state, mut size) = (null_mut::<c_void>(), 0);
        // SAFETY: see above; the buffer is as long as said.
        unsafe {
            assert_eq!(fmi3GetFMUState::<U>(self.0, &raw mut state), fmi3OK);
            assert_eq!(
                fmi3SerializedFMUStateSize::<U>(self.0, state, &raw mut size),
                fmi3OK
            );
            let mut bytes = vec![0; size];
            assert_eq!(
                fmi3SerializeFMUState::<U>(self.0, state, bytes.as_mut_ptr(), size),
                fmi3OK
            );
            assert_eq!(fmi3FreeFMUState::<U>(self.0, &raw mut state), fmi3OK);
            bytes
        }
    }

    /// Whether the state was accepted.
    fn restore(&self, bytes: &[u8]) -> bool {
        let mut state = null_mut();
        // SAFETY: see above.
        unsafe {
            let read =
                fmi3DeserializeFMUState::<U>(self.0, bytes.as_ptr(), bytes.len(), &raw mut state);
            assert!(matches!(read, fmi3OK | fmi3Error), "deserialize: {read}");
            if read == fmi3Error {
                return false;
            }
            let set = fmi3SetFMUState::<U>(self.0, state);
            assert!(matches!(set, fmi3OK | fmi3Error), "set: {set}");
            assert_eq!(fmi3FreeFMUState::<U>(self.0, &raw mut state), fmi3OK);
            set == fmi3OK
        }
    }

    /// All outputs must be numbers.
    fn check_outputs(&self) {
        for variable in U::Variables::MODEL.variables {
            if variable.causality != Causality::Output
                || variable.kind != Kind::Float64
                || variable.dimension.is_some()
            {
                continue;
            }
            let mut value = f64::NAN;
            // SAFETY: see above.
            let read = unsafe {
                fmi3GetFloat64::<U>(self.0, &variable.value_reference, 1, &raw mut value, 1)
            };
            assert!(matches!(read, fmi3OK | fmi3Error), "get: {read}");
            assert!(
                read == fmi3Error || value.is_finite(),
                "{} is {value}",
                variable.name
            );
        }
    }
}

impl<U: Unit> Drop for Instance<U> {
    fn drop(&mut self) {
        // SAFETY: it is freed once.
        unsafe { fmi3FreeInstance::<U>(self.0) }
    }
}

/// A valid state is edited as `script` says, in words of five bytes (operation, position, value), and what is
/// accepted runs on for [`SAMPLES`] at most; how many of them came about, none if the state was refused.
pub fn go_on_from<U: Unit>(script: &[u8]) -> Option<u32> {
    thread_local!(static VALID: std::cell::RefCell<Vec<Vec<u8>>> = const { std::cell::RefCell::new(Vec::new()) });
    let valid = VALID.with_borrow_mut(|valid| {
        if valid.is_empty() {
            let instance = Instance::<U>::new();
            valid.push(instance.serialized());
            instance.initialize();
            valid.push(instance.serialized());
            for k in 0..RUN {
                assert_eq!(instance.step(f64::from(k) * STEP), fmi3OK);
            }
            valid.push(instance.serialized());
        }
        valid.clone()
    });
    let (first, script) = script.split_first()?;
    let base = usize::from(*first) % valid.len();
    let mut content = valid[base].clone();
    content.truncate(content.len() - 8);
    edit(&mut content, script);
    content.extend(check_sum(&content).to_le_bytes());

    let instance = Instance::<U>::new();
    if !instance.restore(&content) {
        return None;
    }
    instance.check_outputs();
    if base == 0 {
        // SAFETY: the instance is alive.
        let [entered, left] = unsafe {
            [
                fmi3EnterInitializationMode::<U>(instance.0, 0, 0.0, 0.0, 0, 0.0),
                fmi3ExitInitializationMode::<U>(instance.0),
            ]
        };
        assert!(entered != fmi3Fatal && left != fmi3Fatal);
        if left > fmi3Warning {
            return Some(0);
        }
    }
    let begin = if base == 2 { RUN } else { 0 };
    for k in 0..SAMPLES {
        let status = instance.step(f64::from(begin + k) * STEP);
        assert_ne!(status, fmi3Fatal);
        if status > fmi3Warning {
            return Some(k);
        }
        instance.check_outputs();
    }
    Some(SAMPLES)
}

fn edit(content: &mut Vec<u8>, script: &[u8]) {
    for word in script.chunks_exact(5).take(16) {
        let &[operation, high, low, a, b] = word else {
            unreachable!("five bytes")
        };
        if content.is_empty() {
            return;
        }
        let at = usize::from(u16::from_be_bytes([high, low])) % content.len();
        match operation % 6 {
            0 => content[at] = a,
            1 => content[at] ^= 1 << (a % 8),
            2 => content.insert(at, a),
            3 => drop(content.drain(at..(at + usize::from(a % 16)).min(content.len()))),
            4 => content.truncate(at),
            _ => {
                let number = NUMBERS[usize::from(a) % NUMBERS.len()] * (1.0 + f64::from(b));
                let room = content.len().min(at + 8) - at;
                content[at..at + room].copy_from_slice(&number.to_le_bytes()[..room]);
            }
        }
    }
}

/// That of the serialized form.
fn check_sum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
