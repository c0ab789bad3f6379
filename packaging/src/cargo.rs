//! Runs cargo and reads what it reports.

use crate::workspace::Workspace;
use serde_json::Value;
use std::collections::BTreeMap;
use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The cargo that runs us.
pub fn command(workspace: &Workspace) -> Command {
    workspace.command(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Builds packages in release. Returns the shared libraries and executables by target name.
pub fn build(
    workspace: &Workspace,
    packages: &[&str],
) -> Result<BTreeMap<String, PathBuf>, String> {
    let mut cargo = command(workspace);
    cargo.args([
        "build",
        "--release",
        "--message-format=json-render-diagnostics",
    ]);
    for package in packages {
        cargo.args(["--package", package]);
    }
    let output = cargo
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err(format!("building {} failed", packages.join(", ")));
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
        let shared = |name: &&str| name.ends_with(env::consts::DLL_SUFFIX);
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

/// What `cargo metadata` says of the workspace and its dependencies on this platform.
pub fn metadata(workspace: &Workspace, triple: &str) -> Result<Value, String> {
    let output = command(workspace)
        .args([
            "metadata",
            "--format-version",
            "1",
            "--filter-platform",
            triple,
        ])
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err("cargo metadata failed".to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))
}
