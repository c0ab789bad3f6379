//! Value references, roles, start values and enumerations.

use super::{breaks, only};

#[test]
fn value_references() {
    only(
        "valueReference=\"20\"",
        "valueReference=\"12\"",
        "t.xml:29: variable valve.count: value reference 12 already belongs to valve.table (line 26), which owns 10 to 12",
    );
    breaks(
        "valueReference=\"1\"",
        "valueReference=\"0\"",
        "t.xml:22: variable inflow: value reference 0 already belongs to clock (line 21), which owns 0 to 0",
    );
    breaks(
        "valueReference=\"1\"",
        "valueReference=\"-1\"",
        "t.xml:22: variable inflow: valueReference `-1` is not a value reference",
    );
    only(
        "valueReference=\"21\"",
        "valueReference=\"4294967295\"",
        "t.xml:30: variable valve.closed: value references exceed 32 bits",
    );
}

#[test]
fn roles() {
    breaks(
        "causality=\"input\"",
        "causality=\"entry\"",
        "t.xml:22: variable inflow: causality `entry` is not one of independent, parameter, structuralParameter, calculatedParameter, input, output, local",
    );
    only(
        "causality=\"parameter\" variability=\"tunable\"",
        "causality=\"parameter\" variability=\"discrete\"",
        "t.xml:29: variable valve.count: a variable of causality parameter cannot be discrete",
    );
    breaks(
        "causality=\"parameter\" variability=\"tunable\"",
        "causality=\"input\" variability=\"continuous\"",
        "t.xml:29: variable valve.count: a variable of type Int32 cannot be continuous",
    );
    only(
        "variability=\"continuous\" unit=\"m/s\" start",
        "variability=\"continuous\" initial=\"exact\" unit=\"m/s\" start",
        "t.xml:22: variable inflow: a variable of causality input that is continuous cannot have initial exact",
    );
    breaks(
        "variability=\"tunable\"",
        "variability=\"tunable\" initial=\"calculated\"",
        "t.xml:29: variable valve.count: a variable of causality parameter that is tunable cannot have initial calculated",
    );
    breaks(
        "causality=\"independent\"",
        "",
        "t.xml:1: no independent variable is declared",
    );
}

#[test]
fn starts() {
    only(
        " start=\"0\"",
        "",
        "t.xml:22: variable inflow: missing attribute `start`",
    );
    only(
        " start=\"1\" description=\"d\"/>\n    <Boolean",
        " description=\"d\"/>\n    <Boolean",
        "t.xml:29: variable valve.count: missing attribute `start`",
    );
    only(
        "displayUnit=\"mm\"",
        "start=\"0\"",
        "t.xml:23: variable level: start is forbidden with initial calculated",
    );
    only(
        "unit=\"s\"",
        "unit=\"s\" start=\"0\"",
        "t.xml:21: variable clock: start is forbidden with causality independent",
    );
    only(
        "start=\"1 2 3\"",
        "start=\"1 2\"",
        "t.xml:26: variable valve.table: 2 start values for 3 elements",
    );
    only(
        "start=\"1 2 3\"",
        "start=\"1 2 9.5\"",
        "t.xml:26: variable valve.table: start 9.5 is outside its range 0 to 9",
    );
    breaks(
        "min=\"0\" max=\"9\"",
        "min=\"3\" max=\"1\"",
        "t.xml:26: variable valve.table: min 3 exceeds max 1",
    );
    breaks(
        "start=\"1 2 3\"",
        "start=\"1 2 inf\"",
        "t.xml:26: variable valve.table: start `inf` is not a finite number",
    );
    breaks(
        "start=\"false\"",
        "start=\"no\"",
        "t.xml:30: variable valve.closed: start `no` is not true or false",
    );
    breaks(
        "<Dimension start=\"3\"/>",
        "<Dimension start=\"0\"/>",
        "t.xml:27: element `Dimension`: start `0` is not a positive number of elements",
    );
}

#[test]
fn enumerations() {
    only(
        "declaredType=\"Mode\" start=\"1\"",
        "declaredType=\"Mode\" start=\"3\"",
        "t.xml:25: variable mode: start 3 is no item of Mode",
    );
    only(
        "declaredType=\"Mode\"",
        "declaredType=\"Mood\"",
        "t.xml:25: variable mode: unknown declaredType `Mood`",
    );
    only(
        "declaredType=\"Mode\"",
        "",
        "t.xml:25: variable mode: missing attribute `declaredType`",
    );
    only(
        "name=\"half_open\" value=\"2\"",
        "name=\"half_open\" value=\"1\"",
        "t.xml:13: item half_open: value 1 already belongs to `open`",
    );
    only(
        "name=\"half_open\"",
        "name=\"HalfOpen\"",
        "t.xml:13: item HalfOpen: name is not in snake case",
    );
    only(
        "name=\"half_open\"",
        "name=\"open\"",
        "t.xml:13: item open: name already used in line 12",
    );
    breaks(
        "<EnumerationType name=\"Mode\"",
        "<EnumerationType name=\"Valve\"",
        "t.xml:11: type Valve: a group of variables has this name in Rust",
    );
    breaks(
        "<EnumerationType name=\"Mode\"",
        "<EnumerationType name=\"mode\"",
        "t.xml:11: type mode: name is not in camel case",
    );
}
