//! What a call to an FMU returned. Foreign values may be any integer.

use std::fmt;

/// Status of a call (FMI 2.0.4 sec 2.1.3, FMI 3.0 sec 2.2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All well.
    Ok,
    /// All well, but a message was logged.
    Warning,
    /// The call was refused; the instance is as before.
    Discard,
    /// The call failed; the instance can only be reset or freed.
    Error,
    /// No instance of the FMU may be called again.
    Fatal,
    /// An asynchronous step is under way (FMI 2.0).
    Pending,
    /// No value of the standard.
    Unknown(i32),
}

impl From<i32> for Status {
    fn from(status: i32) -> Self {
        match status {
            0 => Self::Ok,
            1 => Self::Warning,
            2 => Self::Discard,
            3 => Self::Error,
            4 => Self::Fatal,
            5 => Self::Pending,
            other => Self::Unknown(other),
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(status) => write!(f, "the unknown status {status}"),
            known => write!(f, "{known:?}"),
        }
    }
}

/// A call that did not succeed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Failed {
    /// The function returned a status other than OK and Warning.
    Status(&'static str, Status),
    /// The binary lacks the function.
    Missing(&'static str),
    /// The FMU ended the simulation at this time \[s\].
    Terminated(f64),
    /// The FMU returned from a step at this time \[s\], though that was not allowed.
    ReturnedEarly(f64),
}

/// Ok for OK and Warning.
pub(super) fn check(function: &'static str, status: i32) -> Result<(), Failed> {
    match Status::from(status) {
        Status::Ok | Status::Warning => Ok(()),
        status => Err(Failed::Status(function, status)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ok_and_warning_succeed() {
        for status in -2..9 {
            assert_eq!(
                check("f", status).is_ok(),
                (0..=1).contains(&status),
                "{status}"
            );
        }
        assert_eq!(Status::from(77).to_string(), "the unknown status 77");
    }
}
