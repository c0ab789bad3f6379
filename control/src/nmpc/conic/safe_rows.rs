//! Variables, rows and cones that keep the plan's end in the safe sets ([`super::super::safe_set`]).
//!
//! With X the range of angles and V² = 2·(τ_max + g_min)/J·X as units, for either side, v being the velocity
//! towards its bound and Δ its distance:
//!
//! ```text
//! variables   w, y, and with a thermal limit p, q, r                (w in V, y in X, r in V³/X)
//! rows        v_N/V ≤ w ≤ speed/V      y + h·V/(2·X)·w ≤ Δ_N/X      y ≤ D·V/(2·X)·w
//! cones       w² ≤ y       p² ≤ r·y       q² ≤ w       w² ≤ p·q
//! ```
//!
//! The heat of stopping, `cubic·V³/X·r + linear·V·w` of both sides, stands beside T_N in the last row of the
//! thermal limit and shares its slack.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT;

use super::super::rollout::Rollout;
use super::super::safe_set::SafeSet;
use super::super::solver::Task;
use super::super::spline::stencil;
use super::pattern::{Entries, place};

/// Linear rows of a side.
const ROWS: usize = 4;
/// Rows of a cone.
const CONE: usize = 3;

/// Where the variables and rows of the safe sets are.
#[derive(Clone, Copy, Debug)]
pub struct SafeRows {
    /// Whether there is a thermal limit.
    thermal: bool,
    /// N.
    horizon: usize,
    /// First variable.
    column: usize,
    /// First linear row.
    row: usize,
    /// First row of the cones.
    cone: usize,
}

impl SafeRows {
    /// Linear rows in all.
    pub const LINEAR: usize = 2 * ROWS;

    /// With the first variable at `column`, the linear rows at `row` and those of the cones at `cone`.
    pub fn new(horizon: usize, thermal: bool, column: usize, row: usize, cone: usize) -> Self {
        Self {
            thermal,
            horizon,
            column,
            row,
            cone,
        }
    }

    /// Variables of a side.
    fn per_side(&self) -> usize {
        if self.thermal { 5 } else { 2 }
    }

    /// Cones of a side.
    fn cones_per_side(&self) -> usize {
        if self.thermal { 4 } else { 1 }
    }

    /// Variables in all.
    pub fn variables(&self) -> usize {
        2 * self.per_side()
    }

    /// Rows of the cones in all.
    pub fn cone_rows(&self) -> usize {
        2 * self.cones_per_side() * CONE
    }

    /// The cones.
    pub fn cones(&self) -> impl Iterator<Item = SupportedConeT<f64>> {
        (0..2 * self.cones_per_side()).map(|_| SupportedConeT::SecondOrderConeT(CONE))
    }

    /// (w, y, p, q, r) of a side; the last three only with a thermal limit.
    fn columns(&self, side: usize) -> [usize; 5] {
        std::array::from_fn(|i| self.column + side * self.per_side() + i)
    }

    /// The entries; `room` is the row of the thermal limit at the node N.
    pub fn add(&self, room: usize, entries: &mut Entries) {
        for side in 0..2 {
            let [w, y, p, q, r] = self.columns(side);
            let row = self.row + side * ROWS;
            for m in [self.horizon - 2, self.horizon - 1] {
                entries.add(row, m, 0.0);
                entries.add(row + 2, m, 0.0);
            }
            entries.add(row, w, -1.0);
            entries.add(row + 1, w, 1.0);
            entries.add(row + 2, w, 0.0);
            entries.add(row + 2, y, 1.0);
            entries.add(row + 3, w, 0.0);
            entries.add(row + 3, y, 1.0);
            let mut cone = self.cone + side * self.cones_per_side() * CONE;
            // a² ≤ b·c as ‖(b − c, 2·a)‖ ≤ b + c; no c: 1, which [`Self::constants`] sets.
            let mut square = |a: usize, b: usize, c: Option<usize>| {
                entries.add(cone, b, -1.0);
                entries.add(cone + 1, b, -1.0);
                if let Some(c) = c {
                    entries.add(cone, c, -1.0);
                    entries.add(cone + 1, c, 1.0);
                }
                entries.add(cone + 2, a, -2.0);
                cone += CONE;
            };
            square(w, y, None);
            if self.thermal {
                square(q, w, None);
                square(p, r, Some(y));
                square(w, p, Some(q));
                entries.add(room, w, 0.0);
                entries.add(room, r, 0.0);
            }
        }
    }

    /// Sets what is constant in `b`.
    pub fn constants(&self, b: &mut [f64]) {
        for side in 0..2 {
            let cone = self.cone + side * self.cones_per_side() * CONE;
            for of_one in 0..self.cones_per_side().min(2) {
                b[cone + of_one * CONE] = 1.0;
                b[cone + of_one * CONE + 1] = -1.0;
            }
        }
    }

    /// The values for `set` around the end of `rollout`; `room` as in [`Self::add`], `unit` what its row is
    /// scaled by \[A²\].
    pub fn pose(
        &self,
        task: &Task<'_>,
        set: &SafeSet,
        rollout: &Rollout,
        [sigma, unit]: [f64; 2],
        room: usize,
        (a, b): (&mut CscMatrix<f64>, &mut [f64]),
    ) {
        let (angle, velocity) = (
            rollout.reference_angle[self.horizon],
            rollout.reference_velocity[self.horizon],
        );
        let [of_angle, of_velocity, _] = stencil(task.transcription, self.horizon);
        let range = set.upper - set.lower;
        let rooms = [set.upper - angle, angle - set.lower];
        let mut put = |row: usize, column: usize, value: f64| {
            let place = place(a, row, column);
            a.nzval[place] = value;
        };
        for (index, side) in set.sides.iter().enumerate() {
            let sign = if index == 0 { 1.0 } else { -1.0 };
            let unit_velocity = (2.0 * side.deceleration * range).sqrt();
            let [w, _, _, _, r] = self.columns(index);
            let row = self.row + index * ROWS;
            for (column, m) in [self.horizon - 2, self.horizon - 1].into_iter().enumerate() {
                put(row, m, sign * sigma * of_velocity[column] / unit_velocity);
                put(row + 2, m, sign * sigma * of_angle[column] / range);
            }
            b[row] = -sign * velocity / unit_velocity;
            b[row + 1] = f64::min(side.speed / unit_velocity, 1.0);
            let rate = 0.5 * unit_velocity / range;
            put(row + 2, w, rate * set.interval);
            b[row + 2] = rooms[index] / range;
            put(row + 3, w, -rate * set.time);
            b[row + 3] = 0.0;
            if self.thermal {
                let heat = [
                    side.linear * unit_velocity,
                    side.cubic * unit_velocity.powi(3) / range,
                ];
                put(room, w, heat[0] / unit);
                put(room, r, heat[1] / unit);
            }
        }
    }
}
