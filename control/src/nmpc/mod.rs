//! Nonlinear model predictive control of the reference (sec 3.2.3).
pub mod conic;
pub mod planner;
pub mod problem;
pub mod rest;
pub mod settings;
pub mod solver;
pub mod spline;
pub mod transcription;
pub mod unconstrained;
