//! The parameters by name, each with its error and what it is for.

use crate::frequency::{Mask, Projection};
use crate::regression::{LINEAR, Regression};

/// A parameter with its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Full name of the variable in the contract, such as `arm.inertia`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Standard error σ, by the estimate of Newey and West: the residual is correlated over the filter's length.
    pub sigma: f64,
    /// Root mean square of the parameter's share of the torque, its mean apart \[N·m\]: what it is for. That of all
    /// cogging for its frequency.
    pub torque: f64,
    /// Whether σ is at most a tenth of the value, or its torque at most 1 % of all torque. Never of one that is held at
    /// its bound.
    pub identifiable: bool,
}

/// Damping and hysteresis that would be below zero, where they are held, by their position among the linear terms:
/// what they would be, and σ of that.
pub(crate) type Held = [Option<[f64; 2]>; LINEAR];

/// Contract names and units of J, d, k, o and C.
pub(crate) const NAMES: [(&str, &str); LINEAR] = [
    ("arm.inertia", "kg.m2"),
    ("arm.damping", "N.m.s/rad"),
    ("arm.stiffness", "N.m/rad"),
    ("arm.offset", "N.m"),
    ("arm.hysteresis", "N.m"),
];

/// Names of at least `count` columns: the linear terms in the mask, then the harmonics.
pub(crate) fn column_names(mask: Mask, count: usize) -> Vec<String> {
    let linear = (0..LINEAR)
        .filter(|&i| mask[i])
        .map(|i| NAMES[i].0.to_owned());
    let waves = (1..=count).flat_map(|i| {
        [
            format!("arm.cogging_cos[{i}]"),
            format!("arm.cogging_sin[{i}]"),
        ]
    });
    linear.chain(waves).collect()
}

/// All parameters. `sigma` are the errors of x, and of w as last one if there are harmonics; `scale` is
/// the deviation of the torque \[N·m\].
pub(crate) fn estimates(
    regression: &Regression,
    harmonics: usize,
    projection: &Projection,
    sigma: &[f64],
    held: &Held,
    scale: f64,
) -> Vec<Estimate> {
    let (x, a) = (&projection.solution.x, &projection.a);
    let spread = |column: &[f64]| deviation(&regression.select(column));
    let of_column = |c: usize| spread(a.column(c).into_owned().as_slice());
    let estimate = |name: String, unit, value: f64, sigma: f64, weight: f64| Estimate {
        identifiable: sigma <= 0.1 * value.abs() || sigma * weight <= 0.01 * scale,
        torque: value.abs() * weight,
        name,
        unit,
        value,
        sigma,
    };
    let mut estimates = Vec::new();
    let mut position = 0;
    for (index, (name, unit)) in NAMES.into_iter().enumerate() {
        let found = if let Some([_, sigma]) = held[index] {
            Estimate {
                identifiable: false,
                ..estimate(name.to_owned(), unit, 0.0, sigma, 0.0)
            }
        } else {
            // The offset has no deviation; its torque is itself.
            let weight = if name == "arm.offset" {
                1.0
            } else {
                of_column(position)
            };
            position += 1;
            let (value, sigma) = (x[position - 1], sigma[position - 1]);
            estimate(name.to_owned(), unit, value, sigma, weight)
        };
        estimates.push(found);
    }
    if let Some(slope) = &projection.slope {
        let (name, sigma) = ("arm.cogging_frequency".to_owned(), sigma[a.ncols()]);
        let weight = spread(slope.as_slice());
        let waves = 2 * harmonics;
        let cogging = a.columns(position, waves) * x.rows(position, waves);
        estimates.push(Estimate {
            torque: spread(cogging.as_slice()),
            ..estimate(name, "1/rad", projection.frequency, sigma, weight)
        });
    }
    for (kind, shift) in [("cos", 0), ("sin", 1)] {
        for i in 0..harmonics {
            let c = position + 2 * i + shift;
            let name = format!("arm.cogging_{kind}[{}]", i + 1);
            estimates.push(estimate(name, "N.m", x[c], sigma[c], of_column(c)));
        }
    }
    estimates
}

/// Standard deviation.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}
