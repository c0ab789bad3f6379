//! System structures: runs SSPs of SSP 1.0 and 2.0, ours or another's, and makes them of experiments.
//!
//! - `package` unpacks an `.ssp`; `read` and `bindings` read what is in it (`document`);
//! - `wiring` flattens the hierarchy to FMUs and what feeds them, through `transformation`s; `build` makes
//!   its connectors, `connect` the connections;
//! - `parameters` finds the value of each parameter, of what is `given`, `inputs` those of the system over time;
//! - `order` says who steps first, `layout` where everything is in a row of samples;
//! - `run` hands all that to the co-simulation master, which knows no SSP;
//! - `export` makes an SSP of an experiment, whose system structures `drawing` lays out and `ssd` writes.

mod bindings;
mod build;
mod connect;
mod document;
mod drawing;
mod export;
mod given;
mod inputs;
mod layout;
mod order;
mod package;
mod parameters;
mod read;
mod run;
mod ssd;
mod summary;
mod transformation;
mod wiring;

pub use export::Export;
pub use package::Package;
pub use run::{SystemOutcome, SystemSimulation, simulate_system};
pub use summary::SystemSummary;
