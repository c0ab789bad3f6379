//! Mistakes in experiments: `flexarm run` names file, line and key of each before the first run.
#![cfg(target_os = "linux")]

mod common;

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

/// Right, wrong, and how the message begins: first what is read, then what is looked up in the FMUs.
const MISTAKES: &[(&str, &str, &str)] = &[
    ("title = \"T\"\n", "", "e.toml:1: missing field `title`"),
    (
        "until = 3",
        "until = ",
        "e.toml:6: common.until: string values must be quoted",
    ),
    (
        "until = 3",
        "until = 3\nuntil = 4",
        "e.toml:7: common.until: duplicate key",
    ),
    (
        "until = 3",
        "untill = 3",
        "e.toml:6: common.untill: unknown field `untill`",
    ),
    (
        "until = 3",
        "until = true",
        "e.toml:6: common.until: invalid type: boolean `true`",
    ),
    (
        "until = 3",
        "until = -1",
        "e.toml:6: common.until = -1: expected a time in [0.5, 5e8] s",
    ),
    (
        "step = 0.5",
        "step = 0",
        "e.toml:7: common.step = 0: expected a positive time in s",
    ),
    (
        "step = 0.5",
        "record = 0",
        "e.toml:7: common.record = 0: expected at least 1",
    ),
    (
        "until = 3\nstep = 0.5",
        "until = 1e5\nstep = 1e-4",
        "e.toml:15: run \"a, weak\": record = 1000000000 rows of 6 values: expected at most 536870912",
    ),
    (
        "step = 0.5",
        "order = \"both\"",
        "e.toml:7: common.order: unknown variant `both`",
    ),
    (
        "c.fmu",
        "x.fmu",
        "e.toml:3: common.controller: x.fmu cannot be read: ",
    ),
    (
        "p.fmu",
        "m.toml",
        "e.toml:4: common.plant: m.toml is not an FMU",
    ),
    (
        "plant = \"p.fmu\"\n",
        "",
        "e.toml:13: run: the run has no plant: name its FMU",
    ),
    (
        "m.toml",
        "x.toml",
        "e.toml:5: common.connections: cannot read x.toml: ",
    ),
    (
        "connections = \"m.toml\"\n",
        "",
        "e.toml:14: run \"a, weak\": no output of one FMU has the name of an input",
    ),
    (
        "m.toml",
        "from.toml",
        "from.toml:2: connection.from: plant has no variable z",
    ),
    (
        "m.toml",
        "factor.toml",
        "factor.toml:5: connection.factor = 0: expected a finite number that is not 0",
    ),
    (
        "step = 0.5",
        "parameters = [\n\"right.ssv\",\n\"x.ssv\"]",
        "e.toml:9: common.parameters: cannot read x.ssv: ",
    ),
    (
        "step = 0.5",
        "parameters = [\"unit.ssv\"]",
        "unit.ssv:4: u is given in mm, but its unit is rad",
    ),
    (
        "step = 0.5",
        "setpoints = \"x.csv\"",
        "e.toml:7: common.setpoints: cannot read x.csv: ",
    ),
    (
        "step = 0.5",
        "setpoints = \"bytes.csv\"",
        "e.toml:7: common.setpoints: bytes.csv is not text in UTF-8",
    ),
    (
        "step = 0.5",
        "setpoints = \"push.csv\"",
        "push.csv:1: neither FMU has a variable push",
    ),
    (
        "step = 0.5",
        "setpoints = \"right.csv\"",
        "e.toml:7: common.setpoints: right.csv: the setpoint is connected to no input",
    ),
    (
        "step = 0.5",
        "sequence = { every = 1, setpoints = [1] }",
        "e.toml:7: common.sequence: the setpoint is connected to no input",
    ),
    (
        "step = 0.5",
        "sequence = { every = 0, setpoints = [1] }",
        "e.toml:7: common.sequence.every = 0: expected a positive time in s",
    ),
    (
        "step = 0.5",
        "sequence = { every = 1, setpoints = [1,\n nan] }",
        "e.toml:8: common.sequence.setpoints: setpoint = \"NaN\": expected a finite number",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\"], rows = [[0, 1],\n [1]] }",
        "e.toml:8: common.schedule.rows: 1 values, but the header names 2 columns",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\", \"push\"], rows = [[0, 1, 2]] }",
        "e.toml:7: common.schedule.columns: neither FMU has a variable push",
    ),
    (
        "step = 0.5",
        "schedule = { columns = [\"time\", \"setpoint\"], rows = [[0, \"x\"]] }",
        "e.toml:7: common.schedule.rows: invalid type: string \"x\"",
    ),
    (
        "step = 0.5",
        "setpoints = \"a.csv\"\nsequence = { every = 1, setpoints = [1] }",
        "e.toml:2: common: only one of setpoints, schedule and sequence",
    ),
    (
        "gain = 2",
        "gian = 2",
        "e.toml:9: common.set: neither FMU has a variable gian, did you mean gain?",
    ),
    (
        "gain = 2",
        "\"plant:gian\" = 2",
        "e.toml:9: common.set: plant has no variable gian, did you mean gain?",
    ),
    (
        "gain = 2",
        "gain = 11",
        "e.toml:9: common.set: gain = 11: must be in [-10, 10]",
    ),
    (
        "gain = 2",
        "gain = nan",
        "e.toml:9: common.set: gain = \"NaN\": expected a finite number",
    ),
    (
        "gain = 2",
        "gain = 1979-05-27",
        "e.toml:9: common.set: gain: expected a number",
    ),
    (
        "gain = 2",
        "vector = 1",
        "e.toml:9: common.set: vector is an array: use its elements vector[1] to vector[3]",
    ),
    (
        "gain = 2",
        "flag = true",
        "e.toml:9: common.set: plant.flag is an output that cannot be set",
    ),
    (
        "step = 0.5",
        "name = \"x\"",
        "e.toml:7: common.name: name belongs to runs and variants",
    ),
    (
        "name = \"weak\"",
        "",
        "e.toml:10: variant: missing field `name`",
    ),
    (
        "name = \"strong\"",
        "name = \"weak\"",
        "e.toml:15: run \"a, weak\": \"a-weak\" is the name of another run",
    ),
    (
        "name = \"a\"",
        "name = \"\"",
        "e.toml:15: run.name: \"\" names no folder",
    ),
    (
        "max_abs(plant.y)",
        "maxabs(plant.y)",
        "e.toml:18: expect.quantity: \"maxabs(plant.y)\" is no quantity",
    ),
    (
        "max_abs(plant.y)",
        "max_abs(plant.x)",
        "e.toml:18: expect.quantity: no column plant.x is recorded",
    ),
    (
        "max_abs(plant.y)",
        "plans.done",
        "e.toml:18: expect.quantity: plans have no status \"done\"",
    ),
    (
        "[\"a, strong\"]",
        "[\"a\"]",
        "e.toml:19: expect.of: there is no run \"a\"; there are: \"a, weak\", \"a, strong\"",
    ),
    (
        "of = [\"a, strong\"]",
        "",
        "e.toml:17: expect.name: there is no run \"ratio\"",
    ),
    (
        "[\"a, strong\"]",
        "[]",
        "e.toml:19: expect.of: names no run",
    ),
    (
        "paper = 4",
        "tolerance = 1",
        "e.toml:20: expect.tolerance: needs the figure that it is about",
    ),
    (
        "paper = 4",
        "paper = 0\npaper_tolerance = 1",
        "e.toml:21: expect.paper_tolerance: nothing but 0 deviates from 0",
    ),
    (
        "paper = 4",
        "paper = 4\ntolerance = -1",
        "e.toml:21: expect.tolerance = -1: expected a relative deviation, 0 or more",
    ),
    (
        "paper = 4",
        "paper = inf",
        "e.toml:20: expect.paper = inf: expected a finite number",
    ),
    (
        "paper = 4",
        "factor = 0",
        "e.toml:20: expect.factor = 0: expected a finite number that is not 0",
    ),
    (
        "paper = 4",
        "at_least = 2\nat_most = 1",
        "e.toml:21: expect.at_most = 1: expected at least at_least = 2",
    ),
    (
        "name = \"1\"",
        "name = \"1/2\"",
        "e.toml:22: figure.name: the name of a figure names its file",
    ),
    (
        "title = \"F\"",
        "title = \"F\"\nfrom = 2\nuntil = 1",
        "e.toml:25: figure.until = 1: expected more than from = 2",
    ),
    (
        "title = \"F\"",
        "title = \"F\"\nkind = \"frequency_response\"\nfrom = 0",
        "e.toml:25: figure.from = 0: expected a positive frequency in Hz",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.z\"",
        "e.toml:27: figure.panel.curves.y: no column plant.z is recorded, did you mean plant.y?",
    ),
    (
        "- controller.y\"",
        "- controller.z\", factor = 2",
        "e.toml:28: figure.panel.curves.y: no column controller.z is recorded",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", x = \"tme\"",
        "e.toml:27: figure.panel.curves.x: no column tme is recorded, did you mean time?",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", factor = nan",
        "e.toml:27: figure.panel.curves.factor = NaN: expected a finite number that is not 0",
    ),
    (
        "y = \"plant.y\"",
        "y = \"plant.y\", style = \"dots\"",
        "e.toml:27: figure.panel.curves.style: unknown variant `dots`",
    ),
    (
        "run = \"a, strong\"",
        "run = \"b\"",
        "e.toml:28: figure.panel.curves.run: there is no run \"b\"",
    ),
];

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
    for (right, wrong, message) in MISTAKES {
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
