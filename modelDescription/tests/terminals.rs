//! The terminals of FMI 3.0 (sec 2.4.9): connecting those of one name closes the loop.

use model_description::{Causality, ModelDescription, read};
use roxmltree::{Document, Node};

/// A unit with its terminals.
struct Unit<'a> {
    description: ModelDescription,
    terminals: Document<'a>,
}

fn units() -> [Unit<'static>; 2] {
    [
        (
            include_str!("../controller.xml"),
            include_str!("../controller.terminalsAndIcons.xml"),
        ),
        (
            include_str!("../plant.xml"),
            include_str!("../plant.terminalsAndIcons.xml"),
        ),
    ]
    .map(|(description, terminals)| Unit {
        description: read(description, "contract").unwrap(),
        terminals: Document::parse(terminals).unwrap(),
    })
}

impl Unit<'_> {
    fn terminals(&self) -> impl Iterator<Item = Node<'_, '_>> {
        let all = self.terminals.descendants();
        all.filter(|n| n.has_tag_name("Terminal"))
    }

    fn causality(&self, variable: &str) -> Causality {
        let mut variables = self.description.variables.iter();
        let found = variables.find(|v| v.name == variable);
        found
            .unwrap_or_else(|| panic!("{} has no {variable}", self.description.name))
            .causality
    }
}

/// Name, matching rule and members (member name, variable, kind), without those of terminals inside.
fn terminal<'a>(node: Node<'a, '_>) -> (&'a str, &'a str, Vec<[&'a str; 3]>) {
    let members = node
        .children()
        .filter(|n| n.has_tag_name("TerminalMemberVariable"))
        .map(|n| ["memberName", "variableName", "variableKind"].map(|a| n.attribute(a).unwrap()));
    let attribute = |name| node.attribute(name).unwrap();
    (
        attribute("name"),
        attribute("matchingRule"),
        members.collect(),
    )
}

/// `plug` asks for the same members; each is an input of one unit and an output of the other, and what flows
/// out of one flows into the other.
#[test]
fn terminals_of_one_name_close_the_loop() {
    let [controller, plant] = units();
    let mut connections = Vec::new();
    for node in controller.terminals() {
        let (name, rule, members) = terminal(node);
        if members.is_empty() {
            continue;
        }
        let mate = plant.terminals().map(terminal).find(|(n, ..)| *n == name);
        let Some((_, mates_rule, mates)) = mate else {
            panic!("the plant has no terminal {name}");
        };
        assert_eq!((rule, mates_rule), ("plug", "plug"), "{name}");
        assert_eq!(members.len(), mates.len(), "{name}");
        for ([member, variable, kind], [mates_member, mates_variable, mates_kind]) in
            members.into_iter().zip(mates)
        {
            assert_eq!(member, mates_member, "{name}");
            let directions = (
                controller.causality(variable),
                plant.causality(mates_variable),
            );
            let kinds = match directions {
                (Causality::Output, Causality::Input) => ("outflow", "inflow"),
                (Causality::Input, Causality::Output) => ("signal", "signal"),
                other => panic!("{name}.{member}: {other:?}"),
            };
            assert_eq!((kind, mates_kind), kinds, "{name}.{member}");
            connections.push([variable, mates_variable]);
        }
    }
    assert_eq!(connections, [["torque", "torque"], ["angle", "angle"]]);
}

/// One connection of `drive` is both.
#[test]
fn the_drive_holds_flange_and_sensor() {
    for unit in units() {
        let names = |node: Node| -> Vec<String> {
            let inside = node.children().filter(|n| n.has_tag_name("Terminal"));
            inside.map(|n| terminal(n).0.to_owned()).collect()
        };
        let mut terminals = unit.terminals();
        let drive = terminals.find(|n| terminal(*n).0 == "drive").unwrap();
        assert_eq!(terminal(drive).1, "bus");
        assert_eq!(names(drive), ["flange", "sensor"]);
    }
}

/// The plant's flange for the rest of a machine: its angle is an output, the torque on it an input.
#[test]
fn the_load_acts_on_the_arm() {
    let [_, plant] = units();
    let load = plant.terminals().map(terminal).find(|(n, ..)| *n == "load");
    let (_, rule, members) = load.unwrap();
    assert_eq!(rule, "plug");
    let expected = [
        ["phi", "angle", "signal"],
        ["tau", "disturbance_torque", "inflow"],
    ];
    assert_eq!(members, expected);
    assert_eq!(plant.causality("angle"), Causality::Output);
    assert_eq!(plant.causality("disturbance_torque"), Causality::Input);
}

/// Each terminal is drawn on the edge of the icon, none over another: what comes in on the left, what goes out
/// on the right, as in the system structure.
#[test]
fn terminals_lie_on_the_edge_of_the_icon() {
    for unit in units() {
        let mut places = Vec::new();
        for node in unit.terminals() {
            let mut children = node.children();
            let drawn = children.find(|n| n.has_tag_name("TerminalGraphicalRepresentation"));
            let drawn = drawn.unwrap();
            let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"]
                .map(|a| drawn.attribute(a).unwrap().parse::<f64>().unwrap());
            let (x, y) = (0.5 * (x1 + x2), 0.5 * (y1 + y2));
            assert!((x.abs() == 100.0) != (y.abs() == 100.0), "{x} {y}");
            assert_eq!((x2 - x1, y2 - y1), (20.0, 20.0));
            assert!(!places.contains(&(x, y)));
            places.push((x, y));
            if let (_, _, members) = terminal(node)
                && let [[_, variable, _]] = members[..]
            {
                let inward = unit.causality(variable) == Causality::Input;
                assert_eq!(x < 0.0, inward, "{variable}");
            }
        }
        assert!(places.len() >= 3);
    }
}
