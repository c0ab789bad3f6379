//! Files that are written whole or not at all, and archives whose bytes follow from their content.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// The content of a zip archive, by path.
#[derive(Default)]
pub struct Archive {
    entries: BTreeMap<String, Vec<u8>>,
}

impl Archive {
    /// Adds a file.
    pub fn add(&mut self, path: impl Into<String>, content: impl Into<Vec<u8>>) {
        self.entries.insert(path.into(), content.into());
    }

    /// The archive as bytes: entries by name, all of one date, so that equal content gives equal bytes.
    pub fn to_bytes(&self) -> Result<Vec<u8>, String> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (path, content) in &self.entries {
            let executable = path.starts_with("binaries/");
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                .last_modified_time(DateTime::default())
                .unix_permissions(if executable { 0o755 } else { 0o644 });
            zip.start_file(path.as_str(), options)
                .and_then(|()| Ok(zip.write_all(content)?))
                .map_err(|e| format!("{path}: {e}"))?;
        }
        let bytes = zip.finish().map_err(|e| format!("archive: {e}"))?;
        Ok(bytes.into_inner())
    }
}

/// Writes a file beside its final place and then moves it there. Makes missing folders.
pub fn write_whole(path: &Path, content: &[u8]) -> Result<(), String> {
    let error = |e| format!("{}: {e}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(error)?;
    }
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let written = fs::write(&part, content).and_then(|()| fs::rename(&part, path));
    written.map_err(|e| {
        let _ = fs::remove_file(&part); // it may never have come to be
        error(e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn archive(order: &[&str]) -> Vec<u8> {
        let mut archive = Archive::default();
        for path in order {
            archive.add(*path, path.as_bytes());
        }
        archive.to_bytes().unwrap()
    }

    #[test]
    fn equal_content_gives_equal_bytes() {
        assert_eq!(
            archive(&["b", "a", "binaries/c"]),
            archive(&["binaries/c", "a", "b"])
        );
        assert_ne!(archive(&["a"]), archive(&["b"]));
    }

    #[test]
    fn a_failed_write_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sub/file");
        write_whole(&path, b"1").unwrap();
        write_whole(&path, b"2").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"2");
        let occupied = folder.path().join("sub");
        assert!(write_whole(&occupied, b"3").is_err());
        let names: Vec<_> = fs::read_dir(folder.path()).unwrap().flatten().collect();
        assert_eq!(names.len(), 1, "no partial file is left: {names:?}");
    }
}
