//! Nonlinear model predictive control of the reference (sec 3.2.3), in parts that do not know each other's
//! insides:
//!
//! | part | question | module |
//! |---|---|---|
//! | problem | what is optimised? | [`problem`], from the contract's [`settings`]; [`safe_set`], [`torque_bounds`] |
//! | transcription | how does it become numbers? | [`grid`], [`transcription`], [`rk4`], [`deviation`], [`rollout`], [`linear_quadratic`], [`spline`] |
//! | solver | who solves it? | [`solver`] (the interface), [`unconstrained`], [`interior_point`], [`conic`] |
//! | planner | what if it cannot be solved? | [`planner`], its [`plan`], [`rest`] |
//!
//! Why the parts follow from each other, and where their ideas come from: `docs/solver.md`.
//!
//! A [`planner::Planner`] is made once and then asked for a plan every period:
//!
//! ```
//! use arm::{Limits, Motor, Parameters};
//! use control::nmpc::plan::PlanStatus;
//! use control::nmpc::planner::Planner;
//! use control::nmpc::problem::{FeedbackModel, Initial};
//! use control::nmpc::settings::Settings;
//!
//! let feedback = FeedbackModel {
//!     inertia: 0.0818,
//!     gain_angle: 31.62,
//!     gain_velocity: 2.756,
//!     gain_integral: 0.0,
//!     sample_period: 2.5e-4,
//! };
//! let (arm, motor, limits) = (Parameters::tflex(), Motor::tflex(), Limits::tflex());
//! let mut planner = Planner::new(&Settings::default(), &arm, &motor, &limits, &feedback)
//!     .map_err(|errors| errors[0].clone())?;
//! let at_rest = Initial {
//!     angle: 1.3,
//!     reference_angle: 1.3,
//!     ..Initial::default()
//! };
//! let plan = planner.plan(&at_rest, 1.1);
//! assert_eq!(plan.status, PlanStatus::Solved);
//! assert!((plan.trajectory.angle[40] - 1.1).abs() < 1e-9);
//! # Ok::<(), arm::Inadmissible>(())
//! ```

pub mod conic;
pub mod deviation;
pub mod grid;
pub mod interior_point;
pub mod linear_quadratic;
pub mod plan;
pub mod planner;
pub mod problem;
pub mod rest;
pub mod rk4;
pub mod rollout;
pub mod safe_set;
pub mod settings;
pub mod solver;
pub mod spline;
pub mod torque_bounds;
pub mod transcription;
pub mod unconstrained;

#[cfg(test)]
mod examples;
