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
    pub(super) fn add_file(&mut self, pair: Pair<'_>, path: &Path) -> Result<(), Error> {
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
