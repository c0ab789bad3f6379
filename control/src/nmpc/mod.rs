//! Nonlinear model predictive control of the reference (sec 3.2.3).
