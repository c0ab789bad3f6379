//! Which connector feeds which (SSP 1.0 sec 5.3): the hierarchy of systems flattened to FMUs and values from
//! outside. Everything that is wrong is found before anything runs.

use super::build::build;
use super::document::{Kind, SystemStructure, Type};
use super::package::{Package, mistake};
use super::transformation::{NamedUnit, Transformation, Unit};
use crate::Error;
use crate::fmu::{Description, Fmu, Scalar, Value};
use crate::input::{self, Place};
use std::collections::BTreeMap;

/// An FMU of the system.
#[derive(Debug)]
pub(super) struct Part {
    /// Names from the root system to the component, which the root's is not part of, with points.
    pub path: String,
    pub fmu: Fmu,
    /// What the FMU is called in messages.
    pub source: String,
}

impl Part {
    pub fn description(&self) -> &Description {
        self.fmu.description()
    }

    /// The unit of a variable, if it declares one.
    pub fn unit(&self, scalar: Scalar) -> Option<NamedUnit> {
        let description = self.description();
        let name = description.variable(scalar).unit.as_ref()?;
        let base = description.units.get(name);
        Some(NamedUnit {
            name: name.clone(),
            unit: base.and_then(Unit::of_attributes),
        })
    }
}

/// Where a connector is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Owner {
    Part(usize, Scalar),
    Root,
    Nested,
}

/// A connector of the flattened system.
#[derive(Debug)]
pub(super) struct Point {
    pub owner: Owner,
    pub path: String,
    pub kind: Kind,
    pub unit: Option<NamedUnit>,
    pub signal: Option<Type>,
    pub incoming: Option<Hop>,
}

/// A connection as its target sees it.
#[derive(Clone, Debug)]
pub(super) struct Hop {
    pub from: usize,
    pub transformation: Transformation,
    pub suppress_unit_conversion: bool,
    pub transformed: bool,
    pub line: u32,
}

/// Connectors by name, and what is below.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub connectors: BTreeMap<String, usize>,
    pub children: Vec<(String, Branch)>,
}

/// What a system contains.
#[derive(Debug)]
pub(super) enum Branch {
    Part(usize, BTreeMap<String, usize>),
    System(Tree),
}

/// What a target gets: the value of the point where its connections begin, transformed.
#[derive(Clone, Debug)]
pub(super) struct Origin {
    pub point: usize,
    pub transformation: Transformation,
    /// Line of the last connection.
    pub line: u32,
}

/// The flattened system.
#[derive(Debug)]
pub(super) struct Wiring {
    pub file: String,
    pub parts: Vec<Part>,
    pub points: Vec<Point>,
    pub tree: Tree,
    pub warnings: Vec<String>,
}

impl Wiring {
    /// Opens the FMUs and follows the connections.
    pub fn new(package: &Package, structure: &SystemStructure) -> Result<Self, Error> {
        let (tree, parts, points, mut mistakes) = build(package, structure)?;
        let mut wiring = Self {
            file: structure.file.clone(),
            parts,
            points,
            tree,
            warnings: Vec::new(),
        };
        if mistakes.is_empty() {
            if wiring.parts.is_empty() {
                let place = wiring.place(structure.system.element.line);
                mistakes.push(mistake(place, "the system has no component to simulate"));
            }
            for target in 0..wiring.points.len() {
                if let Err(error) = wiring.origin(target) {
                    mistakes.push(error);
                }
            }
        }
        if let Some(mistakes) = input::Error::several(mistakes) {
            return Err(mistakes.into());
        }
        wiring.warn_of_units();
        Ok(wiring)
    }

    /// Gives the FMUs the structural parameters among the `values` of each. Connectors and values name elements of
    /// arrays in their size at the start: those must still be there.
    pub fn configure(&mut self, values: &[BTreeMap<Scalar, Value>]) -> Result<(), Error> {
        let before: Vec<_> = self.parts.iter().map(|part| part.fmu.clone()).collect();
        for (part, values) in self.parts.iter_mut().zip(values) {
            let all: Vec<_> = values
                .iter()
                .map(|(at, value)| (*at, value.clone()))
                .collect();
            part.fmu = part.fmu.configured(&all)?;
        }
        let connected = self.points.iter().filter_map(|point| match point.owner {
            Owner::Part(part, scalar) => Some((part, scalar)),
            Owner::Root | Owner::Nested => None,
        });
        let given = values.iter().enumerate();
        let given = given.flat_map(|(part, values)| values.keys().map(move |&at| (part, at)));
        for (part, scalar) in connected.chain(given) {
            // Of two dimensions the same element may now be another one.
            let name = before[part].description().name_of(scalar);
            let part = &self.parts[part];
            if part.description().scalar(&name).ok() != Some(scalar) {
                let path = &part.path;
                let message = format!(
                    "{path}.{name} is another element or none, now that structural parameters are given: only those that \
                     stay where they are can be connected or set"
                );
                return Err(mistake(Place::new(self.file.clone(), None), message).into());
            }
        }
        Ok(())
    }

    /// A line of the system structure.
    pub fn place(&self, line: u32) -> Place {
        Place::new(self.file.clone(), Some(line.into()))
    }

    /// Where the value of a connector comes from; none if it is not connected.
    pub fn origin(&self, target: usize) -> Result<Option<Origin>, input::Error> {
        let mut hops: Vec<(&Hop, usize)> = Vec::new();
        let mut at = target;
        while let Some(hop) = &self.points[at].incoming {
            if hops.len() > self.points.len() {
                let points = hops.iter().map(|(hop, _)| &self.points[hop.from]);
                let mut circle: Vec<_> = points.map(|point| point.path.as_str()).collect();
                circle.sort_unstable();
                circle.dedup();
                let message = format!(
                    "the connection is part of a circle without a component: {}",
                    circle.join(", ")
                );
                return Err(mistake(self.place(hop.line), message));
            }
            hops.push((hop, at));
            at = hop.from;
        }
        let Some(&(last, _)) = hops.first() else {
            return Ok(None);
        };
        let mut unit = self.points[at].unit.clone();
        let mut transformation = Transformation::identity();
        for (hop, to) in hops.iter().rev() {
            let target = &self.points[*to].unit;
            if let (Some(from), Some(to), false) = (&unit, target, hop.suppress_unit_conversion) {
                // What cannot be converted is warned of.
                transformation =
                    transformation.then(&from.to(to).unwrap_or(Transformation::identity()));
            }
            transformation = transformation.then(&hop.transformation);
            // A connector without a unit has that of its source.
            unit = target.clone().or(unit);
        }
        Ok(Some(Origin {
            point: at,
            transformation,
            line: last.line,
        }))
    }

    fn warn_of_units(&mut self) {
        for point in &self.points {
            let Some(hop) = &point.incoming else { continue };
            let from = &self.points[hop.from];
            if let (Some(a), Some(b), false, false) = (
                &from.unit,
                &point.unit,
                hop.suppress_unit_conversion,
                hop.transformed,
            ) && let Err(why) = a.to(b)
            {
                let place = self.place(hop.line);
                let (from, to) = (&from.path, &point.path);
                self.warnings.push(format!(
                    "{place}: {from} feeds {to} without conversion: {why}"
                ));
            }
        }
    }
}
