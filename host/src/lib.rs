//! The host: imports FMUs of FMI 2.0 and 3.0, ours or a vendor's, connects a controller to a plant, runs,
//! scores and plots them.
//!
//! - [`fmu`] imports FMUs, alone useful to any client of FMUs;
//! - [`input`] reads what the user gives: parameters, setpoints, connections;
//! - [`run`] steps the pair and measures it: [`simulate`];
//! - [`ssp`] runs system structures, of any number of FMUs: [`ssp::simulate_system`];
//! - [`experiment`] makes many runs that a file describes, and compares them with what was expected;
//! - [`identify`] finds the parameters of an arm from a measurement or from experiments on a plant;
//! - [`output`] writes the result; [`table`] aligns what goes to the terminal.
//!
//! FMUs are known only as files: this crate knows no controller and no export, and the arm only to identify it.

mod error;
pub mod experiment;
pub mod fmu;
pub mod identify;
pub mod input;
pub mod output;
pub mod run;
pub mod ssp;
pub mod table;
mod whole;

pub use error::Error;
pub use run::{Order, Outcome, Prepared, Simulation, simulate, simulate_opened};
