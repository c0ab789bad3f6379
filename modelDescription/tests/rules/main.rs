//! Every rule of a model description, broken once: the message must name the line and the culprit.

mod clocks;
mod dimensions;
mod structure;
mod variables;

use model_description::read;

const VALID: &str = include_str!("../valid.xml");

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

#[test]
fn derivatives_are_the_same_in_every_interface() {
    only(
        "<CoSimulation ",
        "<CoSimulation providesDirectionalDerivatives=\"true\" ",
        "t.xml:4: providesDirectionalDerivatives and providesAdjointDerivatives must be the same everywhere",
    );
}
