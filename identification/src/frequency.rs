//! The cogging frequency w, the one parameter that eq 12 is not linear in.
//!
//! For each w the other parameters are a linear least-squares problem, so that the sum of squares is a function
//! of w alone (variable projection: Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). Its slope is −2·rᵀ·d with
//! the residual r and d = ∂(A·x)/∂w, x held. A scan over the compressed measurement finds the valley, Gauss–Newton
//! steps on all rows its bottom.

use crate::Error;
use crate::curve::Compressed;
use crate::least_squares::{Dependent, Solution, Triangle};
use crate::regression::{LINEAR, Regression};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::FRAC_PI_2;

/// Step of the scan: phase of the highest wave at the ends of the range \[rad\].
const PHASE: f64 = 0.4;
/// Valleys of the scan that are looked into.
const VALLEYS: usize = 5;
/// Steps of the search by golden section in a valley.
const SECTIONS: usize = 24;
/// Gauss–Newton steps.
const STEPS: usize = 30;

/// The w within `range` \[1/rad\] at which this many harmonics fit best. None: no wave within the range is fine
/// enough for the measurement.
pub(crate) fn scan(compressed: &Compressed, range: [f64; 2], harmonics: usize) -> Option<f64> {
    let highest = range[1].min(compressed.finest() / harmonics as f64);
    if highest.is_nan() || range[0] >= highest {
        return None;
    }
    let step = PHASE / (0.5 * harmonics as f64 * compressed.span());
    let count = ((highest - range[0]) / step).ceil().max(2.0) as usize;
    let step = (highest - range[0]) / count as f64;
    let at = |i: usize| range[0] + step * i as f64;
    let misfit = |w: f64| compressed.residual(w, harmonics);
    let scanned: Vec<f64> = (0..=count).map(|i| misfit(at(i))).collect();
    let neighbour = |i: Option<usize>| i.and_then(|i| scanned.get(i)).copied();
    let mut valleys: Vec<usize> = (0..=count)
        .filter(|&i| {
            let beside = [neighbour(i.checked_sub(1)), neighbour(Some(i + 1))];
            beside.into_iter().flatten().all(|b| scanned[i] <= b)
        })
        .collect();
    valleys.sort_by(|a, b| scanned[*a].total_cmp(&scanned[*b]));
    let bottoms = valleys.iter().take(VALLEYS).map(|&i| {
        let bracket = [at(i.saturating_sub(1)), at((i + 1).min(count))];
        golden_section(&misfit, bracket)
    });
    bottoms
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(frequency, _)| frequency)
}

/// Where w is searched \[1/rad\]: `given`, as far as the measurement shows waves that fine, or else all that it shows;
/// and what to know of that. The number of `harmonics`, if it is given, all have to be fine enough.
///
/// # Errors
/// Nothing that is given can be searched.
pub(crate) fn search(
    compressed: &Compressed,
    given: Option<[f64; 2]>,
    harmonics: Option<usize>,
) -> Result<([f64; 2], Vec<String>), Error> {
    let span = compressed.span();
    let harmonics = harmonics.unwrap_or(1).max(1);
    let coarsest = FRAC_PI_2 / span;
    let Some([low, high]) = given else {
        return Ok(([coarsest, compressed.finest()], Vec::new()));
    };
    let finest = compressed.finest() / harmonics as f64;
    if low >= finest {
        return Err(Error::FrequencyRange {
            given: [low, high],
            finest,
            span,
            harmonics,
        });
    }
    let mut warnings = Vec::new();
    if high > finest {
        warnings.push(format!(
            "cogging frequencies are searched up to {finest:.4} 1/rad instead of {high} 1/rad: angles over {span:.4} rad show \
             none that are finer"
        ));
    }
    if low < coarsest {
        warnings.push(format!(
            "cogging frequencies are searched from {low} 1/rad on, but below {coarsest:.4} 1/rad angles over {span:.4} rad show \
             less than a quarter of a period, which stiffness and offset explain as well"
        ));
    }
    Ok(([low, high.min(finest)], warnings))
}

/// What to know of a w \[1/rad\] that was searched within a range that was given.
pub(crate) fn at_its_end([low, high]: [f64; 2], frequency: f64, sigma: f64) -> Option<String> {
    let end = [low, high]
        .iter()
        .any(|end| (frequency - end).abs() <= 1e-6 * end);
    let name = format!("arm.cogging_frequency = {frequency:.6} 1/rad");
    if high - low < sigma {
        Some(format!(
            "{name} is what was given rather than measured: the range from {low} to {high} 1/rad is narrower than its \
             sigma, {sigma:.1e} 1/rad"
        ))
    } else if end {
        Some(format!(
            "{name} is an end of the range that was searched, {low} to {high} 1/rad: the best value may lie outside"
        ))
    } else {
        None
    }
}

/// Least value of a function within a bracket, and where it is.
fn golden_section(f: &dyn Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    let inner = |low: f64, high: f64| [high - RATIO * (high - low), low + RATIO * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let [mut fa, mut fb] = [f(a), f(b)];
    for _ in 0..SECTIONS {
        if fa <= fb {
            (high, b, fb) = (b, a, fa);
            a = inner(low, high)[0];
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = inner(low, high)[1];
            fb = f(b);
        }
    }
    if fa <= fb { (a, fa) } else { (b, fb) }
}

/// Which of the five linear terms take part.
pub(crate) type Mask = [bool; LINEAR];

/// The fit at one w.
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    pub(crate) frequency: f64,
    /// Regressors, rows × (linear terms in the mask + 2·harmonics).
    pub(crate) a: DMatrix<f64>,
    /// Least squares at this w.
    pub(crate) solution: Solution,
    /// b − A·x \[N·m\].
    pub(crate) residual: DVector<f64>,
    /// ∂(A·x)/∂w with x held; without harmonics None.
    pub(crate) slope: Option<DVector<f64>>,
}

impl Projection {
    /// # Errors
    /// Columns that depend on each other.
    pub(crate) fn new(
        regression: &Regression,
        mask: Mask,
        harmonics: usize,
        frequency: f64,
    ) -> Result<Self, Dependent> {
        let linear: Vec<usize> = (0..LINEAR).filter(|&i| mask[i]).collect();
        let (rows, columns) = (regression.rows(), linear.len() + 2 * harmonics);
        let mut all = DMatrix::zeros(rows, columns + 1);
        for (c, &i) in linear.iter().enumerate() {
            all.set_column(c, &DVector::from_vec(regression.linear(i)));
        }
        if harmonics > 0 {
            all.columns_mut(linear.len(), 2 * harmonics)
                .copy_from(&regression.cogging(frequency, harmonics));
        }
        let b = regression.torque();
        all.set_column(columns, &b);
        let solution = Triangle::of(&all).solve()?;
        let a = all.remove_column(columns);
        let residual = b - &a * &solution.x;
        let amplitudes = &solution.x.as_slice()[linear.len()..];
        let slope = (harmonics > 0).then(|| regression.cogging_slope(frequency, amplitudes));
        Ok(Self {
            frequency,
            a,
            solution,
            residual,
            slope,
        })
    }

    /// A with the slope as last column, if there is one.
    pub(crate) fn jacobian(&self) -> DMatrix<f64> {
        let mut all = self.a.clone();
        if let Some(slope) = &self.slope {
            all = all.insert_column(self.a.ncols(), 0.0);
            all.set_column(self.a.ncols(), slope);
        }
        all
    }

    /// Slope of the sum of squares over w, the other parameters following \[(N·m)²·rad\].
    #[cfg(test)]
    fn gradient(&self) -> f64 {
        -2.0 * self.slope.as_ref().map_or(0.0, |d| d.dot(&self.residual))
    }

    /// Change of w by which the linearised problem is solved.
    fn step(&self) -> Option<f64> {
        let columns = self.a.ncols() + 1;
        let mut all = self.jacobian().insert_column(columns, 0.0);
        all.set_column(columns, &self.residual);
        let solution = Triangle::of(&all).solve().ok()?;
        Some(solution.x[columns - 1])
    }
}

/// The fit at the best w near `start` and within `range` \[1/rad\], by Gauss–Newton steps that are halved until the sum of squares falls.
///
/// # Errors
/// Columns that depend on each other.
pub(crate) fn refine(
    regression: &Regression,
    mask: Mask,
    harmonics: usize,
    start: f64,
    range: [f64; 2],
) -> Result<Projection, Dependent> {
    let mut best = Projection::new(regression, mask, harmonics, start)?;
    if harmonics == 0 {
        return Ok(best);
    }
    'steps: for _ in 0..STEPS {
        let Some(full) = best.step() else { break };
        let mut step = full.clamp(-0.1 * best.frequency, 0.1 * best.frequency);
        while step.abs() > 1e-8 * best.frequency {
            let to = (best.frequency + step).clamp(range[0], range[1]);
            let next = Projection::new(regression, mask, harmonics, to)?;
            if next.solution.residual < best.solution.residual {
                best = next;
                continue 'steps;
            }
            step *= 0.5;
        }
        break;
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Measurement, Settings};
    use proptest::prelude::*;

    /// Rows whose torque has two harmonics at 9 1/rad.
    fn regression() -> Regression {
        let angle: Vec<f64> = (0..12_000)
            .map(|k| {
                let t = f64::from(k) * 2.5e-4;
                0.4 * (6.0 * t).sin() + 0.2 * (15.1 * t).sin()
            })
            .collect();
        let torque = angle
            .iter()
            .enumerate()
            .map(|(k, a)| {
                let noise = 1e-3 * f64::from(k as u32 * 7919 % 101) / 50.0;
                a + 0.3 * (9.0 * a).cos() - 0.2 * (18.0 * a).sin() + noise
            })
            .collect();
        let measurement = Measurement::new(2.5e-4, angle, torque);
        Settings::default().regression(&measurement).unwrap()
    }

    const ALL: Mask = [true; LINEAR];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20))]

        /// The slope of the projected sum of squares against central differences.
        #[test]
        fn the_gradient_is_that_of_finite_differences(frequency in 6.0..12.0_f64, harmonics in 1..4_usize) {
            let regression = regression();
            let at = |w: f64| Projection::new(&regression, ALL, harmonics, w).unwrap();
            let h = 1e-4;
            let difference =
                (at(frequency + h).solution.residual - at(frequency - h).solution.residual) / (2.0 * h);
            let gradient = at(frequency).gradient();
            prop_assert!(
                (gradient - difference).abs() < 1e-4 * difference.abs() + 1e-6,
                "{gradient} {difference}"
            );
        }
    }

    #[test]
    fn refinement_ends_where_the_gradient_vanishes() {
        let regression = regression();
        let start = Projection::new(&regression, ALL, 2, 8.7).unwrap();
        let end = refine(&regression, ALL, 2, 8.7, [1.0, 20.0]).unwrap();
        assert!((end.frequency - 9.0).abs() < 0.02, "{}", end.frequency);
        assert!(end.gradient().abs() < 1e-4 * start.gradient().abs());
    }

    #[test]
    fn sections_find_a_minimum() {
        let (place, value) = golden_section(&|x| (x - 0.3).powi(2) + 2.0, [-1.0, 2.0]);
        assert!((place - 0.3).abs() < 1e-4 && (value - 2.0).abs() < 1e-8);
    }
}
