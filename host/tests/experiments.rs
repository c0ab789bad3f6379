//! `flexarm run` as a user meets it.
#![cfg(target_os = "linux")]

mod common;

use common::cli::*;
use common::*;
use serde_json::Value;
use std::fs;
use std::path::Path;

const EXPERIMENT: &str = "
title = \"Gains & faults\"
source = \"nowhere\"
description = \"\"\"
First.

Second.\"\"\"
[common]
controller = \"c.fmu\"
plant = \"p.fmu\"
connections = \"m.toml\"
until = 3
step = 0.5
[common.set]
gain = 2
[[variant]]
name = \"weak\"
set = { \"plant:gain\" = 0.5 }
[[variant]]
name = \"strong\"
[[run]]
name = \"a/b\"
";

const FIGURES: &str = "
[[expect]]
name = \"ratio\"
quantity = \"max_abs(plant.y)\"
of = [\"a/b, strong\"]
over = [\"a/b, weak\"]
paper = 4
at_least = 1
factor = 10
unit = \"%\"
[[expect]]
name = \"shown only\"
quantity = \"last(time)\"
of = [\"a/b, weak\"]
[[figure]]
name = \"1\"
title = \"Angle\"
[[figure.panel]]
axis = \"y [rad]\"
curves = [{ run = \"a/b, weak\", y = \"plant.y - controller.y\", name = \"difference\", style = \"steps\" }]
";

fn write(folder: &Path, text: &str) {
    fs::write(folder.join("e.toml"), text).unwrap();
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn every_run_is_made_with_every_variant_and_shown() {
    let folder = folder();
    write(folder.path(), &format!("{EXPERIMENT}{FIGURES}"));
    let output = flexarm(folder.path(), &["run", "e.toml", "-o", "out", "-j", "2"]);
    assert!(output.status.success(), "{}", errors(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("Gains & faults\n") && text.contains("max_abs(plant.y) [%]"),
        "{text}"
    );

    let out = folder.path().join("out");
    let experiment = json(&out.join("e/experiment.json"));
    let runs = experiment["runs"].as_array().unwrap();
    let gains: Vec<_> = runs
        .iter()
        .map(|run| run["summary"]["given"]["assignments"].to_string())
        .collect();
    assert_eq!(gains, ["[\"gain=2\",\"plant:gain=0.5\"]", "[\"gain=2\"]"]);
    assert!(
        out.join("e/a-b-weak/results.csv").exists()
            && out.join("e/a-b-strong/summary.json").exists()
    );
    let rows = experiment["table"].as_array().unwrap();
    let ours = rows[0]["ours"].as_f64().unwrap();
    assert!((rows[0]["ratio"].as_f64().unwrap() - ours / 4.0).abs() < 1e-12 && ours > 10.0);
    assert_eq!(
        (&rows[0]["met"], &rows[1]["met"]),
        (&Value::Bool(true), &Value::Null)
    );
    assert_eq!(rows[1]["ours"], 2.5);

    let page = fs::read_to_string(out.join("index.html")).unwrap();
    for part in [
        "Gains &amp; faults",
        "<p>First.</p>\n<p>Second.</p>",
        "figures/e/1.svg",
        "1 expected figures, all met.",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let svg = fs::read_to_string(out.join("figures/e/1.svg")).unwrap();
    assert!(svg.contains("difference") && svg.contains("y [rad]"));
}

#[test]
fn a_missed_figure_has_an_exit_code_of_its_own() {
    let folder = folder();
    write(
        folder.path(),
        &format!(
            "{EXPERIMENT}{}",
            FIGURES.replace("at_least = 1", "at_least = 1e9")
        ),
    );
    let output = flexarm(folder.path(), &["run", "e.toml", "-o", "out"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("MISSED: ≥ 1000000000"));
    let page = fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(page.contains("1 missed") && page.contains("missed: ≥ 1000000000"));
}

#[test]
fn a_run_that_fails_leaves_the_others_alone() {
    let folder = folder();
    let fault = format!("set = {{ \"plant:fault\" = {FAIL}, \"plant:fault_time\" = 1 }}");
    let text = format!("{EXPERIMENT}{FIGURES}")
        .replace("name = \"strong\"", &format!("name = \"strong\"\n{fault}"));
    write(folder.path(), &text);
    let output = flexarm(folder.path(), &["run", "e.toml", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("e, a/b, strong: plant: fmi3DoStep returned Error at t = 1 s"),
        "{}",
        errors(&output)
    );
    let out = folder.path().join("out/e");
    assert!(out.join("a-b-weak/results.csv").exists());
    assert!(
        out.join("a-b-strong/results-partial.csv").exists()
            && !out.join("a-b-strong/results.csv").exists()
    );
    let experiment = json(&out.join("experiment.json"));
    assert_eq!(experiment["runs"][1]["summary"], Value::Null);
    assert_eq!(
        (
            &experiment["table"][0]["ours"],
            &experiment["table"][0]["met"]
        ),
        (&Value::Null, &Value::Bool(false))
    );
    assert_eq!(experiment["table"][1]["ours"], 2.5);
}
