//! Builds for every platform from this one: the tools of `cargo xtask package --all-platforms`.
//!
//! zig, as a package of Python, links for Linux against glibc as it was in 2012; mingw-w64 links for
//! Windows, where zig (0.13) would lose the names that a DLL exports. The compiler needs its standard
//! library for each platform.

mod compiler;
mod debian;

use crate::cargo::Products;
use crate::licences::Runtime;
use crate::platform::Platform;
use crate::workspace::Workspace;
use crate::{cargo, imports, python};
use compiler::Compiler;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Where all tools are kept. In the project, so that paths in binaries do not tell where that is.
const FOLDER: &str = "target/toolchain";
/// Where cargo builds. Apart, for cargo does not notice that another linker made what it finds.
const BUILT: &str = "target/platforms";
/// Pinned tools, which come as packages of Python.
const REQUIREMENTS: &str = "packaging/toolchain.txt";
/// What linkers add to binaries: zig to those for Linux, mingw-w64 to those for Windows. Beside the name is the
/// licence in the package of zig, which has that of mingw-w64 too. The exception of libgcc asks for no notice.
const RUNTIME: [(&str, Option<&str>); 4] = [
    ("Zig's compiler runtime, Linux only (MIT)", Some("LICENSE")),
    (
        "libunwind, Linux only (Apache-2.0 WITH LLVM-exception)",
        Some("lib/libunwind/LICENSE.TXT"),
    ),
    (
        "the runtime of mingw-w64, Windows only (ZPL-2.1)",
        Some("lib/libc/mingw/COPYING"),
    ),
    (
        "libgcc, Windows only (GPL-3.0-or-later WITH GCC-exception-3.1)",
        None,
    ),
];

/// The tools, ready to build with.
pub struct Toolchain {
    python: PathBuf,
    /// Where the package of zig is.
    zig: PathBuf,
    compilers: Vec<(Platform, Compiler)>,
}

impl Toolchain {
    /// Fetches what these platforms need.
    pub fn prepare(workspace: &Workspace, platforms: &[Platform]) -> Result<Self, String> {
        let python = python::environment(workspace, &format!("{FOLDER}/python"), REQUIREMENTS)?;
        let mut ask = workspace.command(&python);
        ask.args(["-c", "import ziglang; print(ziglang.__path__[0])"]);
        let output = ask.stderr(Stdio::inherit()).output();
        let output = output.map_err(|e| format!("{}: {e}", python.display()))?;
        if !output.status.success() {
            return Err(format!(
                "{} has no zig, which {REQUIREMENTS} asks for: remove {FOLDER}/python and try again",
                python.display()
            ));
        }
        let zig = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
        let mut compilers = Vec::new();
        for platform in platforms {
            compilers.push((*platform, Compiler::find(workspace, platform.portable)?));
        }
        Ok(Self {
            python,
            zig,
            compilers,
        })
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
            let mut flags = cargo::remapped_paths(workspace)?;
            let mut cargo = if platform.is_linux() {
                self.zig(workspace, platform.portable)
            } else {
                let mut cargo = cargo::command(workspace);
                cargo.args(["build", "--target", platform.portable]);
                compiler.link_for_windows(&mut cargo, &mut flags, platform.portable);
                cargo
            };
            cargo.args(["--target-dir", BUILT]);
            compiler.set_up(&mut cargo);
            cargo.env("CARGO_ENCODED_RUSTFLAGS", flags);
            let products = cargo::products(cargo, packages, platform.suffix)?;
            built.push((*platform, products));
        }
        Ok(built)
    }

    /// Cargo that links for Linux, against the oldest glibc that it shall run on.
    fn zig(&self, workspace: &Workspace, triple: &str) -> Command {
        let (major, minor) = imports::GLIBC;
        let mut cargo = workspace.command(self.python.with_file_name("cargo-zigbuild"));
        cargo.args(["zigbuild", "--target"]);
        cargo.arg(format!("{triple}.{major}.{minor}"));
        cargo.env("CARGO_ZIGBUILD_PYTHON_PATH", &self.python);
        for (variable, folder) in [
            ("CARGO_ZIGBUILD_CACHE_DIR", "wrappers"),
            ("ZIG_GLOBAL_CACHE_DIR", "zig"),
        ] {
            cargo.env(variable, workspace.path(FOLDER).join(folder));
        }
        cargo
    }

    /// The libraries that the linkers add, for those who pass binaries on.
    pub fn runtime(&self) -> Result<Vec<Runtime>, String> {
        let read = |path: &str| {
            let path = self.zig.join(path);
            let text = fs::read_to_string(&path);
            text.map(|text| text.trim().to_owned()).map_err(|e| {
                let path = path.display();
                format!("{path}: {e}; remove {FOLDER}/python and try again")
            })
        };
        let runtime = |(title, path): (&'static str, Option<&str>)| {
            let notice = path.map(read).transpose()?;
            Ok(Runtime { title, notice })
        };
        RUNTIME.into_iter().map(runtime).collect()
    }
}
