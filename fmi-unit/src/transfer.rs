//! The types in which the functions of either version pass values.

use std::ffi::c_int;
use std::marker::PhantomData;

use crate::model::Kind;

/// One element of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Element {
    Float64(f64),
    Int32(i32),
    UInt64(u64),
    Boolean(bool),
    Enumeration(i64),
}

/// A type in which functions of the C interface pass values.
pub(crate) trait Transfer {
    /// The C type.
    type Foreign: Copy;
    /// For the importer; `None` if this type does not carry such elements.
    fn outward(element: Element) -> Option<Self::Foreign>;
    /// From the importer, for a variable of some kind; `None` if this type does not carry it.
    fn inward(value: Self::Foreign, kind: Kind) -> Option<Element>;
}

/// `fmi2Real` and `fmi3Float64`.
pub(crate) enum Float64 {}
impl Transfer for Float64 {
    type Foreign = f64;
    fn outward(element: Element) -> Option<f64> {
        match element {
            Element::Float64(value) => Some(value),
            _ => None,
        }
    }
    fn inward(value: f64, kind: Kind) -> Option<Element> {
        (kind == Kind::Float64).then_some(Element::Float64(value))
    }
}

/// `fmi2Integer`, which carries enumerations as well.
pub(crate) enum Integer {}
impl Transfer for Integer {
    type Foreign = c_int;
    fn outward(element: Element) -> Option<c_int> {
        match element {
            Element::Int32(value) => Some(value),
            Element::Enumeration(value) => c_int::try_from(value).ok(),
            _ => None,
        }
    }
    fn inward(value: c_int, kind: Kind) -> Option<Element> {
        match kind {
            Kind::Int32 => Some(Element::Int32(value)),
            Kind::Enumeration => Some(Element::Enumeration(value.into())),
            _ => None,
        }
    }
}

/// `fmi3Int32`.
pub(crate) enum Int32 {}
impl Transfer for Int32 {
    type Foreign = i32;
    fn outward(element: Element) -> Option<i32> {
        match element {
            Element::Int32(value) => Some(value),
            _ => None,
        }
    }
    fn inward(value: i32, kind: Kind) -> Option<Element> {
        (kind == Kind::Int32).then_some(Element::Int32(value))
    }
}

/// `fmi3UInt64`.
pub(crate) enum UInt64 {}
impl Transfer for UInt64 {
    type Foreign = u64;
    fn outward(element: Element) -> Option<u64> {
        match element {
            Element::UInt64(value) => Some(value),
            _ => None,
        }
    }
    fn inward(value: u64, kind: Kind) -> Option<Element> {
        (kind == Kind::UInt64).then_some(Element::UInt64(value))
    }
}

/// `fmi3Int64`, which carries enumerations.
pub(crate) enum Int64 {}
impl Transfer for Int64 {
    type Foreign = i64;
    fn outward(element: Element) -> Option<i64> {
        match element {
            Element::Enumeration(value) => Some(value),
            _ => None,
        }
    }
    fn inward(value: i64, kind: Kind) -> Option<Element> {
        (kind == Kind::Enumeration).then_some(Element::Enumeration(value))
    }
}

/// `fmi2Boolean` with `T` = `c_int` and `fmi3Boolean` with `T` = `u8`; anything but zero is true.
pub(crate) struct Boolean<T>(PhantomData<T>);
impl<T: Copy + From<bool> + PartialEq> Transfer for Boolean<T> {
    type Foreign = T;
    fn outward(element: Element) -> Option<T> {
        match element {
            Element::Boolean(value) => Some(value.into()),
            _ => None,
        }
    }
    fn inward(value: T, kind: Kind) -> Option<Element> {
        (kind == Kind::Boolean).then(|| Element::Boolean(value != T::from(false)))
    }
}

/// A type that no variable of a unit has.
pub(crate) struct Absent<T>(PhantomData<T>);
impl<T: Copy> Transfer for Absent<T> {
    type Foreign = T;
    fn outward(_: Element) -> Option<T> {
        None
    }
    fn inward(_: T, _: Kind) -> Option<Element> {
        None
    }
}
