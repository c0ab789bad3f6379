//! FMUs that would fill disk or memory.
#![cfg(target_os = "linux")]

mod common;

use common::*;
use host::fmu::{Error, Fmu, Limits, Problem};
use std::fs;

#[test]
fn descriptions_that_ask_for_too_much_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.fmu");
    let array = "<Dimension valueReference=\"8\"/>";
    for (dimensions, size) in [
        ("<Dimension start=\"90000000000\"/>", "90000000000"),
        (
            "<Dimension start=\"4294967296\"/><Dimension start=\"4294967296\"/>",
            "4294967296 x 4294967296",
        ),
    ] {
        pack_mock(&file, 3, &description(3).replace(array, dimensions), b"");
        let message = Fmu::open(&file).unwrap_err().to_string();
        let reason = format!("vector has {size} elements, at most 1048576 are admitted");
        assert!(message.ends_with(&reason), "{message}");
    }
    let padding = " ".repeat(64 << 20) + "<ModelVariables>";
    let text = description(2).replace("<ModelVariables>", &padding);
    pack_mock(&file, 2, &text, b"");
    let message = Fmu::open(&file).unwrap_err().to_string();
    assert!(
        message.contains("modelDescription.xml has 6711")
            && message.ends_with("at most 67108864 are admitted"),
        "{message}"
    );
}

#[test]
fn hostile_archives_are_refused_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("m.fmu");
    pack(&file, &[("../../evil.txt", b"x")]);
    assert!(matches!(
        Fmu::open(&file).unwrap_err(),
        Error::Archive {
            problem: Problem::UnsafeName { .. },
            ..
        }
    ));
    let bomb = vec![0; 64 << 20];
    pack(&file, &[("resources/bomb", &bomb)]);
    assert!(fs::metadata(&file).unwrap().len() < 1 << 20);
    let limits = Limits {
        total: 32 << 20,
        ..Limits::default()
    };
    assert!(matches!(
        Fmu::open_within(&file, &limits).unwrap_err(),
        Error::Archive {
            problem: Problem::TotalSize { .. },
            ..
        }
    ));
}
