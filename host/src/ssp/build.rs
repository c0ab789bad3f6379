//! Makes the connectors and connections of a [`super::wiring::Wiring`], and finds what is wrong with them.

use super::document::{
    Child, Component, Connection, Connector, Kind, System, SystemStructure, Type, Written,
};
use super::package::{Package, mistake, syntax};
use super::read::units_of_fmu;
use super::transformation::{NamedUnit, Transformation};
use super::wiring::{Branch, Hop, Owner, Part, Point, Tree};
use crate::Error;
use crate::fmu::{self, Causality, Fmu};
use crate::input::{self, Place};
use std::collections::BTreeMap;
use std::fs;

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

struct Builder<'a> {
    package: &'a Package,
    structure: &'a SystemStructure,
    opened: BTreeMap<String, Fmu>,
    parts: Vec<Part>,
    points: Vec<Point>,
    mistakes: Vec<input::Error>,
}

impl Builder<'_> {
    fn mistake(&mut self, line: u32, message: impl Into<String>) {
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
        let text = fs::read(fmu.folder().join("modelDescription.xml")).unwrap_or_default();
        let text = String::from_utf8_lossy(&text)
            .trim_start_matches('\u{feff}')
            .to_owned();
        let units = roxmltree::Document::parse(&text)
            .map(|document| units_of_fmu(document.root_element()))
            .unwrap_or_default();
        let part = self.parts.len();
        self.parts.push(Part {
            path: path.clone(),
            source: self.package.name(&component.source),
            units,
            description: text,
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
                    fmu::NameError::Unknown { similar } => similar
                        .first()
                        .map_or(String::new(), |most| format!(", did you mean {most}?")),
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
        let of_fmu = variable.unit.as_ref().map(|name| {
            let known = part_ref.units.get(name).cloned();
            known.unwrap_or(NamedUnit {
                name: name.clone(),
                unit: None,
            })
        });
        Some(Point {
            owner: Owner::Part(part, scalar),
            path: format!("{path}.{name}"),
            kind: connector.kind,
            unit: declared.or(of_fmu),
            signal: connector.signal.clone().or(Some(own)),
            incoming: None,
        })
    }

    fn connect(&mut self, connection: &Connection, tree: &Tree) {
        let mut ends = Vec::new();
        for (element, connector) in &connection.ends {
            match self.end(tree, element.as_deref(), connector) {
                Ok((point, gives)) => ends.push((point, gives)),
                Err(why) => self.mistake(connection.line, format!("connection: {why}")),
            }
        }
        let [(a, a_gives), (b, b_gives)] = ends[..] else {
            return;
        };
        let (from, to) = match (a_gives, b_gives) {
            (true, false) => (a, b),
            (false, true) => (b, a),
            (gives, _) => {
                let both = if gives {
                    "give values, none takes them"
                } else {
                    "take values, none gives them"
                };
                let (a, b) = (&self.points[a].path, &self.points[b].path);
                let message = format!("connection: {a} and {b} both {both}");
                self.mistake(connection.line, message);
                return;
            }
        };
        if let Some(hop) = &self.points[to].incoming {
            let message = format!(
                "connection: {} is fed already by the connection in line {}",
                self.points[to].path, hop.line
            );
            self.mistake(connection.line, message);
            return;
        }
        match self.transformation(connection, from, to) {
            Ok(transformation) => {
                self.points[to].incoming = Some(Hop {
                    from,
                    transformation,
                    suppress_unit_conversion: connection.suppress_unit_conversion,
                    transformed: connection.transformation.is_some(),
                    line: connection.line,
                });
            }
            Err(why) => self.mistake(connection.line, format!("connection: {why}")),
        }
    }

    /// A connector at the end of a connection, and whether it gives values there.
    fn end(
        &self,
        tree: &Tree,
        element: Option<&str>,
        connector: &str,
    ) -> Result<(usize, bool), String> {
        let (connectors, inside) = match element {
            // An empty attribute is what some tools write for none.
            None | Some("") => (&tree.connectors, true),
            Some(name) => {
                let child = tree.children.iter().find(|(child, _)| child == name);
                match child.map(|(_, branch)| branch) {
                    Some(Branch::Part(_, connectors)) => (connectors, false),
                    Some(Branch::System(tree)) => (&tree.connectors, false),
                    None => return Err(format!("the system has no element {name}")),
                }
            }
        };
        let Some(&point) = connectors.get(connector) else {
            return Err(match element {
                Some(element) => format!("element {element} has no connector {connector}"),
                None => format!("the system has no connector {connector}"),
            });
        };
        Ok((point, self.points[point].kind.is_inward() == inside))
    }

    /// What a connection does beside unit conversion. Errors: why it cannot be made.
    fn transformation(
        &self,
        connection: &Connection,
        from: usize,
        to: usize,
    ) -> Result<Transformation, String> {
        let (from, to) = (&self.points[from], &self.points[to]);
        for end in [from, to] {
            if let Some(Type::Other(name)) = &end.signal {
                return Err(format!(
                    "{} is of type {name}: only numbers can be connected",
                    end.path
                ));
            }
        }
        let Some(written) = &connection.transformation else {
            let fits = match (&from.signal, &to.signal) {
                (None, _) | (_, None) => true,
                (Some(from), Some(to)) => {
                    from == to || is_integer(from) && (is_integer(to) || *to == Type::Real)
                }
            };
            let name = |point: &Point| {
                point
                    .signal
                    .as_ref()
                    .map_or(String::new(), ToString::to_string)
            };
            return if fits {
                Ok(Transformation::identity())
            } else {
                Err(format!(
                    "{} is of type {}, {} of type {}: a transformation must say how one becomes the other",
                    from.path,
                    name(from),
                    to.path,
                    name(to)
                ))
            };
        };
        let wrong = |point: &Point, expected: &str| match &point.signal {
            Some(found) if !expected.split(' ').any(|e| e == found.to_string()) => Some(format!(
                "{} cannot be applied to {}, which is of type {found}",
                written.name(),
                point.path
            )),
            _ => None,
        };
        let expected = match written {
            Written::Linear { .. } => "Real Integer",
            Written::Boolean(_) => "Boolean",
            Written::Integer(_) => "Integer",
            Written::Enumeration(_) => "Enumeration",
        };
        if let Some(why) = wrong(from, expected).or(wrong(to, expected)) {
            return Err(why);
        }
        self.numbers(written, from, to)
    }

    /// A transformation in numbers.
    fn numbers(
        &self,
        written: &Written,
        from: &Point,
        to: &Point,
    ) -> Result<Transformation, String> {
        Ok(match written {
            Written::Linear { factor, offset } => Transformation::linear(*factor, *offset),
            Written::Boolean(entries) => {
                let number = |truth: bool| f64::from(u8::from(truth));
                let entries = entries.iter().map(|&(a, b)| (number(a), number(b)));
                Transformation::mapping(entries.collect())
            }
            Written::Integer(entries) => {
                let entries = entries.iter().map(|&(a, b)| (a as f64, b as f64));
                Transformation::mapping(entries.collect())
            }
            Written::Enumeration(entries) => {
                let mut numbers = Vec::new();
                for (a, b) in entries {
                    numbers.push((self.item(from, a)?, self.item(to, b)?));
                }
                Transformation::mapping(numbers)
            }
        })
    }

    /// The value of an enumeration's item: of the FMU, or as the file declares it.
    fn item(&self, point: &Point, name: &str) -> Result<f64, String> {
        let of_fmu = match point.owner {
            Owner::Part(part, scalar) => {
                let items = &self.parts[part].description().variable(scalar).items;
                items.iter().find(|i| i.name == name).map(|i| i.value)
            }
            _ => None,
        };
        let declared = match &point.signal {
            Some(Type::Enumeration(of)) => self.structure.enumerations.get(of),
            _ => None,
        };
        let declared = declared.and_then(|items| items.iter().find(|(item, _)| item == name));
        of_fmu
            .or(declared.map(|(_, value)| *value))
            .map(|value| value as f64)
            .ok_or_else(|| format!("{} has no item {name}", point.path))
    }
}

/// Whether a type is that of integers: enumerations travel as such (SSP 1.0 sec 4.4.1).
fn is_integer(signal: &Type) -> bool {
    matches!(signal, Type::Integer | Type::Enumeration(_))
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
