//! The controller as a Functional Mock-up Unit: glue between `control` and `fmi-unit`, nothing computed here.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod controller;
mod plan;
mod settings;

/// The variables, as declared in `modelDescription/controller.xml`.
pub mod variables {
    include!(concat!(env!("OUT_DIR"), "/variables.rs"));
}

pub use controller::Controller;

fmi_unit::export!(Controller);
