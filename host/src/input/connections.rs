//! Which signal goes where, and which signals are scored and plotted.
//!
//! Without a file, an output of one FMU feeds the input of the other that has its name, and the setpoint feeds
//! the controller's input `setpoint`. A file for FMUs with other names, units or signs:
//!
//! ```toml
//! # to = factor * from + offset; factor is 1 and offset 0 if they are left out
//! [[connection]]
//! from = "plant.phi"                # an output, with its FMU
//! to = "controller.angle"           # an input of the other FMU
//! factor = 0.017453292519943295     # degrees to rad
//!
//! [[connection]]
//! from = "setpoint"                 # the setpoint of the run [rad]
//! to = "controller.setpoint"
//!
//! [[connection]]
//! from = "controller.torque"
//! to = "plant.tau"
//! factor = -1.0
//!
//! # what the host scores and plots, where it is not called as in the contract of flexarm's FMUs
//! [[role]]
//! name = "thermal_load"
//! from = "plant.i2t"
//! ```
//!
//! If the file has connections, they replace the default ones altogether. Roles that are not named in the
//! file fall back to the contract's names; angle and torque also follow the connections to
//! `controller.angle` and `plant.torque`.

use super::{Error, Pair, Place, Side, read_text};
use crate::fmu::{Causality, Scalar};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// The setpoint of the run.
    Setpoint,
    /// An output of an FMU.
    Output(Side, Scalar),
}

/// A value scaled: `factor * source + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Where the value comes from.
    pub source: Source,
    /// Factor.
    pub factor: f64,
    /// Offset, in the unit of the target.
    pub offset: f64,
}

impl Tap {
    /// The value as it is.
    pub fn plain(source: Source) -> Self {
        Self {
            source,
            factor: 1.0,
            offset: 0.0,
        }
    }
}

/// An input and what feeds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// What feeds it.
    pub tap: Tap,
    /// The FMU of the input.
    pub side: Side,
    /// The input.
    pub input: Scalar,
}

/// What a signal means to scoring and plotting.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq, PartialOrd, Ord)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Angle of the arm \[rad\].
    Angle,
    /// Torque asked of the motor \[N·m\].
    Torque,
    /// Thermal load \[A²\].
    ThermalLoad,
    /// Thermal load divided by its limit.
    ThermalFraction,
    /// Count of samples at which a limit was violated.
    Violations,
    /// Angle of the reference \[rad\].
    ReferenceAngle,
    /// Torque of the feedforward \[N·m\].
    FeedforwardTorque,
    /// Torque of the feedback \[N·m\].
    FeedbackTorque,
    /// How the plan in use came to be (enumeration).
    PlanStatus,
    /// Iterations of the latest plan.
    PlanIterations,
}

/// The names of the contract for each role, the first that exists counts.
const DEFAULT_ROLES: [(Role, Side, &str); 11] = [
    (Role::Angle, Side::Plant, "angle"),
    (Role::Torque, Side::Controller, "torque"),
    (Role::ThermalLoad, Side::Plant, "thermal_load"),
    (Role::ThermalLoad, Side::Controller, "thermal_load"),
    (Role::ThermalFraction, Side::Plant, "thermal_fraction"),
    (Role::Violations, Side::Plant, "violations"),
    (Role::ReferenceAngle, Side::Controller, "reference.angle"),
    (
        Role::FeedforwardTorque,
        Side::Controller,
        "feedforward_torque",
    ),
    (Role::FeedbackTorque, Side::Controller, "feedback_torque"),
    (Role::PlanStatus, Side::Controller, "nmpc.status"),
    (Role::PlanIterations, Side::Controller, "nmpc.iterations"),
];

/// What may feed an input or play a role.
const SOURCES: &[Causality] = &[Causality::Output, Causality::Local];

/// All connections and roles of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Wiring {
    /// Inputs and what feeds them.
    pub connections: Vec<Connection>,
    /// The roles that are played.
    pub roles: BTreeMap<Role, Tap>,
    /// What looks wrong but may be meant: connected signals of different units.
    pub warnings: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    connection: Vec<ConnectionEntry>,
    #[serde(default)]
    role: Vec<RoleEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConnectionEntry {
    from: Spanned<String>,
    to: Spanned<String>,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    offset: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoleEntry {
    name: Spanned<Role>,
    from: Spanned<String>,
    #[serde(default = "one")]
    factor: f64,
    #[serde(default)]
    offset: f64,
}

fn one() -> f64 {
    1.0
}

impl Wiring {
    /// Reads a file, or makes the default wiring.
    pub fn read(pair: Pair<'_>, file: Option<&Path>) -> Result<Self, Error> {
        let mut wiring = Self {
            connections: Vec::new(),
            roles: BTreeMap::new(),
            warnings: Vec::new(),
        };
        if let Some(path) = file {
            wiring.add_file(pair, path)?;
        }
        if wiring.connections.is_empty() {
            wiring.connect_by_name(pair)?;
        }
        wiring.add_default_roles(pair);
        wiring.check_units(pair);
        Ok(wiring)
    }

    fn add_file(&mut self, pair: Pair<'_>, path: &Path) -> Result<(), Error> {
        let text = read_text(path)?;
        let place = |offset: usize| {
            let lines = text[..offset.min(text.len())].matches('\n').count();
            Place::in_file(path, lines as u64 + 1)
        };
        let file: File = toml::from_str(&text).map_err(|error| Error::Syntax {
            place: place(error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        for entry in &file.connection {
            let from = place(entry.from.span().start);
            let to = place(entry.to.span().start);
            let tap = tap(
                pair,
                &from,
                entry.from.get_ref(),
                entry.factor,
                entry.offset,
            )?;
            let (side, input) = pair.resolve(&to, entry.to.get_ref(), &[Causality::Input])?;
            if matches!(tap.source, Source::Output(of, _) if of == side) {
                return Err(Error::SameFmu {
                    place: to,
                    from: entry.from.get_ref().clone(),
                    to: entry.to.get_ref().clone(),
                });
            }
            if self.feeds(side, input) {
                return Err(Error::TwoSources {
                    place: to,
                    name: pair.name(side, input),
                });
            }
            self.connections.push(Connection { tap, side, input });
        }
        for entry in &file.role {
            let from = place(entry.from.span().start);
            let tap = tap(
                pair,
                &from,
                entry.from.get_ref(),
                entry.factor,
                entry.offset,
            )?;
            if self.roles.insert(*entry.name.get_ref(), tap).is_some() {
                return Err(Error::TwoSources {
                    place: place(entry.name.span().start),
                    name: format!("the role of {}", entry.from.get_ref()),
                });
            }
        }
        Ok(())
    }

    /// Whether an input is connected.
    pub fn feeds(&self, side: Side, input: Scalar) -> bool {
        self.connections
            .iter()
            .any(|c| (c.side, c.input) == (side, input))
    }

    fn connect_by_name(&mut self, pair: Pair<'_>) -> Result<(), Error> {
        for (side, other) in [
            (Side::Controller, Side::Plant),
            (Side::Plant, Side::Controller),
        ] {
            for input in pair.of(side).numeric_scalars(Causality::Input) {
                let name = &pair.of(side).variable(input).name;
                let output = pair.of(other).scalar(name).ok().filter(|&output| {
                    let variable = pair.of(other).variable(output);
                    variable.causality == Causality::Output && variable.kind.is_numeric()
                });
                let source = match output {
                    Some(output) => Source::Output(other, output),
                    None if side == Side::Controller && name == "setpoint" => Source::Setpoint,
                    None => continue,
                };
                let tap = Tap::plain(source);
                self.connections.push(Connection { tap, side, input });
            }
        }
        if self
            .connections
            .iter()
            .any(|c| c.tap.source != Source::Setpoint)
        {
            return Ok(());
        }
        let names = |side: Side| {
            [Causality::Input, Causality::Output].map(|c| {
                pair.of(side)
                    .names(c)
                    .into_iter()
                    .map(str::to_owned)
                    .collect()
            })
        };
        Err(Error::NothingToConnect {
            controller: names(Side::Controller),
            plant: names(Side::Plant),
        })
    }

    fn add_default_roles(&mut self, pair: Pair<'_>) {
        for (role, side, name) in DEFAULT_ROLES {
            if let Ok(scalar) = pair.scalar(&Place::new("", None), side, name, SOURCES) {
                self.roles
                    .entry(role)
                    .or_insert(Tap::plain(Source::Output(side, scalar)));
            }
        }
        for (role, side, name) in [
            (Role::Angle, Side::Controller, "angle"),
            (Role::Torque, Side::Plant, "torque"),
        ] {
            let input = pair.of(side).scalar(name).ok();
            let feeding = self
                .connections
                .iter()
                .find(|c| c.side == side && Some(c.input) == input);
            if let Some(connection) = feeding {
                self.roles.entry(role).or_insert(connection.tap);
            }
        }
    }

    fn check_units(&mut self, pair: Pair<'_>) {
        for connection in &self.connections {
            let Tap {
                source: Source::Output(side, output),
                factor: 1.0,
                offset: 0.0,
            } = connection.tap
            else {
                continue;
            };
            let from = &pair.of(side).variable(output).unit;
            let to = &pair.of(connection.side).variable(connection.input).unit;
            if let (Some(from), Some(to)) = (from, to)
                && from != to
            {
                self.warnings.push(format!(
                    "{} in {from} feeds {} in {to} without a factor",
                    pair.name(side, output),
                    pair.name(connection.side, connection.input),
                ));
            }
        }
    }
}

fn tap(pair: Pair<'_>, place: &Place, name: &str, factor: f64, offset: f64) -> Result<Tap, Error> {
    let wrong = |key, value| Error::Factor {
        place: place.clone(),
        key,
        value,
    };
    if !factor.is_finite() || factor == 0.0 {
        return Err(wrong("factor", factor));
    }
    if !offset.is_finite() {
        return Err(wrong("offset", offset));
    }
    let source = if name == "setpoint" {
        Source::Setpoint
    } else {
        let (side, scalar) = pair.resolve(place, name, SOURCES)?;
        Source::Output(side, scalar)
    };
    Ok(Tap {
        source,
        factor,
        offset,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::contract;
    use super::*;
    use crate::fmu::description_tests::{description, variable};
    use std::fs;

    fn read(text: &str) -> Result<Wiring, String> {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("M.toml");
        fs::write(&file, text).unwrap();
        let message = |e: Error| {
            e.to_string()
                .replace(&format!("{}/", folder.path().display()), "")
        };
        Wiring::read(pair, Some(&file)).map_err(message)
    }

    fn connection(from: &str, to: &str, rest: &str) -> String {
        format!("[[connection]]\nfrom = \"{from}\"\nto = \"{to}\"\n{rest}\n")
    }

    #[test]
    fn the_contract_is_connected_by_name() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let wiring = Wiring::read(pair, None).unwrap();
        let names: Vec<_> = wiring
            .connections
            .iter()
            .map(|c| {
                let from = match c.tap.source {
                    Source::Setpoint => "setpoint".to_owned(),
                    Source::Output(side, scalar) => pair.name(side, scalar),
                };
                format!("{from} > {}", pair.name(c.side, c.input))
            })
            .collect();
        assert_eq!(
            names,
            [
                "plant.angle > controller.angle",
                "setpoint > controller.setpoint",
                "controller.torque > plant.torque",
            ]
        );
        assert_eq!(wiring.roles.len(), 10);
        assert!(wiring.warnings.is_empty());
    }

    #[test]
    fn a_file_renames_scales_and_assigns_roles() {
        let mut phi = variable("phi", Causality::Output);
        phi.unit = Some("deg".into());
        let plant = description(vec![phi, variable("tau", Causality::Input)]);
        let controller = contract("controller");
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let Err(Error::NothingToConnect {
            plant: [inputs, _], ..
        }) = Wiring::read(pair, None)
        else {
            panic!()
        };
        assert_eq!(inputs, ["tau"]);
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("M.toml");
        let text = connection(
            "plant.phi",
            "controller.angle",
            "factor = 0.5\noffset = 0.1",
        ) + &connection("controller.torque", "plant.tau", "factor = -1.0");
        fs::write(&file, &text).unwrap();
        let wiring = Wiring::read(pair, Some(&file)).unwrap();
        assert_eq!(wiring.connections.len(), 2);
        let angle = wiring.roles[&Role::Angle];
        assert_eq!((angle.factor, angle.offset), (0.5, 0.1));
        assert!(!wiring.roles.contains_key(&Role::Violations));
        fs::write(&file, text.replace("factor = 0.5\noffset = 0.1", "")).unwrap();
        let warnings = Wiring::read(pair, Some(&file)).unwrap().warnings;
        assert_eq!(
            warnings,
            ["plant.phi in deg feeds controller.angle in rad without a factor"]
        );
    }

    #[test]
    fn mistakes_are_named() {
        let good = connection("plant.angle", "controller.angle", "");
        for (text, message) in [
            (
                "[[connection]]\nfrom = \"plant.angle\"\n".to_owned(),
                "M.toml:1: missing field `to`",
            ),
            (
                "[[conection]]\n".to_owned(),
                "M.toml:1: unknown field `conection`",
            ),
            (
                connection("plant.angel", "controller.angle", ""),
                "M.toml:2: plant has no variable angel, did you mean angle?",
            ),
            (
                connection("plant.angle", "controller.torque", ""),
                "M.toml:3: controller.torque is an output; possible here: angle, setpoint",
            ),
            (
                connection("angle", "controller.angle", ""),
                "M.toml:2: \"angle\" must say whose it is",
            ),
            (
                connection("plant.angle", "plant.torque", ""),
                "M.toml:3: plant.angle and plant.torque belong to the same FMU",
            ),
            (
                connection("plant.angle", "controller.angle", "factor = 0.0"),
                "M.toml:2: factor = 0: must be a finite number",
            ),
            (
                good.clone() + &good,
                "M.toml:7: controller.angle already has a source",
            ),
            (
                "[[role]]\nname = \"angel\"\nfrom = \"plant.angle\"".to_owned(),
                "M.toml:2: unknown variant `angel`",
            ),
        ] {
            let found = read(&text).unwrap_err();
            assert!(found.starts_with(message), "{found}");
        }
    }
}
