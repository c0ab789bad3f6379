//! Which key of an experiment a mistake is about.

use super::Run;
use crate::input::{Error as Mistake, Place};
use crate::{Error, fmu};

impl Run {
    /// Where a setting is given, by its key, or a file, by its path.
    fn giving(&self, what: &str) -> &Place {
        self.keys.get(what).unwrap_or(&self.place)
    }

    /// A mistake of the run's set-up, at the key that made it unless it says itself which file it is about.
    pub(crate) fn blame(&self, mistake: Mistake) -> Mistake {
        let at = |place: &Place| Mistake::Syntax {
            place: place.clone(),
            message: mistake.to_string(),
        };
        match &mistake {
            Mistake::Setting {
                name,
                value,
                expected,
            } => {
                let name = name.trim_start_matches('-');
                match self.keys.get(name) {
                    Some(place) => Mistake::Key {
                        place: place.clone(),
                        value: value.clone(),
                        expected: expected.clone(),
                    },
                    None => Mistake::Syntax {
                        place: self.place.clone(),
                        message: format!("{name} = {value}: expected {expected}"),
                    },
                }
            }
            Mistake::Read { file, .. } | Mistake::NotText { file } => {
                at(self.giving(&file.display().to_string()))
            }
            Mistake::Purposeless { file, .. } if self.keys.contains_key(file) => {
                at(self.giving(file))
            }
            Mistake::NothingToConnect { .. } => at(&self.place),
            _ => mistake,
        }
    }

    /// The same for the FMU that `key` names.
    pub(super) fn blame_fmu(&self, key: &str, error: fmu::Error) -> Error {
        if !error.is_input() {
            return Error::Fmu(error);
        }
        Error::Input(Mistake::Syntax {
            place: self.giving(key).clone(),
            message: error.to_string(),
        })
    }

    /// The same for what an FMU refuses when the run begins.
    pub(super) fn blame_start(&self, error: Error) -> Error {
        match error {
            Error::Fmu(error) if error.is_input() => Error::Input(Mistake::Syntax {
                place: self.place.clone(),
                message: error.to_string(),
            }),
            Error::Input(mistake) => Error::Input(self.blame(mistake)),
            other => other,
        }
    }
}
