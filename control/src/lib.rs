//! Motion control of the flexure arm, as pure functions of measurements and state.
//!
//! A [`Controller`] turns one measured angle and one setpoint into one motor torque, 4000 times a
//! second (sec 3.2):
//!
//! ```text
//! setpoint ─► nmpc | profile ─► reference ─► feedforward ─┬─► torque
//!                                   │                     │
//! angle ────────────────────────────┴──────► feedback ────┘
//! ```
//!
//! This crate knows neither simulator nor interface: no I/O and no clock, and everything that a sample
//! needs is allocated at set-up. "eq n" and "sec n" point into the paper, as in [`arm`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod controller;
pub mod feedback;
pub mod feedforward;
mod latency;
mod lowpass;
pub mod nmpc;
mod planning;
pub mod profile;
mod reference;
pub mod riccati;
mod sets;
mod settings;
mod state;

pub use controller::{Controller, LARGEST_ANGLE, usable};
pub use planning::{Planning, When};
pub use reference::Reference;
pub use settings::{ReferenceSource, Settings};
pub use state::{Command, State};
