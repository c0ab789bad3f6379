//! An SSP as a file (SSP 1.0 sec 3): unpacked, its system structures listed, its resources found.

use super::document::SystemStructure;
use super::read;
use crate::Error;
use crate::fmu::{self, Fmu, Limits, archive};
use crate::input::{self, Place, read_text};
use std::fs;
use std::path::{Component, Path, PathBuf};
use tempfile::TempDir;

/// The system structure that a package must have.
const DEFAULT: &str = "SystemStructure.ssd";

/// An unpacked package. Its folder lives as long as this.
#[derive(Debug)]
pub struct Package {
    file: PathBuf,
    folder: TempDir,
    /// The `.ssd` files: the default one, then the variants by name.
    structures: Vec<String>,
}

impl Package {
    /// Unpacks a package, which may be from anywhere, without trusting it.
    pub fn open(file: &Path) -> Result<Self, Error> {
        let failed = |problem| fmu::Error::Archive {
            file: file.to_owned(),
            problem,
        };
        let folder = tempfile::Builder::new()
            .prefix("flexarm-")
            .tempdir()
            .map_err(fmu::Error::TemporaryFolder)?;
        archive::unpack(file, folder.path(), &Limits::default()).map_err(failed)?;
        let unreadable = |error| failed(fmu::Problem::Read(error));
        let mut structures = Vec::new();
        for entry in fs::read_dir(folder.path()).map_err(unreadable)? {
            let name = entry.map_err(unreadable)?.file_name().into_string();
            structures.extend(name.ok().filter(|name| name.ends_with(".ssd")));
        }
        structures.sort_by_key(|name| (name != DEFAULT, name.clone()));
        let package = Self {
            file: file.to_owned(),
            folder,
            structures,
        };
        if package
            .structures
            .first()
            .is_none_or(|name| name != DEFAULT)
        {
            return Err(package.mistake(None, format!("has no {DEFAULT}")));
        }
        Ok(package)
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Reads a system structure: by the name of its file or the one that it gives itself; without a name the
    /// default one.
    pub(super) fn structure(&self, variant: Option<&str>) -> Result<SystemStructure, Error> {
        let Some(name) = variant else {
            return self.read(DEFAULT);
        };
        let wanted = format!("{}.ssd", name.strip_suffix(".ssd").unwrap_or(name));
        if self.structures.contains(&wanted) {
            return self.read(&wanted);
        }
        let mut names = Vec::new();
        for file in &self.structures {
            let structure = self.read(file)?;
            if structure.name == name {
                return Ok(structure);
            }
            names.push(format!(
                "{} ({})",
                file.trim_end_matches(".ssd"),
                structure.name
            ));
        }
        let message = format!(
            "{} has no system structure {name}; there are: {}",
            self.file.display(),
            names.join(", ")
        );
        Err(syntax(Place::new("--variant", None), message))
    }

    fn read(&self, name: &str) -> Result<SystemStructure, Error> {
        let text = read_text(&self.folder.path().join(name))
            .map_err(|error| self.mistake(Some(name), reason(&error)))?;
        Ok(read::system_structure(&text, &self.name(name))?)
    }

    /// What a file of the package is called in messages.
    pub(super) fn name(&self, path: &str) -> String {
        format!("{}/{path}", self.file.display())
    }

    /// Where a file of the package lies. `place` is where it is named.
    pub(super) fn resource(&self, path: &str, place: &Place) -> Result<PathBuf, Error> {
        find(self.folder.path(), path)
            .map_err(|why| syntax(place.clone(), format!("source `{path}` {why}")))
    }

    /// Text of a file of the package.
    pub(super) fn text(&self, path: &str, place: &Place) -> Result<String, Error> {
        text(&self.resource(path, place)?, path, place)
    }

    /// Opens an FMU of the package.
    pub(super) fn fmu(&self, path: &str, place: &Place) -> Result<Fmu, Error> {
        let content = self.resource(path, place)?;
        let name = PathBuf::from(self.name(path));
        Fmu::open_as(&name, &content, &Limits::default()).map_err(Error::Fmu)
    }

    fn mistake(&self, path: Option<&str>, message: String) -> Error {
        let file = path.map_or_else(|| self.file.display().to_string(), |path| self.name(path));
        syntax(Place::new(file, None), message)
    }
}

/// A file in a folder by its relative URI (SSP 1.0 sec 3.2, RFC 3986), which must not lead out of it.
/// Errors: what is wrong with it, as text that follows the path.
pub(super) fn find(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
    if scheme.is_some_and(|s| !s.is_empty() && s.chars().all(|c| c.is_ascii_alphanumeric())) {
        return Err("is no path within the package, only such can be read".to_owned());
    }
    let decoded = decode(uri).ok_or("has an escape that is no character of UTF-8")?;
    let is_inside = |path: &Path| {
        path.components()
            .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
    };
    for path in [uri, decoded.as_str()] {
        if path.contains('\\') || !is_inside(Path::new(path)) {
            return Err("leads out of the package".to_owned());
        }
        let file = folder.join(path);
        if file.is_file() {
            return Ok(file);
        }
    }
    Err("is not in the package".to_owned())
}

/// Text with `%20` and the like decoded.
fn decode(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let escaped = (first == b'%').then(|| tail.get(..2)).flatten();
        let code = escaped.and_then(|hex| u8::from_str_radix(str::from_utf8(hex).ok()?, 16).ok());
        (rest, _) = match code {
            Some(code) => (&tail[2..], bytes.push(code)),
            None => (tail, bytes.push(first)),
        };
    }
    String::from_utf8(bytes).ok()
}

/// A mistake in a file.
pub(super) fn syntax(place: Place, message: impl Into<String>) -> Error {
    Error::Input(mistake(place, message))
}

/// The same for those that only read.
pub(super) fn mistake(place: Place, message: impl Into<String>) -> input::Error {
    input::Error::Syntax {
        place,
        message: message.into(),
    }
}

/// Text of `file`, which is named `path` at `place`.
pub(super) fn text(file: &Path, path: &str, place: &Place) -> Result<String, Error> {
    read_text(file)
        .map_err(|error| syntax(place.clone(), format!("source `{path}` {}", reason(&error))))
}

/// Why a file of the package cannot be read, without the place where it is unpacked.
fn reason(error: &input::Error) -> String {
    match error {
        input::Error::Read { source, .. } => format!("cannot be read: {source}"),
        _ => "is not text in UTF-8".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_package() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("resources")).unwrap();
        fs::write(folder.path().join("resources/a b.fmu"), "").unwrap();
        let find = |uri| find(folder.path(), uri);
        assert!(find("resources/a%20b.fmu").is_ok() && find("./resources/a b.fmu").is_ok());
        for (uri, why) in [
            ("resources/c.fmu", "is not in the package"),
            ("resources", "is not in the package"),
            ("../a.fmu", "leads out of the package"),
            ("resources/..%2f..%2fa.fmu", "leads out of the package"),
            ("/etc/passwd", "leads out of the package"),
            ("resources\\..\\a", "leads out of the package"),
            ("http://host/a.fmu", "is no path within the package"),
            ("file:///etc/passwd", "is no path within the package"),
            ("%ff", "has an escape that is no character"),
        ] {
            let found = find(uri).unwrap_err();
            assert!(found.starts_with(why), "{uri}: {found}");
        }
    }
}
