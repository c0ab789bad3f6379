//! A plan, how it came to be, and what is remembered of it.

use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::rollout::Rollout;
use super::solver::Multipliers;
use crate::Reference;

/// How the plan in use came to be; numbered as `PlanStatus` in the contract.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(i32)]
pub enum PlanStatus {
    /// No plan.
    #[default]
    Idle = 0,
    /// Solved to tolerance.
    Solved = 1,
    /// Solved for the admissible rest point nearest to the setpoint.
    GoalProjected = 2,
    /// Solved, but the thermal limit, or the torque limit of the linear model, could not be kept: the least
    /// excess was planned.
    ThermalSlack = 3,
    /// The solver was stopped before it converged: the plan is admissible, or exceeds the
    /// thermal limit little more than going on as before would, or going on would leave the angle bounds.
    IterationLimit = 4,
    /// No new plan was found: the previous plan, shifted.
    ShiftedPlan = 5,
    /// No plan was found and none is left: the reference is brought to rest.
    Rest = 6,
    /// A measurement was not a number: the last good command is held.
    MeasurementHeld = 7,
    /// Start and terminal rest left no way within the angle bounds: they were widened.
    AngleSlack = 8,
    /// The deadline came before the solver converged: the plan is admissible, or exceeds the
    /// thermal limit little more than going on as before would, or going on would leave the angle bounds.
    Deadline = 9,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How it came to be.
    pub status: PlanStatus,
    /// Interior-point iterations; 0 for a plan in closed form.
    pub iterations: u32,
    /// Convex problems that Clarabel solved.
    pub convex_problems: u32,
    /// Rest point at the end \[rad\].
    pub goal: f64,
    /// Time of the shooting nodes from the start of the plan \[N + 1\] \[s\].
    pub time: Vec<f64>,
    /// u \[N\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// Trajectory and cost in the true model.
    pub trajectory: Rollout,
}

/// A plan at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Time from the start of the plan \[s\].
    pub time: f64,
    /// θ \[rad\].
    pub angle: f64,
    /// θr, ωr and u.
    pub reference: Reference,
    /// T \[A²\].
    pub thermal_load: f64,
}

impl Plan {
    /// No plan yet, on `grid`.
    pub fn new(grid: &Grid) -> Self {
        let time = grid.nodes().to_vec();
        let horizon = time.len() - 1;
        Self {
            status: PlanStatus::Idle,
            iterations: 0,
            convex_problems: 0,
            goal: 0.0,
            time,
            moves: vec![0.0; horizon],
            trajectory: Rollout::new(horizon),
        }
    }

    /// θr and ωr at its end \[rad, rad/s\].
    pub fn end(&self) -> [f64; 2] {
        let last = self.moves.len();
        let nodes = &self.trajectory;
        [nodes.reference_angle[last], nodes.reference_velocity[last]]
    }

    /// The plan at `position` = 0..N, counted in shooting intervals from its start. The reference is exact
    /// between nodes, u being constant there; angle and thermal load are linear. O(1).
    pub fn at(&self, position: f64) -> Instant {
        let interval = (position as usize).min(self.moves.len() - 1);
        let part = position - interval as f64;
        let between = |values: &[f64]| {
            let (from, to) = (values[interval], values[interval + 1]);
            if part == 0.0 {
                from
            } else {
                from + part * (to - from)
            }
        };
        let nodes = &self.trajectory;
        let node = Reference {
            angle: nodes.reference_angle[interval],
            velocity: nodes.reference_velocity[interval],
            acceleration: self.moves[interval],
        };
        Instant {
            time: between(&self.time),
            angle: between(&nodes.angle),
            reference: node.advanced(part * (self.time[interval + 1] - self.time[interval])),
            thermal_load: between(&nodes.thermal_load),
        }
    }
}

/// What the planner remembers from plan to plan.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannerState {
    /// Moves of the latest plan that was found, or of braking to rest, and of the braking that follows a plan
    /// without terminal rest \[N, or N + max(N, 40)\] \[rad/s²\].
    pub moves: Vec<f64>,
    /// How many periods ago that was; none before the first plan.
    pub age: Option<u32>,
    /// Multipliers of the latest plan.
    pub multipliers: Multipliers,
}

impl PlannerState {
    /// Before the first plan of `horizon` intervals, each remembered with `braking` more.
    pub fn new(horizon: usize, braking: usize) -> Self {
        Self {
            moves: vec![0.0; horizon + braking],
            age: None,
            multipliers: Multipliers::new(horizon),
        }
    }
}

impl Clone for PlannerState {
    fn clone(&self) -> Self {
        Self {
            moves: self.moves.clone(),
            age: self.age,
            multipliers: self.multipliers.clone(),
        }
    }

    /// Without allocation where the horizons agree.
    fn clone_from(&mut self, source: &Self) {
        self.moves.clone_from(&source.moves);
        self.age = source.age;
        self.multipliers.clone_from(&source.multipliers);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_nodes_the_reference_moves_as_u_says() {
        let mut trajectory = Rollout::new(2);
        trajectory.angle = vec![1.0, 1.2, 1.3];
        trajectory.reference_angle = vec![1.0, 1.25, 2.0];
        trajectory.reference_velocity = vec![0.0, 1.0, 2.0];
        trajectory.thermal_load = vec![4.0, 6.0, 5.0];
        let plan = Plan {
            status: PlanStatus::Solved,
            iterations: 0,
            convex_problems: 0,
            goal: 2.0,
            time: vec![0.0, 0.5, 1.0],
            moves: vec![2.0, 2.0],
            trajectory,
        };
        let middle = plan.at(0.5);
        assert_eq!((middle.time, middle.thermal_load), (0.25, 5.0));
        assert!((middle.angle - 1.1).abs() < 1e-15);
        assert_eq!(
            (middle.reference.angle, middle.reference.velocity),
            (1.0625, 0.5)
        );
        // At the nodes the values are those of the nodes, the last move repeats.
        let end = plan.at(2.0);
        assert!((end.angle - 1.3).abs() < 1e-15 && end.thermal_load == 5.0);
        assert_eq!(
            (end.reference.angle, end.reference.acceleration),
            (2.0, 2.0)
        );
    }
}
