//! A stretch of samples as rows: differences, hysteresis and filter (eqs 11, 13).

use crate::Hann;
use crate::measurement::{Measurement, Segment, Timing};
use crate::regression::{LINEAR, Order};
use arm::hysteresis;

/// Move after which eq 13 has forgotten 99 % of where z started \[rad\].
pub(crate) const FORGETTING: f64 = 2.0 * hysteresis::DISPLACEMENT * 4.6;

/// Why a segment leaves no row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unused {
    /// It has fewer samples than the filter and the differences need.
    Short,
    /// It is over before z has forgotten its start and the filter is full again.
    Still,
}

/// What is left of a segment.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// Samples at the beginning that do not count, since z has not forgotten its start.
    pub(crate) waited: usize,
    /// Time of the first row \[s\].
    pub(crate) start: f64,
    /// What the cogging is computed from: every angle for [`Order::Regressors`], the filtered one of each row for
    /// [`Order::Signals`].
    pub(crate) angle: Vec<f64>,
    /// Filtered α, ω, θ, 1, z.
    pub(crate) linear: [Vec<f64>; LINEAR],
    pub(crate) torque: Vec<f64>,
}

/// The angle without delay, as it is where the filter would reach beyond its ends.
fn smoothed(angle: &[f64], filter: &Hann) -> Vec<f64> {
    let delay = filter.delay();
    let mut smooth = angle.to_vec();
    let inner = smooth.iter_mut().skip(delay);
    inner.zip(filter.apply(angle, 1)).for_each(|(s, f)| *s = f);
    smooth
}

/// z by eq 13 along the angle, from 0 on, and the sample from which on that start is forgotten.
fn dahl(angle: &[f64]) -> (Vec<f64>, usize) {
    let mut z = Vec::with_capacity(angle.len());
    let (mut state, mut travelled, mut settled) = (0.0, 0.0, angle.len());
    for (k, here) in angle.iter().enumerate() {
        let step = if k == 0 { 0.0 } else { here - angle[k - 1] };
        // Rounding in the filter is no motion.
        if step.abs() > 8.0 * f64::EPSILON * here.abs() {
            state = hysteresis::update(state, step);
        }
        travelled += step.abs();
        if travelled >= FORGETTING && settled == angle.len() {
            settled = k;
        }
        z.push(state);
    }
    (z, settled)
}

impl Piece {
    /// The rows of a segment, from where z has forgotten its start on if it is to `wait` for that.
    pub(crate) fn new(
        segment: &Segment,
        measurement: &Measurement,
        [filter, of_hysteresis]: [&Hann; 2],
        order: Order,
        stride: usize,
        wait: bool,
    ) -> Result<Self, Unused> {
        let n = segment.angle.len().min(segment.torque.len());
        if n < filter.taps().len() + 2 {
            return Err(Unused::Short);
        }
        let (angle, h) = (&segment.angle[..n], measurement.period);
        let acting: Vec<f64> = match measurement.timing {
            Timing::Held => segment.torque[..n]
                .windows(2)
                .map(|t| 0.5 * (t[0] + t[1]))
                .collect(),
            Timing::Sampled => segment.torque[1..n].to_vec(),
        };
        // All signals at samples 1 … n − 2, the first and the last of which have neighbours.
        let acceleration = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]) / (h * h);
        let velocity = |w: &[f64]| (w[2] - w[0]) / (2.0 * h);
        let difference = |of: &dyn Fn(&[f64]) -> f64| angle.windows(3).map(of).collect::<Vec<_>>();
        let inner = &angle[1..n - 1];
        let (z, settled) = match order {
            Order::Regressors => {
                let (z, settled) = dahl(&smoothed(angle, of_hysteresis));
                (z[1..n - 1].to_vec(), settled.saturating_sub(1))
            }
            Order::Signals => {
                let smooth: Vec<f64> = filter.apply(inner, 1).collect();
                dahl(&smooth)
            }
        };
        // The first row whose window holds no sample from before z forgot its start.
        let first = if wait { settled } else { 0 };
        if first >= inner.len() {
            return Err(Unused::Still);
        }
        let every = |x: &[f64]| filter.apply(&x[first..], stride).collect::<Vec<_>>();
        let torque = every(&acting[..inner.len()]);
        if torque.is_empty() {
            return Err(Unused::Still);
        }
        let theta = every(inner);
        let (hysteresis, of_cogging) = match order {
            Order::Regressors => (every(&z), inner[first..].to_vec()),
            Order::Signals => (
                z[first..].iter().copied().step_by(stride).collect(),
                theta.clone(),
            ),
        };
        Ok(Self {
            waited: first,
            start: segment.start + h * (1 + first + filter.delay()) as f64,
            linear: [
                every(&difference(&acceleration)),
                every(&difference(&velocity)),
                theta,
                vec![1.0; torque.len()],
                hysteresis,
            ],
            angle: of_cogging,
            torque,
        })
    }
}
