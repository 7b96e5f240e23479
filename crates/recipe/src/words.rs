//! Plain words for what deserializers say.

use crate::error::shown;
use crate::names::nearest;
use serde_json::Value;

/// What a value is, with its article.
pub(crate) fn form(value: &Value) -> String {
    match value {
        Value::Null => "nothing (null)".to_owned(),
        Value::Bool(truth) => format!("the truth value {truth}"),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => format!("the text \"{}\"", shown(text, 40)),
        Value::Array(list) if list.is_empty() => "an empty list".to_owned(),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "a table".to_owned(),
    }
}

/// Message and hint of a construction error in plain words; what is not a deserializer's phrase stays as it is.
pub(crate) fn plain(message: &str) -> (String, Option<String>) {
    for phrase in ["invalid type: ", "invalid value: "] {
        let parts = message
            .strip_prefix(phrase)
            .and_then(|rest| rest.rsplit_once(", expected "));
        if let Some((found, expected)) = parts {
            let message = format!("{} where {} was expected", noun(found), wanted(expected));
            return (message, None);
        }
    }
    if let Some((length, expected)) = message
        .strip_prefix("invalid length ")
        .and_then(|rest| rest.split_once(", expected "))
    {
        let list = if length == "0" {
            "an empty list".to_owned()
        } else {
            format!("a list of {length}")
        };
        let message = match expected {
            "fewer elements in array" => format!("{list} where fewer were expected"),
            other => format!("{list} where {} was expected", wanted(other)),
        };
        return (message, None);
    }
    if let Some(name) = between(message, "missing field `", "`") {
        return (
            format!("`{name}` is missing"),
            Some(format!("add `{name}`")),
        );
    }
    if let Some(name) = between(message, "duplicate field `", "`") {
        return (
            format!("`{name}` is given twice"),
            Some("write each key once".to_owned()),
        );
    }
    for (phrase, what) in [
        ("unknown variant `", "is not known here"),
        ("unknown field `", "is not a known key"),
    ] {
        // The word itself may contain anything, so look for the end of the phrase from the right.
        let parts = message.strip_prefix(phrase).and_then(|rest| {
            rest.rsplit_once("`, expected ")
                .or_else(|| rest.rsplit_once("`, there are no "))
        });
        if let Some((word, expected)) = parts {
            let known: Vec<String> = expected
                .split('`')
                .skip(1)
                .step_by(2)
                .map(str::to_owned)
                .collect();
            let near = nearest(word, known.iter().map(String::as_str));
            let list = known.join(", ");
            let hint = match near {
                Some(near) if known.len() > 1 => {
                    format!("did you mean `{near}`? known here: {list}")
                }
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {list}"),
            };
            return (format!("`{}` {what}", shown(word, 40)), Some(hint));
        }
    }
    if message.starts_with("data did not match any variant of untagged enum") {
        return (
            "this is written in none of the forms that are understood here".to_owned(),
            None,
        );
    }
    (message.to_owned(), None)
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    text.strip_prefix(before)?.strip_suffix(after)
}

/// What was found, in a deserializer's words.
fn noun(found: &str) -> String {
    let quoted = |kind: &str| between(found, kind, "`").map(|value| shown(value, 40));
    if let Some(value) = quoted("integer `").or_else(|| quoted("floating point `")) {
        return format!("the number {value}");
    }
    if let Some(value) = quoted("boolean `") {
        return format!("the truth value {value}");
    }
    if let Some(text) = found.strip_prefix("string ") {
        // Already in quotes.
        let text = text.trim_matches('"');
        return format!("the text \"{}\"", shown(text, 40));
    }
    match found {
        "sequence" => "a list".to_owned(),
        "map" | "struct" => "a table".to_owned(),
        "null" | "unit value" | "Option value" => "nothing (null)".to_owned(),
        other => shown(other, 60),
    }
}

/// What was expected, in a deserializer's words.
fn wanted(expected: &str) -> String {
    let count = expected
        .strip_prefix("an array of length ")
        .or_else(|| expected.strip_prefix("a tuple of size "))
        .or_else(|| between(expected, "tuple of ", " elements"));
    if let Some(count) = count {
        return format!("a list of {count}");
    }
    if expected.starts_with("struct ") {
        return "a table".to_owned();
    }
    match expected {
        "f32" | "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, not negative,",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a nonzero u32" | "a nonzero usize" | "a nonzero u64" => "a whole number above 0",
        "a boolean" => "true or false",
        "a string" | "string" | "a borrowed string" => "text in quotes",
        "a sequence" => "a list",
        "a map" | "map" => "a table",
        "string or map" => "text in quotes or a table",
        other => other,
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phrases() {
        let cases = [
            (
                "invalid type: floating point `4.5`, expected a sequence",
                "the number 4.5 where a list was expected",
                "",
            ),
            (
                "invalid type: string \"a, expected b\", expected f64",
                "the text \"a, expected b\" where a number was expected",
                "",
            ),
            (
                "invalid value: integer `-3`, expected u32",
                "the number -3 where a whole number, not negative, was expected",
                "",
            ),
            (
                "invalid length 2, expected an array of length 3",
                "a list of 2 where a list of 3 was expected",
                "",
            ),
            ("missing field `angle`", "`angle` is missing", "add `angle`"),
            (
                "unknown variant `clmp`, expected one of `clamp`, `smooth`",
                "`clmp` is not known here",
                "did you mean `clamp`? known here: clamp, smooth",
            ),
            (
                "unknown field `q`, expected `radius`",
                "`q` is not a known key",
                "known here: radius",
            ),
            ("something of its own", "something of its own", ""),
        ];
        for (message, expected, hint) in cases {
            let (plain, mend) = plain(message);
            assert_eq!(
                (plain.as_str(), mend.as_deref().unwrap_or("")),
                (expected, hint)
            );
        }
    }
}
