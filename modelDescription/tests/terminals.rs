//! The terminals of FMI 3.0 name variables of both units.

use model_description::{Causality, read};
use roxmltree::Document;

const TERMINALS: &str = include_str!("../terminalsAndIcons.xml");

#[test]
fn members_are_inputs_of_one_unit_and_outputs_of_the_other() {
    let [plant, controller] = [
        include_str!("../plant.xml"),
        include_str!("../controller.xml"),
    ]
    .map(|text| read(text, "contract").unwrap());
    let document = Document::parse(TERMINALS).unwrap();
    let members = document
        .descendants()
        .filter(|n| n.has_tag_name("TerminalMemberVariable"));
    let mut count = 0;
    for member in members {
        let name = member.attribute("variableName").unwrap();
        let mut roles = [&plant, &controller].map(|unit| {
            let variable = unit.variables.iter().find(|v| v.name == name);
            variable
                .unwrap_or_else(|| panic!("{} has no {name}", unit.name))
                .causality
        });
        roles.sort_by_key(|role| role.to_string());
        assert_eq!(roles, [Causality::Input, Causality::Output], "{name}");
        count += 1;
    }
    assert_eq!(count, 2);
}
