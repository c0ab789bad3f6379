//! Defects of a `modelDescription.xml` with which an FMU cannot be trusted to mean what it says, each with its
//! line: refused, while whatever else its validation finds is only a warning.

use super::description::Version;
use roxmltree::{Document, Node};
use std::collections::{HashMap, HashSet};

/// Values of `causality` and the variabilities that go with each (FMI 2.0 sec 2.2.7, FMI 3.0 sec 2.4.7.4).
const CAUSALITIES: [(&str, &[&str]); 7] = [
    ("parameter", &["fixed", "tunable"]),
    ("calculatedParameter", &["fixed", "tunable"]),
    ("structuralParameter", &["fixed", "tunable"]),
    ("input", &["discrete", "continuous"]),
    ("output", &["constant", "discrete", "continuous"]),
    (
        "local",
        &["constant", "fixed", "tunable", "discrete", "continuous"],
    ),
    ("independent", &["continuous"]),
];
const VARIABILITIES: [&str; 5] = ["constant", "fixed", "tunable", "discrete", "continuous"];
/// Defects that are listed: whoever repairs a description begins with the first.
const LISTED: usize = 20;
const INITIALS: [&str; 3] = ["exact", "approx", "calculated"];

/// A variable of either version.
struct Variable<'a> {
    /// In the list, from 1.
    position: i64,
    node: Node<'a, 'a>,
    /// Carries the type: in FMI 2.0 an element of its own.
    typed: Node<'a, 'a>,
    name: &'a str,
}

struct Check<'a> {
    document: &'a Document<'a>,
    found: Vec<String>,
    /// How many more there are.
    more: usize,
}

/// The defects of a description, the first [`LISTED`] and how many more. O(n) in its size.
pub(super) fn defects(document: &Document<'_>, version: Version) -> Vec<String> {
    let root = document.root_element();
    let variables = variables(root, version);
    let mut check = Check {
        document,
        found: Vec::new(),
        more: 0,
    };
    check.names(&variables);
    let types = types(root, version);
    for variable in &variables {
        check.roles(variable, version);
        check.declared_type(variable, &types);
    }
    check.outputs(root, version, &variables);
    if check.more > 0 {
        check.found.push(format!("and {} more", check.more));
    }
    check.found
}

fn children<'a>(root: Node<'a, 'a>, list: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    let lists = root.children().filter(move |c| c.has_tag_name(list));
    lists.flat_map(|list| list.children().filter(Node::is_element))
}

/// Variables in the order of the file. One without a name is left to the schema.
fn variables<'a>(root: Node<'a, 'a>, version: Version) -> Vec<Variable<'a>> {
    let variable = |(index, node): (usize, Node<'a, 'a>)| {
        let typed = match version {
            Version::V2 => node.first_element_child()?,
            Version::V3 => node,
        };
        let name = node.attribute("name")?;
        let position = index as i64 + 1;
        Some(Variable {
            position,
            node,
            typed,
            name,
        })
    };
    children(root, "ModelVariables")
        .enumerate()
        .filter_map(variable)
        .collect()
}

/// Values of each enumeration; None for a type of another kind.
type Types<'a> = HashMap<&'a str, Option<HashSet<i64>>>;

/// XML writes a number in more than one way.
fn integer(text: &str) -> Option<i64> {
    text.trim().parse().ok()
}

fn types<'a>(root: Node<'a, 'a>, version: Version) -> Types<'a> {
    let of = |node: Node<'a, 'a>| {
        let (list, is_enumeration) = match version {
            Version::V2 => {
                let list = node.first_element_child()?;
                (list, list.has_tag_name("Enumeration"))
            }
            Version::V3 => (node, node.has_tag_name("EnumerationType")),
        };
        let items = list.children().filter(|c| c.has_tag_name("Item"));
        let values = items.filter_map(|item| integer(item.attribute("value")?));
        Some((
            node.attribute("name")?,
            is_enumeration.then(|| values.collect()),
        ))
    };
    children(root, "TypeDefinitions").filter_map(of).collect()
}

impl Check<'_> {
    fn defect(&mut self, node: Node<'_, '_>, message: std::fmt::Arguments<'_>) {
        if self.found.len() == LISTED {
            self.more += 1;
            return;
        }
        let line = self.line(node);
        self.found.push(format!("line {line}: {message}"));
    }

    /// O(n): counted from the start of the text.
    fn line(&self, node: Node<'_, '_>) -> u32 {
        self.document.text_pos_at(node.range().start).row
    }

    /// Names of variables and of their aliases are unique (FMI 2.0 sec 2.2.7, FMI 3.0 sec 2.4.7).
    fn names(&mut self, variables: &[Variable<'_>]) {
        let mut first = HashMap::new();
        for variable in variables {
            let aliases = variable.node.children();
            let aliases = aliases.filter(|c| c.has_tag_name("Alias"));
            for node in std::iter::once(variable.node).chain(aliases) {
                let Some(name) = node.attribute("name") else {
                    continue;
                };
                if let Some(other) = first.insert(name, node) {
                    let is_listed = self.found.len() < LISTED;
                    let line = if is_listed { self.line(other) } else { 0 };
                    self.defect(
                        node,
                        format_args!(
                            "two variables are called {name}; the other stands in line {line}"
                        ),
                    );
                }
            }
        }
    }

    /// Causality, variability and initial are the standard's, and fit together.
    fn roles(&mut self, variable: &Variable<'_>, version: Version) {
        let Variable { node, name, .. } = variable;
        let causalities: Vec<_> = CAUSALITIES
            .iter()
            .map(|(causality, _)| *causality)
            .filter(|causality| version == Version::V3 || *causality != "structuralParameter")
            .collect();
        for (key, admissible) in [
            ("causality", causalities.as_slice()),
            ("variability", &VARIABILITIES),
            ("initial", &INITIALS),
        ] {
            if let Some(value) = node.attribute(key)
                && !admissible.contains(&value)
            {
                let admissible = admissible.join(", ");
                self.defect(
                    *node,
                    format_args!(
                        "variable {name}: {key} is {value}, which is none of {admissible}"
                    ),
                );
                return;
            }
        }
        let causality = node.attribute("causality").unwrap_or("local");
        let Some(variability) = node.attribute("variability") else {
            return;
        };
        let of = CAUSALITIES.iter().find(|(name, _)| *name == causality);
        if let Some((_, admissible)) = of
            && !admissible.contains(&variability)
        {
            let admissible = admissible.join(", ");
            self.defect(
                *node,
                format_args!(
                    "variable {name}: variability {variability} does not go with causality {causality}, which is {admissible}"
                ),
            );
        }
    }

    /// The type of an enumeration exists, and starts are among its items (FMI 2.0 sec 2.2.3, FMI 3.0 sec 2.4.4). Types
    /// of numbers give them no meaning, only units and ranges.
    fn declared_type(&mut self, variable: &Variable<'_>, types: &Types<'_>) {
        let Variable {
            node, typed, name, ..
        } = variable;
        let declared = typed.attribute("declaredType");
        let Some(declared) = declared.filter(|_| typed.has_tag_name("Enumeration")) else {
            return;
        };
        let Some(Some(items)) = types.get(declared) else {
            self.defect(
                *node,
                format_args!("variable {name}: no enumeration {declared}, its type, is defined"),
            );
            return;
        };
        let starts = typed.attribute("start").unwrap_or_default();
        for start in starts.split_ascii_whitespace() {
            if !integer(start).is_some_and(|start| items.contains(&start)) {
                self.defect(
                    *node,
                    format_args!("variable {name}: its start {start} is no item of the enumeration {declared}"),
                );
            }
        }
    }

    /// Each output is listed in the model structure (FMI 2.0 sec 2.2.8, FMI 3.0 sec 2.4.8).
    fn outputs(&mut self, root: Node<'_, '_>, version: Version, variables: &[Variable<'_>]) {
        let (listed, key): (Vec<_>, _) = match version {
            Version::V2 => {
                let lists = children(root, "ModelStructure");
                let outputs = lists.filter(|list| list.has_tag_name("Outputs"));
                (outputs.flat_map(|list| list.children()).collect(), "index")
            }
            Version::V3 => {
                let listed = children(root, "ModelStructure");
                let outputs = listed.filter(|unknown| unknown.has_tag_name("Output"));
                (outputs.collect(), "valueReference")
            }
        };
        let own = |node: &Node<'_, '_>, key| integer(node.attribute(key)?);
        let listed: HashSet<i64> = listed.iter().filter_map(|u| own(u, key)).collect();
        for variable in variables {
            let Variable {
                position,
                node,
                typed,
                name,
            } = variable;
            if node.attribute("causality") != Some("output") || typed.has_tag_name("Clock") {
                continue;
            }
            let reference = match version {
                Version::V2 => Some(*position),
                Version::V3 => own(node, key),
            };
            if reference.is_some_and(|reference| !listed.contains(&reference)) {
                self.defect(
                    *node,
                    format_args!(
                        "variable {name} is an output, but ModelStructure does not list it"
                    ),
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(version: Version, variables: &str, structure: &str) -> Vec<String> {
        let types = match version {
            Version::V2 => {
                "<SimpleType name='E'><Enumeration><Item name='a' value='1'/></Enumeration></SimpleType>
                 <SimpleType name='R'><Real/></SimpleType>"
            }
            Version::V3 => {
                "<EnumerationType name='E'><Item name='a' value='1'/></EnumerationType>
                 <Float64Type name='R'/>"
            }
        };
        // The variables begin in line 1.
        let types = types.replace('\n', " ");
        let text = format!(
            "<m><TypeDefinitions>{types}</TypeDefinitions><ModelVariables>{variables}</ModelVariables>
             <ModelStructure>{structure}</ModelStructure></m>"
        );
        defects(&Document::parse(&text).unwrap(), version)
    }

    fn fmi2(variables: &str, structure: &str) -> Vec<String> {
        let structure = format!("<Outputs>{structure}</Outputs>");
        of(Version::V2, variables, &structure)
    }

    fn fmi3(variables: &str, structure: &str) -> Vec<String> {
        of(Version::V3, variables, structure)
    }

    #[test]
    fn what_is_sound_passes() {
        let found = fmi2(
            "<ScalarVariable name='p' causality='parameter' variability='fixed'><Enumeration declaredType='E' start='+1'/>
             </ScalarVariable><ScalarVariable name='x'><Real declaredType='T'/></ScalarVariable>
             <ScalarVariable name='y' causality='output'><Real/></ScalarVariable>",
            "<Unknown index=' 03'/>",
        );
        assert_eq!(found, Vec::<String>::new());
        let found = fmi3(
            "<Enumeration name='p' valueReference='7' causality='parameter' declaredType='E' start='1 1'/>
             <UInt64 name='n' valueReference='1' causality='structuralParameter' variability='fixed'/>
             <Float64 name='y' valueReference='8' causality='output'><Alias name='z'/></Float64>
             <Clock name='c' valueReference='9' causality='output'/>",
            "<Output valueReference='8'/>",
        );
        assert_eq!(found, Vec::<String>::new());
    }

    #[test]
    fn every_defect_is_named_with_its_line() {
        let found = fmi2(
            "<ScalarVariable name='p' causality='parameter' variability='continuous'><Real/></ScalarVariable>
<ScalarVariable name='q' causality='structuralParameter'><Real/></ScalarVariable>
<ScalarVariable name='q' causality='output'><Enumeration declaredType='E' start='2'/></ScalarVariable>
<ScalarVariable name='r'><Enumeration declaredType='R'/></ScalarVariable>
<ScalarVariable name='s'><Enumeration declaredType='T'/></ScalarVariable>",
            "<Unknown index='2'/>",
        );
        let expected = [
            "line 3: two variables are called q; the other stands in line 2",
            "line 1: variable p: variability continuous does not go with causality parameter, which is fixed, tunable",
            "line 2: variable q: causality is structuralParameter, which is none of parameter, calculatedParameter, input, \
             output, local, independent",
            "line 3: variable q: its start 2 is no item of the enumeration E",
            "line 4: variable r: no enumeration R, its type, is defined",
            "line 5: variable s: no enumeration T, its type, is defined",
            "line 3: variable q is an output, but ModelStructure does not list it",
        ];
        assert_eq!(found, expected);
        let found = fmi3(
            "<Float64 name='x' valueReference='1' variability='sometimes'/>
<Float64 name='y' valueReference='2' causality='output' initial='guess'><Alias name='x'/></Float64>
<Float64 name='z' valueReference='3' causality='input' variability='fixed'/>",
            "<Output valueReference='1'/>",
        );
        let expected = [
            "line 2: two variables are called x; the other stands in line 1",
            "line 1: variable x: variability is sometimes, which is none of constant, fixed, tunable, discrete, continuous",
            "line 2: variable y: initial is guess, which is none of exact, approx, calculated",
            "line 3: variable z: variability fixed does not go with causality input, which is discrete, continuous",
            "line 2: variable y is an output, but ModelStructure does not list it",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_long_list_is_cut() {
        let variable = "<Float64 name='x' valueReference='1' causality='guess'/>";
        let found = fmi3(&variable.repeat(30), "");
        assert_eq!(found.len(), LISTED + 1);
        // 29 names that are taken, 30 causalities.
        assert_eq!(found[LISTED], "and 39 more");
    }
}
