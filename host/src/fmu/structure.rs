//! Units and dependencies of a `modelDescription.xml`, which are the same for FMI 2.0 and 3.0 but for how
//! variables are named.

use super::description::{Variable, Version};
use roxmltree::{Attribute, Node};
use std::collections::{BTreeMap, HashMap};

/// Attributes of the `BaseUnit` of each unit that has one, by the name of the unit.
pub type Units = BTreeMap<String, BTreeMap<String, String>>;

/// The variables that each output depends on directly, both as positions in [`super::Description::variables`]; None for
/// an output that does not say.
pub type Dependencies = BTreeMap<usize, Option<Vec<usize>>>;

/// Units that have a `BaseUnit` (FMI 2.0 sec 2.2.2, FMI 3.0 sec 2.4.3).
pub(super) fn units(root: Node<'_, '_>) -> Units {
    let nodes = root.descendants().filter(|n| n.has_tag_name("Unit"));
    let unit = |node: Node<'_, '_>| {
        let base = node.children().find(|c| c.has_tag_name("BaseUnit"))?;
        let pair = |a: Attribute<'_, '_>| (a.name().to_owned(), a.value().to_owned());
        let attributes = base.attributes().map(pair).collect();
        Some((node.attribute("name")?.to_owned(), attributes))
    };
    nodes.filter_map(unit).collect()
}

/// What outputs depend on directly (FMI 2.0 sec 2.2.8, FMI 3.0 sec 2.4.8).
pub(super) fn dependencies(
    root: Node<'_, '_>,
    version: Version,
    variables: &[Variable],
) -> Dependencies {
    let mut children = root.children();
    let Some(structure) = children.find(|c| c.has_tag_name("ModelStructure")) else {
        return Dependencies::new();
    };
    let (unknowns, key): (Vec<_>, _) = match version {
        Version::V2 => {
            let mut lists = structure.children();
            let outputs = lists.find(|c| c.has_tag_name("Outputs"));
            let unknowns = outputs.into_iter().flat_map(|list| list.children());
            (unknowns.filter(Node::is_element).collect(), "index")
        }
        Version::V3 => {
            let unknowns = structure.children();
            let outputs = unknowns.filter(|c| c.has_tag_name("Output"));
            (outputs.collect(), "valueReference")
        }
    };
    let references: HashMap<u32, usize> = match version {
        Version::V2 => HashMap::new(),
        Version::V3 => {
            let pair = |(position, variable): (usize, &Variable)| (variable.reference, position);
            // Of several with one reference the first counts.
            variables.iter().enumerate().rev().map(pair).collect()
        }
    };
    let position = |text: &str| match version {
        // Positions count from 1.
        Version::V2 => text.parse::<usize>().ok()?.checked_sub(1),
        Version::V3 => references.get(&text.parse().ok()?).copied(),
    };
    let output = |unknown: Node<'_, '_>| {
        let inputs = unknown.attribute("dependencies").map(|list| {
            let names = list.split_ascii_whitespace();
            names.filter_map(position).collect()
        });
        Some((position(unknown.attribute(key)?)?, inputs))
    };
    unknowns.into_iter().filter_map(output).collect()
}

#[cfg(test)]
mod tests {
    use super::super::description::Causality;
    use super::super::description::tests::variable;
    use super::*;
    use roxmltree::Document;

    #[test]
    fn units_without_a_base_unit_are_left_out() {
        let text = "<m><UnitDefinitions><Unit name='rad'><BaseUnit rad='1'/></Unit><Unit name='x'/></UnitDefinitions></m>";
        let document = Document::parse(text).unwrap();
        let units = units(document.root_element());
        assert_eq!(units.len(), 1);
        assert_eq!(units["rad"]["rad"], "1");
    }

    #[test]
    fn outputs_are_named_by_position_or_by_reference() {
        let mut variables = ["u", "x", "y", "z"].map(|name| variable(name, Causality::Output));
        for (variable, reference) in variables.iter_mut().zip([10, 20, 30, 40]) {
            variable.reference = reference;
        }
        let expected = Dependencies::from([(2, Some(vec![0, 1])), (3, None)]);
        for (version, text) in [
            (
                Version::V2,
                "<m><ModelStructure><Outputs><Unknown index='3' dependencies='1 2'/><Unknown index='4'/>\
                 <Unknown index='0'/></Outputs><Derivatives><Unknown index='1'/></Derivatives></ModelStructure></m>",
            ),
            (
                Version::V3,
                "<m><ModelStructure><Output valueReference='30' dependencies='10 20 99'/><Output valueReference='40'/>\
                 <Output valueReference='99'/><InitialUnknown valueReference='10'/></ModelStructure></m>",
            ),
        ] {
            let document = Document::parse(text).unwrap();
            let found = dependencies(document.root_element(), version, &variables);
            assert_eq!(found, expected, "{version:?}");
        }
        let document = Document::parse("<m/>").unwrap();
        let none = dependencies(document.root_element(), Version::V3, &variables);
        assert!(none.is_empty());
    }
}
