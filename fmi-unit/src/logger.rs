//! The way of a message from the instance to the importer's logger.

use fmi_abi::fmi2::{fmi2CallbackFunctions, fmi2ComponentEnvironment, fmi2String};
use fmi_abi::fmi3::{fmi3InstanceEnvironment, fmi3LogMessageCallback};
use std::ffi::{CString, c_char, c_int};
use std::fmt::Arguments;

use crate::log::Severity;
use crate::unit::Failure;

/// Categories of the interface's own messages.
pub(crate) const ERROR: &str = "logStatusError";
pub(crate) const WARNING: &str = "logStatusWarning";
pub(crate) const FATAL: &str = "logStatusFatal";

/// Where messages go, copied from what the importer passed when it instantiated.
#[derive(Clone, Copy)]
enum Target {
    Nowhere,
    Fmi2(
        unsafe extern "C" fn(
            fmi2ComponentEnvironment,
            fmi2String,
            c_int,
            fmi2String,
            fmi2String,
            ...
        ),
        fmi2ComponentEnvironment,
    ),
    Fmi3(
        unsafe extern "C" fn(fmi3InstanceEnvironment, c_int, *const c_char, *const c_char),
        fmi3InstanceEnvironment,
    ),
}

/// A logger with its switches.
#[derive(Clone)]
pub(crate) struct Logger {
    target: Target,
    instance: CString,
    categories: &'static [&'static str],
    /// One switch for each category.
    wanted: Vec<bool>,
    /// Whether messages of categories that the model does not declare go out.
    undeclared: bool,
}

impl Logger {
    /// For FMI 2.0; a null `callbacks` or logger swallows the messages.
    ///
    /// # Safety
    /// `callbacks` is null or points to callbacks that stay valid as long as the logger.
    pub(crate) unsafe fn fmi2(callbacks: *const fmi2CallbackFunctions) -> Self {
        // SAFETY: by contract null or valid.
        let target = match unsafe { callbacks.as_ref() } {
            Some(&fmi2CallbackFunctions {
                logger: Some(logger),
                componentEnvironment,
                ..
            }) => Target::Fmi2(logger, componentEnvironment),
            _ => Target::Nowhere,
        };
        Self::new(target)
    }

    /// For FMI 3.0; a null callback swallows the messages.
    pub(crate) fn fmi3(
        callback: fmi3LogMessageCallback,
        environment: fmi3InstanceEnvironment,
    ) -> Self {
        Self::new(callback.map_or(Target::Nowhere, |f| Target::Fmi3(f, environment)))
    }

    fn new(target: Target) -> Self {
        Self {
            target,
            instance: CString::default(),
            categories: &[],
            wanted: Vec::new(),
            undeclared: true,
        }
    }

    /// Names the instance and its categories. Errors and fatal failures always go out unless the
    /// importer switches them off explicitly; `on` decides about the rest.
    pub(crate) fn identify(
        &mut self,
        instance: &str,
        categories: &'static [&'static str],
        on: bool,
    ) {
        self.instance = c_string(format_args!("{instance}"));
        self.categories = categories;
        self.wanted = categories
            .iter()
            .map(|&c| on || c == ERROR || c == FATAL)
            .collect();
        self.undeclared = on;
    }

    /// `fmi2SetDebugLogging` and `fmi3SetDebugLogging`: on with no categories means all of them.
    pub(crate) fn switch(&mut self, on: bool, categories: &[&str]) -> Result<(), Failure> {
        if let Some(unknown) = categories.iter().find(|c| !self.categories.contains(c)) {
            return Err(Failure(format!(
                "log category \"{unknown}\" is none of {}",
                self.categories.join(", ")
            )));
        }
        self.undeclared = on && categories.is_empty();
        for (wanted, category) in self.wanted.iter_mut().zip(self.categories) {
            *wanted = on && (categories.is_empty() || categories.contains(category));
        }
        Ok(())
    }

    fn wants(&self, category: &str) -> bool {
        match self.categories.iter().position(|&c| c == category) {
            Some(i) => self.wanted[i],
            None => self.undeclared,
        }
    }

    /// Sends a message on, if its category is wanted. Allocates only then.
    pub(crate) fn write(&self, severity: Severity, category: &str, message: Arguments<'_>) {
        if matches!(self.target, Target::Nowhere) || !self.wants(category) {
            return;
        }
        let category = c_string(format_args!("{category}"));
        let message = c_string(message);
        let status = match severity {
            Severity::Info => 0,
            Severity::Warning => 1,
            Severity::Error => 3,
            Severity::Fatal => 4,
        };
        match self.target {
            Target::Nowhere => {}
            // SAFETY: the importer's logger, called as the standard says: a format that prints one
            // string, and that string.
            Target::Fmi2(logger, environment) => unsafe {
                logger(
                    environment,
                    self.instance.as_ptr(),
                    status,
                    category.as_ptr(),
                    c"%s".as_ptr(),
                    message.as_ptr(),
                );
            },
            // SAFETY: the importer's logger, called as the standard says.
            Target::Fmi3(logger, environment) => unsafe {
                logger(environment, status, category.as_ptr(), message.as_ptr());
            },
        }
    }
}

/// As a C string; a null character inside, which C could not see past, becomes a blank.
fn c_string(text: Arguments<'_>) -> CString {
    let mut bytes = text.to_string().into_bytes();
    for byte in &mut bytes {
        if *byte == 0 {
            *byte = b' ';
        }
    }
    CString::new(bytes).unwrap_or_default()
}
