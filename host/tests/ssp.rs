//! System structures of two mocks, y = gain * u after each step: what runs, and what is refused.
#![cfg(target_os = "linux")]

mod common;

use common::cli::{errors, flexarm};
use common::{mock, pack};
use std::fs;
use std::path::Path;

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<ssd:SystemStructureDescription version=\"1.0\" name=\"two mocks\"
 xmlns:ssd=\"http://ssp-standard.org/SSP1/SystemStructureDescription\"
 xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\"
 xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\"
 xmlns:ssm=\"http://ssp-standard.org/SSP1/SystemStructureParameterMapping\">
";
const TAIL: &str = "<ssd:Units>
<ssc:Unit name=\"deg\"><ssc:BaseUnit rad=\"1\" factor=\"0.5\"/></ssc:Unit>
<ssc:Unit name=\"rad\"><ssc:BaseUnit rad=\"1\"/></ssc:Unit>
</ssd:Units>
<ssd:DefaultExperiment startTime=\"1\" stopTime=\"3\"/>
</ssd:SystemStructureDescription>
";

fn connector(name: &str, kind: &str, signal: &str) -> String {
    format!("<ssd:Connector name=\"{name}\" kind=\"{kind}\"><ssc:{signal}/></ssd:Connector>\n")
}

fn component(name: &str, source: &str, bindings: &str) -> String {
    format!(
        "<ssd:Component name=\"{name}\" source=\"{source}\">\n<ssd:Connectors>\n{}{}</ssd:Connectors>\n{bindings}</ssd:Component>\n",
        connector("u", "input", "Real unit=\"rad\""),
        connector("y", "output", "Real unit=\"rad\""),
    )
}

fn connection(from: &str, to: &str, content: &str) -> String {
    let end = |end: &str, which: &str| match end.split_once('.') {
        Some((element, connector)) => {
            format!(" {which}Element=\"{element}\" {which}Connector=\"{connector}\"")
        }
        None => format!(" {which}Connector=\"{end}\""),
    };
    let (start, end) = (end(from, "start"), end(to, "end"));
    format!("<ssd:Connection{start}{end}>{content}</ssd:Connection>\n")
}

fn binding(parameters: &str, mapping: &str) -> String {
    format!(
        "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
<ssv:ParameterSet version=\"1.0\" name=\"p\"><ssv:Parameters>{parameters}</ssv:Parameters></ssv:ParameterSet>
</ssd:ParameterValues>{mapping}</ssd:ParameterBinding></ssd:ParameterBindings>\n"
    )
}

fn real(name: &str, value: f64) -> String {
    format!("<ssv:Parameter name=\"{name}\"><ssv:Real value=\"{value}\"/></ssv:Parameter>")
}

/// Two mocks in a row, the second in a system of its own; `a` takes degrees of 0.5 rad.
fn chain() -> String {
    let root = [
        connector("u", "input", "Real unit=\"deg\""),
        connector("z", "output", "Real unit=\"deg\""),
    ]
    .concat();
    let inner = [
        connector("in", "input", "Real"),
        connector("out", "output", "Real"),
    ]
    .concat();
    let mapping = "<ssd:ParameterMapping><ssm:ParameterMapping version=\"1.0\">
<ssm:MappingEntry source=\"k\" target=\"gain\"><ssc:LinearTransformation factor=\"2\" offset=\"1\"/></ssm:MappingEntry>
</ssm:ParameterMapping></ssd:ParameterMapping>";
    [
        HEAD,
        "<ssd:System name=\"root\">\n<ssd:Connectors>\n",
        &root,
        "</ssd:Connectors>\n",
        &binding(&(real("u", 4.0) + &real("inner.b.gain", 5.0)), ""),
        "<ssd:Elements>\n<ssd:System name=\"inner\">\n<ssd:Connectors>\n",
        &inner,
        "</ssd:Connectors>\n",
        // What the root says of b.gain counts more.
        &binding(&real("b.gain", 7.0), ""),
        "<ssd:Elements>\n",
        &component("b", "resources/b.fmu", ""),
        "</ssd:Elements>\n<ssd:Connections>\n",
        &connection("in", "b.u", ""),
        &connection("b.y", "out", ""),
        "</ssd:Connections>\n</ssd:System>\n",
        &component(
            "a",
            "resources/a%20b.fmu",
            &binding(&real("k", 1.0), mapping),
        ),
        "</ssd:Elements>\n<ssd:Connections>\n",
        &connection("u", "a.u", ""),
        &connection(
            "a.y",
            "inner.in",
            "<ssc:LinearTransformation factor=\"10\" offset=\"1\"/>",
        ),
        &connection("inner.out", "z", ""),
        "</ssd:Connections>\n</ssd:System>\n",
        TAIL,
    ]
    .concat()
}

/// Packs a system structure with both mocks.
fn package(folder: &Path, structure: &str, more: &[(&str, &str)]) {
    let fmus = [2, 3].map(|version| fs::read(mock(folder, version)).unwrap());
    let mut entries = vec![
        ("SystemStructure.ssd", structure.as_bytes()),
        ("resources/a b.fmu", &fmus[0]),
        ("resources/b.fmu", &fmus[1]),
    ];
    entries.extend(more.iter().map(|(name, text)| (*name, text.as_bytes())));
    pack(&folder.join("s.ssp"), &entries);
}

fn simulate(folder: &Path, more: &[&str]) -> Result<String, String> {
    let arguments = [&["simulate", "s.ssp", "--step", "1", "-o", "out"], more].concat();
    let output = flexarm(folder, &arguments);
    if !output.status.success() {
        assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
        return Err(errors(&output));
    }
    Ok(fs::read_to_string(folder.join("out/results.csv")).unwrap())
}

#[test]
fn values_are_converted_transformed_and_parameterised() {
    let folder = tempfile::tempdir().unwrap();
    package(
        folder.path(),
        &chain(),
        &[("again.ssd", &chain().replace("two mocks", "the same"))],
    );
    // u = 4 deg = 2 rad, a.gain = 2·1 + 1 = 3, a.y = 6 rad, b.u = 61 rad, b.y = 5·61 rad = 610 deg. a steps first,
    // though the file names it last.
    let whole = "time,u,inner.b.y,a.y,z\n1,4,0,6,0\n2,4,305,6,610\n";
    assert_eq!(simulate(folder.path(), &[]).as_deref(), Ok(whole));
    for variant in ["again", "the same"] {
        assert_eq!(
            simulate(folder.path(), &["--variant", variant]).as_deref(),
            Ok(whole)
        );
    }
    for file in ["report.html", "summary.json", "plot.svg"] {
        assert!(folder.path().join("out").join(file).is_file(), "{file}");
    }
    fs::write(folder.path().join("u.csv"), "time,u\n1,2\n2,6\n").unwrap();
    let driven = simulate(
        folder.path(),
        &[
            "--setpoints",
            "u.csv",
            "--set",
            "inner.b:gain=1",
            "--set",
            "a.gain=1",
        ],
    );
    assert_eq!(
        driven.as_deref(),
        Ok("time,u,inner.b.y,a.y,z\n1,2,0,1,0\n2,6,11,3,22\n")
    );
    let delayed = simulate(folder.path(), &["--order", "side-by-side", "--until", "4"]).unwrap();
    assert!(delayed.contains("2,4,5,6,10\n"), "{delayed}");
}

#[test]
fn a_loop_of_what_may_depend_directly_runs_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let ring = [
        HEAD,
        "<ssd:System name=\"root\">\n<ssd:Elements>\n",
        &component("a", "resources/b.fmu", &binding(&real("u", 1.0), "")),
        &component("b", "resources/b.fmu", ""),
        "</ssd:Elements>\n<ssd:Connections>\n",
        &connection("a.y", "b.u", ""),
        &connection("b.y", "a.u", "<ssc:LinearTransformation offset=\"1\"/>"),
        "</ssd:Connections>\n</ssd:System>\n",
        TAIL,
    ]
    .concat();
    package(folder.path(), &ring, &[]);
    let arguments = ["simulate", "s.ssp", "--step", "0.5", "-o", "out"];
    let output = flexarm(folder.path(), &arguments);
    assert!(
        errors(&output).contains("warning: a, b wait for each other"),
        "{}",
        errors(&output)
    );
    let results = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert_eq!(results, "time,a.y,b.y\n1,1,0\n1.5,2,1\n2,3,2\n2.5,4,3\n");
}

#[test]
fn what_has_no_effect_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let values = [real("gain", 2.0), real("gaim", 3.0)].concat();
    let one = [
        HEAD,
        "<ssd:System name=\"root\">\n<ssd:Elements>\n",
        &component("a", "resources/b.fmu", &binding(&values, "")),
        "</ssd:Elements>\n</ssd:System>\n",
        TAIL,
    ]
    .concat();
    package(folder.path(), &one, &[]);
    let arguments = ["simulate", "s.ssp", "--step", "0.5", "--until", "2.8"];
    let output = flexarm(folder.path(), &[&arguments[..], &["-o", "out"]].concat());
    let said = errors(&output);
    for warning in [
        "a has no gaim: 1 of the 2 parameters of",
        "--until 2.8 s is no whole number of steps of 0.5 s: the run ends at 2.5 s",
    ] {
        assert!(said.contains(warning), "{said}");
    }
}

#[test]
fn what_is_wrong_is_said_with_file_line_and_element() {
    let folder = tempfile::tempdir().unwrap();
    let good = chain();
    let u = connector("u", "input", "Real unit=\"rad\"");
    let to_a = connection("u", "a.u", "");
    for (from, to, message) in [
        (
            "resources/b.fmu",
            "resources/c.fmu",
            "s.ssp/SystemStructure.ssd:LINE: source `resources/c.fmu` is not in the package",
        ),
        (
            "resources/b.fmu",
            "../b.fmu",
            "source `../b.fmu` leads out of the package",
        ),
        (
            "endElement=\"a\"",
            "endElement=\"c\"",
            "SystemStructure.ssd:LINE: connection: the system has no element c",
        ),
        (
            "endConnector=\"z\"",
            "endConnector=\"x\"",
            "connection: the system has no connector x",
        ),
        (
            u.as_str(),
            &u.repeat(2),
            "Connector u: `b` has this connector already, in line LINE",
        ),
        (
            to_a.as_str(),
            &to_a.repeat(2),
            "connection: a.u is fed already by the connection in line LINE",
        ),
        (
            "name=\"inner\"",
            "name=\"a\"",
            "Component a: the system has an element of this name already",
        ),
        (
            "<ssd:Elements>",
            "<ssd:Elephants/><ssd:Elements>",
            "unknown element `Elephants` in `System`",
        ),
        (
            "kind=\"output\"><ssc:Real unit=\"rad\"",
            "kind=\"output\"><ssc:Boolean",
            "connector inner.b.y: its type is Boolean, but the variable of the FMU is of type Float64",
        ),
        (
            "name=\"y\" kind=\"output\"",
            "name=\"flag\" kind=\"output\"",
            "connector inner.b.flag: its type is Real, but the variable of the FMU is of type Boolean",
        ),
        (
            "name=\"y\" kind=\"output\"",
            "name=\"w\" kind=\"output\"",
            "has no scalar variable w",
        ),
        (
            "name=\"y\" kind=\"output\"",
            "name=\"y\" kind=\"input\"",
            "connector inner.b.y: kind is input, but the variable of the FMU is of causality output",
        ),
        (
            "version=\"1.0\" name=\"two",
            "version=\"3.0\" name=\"two",
            "version `3.0`: 1.x and 2.x can be read",
        ),
        (
            "factor=\"10\"",
            "factor=\"ten\"",
            "factor `ten` is not a finite number",
        ),
        (
            "unit=\"deg\"",
            "unit=\"grad\"",
            "connector u: unit `grad` is not in `Units`",
        ),
        (
            "source=\"k\"",
            "source=\"l\"",
            "mapping entry: no parameter is called l",
        ),
        (
            "name=\"inner.b.gain\"><ssv:Real value=\"5\"",
            "name=\"inner.b.gain\"><ssv:Real value=\"50\"",
            "inner.b.gain = 50: must be in [-10, 10]",
        ),
        (
            "<ssd:System name=\"root\">",
            "<ssd:System>",
            "element `System`: missing attribute `name`",
        ),
        ("<ssd:Units>", "<ssd:Units", "not well-formed"),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good, "{from}");
        let line = bad
            .find(to)
            .map_or(0, |at| bad[..at].matches('\n').count() + 1);
        let message = &message.replace("LINE", &line.to_string());
        package(folder.path(), &bad, &[]);
        let found = simulate(folder.path(), &[]).unwrap_err();
        assert!(found.contains(message), "{message}\n{found}");
        assert!(found.contains("s.ssp/SystemStructure.ssd:"), "{found}");
        assert!(!folder.path().join("out").exists());
    }
    // A passage through the inner system that feeds itself.
    let circle = good
        .replace(&connection("b.y", "out", ""), &connection("in", "out", ""))
        .replace(
            &connection(
                "a.y",
                "inner.in",
                "<ssc:LinearTransformation factor=\"10\" offset=\"1\"/>",
            ),
            &connection("inner.out", "inner.in", ""),
        );
    package(folder.path(), &circle, &[]);
    let found = simulate(folder.path(), &[]).unwrap_err();
    assert!(
        found.contains(
            "the connection is part of a circle without a component: inner.in, inner.out"
        ),
        "{found}"
    );

    package(folder.path(), &good, &[]);
    for (more, message) in [
        (
            &["--set", "gian=1"][..],
            "--set: the system has nothing called gian to be set, did you mean gain?",
        ),
        (
            &["--variant", "x"],
            "there are: SystemStructure (two mocks)",
        ),
        (
            &["--until", "1"],
            "--until = 1: expected a time in [2, 1.000000001e9] s with steps of 1 s from 1 s on",
        ),
    ] {
        let found = simulate(folder.path(), more).unwrap_err();
        assert!(found.contains(message), "{message}\n{found}");
    }
    pack(
        &folder.path().join("s.ssp"),
        &[("Other.ssd", good.as_bytes())],
    );
    assert!(
        simulate(folder.path(), &[])
            .unwrap_err()
            .contains("s.ssp: has no SystemStructure.ssd")
    );
    pack(
        &folder.path().join("s.ssp"),
        &[("../SystemStructure.ssd", good.as_bytes())],
    );
    assert!(
        simulate(folder.path(), &[])
            .unwrap_err()
            .contains("leads out of the folder")
    );
}
