//! Which compiler builds for a platform: one that has, or can build, its standard library.

use super::debian;
use crate::workspace::Workspace;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fmt::{self, Display};
use std::iter;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Sources of the standard library, below the folder of a compiler.
pub const LIBRARY_SOURCE: &str = "lib/rustlib/src/rust/library";

/// What programs of mingw-w64 are called first.
const MINGW: &str = "x86_64-w64-mingw32";

/// A compiler and how it comes by the standard library of a platform.
pub enum Compiler {
    /// That of the user has it, for this target.
    Own,
    /// That of the user has its sources.
    OwnFromSource,
    /// Debian's, unpacked in this folder, has its sources.
    Debian(PathBuf),
}

impl Compiler {
    /// The first that can build for `triple`; fetches Debian's if need be.
    pub fn find(workspace: &Workspace, triple: &str) -> Result<Self, String> {
        let own = sysroot(workspace)?;
        if own.join("lib/rustlib").join(triple).join("lib").is_dir() {
            Ok(Self::Own)
        } else if own.join(LIBRARY_SOURCE).is_dir() {
            Ok(Self::OwnFromSource)
        } else {
            debian::fetch(workspace).map(Self::Debian).map_err(|e| {
                format!(
                    "your compiler has neither the standard library for {triple} nor its sources: \
                     run `rustup component add rust-src` and install gcc-mingw-w64-x86-64.\nNor is Debian's compiler to be had: {e}"
                )
            })
        }
    }

    /// Makes cargo link with mingw-w64, which also compiles what is in C: Debian's, or the installed one.
    /// `flags` are those of the compiler, separated by U+001F.
    pub fn link_for_windows(&self, cargo: &mut Command, flags: &mut OsString, triple: &str) {
        // Equal sources give equal bytes only without the time; half of a DLL would be names.
        flags.push("\x1f-Clink-arg=-Wl,--no-insert-timestamp\x1f-Cstrip=symbols");
        let mut gcc = PathBuf::from(format!("{MINGW}-gcc"));
        if let Self::Debian(folder) = self {
            let programs = folder.join("usr/bin");
            let fetched = programs.join(format!("{MINGW}-gcc-win32"));
            if fetched.exists() {
                gcc = fetched;
            }
            cargo.env("PATH", first("PATH", programs)); // the compiler calls its dlltool by name
        }
        let triple = triple.replace('-', "_");
        cargo.env(format!("CC_{triple}"), &gcc);
        let linker = format!("CARGO_TARGET_{}_LINKER", triple.to_uppercase());
        cargo.env(linker, gcc);
    }

    /// Makes cargo use it.
    pub fn set_up(&self, cargo: &mut Command) {
        if let Self::Debian(folder) = self {
            cargo.env("RUSTC", folder.join("usr/bin/rustc"));
            let libraries = folder.join("usr/lib/x86_64-linux-gnu");
            cargo.env("LD_LIBRARY_PATH", first("LD_LIBRARY_PATH", libraries));
        }
        if !matches!(self, Self::Own) {
            // Building the standard library is not stable; this is what makes it possible at all.
            cargo.env("RUSTC_BOOTSTRAP", "1");
            cargo.arg("-Zbuild-std=std,panic_unwind");
        }
    }
}

/// The value of a variable that lists folders, with `folder` before the others.
fn first(variable: &str, folder: PathBuf) -> OsString {
    let set = env::var_os(variable);
    let others = set.iter().flat_map(env::split_paths);
    // Fails for a folder with a colon only, of which no list can tell.
    env::join_paths(iter::once(folder).chain(others)).unwrap_or_default()
}

impl Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Own => "your compiler",
            Self::OwnFromSource => "your compiler, with the standard library from its source",
            Self::Debian(_) => "Debian's compiler, with the standard library from its source",
        })
    }
}

/// Where the user's compiler keeps its libraries.
fn sysroot(workspace: &Workspace) -> Result<PathBuf, String> {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = workspace
        .command(&rustc)
        .args(["--print", "sysroot"])
        .output()
        .map_err(|e| format!("{}: {e}", Path::new(&rustc).display()))?;
    let line = String::from_utf8_lossy(&output.stdout);
    if output.status.success() {
        Ok(PathBuf::from(OsStr::new(line.trim())))
    } else {
        Err(format!("{} --print sysroot failed", rustc.display()))
    }
}
