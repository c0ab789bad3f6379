//! Closed loop of controller and simulated arm, both sampled at the controller's period.

#![allow(dead_code, reason = "every test file uses a part")]

pub mod rates;

use arm::{Limits, Motor, Parameters, plant};
use control::{Command, Controller, ReferenceSource, Settings, feedback};

/// A controller and the arm it controls.
pub struct Loop {
    pub controller: Controller,
    pub arm: Parameters,
    pub motor: Motor,
    pub limits: Limits,
    pub sample_period: f64,
    pub motion: plant::State,
    /// Torque of the sample before, if the arm gets every torque one sample late.
    pub late_torque: Option<f64>,
}

impl Loop {
    pub fn new(settings: &Settings, arm: Parameters, angle: f64) -> Self {
        Self {
            controller: Controller::new(settings).unwrap(),
            arm,
            motor: settings.motor,
            limits: settings.limits,
            sample_period: settings.sample_period,
            motion: plant::State {
                angle,
                velocity: 0.0,
                thermal_load: settings.initial_thermal_load,
                hysteresis: 0.0,
            },
            late_torque: None,
        }
    }

    /// The same loop in a host that steps controller and arm side by side: every torque comes one sample
    /// late. Until the first one comes the arm is held.
    pub fn delayed(mut self) -> Self {
        self.late_torque = Some(self.arm.position_torque(self.motion.angle));
        self
    }

    /// The T-flex at the middle of its range, with a perfect model.
    pub fn tflex() -> Self {
        Self::new(&Settings::tflex(), Parameters::tflex(), 1.30)
    }

    /// The pendulum, in a controller that takes it for another one (eq 32).
    pub fn pendulum(settings: &Settings) -> Self {
        Self::new(
            settings,
            Parameters::pendulum(),
            std::f64::consts::FRAC_PI_4,
        )
    }

    /// One sample of the controller, then one of the arm.
    pub fn step(&mut self, setpoint: f64, disturbance: f64) -> Command {
        let command = self.controller.sample(self.motion.angle, setpoint);
        let torque = match &mut self.late_torque {
            Some(late) => std::mem::replace(late, command.torque),
            None => command.torque,
        };
        self.motion = plant::step(
            &self.arm,
            &self.motor,
            &self.motion,
            torque,
            disturbance,
            self.sample_period,
        );
        command
    }

    /// Whether a limit of the arm is violated (not one that the controller imposes on itself).
    pub fn violates(&self) -> bool {
        !self.limits.contains(self.motion.angle)
            || self.motion.thermal_load > self.motor.thermal_limit()
    }
}

/// What a sequence of setpoints leads to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    /// Σ (goal − θ)² over the samples after the first setpoint.
    pub cost: f64,
    pub violations: u32,
    pub torque_max: f64,
    /// Largest share of the thermal limit.
    pub thermal_fraction_max: f64,
}

/// Steps through `setpoints`, one every `interval` \[s\]; the first one is not scored.
pub fn track(mut closed_loop: Loop, setpoints: &[f64], interval: f64) -> Score {
    let samples = (interval / closed_loop.sample_period).round() as u32;
    let mut score = Score::default();
    for (i, &setpoint) in setpoints.iter().enumerate() {
        for _ in 0..samples {
            let error = setpoint - closed_loop.motion.angle;
            let command = closed_loop.step(setpoint, 0.0);
            if i > 0 {
                score.cost += error * error;
                score.violations += u32::from(closed_loop.violates());
                score.torque_max = score.torque_max.max(command.torque.abs());
                let fraction = closed_loop.motion.thermal_load / closed_loop.motor.thermal_limit();
                score.thermal_fraction_max = score.thermal_fraction_max.max(fraction);
            }
        }
    }
    score
}

/// The same controller, following the profile.
pub fn with_profile(settings: Settings, max_acceleration: f64) -> Settings {
    Settings {
        reference: ReferenceSource::Profile,
        profile_max_acceleration: max_acceleration,
        ..settings
    }
}

/// Feedback of the disturbance experiment (eq 36).
pub fn feedback_of_equation_36(law: feedback::Law) -> feedback::Settings {
    feedback::Settings {
        law,
        weights: feedback::Weights {
            angle: 1.0,
            velocity: 1e-3,
            integral: 10.0,
            torque: 1e-3,
        },
        ..feedback::Settings::pendulum()
    }
}
