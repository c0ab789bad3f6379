//! Publishes a plan at equidistant instants over the horizon, whatever the number of its intervals.

use control::Reference;
use control::nmpc::planner::Plan;

use crate::variables::NmpcPlan;

/// Instants at which a plan is published; with N = 40 these are the shooting nodes.
const INSTANTS: usize = 41;

/// Writes the trajectory of a plan with shooting intervals of `period` \[s\]. O(instants).
///
/// The reference is exact between nodes, u being constant there; angle and thermal load are linear
/// between nodes.
pub fn publish(plan: &Plan, period: f64, published: &mut NmpcPlan) {
    let (moves, nodes) = (&plan.moves, &plan.trajectory);
    let intervals = moves.len();
    for instant in 0..INSTANTS {
        // In intervals from the start; whole numbers come out exactly.
        let position = (instant * intervals) as f64 / (INSTANTS - 1) as f64;
        let interval = (position as usize).min(intervals - 1);
        let part = position - interval as f64;
        let between = |values: &[f64]| {
            let (from, to) = (values[interval], values[interval + 1]);
            if part == 0.0 {
                from
            } else {
                from + part * (to - from)
            }
        };
        let reference = Reference {
            angle: nodes.reference_angle[interval],
            velocity: nodes.reference_velocity[interval],
            acceleration: moves[interval],
        }
        .advanced(part * period);
        published.time[instant] = position * period;
        published.angle[instant] = between(&nodes.angle);
        published.reference_angle[instant] = reference.angle;
        published.reference_velocity[instant] = reference.velocity;
        published.acceleration[instant] = reference.acceleration;
        published.thermal_load[instant] = between(&nodes.thermal_load);
    }
}
