//! Publishes a plan at equidistant instants over the horizon, whatever the number of its intervals.

use control::nmpc::plan::Plan;

use crate::variables::NmpcPlan;

/// Instants at which a plan is published; with N = 40 these are the shooting nodes.
const INSTANTS: usize = 41;

/// Writes a plan with shooting intervals of `period` \[s\]. O(instants).
pub fn publish(plan: &Plan, period: f64, published: &mut NmpcPlan) {
    for k in 0..INSTANTS {
        // In intervals from the start; whole numbers come out exactly.
        let instant = plan.at(
            (k * plan.moves.len()) as f64 / (INSTANTS - 1) as f64,
            period,
        );
        published.time[k] = instant.time;
        published.angle[k] = instant.angle;
        published.reference_angle[k] = instant.reference.angle;
        published.reference_velocity[k] = instant.reference.velocity;
        published.acceleration[k] = instant.reference.acceleration;
        published.thermal_load[k] = instant.thermal_load;
    }
}
