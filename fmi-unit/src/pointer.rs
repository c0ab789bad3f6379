//! Foreign pointers become references here, checked as far as that is possible.

use std::borrow::Cow;
use std::ffi::{CStr, c_char};

use crate::unit::Failure;

fn check<T>(pointer: *const T, length: usize, what: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(Failure(format!("{what} is a null pointer")));
    }
    if !pointer.is_aligned() || length > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Failure(format!("{what} is not a valid array")));
    }
    Ok(())
}

/// An input array; null is legal when it is empty.
///
/// # Safety
/// `pointer` is null or points to `length` values that nobody changes during the call.
pub(crate) unsafe fn slice<'a, T>(
    pointer: *const T,
    length: usize,
    what: &str,
) -> Result<&'a [T], Failure> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer, length, what)?;
    // SAFETY: checked and by contract.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// An output array; null is legal when it is empty.
///
/// # Safety
/// `pointer` is null or points to `length` writable values that nobody else uses during the call.
pub(crate) unsafe fn slice_mut<'a, T>(
    pointer: *mut T,
    length: usize,
    what: &str,
) -> Result<&'a mut [T], Failure> {
    if length == 0 {
        return Ok(&mut []);
    }
    check(pointer, length, what)?;
    // SAFETY: checked and by contract.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, length) })
}

/// One value to be written, which must be there.
///
/// # Safety
/// As for [`slice_mut`] with one value.
pub(crate) unsafe fn target<'a, T>(pointer: *mut T, what: &str) -> Result<&'a mut T, Failure> {
    check(pointer, 1, what)?;
    // SAFETY: checked and by contract.
    Ok(unsafe { &mut *pointer })
}

/// A string; `None` for null.
///
/// # Safety
/// `pointer` is null or points to a string that ends with a null character.
pub(crate) unsafe fn string<'a>(pointer: *const c_char) -> Option<Cow<'a, str>> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: checked and by contract.
    Some(unsafe { CStr::from_ptr(pointer) }.to_string_lossy())
}
