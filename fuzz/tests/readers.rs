//! Every reader on what it should accept, whole and damaged: a glance at what `cargo xtask fuzz` looks
//! at for as long as it is told to.

use std::fs;
use std::path::Path;

use fuzz::{pack, readers};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// What readers stumble over.
const WORDS: [&[u8]; 12] = [
    b"\"",
    b"<",
    b"/>",
    b"&#0;",
    b"NaN",
    b"1e999",
    b"-1",
    b"18446744073709551616",
    b"\n",
    b",",
    b"\0",
    b"\xff",
];

/// A damage.
#[derive(Clone, Debug)]
enum Edit {
    Insert(Index, &'static [u8]),
    Flip(Index, u8),
    Remove(Index, usize),
    Repeat(Index, usize),
    End(Index),
}

fn edit() -> impl Strategy<Value = Edit> {
    let at = any::<Index>;
    prop_oneof![
        (at(), select(&WORDS[..])).prop_map(|(at, word)| Edit::Insert(at, word)),
        (at(), 0..8_u8).prop_map(|(at, bit)| Edit::Flip(at, bit)),
        (at(), 1..40_usize).prop_map(|(at, count)| Edit::Remove(at, count)),
        (at(), 1..400_usize).prop_map(|(at, count)| Edit::Repeat(at, count)),
        at().prop_map(Edit::End),
    ]
}

fn damage(bytes: &mut Vec<u8>, edit: &Edit) {
    if bytes.is_empty() {
        return;
    }
    let length = bytes.len();
    let range = |at: &Index, count: usize| {
        let begin = at.index(length);
        begin..(begin + count).min(length)
    };
    match edit {
        Edit::Insert(at, word) => drop(bytes.splice(range(at, 0), word.iter().copied())),
        Edit::Flip(at, bit) => bytes[at.index(length)] ^= 1 << bit,
        Edit::Remove(at, count) => drop(bytes.drain(range(at, *count))),
        Edit::Repeat(at, count) => bytes.extend_from_within(range(at, *count)),
        Edit::End(at) => bytes.truncate(at.index(length)),
    }
}

/// A file of the project.
fn seed(path: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Hands the files over: whole, which must be accepted, and then with some damages.
fn look_at(target: fn(&[u8]) -> bool, files: &[Vec<u8>]) {
    for (index, file) in files.iter().enumerate() {
        assert!(target(file), "file {index}");
    }
    let inputs = (select(files.to_vec()), vec(edit(), 1..6));
    let config = ProptestConfig {
        cases: 200,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    proptest!(config, |((mut bytes, edits) in inputs)| {
        edits.iter().for_each(|edit| damage(&mut bytes, edit));
        target(&bytes);
    });
}

#[test]
fn archives() {
    let description = seed("modelDescription/tests/valid.xml");
    let whole = pack(&[("modelDescription.xml", &description)]);
    look_at(readers::archive, &[whole]);
}

#[test]
fn descriptions() {
    let files = [
        "modelDescription/tests/valid.xml",
        "fmi-unit/examples/fault.fmi2.xml",
    ];
    look_at(readers::description, &files.map(seed));
}

#[test]
fn parameter_sets() {
    look_at(readers::parameters, &[fuzz::PARAMETERS.to_vec()]);
}

#[test]
fn structures() {
    look_at(readers::structure, &[seed("fuzz/seeds/structure.ssd")]);
}

#[test]
fn tables() {
    let files = [
        "packaging/assets/tflex-setpoints.csv",
        "fuzz/seeds/measurement.csv",
    ];
    look_at(readers::table, &files.map(seed));
}

#[test]
fn connections_and_experiments() {
    let files = [
        "fuzz/seeds/connections.toml",
        "experiments/identification.toml",
    ];
    look_at(readers::toml, &files.map(seed));
}
