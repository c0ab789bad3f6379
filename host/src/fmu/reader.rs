//! Reads `modelDescription.xml` of either version.

use super::defects::defects;
use super::description::{DefaultExperiment, Description, MAX_ELEMENTS, Version};
use super::{Error, fmi2_description, fmi3_description, structure};
use fmi_rs::model_description::ValidationError;
use roxmltree::{Document, ParsingOptions};
use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Bytes of a description: ten times the largest that is shipped in practice, and what parsers take in memory.
const MAX_SIZE: u64 = 64 << 20;

/// Reads the description of the FMU `file`, unpacked to `xml`.
pub(crate) fn describe(file: &Path, xml: &Path) -> Result<Description, Error> {
    let missing = |source| Error::NoDescription {
        file: file.to_owned(),
        source,
    };
    let size = fs::metadata(xml).map_err(missing)?.len();
    if size > MAX_SIZE {
        return Err(Error::DescriptionSize {
            file: file.to_owned(),
            size,
            limit: MAX_SIZE,
        });
    }
    let bytes = fs::read(xml).map_err(missing)?;
    let text = decode(bytes);
    let wrong = |reason: String| Error::Description {
        file: file.to_owned(),
        reason,
    };
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(&text, options).map_err(|e| wrong(e.to_string()))?;
    let root = document.root_element();
    let version = root
        .attribute("fmiVersion")
        .ok_or_else(|| wrong("fmiVersion is missing".to_owned()))?;
    let version = match version {
        "2.0" => Version::V2,
        v if v.starts_with("3.") => Version::V3,
        _ => {
            return Err(Error::Version {
                file: file.to_owned(),
                version: version.to_owned(),
            });
        }
    };
    let defects = defects(&document, version);
    if !defects.is_empty() {
        return Err(wrong(defects.join("\n  ")));
    }
    let parsed = match version {
        Version::V2 => fmi2_description::read(&text),
        Version::V3 => fmi3_description::read(&text),
    };
    let mut description = parsed.map_err(|e| wrong(e.to_string()))?;
    description.units = structure::units(root);
    description.dependencies =
        structure::dependencies(root, description.version, &description.variables);
    check_sizes(file, &description)?;
    for (position, variable) in description.variables.iter().enumerate() {
        description.index.insert(variable.name.clone(), position);
    }
    Ok(description)
}

/// Whether no array has more elements than the host works with.
pub(super) fn check_sizes(file: &Path, description: &Description) -> Result<(), Error> {
    let mut variables = description.variables.iter();
    let Some(variable) = variables.find(|v| v.elements().is_none()) else {
        return Ok(());
    };
    Err(Error::ArraySize {
        file: file.to_owned(),
        name: variable.name.clone(),
        dimensions: variable.dimensions.clone(),
        limit: MAX_ELEMENTS,
    })
}

/// Text of an XML file: UTF-8, or else Latin-1, which older tools declare and write.
fn decode(bytes: Vec<u8>) -> String {
    let text = String::from_utf8(bytes)
        .unwrap_or_else(|error| error.as_bytes().iter().map(|&b| char::from(b)).collect());
    text.trim_start_matches('\u{feff}').to_owned()
}

/// Numbers of a default experiment.
pub(super) fn experiment(
    declared: &fmi_rs::model_description::DefaultExperiment,
) -> DefaultExperiment {
    let number = |text: &Option<String>| text.as_ref().and_then(|t| t.trim().parse().ok());
    DefaultExperiment {
        start_time: number(&declared.startTime),
        stop_time: number(&declared.stopTime),
        tolerance: number(&declared.tolerance),
        step_size: number(&declared.stepSize),
    }
}

/// What the validation of a description finds.
///
/// `fmi-rs` 0.3 checks names with a scanner in C that has global state and ends the process if two threads
/// use it at once.
pub(super) fn problems(validate: impl FnOnce() -> Vec<ValidationError>) -> Vec<String> {
    static SCANNER: Mutex<()> = Mutex::new(());
    let _one_at_a_time = SCANNER.lock().unwrap_or_else(PoisonError::into_inner);
    validate()
        .into_iter()
        .map(|problem| problem.message)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn latin_1_and_byte_order_marks_are_read() {
        assert_eq!(decode(b"<a b='\xe4'/>".to_vec()), "<a b='ä'/>");
        assert_eq!(decode("\u{feff}<a b='ä'/>".into()), "<a b='ä'/>");
    }

    #[test]
    fn many_threads_may_read_at_once() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../modelDescription/controller.xml"
        );
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..20 {
                        let read = describe(Path::new("test.fmu"), Path::new(path)).unwrap();
                        assert!(read.problems.is_empty());
                    }
                });
            }
        });
    }
}
