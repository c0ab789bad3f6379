//! The torque over the angle without a formula, and a measurement compressed to a few hundred numbers by it.
//!
//! Cubic B-splines over the angle stand for any smooth g(θ). One pass over the measurement gives R of the QR
//! factorisation of `[α ω θ 1 z splines τ]`; a wave cos(ωθ) is a combination of the splines, so that R alone
//! tells how well waves of any frequency fit. Thousands of frequencies are then tried in the time of one pass.

use crate::least_squares::Triangle;
use crate::regression::{LINEAR, Regression};
use arm::HARMONICS;
use nalgebra::DMatrix;
use std::ops::Range;

/// Intervals between knots across the range of the angle.
const INTERVALS: usize = 200;
/// Largest ω·knot distance of a wave: the splines follow it within 0.1 %.
const FINEST: f64 = 0.8;

/// Rows that are factorised at a time.
const CHUNK: usize = 512;

/// Cubic B-splines with equidistant knots.
#[derive(Clone, Copy, Debug)]
struct Splines {
    low: f64,
    spacing: f64,
}

impl Splines {
    const COUNT: usize = INTERVALS + 3;

    /// The four that are not zero at `angle`, from the first one's index on.
    fn at(&self, angle: f64) -> (usize, [f64; 4]) {
        let position = ((angle - self.low) / self.spacing).clamp(0.0, INTERVALS as f64);
        let cell = (position as usize).min(INTERVALS - 1);
        let u = position - cell as f64;
        let v = 1.0 - u;
        let values = [
            v * v * v / 6.0,
            (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
            (4.0 - 6.0 * v * v + 3.0 * v * v * v) / 6.0,
            u * u * u / 6.0,
        ];
        (cell, values)
    }

    /// Angle at which spline `index` is largest.
    fn centre(&self, index: usize) -> f64 {
        self.low + self.spacing * (index as f64 - 1.0)
    }
}

/// A measurement, compressed.
#[derive(Clone, Debug)]
pub struct Compressed {
    splines: Splines,
    span: f64,
    blocks: Vec<Triangle>,
    whole: Triangle,
}

impl Compressed {
    /// Compresses each block of rows, and all of them. Blocks follow each other and cover all rows.
    pub fn new(regression: &Regression, blocks: &[Range<usize>]) -> Self {
        let [low, high] = regression.range();
        let span = (high - low).max(f64::MIN_POSITIVE);
        let splines = Splines {
            low,
            spacing: span / INTERVALS as f64,
        };
        let columns = LINEAR + Splines::COUNT + 1;
        let linear: Vec<Vec<f64>> = (0..LINEAR).map(|i| regression.linear(i)).collect();
        let torque = regression.torque();
        let mut triangles = vec![Triangle::empty(columns); blocks.len()];
        let mut chunk = DMatrix::zeros(CHUNK, columns);
        let (mut filled, mut block) = (0, 0);
        regression.windows(|row, angles, weights| {
            for (c, column) in linear.iter().enumerate() {
                chunk[(filled, c)] = column[row];
            }
            for (angle, weight) in angles.iter().zip(weights) {
                let (cell, values) = splines.at(*angle);
                for (i, value) in values.iter().enumerate() {
                    chunk[(filled, LINEAR + cell + i)] += weight * value;
                }
            }
            chunk[(filled, columns - 1)] = torque[row];
            filled += 1;
            let ends = blocks.get(block).is_some_and(|b| row + 1 == b.end);
            if ends || filled == CHUNK {
                triangles[block].add(chunk.rows(0, filled).into_owned());
                chunk.fill(0.0);
                filled = 0;
            }
            block += usize::from(ends && block + 1 < blocks.len());
        });
        let mut whole = Triangle::empty(columns);
        triangles.iter().for_each(|b| whole.merge(b));
        Self {
            splines,
            span,
            blocks: triangles,
            whole,
        }
    }

    /// Range of the angle \[rad\].
    pub fn span(&self) -> f64 {
        self.span
    }

    /// Highest frequency that the splines can follow \[1/rad\].
    pub fn finest(&self) -> f64 {
        FINEST / self.splines.spacing
    }

    /// From columns `α ω θ 1 z splines` to `α ω θ 1 z cos(wθ) sin(wθ) cos(2wθ) …`.
    ///
    /// Σ_j e^{iω(t_j − θ)} B_j(θ) is 2/3 + cos(ω·spacing)/3 at every knot: waves are interpolated there.
    fn waves(&self, frequency: f64, harmonics: usize) -> DMatrix<f64> {
        let harmonics = harmonics.min(HARMONICS);
        let mut map = DMatrix::zeros(LINEAR + Splines::COUNT, LINEAR + 2 * harmonics);
        for i in 0..LINEAR {
            map[(i, i)] = 1.0;
        }
        for i in 0..harmonics {
            let omega = (i + 1) as f64 * frequency;
            let gain = 2.0 / 3.0 + (omega * self.splines.spacing).cos() / 3.0;
            for j in 0..Splines::COUNT {
                let (sin, cos) = (omega * self.splines.centre(j)).sin_cos();
                map[(LINEAR + j, LINEAR + 2 * i)] = cos / gain;
                map[(LINEAR + j, LINEAR + 2 * i + 1)] = sin / gain;
            }
        }
        map
    }

    /// Sum of the squared residuals of all rows with these waves \[(N·m)²\].
    pub fn residual(&self, frequency: f64, harmonics: usize) -> f64 {
        self.whole
            .mapped(&self.waves(frequency, harmonics))
            .residual()
    }

    /// The same with any function of the angle: the least that waves could reach.
    pub fn residual_of_any_curve(&self) -> f64 {
        self.whole.residual()
    }

    /// Each block with these waves.
    pub fn blocks(&self, frequency: f64, harmonics: usize) -> Vec<Triangle> {
        let map = self.waves(frequency, harmonics);
        self.blocks.iter().map(|b| b.mapped(&map)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frequency::Projection;
    use crate::{Measurement, Settings, Timing};
    use proptest::prelude::*;

    proptest! {
        /// Splines add up to one, and so do the first moments to the angle.
        #[test]
        fn splines_reproduce_lines(angle in 0.0..1.0_f64) {
            let splines = Splines { low: 0.0, spacing: 1.0 / INTERVALS as f64 };
            let (cell, values) = splines.at(angle);
            prop_assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let moment: f64 = values.iter().enumerate().map(|(i, v)| v * splines.centre(cell + i)).sum();
            prop_assert!((moment - angle).abs() < 1e-12);
        }
    }

    /// The compressed measurement answers as the measurement does.
    #[test]
    fn compressed_residuals_are_those_of_all_rows() {
        let angle: Vec<f64> = (0..12_000)
            .map(|k| {
                let t = f64::from(k) * 2.5e-4;
                1.0 + 0.4 * (6.0 * t).sin() + 0.2 * (15.1 * t).sin()
            })
            .collect();
        let torque = angle
            .iter()
            .map(|a| a + 0.3 * (9.0 * a).cos() + 0.1 * (25.0 * a).sin())
            .collect();
        let measurement = Measurement {
            timing: Timing::Sampled,
            ..Measurement::new(2.5e-4, angle, torque)
        };
        let regression = Settings::default().regression(&measurement).unwrap();
        let half = regression.rows() / 2;
        let compressed = Compressed::new(&regression, &[0..half, half..regression.rows()]);
        for (frequency, harmonics) in [(9.0, 1), (7.0, 3), (11.3, 4)] {
            let exact = Projection::new(&regression, [true; LINEAR], harmonics, frequency).unwrap();
            let found = compressed.residual(frequency, harmonics);
            let ratio = found / exact.solution.residual;
            assert!((0.98..1.02).contains(&ratio), "{frequency}: {ratio}");
            let blocks = compressed.blocks(frequency, harmonics);
            let mut merged = Triangle::empty(blocks[0].r().ncols());
            blocks.iter().for_each(|b| merged.merge(b));
            assert_eq!(merged.rows(), regression.rows());
            assert!((merged.residual() / found - 1.0).abs() < 1e-6);
        }
        assert!(compressed.residual_of_any_curve() < 1e-6 * compressed.residual(9.0, 1));
    }
}
