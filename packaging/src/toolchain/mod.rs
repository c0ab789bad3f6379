//! Builds for every platform from this one: the tools of `cargo xtask package --all-platforms`.
//!
//! zig, as a package of Python, links for each of them and brings their system libraries: glibc as
//! it was in 2012, and what a DLL needs. The compiler needs its standard library for each.

mod compiler;
mod debian;

use crate::cargo::Products;
use crate::platform::Platform;
use crate::workspace::Workspace;
use crate::{cargo, imports, python};
use compiler::Compiler;
use std::fs;
use std::path::PathBuf;

/// Where all tools are kept. In the project, so that paths in binaries do not tell where that is.
const FOLDER: &str = "target/toolchain";
/// Where cargo builds. Apart, for cargo does not notice that another linker made what it finds.
const BUILT: &str = "target/platforms";
/// Pinned tools, which come as packages of Python.
const REQUIREMENTS: &str = "packaging/toolchain.txt";
/// Debian's compiler asks for these when it links for Windows. They guard stacks of C, zig has none.
const UNUSED: [&str; 2] = ["libssp.a", "libssp_nonshared.a"];
/// An archive that holds nothing.
const EMPTY_ARCHIVE: &[u8] = b"!<arch>\n";

/// What zig links into binaries: name, and licence in its package.
const RUNTIME: [(&str, &str); 3] = [
    ("Zig's compiler runtime (MIT)", "LICENSE"),
    (
        "libunwind (Apache-2.0 WITH LLVM-exception)",
        "lib/libunwind/LICENSE.TXT",
    ),
    (
        "the runtime of mingw-w64, Windows only (ZPL-2.1)",
        "lib/libc/mingw/COPYING",
    ),
];

/// The tools, ready to build with.
pub struct Toolchain {
    python: PathBuf,
    compilers: Vec<(Platform, Compiler)>,
}

impl Toolchain {
    /// Fetches what these platforms need.
    pub fn prepare(workspace: &Workspace, platforms: &[Platform]) -> Result<Self, String> {
        let python = python::environment(workspace, &format!("{FOLDER}/python"), REQUIREMENTS)?;
        let unused = workspace.path(FOLDER).join("unused");
        fs::create_dir_all(&unused).map_err(|e| format!("{}: {e}", unused.display()))?;
        for name in UNUSED {
            let path = unused.join(name);
            fs::write(&path, EMPTY_ARCHIVE).map_err(|e| format!("{}: {e}", path.display()))?;
        }
        let mut compilers = Vec::new();
        for platform in platforms {
            compilers.push((*platform, Compiler::find(workspace, platform.portable)?));
        }
        Ok(Self { python, compilers })
    }

    /// Builds packages for each of the platforms.
    pub fn build(
        &self,
        workspace: &Workspace,
        packages: &[&str],
    ) -> Result<Vec<(Platform, Products)>, String> {
        let mut built = Vec::new();
        for (platform, compiler) in &self.compilers {
            eprintln!("    for {}, by {compiler}", platform.fmi3);
            let mut cargo = workspace.command(self.python.with_file_name("cargo-zigbuild"));
            let (major, minor) = imports::GLIBC;
            let mut target = platform.portable.to_owned();
            let mut flags = cargo::remapped_paths(workspace)?;
            if platform.is_linux() {
                target += &format!(".{major}.{minor}");
            } else {
                // Relative: an absolute path would change the names of symbols.
                flags.push(format!("\x1f-Lnative={FOLDER}/unused"));
            }
            cargo.args(["zigbuild", "--target", &target]);
            cargo.args(["--target-dir", BUILT]);
            cargo.env("CARGO_ZIGBUILD_PYTHON_PATH", &self.python);
            for (variable, folder) in [
                ("CARGO_ZIGBUILD_CACHE_DIR", "wrappers"),
                ("ZIG_GLOBAL_CACHE_DIR", "zig"),
            ] {
                cargo.env(variable, workspace.path(FOLDER).join(folder));
            }
            compiler.set_up(&mut cargo, &mut flags);
            cargo.env("CARGO_ENCODED_RUSTFLAGS", flags);
            let products = cargo::products(cargo, packages, platform.suffix)?;
            built.push((*platform, products));
        }
        Ok(built)
    }

    /// Names and licences of the libraries that every binary contains, for those who pass it on.
    pub fn runtime(&self, workspace: &Workspace) -> Result<Vec<(&'static str, String)>, String> {
        let mut ask = workspace.command(&self.python);
        let output = ask.args(["-c", "import ziglang; print(ziglang.__path__[0])"]);
        let output = output.output().map_err(|e| format!("python: {e}"))?;
        let folder = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
        let read = |(name, path): (&'static str, &str)| {
            let text = fs::read_to_string(folder.join(path));
            let text = text.map_err(|e| format!("ziglang/{path}: {e}"))?;
            Ok((name, text.trim().to_owned()))
        };
        RUNTIME.into_iter().map(read).collect()
    }
}
