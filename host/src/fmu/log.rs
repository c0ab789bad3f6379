//! Collects what FMUs log.

use super::status::Status;
use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Messages kept for each instance: the latest ones.
const CAPACITY: usize = 1000;

/// One log message of an FMU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Status that came with it.
    pub status: Status,
    /// Category.
    pub category: String,
    /// Text.
    pub text: String,
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.text)?;
        if self.category.is_empty() {
            Ok(())
        } else {
            write!(f, " [{}]", self.category)
        }
    }
}

/// The messages of one instance. FMUs may log from any thread.
#[derive(Debug, Default)]
pub(crate) struct Log(Mutex<VecDeque<Message>>);

impl Log {
    fn messages(&self) -> MutexGuard<'_, VecDeque<Message>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn push(&self, message: Message) {
        let mut messages = self.messages();
        if messages.len() == CAPACITY {
            messages.pop_front();
        }
        messages.push_back(message);
    }

    /// All messages kept so far, oldest first.
    pub(crate) fn all(&self) -> Vec<Message> {
        self.messages().iter().cloned().collect()
    }

    /// The latest `count` messages, oldest first.
    pub(crate) fn last(&self, count: usize) -> Vec<Message> {
        let messages = self.messages();
        messages
            .iter()
            .skip(messages.len().saturating_sub(count))
            .cloned()
            .collect()
    }
}

/// What an FMU holds as its environment and hands back with each message. The first field is known to
/// `logger.c`.
#[repr(C)]
pub(super) struct Environment {
    receive: unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char),
    pub(super) log: Log,
}

impl Environment {
    pub(super) fn new() -> Self {
        Self {
            receive,
            log: Log::default(),
        }
    }
}

/// Text of a C string that may be null or not UTF-8.
///
/// # Safety
/// `text` is null or a C string.
pub(super) unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, so a C string by contract.
    unsafe { CStr::from_ptr(text) }
        .to_string_lossy()
        .trim_end()
        .to_owned()
}

/// Takes one message; also the log callback of FMI 3.0.
///
/// # Safety
/// `environment` is null or points to a live [`Environment`]; the others are null or C strings.
pub(super) unsafe extern "C" fn receive(
    environment: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: by contract; the reference does not outlive the call.
    let Some(environment) = (unsafe { environment.cast::<Environment>().as_ref() }) else {
        return;
    };
    // SAFETY: null or C strings by contract.
    let (category, text) = unsafe { (text(category), text(message)) };
    environment.log.push(Message {
        status: Status::from(status),
        category,
        text,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmi_abi::fmi2::{fmi2CallbackLogger, fmi2String};

    #[test]
    fn variadic_messages_are_formatted() {
        let environment = Environment::new();
        let pointer: *const Environment = &environment;
        let log = super::super::fmi2::flexarm_fmi2_log;
        let _: fmi2CallbackLogger = Some(log);
        let (name, category): (fmi2String, fmi2String) = (c"i".as_ptr(), c"logError".as_ptr());
        let pointer: *mut c_void = pointer.cast_mut().cast();
        // SAFETY: arguments match the conversions; all pointers are live C strings or null.
        unsafe {
            log(
                pointer,
                name,
                3,
                category,
                c"%s is %d, %g".as_ptr(),
                c"x".as_ptr(),
                7 as c_int,
                0.5f64,
            );
            log(pointer, name, 1, std::ptr::null(), c"plain\n".as_ptr());
            log(pointer, name, 1, category, std::ptr::null());
            log(std::ptr::null_mut(), name, 1, category, c"nobody".as_ptr());
        }
        let messages = environment.log.all();
        assert_eq!(messages.len(), 2);
        assert_eq!(messages[0].to_string(), "x is 7, 0.5 [logError]");
        assert_eq!(messages[0].status, Status::Error);
        assert_eq!(messages[1].to_string(), "plain");
    }

    #[test]
    fn the_latest_messages_are_kept() {
        let log = Log::default();
        for i in 0..CAPACITY + 5 {
            log.push(Message {
                status: Status::Ok,
                category: String::new(),
                text: i.to_string(),
            });
        }
        assert_eq!(log.all().len(), CAPACITY);
        assert_eq!(log.last(1)[0].text, (CAPACITY + 4).to_string());
    }
}
