//! The platforms that an FMU can carry binaries for.

use std::env::consts;

/// A platform and what the standards call it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    os: &'static str,
    arch: &'static str,
    /// Target triple of the compiler on the platform itself.
    pub native: &'static str,
    /// Target triple for a binary that runs on old systems too, from whatever machine.
    pub portable: &'static str,
    /// Folder in `binaries/` of an FMI 2.0 FMU (FMI 2.0.4 sec 2.3).
    pub fmi2: &'static str,
    /// Folder in `binaries/` of an FMI 3.0 FMU (FMI 3.0 sec 2.5.1).
    pub fmi3: &'static str,
    /// Suffix of shared libraries.
    pub suffix: &'static str,
}

impl Platform {
    /// Every platform of `cargo xtask package --all-platforms`.
    pub const ALL: [Self; 3] = [
        Self {
            os: "linux",
            arch: "x86_64",
            native: "x86_64-unknown-linux-gnu",
            portable: "x86_64-unknown-linux-gnu",
            fmi2: "linux64",
            fmi3: "x86_64-linux",
            suffix: ".so",
        },
        Self {
            os: "windows",
            arch: "x86_64",
            native: "x86_64-pc-windows-msvc",
            // Windows 7 and later: the only one whose random numbers Wine 8 has too.
            portable: "x86_64-win7-windows-gnu",
            fmi2: "win64",
            fmi3: "x86_64-windows",
            suffix: ".dll",
        },
        Self {
            os: "linux",
            arch: "aarch64",
            native: "aarch64-unknown-linux-gnu",
            portable: "aarch64-unknown-linux-gnu",
            fmi2: "aarch64-linux",
            fmi3: "aarch64-linux",
            suffix: ".so",
        },
    ];

    /// The platform that we run on.
    pub fn host() -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|p| p.os == consts::OS && p.arch == consts::ARCH)
            .ok_or_else(|| format!("no FMU platform for {} on {}", consts::OS, consts::ARCH))
    }

    /// Whether its binaries are of the format ELF and ask for versions of glibc.
    pub fn is_linux(&self) -> bool {
        self.os == "linux"
    }
}
