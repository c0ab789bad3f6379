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

/// Change of [`derivatives`] at `state` in a direction: of the state, the motor torque and the disturbance.
///
/// Beyond its peak the motor passes no change on; at rest, where eq 13 has a kink, it is that of the mean of
/// both sides.
pub fn tangent(
    parameters: &Parameters,
    motor: &Motor,
    state: &State,
    torque: f64,
    (direction, torque_change, disturbance_change): (&State, f64, f64),
) -> Derivatives {
    let passed = motor.passes(torque) * torque_change;
    let [_, slope] = parameters.at::<2>(state.angle);
    let acceleration = (passed + disturbance_change
        - parameters.damping * direction.velocity
        - slope * direction.angle
        - parameters.hysteresis * direction.hysteresis)
        / parameters.inertia;
    Derivatives {
        angle: direction.velocity,
        velocity: acceleration,
        thermal_load: thermal::rate_tangent(
            motor,
            direction.thermal_load,
            (motor.saturate(torque), passed),
        ),
        hysteresis: hysteresis::rate_tangent(
            (state.hysteresis, direction.hysteresis),
            (state.velocity, direction.velocity),
        ),
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

        /// Along every direction, away from the kinks of eq 13 and of the saturation.
        #[test]
        fn tangent_agrees_with_differences(
            start in prop::array::uniform4(-1.0..1.0_f64), torque in -50.0..50.0_f64,
            along in prop::array::uniform6(-1.0..1.0_f64),
        ) {
            let (p, motor) = (Parameters::tflex(), Motor::tflex());
            prop_assume!(start[1].abs() > 1e-3 && (torque.abs() - motor.peak_torque).abs() > 1e-3);
            let state = |x: [f64; 4]| State {
                angle: x[0],
                velocity: x[1],
                thermal_load: x[2],
                hysteresis: x[3],
            };
            let h = 1e-6;
            let at = |h: f64| {
                let moved = std::array::from_fn(|i| start[i] + h * along[i]);
                derivatives(&p, &motor, &state(moved), torque + h * along[4], h * along[5])
            };
            let direction = state([along[0], along[1], along[2], along[3]]);
            let exact = tangent(&p, &motor, &state(start), torque, (&direction, along[4], along[5]));
            let (above, below) = (at(h), at(-h));
            for (exact, above, below) in [
                (exact.angle, above.angle, below.angle),
                (exact.velocity, above.velocity, below.velocity),
                (exact.thermal_load, above.thermal_load, below.thermal_load),
                (exact.hysteresis, above.hysteresis, below.hysteresis),
            ] {
                let difference = (above - below) / (2.0 * h);
                prop_assert!((exact - difference).abs() < 1e-6 * (1.0 + exact.abs()), "{exact} {difference}");
            }
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
