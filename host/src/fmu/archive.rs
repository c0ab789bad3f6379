//! Unpacks an FMU, which is a zip file from anywhere, without trusting it.
//!
//! Nothing is written outside the target folder, links are refused, and the sizes that the archive
//! declares are not believed: the bytes that come out are counted. It knows nothing of FMI.

use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use zip::ZipArchive;

/// What an archive may unpack to.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Bytes of all entries together.
    pub total: u64,
    /// Bytes of one entry.
    pub entry: u64,
    /// Number of entries.
    pub entries: usize,
}

impl Default for Limits {
    /// 2 GiB in all, 1 GiB each, 65 536 entries: several times the largest FMU that is shipped in practice.
    fn default() -> Self {
        Self {
            total: 2 << 30,
            entry: 1 << 30,
            entries: 1 << 16,
        }
    }
}

/// Why an archive was not unpacked.
#[derive(Debug)]
#[allow(missing_docs, reason = "the fields are what Display prints")]
pub enum Problem {
    /// It is a folder.
    Folder,
    /// The archive could not be read.
    Read(io::Error),
    /// An unpacked file could not be written.
    Write { path: PathBuf, source: io::Error },
    /// It is not a zip file, or a damaged one.
    NotAnArchive(String),
    /// An entry would be written outside the folder, or its name is no file name.
    UnsafeName { name: String, why: &'static str },
    /// An entry is a link.
    Link { name: String },
    /// Two entries have the same name.
    Duplicate { name: String },
    /// An entry is encrypted, compressed by an unsupported method or damaged.
    Entry { name: String, why: String },
    /// There are too many entries.
    Entries { count: usize, limit: usize },
    /// One entry is too large.
    EntrySize { name: String, limit: u64 },
    /// All entries together are too large.
    TotalSize { limit: u64 },
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder => f.write_str("is a folder, not an FMU, which is a zip file"),
            Self::Read(source) => write!(f, "cannot be read: {source}"),
            Self::Write { path, source } => {
                write!(f, "cannot be unpacked to {}: {source}", path.display())
            }
            Self::NotAnArchive(why) => write!(f, "is not an FMU, which is a zip file: {why}"),
            Self::UnsafeName { name, why } => {
                write!(f, "is refused: the entry {name:?} {why}")
            }
            Self::Link { name } => write!(f, "is refused: the entry {name:?} is a link"),
            Self::Duplicate { name } => {
                write!(f, "is refused: two entries are called {name:?}")
            }
            Self::Entry { name, why } => write!(f, "has an unreadable entry {name:?}: {why}"),
            Self::Entries { count, limit } => {
                write!(
                    f,
                    "is refused: {count} entries, at most {limit} are admitted"
                )
            }
            Self::EntrySize { name, limit } => write!(
                f,
                "is refused: the entry {name:?} unpacks to more than {} MiB",
                limit >> 20
            ),
            Self::TotalSize { limit } => {
                write!(f, "is refused: it unpacks to more than {} MiB", limit >> 20)
            }
        }
    }
}

/// Unpacks `archive` into the existing, empty folder `into`.
///
/// On an error the folder may hold some of the entries; the caller removes it.
pub fn unpack(archive: &Path, into: &Path, limits: &Limits) -> Result<(), Problem> {
    let file = File::open(archive).map_err(Problem::Read)?;
    if file.metadata().is_ok_and(|m| m.is_dir()) {
        return Err(Problem::Folder);
    }
    let mut zip = ZipArchive::new(io::BufReader::new(file))
        .map_err(|e| Problem::NotAnArchive(e.to_string()))?;
    if zip.len() > limits.entries {
        return Err(Problem::Entries {
            count: zip.len(),
            limit: limits.entries,
        });
    }
    let mut left = limits.total;
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index).map_err(|e| Problem::Entry {
            name: format!("number {index}"),
            why: e.to_string(),
        })?;
        let name = entry.name().map_or_else(
            |_| String::from_utf8_lossy(entry.name_raw()).into_owned(),
            std::borrow::Cow::into_owned,
        );
        let path = into.join(relative_path(&name)?);
        if entry.is_symlink() {
            return Err(Problem::Link { name });
        }
        if name.ends_with(['/', '\\']) {
            create_folder(&path)?;
            continue;
        }
        if let Some(parent) = path.parent() {
            create_folder(parent)?;
        }
        let written = write_entry(&mut entry, &name, &path, limits.entry.min(left))?;
        match written {
            Some(bytes) => left -= bytes,
            None if left < limits.entry => {
                return Err(Problem::TotalSize {
                    limit: limits.total,
                });
            }
            None => {
                return Err(Problem::EntrySize {
                    name,
                    limit: limits.entry,
                });
            }
        }
    }
    Ok(())
}

fn create_folder(path: &Path) -> Result<(), Problem> {
    fs::create_dir_all(path).map_err(|source| Problem::Write {
        path: path.to_owned(),
        source,
    })
}

/// Copies at most `limit` bytes; None if there were more.
fn write_entry(
    entry: &mut impl Read,
    name: &str,
    path: &Path,
    limit: u64,
) -> Result<Option<u64>, Problem> {
    let write_error = |source: io::Error| {
        if source.kind() == io::ErrorKind::AlreadyExists {
            Problem::Duplicate {
                name: name.to_owned(),
            }
        } else {
            Problem::Write {
                path: path.to_owned(),
                source,
            }
        }
    };
    // create_new: a second entry of the same name must not replace the first.
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(path)
        .map_err(write_error)?;
    let mut buffer = [0; 1 << 16];
    let mut total = 0;
    loop {
        let count = entry.read(&mut buffer).map_err(|e| Problem::Entry {
            name: name.to_owned(),
            why: e.to_string(),
        })?;
        if count == 0 {
            return Ok(Some(total));
        }
        total += count as u64;
        if total > limit {
            return Ok(None);
        }
        file.write_all(&buffer[..count]).map_err(write_error)?;
    }
}

/// The path below the target folder. Some tools write `\` for `/`, so both separate.
fn relative_path(name: &str) -> Result<PathBuf, Problem> {
    let refuse = |why| Problem::UnsafeName {
        name: name.to_owned(),
        why,
    };
    if name.contains('\0') {
        return Err(refuse("contains a zero byte"));
    }
    if name.starts_with(['/', '\\']) || name.as_bytes().get(1) == Some(&b':') {
        return Err(refuse("is an absolute path"));
    }
    let mut path = PathBuf::new();
    for part in name.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => return Err(refuse("leads out of the folder")),
            _ => path.push(part),
        }
    }
    if path.as_os_str().is_empty() {
        return Err(refuse("is empty"));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use zip::write::{SimpleFileOptions, ZipWriter};

    fn archive(entries: &[(&str, &[u8])]) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut zip = ZipWriter::new(file.reopen().unwrap());
        for (name, content) in entries {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(content).unwrap();
        }
        zip.finish().unwrap();
        file
    }

    fn unpacked(
        file: &tempfile::NamedTempFile,
        limits: &Limits,
    ) -> Result<tempfile::TempDir, Problem> {
        let folder = tempfile::tempdir().unwrap();
        unpack(file.path(), folder.path(), limits)?;
        Ok(folder)
    }

    #[test]
    fn ordinary_entries_arrive_whole() {
        let file = archive(&[
            ("modelDescription.xml", b"<x/>"),
            ("binaries/linux64/a b%20.so", b"elf"),
            ("resources\\table.csv", b"1,2"),
        ]);
        let folder = unpacked(&file, &Limits::default()).unwrap();
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert_eq!(read("modelDescription.xml"), b"<x/>");
        assert_eq!(read("binaries/linux64/a b%20.so"), b"elf");
        assert_eq!(read("resources/table.csv"), b"1,2");
    }

    #[test]
    fn names_that_lead_outside_are_refused() {
        for name in [
            "../evil",
            "a/../../evil",
            "/etc/evil",
            "\\evil",
            "a\\..\\..\\evil",
            "C:\\evil",
            "C:evil",
            "..",
            "/",
        ] {
            let file = archive(&[(name, b"x")]);
            assert!(
                matches!(
                    unpacked(&file, &Limits::default()),
                    Err(Problem::UnsafeName { .. })
                ),
                "{name}"
            );
        }
    }

    #[test]
    fn links_are_refused() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut zip = ZipWriter::new(file.reopen().unwrap());
        zip.add_symlink("resources/l", "/etc/passwd", SimpleFileOptions::default())
            .unwrap();
        zip.finish().unwrap();
        assert!(matches!(
            unpacked(&file, &Limits::default()),
            Err(Problem::Link { .. })
        ));
    }

    #[test]
    fn sizes_are_counted_as_they_come_out() {
        let zeros = vec![0; 3 << 20];
        let limits = |total, entry| Limits {
            total,
            entry,
            entries: 10,
        };
        let file = archive(&[("a", &zeros), ("b", &zeros)]);
        assert!(matches!(
            unpacked(&file, &limits(100 << 20, 2 << 20)),
            Err(Problem::EntrySize { .. })
        ));
        assert!(matches!(
            unpacked(&file, &limits(5 << 20, 4 << 20)),
            Err(Problem::TotalSize { .. })
        ));
        assert!(unpacked(&file, &limits(6 << 20, 4 << 20)).is_ok());
        let many: Vec<_> = (0..11).map(|i| format!("f{i}")).collect();
        let many: Vec<_> = many.iter().map(|n| (n.as_str(), b"".as_slice())).collect();
        assert!(matches!(
            unpacked(&archive(&many), &limits(1, 1)),
            Err(Problem::Entries { count: 11, .. })
        ));
    }

    /// The declared size is a lie: 1 byte, where 3 MiB come out.
    #[test]
    fn a_declared_size_is_not_believed() {
        let zeros = vec![0; 3 << 20];
        let file = archive(&[("a", &zeros)]);
        let mut bytes = fs::read(file.path()).unwrap();
        let lie = 1u32.to_le_bytes();
        let truth = (3u32 << 20).to_le_bytes();
        let positions: Vec<_> = (0..bytes.len() - 4)
            .filter(|&i| bytes[i..i + 4] == truth)
            .collect();
        assert!(!positions.is_empty());
        for position in positions {
            bytes[position..position + 4].copy_from_slice(&lie);
        }
        fs::write(file.path(), bytes).unwrap();
        let limits = Limits {
            total: 1 << 20,
            entry: 1 << 20,
            entries: 10,
        };
        assert!(unpacked(&file, &limits).is_err());
    }

    #[test]
    fn damage_is_reported() {
        let file = archive(&[("a", &[7; 1000])]);
        let bytes = fs::read(file.path()).unwrap();
        fs::write(file.path(), &bytes[..bytes.len() / 2]).unwrap();
        assert!(matches!(
            unpacked(&file, &Limits::default()),
            Err(Problem::NotAnArchive(_))
        ));
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(
            unpack(folder.path(), folder.path(), &Limits::default()),
            Err(Problem::Folder)
        ));
        fs::write(file.path(), b"hello").unwrap();
        assert!(matches!(
            unpacked(&file, &Limits::default()),
            Err(Problem::NotAnArchive(_))
        ));
    }
}
