//! Equations of motion of arm and motor, for an importer's solver and for fixed steps.

use serde::{Deserialize, Serialize};

use crate::parameters::{Motor, Parameters};
use crate::{hysteresis, thermal};

/// State of arm and motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// θ \[rad\].
    pub angle: f64,
    /// ω \[rad/s\].
    pub velocity: f64,
    /// T \[A²\] (eq 20).
    pub thermal_load: f64,
    /// z of the Dahl hysteresis, in [−1, 1] (eq 13).
    pub hysteresis: f64,
}

/// Time derivative of a [`State`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// dθ/dt \[rad/s\].
    pub angle: f64,
    /// dω/dt \[rad/s²\].
    pub velocity: f64,
    /// dT/dt \[A²/s\].
    pub thermal_load: f64,
    /// dz/dt \[1/s\].
    pub hysteresis: f64,
}

/// dω/dt \[rad/s²\] (eq 12 solved for the acceleration); the motor gives what [`Motor::saturate`] lets through.
pub fn acceleration(
    parameters: &Parameters,
    motor: &Motor,
    state: &State,
    torque: f64,
    disturbance: f64,
) -> f64 {
    (motor.saturate(torque) + disturbance
        - parameters.damping * state.velocity
        - parameters.position_torque(state.angle)
        - parameters.hysteresis * state.hysteresis)
        / parameters.inertia
}

/// Time derivatives under a motor torque and a disturbance torque \[N·m\] (eqs 12, 13, 20).
pub fn derivatives(
    parameters: &Parameters,
    motor: &Motor,
    state: &State,
    torque: f64,
    disturbance: f64,
) -> Derivatives {
    Derivatives {
        angle: state.velocity,
        velocity: acceleration(parameters, motor, state, torque, disturbance),
        thermal_load: thermal::rate(motor, state.thermal_load, motor.saturate(torque)),
        hysteresis: hysteresis::rate(state.hysteresis, state.velocity),
    }
}

/// State after `step` \[s\] with both torques \[N·m\] held.
///
/// Angle and velocity by one classical Runge–Kutta step with z held, then z by eq 13 for the angle
/// travelled, and the thermal load exactly.
pub fn step(
    parameters: &Parameters,
    motor: &Motor,
    state: &State,
    torque: f64,
    disturbance: f64,
    step: f64,
) -> State {
    let slope = |angle, velocity| {
        let at = State {
            angle,
            velocity,
            ..*state
        };
        let alpha = acceleration(parameters, motor, &at, torque, disturbance);
        (velocity, alpha)
    };
    let (angle, velocity) = (state.angle, state.velocity);
    let half = 0.5 * step;
    let (v1, a1) = slope(angle, velocity);
    let (v2, a2) = slope(angle + half * v1, velocity + half * a1);
    let (v3, a3) = slope(angle + half * v2, velocity + half * a2);
    let (v4, a4) = slope(angle + step * v3, velocity + step * a3);
    let next = angle + step / 6.0 * (v1 + 2.0 * (v2 + v3) + v4);
    State {
        angle: next,
        velocity: velocity + step / 6.0 * (a1 + 2.0 * (a2 + a3) + a4),
        thermal_load: thermal::update(motor, state.thermal_load, motor.saturate(torque), step),
        hysteresis: hysteresis::update(state.hysteresis, next - angle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const H: f64 = 2.5e-4;

    fn at(angle: f64, velocity: f64) -> State {
        State {
            angle,
            velocity,
            thermal_load: 1.0,
            hysteresis: 0.2,
        }
    }

    fn run(parameters: &Parameters, start: State, torque: f64, steps: u32, h: f64) -> State {
        (0..steps).fold(start, |state, _| {
            step(parameters, &Motor::tflex(), &state, torque, 0.0, h)
        })
    }

    proptest! {
        /// The arm rests where the torque balances g(θ) + C·z.
        #[test]
        fn rests_under_its_own_position_torque(angle in 0.95..1.5) {
            let p = Parameters::tflex();
            let state = at(angle, 0.0);
            let torque = p.position_torque(angle) + p.hysteresis * state.hysteresis;
            let d = derivatives(&p, &Motor::tflex(), &state, torque, 0.0);
            prop_assert!(d.angle == 0.0 && d.velocity.abs() < 1e-12 && d.hysteresis == 0.0);
        }

        /// A disturbance acts like the same motor torque, but heats nothing.
        #[test]
        fn disturbance_moves_but_does_not_heat(
            angle in 0.0..1.5, velocity in -2.0..2.0, torque in -20.0..20.0,
        ) {
            let (p, motor) = (Parameters::pendulum(), Motor::pendulum());
            let by_motor = step(&p, &motor, &at(angle, velocity), torque, 0.0, H);
            let by_disturbance = step(&p, &motor, &at(angle, velocity), 0.0, torque, H);
            prop_assert_eq!(by_motor.angle, by_disturbance.angle);
            prop_assert_eq!(by_motor.velocity, by_disturbance.velocity);
            prop_assert!(by_disturbance.thermal_load < 1.0);
        }

        /// Without damping, hysteresis and torque, ½·J·ω² + ∫g dθ is conserved.
        #[test]
        fn energy_is_conserved(angle in 0.0..1.5, velocity in -1.0..1.0) {
            let p = Parameters::pendulum();
            let energy = |s: &State| {
                0.5 * p.inertia * s.velocity.powi(2)
                    + 0.5 * p.stiffness * s.angle.powi(2) + p.offset * s.angle + s.angle.sin()
            };
            let start = at(angle, velocity);
            let end = run(&p, start, 0.0, 4000, H);
            prop_assert!((energy(&end) - energy(&start)).abs() < 1e-11);
        }

        /// Step and derivatives describe one arm: the step tends to the derivatives.
        #[test]
        fn step_tends_to_the_derivatives(
            angle in 0.95..1.5, velocity in -2.0..2.0, torque in -60.0..60.0,
        ) {
            let (p, motor) = (Parameters::tflex(), Motor::tflex());
            let start = at(angle, velocity);
            let h = 1e-7;
            let end = step(&p, &motor, &start, torque, 0.1, h);
            let d = derivatives(&p, &motor, &start, torque, 0.1);
            prop_assert!(((end.angle - start.angle) / h - d.angle).abs() < 1e-4);
            prop_assert!(((end.velocity - start.velocity) / h - d.velocity).abs() < 1e-2);
            prop_assert!(((end.thermal_load - start.thermal_load) / h - d.thermal_load).abs() < 1e-5);
            prop_assert!(((end.hysteresis - start.hysteresis) / h - d.hysteresis).abs() < 1e-2);
        }
    }

    #[test]
    fn smooth_motion_converges_with_the_fourth_order() {
        let p = Parameters {
            hysteresis: 0.0,
            ..Parameters::tflex()
        };
        let exact = run(&p, at(1.3, 0.0), 2.0, 1 << 14, 0.2 / f64::from(1 << 14)).angle;
        let error =
            |n: u32| (run(&p, at(1.3, 0.0), 2.0, n, 0.2 / f64::from(n)).angle - exact).abs();
        let ratio = error(32) / error(64);
        assert!((12.0..20.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn torque_beyond_the_peak_changes_nothing() {
        let (p, motor) = (Parameters::tflex(), Motor::tflex());
        let start = at(1.3, 0.0);
        let peak = step(&p, &motor, &start, 35.3, 0.0, H);
        let beyond = step(&p, &motor, &start, 1e6, 0.0, H);
        assert_eq!(peak, beyond);
    }
}
