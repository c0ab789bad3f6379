//! An importer in a few lines: one set of calls for both versions of the interface.

use fmi_abi::fmi2::fmi2EventInfo;
use fmi_unit::{fmi2, fmi3};
use std::ffi::{CString, c_int, c_void};

pub use crate::importer::*;
use crate::toy::Toy;

pub struct Session {
    pub version: Version,
    pub handle: *mut c_void,
    pub messages: Box<Messages>,
}

macro_rules! both {
    ($self:ident, $f2:ident($($a2:expr),*), $f3:ident($($a3:expr),*)) => {
        match $self.version {
            Version::Fmi2 => unsafe { fmi2::$f2::<Toy>($self.handle $(, $a2)*) },
            Version::Fmi3 => unsafe { fmi3::$f3::<Toy>($self.handle $(, $a3)*) },
        }
    };
}

impl Session {
    /// From instantiated to Step or Event Mode.
    pub fn initialize(&self, start: f64, stop: Option<f64>) {
        assert_eq!(self.enter_initialization(start, stop), OK);
        assert_eq!(self.exit_initialization(), OK, "{:?}", self.messages);
    }

    pub fn enter_initialization(&self, start: f64, stop: Option<f64>) -> c_int {
        let (defined, stop) = (stop.is_some(), stop.unwrap_or(0.0));
        match self.version {
            Version::Fmi2 => unsafe {
                let status = fmi2::fmi2SetupExperiment::<Toy>(
                    self.handle,
                    0,
                    0.0,
                    start,
                    defined.into(),
                    stop,
                );
                if status != OK {
                    return status;
                }
                fmi2::fmi2EnterInitializationMode::<Toy>(self.handle)
            },
            Version::Fmi3 => unsafe {
                fmi3::fmi3EnterInitializationMode::<Toy>(
                    self.handle,
                    0,
                    0.0,
                    start,
                    defined.into(),
                    stop,
                )
            },
        }
    }

    pub fn exit_initialization(&self) -> c_int {
        both!(
            self,
            fmi2ExitInitializationMode(),
            fmi3ExitInitializationMode()
        )
    }

    pub fn terminate(&self) -> c_int {
        both!(self, fmi2Terminate(), fmi3Terminate())
    }

    pub fn reset(&self) -> c_int {
        both!(self, fmi2Reset(), fmi3Reset())
    }

    pub fn do_step(&self, t: f64, h: f64) -> c_int {
        match self.version {
            Version::Fmi2 => unsafe { fmi2::fmi2DoStep::<Toy>(self.handle, t, h, 1) },
            Version::Fmi3 => self.do_step3(t, h).0,
        }
    }

    /// Status, early return, last successful time.
    pub fn do_step3(&self, t: f64, h: f64) -> (c_int, bool, f64) {
        let (mut event, mut end, mut early, mut last) = (7, 7, 7, f64::NAN);
        let status = unsafe {
            fmi3::fmi3DoStep::<Toy>(
                self.handle,
                t,
                h,
                1,
                &raw mut event,
                &raw mut end,
                &raw mut early,
                &raw mut last,
            )
        };
        if status == OK {
            assert_eq!((event, end), (0, 0));
        }
        (status, early != 0, last)
    }

    /// A step of an importer that uses Event Mode: whether an event is needed, whether the step ended
    /// early, and when.
    pub fn step_to_event(&self, t: f64, h: f64) -> (bool, bool, f64) {
        let (mut event, mut end, mut early, mut last) = (7, 7, 7, f64::NAN);
        let [event, end, early] = [&mut event, &mut end, &mut early];
        let status = unsafe {
            fmi3::fmi3DoStep::<Toy>(self.handle, t, h, 1, event, end, early, &raw mut last)
        };
        assert_eq!((status, *end), (OK, 0), "{:?}", self.messages);
        (*event != 0, *early != 0, last)
    }

    pub fn enter_step_mode(&self) -> c_int {
        unsafe { fmi3::fmi3EnterStepMode::<Toy>(self.handle) }
    }

    pub fn set_clocks(&self, clocks: &[u32], active: &[u8]) -> c_int {
        let (n, values) = (clocks.len(), active.as_ptr());
        unsafe { fmi3::fmi3SetClock::<Toy>(self.handle, clocks.as_ptr(), n, values) }
    }

    pub fn get_clock(&self, clock: u32) -> Result<bool, c_int> {
        let mut active = 7;
        match unsafe {
            fmi3::fmi3GetClock::<Toy>(self.handle, &raw const clock, 1, &raw mut active)
        } {
            OK => Ok(active != 0),
            status => Err(status),
        }
    }

    /// Interval, shift and qualifier of a clock.
    pub fn interval(&self, clock: u32) -> Result<(f64, f64, c_int), c_int> {
        let (clock, mut interval, mut shift) = (&raw const clock, f64::NAN, f64::NAN);
        let (h, mut qualifier) = (self.handle, 7);
        let q = &raw mut qualifier;
        match unsafe { fmi3::fmi3GetIntervalDecimal::<Toy>(h, clock, 1, &mut interval, q) } {
            OK => {}
            status => return Err(status),
        }
        assert_eq!(
            unsafe { fmi3::fmi3GetShiftDecimal::<Toy>(h, clock, 1, &mut shift) },
            OK
        );
        Ok((interval, shift, qualifier))
    }

    pub fn set_interval(&self, clock: u32, interval: f64) -> c_int {
        let (clock, interval) = (&raw const clock, &raw const interval);
        unsafe { fmi3::fmi3SetIntervalDecimal::<Toy>(self.handle, clock, 1, interval) }
    }

    pub fn activate(&self, clock: u32, time: f64) -> c_int {
        unsafe { fmi3::fmi3ActivateModelPartition::<Toy>(self.handle, clock, time) }
    }

    pub fn get(&self, vr: u32) -> f64 {
        let mut value = [f64::NAN];
        assert_eq!(self.get_reals(&[vr], &mut value), OK, "{:?}", self.messages);
        value[0]
    }

    pub fn get_reals(&self, vr: &[u32], v: &mut [f64]) -> c_int {
        both!(
            self,
            fmi2GetReal(vr.as_ptr(), vr.len(), v.as_mut_ptr()),
            fmi3GetFloat64(vr.as_ptr(), vr.len(), v.as_mut_ptr(), v.len())
        )
    }

    pub fn set(&self, vr: u32, value: f64) -> c_int {
        self.set_reals(&[vr], &[value])
    }

    pub fn set_reals(&self, vr: &[u32], v: &[f64]) -> c_int {
        both!(
            self,
            fmi2SetReal(vr.as_ptr(), vr.len(), v.as_ptr()),
            fmi3SetFloat64(vr.as_ptr(), vr.len(), v.as_ptr(), v.len())
        )
    }

    pub fn get_int(&self, vr: u32) -> i32 {
        let mut v = [-1];
        let p = v.as_mut_ptr();
        let status = both!(self, fmi2GetInteger(&vr, 1, p), fmi3GetInt32(&vr, 1, p, 1));
        assert_eq!(status, OK, "{:?}", self.messages);
        v[0]
    }

    pub fn set_int(&self, vr: u32, value: i32) -> c_int {
        both!(
            self,
            fmi2SetInteger(&vr, 1, &value),
            fmi3SetInt32(&vr, 1, &value, 1)
        )
    }

    pub fn set_enumeration(&self, vr: u32, value: i64) -> c_int {
        both!(
            self,
            fmi2SetInteger(&vr, 1, &i32::try_from(value).unwrap()),
            fmi3SetInt64(&vr, 1, &value, 1)
        )
    }

    /// `fmi3EnterConfigurationMode`.
    pub fn enter_configuration(&self) -> c_int {
        unsafe { fmi3::fmi3EnterConfigurationMode::<Toy>(self.handle) }
    }

    /// `fmi3ExitConfigurationMode`.
    pub fn exit_configuration(&self) -> c_int {
        unsafe { fmi3::fmi3ExitConfigurationMode::<Toy>(self.handle) }
    }

    /// Configuration Mode with one value in it.
    pub fn configure(&self, vr: u32, value: u64) {
        assert_eq!(self.enter_configuration(), OK, "{:?}", self.messages);
        assert_eq!(self.set_size(vr, value), OK, "{:?}", self.messages);
        assert_eq!(self.exit_configuration(), OK, "{:?}", self.messages);
    }

    /// `fmi3SetUInt64`.
    pub fn set_size(&self, vr: u32, value: u64) -> c_int {
        unsafe { fmi3::fmi3SetUInt64::<Toy>(self.handle, &vr, 1, &value, 1) }
    }

    /// `fmi3GetUInt64`.
    pub fn get_size(&self, vr: u32) -> u64 {
        let mut value = u64::MAX;
        let status = unsafe { fmi3::fmi3GetUInt64::<Toy>(self.handle, &vr, 1, &mut value, 1) };
        assert_eq!(status, OK, "{:?}", self.messages);
        value
    }

    pub fn set_boolean(&self, vr: u32, value: u8) -> c_int {
        both!(
            self,
            fmi2SetBoolean(&vr, 1, &value.into()),
            fmi3SetBoolean(&vr, 1, &value, 1)
        )
    }

    pub fn save(&self, state: &mut *mut c_void) -> c_int {
        both!(self, fmi2GetFMUstate(state), fmi3GetFMUState(state))
    }

    pub fn restore(&self, state: *mut c_void) -> c_int {
        both!(self, fmi2SetFMUstate(state), fmi3SetFMUState(state))
    }

    pub fn free_state(&self, state: &mut *mut c_void) -> c_int {
        both!(self, fmi2FreeFMUstate(state), fmi3FreeFMUState(state))
    }

    pub fn serialize(&self, state: *mut c_void) -> Vec<u8> {
        let mut size = 0;
        let p = &raw mut size;
        let status = both!(
            self,
            fmi2SerializedFMUstateSize(state, p),
            fmi3SerializedFMUStateSize(state, p)
        );
        assert_eq!(status, OK);
        let mut bytes = vec![0xaa_u8; size + 8];
        let p = bytes.as_mut_ptr();
        let status = both!(
            self,
            fmi2SerializeFMUstate(state, p.cast(), size),
            fmi3SerializeFMUState(state, p, size)
        );
        assert_eq!(status, OK);
        assert_eq!(bytes.split_off(size), [0xaa; 8]);
        bytes
    }

    pub fn deserialize(&self, bytes: &[u8], state: &mut *mut c_void) -> c_int {
        let (p, n) = (bytes.as_ptr(), bytes.len());
        both!(
            self,
            fmi2DeSerializeFMUstate(p.cast(), n, state),
            fmi3DeserializeFMUState(p, n, state)
        )
    }

    pub fn set_time(&self, t: f64) -> c_int {
        both!(self, fmi2SetTime(t), fmi3SetTime(t))
    }

    pub fn set_states(&self, x: &[f64]) -> c_int {
        let (p, n) = (x.as_ptr(), x.len());
        both!(
            self,
            fmi2SetContinuousStates(p, n),
            fmi3SetContinuousStates(p, n)
        )
    }

    pub fn get_states(&self, x: &mut [f64]) -> c_int {
        let (p, n) = (x.as_mut_ptr(), x.len());
        both!(
            self,
            fmi2GetContinuousStates(p, n),
            fmi3GetContinuousStates(p, n)
        )
    }

    /// `[unknowns, knowns]`.
    pub fn directional(&self, [u, k]: [&[u32]; 2], seed: &[f64], out: &mut [f64]) -> c_int {
        let (unknowns, knowns, p, n) = (u.as_ptr(), k.as_ptr(), seed.as_ptr(), seed.len());
        let (result, m) = (out.as_mut_ptr(), out.len());
        both!(
            self,
            fmi2GetDirectionalDerivative(unknowns, u.len(), knowns, k.len(), p, result),
            fmi3GetDirectionalDerivative(unknowns, u.len(), knowns, k.len(), p, n, result, m)
        )
    }

    /// `[unknowns, knowns]`; FMI 3.0 alone has it.
    pub fn adjoint(&self, [u, k]: [&[u32]; 2], seed: &[f64], out: &mut [f64]) -> c_int {
        let (unknowns, knowns, p, n) = (u.as_ptr(), k.as_ptr(), seed.as_ptr(), seed.len());
        let (result, m) = (out.as_mut_ptr(), out.len());
        unsafe {
            fmi3::fmi3GetAdjointDerivative::<Toy>(
                self.handle,
                unknowns,
                u.len(),
                knowns,
                k.len(),
                p,
                n,
                result,
                m,
            )
        }
    }

    pub fn get_derivatives(&self, x: &mut [f64]) -> c_int {
        let (p, n) = (x.as_mut_ptr(), x.len());
        both!(
            self,
            fmi2GetDerivatives(p, n),
            fmi3GetContinuousStateDerivatives(p, n)
        )
    }

    pub fn enter_event_mode(&self) -> c_int {
        both!(self, fmi2EnterEventMode(), fmi3EnterEventMode())
    }

    pub fn enter_continuous_time(&self) -> c_int {
        both!(
            self,
            fmi2EnterContinuousTimeMode(),
            fmi3EnterContinuousTimeMode()
        )
    }

    /// Whether Event Mode must be entered.
    pub fn completed_step(&self) -> Result<bool, c_int> {
        let (status, event) = match self.version {
            Version::Fmi2 => {
                let (mut event, mut end) = (7, 7);
                let status = unsafe {
                    fmi2::fmi2CompletedIntegratorStep::<Toy>(
                        self.handle,
                        1,
                        &raw mut event,
                        &raw mut end,
                    )
                };
                (status, event != 0)
            }
            Version::Fmi3 => {
                let (mut event, mut end) = (7, 7);
                let status = unsafe {
                    fmi3::fmi3CompletedIntegratorStep::<Toy>(
                        self.handle,
                        1,
                        &raw mut event,
                        &raw mut end,
                    )
                };
                (status, event != 0)
            }
        };
        if status == OK { Ok(event) } else { Err(status) }
    }

    /// Again, states changed, next event.
    pub fn update_discrete(&self) -> Result<(bool, bool, Option<f64>), c_int> {
        match self.version {
            Version::Fmi2 => {
                let mut info = fmi2EventInfo::default();
                match unsafe { fmi2::fmi2NewDiscreteStates::<Toy>(self.handle, &raw mut info) } {
                    OK => Ok((
                        info.newDiscreteStatesNeeded != 0,
                        info.valuesOfContinuousStatesChanged != 0,
                        (info.nextEventTimeDefined != 0).then_some(info.nextEventTime),
                    )),
                    status => Err(status),
                }
            }
            Version::Fmi3 => {
                let mut b = [7_u8; 5];
                let mut next = f64::NAN;
                let [again, end, nominals, states, defined] = &mut b;
                match unsafe {
                    fmi3::fmi3UpdateDiscreteStates::<Toy>(
                        self.handle,
                        again,
                        end,
                        nominals,
                        states,
                        defined,
                        &raw mut next,
                    )
                } {
                    OK => {
                        assert_eq!((*end, *nominals), (0, 0));
                        Ok((*again != 0, *states != 0, (*defined != 0).then_some(next)))
                    }
                    status => Err(status),
                }
            }
        }
    }

    pub fn set_debug_logging(&self, on: bool, categories: &[&str]) -> c_int {
        let owned: Vec<_> = categories
            .iter()
            .map(|&c| CString::new(c).unwrap())
            .collect();
        let pointers: Vec<_> = owned.iter().map(|c| c.as_ptr()).collect();
        let (p, n) = (pointers.as_ptr(), pointers.len());
        both!(
            self,
            fmi2SetDebugLogging(on.into(), n, p),
            fmi3SetDebugLogging(on.into(), n, p)
        )
    }

    /// The last message, which must be one.
    pub fn last(&self) -> Message {
        self.messages.borrow().last().expect("a message").clone()
    }

    /// Asserts that the last message is an error about all of `parts`.
    pub fn assert_error(&self, parts: &[&str]) {
        let message = self.last();
        assert_eq!(message.status, ERROR, "{message:?}");
        assert_eq!(message.category, "logStatusError");
        for part in parts {
            assert!(message.text.contains(part), "{message:?} lacks {part:?}");
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        match self.version {
            Version::Fmi2 => unsafe { fmi2::fmi2FreeInstance::<Toy>(self.handle) },
            Version::Fmi3 => unsafe { fmi3::fmi3FreeInstance::<Toy>(self.handle) },
        }
    }
}
