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

mod file;

use super::roles::{DEFAULT_ROLES, Role};
use super::{Error, Pair, Place, Side};
use crate::fmu::{Causality, Scalar};
use std::collections::BTreeMap;
use std::path::Path;

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

    /// What an input is connected to, if anything.
    pub fn source(&self, side: Side, input: Scalar) -> Option<Source> {
        let mut connections = self.connections.iter();
        let found = connections.find(|c| (c.side, c.input) == (side, input));
        found.map(|connection| connection.tap.source)
    }

    /// Whether an input is connected.
    pub fn feeds(&self, side: Side, input: Scalar) -> bool {
        self.source(side, input).is_some()
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

#[cfg(test)]
pub(super) mod tests {
    use super::super::tests::contract;
    use super::*;
    use crate::fmu::description_tests::{description, variable};
    use std::fs;

    pub(super) fn connection(from: &str, to: &str, rest: &str) -> String {
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
}
