//! Closed loops that plan at different rates, shared by the tests and the benchmarks.

use control::nmpc::plan::PlanStatus;
use control::nmpc::settings;
use control::{Command, Settings};

use super::Loop;

/// Length of a run \[s\].
pub const SECONDS: f64 = 10.0;
/// A setpoint a second \[rad\].
pub const TFLEX: [f64; 10] = [1.1, 1.4, 1.0, 1.3, 1.45, 0.96, 1.2, 1.5, 1.0, 1.3];
/// A setpoint a second \[rad\], as far apart as the thermal limit allows.
pub const PENDULUM: [f64; 10] = [0.1, 1.4, 0.4, 1.5, 0.1, 1.5, 0.8, 1.3, 0.2, 1.5];

/// The setpoint of a sequence, and no push, at a time \[s\].
pub fn setpoint(sequence: &[f64; 10], time: f64) -> [f64; 2] {
    [sequence[(time as usize).min(9)], 0.0]
}

/// A setpoint held, and a push of `torque` \[N·m\] from 2 s to 6 s, at a time \[s\].
pub fn push(setpoint: f64, torque: f64, time: f64) -> [f64; 2] {
    let pushed = (2.0..6.0).contains(&time);
    [setpoint, if pushed { torque } else { 0.0 }]
}

/// The same controller, planning every `period` \[s\] over 2 s.
pub fn every(period: f64, settings: Settings) -> Settings {
    let nmpc = settings::Settings {
        period,
        duration: 2.0,
        ..settings.nmpc
    };
    Settings { nmpc, ..settings }
}

/// What a run led to.
#[derive(Debug)]
pub struct Run {
    /// Σ (goal − θ)² over the samples \[rad²\].
    pub score: f64,
    pub plans: u32,
    /// Plans that are neither solved nor solved for the least excess.
    pub unsolved: u32,
    /// Plans that took iterations.
    pub iterated: u32,
    pub iterations: u32,
    pub most_iterations: u32,
    /// Largest excess of the thermal load over the limit that plans keep, at the nodes where they keep it \[A²\].
    pub excess: f64,
    pub violations: u32,
}

impl Run {
    /// Iterations of those plans that took any.
    pub fn mean_iterations(&self) -> f64 {
        f64::from(self.iterations) / f64::from(self.iterated.max(1))
    }

    fn count(&mut self, closed_loop: &Loop, command: &Command, limit: f64) {
        self.violations += u32::from(closed_loop.violates());
        if !command.new_plan {
            return;
        }
        let plan = closed_loop.controller.plan().expect("at hand");
        self.excess = self.excess.max(command.thermal_load - limit);
        self.plans += 1;
        self.iterated += u32::from(plan.iterations > 0);
        self.iterations += plan.iterations;
        self.most_iterations = self.most_iterations.max(plan.iterations);
        self.unsolved += u32::from(!matches!(
            plan.status,
            PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::ThermalSlack
        ));
    }
}

/// [`SECONDS`] with a setpoint \[rad\] and a disturbing torque \[N·m\] for every time \[s\]; `see` gets time and
/// error \[rad\] of every sample.
pub fn run(
    mut closed_loop: Loop,
    settings: &Settings,
    at: impl Fn(f64) -> [f64; 2],
    mut see: impl FnMut(f64, f64),
) -> Run {
    let limit = settings.nmpc.thermal_share.powi(2) * settings.motor.thermal_limit();
    let mut run = Run {
        score: 0.0,
        plans: 0,
        unsolved: 0,
        iterated: 0,
        iterations: 0,
        most_iterations: 0,
        excess: f64::NEG_INFINITY,
        violations: 0,
    };
    for sample in 0..(SECONDS / settings.sample_period).round() as u32 {
        let time = f64::from(sample) * settings.sample_period;
        let [setpoint, disturbance] = at(time);
        let error = setpoint - closed_loop.motion.angle;
        run.score += error * error;
        see(time, error);
        let command = closed_loop.step(setpoint, disturbance);
        run.count(&closed_loop, &command, limit);
    }
    run
}
