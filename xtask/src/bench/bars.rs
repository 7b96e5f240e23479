//! The ratios that are asked for, from `tests/benches/bars.toml`.
//!
//! ```toml
//! [[bar]]
//! group = "lattice 4×4×4"               # the criterion group
//! row = "kernel"                        # the row that must be fast
//! over = "baseline: array of structures" # the row it is compared with, of the same group
//! at_least = 4.0                        # the least ratio: time of `over` divided by time of `row`
//! note = "why"                          # optional
//! ```
//!
//! A bar below 1 says how much slower a row may be: "within 1.3×" is `at_least = 0.77`.

use super::measured::{Group, Row};
use crate::document::{NotToml, Table, Value};

/// One ratio that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// The criterion group.
    pub group: String,
    /// The row that must be fast.
    pub row: String,
    /// The row it is compared with.
    pub over: String,
    /// The least ratio.
    pub at_least: f64,
    /// Why; may be empty.
    pub note: String,
}

/// How a bar fared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The ratio is at least what is asked.
    Met(f64),
    /// It is less.
    Missed(f64),
    /// One of the rows was not measured.
    NotMeasured,
}

/// Reads the file.
///
/// # Errors
/// The line, and what is wrong there: no TOML, an unknown key, a missing one or one of the wrong type.
pub fn read(text: &str) -> Result<Vec<Bar>, NotToml> {
    let table = Table::parse(text)?;
    if let Some(stray) = table.entries.iter().find(|e| e.key != "bar") {
        return Err(wrong(
            stray.line,
            format!(
                "`{}` means nothing here; every entry is a [[bar]]",
                stray.key
            ),
        ));
    }
    let bars = table.get("bar").map_or(&[][..], |e| e.value.items());
    bars.iter()
        .map(|(line, bar)| read_bar(*line, bar))
        .collect()
}

fn read_bar(line: usize, value: &Value) -> Result<Bar, NotToml> {
    let table = value
        .as_table()
        .ok_or_else(|| wrong(line, "write each bar as [[bar]]".to_owned()))?;
    if let Some(stray) = table
        .entries
        .iter()
        .find(|e| !["group", "row", "over", "at_least", "note"].contains(&e.key.as_str()))
    {
        return Err(wrong(
            stray.line,
            format!("a bar has no key `{}`", stray.key),
        ));
    }
    let text = |key: &str| match table.text(key) {
        Some(text) => Ok(text.to_owned()),
        None => Err(wrong(line, format!("the bar has no `{key} = \"…\"`"))),
    };
    let at_least = match table.get("at_least").map(|e| &e.value) {
        Some(Value::Number(least)) if *least > 0.0 => *least,
        _ => {
            return Err(wrong(
                line,
                "the bar has no `at_least` with a number above zero".to_owned(),
            ));
        }
    };
    let note = if table.get("note").is_some() {
        text("note")?
    } else {
        String::new()
    };
    Ok(Bar {
        group: text("group")?,
        row: text("row")?,
        over: text("over")?,
        at_least,
        note,
    })
}

fn wrong(line: usize, message: String) -> NotToml {
    NotToml { line, message }
}

/// How the bar fared.
#[must_use]
pub fn judge(bar: &Bar, groups: &[Group]) -> Verdict {
    let find = |id: &str| -> Option<&Row> {
        groups
            .iter()
            .find(|g| g.name == bar.group)
            .and_then(|g| g.rows.iter().find(|r| r.id() == id))
    };
    match (find(&bar.row), find(&bar.over)) {
        (Some(row), Some(over)) => {
            let ratio = row.speed_over(over);
            if ratio >= bar.at_least {
                Verdict::Met(ratio)
            } else {
                Verdict::Missed(ratio)
            }
        }
        _ => Verdict::NotMeasured,
    }
}

#[cfg(test)]
mod tests {
    use super::super::measured::{groups, made_up};
    use super::*;

    const TEXT: &str = "[[bar]]\ngroup = \"g\"\nrow = \"kernel/4\"\nover = \"baseline: plain\"\nat_least = 4\nnote = \"n\"\n";

    #[test]
    fn bars_are_read() {
        let bar = Bar {
            group: "g".into(),
            row: "kernel/4".into(),
            over: "baseline: plain".into(),
            at_least: 4.0,
            note: "n".into(),
        };
        assert_eq!(read(TEXT), Ok(vec![bar]));
        assert_eq!(read(""), Ok(Vec::new()));
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        let cases = [
            (TEXT.replace("note", "nota"), 6, "`nota`"),
            (TEXT.replace("row = \"kernel/4\"\n", ""), 1, "`row"),
            (TEXT.replace("= 4", "= \"4\""), 1, "`at_least`"),
            (TEXT.replace("= 4", "= 0"), 1, "`at_least`"),
            (TEXT.replace("= 4", "= = 4"), 5, ""),
            (format!("x = 1\n{TEXT}"), 1, "`x`"),
        ];
        for (text, line, message) in cases {
            let error = read(&text).expect_err(&text);
            assert_eq!(error.line, line, "{error:?}");
            assert!(error.message.contains(message), "{error:?}");
        }
    }

    #[test]
    fn a_bar_is_met_missed_or_not_measured() {
        let bar = read(TEXT).expect("bars").remove(0);
        let run = |time: f64| {
            groups(vec![
                made_up("g", "baseline: plain", None, 4000.0),
                made_up("g", "kernel", Some("4"), time),
            ])
        };
        assert_eq!(judge(&bar, &run(800.0)), Verdict::Met(5.0));
        assert_eq!(judge(&bar, &run(1000.0)), Verdict::Met(4.0));
        assert_eq!(judge(&bar, &run(2000.0)), Verdict::Missed(2.0));
        assert_eq!(judge(&bar, &run(1000.0)[..0]), Verdict::NotMeasured);
        let other = groups(vec![
            made_up("other", "kernel", Some("4"), 1.0),
            made_up("g", "baseline: plain", None, 1.0),
        ]);
        assert_eq!(judge(&bar, &other), Verdict::NotMeasured);
    }
}
