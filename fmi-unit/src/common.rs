//! Functions that both versions of the standard have under their own names. Each takes the name, for
//! messages.
//!
//! Every function is `unsafe` for the same reason: the importer is C and vouches for its pointers. An
//! instance is null or comes from the instantiation of the same unit, a state from the functions here;
//! arrays are null or as long as said; strings are null or end with a null character.
#![allow(
    clippy::missing_safety_doc,
    clippy::undocumented_unsafe_blocks,
    reason = "one contract for all, stated above"
)]

use std::ffi::{c_char, c_int, c_void};

use crate::access::Addressing;
use crate::guard::call;
use crate::legality::{ALWAYS, Row};
use crate::pointer::{slice, slice_mut, string, target};
use crate::sensitivity::Product;
use crate::snapshot::Snapshot;
use crate::transfer::Transfer;
use crate::unit::{Failure, Unit};

type Name = &'static str;

pub(crate) unsafe fn set_debug_logging<U: Unit>(
    instance: *mut c_void,
    name: Name,
    on: bool,
    n: usize,
    categories: *const *const c_char,
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |i| {
            let names = slice(categories, n, "categories")?
                .iter()
                .map(|&category| string(category))
                .collect::<Option<Vec<_>>>()
                .ok_or_else(|| Failure("a category is a null pointer".into()))?;
            let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
            i.logger.switch(on, &names)
        })
    }
}

/// Reads `n` variables into `n_values` values.
pub(crate) unsafe fn get<U: Unit, T: Transfer>(
    instance: *mut c_void,
    (name, row): (Name, &Row),
    (references, n): (*const u32, usize),
    (values, n_values): (*mut T::Foreign, usize),
    addressing: Addressing,
) -> c_int {
    unsafe {
        call::<U>(instance, name, row, |i| {
            let references = slice(references, n, "value references")?;
            let values = slice_mut(values, n_values, "values")?;
            i.get::<T>(references, values, addressing)
        })
    }
}

/// Writes `n_values` values into `n` variables.
pub(crate) unsafe fn set<U: Unit, T: Transfer>(
    instance: *mut c_void,
    (name, row): (Name, &Row),
    (references, n): (*const u32, usize),
    (values, n_values): (*const T::Foreign, usize),
    addressing: Addressing,
) -> c_int {
    unsafe {
        call::<U>(instance, name, row, |i| {
            let references = slice(references, n, "value references")?;
            let values = slice(values, n_values, "values")?;
            i.set::<T>(references, values, addressing)
        })
    }
}

/// Multiplies partial derivatives with a seed.
pub(crate) unsafe fn sensitivity<U: Unit>(
    instance: *mut c_void,
    (name, row): (Name, &Row),
    product: Product,
    [unknowns, knowns]: [(*const u32, usize); 2],
    seed: (*const f64, usize),
    sensitivity: (*mut f64, usize),
    addressing: Addressing,
) -> c_int {
    unsafe {
        call::<U>(instance, name, row, |i| {
            let unknowns = slice(unknowns.0, unknowns.1, "unknowns")?;
            let knowns = slice(knowns.0, knowns.1, "knowns")?;
            let seed = slice(seed.0, seed.1, "seed")?;
            let sensitivity = slice_mut(sensitivity.0, sensitivity.1, "sensitivity")?;
            i.sensitivity(product, [unknowns, knowns], seed, sensitivity, addressing)
        })
    }
}

/// A capability that the description does not declare. Legal if nothing is asked of it.
pub(crate) unsafe fn undeclared<U: Unit>(
    instance: *mut c_void,
    name: Name,
    asked: bool,
    what: &str,
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |_| {
            if asked {
                Err(Failure(format!("{what} is not provided")))
            } else {
                Ok(())
            }
        })
    }
}

/// Saves into the state that `state` points to, or into a new one if that is null.
pub(crate) unsafe fn get_state<U: Unit>(
    instance: *mut c_void,
    (name, row): (Name, &Row),
    state: *mut *mut c_void,
) -> c_int {
    unsafe {
        call::<U>(instance, name, row, |i| {
            let state = target(state, "FMU state")?;
            match state.cast::<Snapshot<U>>().as_mut() {
                Some(existing) => i.save_into(existing),
                None => *state = Box::into_raw(Box::new(i.save())).cast(),
            }
            Ok(())
        })
    }
}

pub(crate) unsafe fn set_state<U: Unit>(
    instance: *mut c_void,
    (name, row): (Name, &Row),
    state: *mut c_void,
) -> c_int {
    unsafe { call::<U>(instance, name, row, |i| i.restore(snapshot(state)?)) }
}

/// Null is ignored.
pub(crate) unsafe fn free_state<U: Unit>(
    instance: *mut c_void,
    name: Name,
    state: *mut *mut c_void,
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |_| {
            if let Some(state) = state.as_mut()
                && !state.is_null()
            {
                let state = std::mem::replace(state, std::ptr::null_mut());
                drop(Box::from_raw(state.cast::<Snapshot<U>>()));
            }
            Ok(())
        })
    }
}

pub(crate) unsafe fn state_size<U: Unit>(
    instance: *mut c_void,
    name: Name,
    state: *mut c_void,
    size: *mut usize,
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |_| {
            *target(size, "size")? = snapshot::<U>(state)?.size()?;
            Ok(())
        })
    }
}

pub(crate) unsafe fn serialize_state<U: Unit>(
    instance: *mut c_void,
    name: Name,
    state: *mut c_void,
    (bytes, size): (*mut u8, usize),
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |_| {
            snapshot::<U>(state)?.serialize(slice_mut(bytes, size, "serialized state")?)
        })
    }
}

/// Always makes a new state: what `state` holds before is not looked at.
pub(crate) unsafe fn deserialize_state<U: Unit>(
    instance: *mut c_void,
    name: Name,
    (bytes, size): (*const u8, usize),
    state: *mut *mut c_void,
) -> c_int {
    unsafe {
        call::<U>(instance, name, &ALWAYS, |_| {
            let state = target(state, "FMU state")?;
            let bytes = slice(bytes, size, "serialized state")?;
            *state = Box::into_raw(Box::new(Snapshot::<U>::deserialize(bytes)?)).cast();
            Ok(())
        })
    }
}

unsafe fn snapshot<'a, U: Unit>(state: *mut c_void) -> Result<&'a Snapshot<U>, Failure> {
    Ok(unsafe { target(state.cast(), "FMU state")? })
}
