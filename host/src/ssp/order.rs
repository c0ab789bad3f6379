//! In which order components step.
//!
//! Whose outputs depend directly on its inputs must step before those that take these outputs, or they take what
//! is a communication step old. Two that depend on each other so are an algebraic loop, which a co-simulation
//! without iterations does not solve.

use super::wiring::Part;
use crate::fmu::{Causality, Dependencies, Scalar};

/// A connection from an output of a component to an input of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Link {
    pub from: usize,
    pub output: Scalar,
    pub to: usize,
    pub input: Scalar,
    /// Line of the connection.
    pub line: u32,
}

/// How much it matters that one steps before another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    /// The FMU does not say what its output depends on.
    Undeclared,
    /// The output depends directly on inputs, but on none that another component feeds.
    Outside,
    /// The output depends directly on what another component feeds.
    Declared,
}

/// Who must step before whom, and how much it matters.
type Before = (usize, usize, Need);

/// An order of steps.
#[derive(Debug, PartialEq)]
pub(super) struct Sequence {
    /// Indices of the components.
    pub order: Vec<usize>,
    /// Components that wait for each other in a circle: some take what is a step old.
    pub doubtful: Vec<usize>,
}

/// The order, by the file where it does not matter. Errors: the connections of an algebraic loop.
pub(super) fn sequence(parts: &[Part], links: &[Link]) -> Result<Sequence, Vec<Link>> {
    let declared: Vec<_> = parts
        .iter()
        .map(|part| &part.description().dependencies)
        .collect();
    if let Some(circle) = algebraic_loop(&declared, links) {
        return Err(circle);
    }
    let need = |link: &Link| {
        let inputs = match declared[link.from].get(&link.output.variable) {
            Some(Some(inputs)) => inputs,
            _ => return Some(Need::Undeclared),
        };
        let is_fed = |input: &usize| {
            let mut feeding = links.iter().filter(|l| l.to == link.from);
            feeding.any(|l| l.input.variable == *input)
        };
        let is_input = |input: &usize| {
            let variable = parts[link.from].description().variables.get(*input);
            variable.is_some_and(|v| v.causality == Causality::Input)
        };
        if inputs.iter().any(is_fed) {
            Some(Need::Declared)
        } else {
            inputs.iter().any(is_input).then_some(Need::Outside)
        }
    };
    let before = |link: &Link| Some((link.from, link.to, need(link)?));
    let needs: Vec<_> = links.iter().filter_map(before).collect();
    Ok(sort(parts.len(), &needs))
}

/// Who has to wait for nobody steps next. Where all wait, what matters least is given up.
fn sort(count: usize, needs: &[Before]) -> Sequence {
    let mut order = Vec::new();
    let mut open: Vec<usize> = (0..count).collect();
    let mut doubtful = Vec::new();
    while !open.is_empty() {
        let free = |least: Need| {
            let waits = |part: usize| {
                let mut before = needs
                    .iter()
                    .filter(|(_, to, need)| *to == part && *need >= least);
                before.any(|(from, ..)| *from != part && open.contains(from))
            };
            open.iter().position(|&part| !waits(part))
        };
        let next = free(Need::Undeclared).or_else(|| {
            if doubtful.is_empty() {
                doubtful.clone_from(&open);
            }
            free(Need::Outside).or_else(|| free(Need::Declared))
        });
        order.push(open.remove(next.unwrap_or(0)));
    }
    Sequence { order, doubtful }
}

/// Connections each of which feeds what the next one takes, in a circle.
fn algebraic_loop(declared: &[&Dependencies], links: &[Link]) -> Option<Vec<Link>> {
    let feeds = |a: &Link, b: &Link| {
        let inputs = declared[b.from].get(&b.output.variable);
        let inputs = inputs.and_then(Option::as_ref);
        a.to == b.from && inputs.is_some_and(|inputs| inputs.contains(&a.input.variable))
    };
    // What nothing feeds is in no circle, nor is then what only that feeds.
    let mut left = links.to_vec();
    loop {
        let fed = |link: &Link| left.iter().any(|other| feeds(other, link));
        let kept: Vec<_> = left.iter().filter(|link| fed(link)).copied().collect();
        if kept.len() == left.len() {
            break;
        }
        left = kept;
    }
    let mut path = vec![*left.first()?];
    loop {
        let before = *left
            .iter()
            .find(|link| feeds(link, &path[path.len() - 1]))?;
        if let Some(begin) = path.iter().position(|link| *link == before) {
            let mut circle = path.split_off(begin);
            circle.reverse();
            return Some(circle);
        }
        path.push(before);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// From variable 1 of a component to variable 0 of another.
    fn link(from: usize, to: usize) -> Link {
        let scalar = |variable| Scalar {
            variable,
            element: 0,
        };
        Link {
            from,
            output: scalar(1),
            to,
            input: scalar(0),
            line: 10 * from as u32 + to as u32,
        }
    }

    #[test]
    fn who_depends_directly_on_others_steps_after_them() {
        use Need::{Declared, Outside, Undeclared};
        let order = |count, needs: &[Before]| {
            let Sequence { order, doubtful } = sort(count, needs);
            (order, doubtful)
        };
        assert_eq!(order(3, &[]), (vec![0, 1, 2], vec![]));
        let chain = [(2, 1, Declared), (1, 0, Undeclared)];
        assert_eq!(order(3, &chain), (vec![2, 1, 0], vec![]));
        // What is declared counts more than what may be.
        let mixed = [(0, 1, Undeclared), (1, 0, Declared)];
        assert_eq!(order(3, &mixed), (vec![2, 1, 0], vec![0, 1]));
        let outside = [(0, 1, Outside), (1, 0, Declared)];
        assert_eq!(order(2, &outside), (vec![1, 0], vec![0, 1]));
        let circle = [(0, 1, Declared), (1, 0, Declared)];
        assert_eq!(order(2, &circle), (vec![0, 1], vec![0, 1]));
    }

    #[test]
    fn algebraic_loops_are_found() {
        let direct: Dependencies = BTreeMap::from([(1, Some(vec![0]))]);
        let none: Dependencies = BTreeMap::from([(1, Some(vec![]))]);
        let lines = |declared: &[&Dependencies], pairs: &[(usize, usize)]| {
            let links: Vec<_> = pairs.iter().map(|&(from, to)| link(from, to)).collect();
            algebraic_loop(declared, &links).map(|c| c.iter().map(|l| l.line).collect::<Vec<_>>())
        };
        let pairs = [(0, 1), (1, 2), (2, 1)];
        assert_eq!(lines(&[&direct; 3], &pairs), Some(vec![21, 12]));
        assert_eq!(lines(&[&direct, &direct, &none], &pairs), None);
        assert_eq!(lines(&[&direct], &[(0, 0)]), Some(vec![0]));
        assert_eq!(lines(&[&BTreeMap::new(); 3], &pairs), None);
    }
}
