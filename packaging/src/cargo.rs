//! Runs cargo and reads what it reports.

use crate::workspace::Workspace;
use serde_json::Value;
use std::collections::BTreeMap;
use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Shared libraries and executables by target name.
pub type Products = BTreeMap<String, PathBuf>;

/// The cargo that runs us.
pub fn command(workspace: &Workspace) -> Command {
    workspace.command(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Builds packages in release, for this platform.
///
/// For a `product`, built for that target, the compiler is told to forget where this machine keeps
/// sources, so that equal sources give equal binaries everywhere.
pub fn build(
    workspace: &Workspace,
    packages: &[&str],
    product: Option<&str>,
) -> Result<Products, String> {
    let mut cargo = command(workspace);
    cargo.arg("build");
    if let Some(triple) = product {
        cargo.args(["--target", triple]);
        cargo.env("CARGO_ENCODED_RUSTFLAGS", remapped_paths(workspace)?);
    }
    products(cargo, packages, env::consts::DLL_SUFFIX)
}

/// Runs a command that builds, `cargo build` or one like it, for packages in release. The names of
/// shared libraries end with `suffix`.
pub fn products(mut cargo: Command, packages: &[&str], suffix: &str) -> Result<Products, String> {
    cargo.args(["--release", "--message-format=json-render-diagnostics"]);
    for package in packages {
        cargo.args(["--package", package]);
    }
    let output = cargo
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("{}: {e}", cargo.get_program().display()))?;
    if !output.status.success() {
        return Err(format!(
            "building {} failed: {}",
            packages.join(", "),
            output.status
        ));
    }
    let mut built = BTreeMap::new();
    for line in output.stdout.split(|b| *b == b'\n') {
        let Ok(message) = serde_json::from_slice::<Value>(line) else {
            continue;
        };
        let target = &message["target"];
        let kinds = [Value::from("cdylib"), Value::from("bin")];
        let is_product = target["kind"]
            .as_array()
            .is_some_and(|k| k.iter().any(|k| kinds.contains(k)));
        if message["reason"] != "compiler-artifact" || !is_product {
            continue;
        }
        // A library lists its rlib beside the shared library.
        let shared = |name: &&str| name.ends_with(suffix);
        let files = message["filenames"].as_array().into_iter().flatten();
        let file = message["executable"]
            .as_str()
            .or_else(|| files.filter_map(Value::as_str).find(shared));
        if let (Some(name), Some(file)) = (target["name"].as_str(), file) {
            built.insert(name.to_owned(), PathBuf::from(file));
        }
    }
    Ok(built)
}

/// Builds the `flexarm` host and returns where it is.
pub fn host(workspace: &Workspace) -> Result<PathBuf, String> {
    let mut built = build(workspace, &["flexarm-host"], None)?;
    let host = built.remove("flexarm");
    host.ok_or_else(|| "flexarm-host built no `flexarm`".to_owned())
}

/// Compiler flags that replace the paths of this machine, for `CARGO_ENCODED_RUSTFLAGS`.
pub fn remapped_paths(workspace: &Workspace) -> Result<OsString, String> {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home
        .or_else(|| env::home_dir().map(|home| home.join(".cargo")))
        .ok_or("neither CARGO_HOME nor a home folder is known")?;
    let mut flags = OsString::new();
    for (path, name) in [(home, "cargo"), (workspace.path(""), "flexarm")] {
        if !flags.is_empty() {
            flags.push("\x1f");
        }
        flags.push("--remap-path-prefix=");
        flags.push(path);
        flags.push(format!("={name}"));
    }
    Ok(flags)
}

/// What `cargo metadata` says of the workspace and its dependencies for these targets.
pub fn metadata(workspace: &Workspace, triples: &[&str]) -> Result<Value, String> {
    let mut cargo = command(workspace);
    cargo.args(["metadata", "--format-version", "1"]);
    for triple in triples {
        cargo.args(["--filter-platform", triple]);
    }
    let output = cargo
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err("cargo metadata failed".to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))
}
