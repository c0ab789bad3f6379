//! The identified arm as a parameter file (SSV) for controller and plant.

use ::identification::tube::Tube;
use arm::Parameters;
use model_description::Unit;
use model_description::ssv::{Parameter, ParameterSet, Value};

/// Units with the exponents of their base units.
const UNITS: [(&str, &[(&str, &str)]); 7] = [
    ("kg.m2", &[("kg", "1"), ("m", "2"), ("rad", "-1")]),
    (
        "N.m.s/rad",
        &[("kg", "1"), ("m", "2"), ("s", "-1"), ("rad", "-1")],
    ),
    (
        "N.m/rad",
        &[("kg", "1"), ("m", "2"), ("s", "-2"), ("rad", "-1")],
    ),
    ("N.m", &[("kg", "1"), ("m", "2"), ("s", "-2")]),
    ("1/rad", &[("rad", "-1")]),
    ("rad", &[("rad", "1")]),
    ("1", &[]),
];

/// φ under the names of the contract, the model that the feedback is designed for, and the tube if there is one.
pub fn parameter_set(arm: &Parameters, tube: Option<&Tube>, description: &str) -> ParameterSet {
    let mut values = vec![
        ("arm.inertia".to_owned(), arm.inertia, "kg.m2"),
        ("arm.damping".to_owned(), arm.damping, "N.m.s/rad"),
        ("arm.stiffness".to_owned(), arm.stiffness, "N.m/rad"),
        ("arm.offset".to_owned(), arm.offset, "N.m"),
        ("arm.hysteresis".to_owned(), arm.hysteresis, "N.m"),
        (
            "arm.cogging_frequency".to_owned(),
            arm.cogging_frequency,
            "1/rad",
        ),
    ];
    for (kind, amplitudes) in [("cos", arm.cogging_cos), ("sin", arm.cogging_sin)] {
        for (i, amplitude) in amplitudes.into_iter().enumerate() {
            values.push((format!("arm.cogging_{kind}[{}]", i + 1), amplitude, "N.m"));
        }
    }
    values.push(("feedback.inertia".to_owned(), arm.inertia, "kg.m2"));
    values.push(("feedback.damping".to_owned(), arm.damping, "N.m.s/rad"));
    if let Some(tube) = tube {
        values.push(("nmpc.angle_margin".to_owned(), tube.angle_margin, "rad"));
        values.push(("nmpc.thermal_share".to_owned(), tube.thermal_share, "1"));
    }
    let used = |unit: &str| values.iter().any(|v| v.2 == unit);
    let units = UNITS.iter().filter(|(name, _)| used(name));
    let unit = |(name, base): &(&str, &[(&str, &str)])| Unit {
        name: (*name).to_owned(),
        base: Some(
            base.iter()
                .map(|(unit, exponent)| ((*unit).to_owned(), (*exponent).to_owned()))
                .collect(),
        ),
        display_units: Vec::new(),
        line: 0,
    };
    ParameterSet {
        name: "identified".to_owned(),
        description: description.to_owned(),
        units: units.map(unit).collect(),
        parameters: values
            .into_iter()
            .map(|(name, value, unit)| Parameter {
                name,
                value: Value::Real(value),
                unit: Some(unit.to_owned()),
                line: 0,
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contract declares names and units; what is written here only follows it.
    #[test]
    fn names_and_units_are_those_of_the_contract() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../modelDescription/controller.xml"
        );
        let text = std::fs::read_to_string(file).unwrap();
        let contract = model_description::read(&text, file).unwrap();
        let tube = Tube {
            angle_margin: 0.01,
            thermal_share: 0.8,
            largest_error: 0.005,
            feedback_share: 0.1,
        };
        let set = parameter_set(&Parameters::tflex(), Some(&tube), "");
        let whole = model_description::parameters::start_values(&[contract], "all").unwrap();
        for parameter in &set.parameters {
            let declared = whole.parameters.iter().find(|p| p.name == parameter.name);
            let declared = declared.unwrap_or_else(|| panic!("no {}", parameter.name));
            assert_eq!(declared.unit, parameter.unit, "{}", parameter.name);
        }
        for unit in &set.units {
            let declared = whole.units.iter().find(|u| u.name == unit.name).unwrap();
            assert_eq!(declared.base, unit.base, "{}", unit.name);
        }
    }
}
