//! Every rule of a model description, broken once: the message must name the line and the culprit.

use model_description::read;

const VALID: &str = include_str!("valid.xml");

/// What is reported once `from` is replaced by `to` in the valid description.
fn broken(from: &str, to: &str) -> Vec<String> {
    assert_eq!(VALID.matches(from).count(), 1, "`{from}` must occur once");
    let diagnostics = read(&VALID.replace(from, to), "t.xml").expect_err(to);
    diagnostics.iter().map(ToString::to_string).collect()
}

#[track_caller]
fn breaks(from: &str, to: &str, message: &str) {
    let messages = broken(from, to);
    assert!(messages.iter().any(|m| m == message), "{messages:#?}");
}

/// The only complaint.
#[track_caller]
fn only(from: &str, to: &str, message: &str) {
    assert_eq!(broken(from, to), [message]);
}

#[test]
fn the_valid_description_is_valid() {
    let description = read(VALID, "t.xml").unwrap();
    assert_eq!(description.variables.len(), 8);
    assert_eq!(
        description.states().map(|s| &*s.name).collect::<Vec<_>>(),
        ["level"]
    );
    assert_eq!(description.token.len(), 64);
}

#[test]
fn the_token_follows_the_text_but_not_its_line_ends() {
    let token = |text: &str| read(text, "t.xml").unwrap().token;
    assert_eq!(token(VALID), token(&VALID.replace('\n', "\r\n")));
    assert_ne!(
        token(VALID),
        token(&VALID.replace("max=\"9\"", "max=\"8\""))
    );
}

#[test]
fn xml() {
    only(
        "</ModelVariables>",
        "",
        "t.xml:38: not well-formed: expected 'ModelVariables' tag, not 'fmiModelDescription' at 38:1",
    );
    only(
        "<CoSimulation ",
        "<CoSimulation speed=\"1\" ",
        "t.xml:4: element `CoSimulation`: unknown attribute `speed`",
    );
    only(
        "start=\"0\"",
        "start=\"0\" starts=\"0\"",
        "t.xml:22: variable inflow: unknown attribute `starts`",
    );
    only(
        "<ModelStructure>",
        "<ModelStructure><Input/>",
        "t.xml:32: unknown element `Input` in `ModelStructure`",
    );
    only(
        "<Int32 name=\"valve.count\"",
        "<Int64 name=\"x\"/><Int32 name=\"valve.count\"",
        "t.xml:29: unknown element `Int64` in `ModelVariables`",
    );
    only(
        "<Dimension start=\"3\"/>",
        "<Dimension start=\"3\"/>3",
        "t.xml:26: variable valve.table: text where only elements may stand",
    );
    breaks(
        "<Output valueReference=\"2\"",
        "<Output",
        "t.xml:33: element `Output`: missing attribute `valueReference`",
    );
}

#[test]
fn head() {
    only(
        "fmiVersion=\"3.0\"",
        "fmiVersion=\"2.0\"",
        "t.xml:1: element `fmiModelDescription`: fmiVersion must be `3.0`",
    );
    only(
        "structured",
        "flat",
        "t.xml:1: element `fmiModelDescription`: variableNamingConvention must be `structured`",
    );
    only(
        "instantiationToken=\"\"",
        "instantiationToken=\"x\"",
        "t.xml:1: element `fmiModelDescription`: `instantiationToken=\"\"` must be there once: the build fills it",
    );
    only(
        "<CoSimulation modelIdentifier=\"Tank\"/>",
        "<CoSimulation modelIdentifier=\"Tub\"/>",
        "t.xml:4: modelIdentifier `Tub` differs from modelName `Tank`",
    );
    only(
        "<DefaultExperiment startTime=\"0\" stopTime=\"1\"",
        "<DefaultExperiment startTime=\"1\" stopTime=\"1\"",
        "t.xml:19: DefaultExperiment: startTime 1 is not before stopTime 1",
    );
    only(
        "stepSize=\"0.1\"",
        "stepSize=\"0\"",
        "t.xml:19: DefaultExperiment: stepSize 0 is not positive",
    );
    only(
        "license=\"MIT\"",
        "",
        "t.xml:1: element `fmiModelDescription`: missing attribute `license`",
    );
    breaks(
        "<ModelStructure>",
        "<ModelStructure/><ModelStructure>",
        "t.xml:32: element `ModelStructure` may not follow `ModelStructure`",
    );
    let text = VALID
        .replace("<ModelExchange modelIdentifier=\"Tank\"/>", "")
        .replace("<CoSimulation modelIdentifier=\"Tank\"/>", "");
    assert_eq!(
        read(&text, "t.xml").unwrap_err()[0].message,
        "neither `ModelExchange` nor `CoSimulation` is offered"
    );
}

#[test]
fn order_of_the_sections() {
    let category = "<LogCategories>\n    <Category name=\"logEvents\" description=\"d\"/>\n  </LogCategories>\n";
    let text = VALID
        .replace(category, "")
        .replace("<ModelStructure>", &format!("{category}<ModelStructure>"));
    let messages = read(&text, "t.xml").unwrap_err();
    assert_eq!(messages.len(), 1);
    assert_eq!(
        messages[0].to_string(),
        "t.xml:29: element `LogCategories` may not follow `ModelVariables`"
    );
}

#[test]
fn units() {
    only(
        "unit=\"m/s\" start",
        "unit=\"kg\" start",
        "t.xml:22: variable inflow: unknown unit `kg`",
    );
    only(
        "unit=\"m/s\" start",
        "start",
        "t.xml:22: variable inflow: missing attribute `unit`",
    );
    only(
        "displayUnit=\"mm\"",
        "displayUnit=\"cm\"",
        "t.xml:23: variable level: unknown display unit `cm` of `m`",
    );
    only(
        "<Unit name=\"m/s\">",
        "<Unit name=\"m/s\"><BaseUnit/></Unit><Unit name=\"m/s\">",
        "t.xml:8: unit m/s: name already used in line 8",
    );
    only(
        "<Unit name=\"s\"><BaseUnit s=\"1\"/></Unit>",
        "<Unit name=\"s\"/>",
        "t.xml:6: unit s: no `BaseUnit`",
    );
    only(
        "<BaseUnit s=\"1\"/>",
        "<BaseUnit s=\"one\"/>",
        "t.xml:6: element `BaseUnit`: s `one` is not an integer",
    );
}

#[test]
fn names() {
    only(
        "name=\"valve.count\"",
        "name=\"inflow\"",
        "t.xml:29: variable inflow: name already used in line 22",
    );
    only(
        "name=\"inflow\"",
        "name=\"time\"",
        "t.xml:22: variable time: importers keep this name for themselves",
    );
    only(
        "name=\"inflow\"",
        "name=\"valve.closed.x\"",
        "t.xml:30: variable valve.closed: also the group of valve.closed.x",
    );
    only(
        "name=\"inflow\"",
        "name=\"der_level\"",
        "t.xml:24: variable der(level): has the same name in Rust as der_level",
    );
    for bad in ["In.flow", "valve.table[4]", "a-b", "loop"] {
        only(
            "name=\"inflow\"",
            &format!("name=\"{bad}\""),
            &format!(
                "t.xml:22: variable {bad}: name is not dotted snake case (an array has a `Dimension`, not a subscript), \
                 or contains a Rust keyword"
            ),
        );
    }
    only(
        "name=\"logEvents\" description=\"d\"",
        "name=\"logEvents\"",
        "t.xml:17: log category logEvents: missing attribute `description`",
    );
    only(
        "start=\"0\" description=\"d\"",
        "start=\"0\"",
        "t.xml:22: variable inflow: missing attribute `description`",
    );
    only(
        "start=\"0\" description=\"d\"",
        "start=\"0\" description=\" \"",
        "t.xml:22: variable inflow: attribute `description` is empty",
    );
}

#[test]
fn groups_that_rust_cannot_tell_apart() {
    let text = VALID
        .replace("\"valve.count\"", "\"a_b.x\"")
        .replace("\"valve.closed\"", "\"a.b.x\"");
    let messages = read(&text, "t.xml").unwrap_err();
    assert_eq!(
        messages[0].to_string(),
        "t.xml:30: variable a.b.x: its group and `a_b` have one name in Rust"
    );
}

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
        "t.xml:22: variable inflow: causality `entry` is not one of independent, parameter, calculatedParameter, input, output, local",
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

#[test]
fn everything_is_reported_at_once_and_by_line() {
    let text = VALID
        .replace("unit=\"m/s\" start=\"0\"", "unit=\"kg\"")
        .replace("start=\"false\"", "");
    let lines: Vec<_> = read(&text, "t.xml")
        .unwrap_err()
        .iter()
        .map(|d| d.line)
        .collect();
    assert_eq!(lines, [22, 22, 30]);
}

#[test]
fn the_contracts_are_valid() {
    for unit in ["plant", "controller"] {
        let path = format!("{}/{unit}.xml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap();
        if let Err(diagnostics) = read(&text, &format!("modelDescription/{unit}.xml")) {
            let lines: Vec<_> = diagnostics.iter().map(ToString::to_string).collect();
            panic!("{}", lines.join("\n"));
        }
    }
}
