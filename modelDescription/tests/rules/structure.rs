//! The model structure.

use super::{breaks, only};

#[test]
fn structure() {
    only(
        "    <Output valueReference=\"2\" dependencies=\"2\"/>\n",
        "",
        "t.xml:23: variable level: missing `Output` 2 in the model structure",
    );
    only(
        "    <ContinuousStateDerivative valueReference=\"3\" dependencies=\"1 2\"/>\n",
        "",
        "t.xml:24: variable der(level): missing `ContinuousStateDerivative` 3 in the model structure",
    );
    only(
        "    <InitialUnknown valueReference=\"3\"/>\n",
        "",
        "t.xml:24: variable der(level): missing `InitialUnknown` 3 in the model structure",
    );
    only(
        "<InitialUnknown valueReference=\"3\"/>",
        "<InitialUnknown valueReference=\"3\"/><InitialUnknown valueReference=\"1\"/>",
        "t.xml:36: InitialUnknown 1: variable inflow is not calculated at initialization",
    );
    only(
        "<InitialUnknown valueReference=\"3\"/>",
        "<InitialUnknown valueReference=\"3\"/><InitialUnknown valueReference=\"3\"/>",
        "t.xml:36: InitialUnknown 3: already declared in line 36",
    );
    only(
        "<Output valueReference=\"2\" dependencies=\"2\"/>",
        "<Output valueReference=\"2\" dependencies=\"99\"/>",
        "t.xml:33: Output 2: dependency 99 is no variable",
    );
    only(
        "<Output valueReference=\"2\" dependencies=\"2\"/>",
        "<Output valueReference=\"2\" dependencies=\"1 1\"/>",
        "t.xml:33: Output 2: dependency 1 stands twice",
    );
    only(
        "<Output valueReference=\"2\" dependencies=\"2\"/>",
        "<Output valueReference=\"2\" dependencies=\"10\"/>",
        "t.xml:33: Output 2: dependency 10 (valve.table) is not an input, a continuous state or the independent variable",
    );
    only(
        "<InitialUnknown valueReference=\"2\" dependencies=\"10\"/>",
        "<InitialUnknown valueReference=\"2\" dependencies=\"3\"/>",
        "t.xml:35: InitialUnknown 2: dependency 3 (der(level)) is not an input, the independent variable or a variable with initial exact",
    );
    only(
        "<Output valueReference=\"2\" dependencies=\"2\"/>",
        "<Output valueReference=\"2\" dependencies=\"2\"/><Output valueReference=\"77\"/>",
        "t.xml:33: Output 77: no variable has this value reference",
    );
    only(
        "    <Output valueReference=\"2\" dependencies=\"2\"/>\n    <ContinuousStateDerivative valueReference=\"3\" dependencies=\"1 2\"/>",
        "    <ContinuousStateDerivative valueReference=\"3\" dependencies=\"1 2\"/>\n    <Output valueReference=\"2\" dependencies=\"2\"/>",
        "t.xml:34: element `Output` may not follow `ContinuousStateDerivative`",
    );
}

#[test]
fn derivatives() {
    breaks(
        "derivative=\"2\"",
        "derivative=\"9\"",
        "t.xml:24: variable der(level): derivative of unknown variable 9",
    );
    breaks(
        "derivative=\"2\"",
        "derivative=\"4\"",
        "t.xml:24: variable der(level): it and its state mode must be continuous Float64",
    );
    breaks(
        "derivative=\"2\"",
        "derivative=\"10\"",
        "t.xml:24: variable der(level): states must be scalars",
    );
    breaks(
        "<Int32 name=\"valve.count\"",
        "<Float64 name=\"fall\" valueReference=\"30\" unit=\"m/s\" derivative=\"2\" description=\"d\"/><Int32 name=\"valve.count\"",
        "t.xml:29: variable fall: der(level) is already the derivative of level",
    );
}
