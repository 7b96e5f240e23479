//! The page `docs/benchmarks.md`.

use super::bars::{Bar, Verdict, judge};
use super::measured::{Group, Row, Throughput};
use std::fmt::Write as _;

const NOTES_START: &str = "<!-- notes -->";
const NOTES_END: &str = "<!-- /notes -->";
const FIRST_NOTES: &str = "\nWhat stands here, between the two marks, is written by hand and kept when the page is written anew.\n";

/// The machine that measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    /// The processor's model; nothing when the system does not say.
    pub processor: Option<String>,
    /// How many threads can run at once; nothing when the system does not say.
    pub cores: Option<usize>,
}

impl Machine {
    /// This machine.
    #[must_use]
    pub fn this() -> Self {
        let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Self {
            processor: model(&cpuinfo),
            cores: std::thread::available_parallelism().ok().map(usize::from),
        }
    }
}

/// The processor's model in the text of `/proc/cpuinfo`.
fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    let model = line.split_once(':')?.1.trim();
    (!model.is_empty()).then(|| model.to_owned())
}

/// The part of a page that is written by hand; nothing when it has none.
///
/// # Errors
/// When only one of the two marks is there, or they are in the wrong order: then it is not known what to keep.
pub fn notes(page: &str) -> Result<Option<String>, String> {
    match (page.find(NOTES_START), page.find(NOTES_END)) {
        (None, None) => Ok(None),
        (Some(start), Some(end)) if start < end => {
            Ok(Some(page[start + NOTES_START.len()..end].to_owned()))
        }
        _ => Err(format!(
            "the notes must stand between `{NOTES_START}` and `{NOTES_END}`; set the marks right"
        )),
    }
}

/// The whole page.
#[must_use]
pub fn write(
    groups: &[Group],
    bars: &[Bar],
    machine: &Machine,
    quick: bool,
    notes: Option<&str>,
) -> String {
    let mut page = String::from("# Benchmarks\n\n");
    let processor = machine
        .processor
        .as_deref()
        .unwrap_or("a processor that does not give its name");
    let cores = machine
        .cores
        .map(|n| format!(", {n} {}", if n == 1 { "core" } else { "cores" }))
        .unwrap_or_default();
    page.push_str("Written by `cargo xtask bench`; run that to measure again (`--quick` for a rough look, `FILTER…` for some of the groups).\n\n");
    let _ = writeln!(page, "Measured on: {processor}{cores}.");
    if quick {
        page.push_str(
            "The last run was a quick one: expect ratios to vary by some tens of percent.\n",
        );
    }
    page.push_str(
        "\nTimes are medians. A ratio compares two times of the same run: the baseline's divided by the row's, for the \
         same amount of work, so more is faster. Ratios carry over to other machines far better than times do.\n\n",
    );
    let _ = writeln!(
        page,
        "{NOTES_START}{}{NOTES_END}\n",
        notes.unwrap_or(FIRST_NOTES)
    );
    page.push_str(&tables(groups, bars));
    page
}

/// The tables alone: bars, then a table for each group.
#[must_use]
pub fn tables(groups: &[Group], bars: &[Bar]) -> String {
    let mut text = String::new();
    if !bars.is_empty() {
        text.push_str("## Bars\n\n| group | row | over | asked | measured | | note |\n| --- | --- | --- | ---: | ---: | --- | --- |\n");
        for bar in bars {
            let (measured, verdict) = match judge(bar, groups) {
                Verdict::Met(ratio) => (ratio_text(ratio), "met"),
                Verdict::Missed(ratio) => (ratio_text(ratio), "MISSED"),
                Verdict::NotMeasured => ("–".to_owned(), "not measured"),
            };
            let cells = [&bar.group, &bar.row, &bar.over].map(|name| cell(name));
            let asked = ratio_text(bar.at_least);
            let _ = writeln!(
                text,
                "| {} | {asked} | {measured} | {verdict} | {} |",
                cells.join(" | "),
                cell(&bar.note)
            );
        }
        text.push('\n');
    }
    for group in groups {
        let _ = writeln!(text, "## {}\n", group.name);
        text.push_str(
            "| row | time | per element | rate | ratio |\n| --- | ---: | ---: | ---: | ---: |\n",
        );
        for row in &group.rows {
            let ratio = group.baseline_of(row).map_or("–".to_owned(), |baseline| {
                ratio_text(row.speed_over(baseline))
            });
            let (each, rate) = per_element(row);
            let _ = writeln!(
                text,
                "| {} | {} | {each} | {rate} | {ratio} |",
                cell(&row.id()),
                duration(row.time)
            );
        }
        text.push('\n');
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Text that cannot end a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Time per element and rate; a nanosecond for each is a thousand million in a second.
fn per_element(row: &Row) -> (String, String) {
    match row.throughput {
        Some(Throughput::Elements(elements)) => {
            let each = row.time / elements;
            (
                format!("{} ns/element", digits(each)),
                format!("{} M elements/s", digits(1000.0 / each)),
            )
        }
        Some(Throughput::Bytes(bytes)) => {
            let each = row.time / bytes;
            (
                format!("{} ns/byte", digits(each)),
                format!("{} MB/s", digits(1000.0 / each)),
            )
        }
        None => ("–".to_owned(), "–".to_owned()),
    }
}

/// Nanoseconds in the unit that leaves one to three digits before the point.
fn duration(nanoseconds: f64) -> String {
    let units = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")];
    let (size, unit) = units
        .into_iter()
        .find(|(size, _)| nanoseconds >= *size)
        .unwrap_or((1.0, "ns"));
    format!("{} {unit}", digits(nanoseconds / size))
}

fn ratio_text(ratio: f64) -> String {
    format!(
        "{}×",
        if ratio >= 100.0 {
            format!("{ratio:.0}")
        } else {
            format!("{ratio:.2}")
        }
    )
}

/// Three digits that count, without an exponent.
fn digits(value: f64) -> String {
    if !value.is_finite() || value <= 0.0 {
        return value.to_string();
    }
    // 999.5 shows as four digits and no fraction; that is the same as for 1000.
    let before_point = value.log10().floor() as i32 + 1;
    let decimals = usize::try_from((3 - before_point).max(0)).unwrap_or(0);
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::super::measured::{groups, made_up};
    use super::*;

    fn run() -> Vec<Group> {
        let copy = |function: &str, time| Row {
            throughput: Some(Throughput::Bytes(8000.0)),
            ..made_up("copy", function, None, time)
        };
        groups(vec![
            made_up("lattice", "baseline: array of structures", None, 27_800.0),
            made_up("lattice", "kernel | blocks", None, 5_000.0),
            copy("one thread", 1_600.0),
            Row {
                throughput: None,
                ..made_up("whole", "", None, 2.5e9)
            },
        ])
    }

    fn bars() -> Vec<Bar> {
        let bar = |row: &str, at_least| Bar {
            group: "lattice".into(),
            row: row.into(),
            over: "baseline: array of structures".into(),
            at_least,
            note: "asked for".into(),
        };
        vec![
            bar("kernel | blocks", 4.0),
            bar("kernel | blocks", 6.0),
            bar("gone", 1.0),
        ]
    }

    fn machine() -> Machine {
        Machine {
            processor: Some("A Processor @ 2 GHz".into()),
            cores: Some(2),
        }
    }

    #[test]
    fn tables_have_time_rate_and_ratio_within_the_group() {
        let expected = "\
## Bars

| group | row | over | asked | measured | | note |
| --- | --- | --- | ---: | ---: | --- | --- |
| lattice | kernel \\| blocks | baseline: array of structures | 4.00× | 5.56× | met | asked for |
| lattice | kernel \\| blocks | baseline: array of structures | 6.00× | 5.56× | MISSED | asked for |
| lattice | gone | baseline: array of structures | 1.00× | – | not measured | asked for |

## copy

| row | time | per element | rate | ratio |
| --- | ---: | ---: | ---: | ---: |
| one thread | 1.60 µs | 0.200 ns/byte | 5000 MB/s | – |

## lattice

| row | time | per element | rate | ratio |
| --- | ---: | ---: | ---: | ---: |
| baseline: array of structures | 27.8 µs | 27.8 ns/element | 36.0 M elements/s | 1.00× |
| kernel \\| blocks | 5.00 µs | 5.00 ns/element | 200 M elements/s | 5.56× |

## whole

| row | time | per element | rate | ratio |
| --- | ---: | ---: | ---: | ---: |
| whole | 2.50 s | – | – | – |
";
        assert_eq!(tables(&run(), &bars()), expected);
    }

    #[test]
    fn the_page_says_how_and_where_it_was_measured() {
        let page = write(&run(), &[], &machine(), false, None);
        assert!(
            page.contains("`cargo xtask bench`")
                && page.contains("Measured on: A Processor @ 2 GHz, 2 cores.\n")
        );
        assert!(!page.contains("quick one") && !page.contains("## Bars"));
        assert!(write(&run(), &[], &machine(), true, None).contains("a quick one"));
        let nameless = Machine {
            processor: None,
            cores: None,
        };
        assert!(write(&run(), &[], &nameless, false, None).contains("does not give its name.\n"));
    }

    #[test]
    fn notes_are_kept_when_the_page_is_written_again() {
        let first = write(&run(), &bars(), &machine(), false, None);
        assert_eq!(notes(&first), Ok(Some(FIRST_NOTES.to_owned())));
        let by_hand = "\nKept: <b>as it is</b>\n\n| even | tables |\n";
        let second = write(&run(), &[], &machine(), true, Some(by_hand));
        let kept = notes(&second).expect("marks");
        assert_eq!(kept.as_deref(), Some(by_hand));
        assert_eq!(
            write(&run(), &[], &machine(), true, kept.as_deref()),
            second
        );
    }

    #[test]
    fn notes_that_are_not_closed_are_an_error_and_not_lost() {
        assert_eq!(notes("# Page\n"), Ok(None));
        assert!(notes("a <!-- notes --> b").is_err());
        assert!(notes("a <!-- /notes --> b <!-- notes -->").is_err());
    }

    #[test]
    fn numbers_have_three_digits_that_count() {
        let shown = [
            0.001_234,
            0.2,
            5.0,
            12.34,
            99.96,
            123.4,
            5000.0,
            1_234_567.0,
        ]
        .map(digits);
        assert_eq!(
            shown,
            [
                "0.00123", "0.200", "5.00", "12.3", "100.0", "123", "5000", "1234567"
            ]
        );
        let times = [0.5, 999.0, 1000.0, 2.5e6, 6.0e10].map(duration);
        assert_eq!(
            times,
            ["0.500 ns", "999 ns", "1.00 µs", "2.50 ms", "60.0 s"]
        );
    }

    #[test]
    fn the_processor_is_found_in_what_the_system_says() {
        let text = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: A Processor\nprocessor\t: 1\nmodel name\t: B\n";
        assert_eq!(model(text).as_deref(), Some("A Processor"));
        assert_eq!(model("model name\t:\n"), None);
        assert_eq!(model("Hardware : Board\n"), None);
    }
}
