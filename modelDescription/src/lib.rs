//! The contracts of the units: hand-written FMI 3.0 model descriptions, checked and translated.
//!
//! A variable is declared once, in `modelDescription/<unit>.xml`. [`read()`] turns that text into a
//! [`ModelDescription`] or reports *every* inconsistency with its file and line; from the tree derive
//!
//! - [`rust::generate`]: the Rust variable table and structs of the unit, at build time;
//! - [`fmi3::write`] and [`fmi2::write`]: the `modelDescription.xml` of the FMUs;
//! - [`ssv`]: parameter files (SSP), whose entries [`parameters`] checks against the contracts.
//!
//! [`xml`] reads any XML with positions, for messages that name the line.
//!
//! This crate knows no arm and no controller.

mod check;
mod diagnostic;
pub mod fmi2;
pub mod fmi3;
mod names;
pub mod parameters;
mod read;
pub mod rust;
pub mod ssv;
mod tree;
pub mod xml;

pub use diagnostic::Diagnostic;
pub use read::read;
pub use tree::{
    Causality, Clock, Dimension, DisplayUnit, EnumerationType, Experiment, Initial, Interface,
    Item, Kind, LogCategory, ModelDescription, Unit, Unknown, Value, Variability, Variable,
};
