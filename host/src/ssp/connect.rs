//! Makes the connections of a [`super::wiring::Wiring`]: who feeds whom, and what becomes of the value.

use super::build::Builder;
use super::document::{Connection, Type, Written};
use super::transformation::Transformation;
use super::wiring::{Branch, Hop, Owner, Point, Tree};

impl Builder<'_> {
    /// Makes a connection of the system whose content is `tree`.
    pub fn connect(&mut self, connection: &Connection, tree: &Tree) {
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
            let fits = |from: &Type, to: &Type| {
                from == to || is_integer(from) && (is_integer(to) || *to == Type::Real)
            };
            return match (&from.signal, &to.signal) {
                (Some(a), Some(b)) if !fits(a, b) => Err(format!(
                    "{} is of type {a}, {} of type {b}: a transformation must say how one becomes the other",
                    from.path, to.path
                )),
                _ => Ok(Transformation::identity()),
            };
        };
        let expected: &[Type] = match written {
            Written::Linear { .. } => &[Type::Real, Type::Integer],
            Written::Boolean(_) => &[Type::Boolean],
            Written::Integer(_) => &[Type::Integer],
            Written::Enumeration(_) => &[],
        };
        for end in [from, to] {
            match &end.signal {
                Some(Type::Enumeration(_)) if matches!(written, Written::Enumeration(_)) => {}
                Some(found) if !expected.contains(found) => {
                    return Err(format!(
                        "{} cannot be applied to {}, which is of type {found}",
                        written.name(),
                        end.path
                    ));
                }
                _ => {}
            }
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
