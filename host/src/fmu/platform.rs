//! Where an FMU keeps the binary for the machine that the host runs on.

use std::path::{Path, PathBuf};

/// FMI 2.0 name of this platform (FMI 2.0.4 sec 2.3), then names that tools use where the standard has none.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
const PLATFORMS: &[&str] = &["linux64", "x86_64-linux"];
#[cfg(all(target_os = "linux", target_arch = "aarch64"))]
const PLATFORMS: &[&str] = &["aarch64-linux", "linux-aarch64", "linux64-aarch64"];
#[cfg(all(target_os = "windows", target_arch = "x86_64"))]
const PLATFORMS: &[&str] = &["win64", "x86_64-windows"];
#[cfg(all(target_os = "macos", target_arch = "x86_64"))]
const PLATFORMS: &[&str] = &["darwin64", "x86_64-darwin"];
#[cfg(all(target_os = "macos", target_arch = "aarch64"))]
const PLATFORMS: &[&str] = &["aarch64-darwin", "darwin64"];
#[cfg(not(any(
    all(
        target_os = "linux",
        any(target_arch = "x86_64", target_arch = "aarch64")
    ),
    all(target_os = "windows", target_arch = "x86_64"),
    all(
        target_os = "macos",
        any(target_arch = "x86_64", target_arch = "aarch64")
    ),
)))]
const PLATFORMS: &[&str] = &[];

/// The binary of `identifier` for this platform below the unpacked folder. Some tools use the names of the
/// other version of the standard, so both are tried.
pub(crate) fn find_binary(folder: &Path, identifier: &str) -> Option<PathBuf> {
    let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
    PLATFORMS
        .iter()
        .map(|platform| folder.join("binaries").join(platform).join(&file))
        .find(|path| path.is_file())
}

/// Names of this platform.
pub(crate) fn names() -> String {
    PLATFORMS.join(" or ")
}

/// Platforms that the FMU has a folder for, in order.
pub(crate) fn present(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = std::fs::read_dir(folder.join("binaries"))
        .into_iter()
        .flatten()
        .flatten()
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// `file:///…` of an absolute path (RFC 8089), everything but unreserved characters percent-encoded.
pub(crate) fn file_uri(path: &Path) -> String {
    let text = path.to_string_lossy();
    let text = text.strip_prefix(r"\\?\").unwrap_or(&text);
    let mut uri = String::from("file://");
    if !text.starts_with(['/', '\\']) {
        uri.push('/');
    }
    for byte in text.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                uri.push(char::from(byte));
            }
            b'\\' if cfg!(windows) => uri.push('/'),
            b':' if cfg!(windows) => uri.push(':'),
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn uris_escape_what_is_reserved() {
        assert_eq!(
            file_uri(Path::new("/a b/50%#ä/resources")),
            "file:///a%20b/50%25%23%C3%A4/resources"
        );
    }

    #[test]
    fn both_names_of_the_platform_are_found() {
        for platform in PLATFORMS {
            let folder = tempfile::tempdir().unwrap();
            let binaries = folder.path().join("binaries").join(platform);
            std::fs::create_dir_all(&binaries).unwrap();
            assert_eq!(find_binary(folder.path(), "m"), None);
            let file = binaries.join(format!("m{}", std::env::consts::DLL_SUFFIX));
            std::fs::write(&file, b"").unwrap();
            assert_eq!(find_binary(folder.path(), "m"), Some(file));
            assert_eq!(present(folder.path()), [(*platform).to_owned()]);
        }
    }
}
