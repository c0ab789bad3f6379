//! Identification of the parametric arm from measured angle and torque (sec 3.1, eqs 10 to 15).
//!
//! Eq 12 is linear in all parameters but the cogging frequency w,
//!
//! ```text
//! τ = J·α + d·ω + k·θ + o + C·z + Σ a_i·cos(iwθ) + b_i·sin(iwθ)
//! ```
//!
//! z follows from the angle by eq 13. [`identify`] filters both sides ([`filter`], [`regression`]), finds w
//! and the number of harmonics, solves for the rest by least squares and says how sure it is of each. [`Fit`]
//! compares a parameter vector with any measurement, [`tube`] proposes what to leave to the feedback.
//!
//! Pure functions: no I/O, no clock. "eq n" and "sec n" point into the paper on model predictive control of the
//! T-flex.
//!
//! ```
//! use identification::{Measurement, Settings, identify};
//!
//! # fn measured() -> (Vec<f64>, Vec<f64>) {
//! #     let angle: Vec<f64> = (0..40_000).map(|k| (k as f64 * 1e-3).sin() + 0.4 * (k as f64 * 3.3e-3).sin()).collect();
//! #     let torque = (0..40_000).map(|k| 2.0 * angle[k] + 0.5 + 1e-3 * ((k * k % 17) as f64 - 8.0)).collect();
//! #     (angle, torque)
//! # }
//! let (angle, torque) = measured();
//! let measurement = Measurement::new(2.5e-4, angle, torque);
//! let settings = Settings { harmonics: Some(0), ..Settings::default() };
//! match identify(&measurement, &settings) {
//!     Ok(found) => println!("k = {} N.m/rad", found.parameters.stiffness),
//!     Err(error) => println!("{error}"),
//! }
//! ```

mod curve;
mod error;
mod estimates;
pub mod filter;
mod fit;
mod frequency;
mod harmonics;
mod identify;
mod least_squares;
mod measurement;
mod piece;
pub mod regression;
pub mod tube;

pub use error::Error;
pub use estimates::Estimate;
pub use filter::Hann;
pub use fit::{Fit, Series};
pub use harmonics::Candidate;
pub use identify::{Identification, Settings, identify};
pub use measurement::{Measurement, Segment, Timing};
