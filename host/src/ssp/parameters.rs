//! Values of parameters (SSP 1.0 sec 5.2.4): who is given what, and which of several values counts.

use super::bindings::mapping_file;
use super::document::{
    Binding, Child, Component, Element, Kind, Source, System, SystemStructure, Type,
};
use super::given::{Given, given, mapped};
use super::package::{Package, find, syntax, text};
use super::read;
use super::wiring::{Branch, Owner, Tree, Wiring};
use crate::Error;
use crate::fmu::{self, NameError, Scalar, Value, hint, similar};
use crate::input::parameters::{Assignment, ParameterFile, checked};
use crate::input::{self, Place, read_text};
use model_description::ssv;
use model_description::xml::f64_text;
use std::collections::BTreeMap;
use std::path::Path;

/// Values of all components and system connectors.
#[derive(Debug, Default)]
pub(super) struct Values {
    /// Start values of each component.
    pub parts: Vec<BTreeMap<Scalar, Value>>,
    /// Values of system connectors, by point, with the place where they are given.
    pub connectors: BTreeMap<usize, (f64, Place)>,
    pub warnings: Vec<String>,
}

/// Names that a warning lists.
const SHOWN: usize = 3;

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
            let mut missing = Vec::new();
            for given in &all {
                if !self.apply(target, &given.name, given)? {
                    missing.push(given.name.as_str());
                }
            }
            let place = self.wiring.place(binding.line);
            let name = &element.name;
            if missing.len() == all.len() && !all.is_empty() {
                self.values.warnings.push(format!(
                    "{place}: {name} has none of the {} parameters of {source}",
                    all.len()
                ));
            } else if !missing.is_empty() {
                let some = &missing[..missing.len().min(SHOWN)];
                let more = if some.len() < missing.len() {
                    ", ..."
                } else {
                    ""
                };
                self.values.warnings.push(format!(
                    "{place}: {name} has no {}{more}: {} of the {} parameters of {source} go to nobody",
                    some.join(", "),
                    missing.len(),
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
        let Some(component) = component.filter(|_| in_component) else {
            return Ok((self.package.text(path, place)?, self.package.name(path)));
        };
        let source = self.package.name(&component.source);
        let mut parts = self.wiring.parts.iter();
        let part = parts.find(|part| part.source == source);
        let folder = part.map(|part| part.fmu.folder());
        let file = folder.map_or(Err("is not there".to_owned()), |f| find(f, path));
        let file = file.map_err(|why| syntax(place.clone(), format!("source `{path}` {why}")))?;
        Ok((text(&file, path, place)?, format!("{source}/{path}")))
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
        let text = given.text_in(of.unit(scalar).as_ref(), &title)?;
        let value = checked(description, scalar, &given.place, &title, &text, None)?;
        self.values.parts[part].insert(scalar, value);
        Ok(true)
    }

    fn give_connector(&mut self, point: usize, given: &Given) -> Result<(), Error> {
        let of = &self.wiring.points[point];
        let text = given.text_in(of.unit.as_ref(), &of.path)?;
        let items = match &of.signal {
            Some(Type::Enumeration(name)) => self.structure.enumerations.get(name),
            _ => None,
        };
        let number = match (text.trim(), &of.signal) {
            ("true", _) => Some(1.0),
            ("false", _) => Some(0.0),
            (text, Some(Type::Enumeration(_))) => {
                let item = items.and_then(|items| items.iter().find(|(item, _)| item == text));
                item.map(|(_, value)| *value as f64)
            }
            (text, _) => text.parse().ok().filter(|number: &f64| number.is_finite()),
        };
        let number = number.ok_or_else(|| {
            let names = |items: &Vec<(String, i64)>| {
                let names: Vec<_> = items.iter().map(|(name, _)| name.as_str()).collect();
                format!("one of {}", names.join(", "))
            };
            input::Error::Value {
                place: given.place.clone(),
                name: of.path.clone(),
                value: text.clone(),
                expected: items.map_or("a finite number".to_owned(), names),
            }
        })?;
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
                Some((element, path)) if !Path::new(&shown).exists() => {
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
            let name = format!("{side}{}", assignment.name.replacen(':', ".", 1));
            let (text, place) = (assignment.value.clone(), assignment.place.clone());
            let given = Given::plain(name, text, place);
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
        let hint = hint(&similar(&given.name, names.iter().map(String::as_str)));
        let message = format!(
            "the system has nothing called {} to be set{hint}",
            given.name
        );
        Err(syntax(given.place.clone(), message))
    }
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
            if point.kind == Kind::Parameter {
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
            fmu::Kind::Boolean => (number != 0.0).to_string(),
            _ => f64_text(number),
        };
        let value = checked(description, scalar, given, &point.path, &text, None)?;
        values.parts[part].insert(scalar, value);
    }
    Ok(())
}
