//! Build script of the FMU crates: checks `modelDescription/<unit>.xml` and makes the Rust
//! variables of the crate `flexarm-fmu-<unit>` from it.

use std::path::Path;
use std::process::ExitCode;
use std::{env, fs};

fn main() -> ExitCode {
    match generate() {
        Ok(()) => ExitCode::SUCCESS,
        Err(messages) => {
            eprintln!("{messages}");
            ExitCode::FAILURE
        }
    }
}

fn generate() -> Result<(), String> {
    let variable = |name: &str| env::var(name).map_err(|e| format!("{name}: {e}"));
    let package = variable("CARGO_PKG_NAME")?;
    let unit = package
        .strip_prefix("flexarm-fmu-")
        .ok_or_else(|| format!("package `{package}` is not called flexarm-fmu-<unit>"))?;
    let file = format!("modelDescription/{unit}.xml");
    let path = Path::new("..").join(&file);
    println!("cargo::rerun-if-changed={}", path.display());
    println!("cargo::rerun-if-changed=../build.rs");
    let text = fs::read_to_string(&path).map_err(|e| format!("{file}: {e}"))?;
    let description = model_description::read(&text, &file).map_err(|diagnostics| {
        let lines: Vec<_> = diagnostics.iter().map(ToString::to_string).collect();
        lines.join("\n")
    })?;
    let output = Path::new(&variable("OUT_DIR")?).join("variables.rs");
    fs::write(&output, model_description::rust::generate(&description))
        .map_err(|e| format!("{}: {e}", output.display()))
}
