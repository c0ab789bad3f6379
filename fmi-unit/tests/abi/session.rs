//! An importer in a few lines: one set of calls for both versions of the interface.

use fmi_abi::fmi2::{fmi2CallbackFunctions, fmi2EventInfo};
use fmi_unit::{fmi2, fmi3};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use crate::toy::Toy;

pub const OK: c_int = 0;
pub const DISCARD: c_int = 2;
pub const ERROR: c_int = 3;
pub const FATAL: c_int = 4;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Version {
    Fmi2,
    Fmi3,
}
pub const BOTH: [Version; 2] = [Version::Fmi2, Version::Fmi3];

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    ModelExchange,
    CoSimulation,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub status: c_int,
    pub category: String,
    pub text: String,
}

pub type Messages = RefCell<Vec<Message>>;

fn text(s: *const c_char) -> String {
    unsafe { CStr::from_ptr(s) }.to_str().unwrap().to_owned()
}

pub unsafe extern "C" fn log3(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    let messages = unsafe { &*environment.cast::<Messages>() };
    messages.borrow_mut().push(Message {
        status,
        category: text(category),
        text: text(message),
    });
}

/// Stands in for a variadic function, which stable Rust cannot define.
unsafe extern "C" fn log2(
    environment: *mut c_void,
    instance: *const c_char,
    status: c_int,
    category: *const c_char,
    format: *const c_char,
    message: *const c_char,
) {
    assert_eq!(text(format), "%s");
    assert_eq!(text(instance), "toy");
    unsafe { log3(environment, status, category, message) }
}

pub struct Session {
    pub version: Version,
    pub handle: *mut c_void,
    pub messages: Box<Messages>,
}

/// How to instantiate.
pub struct Options {
    pub token: Option<&'static CStr>,
    pub name: Option<&'static CStr>,
    pub logging: bool,
    pub event_mode: bool,
    pub intermediate: fmi_abi::fmi3::fmi3IntermediateUpdateCallback,
    pub early_return: bool,
    pub environment: *mut c_void,
    pub logger: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            token: Some(c"{toy}"),
            name: Some(c"toy"),
            logging: true,
            event_mode: false,
            intermediate: None,
            early_return: false,
            environment: null_mut(),
            logger: true,
        }
    }
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
    pub fn new(version: Version, kind: Kind) -> Self {
        let session = Self::with(version, kind, Options::default());
        assert!(!session.handle.is_null(), "{:?}", session.messages);
        session
    }

    pub fn with(version: Version, kind: Kind, options: Options) -> Self {
        let messages: Box<Messages> = Box::default();
        let own = (&raw const *messages).cast_mut().cast::<c_void>();
        let environment = if options.environment.is_null() {
            own
        } else {
            options.environment
        };
        let name = options.name.map_or(null(), CStr::as_ptr);
        let token = options.token.map_or(null(), CStr::as_ptr);
        let logging = options.logging;
        let handle = match (version, kind) {
            (Version::Fmi2, kind) => {
                let log2: unsafe extern "C" fn(_, _, _, _, _, _) = log2;
                let callbacks = fmi2CallbackFunctions {
                    logger: options.logger.then(|| unsafe {
                        std::mem::transmute::<
                            unsafe extern "C" fn(
                                *mut c_void,
                                *const c_char,
                                c_int,
                                *const c_char,
                                *const c_char,
                                *const c_char,
                            ),
                            unsafe extern "C" fn(
                                *mut c_void,
                                *const c_char,
                                c_int,
                                *const c_char,
                                *const c_char,
                                ...
                            ),
                        >(log2)
                    }),
                    allocateMemory: None,
                    freeMemory: None,
                    stepFinished: None,
                    componentEnvironment: environment,
                };
                let kind = (kind == Kind::CoSimulation).into();
                unsafe {
                    fmi2::fmi2Instantiate::<Toy>(
                        name,
                        kind,
                        token,
                        null(),
                        &raw const callbacks,
                        0,
                        logging.into(),
                    )
                }
            }
            (Version::Fmi3, Kind::ModelExchange) => unsafe {
                let log = options.logger.then_some(log3 as _);
                fmi3::fmi3InstantiateModelExchange::<Toy>(
                    name,
                    token,
                    null(),
                    0,
                    logging.into(),
                    environment,
                    log,
                )
            },
            (Version::Fmi3, Kind::CoSimulation) => unsafe {
                let log = options.logger.then_some(log3 as _);
                fmi3::fmi3InstantiateCoSimulation::<Toy>(
                    name,
                    token,
                    null(),
                    0,
                    logging.into(),
                    options.event_mode.into(),
                    options.early_return.into(),
                    null(),
                    0,
                    environment,
                    log,
                    options.intermediate,
                )
            },
        };
        Self {
            version,
            handle,
            messages,
        }
    }

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
