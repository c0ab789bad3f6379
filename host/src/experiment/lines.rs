//! Where the keys of a TOML text stand, for messages.

use crate::input::Place;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys of a text with their lines.
pub(super) struct Lines<'a> {
    path: &'a Path,
    text: &'a str,
    table: DeTable<'a>,
}

impl<'a> Lines<'a> {
    /// Those of `text`, the contents of the file `path`.
    pub(super) fn new(path: &'a Path, text: &'a str) -> Self {
        let table = DeTable::parse(text).map_or_else(|_| DeTable::new(), Spanned::into_inner);
        Self { path, text, table }
    }

    /// The place of byte `offset`.
    pub(super) fn at(&self, offset: usize) -> Place {
        let before = self.text.as_bytes().iter().take(offset);
        let line = before.filter(|byte| **byte == b'\n').count() as u64 + 1;
        Place::new(self.path.display().to_string(), Some(line))
    }

    /// The place of the innermost of nested `keys` that there is; an element of an array goes by its index.
    pub(super) fn place(&self, keys: &[&str]) -> Place {
        let mut offset = 0;
        let Some((first, rest)) = keys.split_first() else {
            return self.at(0);
        };
        let Some((key, mut value)) = self.table.get_key_value(*first) else {
            return self.at(0);
        };
        offset = offset.max(key.span().start);
        for key in rest {
            let inner = match value.get_ref() {
                DeValue::Table(table) => table
                    .get_key_value(*key)
                    .map(|(key, value)| (key.span().start, value)),
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
        self.at(offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_found_in_tables_arrays_and_dotted_names() {
        let text = "a = 1\n[b]\nc.d = [1,\n 2]\n[[run]]\nname = 1\n[[run]]\nset.\"x.y\" = 2\n";
        let lines = Lines::new(Path::new("x.toml"), text);
        for (keys, line) in [
            (&["a"][..], 1),
            (&["b", "c", "d"], 3),
            (&["b", "c", "d", "1"], 4),
            (&["run", "0", "name"], 6),
            (&["run", "1", "set", "x.y"], 8),
            (&["run", "1", "nothing"], 7),
            (&["nothing"], 1),
        ] {
            assert_eq!(lines.place(keys).line, Some(line), "{keys:?}");
        }
    }
}
