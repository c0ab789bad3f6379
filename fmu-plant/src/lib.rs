//! The flexure arm as a Functional Mock-up Unit: glue between `arm` and `fmi-unit`, nothing computed here.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod noise;
mod plant;

/// The variables, as declared in `modelDescription/plant.xml`.
pub mod variables {
    include!(concat!(env!("OUT_DIR"), "/variables.rs"));
}

pub use plant::Plant;

fmi_unit::export!(Plant);
