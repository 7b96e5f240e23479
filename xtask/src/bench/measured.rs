//! What criterion measured, read from the files it leaves.
//!
//! Each row has a folder with `new/benchmark.json` (its names and how much one iteration handles) and
//! `new/estimates.json` (nanoseconds for one iteration; the median is used, as the mean carries every hiccup of the
//! machine).

use serde_json::Value;
use std::path::Path;
use std::time::SystemTime;

/// How much one iteration handles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Throughput {
    /// So many elements: points, samples.
    Elements(f64),
    /// So many bytes.
    Bytes(f64),
}

/// One row: a function of a group, possibly with a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The group.
    pub group: String,
    /// The function; empty when the group is one function alone.
    pub function: String,
    /// The parameter it was measured with.
    pub parameter: Option<String>,
    /// Median time of one iteration in nanoseconds.
    pub time: f64,
    /// How much one iteration handles.
    pub throughput: Option<Throughput>,
    /// Whether this run measured it.
    pub fresh: bool,
}

/// The rows of one group, ready to print: baselines first, then by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Its rows, at least one.
    pub rows: Vec<Row>,
}

impl Row {
    /// What the row is called within its group, as criterion has it: `function/parameter`.
    #[must_use]
    pub fn id(&self) -> String {
        match (self.function.as_str(), &self.parameter) {
            ("", None) => self.group.clone(),
            ("", Some(parameter)) => parameter.clone(),
            (function, None) => function.to_owned(),
            (function, Some(parameter)) => format!("{function}/{parameter}"),
        }
    }

    /// Whether other rows are compared with this one.
    #[must_use]
    pub fn is_baseline(&self) -> bool {
        self.function.starts_with("baseline")
    }

    /// How many times faster this row is than `other`: for the same amount of work when both say how much they do in
    /// the same unit, else for one iteration.
    #[must_use]
    pub fn speed_over(&self, other: &Self) -> f64 {
        match (self.throughput, other.throughput) {
            (Some(Throughput::Elements(mine)), Some(Throughput::Elements(theirs)))
            | (Some(Throughput::Bytes(mine)), Some(Throughput::Bytes(theirs))) => {
                (other.time / theirs) / (self.time / mine)
            }
            _ => other.time / self.time,
        }
    }
}

impl Group {
    /// The row that `row` is compared with: the baseline with the same parameter, else one that has none.
    #[must_use]
    pub fn baseline_of(&self, row: &Row) -> Option<&Row> {
        let with = |parameter: &Option<String>| {
            self.rows
                .iter()
                .find(|r| r.is_baseline() && r.parameter == *parameter)
        };
        with(&row.parameter).or_else(|| with(&None))
    }
}

/// Reads every row below criterion's folder. A row is fresh when it was written after `start`.
///
/// # Errors
/// The file and what is wrong with it.
pub fn read(results: &Path, start: SystemTime) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    if results.exists() {
        walk(results, start, &mut rows).map_err(|e| format!("{}: {e}", results.display()))?;
    }
    rows.into_iter().collect()
}

fn walk(
    folder: &Path,
    start: SystemTime,
    rows: &mut Vec<Result<Row, String>>,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if !path.is_dir() {
            continue;
        }
        let (names, times) = (path.join("benchmark.json"), path.join("estimates.json"));
        if path.ends_with("new") && names.is_file() && times.is_file() {
            let fresh = std::fs::metadata(&times)?
                .modified()
                .is_ok_and(|written| written >= start);
            let row = row(
                &std::fs::read_to_string(&names)?,
                &std::fs::read_to_string(&times)?,
                fresh,
            );
            rows.push(row.map_err(|what| format!("{}: {what}", path.display())));
        } else {
            walk(&path, start, rows)?;
        }
    }
    Ok(())
}

/// A row from the two files.
fn row(names: &str, times: &str, fresh: bool) -> Result<Row, String> {
    let names: Value = serde_json::from_str(names).map_err(|e| format!("benchmark.json: {e}"))?;
    let times: Value = serde_json::from_str(times).map_err(|e| format!("estimates.json: {e}"))?;
    let text = |key: &str| names.get(key).and_then(Value::as_str).map(str::to_owned);
    let time = times
        .pointer("/median/point_estimate")
        .and_then(Value::as_f64);
    Ok(Row {
        group: text("group_id").ok_or("benchmark.json: no group_id")?,
        function: text("function_id").unwrap_or_default(),
        parameter: text("value_str"),
        time: time
            .filter(|t| *t > 0.0)
            .ok_or("estimates.json: no median above zero")?,
        throughput: names.get("throughput").and_then(throughput),
        fresh,
    })
}

fn throughput(value: &Value) -> Option<Throughput> {
    let number = |at: &str| {
        value
            .pointer(at)
            .and_then(Value::as_f64)
            .filter(|n| *n > 0.0)
    };
    let elements = number("/Elements").or_else(|| number("/ElementsAndBytes/elements"));
    let bytes = || number("/Bytes").or_else(|| number("/BytesDecimal"));
    elements
        .map(Throughput::Elements)
        .or_else(|| bytes().map(Throughput::Bytes))
}

/// Sorts rows into groups. Of a group that this run measured, rows of earlier runs are left out.
#[must_use]
pub fn groups(mut rows: Vec<Row>) -> Vec<Group> {
    rows.sort_by(|a, b| {
        order(a)
            .partial_cmp(&order(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut groups: Vec<Group> = Vec::new();
    for row in rows {
        match groups.last_mut().filter(|g| g.name == row.group) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group {
                name: row.group.clone(),
                rows: vec![row],
            }),
        }
    }
    for group in &mut groups {
        if group.rows.iter().any(|row| row.fresh) {
            group.rows.retain(|row| row.fresh);
        }
    }
    groups
}

/// By group; baselines first; parameters that are numbers by their size.
fn order(row: &Row) -> (&str, bool, &str, f64, Option<&str>) {
    let parameter = row.parameter.as_deref();
    let size = parameter
        .and_then(|p| p.parse().ok())
        .filter(|size: &f64| !size.is_nan())
        .unwrap_or(f64::INFINITY);
    (
        &row.group,
        !row.is_baseline(),
        &row.function,
        size,
        parameter,
    )
}

#[cfg(test)]
pub(crate) fn made_up(group: &str, function: &str, parameter: Option<&str>, time: f64) -> Row {
    Row {
        group: group.to_owned(),
        function: function.to_owned(),
        parameter: parameter.map(str::to_owned),
        time,
        throughput: Some(Throughput::Elements(1000.0)),
        fresh: true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::testing::Sketch;
    use std::time::Duration;

    const TIMES: &str =
        r#"{"mean":{"point_estimate":9.0},"median":{"point_estimate":2500.0},"slope":null}"#;

    fn names(function: &str, parameter: &str, throughput: &str) -> String {
        format!(
            r#"{{"group_id":"sum: f64","function_id":{function},"value_str":{parameter},"throughput":{throughput}}}"#
        )
    }

    #[test]
    fn rows_are_read_from_criterions_folders_and_the_last_run_is_told_from_earlier_ones() {
        let sketch = Sketch::new()
            .file(
                "sum_ f64/baseline_ fold/new/benchmark.json",
                names("\"baseline: fold\"", "null", "{\"Elements\":10}"),
            )
            .file("sum_ f64/baseline_ fold/new/estimates.json", TIMES)
            .file("sum_ f64/baseline_ fold/base/estimates.json", TIMES)
            .file(
                "sum_ f64/par/32/new/benchmark.json",
                names("\"par\"", "\"32\"", "{\"Bytes\":80}"),
            )
            .file("sum_ f64/par/32/new/estimates.json", TIMES)
            .file(
                "alone/new/benchmark.json",
                r#"{"group_id":"alone","function_id":null,"value_str":null}"#,
            )
            .file("alone/new/estimates.json", TIMES);
        let hour = Duration::from_secs(3600);
        let mut rows = read(sketch.path(), SystemTime::now() - hour).expect("rows");
        rows.sort_by_key(Row::id);
        let seen: Vec<_> = rows
            .iter()
            .map(|r| (r.id(), r.time, r.throughput, r.fresh))
            .collect();
        assert_eq!(
            seen,
            [
                ("alone".to_owned(), 2500.0, None, true),
                (
                    "baseline: fold".to_owned(),
                    2500.0,
                    Some(Throughput::Elements(10.0)),
                    true
                ),
                (
                    "par/32".to_owned(),
                    2500.0,
                    Some(Throughput::Bytes(80.0)),
                    true
                ),
            ]
        );
        assert!(
            read(sketch.path(), SystemTime::now() + hour)
                .expect("rows")
                .iter()
                .all(|r| !r.fresh)
        );
        assert_eq!(
            read(&sketch.path().join("absent"), SystemTime::now()),
            Ok(Vec::new())
        );
    }

    #[test]
    fn files_that_are_damaged_are_named() {
        let sketch = Sketch::new().file("a/new/benchmark.json", names("null", "null", "null"));
        let sketch = sketch.file(
            "a/new/estimates.json",
            r#"{"median":{"point_estimate":0.0}}"#,
        );
        let error = read(sketch.path(), SystemTime::now()).expect_err("no time");
        assert!(
            error.contains("estimates.json: no median above zero"),
            "{error}"
        );
        assert!(
            row("{", TIMES, true)
                .expect_err("no JSON")
                .starts_with("benchmark.json: ")
        );
    }

    #[test]
    fn throughput_prefers_elements() {
        let of = |text: &str| throughput(&serde_json::from_str(text).expect("JSON"));
        assert_eq!(
            of(r#"{"ElementsAndBytes":{"elements":3,"bytes":24}}"#),
            Some(Throughput::Elements(3.0))
        );
        assert_eq!(of(r#"{"BytesDecimal":24}"#), Some(Throughput::Bytes(24.0)));
        assert_eq!(of("null"), None);
    }

    #[test]
    fn rows_are_ordered_baseline_first_and_numbers_by_size() {
        let rows = vec![
            made_up("b", "kernel", Some("32"), 1.0),
            made_up("b", "kernel", Some("4"), 1.0),
            made_up("b", "baseline: plain", None, 1.0),
            made_up("b", "kernel", Some("all"), 1.0),
            made_up("a", "x", None, 1.0),
        ];
        let groups = groups(rows);
        assert_eq!(
            groups.iter().map(|g| g.name.as_str()).collect::<Vec<_>>(),
            ["a", "b"]
        );
        let ids: Vec<String> = groups[1].rows.iter().map(Row::id).collect();
        assert_eq!(
            ids,
            ["baseline: plain", "kernel/4", "kernel/32", "kernel/all"]
        );
    }

    #[test]
    fn a_group_never_mixes_runs() {
        let stale = |group: &str, function: &str| Row {
            fresh: false,
            ..made_up(group, function, None, 1.0)
        };
        let rows = vec![
            stale("a", "baseline"),
            made_up("a", "x", None, 1.0),
            stale("b", "baseline"),
            stale("b", "y"),
        ];
        let groups = groups(rows);
        assert_eq!(
            groups.iter().map(|g| g.rows.len()).collect::<Vec<_>>(),
            [1, 2]
        );
        assert_eq!(groups[0].rows[0].function, "x");
    }

    #[test]
    fn the_baseline_is_the_one_with_the_same_parameter() {
        let rows = vec![
            made_up("g", "baseline", Some("4"), 1.0),
            made_up("g", "baseline", Some("32"), 2.0),
            made_up("g", "x", Some("32"), 1.0),
            made_up("g", "x", Some("64"), 1.0),
        ];
        let group = &groups(rows)[0];
        assert_eq!(group.baseline_of(&group.rows[2]).map(|r| r.time), Some(2.0));
        assert_eq!(group.baseline_of(&group.rows[3]), None);
        let mut rows = group.rows.clone();
        rows.push(made_up("g", "baseline", None, 7.0));
        let group = &groups(rows)[0];
        let last = group.rows.last().expect("a row");
        assert_eq!(
            (last.id().as_str(), group.baseline_of(last).map(|r| r.time)),
            ("x/64", Some(7.0))
        );
    }

    #[test]
    fn speed_is_compared_for_the_same_amount_of_work() {
        let thousand = made_up("g", "x", None, 500.0);
        let slow = made_up("g", "baseline", None, 1000.0);
        assert_eq!(thousand.speed_over(&slow), 2.0);
        let twice_the_work = Row {
            throughput: Some(Throughput::Elements(2000.0)),
            ..slow.clone()
        };
        assert_eq!(thousand.speed_over(&twice_the_work), 1.0);
        let unknown = Row {
            throughput: None,
            ..slow
        };
        assert_eq!(thousand.speed_over(&unknown), 2.0);
    }
}
