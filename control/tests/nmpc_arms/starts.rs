//! Seeded starts in classes, shared by the tests and the benchmarks of the planner.

use control::nmpc::plan::Plan;
use control::nmpc::problem::{Initial, Problem};

/// What starts have in common.
#[derive(Clone, Copy, Debug)]
pub struct Class {
    /// Name, for tables.
    pub name: &'static str,
    /// Thermal load, in units of the plan's limit \[1\].
    pub loads: [f64; 2],
    /// Speed away from the goal \[rad/s\]; none: any that crosses the workspace in a second at most.
    pub away: Option<[f64; 2]>,
}

/// Anywhere, cool or hot.
pub const RANDOM: Class = within("random", [0.0, 0.9]);
/// With a thermal budget of 0.2 to 3 %.
pub const STARVED: Class = within("starved", [0.97, 0.998]);
/// The same for a motor so strong that only a fast start the wrong way heats it: that of the T-flex.
pub const STARVED_FAST: Class = Class {
    away: Some([8.0, 16.0]),
    ..STARVED
};
/// Above the limit by up to 0.2 %.
pub const OVER: Class = within("over", [1.0, 1.002]);
/// Above the limit by up to 50 %.
pub const FAR_OVER: Class = within("far over", [1.0, 1.5]);

/// A class of the given loads.
pub const fn within(name: &'static str, loads: [f64; 2]) -> Class {
    Class {
        name,
        loads,
        away: None,
    }
}

/// Uniform numbers from a seed.
pub struct Uniform(pub u64);

impl Uniform {
    /// A number between `low` and `high`.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * arm::random::uniform(&mut self.0)
    }

    /// A start of a class in the workspace, and a goal \[rad\].
    pub fn start(&mut self, problem: &Problem, class: &Class) -> (Initial, f64) {
        let (low, high) = (problem.angle_lower, problem.angle_upper);
        let (angle, goal) = (self.within(low, high), self.within(low, high));
        let velocity = match class.away {
            Some([slow, fast]) => self.within(slow, fast).copysign(angle - goal),
            None => self.within(low - high, high - low),
        };
        // Where the plan keeps no limit, the motor still has one.
        let limit = problem
            .thermal_limit
            .unwrap_or(problem.motor.thermal_limit());
        let load = self.within(class.loads[0], class.loads[1]) * limit;
        let initial = Initial {
            angle: angle + self.within(-2e-3, 2e-3),
            velocity: velocity + self.within(-2e-2, 2e-2),
            reference_angle: angle,
            reference_velocity: velocity,
            thermal_load: load,
            ..Initial::default()
        };
        (initial, goal)
    }
}

/// The start one period after `initial`, the planner's own model following `plan`.
pub fn following(plan: &Plan, initial: &Initial) -> Initial {
    let trajectory = &plan.trajectory;
    Initial {
        angle: trajectory.angle[1],
        velocity: trajectory.stages[1].velocity[0],
        reference_angle: trajectory.reference_angle[1],
        reference_velocity: trajectory.reference_velocity[1],
        thermal_load: trajectory.thermal_load[1],
        ..*initial
    }
}
