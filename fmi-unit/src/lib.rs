//! From one Rust trait to the complete C interfaces of FMI 2.0 and FMI 3.0.
//!
//! A crate implements [`Unit`] for a type, generates its variables in the build script and calls
//! `fmi_unit::export!(Type)`; its cdylib then exports every function of both standards.
//! This crate knows nothing of control.

pub mod log;
pub mod model;
pub mod unit;

mod access;
mod clock;
mod common;
mod exchange;
mod export;
mod guard;
mod instance;
mod legality;
mod logger;
mod pointer;
mod sensitivity;
mod snapshot;
mod step;
mod transfer;

// Named by the code that `export!` makes.
#[doc(hidden)]
pub mod fmi2;
#[doc(hidden)]
pub mod fmi3;
#[doc(hidden)]
pub use fmi_abi as abi;

pub use clock::Ticks;
pub use log::{Log, Severity};
pub use model::{
    Causality, Clock, Dimension, Kind, Model, Values, ValuesMut, Variability, Variable, Variables,
};
pub use unit::{Failure, Unit};
