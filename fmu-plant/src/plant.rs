//! [`Plant`]: the arm between two samples, its noise and its count of violations.

use arm::plant::{self, Derivatives, State as Motion};
use fmi_unit::{Failure, Log, Unit};
use serde::{Deserialize, Serialize};

use crate::noise::standard_normal;
use crate::variables::Variables;

/// The arm, driven by a torque that holds between communication points.
pub struct Plant {
    arm: arm::Parameters,
    motor: arm::Motor,
    limits: arm::Limits,
    sample_period: f64,
    noise: Noise,
    start: f64,
    state: State,
}

/// Drive noise: a new draw each sample, if there is any.
struct Noise {
    /// \[A\]
    standard_deviation: f64,
    seed: u64,
}

/// What changes while the arm moves.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    motion: Motion,
    /// Samples whose instant has been reached after the start, for the count of violations.
    samples: u64,
    /// Violations seen since the last event; Model Exchange may publish them at events only.
    unpublished: i32,
    /// Draws of the noise so far.
    draws: u64,
    /// Noise current until the next draw \[A\].
    noise_current: f64,
}

impl Plant {
    /// Torque of the motor on the arm, noise of the drive included \[N·m\].
    fn motor_torque(&self, torque: f64) -> f64 {
        self.motor.saturate(torque) + self.state.noise_current * self.motor.torque_constant
    }

    fn violates(&self) -> bool {
        let Motion {
            angle,
            thermal_load,
            ..
        } = self.state.motion;
        !self.limits.contains(angle) || thermal_load > self.motor.thermal_limit()
    }

    fn instant(&self, sample: u64) -> f64 {
        self.start + sample as f64 * self.sample_period
    }

    /// Counts `passed` samples, all as the arm stands now.
    fn count(&mut self, passed: u64) {
        self.state.samples = self.state.samples.saturating_add(passed);
        if self.violates() {
            let passed = i32::try_from(passed).unwrap_or(i32::MAX);
            self.state.unpublished = self.state.unpublished.saturating_add(passed);
        }
    }

    /// Counts the samples in (last sample, `time`].
    fn count_until(&mut self, time: f64) {
        // A thousandth of a period absorbs the rounding of a master that sums its time.
        let reached = ((time - self.start) / self.sample_period + 1e-3) as u64;
        self.count(reached.saturating_sub(self.state.samples));
    }

    /// From sample instant to sample instant, under the torques of motor and disturbance \[N·m\].
    fn integrate(&mut self, [torque, disturbance_torque]: [f64; 2], from: f64, to: f64) {
        self.count_until(from);
        let mut time = from;
        while time < to {
            let boundary = self.instant(self.state.samples.saturating_add(1));
            // Where time is too coarse to show a sample, the rest is one piece.
            let reaches_boundary = time < boundary && boundary < to - 1e-3 * self.sample_period;
            let end = if reaches_boundary { boundary } else { to };
            self.state.motion = plant::step(
                &self.arm,
                &self.motor,
                &self.state.motion,
                torque,
                disturbance_torque,
                end - time,
            );
            if reaches_boundary {
                self.count(1);
            } else {
                self.count_until(end);
            }
            time = end;
        }
    }

    fn publish_violations(&mut self, variables: &mut Variables) {
        let count = std::mem::take(&mut self.state.unpublished);
        variables.violations = variables.violations.saturating_add(count);
    }
}

impl Unit for Plant {
    type Variables = Variables;
    type State = State;
    type Job = ();

    fn initial_outputs(variables: &mut Variables) {
        let (arm, motor, limits) = parameters(variables);
        let motion = initial_motion(variables);
        let torque = finite(motor.saturate(variables.torque));
        write_outputs(variables, &arm, &motor, &motion, torque);
        write_margins(variables, &motor, &limits, &motion);
    }

    fn new(variables: &mut Variables, start: f64) -> Result<Self, Vec<Failure>> {
        let (arm, motor, limits) = parameters(variables);
        let mut errors = Vec::new();
        arm.validate(&mut errors);
        motor.validate(&mut errors);
        limits.validate(&mut errors);
        let motion = initial_motion(variables);
        if errors.is_empty() && !limits.contains(motion.angle) {
            errors.push(arm::Inadmissible {
                name: "initial.angle",
                value: motion.angle,
                admissible: format!("in [{}, {}]", limits.angle_lower, limits.angle_upper),
                unit: "rad",
            });
        }
        if !errors.is_empty() {
            return Err(errors.iter().map(|e| Failure(e.to_string())).collect());
        }
        Ok(Self {
            arm,
            motor,
            limits,
            sample_period: variables.sample_period,
            noise: Noise {
                standard_deviation: variables.noise.current,
                seed: u64::from(variables.noise.seed.unsigned_abs()),
            },
            start,
            state: State {
                motion,
                samples: 0,
                unpublished: 0,
                draws: 0,
                noise_current: 0.0,
            },
        })
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn is_admissible(state: &State) -> bool {
        let Motion {
            angle,
            velocity,
            thermal_load,
            hysteresis,
        } = state.motion;
        let numbers = [
            angle,
            velocity,
            thermal_load,
            hysteresis,
            state.noise_current,
        ];
        numbers.iter().all(|number| number.is_finite())
    }

    fn set_state(&mut self, state: &State) -> Result<(), Failure> {
        self.state.clone_from(state);
        Ok(())
    }

    /// Only the noise makes events; the first draw is due at the start.
    fn next_event(&self) -> f64 {
        if self.noise.standard_deviation > 0.0 {
            self.instant(self.state.draws)
        } else {
            f64::INFINITY
        }
    }

    fn event(
        &mut self,
        variables: &mut Variables,
        time: f64,
        _: &mut Log<'_>,
    ) -> Result<(), Failure> {
        self.publish_violations(variables);
        if time >= self.next_event() - 1e-3 * self.sample_period {
            self.state.noise_current =
                self.noise.standard_deviation * standard_normal(self.noise.seed, self.state.draws);
            self.state.draws = self.state.draws.saturating_add(1);
        }
        Ok(())
    }

    /// Integrates from sample instant to sample instant, so that the result does not depend on how long
    /// the communication steps are. O(samples).
    fn advance(
        &mut self,
        variables: &mut Variables,
        from: f64,
        to: f64,
        _: &mut Log<'_>,
    ) -> Result<(), Failure> {
        for (name, torque) in [
            ("torque", variables.torque),
            ("disturbance_torque", variables.disturbance_torque),
        ] {
            if !torque.is_finite() {
                return Err(Failure(format!(
                    "{name} = {torque} N.m is not admissible: must be finite"
                )));
            }
        }
        let torque = self.motor_torque(variables.torque);
        self.integrate([torque, variables.disturbance_torque], from, to);
        self.publish_violations(variables);
        let Motion {
            angle,
            velocity,
            thermal_load,
            ..
        } = self.state.motion;
        if [angle, velocity, thermal_load]
            .iter()
            .all(|x| x.is_finite())
        {
            return Ok(());
        }
        Err(Failure(format!(
            "at {to} s angle = {angle} rad, velocity = {velocity} rad/s, thermal_load = {thermal_load} A2: \
             no longer finite"
        )))
    }

    fn outputs(&self, variables: &mut Variables) {
        let torque = finite(self.motor_torque(variables.torque));
        write_outputs(
            variables,
            &self.arm,
            &self.motor,
            &self.state.motion,
            torque,
        );
        write_margins(variables, &self.motor, &self.limits, &self.state.motion);
    }

    fn continuous_states(&self, states: &mut [f64]) {
        let Motion {
            angle,
            velocity,
            thermal_load,
            hysteresis,
        } = self.state.motion;
        states.copy_from_slice(&[angle, velocity, thermal_load, hysteresis]);
    }

    fn set_continuous_states(&mut self, states: &[f64]) {
        if let &[angle, velocity, thermal_load, hysteresis] = states {
            self.state.motion = Motion {
                angle,
                velocity,
                thermal_load,
                hysteresis,
            };
        }
    }

    fn derivatives(&self, variables: &Variables, derivatives: &mut [f64]) {
        let d = plant::derivatives(
            &self.arm,
            &self.motor,
            &self.state.motion,
            self.motor_torque(variables.torque),
            variables.disturbance_torque,
        );
        derivatives.copy_from_slice(&[d.angle, d.velocity, d.thermal_load, d.hysteresis]);
    }

    fn tangent(&self, variables: &Variables, direction: &Variables, tangent: &mut Variables) {
        let torque = self.motor_torque(variables.torque);
        let change = self.motor.passes(variables.torque) * direction.torque;
        let motion = Motion {
            angle: direction.angle,
            velocity: direction.velocity,
            thermal_load: direction.thermal_load,
            hysteresis: direction.hysteresis_state,
        };
        let changes = (&motion, change, direction.disturbance_torque);
        let d = plant::tangent(&self.arm, &self.motor, &self.state.motion, torque, changes);
        write_motion(tangent, &self.motor, &motion, change, &d);
    }

    fn completed_step(&mut self, _: &Variables, time: f64) -> bool {
        self.count_until(time);
        self.state.unpublished > 0
    }
}

/// An input that is no number is refused where it would move the arm; until then it puts out no current.
fn finite(torque: f64) -> f64 {
    if torque.is_finite() { torque } else { 0.0 }
}

fn initial_motion(variables: &Variables) -> Motion {
    Motion {
        angle: variables.initial.angle,
        velocity: variables.initial.velocity,
        thermal_load: variables.initial.thermal_load,
        hysteresis: 0.0,
    }
}

/// `torque` is the motor's \[N·m\], noise included.
fn write_outputs(
    variables: &mut Variables,
    arm: &arm::Parameters,
    motor: &arm::Motor,
    motion: &Motion,
    torque: f64,
) {
    let d = plant::derivatives(arm, motor, motion, torque, variables.disturbance_torque);
    write_motion(variables, motor, motion, torque, &d);
}

/// The event indicators.
fn write_margins(
    variables: &mut Variables,
    motor: &arm::Motor,
    limits: &arm::Limits,
    motion: &Motion,
) {
    let margin = &mut variables.margin;
    [margin.angle_lower, margin.angle_upper] = limits.margins(motion.angle);
    margin.thermal_load = motor.thermal_margin(motion.thermal_load);
}

/// Everything that is linear in motion, motor torque \[N·m\] and derivatives: values, or changes of them.
fn write_motion(
    variables: &mut Variables,
    motor: &arm::Motor,
    motion: &Motion,
    torque: f64,
    d: &Derivatives,
) {
    variables.angle = motion.angle;
    variables.velocity = motion.velocity;
    variables.current = torque / motor.torque_constant;
    variables.thermal_load = motion.thermal_load;
    variables.thermal_fraction = motion.thermal_load / motor.thermal_limit();
    variables.hysteresis_state = motion.hysteresis;
    variables.der_angle = d.angle;
    variables.der_velocity = d.velocity;
    variables.der_thermal_load = d.thermal_load;
    variables.der_hysteresis_state = d.hysteresis;
}

fn parameters(variables: &Variables) -> (arm::Parameters, arm::Motor, arm::Limits) {
    let (a, m, l) = (&variables.arm, &variables.motor, &variables.limits);
    (
        arm::Parameters {
            inertia: a.inertia,
            damping: a.damping,
            stiffness: a.stiffness,
            offset: a.offset,
            hysteresis: a.hysteresis,
            cogging_frequency: a.cogging_frequency,
            cogging_cos: a.cogging_cos,
            cogging_sin: a.cogging_sin,
        },
        arm::Motor {
            torque_constant: m.torque_constant,
            thermal_time_constant: m.thermal_time_constant,
            continuous_current: m.continuous_current,
            peak_torque: m.peak_torque,
        },
        arm::Limits {
            angle_lower: l.angle_lower,
            angle_upper: l.angle_upper,
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An importer may read outputs before it has set an input to a number.
    #[test]
    fn a_torque_that_is_no_number_puts_out_no_current() {
        let mut variables = Variables {
            torque: f64::NAN,
            ..Variables::default()
        };
        Plant::initial_outputs(&mut variables);
        assert_eq!(variables.current, 0.0);
        let plant = Plant::new(&mut variables, 0.0).expect("defaults");
        variables.current = 7.0;
        plant.outputs(&mut variables);
        assert_eq!((variables.current, variables.angle), (0.0, 1.3));
        // It is refused where it would move the arm.
        let mut derivatives = [0.0; 4];
        plant.derivatives(&variables, &mut derivatives);
        assert!(derivatives[1].is_nan());
    }

    /// Found by fuzzing: both ran on from such states.
    #[test]
    fn states_that_no_plant_has_are_refused_or_overcome() {
        let mut plant = Plant::new(&mut Variables::default(), -1e300).unwrap();
        assert!(Plant::is_admissible(plant.state()));
        let mut state = plant.state().clone();
        state.motion.hysteresis = f64::NAN;
        assert!(!Plant::is_admissible(&state));
        // So long after the start no sample can be counted, and the step must end all the same.
        plant.integrate([0.0; 2], 0.0, 0.001);
        assert!(Plant::is_admissible(plant.state()));
    }
}
