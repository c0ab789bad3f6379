//! Elementary functions whose bits are the same on every platform.
//!
//! Those of the standard library are the system's: between glibc and Windows they differ in the last bit, and so
//! would two runs. `clippy.toml` keeps them out of what the units are made of; nalgebra has the same from `libm`.

pub use libm::{cos, exp, expm1, hypot, log, pow, sin};
