//! What is left without any plan: the reference is brought to rest.

use super::super::problem::{Initial, Problem};
use super::super::safe_set::SafeSet;

/// Brakes the reference to rest, evenly and no faster than the angle bound ahead demands; where plans end in
/// a safe set, as that says.
pub fn brake(
    problem: &Problem,
    set: Option<&SafeSet>,
    nodes: &[f64],
    initial: &Initial,
    moves: &mut [f64],
) {
    let (angle, velocity) = (initial.reference_angle, initial.reference_velocity);
    if let Some(set) = set {
        let lengths = nodes.windows(2).map(|node| node[1] - node[0]);
        return set.brake(angle, velocity, lengths, moves);
    }
    moves.fill(0.0);
    if !velocity.is_finite() || velocity == 0.0 {
        return;
    }
    let room = if velocity > 0.0 {
        problem.angle_upper - angle
    } else {
        angle - problem.angle_lower
    };
    let longest = 2.0 * room / velocity.abs();
    let intervals = nodes[1..].iter().take_while(|&&time| time <= longest);
    let intervals = intervals.count().max(1);
    moves[..intervals].fill(-velocity / nodes[intervals]);
}
