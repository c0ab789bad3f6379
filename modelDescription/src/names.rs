//! Names of variables and the names that Rust knows them by.

/// Rust keywords, which no segment of a name may be: it becomes a field.
const KEYWORDS: [&str; 40] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate",
    "do", "dyn", "else", "enum", "extern", "final", "fn", "for", "gen", "if", "impl", "in", "let",
    "loop", "macro", "match", "mod", "move", "mut", "pub", "ref", "return", "self", "static",
    "struct", "trait", "type", "use", "where", "while",
];

/// Fields that lead to the value of a variable: `nmpc.plan.angle` is `nmpc`, `plan`, `angle`, and
/// `der(angle)` is `der_angle`. None if the name is not dotted snake case or `der(...)` of it.
pub(crate) fn path(name: &str) -> Option<Vec<String>> {
    if let Some(of) = name.strip_prefix("der(").and_then(|n| n.strip_suffix(')')) {
        let mut segments = path(of)?;
        segments[0].insert_str(0, "der_");
        return Some(segments);
    }
    let segments: Vec<_> = name.split('.').map(str::to_owned).collect();
    segments
        .iter()
        .all(|s| is_snake_case(s) && !KEYWORDS.contains(&s.as_str()))
        .then_some(segments)
}

/// Lower-case words of letters and digits, joined by single underscores.
pub(crate) fn is_snake_case(name: &str) -> bool {
    let word = |w: &str| {
        !w.is_empty()
            && w.bytes()
                .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit())
    };
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.split('_').all(word)
}

/// Letters and digits, beginning with a capital.
pub(crate) fn is_camel_case(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.bytes().all(|b| b.is_ascii_alphanumeric())
}

/// `goal_projected` as `GoalProjected`.
pub(crate) fn camel_case(snake: &str) -> String {
    snake
        .split('_')
        .flat_map(|word| {
            let mut chars = word.chars();
            chars
                .next()
                .map(|c| c.to_ascii_uppercase())
                .into_iter()
                .chain(chars)
        })
        .collect()
}

/// The Rust struct of the group that holds these fields: `Variables` at the top, `NmpcPlan` below.
pub(crate) fn group_type(path: &[String]) -> String {
    match path {
        [] => "Variables".to_owned(),
        path => path.iter().map(|s| camel_case(s)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_field_paths() {
        assert_eq!(path("arm.inertia").unwrap(), ["arm", "inertia"]);
        assert_eq!(path("der(angle)").unwrap(), ["der_angle"]);
        for bad in [
            "", "arm.", "Arm.x", "a[1]", "a b", "loop", "arm.type", "1a", "a__b", "der(a", "_a",
        ] {
            assert_eq!(path(bad), None, "{bad}");
        }
    }

    #[test]
    fn types_are_camel_case() {
        assert_eq!(camel_case("goal_projected"), "GoalProjected");
        assert_eq!(group_type(&path("nmpc.plan").unwrap()), "NmpcPlan");
        assert_eq!(group_type(&[]), "Variables");
    }
}
