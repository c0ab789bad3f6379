//! System structures: runs SSPs of SSP 1.0 and 2.0, ours or another's, and makes them of experiments.
//!
//! - [`package`] unpacks an `.ssp`, [`read`] reads what is in it ([`document`]);
//! - [`wiring`] flattens the hierarchy to FMUs and what feeds them, through [`transformation`]s;
//! - [`parameters`] finds the value of each parameter, [`order`] who steps first;
//! - [`run`] hands all that to the co-simulation master, which knows no SSP;
//! - [`export`] makes an SSP of an experiment, [`drawing`] writes and draws its system structures.

mod document;
mod drawing;
mod export;
mod inputs;
mod order;
mod package;
mod parameters;
mod read;
mod run;
mod transformation;
mod wiring;

pub use export::Export;
pub use package::Package;
pub use run::{SystemOutcome, SystemSimulation, SystemSummary, simulate_system};
