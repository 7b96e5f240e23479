//! The nearest known word.

use crate::error::shown;

/// Known words listed in full in a hint.
const LISTED: usize = 16;

/// The known word that `word` was probably meant to be: the one of the fewest typing errors (Damerau–Levenshtein), if
/// they are at most a third of its letters. Case and the choice between `-`, `_` and a blank do not count.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Words this long are garbage, and the distance takes time proportional to the product of the lengths.
    if word.len() > 100 {
        return None;
    }
    let normal = |text: &str| text.trim().to_lowercase().replace(['_', ' '], "-");
    let word = normal(word);
    known
        .into_iter()
        .filter_map(|name| {
            let other = normal(name);
            let errors = strsim::damerau_levenshtein(&word, &other);
            let letters = word.chars().count().max(other.chars().count());
            (errors < letters && errors <= letters.div_ceil(3)).then_some((errors, name))
        })
        .min()
        .map(|(_, name)| name)
}

/// A hint for an unknown word: the nearest known one, and all of them if they are few.
pub(crate) fn suggestion(word: &str, known: &[String]) -> String {
    let near = nearest(word, known.iter().map(String::as_str));
    let list = match known.len() {
        0 => return "none is known here".to_owned(),
        1..=LISTED => Some(known.join(", ")),
        _ => None,
    };
    match (near, list) {
        (Some(near), Some(list)) if known.len() > 1 => {
            format!("did you mean `{near}`? known here: {list}")
        }
        (Some(near), _) => format!("did you mean `{near}`?"),
        (None, Some(list)) => format!("known here: {list}"),
        (None, None) => {
            let first = known.iter().take(LISTED).map(String::as_str);
            let list: Vec<&str> = first.collect();
            format!("known here: {}, …", shown(&list.join(", "), 300))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_are_forgiven_and_no_more() {
        let known = ["twist", "taper", "bend", "x", "y", "falloff-radius"];
        for (word, expected) in [
            ("twst", Some("twist")),
            ("TWIST", Some("twist")),
            ("tapre", Some("taper")),
            ("falloff_radius", Some("falloff-radius")),
            ("falof radius", Some("falloff-radius")),
            ("z", None),
            ("mirror", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, known), expected, "{word}");
        }
        assert_eq!(nearest(&"twist".repeat(1000), known), None);
    }
}
