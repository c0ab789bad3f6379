//! The command line as a user meets it.
#![cfg(target_os = "linux")]

mod common;

use common::cli::*;
use common::*;
use std::fs;

#[test]
fn a_pair_of_both_versions_runs_and_is_recorded() {
    let folder = folder();
    let sets = [
        "--until",
        "2",
        "-o",
        "out",
        "--set",
        "gain=2",
        "--set",
        "plant:gain=3",
    ];
    let output = run(folder.path(), &sets);
    assert!(output.status.success(), "{}", errors(&output));
    let found = errors(&output);
    assert!(found.ends_with("out/report.html\n"), "{found}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.starts_with(
            "Mock (FMI 2.0) with Mock (FMI 3.0), sequential, communication step 500 ms"
        ),
        "{table}"
    );
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    // Controller 2·(y + 1), plant 3 times that: y = 0, 6, 42, 258; the angle of the score is twice as large.
    assert_eq!(
        read("results.csv"),
        "time,setpoint,plant.y,plant.flag,controller.y,controller.flag\n\
         0,0,0,1,2,1\n0.5,0,6,1,14,1\n1,0,42,1,86,1\n1.5,0,258,1,518,1\n"
    );
    let summary: host::run::summary::Summary = serde_json::from_str(&read("summary.json")).unwrap();
    let expected = 2000.0 * 4.0 * (6.0f64.powi(2) + 42.0f64.powi(2) + 258.0f64.powi(2));
    assert_eq!(summary.score.squared_error_rad2, Some(expected));
    assert_eq!(summary.steps, 4);
    assert_eq!(summary.given.assignments, ["gain=2", "plant:gain=3"]);
    let report = read("report.html");
    assert!(report.contains("Mock (FMI 2.0)") && report.contains("Mock (FMI 3.0)"));
    assert!(read("log.txt").contains("controller: Ok: 100% ready"));

    // What the controller makes of a row is in the next one, when the plant gets it.
    let side_by_side = [&sets[..], &["--order", "side-by-side"]].concat();
    let output = run(folder.path(), &side_by_side);
    assert!(output.status.success(), "{}", errors(&output));
    assert_eq!(
        read("results.csv"),
        "time,setpoint,plant.y,plant.flag,controller.y,controller.flag\n\
         0,0,0,1,0,1\n0.5,0,0,1,2,1\n1,0,6,1,2,1\n1.5,0,6,1,14,1\n"
    );
    let output = run(
        folder.path(),
        &[&side_by_side[..], &["--record", "2"]].concat(),
    );
    assert!(output.status.success(), "{}", errors(&output));
    let rows = read("results.csv");
    assert!(rows.ends_with("\n0,0,0,1,0,1\n1,0,6,1,2,1\n"), "{rows}");
}

#[test]
fn setpoints_drive_inputs_too() {
    let folder = folder();
    fs::write(
        folder.path().join("s.csv"),
        "time,setpoint,plant.u\n0,1,5\n1,2,7\n",
    )
    .unwrap();
    fs::write(
        folder.path().join("m.toml"),
        format!(
            "[[connection]]\nfrom = \"setpoint\"\nto = \"controller.u\"\nfactor = 10.0\n{ROLE}"
        ),
    )
    .unwrap();
    let output = run(folder.path(), &["--setpoints", "s.csv", "-o", "out"]);
    assert!(output.status.success(), "{}", errors(&output));
    let csv = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert_eq!(
        csv,
        "time,setpoint,plant.u,plant.y,plant.flag,controller.y,controller.flag\n\
         0,1,5,0,1,10,1\n0.5,1,5,5,1,10,1\n1,2,7,5,1,20,1\n1.5,2,7,7,1,20,1\n"
    );
    let output = run(folder.path(), &["--setpoints", "s.csv", "--until", "1"]);
    let found = errors(&output);
    assert!(
        found.contains("warning: setpoints go on to 1 s, but the run ends at 1 s"),
        "{found}"
    );
    let taken = "[[connection]]\nfrom = \"setpoint\"\nto = \"controller.u\"\n[[connection]]\nfrom = \"controller.y\"\nto = \"plant.u\"\n";
    fs::write(folder.path().join("m.toml"), format!("{taken}{ROLE}")).unwrap();
    let output = run(folder.path(), &["--setpoints", "s.csv"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        errors(&output),
        "error: s.csv:1: plant.u already has a source\n"
    );
}

#[test]
fn a_run_that_fails_says_why_and_keeps_what_it_has_as_partial() {
    let folder = folder();
    for (fault, reason) in [
        (
            FAIL,
            "error: plant: fmi3DoStep returned Error at t = 1 s\n  none failed at 1 [logStatusError]\n",
        ),
        (DIE, "error: plant: fmi3DoStep returned Fatal at t = 1 s\n"),
        (END, "error: plant ended the simulation at t = 1 s\n"),
        (
            NOT_A_NUMBER,
            "error: plant.y is NaN at t = 1.5 s: not a finite number\n",
        ),
    ] {
        let fault = format!("plant:fault={fault}");
        let output = run(
            folder.path(),
            &[
                "--until",
                "3",
                "--set",
                &fault,
                "--set",
                "plant:fault_time=1",
                "-o",
                "out/deep",
            ],
        );
        assert_eq!(output.status.code(), Some(1));
        assert!(errors(&output).ends_with(reason), "{}", errors(&output));
        assert!(output.stdout.is_empty());
        let out = folder.path().join("out/deep");
        assert!(!out.join("results.csv").exists());
        let rows = fs::read_to_string(out.join("results-partial.csv")).unwrap();
        assert!(rows.lines().count() >= 3, "{rows}");
        let summary = fs::read_to_string(out.join("summary-partial.json")).unwrap();
        let summary: host::run::summary::Summary = serde_json::from_str(&summary).unwrap();
        let stopped = summary.stopped.unwrap();
        assert_eq!(stopped.planned_s, 3.0);
        assert_eq!(format!("error: {}\n", stopped.reason), reason);
    }
}

#[test]
fn wrong_usage_and_input_exit_with_2() {
    let folder = folder();
    for (arguments, reason) in [
        (
            vec!["--until", "0"],
            "--until = 0: expected a time in [0.5, 5e8] s",
        ),
        (vec!["--until", "-1"], "--until = -1: expected a time in"),
        (vec!["--until", "nan"], "--until = NaN: expected a time in"),
        (vec!["--record", "0"], "--record = 0: expected at least 1"),
        (
            vec!["--set", "gain=11"],
            "--set: gain = 11: must be in [-10, 10]",
        ),
        (
            vec!["--set", "gian=1"],
            "--set: neither FMU has a variable gian, did you mean gain?",
        ),
        (vec!["--set", "gain"], "NAME=VALUE"),
        (
            vec!["--parameters", "plant=nothing.ssv"],
            "cannot read nothing.ssv",
        ),
        (
            vec!["--setpoints", "nothing.csv"],
            "cannot read nothing.csv",
        ),
        (
            vec!["--order", "random"],
            "possible values: sequential, side-by-side",
        ),
        (vec!["-o", "c.fmu"], "cannot write c.fmu"),
    ] {
        let output = run(folder.path(), &arguments);
        let found = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{found}");
        assert!(
            found.starts_with("error: ") && found.contains(reason),
            "{found}"
        );
    }
    let pair = ["simulate", "--controller", "c.fmu", "--plant", "p.fmu"];
    let step = ["--connections", "m.toml", "--step", "-1"];
    let output = flexarm(folder.path(), &[&pair[..], &step].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("--step = -1: expected a positive time"));
    let output = flexarm(folder.path(), &pair);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("controller inputs: u\n  controller outputs: y, flag"),
        "{}",
        errors(&output)
    );
    fs::write(folder.path().join("c.fmu"), "no zip").unwrap();
    let output = run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).starts_with("error: c.fmu is not an FMU, which is a zip file"));
}

#[test]
fn an_fmu_is_shown() {
    let folder = folder();
    let output = flexarm(folder.path(), &["inspect", "."]);
    assert_eq!(
        errors(&output),
        "error: . is a folder, not an FMU, which is a zip file\n"
    );
    let output = flexarm(folder.path(), &["inspect", "p.fmu"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    for expected in [
        "FMI version",
        "3.0",
        "Co-Simulation",
        platform(3),
        "variable communication step",
        "9 variables:",
        "Structural parameters",
        "vector[size]",
        "-10 .. 10",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let help = flexarm(folder.path(), &["simulate", "--help"]);
    assert!(String::from_utf8_lossy(&help.stdout).contains("Examples:"));
}
