//! Placeholder.
pub mod fmu;
