//! The whole identification: rows, harmonics, frequency, parameters, errors.

use crate::curve::Compressed;
use crate::estimates::{Estimate, Held, column_names, deviation, estimates};
use crate::filter::{Hann, TAPS};
use crate::frequency::{Mask, Projection, at_its_end, refine, search};
use crate::harmonics::{Candidate, choose};
use crate::least_squares::{Dependent, covariance};
use crate::measurement::Measurement;
use crate::regression::{HYSTERESIS, LINEAR, Order, Regression};
use crate::{Error, Fit, Series};
use arm::{HARMONICS, Parameters};
use std::ops::Range;

/// Set-up of an identification.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Taps of the filter (eq 11). Longer ones suppress more noise and leave less of fast motion.
    pub taps: usize,
    /// What the filter is applied to.
    pub order: Order,
    /// Taps of the filter for the angle that the hysteresis follows. None: a sixth of `taps`. Eq 13 adds up every
    /// step of the angle, those of an encoder's noise too: at 1 µrad, white, they bias C by 2 % and d by 4 % without
    /// this filter, and this filter costs a thirtieth of what that of the whole length would.
    pub hysteresis_taps: Option<usize>,
    /// Number of cogging harmonics, 0 to 9. None: by cross-validation.
    pub harmonics: Option<usize>,
    /// Where the cogging frequency is searched \[1/rad\]. None: from a quarter of a period across the range of the
    /// angle, below which waves are parabolas, up to the finest wave that the measurement shows.
    pub frequency_range: Option<[f64; 2]>,
    /// Blocks of time for the cross-validation.
    pub blocks: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            taps: TAPS,
            order: Order::default(),
            hysteresis_taps: None,
            harmonics: None,
            frequency_range: None,
            blocks: 10,
        }
    }
}

impl Settings {
    /// The filter.
    pub fn filter(&self) -> Hann {
        Hann::new(self.taps)
    }

    /// Samples from one row to the next: an eighth of the filter, whose outputs in between say nothing new, or
    /// more for measurements so long that rows abound.
    pub fn stride(&self, samples: usize) -> usize {
        const MOST_ROWS: usize = 60_000;
        (self.taps / 8).max(samples / MOST_ROWS).max(1)
    }

    /// A measurement, filtered.
    ///
    /// # Errors
    /// Too few samples for a cross-validation, or samples that are not finite.
    pub fn regression(&self, measurement: &Measurement) -> Result<Regression, Error> {
        let stride = self.stride(measurement.samples());
        let needed = self.blocks.max(2) * 4 * (LINEAR + 1);
        let taps = self.hysteresis_taps.unwrap_or(2 * (self.taps / 12) + 1);
        let of_hysteresis = Hann::new(taps);
        Regression::new(
            measurement,
            &self.filter(),
            &of_hysteresis,
            self.order,
            stride,
            needed,
        )
    }
}

/// What a measurement says about an arm.
#[derive(Clone, Debug)]
pub struct Identification {
    /// φ of eq 12.
    pub parameters: Parameters,
    /// Every parameter with its error. Those of harmonics that the arm does not have are left out.
    pub estimates: Vec<Estimate>,
    /// Number of harmonics.
    pub harmonics: usize,
    /// What the choice of their number was made from; empty if it was given.
    pub candidates: Vec<Candidate>,
    /// Condition number of the regressors, scaled to length one.
    pub condition: f64,
    /// How the parameters fit the measurement that they come from.
    pub fit: Fit,
    /// Root mean square of the residual that any smooth torque over the angle would leave \[N·m\].
    pub residual_of_any_curve: f64,
    /// Angles that the measurement covers \[rad\].
    pub range: [f64; 2],
    /// Whether friction holds the arm at rest, so that only rows in motion were used.
    pub sticks: bool,
    /// What to know before the result is used.
    pub warnings: Vec<String>,
}

/// Residual where the arm slides, with parameters from there, by that with parameters from all rows: less would be
/// no reason to leave rows out.
const GAIN: f64 = 0.5;
/// Residual at rest by that in motion, with parameters from motion alone, from which on friction holds the arm.
const STICKING: f64 = 1.2;
/// Condition number from which on motion that noise causes counts among the motion that tells parameters apart:
/// it is correlated with the noise, so that errors are no longer random. The T-flex has 1000 where its arm moves
/// through all of its range (`docs/identification.md`).
const ILL_CONDITIONED: f64 = 3000.0;

const DAMPING: usize = 1;

/// Identifies φ of eq 12.
///
/// Where friction holds the arm at rest it may take any value up to its sliding one, which eq 13 does not know:
/// if parameters from where the arm slides fit far better there, and far worse at rest, they are the ones, and a
/// warning says so.
///
/// # Errors
/// Too few or bad samples; motion from which the parameters cannot be told apart; an inertia that is not positive.
pub fn identify(measurement: &Measurement, settings: &Settings) -> Result<Identification, Error> {
    let regression = settings.regression(measurement)?;
    let mut found = identify_motion(&regression, settings)?;
    found.warnings.extend(regression.unused());
    Ok(found)
}

/// From all rows, or from those in motion.
fn identify_motion(regression: &Regression, settings: &Settings) -> Result<Identification, Error> {
    let everything = identify_rows(regression, settings)?;
    let moving = regression.clone().sliding();
    let (harmonics, w) = (
        everything.harmonics,
        everything.parameters.cogging_frequency,
    );
    let sliding = |parameters: &Parameters| {
        let residuals = Series::new(parameters, &moving).residuals();
        residuals.iter().map(|r| r * r).sum::<f64>().sqrt()
    };
    let before = sliding(&everything.parameters);
    let sticks = |parameters: &Parameters| {
        sliding(parameters) <= GAIN * before && rest_by_motion(parameters, regression) >= STICKING
    };
    // Linear parameters from motion alone are soon found and show whether more is worth while.
    let mask = [true; LINEAR];
    let first = Projection::new(&moving, mask, harmonics, w).map(|p| parameters(mask, &p));
    if !first.is_ok_and(|p| sticks(&p)) {
        return Ok(everything);
    }
    let mut in_motion = match identify_rows(&moving, settings) {
        Ok(found) if sticks(&found.parameters) => found,
        _ => return Ok(everything),
    };
    in_motion.sticks = true;
    in_motion.warnings.push(format!(
        "friction holds the arm at rest, which the hysteresis of the model does not do: only the {:.0} % of all rows \
         where it slides are used",
        100.0 * moving.counted() as f64 / moving.rows() as f64
    ));
    Ok(in_motion)
}

/// Root mean square of the residual at rest by that in motion.
fn rest_by_motion(parameters: &Parameters, regression: &Regression) -> f64 {
    let residuals = Series::new(parameters, regression).residuals();
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for (residual, moves) in residuals.iter().zip(regression.motion()) {
        sums[usize::from(moves)] += residual * residual;
        counts[usize::from(moves)] += 1.0;
    }
    if counts[0] == 0.0 || counts[1] == 0.0 {
        return 0.0;
    }
    (sums[0] / counts[0]).sqrt() / (sums[1] / counts[1]).sqrt()
}

fn identify_rows(regression: &Regression, settings: &Settings) -> Result<Identification, Error> {
    let torque = regression.torque();
    let scale = deviation(&regression.select(torque.as_slice()));
    let blocks = blocks(regression.rows(), settings.blocks.max(2));
    let everything = [true; LINEAR];
    // Before anything is searched: without enough motion all answers would be chance.
    Projection::new(regression, everything, 0, 0.0).map_err(|d| unexcited(&d, everything))?;
    let compressed = Compressed::new(regression, &blocks);
    let (search, mut warnings) = search(&compressed, settings.frequency_range, settings.harmonics)?;
    let (candidates, harmonics, start) = match settings.harmonics {
        Some(0) => (Vec::new(), 0, 0.0),
        Some(given) => {
            let given = given.min(HARMONICS);
            let start = crate::frequency::scan(&compressed, search, given);
            (Vec::new(), given, start.unwrap_or(search[0]))
        }
        None => {
            let (candidates, chosen) = choose(&compressed, search, HARMONICS, scale);
            let Candidate {
                harmonics,
                frequency,
                ..
            } = candidates[chosen];
            (candidates, harmonics, frequency)
        }
    };
    let mut mask = everything;
    let mut held = Held::default();
    let (projection, sigma) = loop {
        let projection =
            refine(regression, mask, harmonics, start, search).map_err(|d| unexcited(&d, mask))?;
        let sigma = sigma(regression, &projection);
        let Some((index, position)) = negative(mask, &projection) else {
            break (projection, sigma);
        };
        held[index] = Some([projection.solution.x[position], sigma[position]]);
        mask[index] = false;
    };
    let x = &projection.solution.x;
    if !x[0].is_finite() {
        return Err(Error::Result {
            name: "arm.inertia".to_owned(),
            value: x[0],
        });
    }
    if x[0] <= 0.0 {
        return Err(Error::Inertia {
            value: x[0],
            sigma: sigma[0],
        });
    }
    let parameters = parameters(mask, &projection);
    let estimates = estimates(regression, harmonics, &projection, &sigma, &held, scale);
    for (index, e) in estimates
        .iter()
        .enumerate()
        .filter(|(_, e)| !e.identifiable)
    {
        warnings.push(match held.get(index) {
            Some(Some([value, sigma])) => at_bound(e, *value, *sigma),
            _ => format!(
                "{} = {:.4e} {} is not identifiable from this measurement: its sigma is {:.1e}",
                e.name, e.value, e.unit, e.sigma
            ),
        });
    }
    if let (Some(_), Some(sigma)) = (settings.frequency_range, sigma.get(x.len())) {
        warnings.extend(at_its_end(search, projection.frequency, *sigma));
    }
    if projection.solution.condition > ILL_CONDITIONED {
        warnings.push(format!(
            "condition number {:.0}: some parameters, most likely stiffness, offset and the first harmonics, make up for \
             each other. Within the measured angles their torque is right, but each may be further off than its sigma \
             says; a wider range of angles tells them apart",
            projection.solution.condition
        ));
    }
    let residuals = regression.select(projection.residual.as_slice());
    let fit = Fit::of(&regression.select(torque.as_slice()), &residuals);
    let found = Identification {
        parameters,
        estimates,
        harmonics,
        candidates,
        condition: projection.solution.condition,
        fit,
        residual_of_any_curve: (compressed.residual_of_any_curve() / regression.rows() as f64)
            .sqrt(),
        range: regression.range(),
        sticks: false,
        warnings,
    };
    finite(&found).map_or(Ok(()), Err)?;
    Ok(found)
}

/// A parameter that is held at 0, by what it would be and σ of that.
fn at_bound(estimate: &Estimate, value: f64, sigma: f64) -> String {
    let Estimate { name, unit, .. } = estimate;
    let text = format!(
        "{name} is not identifiable from this measurement: it would be {value:.4e} {unit} (sigma {sigma:.1e}) and is held \
         at its bound, 0"
    );
    if value < -3.0 * sigma {
        text + "; a delay between torque and angle does this"
    } else {
        text
    }
}

/// The first result that is no number, σ apart, which may be infinite.
fn finite(found: &Identification) -> Option<Error> {
    let parameters = found.estimates.iter();
    let parameters = parameters.map(|e| (e.name.as_str(), e.value + e.torque));
    let candidates = found.candidates.iter();
    let candidates = candidates.map(|c| ("the residual of blocks that were left out", c.score));
    let others = [
        ("the condition number", found.condition),
        ("the residual", found.fit.residual),
        ("the largest residual", found.fit.largest),
        ("the deviation of the torque", found.fit.torque),
        ("the residual of any curve", found.residual_of_any_curve),
    ];
    let mut results = parameters.chain(candidates).chain(others);
    let (name, value) = results.find(|(_, value)| !value.is_finite())?;
    Some(Error::Result {
        name: name.to_owned(),
        value,
    })
}

/// Equal stretches of rows.
fn blocks(rows: usize, count: usize) -> Vec<Range<usize>> {
    let edge = |i: usize| rows * i / count;
    (0..count).map(|i| edge(i)..edge(i + 1)).collect()
}

/// A damping or hysteresis below zero, as index of the linear term and position in x.
fn negative(mask: Mask, projection: &Projection) -> Option<(usize, usize)> {
    let present = (0..LINEAR).filter(|&i| mask[i]).enumerate();
    let mut negative = present.filter(|&(position, index)| {
        [DAMPING, HYSTERESIS].contains(&index) && projection.solution.x[position] < 0.0
    });
    negative.next().map(|(position, index)| (index, position))
}

/// Lags over which the residual counts as correlated: four lengths of the filter.
fn lags(regression: &Regression) -> usize {
    (4 * regression.filter().taps().len()).div_ceil(regression.stride())
}

/// Standard errors of x, and of w as last one if there are harmonics.
fn sigma(regression: &Regression, projection: &Projection) -> Vec<f64> {
    let jacobian = projection.jacobian();
    let covariance = covariance(
        &jacobian,
        &projection.residual,
        &regression.stretches(),
        lags(regression),
    );
    let variance = |c: usize| {
        covariance
            .as_ref()
            .map_or(f64::INFINITY, |m| m[(c, c)].max(0.0))
    };
    (0..jacobian.ncols()).map(|c| variance(c).sqrt()).collect()
}

fn unexcited(dependent: &Dependent, mask: Mask) -> Error {
    let names = column_names(mask, dependent.columns.iter().max().map_or(0, |c| c + 1));
    Error::NotExcited {
        parameters: dependent
            .columns
            .iter()
            .map(|&c| names[c].clone())
            .collect(),
        condition: dependent.condition,
    }
}

fn parameters(mask: Mask, projection: &Projection) -> Parameters {
    let x = projection.solution.x.as_slice();
    let mut linear = [0.0; LINEAR];
    let present = (0..LINEAR).filter(|&i| mask[i]);
    let mut count = 0;
    for (position, index) in present.enumerate() {
        linear[index] = x[position];
        count = position + 1;
    }
    let mut cogging_cos = [0.0; HARMONICS];
    let mut cogging_sin = [0.0; HARMONICS];
    for (i, pair) in x[count..].chunks_exact(2).enumerate() {
        (cogging_cos[i], cogging_sin[i]) = (pair[0], pair[1]);
    }
    let [inertia, damping, stiffness, offset, hysteresis] = linear;
    Parameters {
        inertia,
        damping,
        stiffness,
        offset,
        hysteresis,
        cogging_frequency: projection.frequency,
        cogging_cos,
        cogging_sin,
    }
}
