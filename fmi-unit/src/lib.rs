//! From one Rust trait to the complete C interfaces of FMI 2.0 and FMI 3.0.
//!
//! A crate implements [`Unit`] for a type, generates its variables in the build script and calls
//! `fmi_unit::export!(Type)`; its cdylib then exports every function of both standards.
//! This crate knows nothing of control.

pub mod log;
pub mod model;
pub mod unit;

pub use log::{Log, Severity};
pub use model::{Causality, Kind, Model, Values, ValuesMut, Variability, Variable, Variables};
pub use unit::{Failure, Unit};
