//! The platforms that an FMU can carry binaries for.

use std::env::consts;

/// A platform and what the standards call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    os: &'static str,
    arch: &'static str,
    /// Target triple of the compiler.
    pub triple: &'static str,
    /// Folder in `binaries/` of an FMI 2.0 FMU (FMI 2.0 sec 2.3).
    pub fmi2: &'static str,
    /// Folder in `binaries/` of an FMI 3.0 FMU (FMI 3.0 sec 2.5.1).
    pub fmi3: &'static str,
    /// Suffix of shared libraries.
    pub suffix: &'static str,
}

const PLATFORMS: [Platform; 2] = [
    Platform {
        os: "linux",
        arch: "x86_64",
        triple: "x86_64-unknown-linux-gnu",
        fmi2: "linux64",
        fmi3: "x86_64-linux",
        suffix: ".so",
    },
    Platform {
        os: "windows",
        arch: "x86_64",
        triple: "x86_64-pc-windows-msvc",
        fmi2: "win64",
        fmi3: "x86_64-windows",
        suffix: ".dll",
    },
];

impl Platform {
    /// The platform that we run on.
    pub fn host() -> Result<Self, String> {
        PLATFORMS
            .into_iter()
            .find(|p| p.os == consts::OS && p.arch == consts::ARCH)
            .ok_or_else(|| format!("no FMU platform for {} on {}", consts::OS, consts::ARCH))
    }
}
