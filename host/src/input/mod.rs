//! What the user gives: parameter files, setpoints, connections. Every message names file, line, key and value.

pub mod connections;
mod error;
pub mod measurement;
pub mod parameters;
mod place;
pub mod roles;
pub(crate) mod rows;
pub mod setpoints;

pub use error::Error;
pub use place::Place;

use crate::fmu::{Causality, Description, Fmu, Kind, NameError, Scalar};
use std::fmt;
use std::path::Path;

/// One of the two FMUs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The controller.
    Controller,
    /// The plant.
    Plant,
}

impl Side {
    /// Both, in the order in which they step.
    pub const BOTH: [Self; 2] = [Self::Controller, Self::Plant];
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Controller => "controller",
            Self::Plant => "plant",
        })
    }
}

/// The descriptions of both FMUs.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Of the controller.
    pub controller: &'a Description,
    /// Of the plant.
    pub plant: &'a Description,
}

impl<'a> Pair<'a> {
    /// Of these FMUs.
    pub fn new(controller: &'a Fmu, plant: &'a Fmu) -> Self {
        Self {
            controller: controller.description(),
            plant: plant.description(),
        }
    }

    /// Of one of them.
    pub fn of(&self, side: Side) -> &'a Description {
        match side {
            Side::Controller => self.controller,
            Side::Plant => self.plant,
        }
    }

    /// Name of a scalar with its side, like `plant.angle`.
    pub fn name(&self, side: Side, scalar: Scalar) -> String {
        format!("{side}.{}", self.of(side).name_of(scalar))
    }

    /// The numeric scalar called `controller.…` or `plant.…`, whose role must be one of `roles`.
    fn resolve(
        &self,
        place: &Place,
        name: &str,
        roles: &[Causality],
    ) -> Result<(Side, Scalar), Error> {
        let (side, bare) = if let Some(bare) = name.strip_prefix("controller.") {
            (Side::Controller, bare)
        } else if let Some(bare) = name.strip_prefix("plant.") {
            (Side::Plant, bare)
        } else {
            return Err(Error::Side {
                place: place.clone(),
                name: name.to_owned(),
            });
        };
        self.scalar(place, side, bare, roles)
            .map(|scalar| (side, scalar))
    }

    fn scalar(
        &self,
        place: &Place,
        side: Side,
        name: &str,
        roles: &[Causality],
    ) -> Result<Scalar, Error> {
        let description = self.of(side);
        let existing = || {
            let names = roles.iter().flat_map(|&role| description.names(role));
            names.map(str::to_owned).collect()
        };
        let scalar = description.scalar(name).map_err(|error| match error {
            NameError::Unknown { similar } => Error::Unknown {
                place: place.clone(),
                owner: Some(side),
                name: name.to_owned(),
                similar,
                existing: existing(),
            },
            NameError::Array { first, last } => Error::Array {
                place: place.clone(),
                name: name.to_owned(),
                first,
                last,
            },
        })?;
        let variable = description.variable(scalar);
        if !roles.contains(&variable.causality) || !variable.kind.is_numeric() {
            return Err(Error::Role {
                place: place.clone(),
                name: format!("{side}.{name}"),
                found: match variable.kind {
                    Kind::String | Kind::Binary | Kind::Clock => {
                        format!("of type {}", variable.kind)
                    }
                    _ => with_article(variable.causality),
                },
                existing: existing(),
            });
        }
        Ok(scalar)
    }
}

/// Like "an input".
fn with_article(causality: Causality) -> String {
    let article = match causality {
        Causality::Independent | Causality::Input | Causality::Output => "an",
        _ => "a",
    };
    format!("{article} {causality}")
}

/// Text of a file that the user named, without a byte order mark.
pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Read {
        file: path.to_owned(),
        source,
    })?;
    let text = String::from_utf8(bytes).map_err(|_| Error::NotText {
        file: path.to_owned(),
    })?;
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::fmu::describe;

    /// The project's own contract of a unit.
    pub(crate) fn contract(unit: &str) -> Description {
        let path = format!(
            "{}/../modelDescription/{unit}.xml",
            env!("CARGO_MANIFEST_DIR")
        );
        describe(Path::new("test.fmu"), Path::new(&path)).unwrap()
    }

    #[test]
    fn names_are_resolved_with_their_side() {
        let (controller, plant) = (contract("controller"), contract("plant"));
        let pair = Pair {
            controller: &controller,
            plant: &plant,
        };
        let place = Place::new("M.toml", Some(3));
        let resolve = |name, role| {
            pair.resolve(&place, name, &[role])
                .map_err(|e| e.to_string())
        };
        let (side, angle) = resolve("plant.angle", Causality::Output).unwrap();
        assert_eq!(pair.name(side, angle), "plant.angle");
        assert_eq!(
            resolve("plant.angel", Causality::Output).unwrap_err(),
            "M.toml:3: plant has no variable angel, did you mean angle?; there are: angle, velocity, current, thermal_load, thermal_fraction, violations"
        );
        assert_eq!(
            resolve("plant.angle", Causality::Input).unwrap_err(),
            "M.toml:3: plant.angle is an output; possible here: torque, disturbance_torque"
        );
        assert!(
            resolve("angle", Causality::Output)
                .unwrap_err()
                .contains("controller.angle or plant.angle")
        );
        assert!(
            resolve("plant.arm.cogging_cos", Causality::Parameter)
                .unwrap_err()
                .contains("arm.cogging_cos[9]")
        );
    }
}
