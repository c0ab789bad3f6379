//! The C interface as an importer sees it, in both versions.
#![allow(
    clippy::undocumented_unsafe_blocks,
    reason = "pointers come from live references, instances from the instantiation"
)]

mod allocation;
mod binary;
mod clocks;
mod configuration;
mod exchange;
mod importer;
mod legality;
mod lifecycle;
mod logging;
mod properties;
mod sensitivity;
mod session;
mod states;
mod steps;
mod toy;
mod values;
