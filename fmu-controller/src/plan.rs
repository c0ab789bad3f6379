//! Publishes a plan at points equidistant in its shooting intervals, whatever their number.

use control::nmpc::plan::Plan;

use crate::variables::NmpcPlan;

/// Writes a plan that begins `latency` \[s\] after the sample that made it, at as many points as the arrays
/// have; N + 1 are the shooting nodes. O(points).
pub fn publish(plan: &Plan, latency: f64, published: &mut NmpcPlan) {
    // There are two or more, by the range of their number.
    let last = published.time.len() - 1;
    for k in 0..=last {
        // In intervals from the start; whole numbers come out exactly.
        let instant = plan.at((k * plan.moves.len()) as f64 / last as f64);
        published.time[k] = latency + instant.time;
        published.angle[k] = instant.angle;
        published.reference_angle[k] = instant.reference.angle;
        published.reference_velocity[k] = instant.reference.velocity;
        published.acceleration[k] = instant.reference.acceleration;
        published.thermal_load[k] = instant.thermal_load;
    }
}
