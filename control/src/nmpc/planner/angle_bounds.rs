//! The angle bounds of one plan (eq 25), wider where the start demands it.

use super::super::problem::Problem;
use super::super::rollout::Rollout;

/// Bounds of θr at the nodes after the first (eq 25). A start outside may return as slowly as the optimum
/// without inequalities does; once that is inside, the bounds hold. Whether they are wider than the problem's.
pub fn bound_angle(bounds: &mut [[f64; 2]], problem: &Problem, unbounded: &Rollout) -> bool {
    let (lower, upper) = (problem.angle_lower, problem.angle_upper);
    let start = unbounded.reference_angle[0];
    // A solver's tolerance beyond a bound is no licence to leave it.
    if problem.admits_angle(start) {
        bounds.fill([lower, upper]);
        return false;
    }
    let (mut below, mut above) = (start < lower, start > upper);
    for (bound, &angle) in bounds.iter_mut().zip(&unbounded.reference_angle[1..]) {
        below &= angle < lower;
        above &= angle > upper;
        *bound = [
            if below { angle } else { lower },
            if above { angle } else { upper },
        ];
    }
    are_wider(bounds, problem)
}

fn are_wider(bounds: &[[f64; 2]], problem: &Problem) -> bool {
    let mut all = bounds.iter().flatten();
    !all.all(|&bound| problem.admits_angle(bound))
}

/// Widens the bounds so that `trajectory` keeps them; whether they are wider than the problem's.
pub fn widen(bounds: &mut [[f64; 2]], problem: &Problem, trajectory: &Rollout) -> bool {
    for ([lower, upper], &angle) in bounds.iter_mut().zip(&trajectory.reference_angle[1..]) {
        (*lower, *upper) = (lower.min(angle), upper.max(angle));
    }
    are_wider(bounds, problem)
}
