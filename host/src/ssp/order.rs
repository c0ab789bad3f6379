//! In which order components step.
//!
//! Whose outputs depend directly on its inputs must step before those that take these outputs, or they take what
//! is a communication step old. Two that depend on each other so are an algebraic loop, which a co-simulation
//! without iterations does not solve.

use super::wiring::Part;
use crate::fmu::{Scalar, Version};
use roxmltree::{Document, Node};
use std::collections::BTreeMap;

/// A connection from an output of a component to an input of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub from: usize,
    pub output: Scalar,
    pub to: usize,
    pub input: Scalar,
    /// Line of the connection.
    pub line: u32,
}

/// How surely one must step before another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    /// The FMU does not say what its outputs depend on.
    Undeclared,
    Declared,
}

/// An order of steps.
#[derive(Debug, PartialEq)]
pub(super) struct Sequence {
    /// Indices of the components.
    pub order: Vec<usize>,
    /// Components that perhaps depend on each other in a circle.
    pub doubtful: Vec<usize>,
}

/// The order, by the file where it does not matter. Errors: the connections of an algebraic loop.
pub(super) fn sequence(parts: &[Part], links: &[Link]) -> Result<Sequence, Vec<Link>> {
    let declared: Vec<_> = parts.iter().map(dependencies).collect();
    let need = |link: &Link| {
        let fed = |input: usize| {
            links
                .iter()
                .any(|l| l.to == link.from && l.input.variable == input)
        };
        match &declared[link.from] {
            None => links
                .iter()
                .any(|l| l.to == link.from)
                .then_some(Need::Undeclared),
            Some(of) => match of.get(&link.output.variable) {
                Some(Some(inputs)) => inputs.iter().any(|&i| fed(i)).then_some(Need::Declared),
                _ => links
                    .iter()
                    .any(|l| l.to == link.from)
                    .then_some(Need::Undeclared),
            },
        }
    };
    let needs: Vec<_> = links
        .iter()
        .filter_map(|link| Some((*link, need(link)?)))
        .collect();
    sort(parts.len(), &needs)
}

fn sort(count: usize, needs: &[(Link, Need)]) -> Result<Sequence, Vec<Link>> {
    let mut order = Vec::new();
    let mut open: Vec<usize> = (0..count).collect();
    let mut doubtful = Vec::new();
    while !open.is_empty() {
        let free = |least: Need| {
            let waits = |part: usize| {
                let mut before = needs
                    .iter()
                    .filter(|(l, need)| l.to == part && *need >= least);
                before.any(|(l, _)| open.contains(&l.from))
            };
            open.iter().position(|&part| !waits(part))
        };
        let next = match free(Need::Undeclared) {
            Some(next) => next,
            None => {
                if doubtful.is_empty() {
                    doubtful.clone_from(&open);
                }
                free(Need::Declared).ok_or_else(|| circle(&open, needs))?
            }
        };
        order.push(open.remove(next));
    }
    Ok(Sequence { order, doubtful })
}

/// A circle among components each of which waits for another.
fn circle(open: &[usize], needs: &[(Link, Need)]) -> Vec<Link> {
    let before = |part: usize| {
        let mut links = needs
            .iter()
            .filter(|(l, need)| *need == Need::Declared && l.to == part);
        links.find(|(l, _)| open.contains(&l.from)).map(|(l, _)| *l)
    };
    let mut path: Vec<Link> = Vec::new();
    let mut at = open[0];
    while let Some(link) = before(at) {
        if let Some(begin) = path.iter().position(|l| l.to == at) {
            return path.split_off(begin);
        }
        at = link.from;
        path.push(link);
    }
    path
}

/// The inputs that each output depends on directly, by positions of the variables; none for an output without
/// declared dependencies (FMI 2.0 sec 2.2.8, FMI 3.0 sec 2.4.8). None at all without a model structure.
fn dependencies(part: &Part) -> Option<BTreeMap<usize, Option<Vec<usize>>>> {
    let document = Document::parse(&part.description).ok()?;
    let structure = document
        .root_element()
        .children()
        .find(|c| c.has_tag_name("ModelStructure"))?;
    let description = part.description();
    let position: Box<dyn Fn(&str) -> Option<usize>> = match description.version {
        // Positions count from 1.
        Version::V2 => Box::new(|text| text.parse::<usize>().ok()?.checked_sub(1)),
        Version::V3 => Box::new(|text| {
            let reference: u32 = text.parse().ok()?;
            let variables = &description.variables;
            variables.iter().position(|v| v.reference == reference)
        }),
    };
    let unknowns: Vec<Node<'_, '_>> = match description.version {
        Version::V2 => {
            let outputs = structure.children().find(|c| c.has_tag_name("Outputs"))?;
            outputs.children().filter(Node::is_element).collect()
        }
        Version::V3 => {
            let children = structure.children();
            children.filter(|c| c.has_tag_name("Output")).collect()
        }
    };
    let mut found = BTreeMap::new();
    for unknown in unknowns {
        let which = unknown
            .attribute("index")
            .or(unknown.attribute("valueReference"));
        if let Some(output) = which.and_then(&position) {
            let inputs = unknown.attribute("dependencies").map(|list| {
                let names = list.split_ascii_whitespace();
                names.filter_map(&position).collect()
            });
            found.insert(output, inputs);
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(from: usize, to: usize) -> Link {
        let scalar = Scalar {
            variable: 0,
            element: 0,
        };
        Link {
            from,
            output: scalar,
            to,
            input: scalar,
            line: 10 * from as u32 + to as u32,
        }
    }

    fn order(
        count: usize,
        needs: &[(usize, usize, Need)],
    ) -> Result<(Vec<usize>, Vec<usize>), Vec<u32>> {
        let needs: Vec<_> = needs.iter().map(|&(a, b, n)| (link(a, b), n)).collect();
        match sort(count, &needs) {
            Ok(found) => Ok((found.order, found.doubtful)),
            Err(links) => Err(links.iter().map(|l| l.line).collect()),
        }
    }

    #[test]
    fn who_depends_directly_on_others_steps_after_them() {
        use Need::{Declared, Undeclared};
        assert_eq!(order(3, &[]), Ok((vec![0, 1, 2], vec![])));
        assert_eq!(
            order(3, &[(2, 1, Declared), (1, 0, Undeclared)]),
            Ok((vec![2, 1, 0], vec![]))
        );
        // What is declared counts more than what may be.
        let mixed = [(0, 1, Undeclared), (1, 0, Declared)];
        assert_eq!(order(3, &mixed), Ok((vec![2, 1, 0], vec![0, 1])));
        let unknown = [(0, 1, Undeclared), (1, 0, Undeclared)];
        assert_eq!(order(2, &unknown), Ok((vec![0, 1], vec![0, 1])));
        let circle = [(0, 1, Declared), (1, 2, Declared), (2, 1, Declared)];
        assert_eq!(order(3, &circle), Err(vec![21, 12]));
    }
}
