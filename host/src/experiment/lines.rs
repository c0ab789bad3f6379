//! Where the keys of a TOML text stand, for messages.

use crate::input::Place;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// The keys of a text with their lines.
pub(super) struct Lines<'a> {
    path: &'a Path,
    text: &'a str,
    table: DeTable<'a>,
}

impl<'a> Lines<'a> {
    /// Those of `text`, the contents of the file `path`, as far as it is TOML.
    pub(super) fn new(path: &'a Path, text: &'a str) -> Self {
        let (table, _) = DeTable::parse_recoverable(text);
        let table = table.into_inner();
        Self { path, text, table }
    }

    /// The place of byte `offset`, with the key that begins there or last before. Byte 0 stands for the whole text.
    pub(super) fn at(&self, offset: usize) -> Place {
        if offset == 0 {
            return self.line(0);
        }
        let mut last = (0, None);
        visit(&self.table, "", &mut |start, key| {
            if (last.0..=offset).contains(&start) {
                last = (start, Some(key.to_owned()));
            }
        });
        let place = self.line(offset);
        match last {
            (_, Some(key)) => place.at_key(key),
            (_, None) => place,
        }
    }

    fn line(&self, offset: usize) -> Place {
        let before = self.text.as_bytes().iter().take(offset);
        let line = before.filter(|byte| **byte == b'\n').count() as u64 + 1;
        Place::new(self.path.display().to_string(), Some(line))
    }

    /// The place of the innermost of nested `keys` that there is; an element of an array goes by its index.
    pub(super) fn place(&self, keys: &[&str]) -> Place {
        let Some((first, rest)) = keys.split_first() else {
            return self.line(0);
        };
        let Some((key, mut value)) = self.table.get_key_value(*first) else {
            return self.line(0);
        };
        let mut offset = key.span().start;
        let mut names = vec![*first];
        for key in rest {
            let inner = match value.get_ref() {
                DeValue::Table(table) => table.get_key_value(*key).map(|(found, value)| {
                    names.push(key);
                    (found.span().start, value)
                }),
                DeValue::Array(array) => key
                    .parse()
                    .ok()
                    .and_then(|index: usize| array.get(index))
                    .map(|value| (value.span().start, value)),
                _ => None,
            };
            let Some((start, inner)) = inner else { break };
            (offset, value) = (start, inner);
        }
        self.line(offset).at_key(names.join("."))
    }
}

/// Tells where the keys of a table and the elements of its arrays begin, outer ones before inner ones.
fn visit(table: &DeTable<'_>, prefix: &str, tell: &mut dyn FnMut(usize, &str)) {
    for (key, value) in table {
        let name = format!("{prefix}{}", key.get_ref());
        // The header of a table begins with its bracket.
        tell(key.span().start.min(value.span().start), &name);
        visit_value(value.get_ref(), &name, tell);
    }
}

fn visit_value(value: &DeValue<'_>, name: &str, tell: &mut dyn FnMut(usize, &str)) {
    match value {
        DeValue::Table(table) => visit(table, &format!("{name}."), tell),
        DeValue::Array(elements) => {
            for element in elements {
                tell(element.span().start, name);
                visit_value(element.get_ref(), name, tell);
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_in_tables_arrays_and_dotted_names() {
        let text = "a = 1\n[b]\nc.d = [1,\n 2]\n[[run]]\nname = 1\n[[run]]\nset.\"x.y\" = 2\n";
        let lines = Lines::new(Path::new("x.toml"), text);
        for (keys, place) in [
            (&["a"][..], "x.toml:1: a"),
            (&["b", "c", "d"], "x.toml:3: b.c.d"),
            (&["b", "c", "d", "1"], "x.toml:4: b.c.d"),
            (&["run", "0", "name"], "x.toml:6: run.name"),
            (&["run", "1", "set", "x.y"], "x.toml:8: run.set.x.y"),
            (&["run", "1", "nothing"], "x.toml:7: run"),
            (&["nothing"], "x.toml:1"),
        ] {
            assert_eq!(lines.place(keys).to_string(), place);
        }
    }

    #[test]
    fn a_byte_belongs_to_the_key_before_it() {
        let text = "a = 1\n[b]\nc.d = [1,\n 2]\n[[run]]\nname = 1\n[[run]]\nset.\"x.y\" = \n";
        let lines = Lines::new(Path::new("x.toml"), text);
        for (of, place) in [
            ("1", "x.toml:1: a"),
            ("[b]", "x.toml:2: b"),
            (" 2]", "x.toml:4: b.c.d"),
            ("[[run]]", "x.toml:5: run"),
            ("name", "x.toml:6: run.name"),
            ("[[run]]\nset", "x.toml:7: run"),
            ("\"x.y\" = ", "x.toml:8: run.set.x.y"),
        ] {
            assert_eq!(lines.at(text.find(of).unwrap()).to_string(), place, "{of}");
        }
    }
}
