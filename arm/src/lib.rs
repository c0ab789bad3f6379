//! The parametric flexure arm, as pure functions.
//!
//! One equation of motion (eq 12) serves every arm:
//!
//! ```text
//! J·α = τ_motor + τ_disturbance − d·ω − g(θ) − C·z
//! g(θ) = k·θ + o + Σ_{i=1..9} a_i·cos(i·w·θ) + b_i·sin(i·w·θ)
//! ```
//!
//! θ [`plant::State::angle`] \[rad\], ω its velocity \[rad/s\], z the state of the Dahl hysteresis
//! (eq 13) and T the thermal load of the motor \[A²\] (eq 20). The parameter vector φ is
//! [`Parameters`]. This crate knows neither controller nor simulator: no I/O, no clock, no allocation
//! outside validation.
//!
//! "eq n", "sec n" and "fig n" point into the paper on model predictive control of the T-flex.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod admissible;
mod arithmetic;
pub mod elementary;
pub mod hysteresis;
mod parameters;
pub mod plant;
mod position_torque;
pub mod random;
mod sets;
pub mod thermal;
mod vector;

pub use admissible::{Inadmissible, require};
pub use arithmetic::{Arithmetic, Instructions, Kernel, Separate};
pub use parameters::{HARMONICS, Limits, Motor, Parameters};
pub use position_torque::PositionTorque;
pub use vector::{LANES, Vector};
