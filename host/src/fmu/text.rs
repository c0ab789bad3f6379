//! Numbers and names for messages.

/// A number for people: powers of ten rather than rows of zeros.
pub fn short(number: f64) -> String {
    if number != 0.0 && !(1e-3..1e5).contains(&number.abs()) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// At most three of `names` that resemble `name`, the most similar first.
pub(crate) fn similar<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut scored: Vec<_> = names
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(score, _)| *score > 0.8)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored
        .into_iter()
        .take(3)
        .map(|(_, n)| n.to_owned())
        .collect()
}

/// The most similar of [`similar`] names as the end of a message, if there is one.
pub(crate) fn hint(similar: &[String]) -> String {
    let most = similar.first();
    most.map_or(String::new(), |most| format!(", did you mean {most}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn similar_names_are_suggested() {
        let names = ["nmpc.horizon", "nmpc.period", "arm.inertia"];
        assert_eq!(similar("nmpc.horizn", names.into_iter())[0], "nmpc.horizon");
        assert!(similar("zzz", names.into_iter()).is_empty());
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1e-9, 0.000_25, 0.5, -31.62, 1e6].map(short);
        assert_eq!(texts, ["0", "1e-9", "2.5e-4", "0.5", "-31.62", "1e6"]);
    }
}
