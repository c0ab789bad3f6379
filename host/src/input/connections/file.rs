//! Reads connections and roles from a TOML file, with the line of every mistake.

use super::super::roles::Role;
use super::super::{Error, Pair, Place, read_text};
use super::{Connection, SOURCES, Source, Tap, Wiring};
use crate::fmu::Causality;
use serde::Deserialize;
use std::path::Path;
use toml::Spanned;

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
    factor: Option<Spanned<f64>>,
    offset: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoleEntry {
    name: Spanned<Role>,
    from: Spanned<String>,
    factor: Option<Spanned<f64>>,
    offset: Option<Spanned<f64>>,
}

impl Wiring {
    pub(super) fn add_file(&mut self, pair: Pair<'_>, path: &Path) -> Result<(), Error> {
        let text = read_text(path)?;
        let line = |offset: usize| {
            let lines = text[..offset.min(text.len())].matches('\n').count();
            Place::in_file(path, lines as u64 + 1)
        };
        let file: File = toml::from_str(&text).map_err(|error| Error::Syntax {
            place: line(error.span().map_or(0, |span| span.start)),
            message: error.message().to_owned(),
        })?;
        for entry in &file.connection {
            let place = |offset: usize, key: &str| line(offset).at_key(format!("connection.{key}"));
            let tap = tap(pair, &place, &entry.from, &entry.factor, &entry.offset)?;
            let to = place(entry.to.span().start, "to");
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
            let place = |offset: usize, key: &str| line(offset).at_key(format!("role.{key}"));
            let tap = tap(pair, &place, &entry.from, &entry.factor, &entry.offset)?;
            if self.roles.insert(*entry.name.get_ref(), tap).is_some() {
                return Err(Error::TwoSources {
                    place: place(entry.name.span().start, "name"),
                    name: format!("the role of {}", entry.from.get_ref()),
                });
            }
        }
        Ok(())
    }
}

/// `place` says where a key of the entry is, by its offset.
fn tap(
    pair: Pair<'_>,
    place: &dyn Fn(usize, &str) -> Place,
    from: &Spanned<String>,
    factor: &Option<Spanned<f64>>,
    offset: &Option<Spanned<f64>>,
) -> Result<Tap, Error> {
    let number = |given: &Option<Spanned<f64>>, key, default, nonzero: bool| {
        let Some(given) = given else {
            return Ok(default);
        };
        let value = *given.get_ref();
        if value.is_finite() && !(nonzero && value == 0.0) {
            return Ok(value);
        }
        let besides = if nonzero { " that is not 0" } else { "" };
        Err(Error::Key {
            place: place(given.span().start, key),
            value: value.to_string(),
            expected: format!("a finite number{besides}"),
        })
    };
    let source = if from.get_ref() == "setpoint" {
        Source::Setpoint
    } else {
        let place = place(from.span().start, "from");
        let (side, scalar) = pair.resolve(&place, from.get_ref(), SOURCES)?;
        Source::Output(side, scalar)
    };
    Ok(Tap {
        source,
        factor: number(factor, "factor", 1.0, true)?,
        offset: number(offset, "offset", 0.0, false)?,
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::contract;
    use super::super::tests::connection;
    use super::*;
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
                "M.toml:2: connection.from: plant has no variable angel, did you mean angle?",
            ),
            (
                connection("plant.angle", "controller.torque", ""),
                "M.toml:3: connection.to: controller.torque is an output; possible here: angle, setpoint",
            ),
            (
                connection("angle", "controller.angle", ""),
                "M.toml:2: connection.from: \"angle\" must say whose it is",
            ),
            (
                connection("plant.angle", "plant.torque", ""),
                "M.toml:3: connection.to: plant.angle and plant.torque belong to the same FMU",
            ),
            (
                connection("plant.angle", "controller.angle", "factor = 0.0"),
                "M.toml:4: connection.factor = 0: expected a finite number that is not 0",
            ),
            (
                good.clone() + &good,
                "M.toml:7: connection.to: controller.angle already has a source",
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
