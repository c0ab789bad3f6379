//! What an importer passes when it instantiates, and what it hears from the logger.

use fmi_abi::fmi2::fmi2CallbackFunctions;
use fmi_unit::{fmi2, fmi3};
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr::{null, null_mut};

use crate::session::Session;
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
    /// FMI 3.0 alone has it.
    ScheduledExecution,
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

/// How to instantiate.
pub struct Options {
    pub token: Option<&'static CStr>,
    pub name: Option<&'static CStr>,
    pub logging: bool,
    pub event_mode: bool,
    pub intermediate: fmi_abi::fmi3::fmi3IntermediateUpdateCallback,
    pub early_return: bool,
    pub lock: fmi_abi::fmi3::fmi3LockPreemptionCallback,
    pub unlock: fmi_abi::fmi3::fmi3UnlockPreemptionCallback,
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
            lock: None,
            unlock: None,
            environment: null_mut(),
            logger: true,
        }
    }
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
        let log = options.logger.then_some(log3 as _);
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
            (Version::Fmi3, Kind::ScheduledExecution) => unsafe {
                fmi3::fmi3InstantiateScheduledExecution::<Toy>(
                    name,
                    token,
                    null(),
                    0,
                    logging.into(),
                    environment,
                    log,
                    None,
                    options.lock,
                    options.unlock,
                )
            },
            (Version::Fmi3, Kind::CoSimulation) => unsafe {
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
}
