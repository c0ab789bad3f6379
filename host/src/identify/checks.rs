//! What experiments on a plant are refused for before the first one.

use super::experiment::Experiment;
use crate::input::connections::{Connection, Source, Wiring};
use crate::input::parameters::StartValues;
use crate::input::roles::Role;
use crate::input::setpoints::AngleLimits;
use crate::input::{self, Pair, Side};
use crate::run::angle_limits;

pub(super) const NO_ANGLE: &str = "no signal plays the role of the angle";
pub(super) const NO_TORQUE: &str = "no signal plays the role of the torque";

pub(super) fn purposeless(missing: &'static str) -> input::Error {
    input::Error::Purposeless {
        file: "--connections".to_owned(),
        missing,
        swapped: false,
    }
}

/// Whether experiments can move the plant and see what comes of it: found out before the first one.
pub(super) fn complete(wiring: &Wiring) -> Result<(), input::Error> {
    for (role, missing) in [(Role::Angle, NO_ANGLE), (Role::Torque, NO_TORQUE)] {
        if !wiring.roles.contains_key(&role) {
            return Err(purposeless(missing));
        }
    }
    let feeds = |side: Side, source: Side| {
        let mut connections = wiring.connections.iter().filter(|c| c.side == side);
        connections.any(|c| matches!(c.tap.source, Source::Output(of, _) if of == source))
    };
    let setpoint = |c: &Connection| c.tap.source == Source::Setpoint;
    if !feeds(Side::Plant, Side::Controller) {
        Err(purposeless("no output of the controller feeds the plant"))
    } else if !feeds(Side::Controller, Side::Plant) {
        Err(purposeless("no output of the plant feeds the controller"))
    } else if !wiring.connections.iter().any(setpoint) {
        Err(purposeless("the setpoint is connected to no input"))
    } else {
        Ok(())
    }
}

/// Where the angle stays: between what the user gives, which lies within the limits of the plant, and else these.
pub(super) fn range(
    experiment: &Experiment,
    pair: Pair<'_>,
    values: &StartValues,
) -> Result<AngleLimits, input::Error> {
    let setting = |name: &str, value: Option<f64>, expected: String| input::Error::Setting {
        name: name.to_owned(),
        value: value.map_or("nothing".to_owned(), |value| value.to_string()),
        expected,
    };
    let limits = match pair.plant.scalar("limits.angle_lower") {
        Ok(_) => angle_limits(pair, values),
        Err(_) => None,
    };
    let end = |name: &str, given: Option<f64>, limit: Option<f64>| {
        let Some(value) = given.or(limit) else {
            let expected = "an angle in rad: the plant has no limits.angle_lower and .angle_upper";
            return Err(setting(name, None, expected.to_owned()));
        };
        if !value.is_finite() {
            return Err(setting(name, given, "a finite angle in rad".to_owned()));
        }
        match limits {
            Some(limits) if !limits.contains(value) => {
                let AngleLimits { lower, upper } = limits;
                let expected =
                    format!("an angle in [{lower}, {upper}] rad, the limits of the plant");
                Err(setting(name, Some(value), expected))
            }
            _ => Ok(value),
        }
    };
    let lower = end("--lower", experiment.lower, limits.map(|l| l.lower))?;
    let upper = end("--upper", experiment.upper, limits.map(|l| l.upper))?;
    ordered(lower, upper)
}

/// A range from its ends \[rad\].
pub(super) fn ordered(lower: f64, upper: f64) -> Result<AngleLimits, input::Error> {
    if lower < upper {
        return Ok(AngleLimits { lower, upper });
    }
    Err(input::Error::Setting {
        name: "--upper".to_owned(),
        value: upper.to_string(),
        expected: format!("an angle in rad above --lower = {lower}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::tests::contract;

    #[test]
    fn a_wiring_that_moves_nothing_is_refused() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let whole = Wiring::read(pair, None).unwrap();
        assert!(complete(&whole).is_ok());
        let without = |take: &dyn Fn(&mut Wiring)| {
            let mut wiring = whole.clone();
            take(&mut wiring);
            complete(&wiring).unwrap_err().to_string()
        };
        for (role, name) in [(Role::Angle, "angle"), (Role::Torque, "torque")] {
            let message = without(&|wiring| {
                let _ = wiring.roles.remove(&role);
            });
            let expected = format!("--connections: no signal plays the role of the {name}");
            assert!(message.starts_with(&expected), "{message}");
        }
        let message = without(&|wiring| wiring.connections.retain(|c| c.side != Side::Plant));
        assert!(message.contains("no output of the controller feeds the plant"));
        let message = without(&|wiring| wiring.connections.retain(|c| c.side == Side::Plant));
        assert!(message.contains("no output of the plant feeds the controller"));
        let message = without(&|w| w.connections.retain(|c| c.tap.source != Source::Setpoint));
        assert!(message.contains("the setpoint is connected to no input"));
    }
}
