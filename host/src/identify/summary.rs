//! What an identification comes to: for people tables, for scripts JSON.

use super::{Compared, Identified, Made};
use crate::table::{aligned, quantities};
use ::identification::Fit;
use ::identification::regression::Order;
use serde::{Deserialize, Serialize};

fn unknown() -> f64 {
    f64::NAN
}

/// JSON has no word for it.
fn is_unknown(value: &f64) -> bool {
    !value.is_finite()
}

/// A parameter with its error.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct ParameterSummary {
    /// Name in the contract.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: f64,
    /// Standard error; left out where there is none, as a warning says.
    #[serde(default = "unknown", skip_serializing_if = "is_unknown")]
    pub sigma: f64,
    /// Root mean square of its share of the torque, its mean apart \[N·m\].
    pub torque_n_m: f64,
    /// Whether the measurement determines it.
    pub identifiable: bool,
}

/// A number of harmonics that was tried.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct CandidateSummary {
    /// Number of harmonics.
    pub harmonics: usize,
    /// Cogging frequency that fits best with them \[1/rad\].
    pub frequency: f64,
    /// Root mean square of what they leave unexplained in blocks that were left out \[N·m\].
    pub left_out_rms_n_m: f64,
}

/// Measures of a fit.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct FitSummary {
    /// Experiment or file.
    pub measurement: String,
    /// Rows compared.
    pub rows: usize,
    /// Root mean square of measured minus reconstructed torque \[N·m\].
    pub residual_rms_n_m: f64,
    /// Largest residual \[N·m\].
    pub residual_max_n_m: f64,
    /// Standard deviation of the measured torque \[N·m\].
    pub torque_deviation_n_m: f64,
    /// `residual_rms_n_m` by `torque_deviation_n_m`; left out where the torque does not vary, as a warning says.
    #[serde(default = "unknown", skip_serializing_if = "is_unknown")]
    pub nrmse: f64,
    /// Root mean square of angle minus reference \[rad\]; None without a reference.
    pub tracking_rms_rad: Option<f64>,
}

impl FitSummary {
    fn new(compared: &Compared, fit: Fit) -> Self {
        let errors = compared.signals.tracking_error();
        let tracking = errors
            .filter(|errors| !errors.is_empty())
            .map(|errors| (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt());
        Self {
            tracking_rms_rad: tracking,
            measurement: compared.name.clone(),
            rows: fit.rows,
            residual_rms_n_m: fit.residual,
            residual_max_n_m: fit.largest,
            torque_deviation_n_m: fit.torque,
            nrmse: fit.nrmse,
        }
    }
}

/// What to leave to the feedback.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct TubeSummary {
    /// `nmpc.angle_margin` \[rad\].
    pub angle_margin_rad: f64,
    /// `nmpc.thermal_share`.
    pub thermal_share: f64,
    /// Largest tracking error seen \[rad\].
    pub largest_error_rad: f64,
    /// Share of the feedback in the torque seen.
    pub feedback_share: f64,
}

/// An experiment on a plant.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct ExperimentSummary {
    /// Name.
    pub name: String,
    /// Least and greatest setpoint \[rad\].
    pub setpoints_rad: [f64; 2],
    /// Least and greatest angle \[rad\].
    pub angles_rad: [f64; 2],
    /// Samples whose angle was outside the range that was asked for.
    pub outside: u64,
    /// Samples outside its limits that the plant counted; None of one that does not count.
    pub violations: Option<u64>,
    /// How often it was run; all runs but the last one left the range and were stopped there.
    pub attempts: u32,
}

impl From<&Made> for ExperimentSummary {
    fn from(made: &Made) -> Self {
        Self {
            name: made.kind.name().to_owned(),
            setpoints_rad: made.setpoints,
            angles_rad: made.angles,
            outside: made.outside,
            violations: made.violations,
            attempts: made.attempts,
        }
    }
}

/// How the measurement was filtered.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct FilterSummary {
    /// Taps of the Hann window.
    pub taps: usize,
    /// `regressors` or `signals`: what it was applied to.
    pub order: String,
    /// Period of the measurement \[s\].
    pub period_s: f64,
}

/// What an identification comes to.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Summary {
    /// Every parameter.
    pub parameters: Vec<ParameterSummary>,
    /// Number of harmonics.
    pub harmonics: usize,
    /// What their number was chosen from.
    pub candidates: Vec<CandidateSummary>,
    /// Condition number of the scaled regressors.
    pub condition: f64,
    /// Angles that the measurement covers \[rad\].
    pub range_rad: [f64; 2],
    /// Whether friction holds the arm at rest: parameters then come from where it slides, and fits are judged
    /// in motion.
    pub sticks: bool,
    /// Filter.
    pub filter: FilterSummary,
    /// Fit of the measurement that the parameters come from.
    pub fit: FitSummary,
    /// Fit of another measurement.
    pub validation: Option<FitSummary>,
    /// Fit of the motion of the validation by feedback alone.
    pub feedback_alone: Option<FitSummary>,
    /// The experiments that were made, in order.
    pub experiments: Vec<ExperimentSummary>,
    /// Residual that any smooth torque over the angle would leave \[N·m\]: far below `fit` means that cogging
    /// harmonics do not describe the arm.
    pub residual_of_any_curve_n_m: f64,
    /// Margins for the planner.
    pub tube: Option<TubeSummary>,
    /// What to know before the result is used.
    pub warnings: Vec<String>,
}

impl Summary {
    /// Of an identified arm.
    pub fn new(identified: &Identified) -> Self {
        let found = &identified.identification;
        let fit = |compared: &Compared| {
            let series = &compared.series;
            let fit = if found.sticks {
                series.fit_in_motion()
            } else {
                series.fit()
            };
            FitSummary::new(compared, fit)
        };
        let mut summary = Self {
            parameters: found
                .estimates
                .iter()
                .map(|e| ParameterSummary {
                    name: e.name.clone(),
                    unit: e.unit.to_owned(),
                    value: e.value,
                    sigma: e.sigma,
                    torque_n_m: e.torque,
                    identifiable: e.identifiable,
                })
                .collect(),
            harmonics: found.harmonics,
            candidates: found
                .candidates
                .iter()
                .map(|c| CandidateSummary {
                    harmonics: c.harmonics,
                    frequency: c.frequency,
                    left_out_rms_n_m: c.score,
                })
                .collect(),
            condition: found.condition,
            range_rad: found.range,
            sticks: found.sticks,
            filter: FilterSummary {
                taps: identified.settings.taps,
                order: match identified.settings.order {
                    Order::Regressors => "regressors".to_owned(),
                    Order::Signals => "signals".to_owned(),
                },
                period_s: identified.period,
            },
            fit: fit(&identified.measurement),
            validation: identified.validation.as_ref().map(fit),
            feedback_alone: identified.feedback_alone.as_ref().map(fit),
            experiments: identified.experiments.iter().map(Into::into).collect(),
            residual_of_any_curve_n_m: found.residual_of_any_curve,
            tube: identified.tube.map(|tube| TubeSummary {
                angle_margin_rad: tube.angle_margin,
                thermal_share: tube.thermal_share,
                largest_error_rad: tube.largest_error,
                feedback_share: tube.feedback_share,
            }),
            warnings: identified.warnings.clone(),
        };
        let others = [&summary.validation, &summary.feedback_alone];
        let fits = [&summary.fit]
            .into_iter()
            .chain(others.into_iter().flatten());
        let still = fits.filter(|fit| is_unknown(&fit.nrmse)).map(|fit| {
            format!(
                "{}: no NRMSE, since the torque does not vary over the {} rows compared",
                fit.measurement, fit.rows
            )
        });
        let still: Vec<_> = still.collect();
        summary.warnings.extend(still);
        summary
    }

    /// Name, value, σ and unit of every parameter, as text.
    pub fn parameter_rows(&self) -> Vec<[String; 4]> {
        let row = |p: &ParameterSummary| {
            let [value, sigma] = with_error(p.value, p.sigma);
            [p.name.clone(), value, sigma, p.unit.clone()]
        };
        self.parameters.iter().map(row).collect()
    }

    /// Name, value and unit of every other quantity, as text.
    pub fn rows(&self) -> Vec<[String; 3]> {
        let mut rows = Vec::new();
        let mut row = |name: String, value: String, unit: &str| {
            rows.push([name, value, unit.to_owned()]);
        };
        row(
            "cogging harmonics".to_owned(),
            self.harmonics.to_string(),
            "",
        );
        row(
            "condition number".to_owned(),
            format!("{:.0}", self.condition),
            "",
        );
        let fits = [
            Some(&self.fit),
            self.feedback_alone.as_ref(),
            self.validation.as_ref(),
        ];
        for fit in fits.into_iter().flatten() {
            let name = |what: &str| format!("{}: {what}", fit.measurement);
            row(
                name("NRMSE of the torque"),
                format!("{:.3}", 100.0 * fit.nrmse),
                "%",
            );
            row(
                name("residual"),
                format!("{:.2e}", fit.residual_rms_n_m),
                "N.m",
            );
            if let Some(error) = fit.tracking_rms_rad {
                row(name("RMS tracking error"), format!("{error:.2e}"), "rad");
            }
        }
        if let Some(tube) = &self.tube {
            row(
                "nmpc.angle_margin".to_owned(),
                format!("{:.5}", tube.angle_margin_rad),
                "rad",
            );
            row(
                "nmpc.thermal_share".to_owned(),
                format!("{:.3}", tube.thermal_share),
                "1",
            );
        }
        rows
    }

    /// Both tables, aligned.
    pub fn table(&self) -> String {
        let mut parameters = aligned(["parameter", "value", "sigma", "unit"], [1, 2]);
        parameters.add_rows(self.parameter_rows());
        let rest = quantities(self.rows());
        format!("{}\n{}", parameters.trim_fmt(), rest.trim_fmt())
    }
}

/// A value with as many decimals as its error has two digits for, and the error.
fn with_error(value: f64, sigma: f64) -> [String; 2] {
    if !(sigma > 0.0 && sigma.is_finite()) {
        return [format!("{value:.6}"), format!("{sigma}")];
    }
    let decimals = (1.0 - sigma.log10().floor()).clamp(0.0, 12.0) as usize;
    [format!("{value:.decimals$}"), format!("{sigma:.decimals$}")]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_decide_the_digits() {
        for (value, sigma, text) in [
            (0.081_812_345, 0.000_012, ["0.081812", "0.000012"]),
            (9.72, 0.0213, ["9.720", "0.021"]),
            (123.4, 45.0, ["123", "45"]),
            (0.0, 0.0, ["0.000000", "0"]),
        ] {
            assert_eq!(with_error(value, sigma), text.map(str::to_owned));
        }
    }

    #[test]
    fn an_error_that_is_no_number_is_left_out() {
        let known = ParameterSummary {
            name: "arm.damping".to_owned(),
            unit: "N.m.s/rad".to_owned(),
            value: 0.5,
            sigma: 0.25,
            torque_n_m: 1.0,
            identifiable: true,
        };
        let json = serde_json::to_value(&known).unwrap();
        assert_eq!(json["sigma"], 0.25);
        let unknown = ParameterSummary {
            sigma: f64::INFINITY,
            ..known
        };
        let json = serde_json::to_value(&unknown).unwrap();
        assert_eq!(json.get("sigma"), None);
        let read: ParameterSummary = serde_json::from_value(json).unwrap();
        assert!(read.sigma.is_nan());
    }
}
