//! Mistakes in experiments: `flexarm run` names file, line and key of each before the first run.
#![cfg(target_os = "linux")]

#[path = "../common/mod.rs"]
mod common;
mod rows;
mod runs;

use common::cli::*;
use common::*;
use std::fs;

/// Line 1 is `title`.
const EXPERIMENT: &str = r#"title = "T"
[common]
controller = "c.fmu"
plant = "p.fmu"
connections = "m.toml"
until = 3
step = 0.5
[common.set]
gain = 2
[[variant]]
name = "weak"
[[variant]]
name = "strong"
[[run]]
name = "a"
[[expect]]
name = "ratio"
quantity = "max_abs(plant.y)"
of = ["a, strong"]
paper = 4
[[figure]]
name = "1"
title = "F"
[[figure.panel]]
axis = "y"
curves = [
  { run = "a, weak", y = "plant.y", name = "n" },
  { run = "a, strong", y = "plant.y - controller.y", name = "n" },
]
"#;

/// Right, wrong, and how the message begins.
type Mistake = (&'static str, &'static str, &'static str);

#[test]
fn file_line_and_key_are_named_before_the_first_run() {
    let folder = folder();
    let file = |name: &str, text: &[u8]| fs::write(folder.path().join(name), text).unwrap();
    file(
        "from.toml",
        CONNECTIONS.replace("plant.y", "plant.z").trim().as_bytes(),
    );
    let factor = CONNECTIONS.replace("offset = 1.0", "offset = 1.0\nfactor = 0.0");
    file("factor.toml", factor.trim().as_bytes());
    file("right.csv", b"time,setpoint\n0,1\n");
    file("push.csv", b"time,setpoint,push\n0,1,1\n");
    file("bytes.csv", &[0xff, 0xfe]);
    let set = |unit: &str| {
        format!(
            "<ssv:ParameterSet version=\"1.0\" name=\"s\" xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\"\n \
             xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\">\n<ssv:Parameters>\n\
             <ssv:Parameter name=\"u\"><ssv:Real value=\"1\" unit=\"{unit}\"/></ssv:Parameter></ssv:Parameters>\n\
             <ssv:Units><ssc:Unit name=\"{unit}\"><ssc:BaseUnit/></ssc:Unit></ssv:Units></ssv:ParameterSet>\n"
        )
    };
    file("right.ssv", set("rad").as_bytes());
    file("unit.ssv", set("mm").as_bytes());
    let mut other = String::new();
    for (right, wrong, message) in runs::MISTAKES.iter().chain(rows::MISTAKES) {
        assert!(EXPERIMENT.contains(right), "{right}");
        file("e.toml", EXPERIMENT.replacen(right, wrong, 1).as_bytes());
        let output = flexarm(folder.path(), &["run", "e.toml", "-o", "out"]);
        let found = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{found}");
        if !found.starts_with(&format!("error: {message}")) {
            other += &format!("{found}not    {message}\n\n");
        }
        assert!(!folder.path().join("out/e").exists());
    }
    assert!(other.is_empty(), "{other}");
}

/// What all runs have in common is wrong once, not once a run; several mistakes are told together.
#[test]
fn every_mistake_is_told_once() {
    let folder = folder();
    let run = |text: String| {
        fs::write(folder.path().join("e.toml"), text).unwrap();
        errors(&flexarm(folder.path(), &["run", "e.toml"]))
    };
    let found = run(EXPERIMENT
        .replace("c.fmu", "x.fmu")
        .replace("p.fmu", "y.fmu"));
    let lines: Vec<_> = found.lines().collect();
    assert_eq!(lines.len(), 2, "{found}");
    assert!(lines[1].starts_with("  e.toml:4: common.plant: y.fmu cannot be read"));
    let found = run(EXPERIMENT.replace("gain = 2", "gain = 11\nfault_time = nan"));
    assert_eq!(
        found,
        "error: e.toml:10: common.set: fault_time = \"NaN\": expected a finite number\n  \
         e.toml:9: common.set: gain = 11: must be in [-10, 10]\n"
    );
}

/// What only the FMU knows is told when the run begins, with the place of the run.
#[test]
fn a_refusal_of_the_fmu_names_the_run() {
    let folder = folder();
    let fault = format!("\"plant:fault\" = {REFUSE_START}");
    let text = EXPERIMENT.replace("gain = 2", &fault);
    fs::write(folder.path().join("e.toml"), text).unwrap();
    let output = flexarm(folder.path(), &["run", "e.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let found = errors(&output);
    let first = "e.toml:15: run \"a, weak\": plant cannot be set up: ";
    assert!(found.contains(first), "{found}");
}
