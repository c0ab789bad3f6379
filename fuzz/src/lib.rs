//! The fuzz targets. Each gives bytes that may be anything to one reader, by its public interface: it must return,
//! with a value or with an error that can be shown.
//!
//! `fuzz_targets/` hands them to libFuzzer (`cargo xtask fuzz`), `tests/` some inputs of each in every test run.
//! Only the former is built with debug assertions, and sees arithmetic that overflows.

pub mod readers;
pub mod snapshot;

use host::fmu::Fmu;
use host::input::Pair;
use std::fmt::Display;
use std::io::{Cursor, Write};
use std::path::PathBuf;
use std::sync::OnceLock;
use tempfile::TempDir;
use zip::write::{SimpleFileOptions, ZipWriter};

/// A parameter set that structures may bind.
pub const PARAMETERS: &[u8] = include_bytes!("../../modelDescription/parameters/pendulum.ssv");

const DESCRIPTIONS: [&[u8]; 2] = [
    include_bytes!("../../modelDescription/controller.xml"),
    include_bytes!("../../modelDescription/plant.xml"),
];

/// A file with this content; the next call of this thread with its name overwrites it.
pub fn file(name: &str, content: &[u8]) -> PathBuf {
    // One for each thread: tests run side by side.
    thread_local!(static FOLDER: TempDir = TempDir::new().expect("a temporary folder"));
    let path = FOLDER.with(|folder| folder.path().join(name));
    std::fs::write(&path, content).expect("a temporary file");
    path
}

/// An archive, not compressed.
pub fn pack(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, content) in entries {
        archive.start_file(*name, stored).expect("a valid name");
        archive.write_all(content).expect("memory");
    }
    archive.finish().expect("memory").into_inner()
}

/// The controller and the plant without binaries, as archives.
pub fn fmus() -> [&'static [u8]; 2] {
    static FMUS: OnceLock<[Vec<u8>; 2]> = OnceLock::new();
    let fmus = FMUS.get_or_init(|| DESCRIPTIONS.map(|xml| pack(&[("modelDescription.xml", xml)])));
    fmus.each_ref().map(Vec::as_slice)
}

/// Their descriptions.
pub fn pair() -> Pair<'static> {
    static OPENED: OnceLock<[Fmu; 2]> = OnceLock::new();
    let open = |bytes| Fmu::open(&file("ours.fmu", bytes)).expect("our own description");
    let [controller, plant] = OPENED.get_or_init(|| fmus().map(open));
    Pair::new(controller, plant)
}

/// The value; an error must have something to say.
pub fn judge<T, E: Display>(result: Result<T, E>) -> Option<T> {
    result
        .map_err(|error| assert!(!error.to_string().trim().is_empty()))
        .ok()
}
