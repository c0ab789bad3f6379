//! Types and function signatures of the Functional Mock-up Interface 2.0 and 3.0.
//!
//! Declarations only, after the official C headers, whose notice is in `LICENSE-BSD-2-Clause`. Both
//! sides use them: what exports an FMU and what imports one. A function type such as
//! [`fmi2::fmi2DoStepTYPE`] is an `Option`, like every function pointer of C, so that
//! `const _: fmi2DoStepTYPE = Some(fmi2DoStep);` makes the compiler check a definition.

#![allow(
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    missing_docs,
    reason = "the names and their meaning are the standards'"
)]

pub mod fmi2;
pub mod fmi3;

#[cfg(test)]
mod tests;
