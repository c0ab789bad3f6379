//! Makes the connectors of a [`super::wiring::Wiring`], and finds what is wrong with them.

use super::document::{Child, Component, Connector, Kind, System, SystemStructure, Type};
use super::package::{Package, mistake, syntax};
use super::transformation::NamedUnit;
use super::wiring::{Branch, Owner, Part, Point, Tree};
use crate::Error;
use crate::fmu::{self, Causality, Fmu, hint};
use crate::input::{self, Place};
use std::collections::BTreeMap;

/// What a wiring is made of, with what is wrong with it.
type Built = (Tree, Vec<Part>, Vec<Point>, Vec<input::Error>);

/// Opens the FMUs and connects their connectors.
pub(super) fn build(package: &Package, structure: &SystemStructure) -> Result<Built, Error> {
    let mut builder = Builder {
        package,
        structure,
        opened: BTreeMap::new(),
        parts: Vec::new(),
        points: Vec::new(),
        mistakes: Vec::new(),
    };
    let tree = builder.system(&structure.system, None)?;
    Ok((tree, builder.parts, builder.points, builder.mistakes))
}

/// What is made until now.
pub(super) struct Builder<'a> {
    package: &'a Package,
    pub structure: &'a SystemStructure,
    opened: BTreeMap<String, Fmu>,
    pub parts: Vec<Part>,
    pub points: Vec<Point>,
    mistakes: Vec<input::Error>,
}

impl Builder<'_> {
    pub fn mistake(&mut self, line: u32, message: impl Into<String>) {
        let place = Place::new(self.structure.file.clone(), Some(line.into()));
        self.mistakes.push(mistake(place, message));
    }

    /// `path` is none for the root.
    fn system(&mut self, system: &System, path: Option<&str>) -> Result<Tree, Error> {
        let below = |name: &str| path.map_or(name.to_owned(), |path| format!("{path}.{name}"));
        let owner = if path.is_some() {
            Owner::Nested
        } else {
            Owner::Root
        };
        let mut tree = Tree::default();
        for connector in &system.element.connectors {
            let unit = self.declared_unit(connector);
            let point = Point {
                owner,
                path: below(&connector.name),
                kind: connector.kind,
                unit,
                signal: connector.signal.clone(),
                incoming: None,
            };
            tree.connectors
                .insert(connector.name.clone(), self.points.len());
            self.points.push(point);
        }
        for child in &system.children {
            let name = &child.element().name;
            let branch = match child {
                Child::Component(component) => self.component(component, below(name))?,
                Child::System(system) => Branch::System(self.system(system, Some(&below(name)))?),
            };
            tree.children.push((name.clone(), branch));
        }
        for connection in &system.connections {
            self.connect(connection, &tree);
        }
        Ok(tree)
    }

    /// The unit that a connector declares, which must be in `Units` (SSP 1.0 sec 4.4.1).
    fn declared_unit(&mut self, connector: &Connector) -> Option<NamedUnit> {
        let name = connector.unit.as_ref()?;
        let unit = self.structure.units.get(name);
        if unit.is_none() {
            let message = format!(
                "connector {}: unit `{name}` is not in `Units`",
                connector.name
            );
            self.mistake(connector.line, message);
        }
        unit.cloned()
    }

    fn component(&mut self, component: &Component, path: String) -> Result<Branch, Error> {
        let place = Place::new(
            self.structure.file.clone(),
            Some(component.element.line.into()),
        );
        let fmu = match self.opened.get(&component.source) {
            Some(fmu) => fmu.clone(),
            None => self.package.fmu(&component.source, &place)?,
        };
        let description = fmu.description();
        match &description.co_simulation {
            None => {
                return Err(Error::Fmu(fmu::Error::NoCoSimulation {
                    file: fmu.file().to_owned(),
                }));
            }
            Some(interface) => {
                let again = self.opened.contains_key(&component.source);
                if interface.can_be_instantiated_only_once_per_process && again {
                    let message = format!(
                        "component {}: {} can be instantiated only once",
                        component.element.name, component.source
                    );
                    return Err(syntax(place, message));
                }
            }
        }
        self.opened.insert(component.source.clone(), fmu.clone());
        let part = self.parts.len();
        self.parts.push(Part {
            path: path.clone(),
            source: self.package.name(&component.source),
            fmu,
        });
        let mut connectors = BTreeMap::new();
        for connector in &component.element.connectors {
            if let Some(point) = self.variable(connector, part, &path) {
                connectors.insert(connector.name.clone(), self.points.len());
                self.points.push(point);
            }
        }
        Ok(Branch::Part(part, connectors))
    }

    /// A connector of a component, which must be a variable of its FMU, of its kind and type.
    fn variable(&mut self, connector: &Connector, part: usize, path: &str) -> Option<Point> {
        let declared = self.declared_unit(connector);
        let part_ref = &self.parts[part];
        let description = part_ref.description();
        let name = &connector.name;
        let title = format!("connector {path}.{name}");
        let scalar = match description.scalar(name) {
            Ok(scalar) => scalar,
            Err(error) => {
                let source = &part_ref.source;
                let why = match error {
                    fmu::NameError::Unknown { similar } => hint(&similar),
                    fmu::NameError::Array { first, last } => {
                        format!(": it is an array, connect its elements {first} to {last}")
                    }
                };
                let message = format!("{title}: {source} has no scalar variable {name}{why}");
                self.mistake(connector.line, message);
                return None;
            }
        };
        let variable = description.variable(scalar);
        let fits = match connector.kind {
            Kind::Input => variable.causality == Causality::Input,
            Kind::Output => matches!(variable.causality, Causality::Output | Causality::Local),
            Kind::Parameter => matches!(
                variable.causality,
                Causality::Parameter | Causality::StructuralParameter
            ),
            Kind::CalculatedParameter => {
                variable.causality == Causality::CalculatedParameter || variable.constant
            }
        };
        if !fits {
            let message = format!(
                "{title}: kind is {}, but the variable of the FMU is of causality {}",
                connector.kind, variable.causality
            );
            self.mistake(connector.line, message);
            return None;
        }
        let own = type_of(variable.kind);
        let matches = match (&connector.signal, &own) {
            (None, _) | (Some(Type::Enumeration(_)), Type::Enumeration(_)) => true,
            (Some(declared), own) => declared == own,
        };
        if !matches {
            let declared = connector.signal.as_ref().unwrap_or(&own);
            let message = format!(
                "{title}: its type is {declared}, but the variable of the FMU is of type {}",
                variable.kind
            );
            self.mistake(connector.line, message);
            return None;
        }
        Some(Point {
            owner: Owner::Part(part, scalar),
            path: format!("{path}.{name}"),
            kind: connector.kind,
            unit: declared.or_else(|| part_ref.unit(scalar)),
            signal: connector.signal.clone().or(Some(own)),
            incoming: None,
        })
    }
}

fn type_of(kind: fmu::Kind) -> Type {
    match kind {
        fmu::Kind::Float32 | fmu::Kind::Float64 => Type::Real,
        fmu::Kind::Boolean => Type::Boolean,
        fmu::Kind::Enumeration => Type::Enumeration(String::new()),
        fmu::Kind::String | fmu::Kind::Binary | fmu::Kind::Clock => Type::Other(kind.to_string()),
        _ => Type::Integer,
    }
}
