//! Makes FMUs for tests: `mock.c`, compiled once and packed with a description of either version.

#![allow(dead_code, reason = "each test binary uses a part")]

pub mod cli;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Faults of `mock.c`.
pub const FAIL: i32 = 1;
pub const DIE: i32 = 2;
pub const REFUSE_STEP: i32 = 3;
pub const ODD_STATUS: i32 = 4;
pub const END: i32 = 5;
pub const RETURN_EARLY: i32 = 6;
pub const ASYNCHRONOUS: i32 = 7;
pub const NOT_A_NUMBER: i32 = 8;
pub const WARN: i32 = 9;
pub const SLOW: i32 = 10;
pub const REFUSE_START: i32 = 11;

const SUFFIX: &str = std::env::consts::DLL_SUFFIX;

/// Compiles C into a shared library.
pub fn compile(source: &Path, to: &Path, arguments: &[&str]) {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let status = Command::new(compiler)
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(to)
        .arg(source)
        .args(arguments)
        .status()
        .unwrap();
    assert!(status.success());
}

/// The binary of the mock.
pub fn binary() -> &'static [u8] {
    static BINARY: OnceLock<Vec<u8>> = OnceLock::new();
    BINARY.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("mock.so");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/common/mock.c");
        compile(&source, &library, &["-lm"]);
        fs::read(library).unwrap()
    })
}

/// Description of the mock, FMI 2.0 or 3.0.
pub fn description(version: u32) -> String {
    let variables = [
        ("u", "input", "continuous", "start=\"0\" unit=\"rad\""),
        ("y", "output", "continuous", "unit=\"rad\""),
        (
            "gain",
            "parameter",
            "fixed",
            "start=\"1\" min=\"-10\" max=\"10\"",
        ),
        ("fault", "parameter", "fixed", "start=\"0\""),
        ("fault_time", "parameter", "fixed", "start=\"0\" unit=\"s\""),
        ("flag", "output", "discrete", ""),
        ("label", "parameter", "fixed", "start=\"none\""),
    ];
    let types = if version == 2 {
        [
            "Real", "Real", "Real", "Integer", "Real", "Boolean", "String",
        ]
    } else {
        [
            "Float64", "Float64", "Float64", "Int32", "Float64", "Boolean", "String",
        ]
    };
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let (token, fmi) = if version == 2 {
        ("guid", "2.0")
    } else {
        ("instantiationToken", "3.0")
    };
    xml += &format!(
        "<fmiModelDescription fmiVersion=\"{fmi}\" modelName=\"Mock\" {token}=\"mock-token\">\n"
    );
    xml += "<CoSimulation modelIdentifier=\"mock\" canHandleVariableCommunicationStepSize=\"true\"/>\n<ModelVariables>\n";
    for (reference, ((name, causality, variability, rest), kind)) in
        variables.into_iter().zip(types).enumerate()
    {
        let head = format!(
            "name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" variability=\"{variability}\""
        );
        xml += &match (version, kind) {
            (2, _) => format!("<ScalarVariable {head}><{kind} {rest}/></ScalarVariable>\n"),
            (_, "String") => format!("<String {head}><Start value=\"none\"/></String>\n"),
            _ => format!("<{kind} {head} {rest}/>\n"),
        };
    }
    xml += &if version == 2 {
        "</ModelVariables>\n<ModelStructure><Outputs><Unknown index=\"2\"/><Unknown index=\"6\"/></Outputs><InitialUnknowns><Unknown index=\"2\"/><Unknown index=\"6\"/></InitialUnknowns></ModelStructure>\n".to_owned()
    } else {
        "<Float64 name=\"vector\" valueReference=\"7\" causality=\"parameter\" variability=\"fixed\" start=\"1\"><Dimension valueReference=\"8\"/></Float64>\n\
         <UInt64 name=\"size\" valueReference=\"8\" causality=\"structuralParameter\" variability=\"fixed\" start=\"3\" min=\"1\" max=\"8\"/>\n\
         </ModelVariables>\n<ModelStructure><Output valueReference=\"1\"/><Output valueReference=\"5\"/><InitialUnknown valueReference=\"1\"/><InitialUnknown valueReference=\"5\"/></ModelStructure>\n".to_owned()
    };
    xml + "</fmiModelDescription>\n"
}

/// Name of the platform's folder.
pub fn platform(version: u32) -> &'static str {
    match (version, std::env::consts::ARCH) {
        (2, "x86_64") => "linux64",
        (3, "x86_64") => "x86_64-linux",
        _ => "aarch64-linux",
    }
}

/// Packs an FMU of any content.
pub fn pack(file: &Path, entries: &[(&str, &[u8])]) {
    let mut zip = ZipWriter::new(fs::File::create(file).unwrap());
    for (name, content) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(content).unwrap();
    }
    zip.finish().unwrap();
}

/// Packs the mock with another description and binary.
pub fn pack_mock(file: &Path, version: u32, description: &str, binary: &[u8]) {
    let name = format!("binaries/{}/mock{SUFFIX}", platform(version));
    pack(
        file,
        &[
            ("modelDescription.xml", description.as_bytes()),
            (&name, binary),
            ("resources/hello.txt", b"hello"),
        ],
    );
}

/// The mock as it should be.
pub fn mock(folder: &Path, version: u32) -> PathBuf {
    let file = folder.join(format!("mock {version} 100%.fmu"));
    pack_mock(&file, version, &description(version), binary());
    file
}
