//! Rows of the regression (eqs 12, 13): for each instant the regressors p̄ and the torque, both filtered.
//!
//! The second difference of the angle is the mean of the acceleration over the two periods beside the sample,
//! with a triangular weight. A torque τ_k that is held from sample k on has the same weight in the mean
//! (τ_{k−1} + τ_k)/2, so that both sides of eq 12 belong to the instant of sample k. With τ_k itself the torque
//! would be late by half a period, and J·jerk·period/2 would pass for damping: 6 % of d on the T-flex at 4 kHz.
//!
//! Eq 12 is linear in φ but its regressors are not linear in θ. The mean of cos(iwθ) under the filter is not
//! cos(iw·mean θ): see [`Order`].

use crate::measurement::Measurement;
use crate::piece::{FORGETTING, Piece, Unused};
use crate::{Error, Hann};
use arm::HARMONICS;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// What the filter is applied to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// Every regressor, computed from the angle as measured. Eq 12 then holds for the filtered columns as it
    /// does for each sample.
    #[default]
    Regressors,
    /// Angle and torque, as the paper does; regressors come from the filtered angle. Smoothing takes amplitude
    /// off cogging and hysteresis where the arm is fast: 0.3 % of C, 0.5 % of k, 0.9 % of o on the T-flex.
    Signals,
}

/// Regressors beside the cogging: α, ω, θ, 1 and z, for J, d, k, o and C.
pub const LINEAR: usize = 5;

/// Rows that are filtered at a time: their samples stay in the cache.
const CHUNK: usize = 128;

/// Share of the root mean square speed below which the arm is at rest.
const REST: f64 = 0.2;

/// |z| from which on friction counts as fully built up.
const SLIDING: f64 = 0.9;

/// Position of z among the regressors.
pub(crate) const HYSTERESIS: usize = 4;

/// A measurement, filtered.
#[derive(Clone, Debug)]
pub struct Regression {
    pieces: Vec<Piece>,
    filter: Hann,
    order: Order,
    period: f64,
    stride: usize,
    rows: usize,
    /// Samples of the whole measurement.
    samples: usize,
    /// Why some segments leave no row, and how many samples they have.
    dropped: Vec<(Unused, usize)>,
    /// Rows that count; None: all.
    counted: Option<Vec<bool>>,
}

impl Regression {
    /// Filters a measurement; rows are `stride` samples apart. The angle that z follows passes `of_hysteresis`, unless
    /// `order` smooths it anyway.
    ///
    /// # Errors
    /// Values that are not finite, or fewer rows than `needed`.
    pub fn new(
        measurement: &Measurement,
        filter: &Hann,
        of_hysteresis: &Hann,
        order: Order,
        stride: usize,
        needed: usize,
    ) -> Result<Self, Error> {
        measurement.validate()?;
        let stride = stride.max(1);
        let filters = [filter, of_hysteresis];
        let pieces = |wait| {
            let (mut pieces, mut dropped) = (Vec::new(), Vec::new());
            for segment in &measurement.segments {
                match Piece::new(segment, measurement, filters, order, stride, wait) {
                    Ok(piece) => pieces.push(piece),
                    Err(why) => dropped.push((why, segment.angle.len())),
                }
            }
            (pieces, dropped)
        };
        // Of an arm that hardly moves all is kept: which parameters that leaves open is found out later.
        let (mut kept, mut dropped) = pieces(true);
        if kept.is_empty() {
            (kept, dropped) = pieces(false);
        }
        let rows = kept.iter().map(|piece| piece.torque.len()).sum();
        if rows < needed {
            return Err(Error::TooShort {
                rows,
                needed,
                samples: measurement.samples(),
                period: measurement.period,
            });
        }
        Ok(Self {
            pieces: kept,
            filter: filter.clone(),
            order,
            period: measurement.period,
            stride,
            rows,
            samples: measurement.samples(),
            dropped,
            counted: None,
        })
    }

    /// Which samples of a measurement with gaps do not count, and why.
    pub fn unused(&self) -> Vec<String> {
        let stretches = self.pieces.len() + self.dropped.len();
        if stretches < 2 {
            return Vec::new();
        }
        let of = |why: Unused| {
            let samples = self.dropped.iter().filter(move |(w, _)| *w == why);
            samples.fold((0, 0), |(n, sum), (_, samples)| (n + 1, sum + samples))
        };
        let waited: usize = self.pieces.iter().map(|piece| piece.waited).sum();
        let needed = self.filter.taps().len() + 2;
        let reasons = [
            (
                of(Unused::Short),
                format!("stretches are shorter than the {needed} samples that the filter needs"),
            ),
            (
                of(Unused::Still),
                format!(
                    "stretches end before the arm has moved {FORGETTING:.2} rad, after which the hysteresis has forgotten its start"
                ),
            ),
            (
                (self.pieces.len(), waited),
                format!("stretches begin to count once the arm has moved {FORGETTING:.2} rad"),
            ),
        ];
        let text = |((count, samples), reason): ((usize, usize), String)| {
            (samples > 0).then(|| {
                format!(
                    "samples are missing in {} places: {samples} of {} samples do not count, since {count} of {stretches} \
                     {reason}",
                    stretches - 1,
                    self.samples
                )
            })
        };
        reasons.into_iter().filter_map(text).collect()
    }

    /// The same with zeros in place of all rows at rest or soon after a reversal, where friction that holds the
    /// arm at rest is not what eq 13 says.
    pub fn sliding(mut self) -> Self {
        let z = self.linear(HYSTERESIS);
        let rows = self.motion().into_iter().zip(z);
        self.counted = Some(rows.map(|(moves, z)| moves && z.abs() >= SLIDING).collect());
        self
    }

    /// Which rows are not at rest: a fifth of the mean speed and more.
    pub fn motion(&self) -> Vec<bool> {
        let speed: Vec<f64> = self
            .pieces
            .iter()
            .flat_map(|p| &p.linear[1])
            .copied()
            .collect();
        let square: f64 = speed.iter().map(|v| v * v).sum::<f64>() / speed.len().max(1) as f64;
        let least = REST * square.sqrt();
        speed.iter().map(|v| v.abs() >= least).collect()
    }

    /// Number of rows that count.
    pub fn counted(&self) -> usize {
        let count = |c: &Vec<bool>| c.iter().filter(|c| **c).count();
        self.counted.as_ref().map_or(self.rows, count)
    }

    /// Of values of all rows those that count.
    pub fn select(&self, values: &[f64]) -> Vec<f64> {
        let rows = values.iter().enumerate();
        rows.filter(|(row, _)| self.counts(*row))
            .map(|(_, v)| *v)
            .collect()
    }

    fn counts(&self, row: usize) -> bool {
        self.counted.as_ref().is_none_or(|c| c[row])
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Samples from one row to the next.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The filter.
    pub fn filter(&self) -> &Hann {
        &self.filter
    }

    /// Time of each row \[s\].
    pub fn times(&self) -> Vec<f64> {
        let step = self.period * self.stride as f64;
        let of = |p: &Piece| {
            let start = p.start;
            (0..p.torque.len()).map(move |j| start + step * j as f64)
        };
        self.pieces.iter().flat_map(of).collect()
    }

    /// Filtered torque of each row \[N·m\].
    pub fn torque(&self) -> DVector<f64> {
        let torque = self.pieces.iter().flat_map(|p| &p.torque);
        let torque = torque
            .enumerate()
            .map(|(row, t)| if self.counts(row) { *t } else { 0.0 });
        DVector::from_iterator(self.rows, torque)
    }

    /// Regressor 0 to 4: α, ω, θ, 1, z, one value a row.
    pub fn linear(&self, index: usize) -> Vec<f64> {
        let values = self.pieces.iter().flat_map(|p| &p.linear[index]);
        values
            .enumerate()
            .map(|(row, v)| if self.counts(row) { *v } else { 0.0 })
            .collect()
    }

    /// Smallest and largest angle that the cogging is computed from \[rad\].
    pub fn range(&self) -> [f64; 2] {
        let angles = self.pieces.iter().flat_map(|p| &p.angle);
        angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| {
            [low.min(x), high.max(x)]
        })
    }

    /// Rows of each stretch without a gap.
    pub fn stretches(&self) -> Vec<Range<usize>> {
        let mut first = 0;
        let stretch = |p: &Piece| {
            let range = first..first + p.torque.len();
            first = range.end;
            range
        };
        self.pieces.iter().map(stretch).collect()
    }

    /// Filtered cos(iwθ), sin(iwθ) for i = 1 … `harmonics`, rows × 2·`harmonics`.
    pub fn cogging(&self, frequency: f64, harmonics: usize) -> DMatrix<f64> {
        let harmonics = harmonics.min(HARMONICS);
        self.columns(2 * harmonics, |angle, out| {
            let waves = waves(frequency * angle);
            for i in 0..harmonics {
                (out[2 * i], out[2 * i + 1]) = (waves[i][0], waves[i][1]);
            }
        })
    }

    /// Filtered ∂/∂w Σ a_i·cos(iwθ) + b_i·sin(iwθ) \[N·m·rad\], for `amplitudes` a_1, b_1, a_2, b_2 …
    pub fn cogging_slope(&self, frequency: f64, amplitudes: &[f64]) -> DVector<f64> {
        let harmonics = (amplitudes.len() / 2).min(HARMONICS);
        let column = self.columns(1, |angle, out| {
            let waves = waves(frequency * angle);
            let slope = |i: usize| {
                let ([cos, sin], [a, b]) = (waves[i], [amplitudes[2 * i], amplitudes[2 * i + 1]]);
                (i + 1) as f64 * angle * (b * cos - a * sin)
            };
            out[0] = (0..harmonics).map(slope).sum();
        });
        column.column(0).into_owned()
    }

    /// Filtered columns of a function of the angle that writes `width` values.
    fn columns(&self, width: usize, function: impl Fn(f64, &mut [f64])) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rows, width);
        let mut out = vec![0.0; width];
        let mut values = Vec::new();
        let mut first = 0;
        for piece in &self.pieces {
            for begin in (0..piece.torque.len()).step_by(CHUNK) {
                let rows = begin..piece.torque.len().min(begin + CHUNK);
                let angles = &piece.angle[self.samples(&rows)];
                // One column after the other, so that the filter reads neighbours.
                let n = angles.len();
                values.resize(n * width, 0.0);
                for (k, angle) in angles.iter().enumerate() {
                    function(*angle, &mut out);
                    for (c, value) in out.iter().enumerate() {
                        values[c * n + k] = *value;
                    }
                }
                for c in 0..width {
                    let column = &values[c * n..(c + 1) * n];
                    let mut target = matrix.view_mut((first + rows.start, c), (rows.len(), 1));
                    match self.order {
                        Order::Regressors => {
                            let filtered = self.filter.apply(column, self.stride);
                            target.iter_mut().zip(filtered).for_each(|(t, v)| *t = v);
                        }
                        Order::Signals => {
                            target.iter_mut().zip(column).for_each(|(t, v)| *t = *v);
                        }
                    }
                }
            }
            first += piece.torque.len();
        }
        for row in (0..self.rows).filter(|row| !self.counts(*row)) {
            matrix.row_mut(row).fill(0.0);
        }
        matrix
    }

    /// Tells `visit` the rows in order, each with the angles \[rad\] of its window, none for one that does not count,
    /// and their weights.
    pub fn windows(&self, mut visit: impl FnMut(usize, &[f64], &[f64])) {
        let mut first = 0;
        let taps = match self.order {
            Order::Regressors => self.filter.taps(),
            Order::Signals => &[1.0],
        };
        for piece in &self.pieces {
            for row in 0..piece.torque.len() {
                visit(
                    first + row,
                    &piece.angle[self.samples(&(row..row + 1))],
                    taps,
                );
            }
            first += piece.torque.len();
        }
    }

    /// Positions of the angles that some rows of a piece are computed from.
    fn samples(&self, rows: &Range<usize>) -> Range<usize> {
        match self.order {
            Order::Regressors => {
                let last = rows.end.saturating_sub(1) * self.stride;
                rows.start * self.stride..last + self.filter.taps().len()
            }
            Order::Signals => rows.clone(),
        }
    }
}

/// cos(i·x), sin(i·x) for i = 1 … 9, by the angle-addition theorems.
fn waves(x: f64) -> [[f64; 2]; HARMONICS] {
    let (sin, cos) = x.sin_cos();
    let mut waves = [[cos, sin]; HARMONICS];
    for i in 1..HARMONICS {
        let [c, s] = waves[i - 1];
        waves[i] = [c * cos - s * sin, s * cos + c * sin];
    }
    waves
}
