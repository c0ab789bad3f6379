//! Values of parameters (SSP 1.0 sec 5.2.4): who is given what, and which of several values counts.

use super::bindings::mapping_file;
use super::document::{
    Binding, Child, Component, Element, Mapping, Source, System, SystemStructure, Type, Written,
};
use super::package::{Package, find, mistake, reason, syntax};
use super::read;
use super::transformation::{NamedUnit, Transformation, Unit};
use super::wiring::{Branch, Owner, Tree, Wiring};
use crate::Error;
use crate::fmu::{NameError, Scalar, Value, similar};
use crate::input::parameters::{Assignment, ParameterFile, checked};
use crate::input::{self, Place, read_text};
use model_description::ssv::{self, ParameterSet};
use std::collections::BTreeMap;

/// Values of all components and system connectors.
#[derive(Debug, Default)]
pub(super) struct Values {
    /// Start values of each component.
    pub parts: Vec<BTreeMap<Scalar, Value>>,
    /// Values of system connectors, by point, with the place where they are given.
    pub connectors: BTreeMap<usize, (f64, Place)>,
    pub warnings: Vec<String>,
}

/// A value on its way to what it is for.
#[derive(Clone, Debug)]
struct Given {
    name: String,
    text: String,
    unit: Option<NamedUnit>,
    place: Place,
    /// After the unit conversion, which may be suppressed.
    transformation: Option<Written>,
    suppress_unit_conversion: bool,
}

/// What the user gives on top of the package.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromUser<'a> {
    pub files: &'a [ParameterFile],
    pub assignments: &'a [Assignment],
}

impl Values {
    /// Reads all bindings: those of a system count more than those in it, later ones more than earlier
    /// ones. What the user gives counts most.
    pub fn new(
        package: &Package,
        structure: &SystemStructure,
        wiring: &Wiring,
        user: FromUser<'_>,
    ) -> Result<Self, Error> {
        let mut reader = Reader {
            package,
            structure,
            wiring,
            values: Self {
                parts: vec![BTreeMap::new(); wiring.parts.len()],
                ..Self::default()
            },
        };
        reader.system(&structure.system, &wiring.tree)?;
        reader.user(user)?;
        Ok(reader.values)
    }
}

/// What a binding is for.
#[derive(Clone, Copy)]
enum Target<'a> {
    System(&'a Tree),
    Part(usize),
}

struct Reader<'a> {
    package: &'a Package,
    structure: &'a SystemStructure,
    wiring: &'a Wiring,
    values: Values,
}

impl Reader<'_> {
    fn system(&mut self, system: &System, tree: &Tree) -> Result<(), Error> {
        for (child, (_, branch)) in system.children.iter().zip(&tree.children) {
            match (child, branch) {
                (Child::System(system), Branch::System(tree)) => self.system(system, tree)?,
                (Child::Component(component), Branch::Part(part, _)) => {
                    let target = Target::Part(*part);
                    self.bindings(&component.element, target, Some(component))?;
                }
                _ => {} // the tree was made from these children
            }
        }
        self.bindings(&system.element, Target::System(tree), None)
    }

    fn bindings(
        &mut self,
        element: &Element,
        target: Target<'_>,
        component: Option<&Component>,
    ) -> Result<(), Error> {
        for binding in &element.bindings {
            let (all, source) = self.given(binding, component)?;
            let mut applied = 0;
            for given in &all {
                applied += usize::from(self.apply(target, &given.name, given)?);
            }
            if applied == 0 && !all.is_empty() {
                let place = self.wiring.place(binding.line);
                let name = &element.name;
                self.values.warnings.push(format!(
                    "{place}: {name} has none of the {} parameters of {source}",
                    all.len()
                ));
            }
        }
        Ok(())
    }

    /// The values of a binding, renamed by its mapping if it has one, and what its source is called.
    fn given(
        &self,
        binding: &Binding,
        component: Option<&Component>,
    ) -> Result<(Vec<Given>, String), Error> {
        let place = self.wiring.place(binding.line);
        let (set, file) = match &binding.values {
            Source::Inline(set) => (set.clone(), self.structure.file.clone()),
            Source::File { path, in_component } => {
                let (text, file) = self.text(path, *in_component, component, &place)?;
                (ssv::read(&text, &file).map_err(read::errors)?, file)
            }
        };
        let all = given(&set, &file, &binding.prefix);
        let Some(mapping) = &binding.mapping else {
            return Ok((all, file));
        };
        let (mapping, of) = match mapping {
            Source::Inline(mapping) => (mapping.clone(), self.structure.file.clone()),
            Source::File { path, in_component } => {
                let (text, file) = self.text(path, *in_component, component, &place)?;
                (mapping_file(&text, &file)?, file)
            }
        };
        Ok((mapped(&all, &mapping, &of)?, file))
    }

    /// Text of a file in the package or in the component, and what it is called.
    fn text(
        &self,
        path: &str,
        in_component: bool,
        component: Option<&Component>,
        place: &Place,
    ) -> Result<(String, String), Error> {
        let (file, name) = match component.filter(|_| in_component) {
            Some(component) => {
                let parts = &self.wiring.parts;
                let source = self.package.name(&component.source);
                let part = parts.iter().find(|part| part.source == source);
                let folder = part.map(|part| part.fmu.folder());
                let file = folder.map_or(Err("is not there".to_owned()), |f| find(f, path));
                let wrong = |why| syntax(place.clone(), format!("source `{path}` {why}"));
                (file.map_err(wrong)?, format!("{source}/{path}"))
            }
            None => (self.package.resource(path, place)?, self.package.name(path)),
        };
        let text = read_text(&file).map_err(|error| {
            syntax(place.clone(), format!("source `{path}` {}", reason(&error)))
        })?;
        Ok((text, name))
    }

    /// Gives a value to all that its name means; whether there are any.
    fn apply(&mut self, target: Target<'_>, name: &str, given: &Given) -> Result<bool, Error> {
        match target {
            Target::Part(part) => self.give_part(part, name, given),
            Target::System(tree) => {
                let mut applied = false;
                if let Some(&point) = tree.connectors.get(name) {
                    self.give_connector(point, given)?;
                    applied = true;
                }
                for (child, branch) in &tree.children {
                    let rest = name.strip_prefix(child.as_str());
                    if let Some(rest) = rest.and_then(|rest| rest.strip_prefix('.')) {
                        let target = match branch {
                            Branch::Part(part, _) => Target::Part(*part),
                            Branch::System(tree) => Target::System(tree),
                        };
                        applied |= self.apply(target, rest, given)?;
                    }
                }
                Ok(applied)
            }
        }
    }

    fn give_part(&mut self, part: usize, name: &str, given: &Given) -> Result<bool, Error> {
        let of = &self.wiring.parts[part];
        let description = of.description();
        let title = format!("{}.{name}", of.path);
        let scalar = match description.scalar(name) {
            Ok(scalar) => scalar,
            Err(NameError::Unknown { .. }) => return Ok(false),
            Err(NameError::Array { first, last }) => {
                let message = format!("{title} is an array: give its elements {first} to {last}");
                return Err(syntax(given.place.clone(), message));
            }
        };
        let variable = description.variable(scalar);
        if !variable.settable {
            let message = format!(
                "{title} cannot be set: it is of causality {}",
                variable.causality
            );
            return Err(syntax(given.place.clone(), message));
        }
        let unit = variable.unit.as_ref().map(|name| {
            let known = of.units.get(name).cloned();
            known.unwrap_or(NamedUnit {
                name: name.clone(),
                unit: None,
            })
        });
        let text = given.text_in(unit.as_ref(), &title)?;
        let value = checked(description, scalar, &given.place, &title, &text, None)?;
        self.values.parts[part].insert(scalar, value);
        Ok(true)
    }

    fn give_connector(&mut self, point: usize, given: &Given) -> Result<(), Error> {
        let of = &self.wiring.points[point];
        let text = given.text_in(of.unit.as_ref(), &of.path)?;
        let number = match (text.trim(), &of.signal) {
            ("true", _) => Some(1.0),
            ("false", _) => Some(0.0),
            (text, Some(Type::Enumeration(name))) => {
                let items = self.structure.enumerations.get(name);
                let item = items.and_then(|items| items.iter().find(|(item, _)| item == text));
                item.map(|(_, value)| *value as f64)
            }
            (text, _) => text.parse().ok().filter(|number: &f64| number.is_finite()),
        };
        let Some(number) = number else {
            let message = format!("{} = {text:?}: expected a finite number", of.path);
            return Err(syntax(given.place.clone(), message));
        };
        let place = given.place.clone();
        self.values.connectors.insert(point, (number, place));
        Ok(())
    }

    /// Files and single values of the user: a name is looked up in the whole system, then in each component.
    fn user(&mut self, user: FromUser<'_>) -> Result<(), Error> {
        for file in user.files {
            let shown = file.to_string();
            // The part before the equals sign is an element, unless there is such a file.
            let (prefix, path) = match shown.split_once('=') {
                Some((element, path)) if !std::path::Path::new(&shown).exists() => {
                    (format!("{element}."), path.to_owned())
                }
                _ => (String::new(), shown.clone()),
            };
            let text = read_text(path.as_ref())?;
            let set = ssv::read(&text, &path).map_err(read::errors)?;
            for given in given(&set, &path, &prefix) {
                self.by_user(&given)?;
            }
        }
        for assignment in user.assignments {
            let side = assignment
                .side
                .map_or(String::new(), |side| format!("{side}."));
            let given = Given {
                name: format!("{side}{}", assignment.name.replacen(':', ".", 1)),
                text: assignment.value.clone(),
                unit: None,
                place: assignment.place.clone(),
                transformation: None,
                suppress_unit_conversion: false,
            };
            self.by_user(&given)?;
        }
        Ok(())
    }

    fn by_user(&mut self, given: &Given) -> Result<(), Error> {
        let wiring = self.wiring;
        if self.apply(Target::System(&wiring.tree), &given.name, given)? {
            return Ok(());
        }
        let mut applied = false;
        for part in 0..wiring.parts.len() {
            applied |= self.give_part(part, &given.name, given)?;
        }
        if applied {
            return Ok(());
        }
        let connectors = wiring.tree.connectors.keys().cloned();
        let variables = wiring.parts.iter().flat_map(|part| {
            let settable = part.description().variables.iter().filter(|v| v.settable);
            settable.flat_map(|v| [v.name.clone(), format!("{}.{}", part.path, v.name)])
        });
        let names: Vec<String> = connectors.chain(variables).collect();
        let similar = similar(&given.name, names.iter().map(String::as_str));
        let hint = similar
            .first()
            .map_or(String::new(), |most| format!(", did you mean {most}?"));
        let message = format!(
            "the system has nothing called {} to be set{hint}",
            given.name
        );
        Err(syntax(given.place.clone(), message))
    }
}

/// The values of a set, as they are in its file.
fn given(set: &ParameterSet, file: &str, prefix: &str) -> Vec<Given> {
    let unit = |name: &String| {
        let declared = set.units.iter().find(|unit| unit.name == *name);
        NamedUnit {
            name: name.clone(),
            unit: declared.and_then(|unit| Unit::of_attributes(unit.base.as_ref()?)),
        }
    };
    let one = |parameter: &ssv::Parameter| Given {
        name: format!("{prefix}{}", parameter.name),
        text: parameter.value.to_string(),
        unit: parameter.unit.as_ref().map(unit),
        place: Place::new(file, Some(parameter.line.into())),
        transformation: None,
        suppress_unit_conversion: false,
    };
    set.parameters.iter().map(one).collect()
}

/// What a mapping makes of values: those that it does not name are dropped (SSP 1.0 sec 7.1).
fn mapped(all: &[Given], mapping: &Mapping, file: &str) -> Result<Vec<Given>, input::Error> {
    let one = |entry: &super::document::MappingEntry| {
        let source = all.iter().find(|given| given.name == entry.source);
        let given = source.ok_or_else(|| {
            let place = Place::new(file, Some(entry.line.into()));
            let names = all.iter().map(|given| given.name.as_str());
            let hint = match similar(&entry.source, names).first() {
                Some(most) => format!(", did you mean {most}?"),
                None => String::new(),
            };
            mistake(
                place,
                format!(
                    "mapping entry: no parameter is called {}{hint}",
                    entry.source
                ),
            )
        })?;
        Ok(Given {
            name: entry.target.clone(),
            transformation: entry.transformation.clone(),
            suppress_unit_conversion: entry.suppress_unit_conversion,
            ..given.clone()
        })
    };
    mapping.entries.iter().map(one).collect()
}

impl Given {
    /// The value in the unit of what it is for, transformed, as text that reads back exactly.
    fn text_in(&self, unit: Option<&NamedUnit>, title: &str) -> Result<String, Error> {
        let wrong = |why: String| syntax(self.place.clone(), format!("{title}: {why}"));
        let conversion = match (&self.unit, unit) {
            (Some(from), Some(to)) if !self.suppress_unit_conversion => {
                from.to(to).map_err(wrong)?
            }
            _ => Transformation::identity(),
        };
        let own = match &self.transformation {
            None => Transformation::identity(),
            Some(Written::Linear { factor, offset }) => Transformation::linear(*factor, *offset),
            Some(Written::Boolean(entries)) => {
                return look_up(entries, &self.text, |t| t.parse().ok()).map_err(wrong);
            }
            Some(Written::Integer(entries)) => {
                return look_up(entries, &self.text, |t| t.parse().ok()).map_err(wrong);
            }
            Some(Written::Enumeration(entries)) => {
                return look_up(entries, &self.text, |t| Some(t.to_owned())).map_err(wrong);
            }
        };
        let whole = conversion.then(&own);
        if whole.is_identity() {
            return Ok(self.text.clone());
        }
        let number: Option<f64> = self.text.trim().parse().ok();
        let Some(number) = number.and_then(|number| whole.apply(number)) else {
            return Err(wrong(format!(
                "{:?} is no number to be converted",
                self.text
            )));
        };
        Ok(if number.fract() == 0.0 && number.abs() < 1e15 {
            format!("{number:.0}")
        } else {
            format!("{number:?}")
        })
    }
}

/// What a map has for a value.
fn look_up<T: PartialEq + std::fmt::Display>(
    entries: &[(T, T)],
    text: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<String, String> {
    let value = parse(text.trim());
    let entry = entries
        .iter()
        .find(|(from, _)| Some(from) == value.as_ref());
    entry
        .map(|(_, to)| to.to_string())
        .ok_or_else(|| format!("{text:?} is not in the mapping"))
}

/// The start value that a connector of a component has from its own chain, if it begins at a system connector.
pub(super) fn constants(wiring: &Wiring, values: &mut Values) -> Result<(), Error> {
    for target in 0..wiring.points.len() {
        let point = &wiring.points[target];
        let Owner::Part(part, scalar) = point.owner else {
            continue;
        };
        if !point.kind.is_inward() {
            continue;
        }
        let Some(origin) = wiring.origin(target)? else {
            continue;
        };
        let source = &wiring.points[origin.point];
        let place = wiring.place(origin.line);
        if let Owner::Part(..) = source.owner {
            if point.kind == super::document::Kind::Parameter {
                let message = format!(
                    "connection: {} feeds the parameter {}: only parameters of the system can",
                    source.path, point.path
                );
                return Err(syntax(place, message));
            }
            continue;
        }
        let Some((number, given)) = values.connectors.get(&origin.point) else {
            continue;
        };
        let Some(number) = origin.transformation.apply(*number) else {
            let message = format!(
                "{} = {number}: the mapping has no entry for it",
                source.path
            );
            return Err(syntax(given.clone(), message));
        };
        let description = wiring.parts[part].description();
        let variable = description.variable(scalar);
        let text = match variable.kind {
            crate::fmu::Kind::Boolean => (number != 0.0).to_string(),
            _ if number.fract() == 0.0 && number.abs() < 1e15 => format!("{number:.0}"),
            _ => format!("{number:?}"),
        };
        let value = checked(description, scalar, given, &point.path, &text, None)?;
        values.parts[part].insert(scalar, value);
    }
    Ok(())
}
