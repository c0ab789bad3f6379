//! The deviation z = (θ−θr, ω−ωr, e_L) along a plan: the same whatever the moves are
//! ([`super::transcription`]), and a linear form of z at the start, with coefficients known at set-up.

use arm::{Arithmetic, Vector, elementary};

use super::rk4::{Interval, Lanes, Matrix3, STAGES};

/// z from any start.
#[derive(Clone, Debug)]
pub struct Deviation {
    /// z at the start.
    start: [f64; 3],
    /// θ−θr and ω−ωr at the stages, and z after the interval in the first three lanes \[N × 3 × 4\].
    along: Vec<[Lanes; 3]>,
    /// ∂/∂z_0 of that \[N × 3 × 3 × 4\].
    by_start: Vec<[[Lanes; 3]; 3]>,
}

impl Deviation {
    /// Of a plan of `horizon` intervals; `intervals` are these, or a single one if all are equal. O(N).
    pub fn new(intervals: &[Interval], horizon: usize) -> Self {
        let mut z = nalgebra::Matrix3::identity();
        let by_start = |interval: &Interval| {
            let after = interval.deviation.map(|step| from_rows(&step) * z);
            z = after[STAGES];
            // An unstable loop's may overflow; no deviation at the start shall stay none.
            let finite = |x: f64| if x.is_finite() { x } else { f64::MAX };
            let row = |lane: &dyn Fn(usize, usize) -> f64| {
                std::array::from_fn(|i| std::array::from_fn(|j| finite(lane(j, i))))
            };
            [
                row(&|j, i| after[j][(0, i)]),
                row(&|j, i| after[j][(1, i)]),
                row(&|j, i| if j < 3 { z[(j, i)] } else { 0.0 }),
            ]
        };
        let each = intervals.iter().cycle().take(horizon);
        Self {
            start: [0.0; 3],
            along: vec![[[0.0; STAGES]; 3]; horizon],
            by_start: each.map(by_start).collect(),
        }
    }

    /// Sets z at the start. O(N).
    #[inline(always)]
    pub fn set<A: Arithmetic>(&mut self, start: [f64; 3]) {
        self.start = start;
        let z = start.map(A::Vector::splat);
        for (rows, by_start) in self.along.iter_mut().zip(&self.by_start) {
            for (row, [a, b, c]) in rows.iter_mut().zip(by_start) {
                let both = A::Vector::new(b).mul_add(z[1], A::Vector::new(a) * z[0]);
                *row = A::Vector::new(c).mul_add(z[2], both).lanes();
            }
        }
    }

    /// θ−θr and ω−ωr at the stages, and z after the interval in the first three lanes \[N × 3 × 4\].
    #[inline(always)]
    pub fn along(&self) -> &[[Lanes; 3]] {
        &self.along
    }

    /// z at node `k`.
    pub fn at(&self, k: usize) -> [f64; 3] {
        k.checked_sub(1).map_or(self.start, |interval| {
            let [_, _, [angle, velocity, integral, _]] = self.along[interval];
            [angle, velocity, integral]
        })
    }
}

/// Product of the spectral radii of the steps of z over `horizon` intervals: above 1 RK4 lets the tracking error
/// grow. `intervals` are these, or a single one if all are equal.
pub fn growth(intervals: &[Interval], horizon: usize) -> f64 {
    let of = |interval: &Interval| spectral_radius(&interval.deviation[STAGES]);
    if let [interval] = intervals {
        return elementary::pow(of(interval), horizon as f64);
    }
    intervals.iter().map(of).product()
}

fn from_rows(matrix: &Matrix3) -> nalgebra::Matrix3<f64> {
    nalgebra::Matrix3::from_fn(|r, c| matrix[r][c])
}

/// Largest magnitude of an eigenvalue.
fn spectral_radius(matrix: &Matrix3) -> f64 {
    match nalgebra::Schur::try_new(from_rows(matrix), f64::EPSILON, 1000) {
        Some(schur) => {
            let eigenvalues = schur.complex_eigenvalues();
            eigenvalues
                .iter()
                .map(|z| elementary::hypot(z.re, z.im))
                .fold(0.0, f64::max)
        }
        None => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nmpc::examples::tflex;
    use arm::Separate;

    /// An unstable prediction overflows; from no deviation there is none nevertheless.
    #[test]
    fn no_deviation_stays_none() {
        let mut problem = tflex();
        problem.feedback.gain_velocity = 1e6;
        let intervals = [Interval::new(&problem, 0.05)];
        let mut deviation = Deviation::new(&intervals, 200);
        for (start, finite) in [([0.0; 3], true), ([1e-3, 0.0, 0.0], false)] {
            deviation.set::<Separate>(start);
            assert_eq!(deviation.at(200).iter().all(|z| z.abs() < 1e100), finite);
        }
        deviation.set::<Separate>([0.0; 3]);
        assert_eq!(deviation.at(200), [0.0; 3]);
    }
}
