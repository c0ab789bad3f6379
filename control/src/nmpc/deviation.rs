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
    /// The same for z = (1, 0, 0), (0, 1, 0) and (0, 0, 1) at the start \[N × 3 × 3 × 4\].
    of_units: Vec<[[Lanes; 3]; 3]>,
}

impl Deviation {
    /// Of a plan with `horizon` intervals, or a single one if all are equal. O(N).
    pub fn new(intervals: &[Interval], horizon: usize) -> Self {
        let mut z = nalgebra::Matrix3::identity();
        let of_units = |interval: &Interval| {
            let after = interval.deviation.map(|step| from_rows(&step) * z);
            z = after[STAGES];
            let row = |lane: &dyn Fn(usize, usize) -> f64| {
                std::array::from_fn(|unit| std::array::from_fn(|j| lane(j, unit)))
            };
            [
                row(&|j, unit| after[j][(0, unit)]),
                row(&|j, unit| after[j][(1, unit)]),
                row(&|j, unit| if j < 3 { z[(j, unit)] } else { 0.0 }),
            ]
        };
        let each = intervals.iter().cycle().take(horizon);
        Self {
            start: [0.0; 3],
            along: vec![[[0.0; STAGES]; 3]; horizon],
            of_units: each.map(of_units).collect(),
        }
    }

    /// Sets z at the start. O(N).
    #[inline(always)]
    pub fn set<A: Arithmetic>(&mut self, start: [f64; 3]) {
        self.start = start;
        let z = start.map(A::Vector::splat);
        for (rows, of_units) in self.along.iter_mut().zip(&self.of_units) {
            for (row, [a, b, c]) in rows.iter_mut().zip(of_units) {
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

/// Product of the spectral radii of the steps of z over `horizon` intervals, or a single one if all are equal:
/// above 1 RK4 lets the tracking error grow.
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
