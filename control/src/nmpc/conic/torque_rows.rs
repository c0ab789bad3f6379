//! Rows of the pessimistic torque limit (appendix C.3): two for either end of every interval, and the sign of
//! a slack t that all have in common.
//!
//! ```text
//! (g_upper(θ) + d·ωr + J·u)_new ≤ τ_max·(1 + t)     −(g_lower(θ) + d·ωr + J·u)_new ≤ τ_max·(1 + t)     t ≥ 0
//! ```
//!
//! The left sides are affine in the spline's coefficients. A row is scaled by its largest coefficient, which
//! takes σ and all units out of the matrix.

use clarabel::algebra::CscMatrix;

use super::super::rollout::Rollout;
use super::super::solver::Task;
use super::super::spline::{free_columns, stencil};
use super::super::torque_bounds::TorqueLimit;
use super::super::transcription::Transcription;
use super::pattern::{Entries, place};

/// Rows per interval: above and below, at its start and at its end.
const ROWS: usize = 4;
/// What the slack's variable is in units of.
pub const UNIT: f64 = 1e-3;

/// Rows in all.
pub fn count(horizon: usize) -> usize {
    ROWS * horizon + 1
}

/// ∂τ/∂(c_{k−1}, c_k, c_{k+1}) at one `end` of interval `k`, for a bound of slope `slope` \[N·m/rad\].
fn gradient(transcription: &Transcription, k: usize, end: usize, slope: f64) -> [f64; 3] {
    let arm = &transcription.problem().arm;
    let h = transcription.interval(k).length;
    let time = h * end as f64;
    let of = [
        slope,
        slope * time + arm.damping,
        slope * 0.5 * time * time + arm.damping * time + arm.inertia,
    ];
    let stencil = stencil(transcription, k);
    std::array::from_fn(|column| (0..3).map(|row| of[row] * stencil[row][column]).sum())
}

/// Sign, end and slope of the rows of an interval.
fn kinds(limit: &TorqueLimit) -> [(f64, usize, f64); ROWS] {
    let (upper, lower) = (limit.upper.slope, limit.lower.slope);
    [
        (1.0, 0, upper),
        (-1.0, 0, lower),
        (1.0, 1, upper),
        (-1.0, 1, lower),
    ]
}

fn largest(gradient: &[f64; 3]) -> f64 {
    gradient
        .iter()
        .fold(f64::MIN_POSITIVE, |most, g| most.max(g.abs()))
}

/// The entries, from row `first` on, for `free` coefficients and the slack at column `slack`.
pub fn add(
    transcription: &Transcription,
    limit: &TorqueLimit,
    first: usize,
    [free, slack]: [usize; 2],
    entries: &mut Entries,
) {
    for k in 0..transcription.problem().horizon {
        for (row, (sign, end, slope)) in kinds(limit).into_iter().enumerate() {
            let gradient = gradient(transcription, k, end, slope);
            for (column, m) in free_columns(k, free) {
                let value = sign * gradient[column] / largest(&gradient);
                entries.add(first + ROWS * k + row, m, value);
            }
            entries.add(first + ROWS * k + row, slack, 0.0);
        }
    }
    let sign = first + ROWS * transcription.problem().horizon;
    entries.add(sign, slack, -1.0);
}

/// The room that `rollout` leaves, in `b` from row `first` on, and what the slack at column `slack` adds to
/// it.
pub fn pose(
    task: &Task<'_>,
    limit: &TorqueLimit,
    rollout: &Rollout,
    sigma: f64,
    [first, slack]: [usize; 2],
    (a, b): (&mut CscMatrix<f64>, &mut [f64]),
) {
    let arm = &task.transcription.problem().arm;
    let velocity = &rollout.reference_velocity;
    for k in 0..task.transcription.problem().horizon {
        let length = task.transcription.interval(k).length;
        let inertia = arm.inertia * (velocity[k + 1] - velocity[k]) / length;
        for (row, (sign, end, slope)) in kinds(limit).into_iter().enumerate() {
            let bound = if sign > 0.0 {
                &limit.upper
            } else {
                &limit.lower
            };
            let torque =
                bound.at(rollout.angle[k + end]) + arm.damping * velocity[k + end] + inertia;
            let scale = sigma * largest(&gradient(task.transcription, k, end, slope));
            let row = first + ROWS * k + row;
            b[row] = (limit.most - sign * torque) / scale;
            let place = place(a, row, slack);
            a.nzval[place] = -UNIT * limit.most / scale;
        }
    }
}
