//! Refusal of parameter values: every inadmissible one is reported, with its contract name.

use std::fmt;

/// A parameter value that cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub struct Inadmissible {
    /// Full name of the variable in the contract, such as `arm.inertia`.
    pub name: &'static str,
    /// Value that was refused.
    pub value: f64,
    /// What would be admissible, such as `> 0` or `in [0, 1]`.
    pub admissible: String,
    /// Unit of the value and the bounds; `1` if dimensionless.
    pub unit: &'static str,
}

impl fmt::Display for Inadmissible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            value,
            admissible,
            unit,
        } = self;
        if *unit == "1" {
            write!(
                f,
                "{name} = {value} is not admissible: must be {admissible}"
            )
        } else {
            write!(
                f,
                "{name} = {value} {unit} is not admissible: must be {admissible} {unit}"
            )
        }
    }
}

impl std::error::Error for Inadmissible {}

/// Notes in `errors` that `value` lies outside `[lowest, highest]` or is not a number.
pub fn require(
    errors: &mut Vec<Inadmissible>,
    name: &'static str,
    value: f64,
    [lowest, highest]: [f64; 2],
    unit: &'static str,
) {
    if !(lowest..=highest).contains(&value) {
        errors.push(Inadmissible {
            name,
            value,
            admissible: format!("in [{lowest:?}, {highest:?}]"),
            unit,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_name_value_range_and_unit() {
        let mut errors = Vec::new();
        require(&mut errors, "arm.inertia", -1.0, [1e-9, 1e6], "kg.m2");
        require(&mut errors, "nmpc.thermal_share", 1.5, [0.0, 1.0], "1");
        require(&mut errors, "arm.damping", 0.0, [0.0, 1.0], "N.m.s/rad");
        let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
        assert_eq!(
            texts,
            [
                "arm.inertia = -1 kg.m2 is not admissible: must be in [1e-9, 1000000.0] kg.m2",
                "nmpc.thermal_share = 1.5 is not admissible: must be in [0.0, 1.0]",
            ]
        );
    }

    #[test]
    fn not_a_number_is_outside_every_range() {
        let mut errors = Vec::new();
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        require(&mut errors, "arm.offset", f64::NAN, all, "N.m");
        assert_eq!(errors.len(), 1);
    }
}
