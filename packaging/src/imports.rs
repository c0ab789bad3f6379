//! What a binary offers, and asks of the system that loads it: libraries, and versions of glibc.
//!
//! An FMU is dropped into tools on machines that nobody has seen. Its binaries must find there all
//! that they ask for, so they may ask only for what every such system brings.

use object::elf::{DT_NEEDED, FileHeader64};
use object::read::elf::{Dyn, FileHeader};
use object::read::pe::PeFile64;
use object::{LittleEndian, NameOrOrdinal, Object};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The newest glibc that a binary for Linux may ask for: that of 2012, the first for aarch64.
pub const GLIBC: (u32, u32) = (2, 17);

/// What every Linux with glibc brings, up to the suffix `.so.N`.
const LINUX: [&str; 6] = [
    "libc",
    "libm",
    "libpthread",
    "libdl",
    "ld-linux-x86-64",
    "ld-linux-aarch64",
];

/// What every Windows brings; so are those that start with `api-ms-win-crt-`, its newer C library.
const WINDOWS: [&str; 9] = [
    "kernel32.dll",
    "ntdll.dll",
    "msvcrt.dll",
    "advapi32.dll",
    "userenv.dll",
    "ws2_32.dll",
    "user32.dll",
    "dbghelp.dll",
    "bcrypt.dll",
];
const WINDOWS_C: &str = "api-ms-win-crt-";

/// One function of each version of the standard: a linker that keeps no names loses these too.
const FUNCTIONS: [&str; 2] = ["fmi2Instantiate", "fmi3DoStep"];

/// Refuses a shared library whose functions a tool would not find, or that asks for too much.
pub fn check(binary: &[u8]) -> Result<(), String> {
    let unreadable = |e| format!("is not a shared library that can be checked: {e}");
    let exports = exports(binary).map_err(unreadable)?;
    for function in FUNCTIONS {
        if !exports.contains(function) {
            return Err(format!("does not export {function}"));
        }
    }
    Imports::read(binary).map_err(unreadable)?.check()
}

fn exports(binary: &[u8]) -> object::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for export in object::File::parse(binary)?.exports()? {
        if let NameOrOrdinal::Name(name) = export?.name() {
            names.insert(String::from_utf8_lossy(name).into_owned());
        }
    }
    Ok(names)
}

/// The libraries that a binary names, and the versions of symbols (ELF only).
#[derive(Debug, Default, PartialEq, Eq)]
struct Imports {
    /// Names as in the file.
    libraries: BTreeSet<String>,
    /// `GLIBC_2.17` and the like.
    versions: BTreeSet<String>,
}

impl Imports {
    /// Reads them from a 64-bit ELF or PE file.
    fn read(binary: &[u8]) -> object::Result<Self> {
        if binary.starts_with(b"MZ") {
            Self::of_pe(binary)
        } else {
            Self::of_elf(binary)
        }
    }

    fn of_elf(binary: &[u8]) -> object::Result<Self> {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let header = FileHeader64::<LittleEndian>::parse(binary)?;
        let endian = header.endian()?;
        let sections = header.sections(endian, binary)?;
        let mut imports = Self::default();
        if let Some((entries, strings)) = sections.dynamic(endian, binary)? {
            let strings = sections.strings(endian, binary, strings)?;
            for entry in entries {
                if entry.tag(endian) == DT_NEEDED {
                    let library = entry.string(endian, strings)?;
                    imports.libraries.insert(text(library));
                }
            }
        }
        if let Some((mut needs, strings)) = sections.gnu_verneed(endian, binary)? {
            let strings = sections.strings(endian, binary, strings)?;
            while let Some((_, mut versions)) = needs.next()? {
                while let Some(version) = versions.next()? {
                    imports
                        .versions
                        .insert(text(version.name(endian, strings)?));
                }
            }
        }
        Ok(imports)
    }

    fn of_pe(binary: &[u8]) -> object::Result<Self> {
        let mut imports = Self::default();
        if let Some(table) = PeFile64::parse(binary)?.import_table()? {
            let mut libraries = table.descriptors()?;
            while let Some(library) = libraries.next()? {
                let name = table.name(library.name.get(LittleEndian))?;
                let name = String::from_utf8_lossy(name).into_owned();
                imports.libraries.insert(name);
            }
        }
        Ok(imports)
    }

    /// Refuses, by name, what not every system brings.
    fn check(&self) -> Result<(), String> {
        let libraries = self.libraries.iter().filter(|name| !is_system(name));
        let versions = self.versions.iter().filter(|name| is_newer(name));
        let mut refused = String::new();
        for name in libraries {
            let _ = write!(refused, "\n  {name} is not part of every system"); // a String takes all
        }
        for name in versions {
            let (major, minor) = GLIBC;
            let _ = write!(refused, "\n  {name} is newer than GLIBC_{major}.{minor}");
        }
        if refused.is_empty() {
            Ok(())
        } else {
            Err(format!("asks for too much:{refused}"))
        }
    }
}

fn is_system(library: &str) -> bool {
    if let Some((name, _)) = library.split_once(".so") {
        return LINUX.contains(&name);
    }
    let name = library.to_lowercase(); // Windows does not tell cases apart
    WINDOWS.contains(&name.as_str()) || name.starts_with(WINDOWS_C)
}

/// Everything that is not a known, old version counts as newer.
fn is_newer(version: &str) -> bool {
    let numbers = version.strip_prefix("GLIBC_").and_then(|numbers| {
        let mut parts = numbers.split('.').map(str::parse);
        Some((parts.next()?.ok()?, parts.next()?.ok()?))
    });
    numbers.is_none_or(|version| version > GLIBC)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imports(libraries: &[&str], versions: &[&str]) -> Imports {
        let set = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        Imports {
            libraries: set(libraries),
            versions: set(versions),
        }
    }

    #[test]
    fn what_every_system_brings_passes() {
        let linux = imports(
            &["libc.so.6", "ld-linux-aarch64.so.1"],
            &["GLIBC_2.2.5", "GLIBC_2.17"],
        );
        assert_eq!(linux.check(), Ok(()));
        let windows = imports(&["KERNEL32.dll", "api-ms-win-crt-heap-l1-1-0.dll"], &[]);
        assert_eq!(windows.check(), Ok(()));
    }

    #[test]
    fn the_rest_is_refused_by_name() {
        for (libraries, versions, name) in [
            (&["libopenblas.so.0"][..], &[][..], "libopenblas.so.0"),
            (&["libgcc_s_seh-1.dll"], &[], "libgcc_s_seh-1.dll"),
            (&[], &["GLIBC_2.18"], "GLIBC_2.18"),
            (&[], &["GLIBC_PRIVATE"], "GLIBC_PRIVATE"),
            (&[], &["GCC_3.0"], "GCC_3.0"),
        ] {
            let message = imports(libraries, versions).check().unwrap_err();
            assert!(message.contains(name), "{message}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_program_of_this_machine_is_read() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let read = Imports::read(&program).unwrap();
        assert!(read.libraries.contains("libc.so.6"), "{read:?}");
        assert!(read.versions.iter().any(|v| v.starts_with("GLIBC_2.")));
        assert_eq!(
            check(&program).unwrap_err(),
            "does not export fmi2Instantiate"
        );
        assert!(check(b"no binary").is_err());
    }
}
