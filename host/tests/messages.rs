//! What a run says of itself: refusals, warnings, interruption.
#![cfg(target_os = "linux")]

mod common;

use common::cli::*;
use common::*;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn values_that_an_fmu_refuses_are_input() {
    let folder = folder();
    for (side, message) in [
        (
            "controller",
            "error: controller cannot be set up: gain = 7 is too much\n",
        ),
        (
            "plant",
            "error: plant cannot be set up: fmi3ExitInitializationMode returned Error\n",
        ),
    ] {
        let fault = format!("{side}:fault={REFUSE_START}");
        let output = run(
            folder.path(),
            &["--set", &fault, "--set", "gain=7", "-o", "out"],
        );
        assert_eq!(errors(&output), message);
        assert_eq!(output.status.code(), Some(2));
    }
}

#[test]
fn setpoints_need_an_input_and_an_angle() {
    let folder = folder();
    let file = |name, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("s.csv", "time,setpoint\n0,1\n1,2\n");
    let refused = |reason| {
        let output = run(folder.path(), &["--setpoints", "s.csv"]);
        assert_eq!(
            errors(&output),
            format!("error: s.csv: {reason}: name it in a file for --connections\n")
        );
        assert_eq!(output.status.code(), Some(2));
    };
    refused("the setpoint is connected to no input");
    file(
        "m.toml",
        "[[connection]]\nfrom = \"setpoint\"\nto = \"controller.u\"\n",
    );
    refused("no signal plays the role of the angle");
}

#[test]
fn a_value_for_a_connected_input_is_not_lost_in_silence() {
    let folder = folder();
    let output = run(
        folder.path(),
        &["--set", "controller:u=0.5", "--until", "1"],
    );
    assert!(output.status.success(), "{}", errors(&output));
    assert!(
        errors(&output)
            .contains("warning: controller.u = 0.5 is not used: it is connected to plant.y\n"),
        "{}",
        errors(&output)
    );
}

#[test]
fn what_is_not_scored_has_no_score() {
    let folder = folder();
    let connections = CONNECTIONS.replace("plant.y\"\nto", "setpoint\"\nto");
    fs::write(folder.path().join("m.toml"), connections).unwrap();
    fs::write(folder.path().join("s.csv"), "time,setpoint\n0,1\n9,2\n").unwrap();
    let output = run(folder.path(), &["--setpoints", "s.csv", "--until", "2"]);
    assert!(output.status.success(), "{}", errors(&output));
    assert!(
        errors(&output).contains("warning: nothing is scored: "),
        "{}",
        errors(&output)
    );
    let table = String::from_utf8(output.stdout).unwrap();
    let row = table
        .lines()
        .find(|line| line.contains("squared error"))
        .unwrap();
    assert_eq!(
        row.replace(['│', '┆'], " ").split_whitespace().nth(4),
        Some("-"),
        "{row}"
    );
    fs::write(folder.path().join("s.csv"), "time,setpoint\n0,1e200\n").unwrap();
    let output = run(folder.path(), &["--setpoints", "s.csv", "--until", "2"]);
    assert_eq!(
        errors(&output),
        "error: the squared error is inf at t = 2 s: not a finite number\n"
    );
}

#[test]
fn warnings_of_an_fmu_are_shown_without_asking() {
    let folder = folder();
    let declared = |categories: &[&str]| {
        let list: String = categories
            .iter()
            .map(|name| format!("<Category name=\"{name}\"/>"))
            .collect();
        for (name, version) in [("c.fmu", 2), ("p.fmu", 3)] {
            let text = description(version).replace(
                "<ModelVariables>",
                &format!("<LogCategories>{list}</LogCategories><ModelVariables>"),
            );
            pack_mock(&folder.path().join(name), version, &text, binary());
        }
        let fault = format!("fault={WARN}");
        let output = run(folder.path(), &["--until", "1", "--set", &fault]);
        assert!(output.status.success(), "{}", errors(&output));
        let text = errors(&output);
        ["controller", "plant"].map(|side| {
            let line = format!("{side}: Warning: warm at 0.5 [logStatusWarning]");
            text.lines().any(|l| l == line)
        })
    };
    assert_eq!(declared(&["logStatusWarning", "logEvents"]), [true, true]);
    assert_eq!(declared(&["logEvents"]), [false, false]);
    // The mock refuses that category, and the instance that was asked cannot be used any more.
    assert_eq!(
        declared(&["logStatusWarning", "logStatusFatal"]),
        [false, false]
    );
}

/// Starts the command, interrupts it after a second, and says what it leaves. Steps that take long are no reason to wait.
fn interrupted(folder: &Path, arguments: &[&str]) -> String {
    let child = Command::new(env!("CARGO_BIN_EXE_flexarm"))
        .args(arguments)
        .current_dir(folder)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(1));
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    let sent = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(
        sent.elapsed() < Duration::from_secs(5),
        "{:?}",
        sent.elapsed()
    );
    assert_eq!(output.status.code(), Some(1));
    errors(&output)
}

/// A run that is interrupted leaves its samples until then, marked as partial.
fn assert_partial(out: &Path) {
    let mut names: Vec<_> = fs::read_dir(out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.retain(|name| name != "log.txt");
    assert!(
        names.iter().all(|name| name.contains("-partial.")),
        "{names:?}"
    );
    let rows = fs::read_to_string(out.join("results-partial.csv")).unwrap();
    assert!((2..20).contains(&rows.lines().count()), "{rows}");
    let summary = fs::read_to_string(out.join("summary-partial.json")).unwrap();
    assert!(
        summary.contains("\"reason\": \"interrupted at t = "),
        "{summary}"
    );
}

#[test]
fn an_interrupt_ends_a_run_within_a_step() {
    let folder = folder();
    let slow = format!("plant:fault={SLOW}");
    let arguments = [&RUN[..], &["--until", "100", "--set", &slow, "-o", "out"]].concat();
    let found = interrupted(folder.path(), &arguments);
    assert!(found.contains("error: interrupted at t = "), "{found}");
    assert_partial(&folder.path().join("out"));
}

#[test]
fn an_interrupt_ends_all_runs_of_an_experiment() {
    let folder = folder();
    let text = format!(
        "title = \"T\"\n[common]\ncontroller = \"c.fmu\"\nplant = \"p.fmu\"\nconnections = \"m.toml\"\nuntil = 100\n\
         step = 0.5\nset = {{ \"plant:fault\" = {SLOW} }}\n[[run]]\nname = \"a\"\n[[run]]\nname = \"b\"\n"
    );
    fs::write(folder.path().join("e.toml"), text).unwrap();
    let found = interrupted(folder.path(), &["run", "e.toml", "-j", "1", "-o", "out"]);
    assert!(found.contains("e, a: interrupted at t = "), "{found}");
    assert_partial(&folder.path().join("out/e/a"));
    assert!(
        !folder.path().join("out/e/b").exists() && !folder.path().join("out/index.html").exists()
    );
}

#[test]
fn progress_may_stop_a_run_at_every_step_and_at_its_end() {
    let folder = folder();
    let mut simulation =
        host::Simulation::new(folder.path().join("c.fmu"), folder.path().join("p.fmu"));
    simulation.connections = Some(folder.path().join("m.toml"));
    (simulation.step, simulation.until) = (0.5, Some(2.0));
    for stop in 0..=4 {
        let mut calls = 0;
        let outcome = host::simulate(&simulation, &mut |done| {
            assert_eq!(done, f64::from(calls) / 4.0);
            calls += 1;
            if calls > stop {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let message = outcome.unwrap_err().to_string();
        assert_eq!(
            message,
            format!("interrupted at t = {} s", 0.5 * f64::from(stop))
        );
    }
}
