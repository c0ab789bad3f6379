//! The one way into an instance: every exported function goes through [`enter`].
//!
//! A panic must not cross into the importer, which is C: it becomes status Fatal and a log message,
//! and the instance is poisoned, so that no later call can see the state that the panic left behind.

use fmi_abi::fmi3::{fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback};
use std::any::Any;
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU8, Ordering};

use crate::instance::Instance;
use crate::legality::Row;
use crate::log::Severity;
use crate::logger::{ERROR, FATAL, Logger};
use crate::unit::{Failure, Unit};

/// Outcome of a call; the numbers are those of `fmi2Status` and `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Status {
    Ok = 0,
    Error = 3,
    Fatal = 4,
}

const IDLE: u8 = 0;
/// A call is under way: the importer calls from a callback or from another thread.
const BUSY: u8 = 1;
const POISONED: u8 = 2;

/// Attempts to get hold of an instance in Scheduled Execution; some 10 ms.
const PATIENCE: u32 = 1 << 20;

/// Callbacks of an importer that preempts one partition by another (FMI 3.0 sec 5.2.1).
#[derive(Clone, Copy, Default)]
pub(crate) struct Preemption {
    pub(crate) lock: fmi3LockPreemptionCallback,
    pub(crate) unlock: fmi3UnlockPreemptionCallback,
}

/// What an instance pointer points to.
pub(crate) struct Handle<U: Unit> {
    occupancy: AtomicU8,
    preemption: Preemption,
    instance: UnsafeCell<Instance<U>>,
}

/// Carries out `body` on the instance, if `row` allows the call `name` in the instance's mode. A failure
/// is logged as an error.
///
/// # Safety
/// `handle` is null or was made by [`create`] for the same `U` and not yet given to [`release`].
pub(crate) unsafe fn enter<U: Unit, T>(
    handle: *mut c_void,
    name: &'static str,
    row: &Row,
    body: impl FnOnce(&mut Instance<U>) -> Result<T, Failure>,
) -> Result<T, Status> {
    // SAFETY: by contract.
    let handle = unsafe { find::<U>(handle)? };
    handle.claim()?;
    // SAFETY: claimed.
    unsafe { carry_out(handle, name, row, body) }
}

/// [`enter`] that waits for a call under way, however long that takes: what `body` brings must not be lost.
///
/// # Safety
/// As for [`enter`]; not from a callback of the same instance.
pub(crate) unsafe fn enter_when_idle<U: Unit, T>(
    handle: *mut c_void,
    name: &'static str,
    row: &Row,
    body: impl FnOnce(&mut Instance<U>) -> Result<T, Failure>,
) -> Result<T, Status> {
    // SAFETY: by contract.
    let handle = unsafe { find::<U>(handle)? };
    while let Err(status) = handle.claim() {
        if status == Status::Fatal {
            return Err(status);
        }
        std::thread::yield_now();
    }
    // SAFETY: claimed.
    unsafe { carry_out(handle, name, row, body) }
}

/// What an instance pointer points to; an error if it is null.
///
/// # Safety
/// As for [`enter`].
unsafe fn find<'a, U: Unit>(handle: *mut c_void) -> Result<&'a Handle<U>, Status> {
    // SAFETY: by contract; nobody holds a unique reference to the handle.
    unsafe { handle.cast::<Handle<U>>().as_ref() }.ok_or(Status::Error)
}

/// Carries out `body` and gives the claim back.
///
/// # Safety
/// The handle is claimed.
unsafe fn carry_out<U: Unit, T>(
    handle: &Handle<U>,
    name: &'static str,
    row: &Row,
    body: impl FnOnce(&mut Instance<U>) -> Result<T, Failure>,
) -> Result<T, Status> {
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the claim makes this the only reference to the instance.
        let instance = unsafe { &mut *handle.instance.get() };
        instance
            .admit(name, row)
            .and_then(|()| body(instance))
            .map_err(|Failure(reason)| {
                let message = format_args!("{name}: {reason}");
                instance.logger.write(Severity::Error, ERROR, message);
            })
    }));
    match outcome {
        Ok(result) => {
            handle.occupancy.store(IDLE, Ordering::Release);
            result.map_err(|()| Status::Error)
        }
        Err(payload) => {
            // SAFETY: the claim still makes this the only reference. Poison comes after: it would let another
            // thread, or the logger itself, free the instance while its logger is at work.
            let logger = unsafe { &(*handle.instance.get()).logger };
            report_panic(logger, name, payload);
            handle.occupancy.store(POISONED, Ordering::Release);
            Err(Status::Fatal)
        }
    }
}

/// Carries out `body` while the importer lets no other partition in.
///
/// # Safety
/// As for [`enter`]; the importer's callbacks are still valid.
pub(crate) unsafe fn uninterrupted<U: Unit, T>(handle: *mut c_void, body: impl FnOnce() -> T) -> T {
    // SAFETY: by contract; nobody writes to these fields.
    let handle = unsafe { handle.cast::<Handle<U>>().as_ref() };
    let Preemption { lock, unlock } = handle.map(|h| h.preemption).unwrap_or_default();
    if let Some(lock) = lock {
        // SAFETY: called as the standard says.
        unsafe { lock() }
    }
    let outcome = body();
    if let Some(unlock) = unlock {
        // SAFETY: likewise.
        unsafe { unlock() }
    }
    outcome
}

/// [`enter`] for a body whose result is nothing but success.
///
/// # Safety
/// As for [`enter`].
pub(crate) unsafe fn call<U: Unit>(
    handle: *mut c_void,
    name: &'static str,
    row: &Row,
    body: impl FnOnce(&mut Instance<U>) -> Result<(), Failure>,
) -> i32 {
    // SAFETY: by contract.
    let outcome = unsafe { enter(handle, name, row, body) };
    outcome.map_or_else(|status| status, |()| Status::Ok) as i32
}

/// Makes an instance; null and a log message if `make` refuses.
pub(crate) fn create<U: Unit>(
    name: &'static str,
    mut logger: Logger,
    make: impl FnOnce(&mut Logger) -> Result<Instance<U>, Failure>,
) -> *mut c_void {
    let outcome = catch_unwind(AssertUnwindSafe(|| match make(&mut logger) {
        Ok(instance) => Box::into_raw(Box::new(Handle {
            occupancy: AtomicU8::new(IDLE),
            preemption: instance.preemption,
            instance: UnsafeCell::new(instance),
        })),
        Err(Failure(reason)) => {
            let message = format_args!("{name}: {reason}");
            logger.write(Severity::Error, ERROR, message);
            std::ptr::null_mut()
        }
    }));
    match outcome {
        Ok(handle) => handle.cast(),
        Err(payload) => {
            report_panic(&logger, name, payload);
            std::ptr::null_mut()
        }
    }
}

/// Frees an instance. Null is ignored, and so is an instance that a call is using: freeing it would
/// pull it away from under that call.
///
/// # Safety
/// As for [`enter`]; the handle is dead afterwards.
pub(crate) unsafe fn release<U: Unit>(handle: *mut c_void, name: &'static str) {
    let handle = handle.cast::<Handle<U>>();
    // SAFETY: by contract.
    let claim = match unsafe { handle.as_ref() } {
        None => return,
        Some(handle) => handle.claim(),
    };
    let occupancy = match claim {
        Ok(()) => IDLE,
        Err(Status::Fatal) => POISONED,
        Err(_) => return,
    };
    // SAFETY: the claim, or the poison, makes this the only reference.
    let within_step = unsafe { (*(*handle).instance.get()).within_step() };
    // SAFETY: likewise.
    let logger = unsafe { (*(*handle).instance.get()).logger.clone() };
    if within_step {
        let message = format_args!("{name}: ignored while a step is under way");
        logger.write(Severity::Error, ERROR, message);
        // SAFETY: likewise.
        unsafe { &*handle }
            .occupancy
            .store(occupancy, Ordering::Release);
        return;
    }
    // SAFETY: made by `Box::into_raw` in `create`, and used by nobody else.
    let outcome = catch_unwind(AssertUnwindSafe(|| drop(unsafe { Box::from_raw(handle) })));
    if let Err(payload) = outcome {
        report_panic(&logger, name, payload);
    }
}

impl<U: Unit> Handle<U> {
    /// Partitions that run on several processors meet here: each call waits for the other, which takes
    /// microseconds. A callback that calls back would wait for itself, hence the bound.
    fn claim(&self) -> Result<(), Status> {
        let patience = if self.preemption.lock.is_some() {
            PATIENCE
        } else {
            0
        };
        for attempt in 0.. {
            match self
                .occupancy
                // Acquire on failure too: who finds poison may free what the panic left.
                .compare_exchange(IDLE, BUSY, Ordering::Acquire, Ordering::Acquire)
            {
                Ok(_) => return Ok(()),
                Err(POISONED) => return Err(Status::Fatal),
                Err(_) if attempt < patience => std::hint::spin_loop(),
                Err(_) => break,
            }
        }
        Err(Status::Error)
    }
}

fn report_panic(logger: &Logger, name: &str, payload: Box<dyn Any + Send>) {
    // Whatever goes wrong here must not leave either: the message is lost then.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        let reason = match payload.downcast_ref::<String>() {
            Some(text) => text,
            None => *payload.downcast_ref::<&str>().unwrap_or(&"unknown cause"),
        };
        let message = format_args!("{name}: the unit panicked: {reason}");
        logger.write(Severity::Fatal, FATAL, message);
    }))
    // A payload of some other type could panic once more when it is dropped.
    .map_err(std::mem::forget);
    if payload.is::<String>() || payload.is::<&str>() {
        drop(payload);
    } else {
        std::mem::forget(payload);
    }
}
