//! Motion control of the flexure arm: profile, feedforward, feedback, nonlinear model predictive control.

pub mod nmpc;
