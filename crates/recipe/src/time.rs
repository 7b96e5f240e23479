//! Recipes over time: tracks of keyed values, and schedules of strengths.
//!
//! Time runs from 0 to 1. A `[[track]]` sets one value of the recipe by keys; a warp's `schedule` says when its strengths rise from 0 to
//! 1, feature by feature if need be; `[time]` says the way and the ease of warps without one. A recipe that says nothing of time goes from
//! the model as it is to the full warp evenly.
//!
//! *Source*: Milliron et al. 2002, §8.1 (four ways: the result blended, transformations or strengths scaled, targets moved), with errata
//! F19; *Interpolation Techniques*, chapter 2 ("articulation variables": any parameter over time). The notation is a decision.

use crate::Recipe;
use crate::error::{OF_TRACK, Problem, RecipeError, quoted};
use crate::names::{nearest, suggestion};
use crate::set::{put, words};
use crate::tree::{Part, join};
use crate::words::form;
use anamorph_curves::eases::{self, Ease};
use serde_json::{Map, Value};
use std::sync::Arc;

/// Words of `way`, in the paper's order; the fourth is what tracks of targets do.
pub(crate) const WAYS: [&str; 3] = ["result", "transformations", "strengths"];
/// Keys of `[time]`.
const TIME_KEYS: [&str; 4] = ["way", "ease", "dissolve", "path"];
/// Keys of a `[[track]]`.
const TRACK_KEYS: [&str; 3] = ["set", "keys", "ease"];
/// Keys of a `schedule`.
const SCHEDULE_KEYS: [&str; 4] = ["start", "end", "ease", "features"];

/// How much of a warp is in force at a time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Share {
    /// Whether the result is blended (the first way) or strengths are multiplied.
    pub(crate) blend: bool,
    /// Of features without a schedule of their own.
    pub(crate) common: f64,
    /// Of single features, by number.
    pub(crate) features: Vec<f64>,
}

impl Recipe {
    /// Whether the recipe says anything of time.
    pub fn is_timed(&self) -> bool {
        let warps = self.tree.get("warp").and_then(Value::as_array);
        self.tree.contains_key("track")
            || self.tree.contains_key("time")
            || warps.is_some_and(|list| list.iter().any(|w| w.get("schedule").is_some()))
    }

    /// The recipe at a time from 0 (nothing has happened) to 1 (all has): its tracks have set their values, and its schedules will be in
    /// force when it is built.
    ///
    /// # Errors
    ///
    /// Tracks, schedules and a `[time]` that cannot be understood, all of them, by their lines; values of a track that do not go over into
    /// each other.
    pub fn at(&self, time: f64) -> Result<Self, RecipeError> {
        let time = if time.is_nan() {
            0.0
        } else {
            time.clamp(0.0, 1.0)
        };
        let mut problems = Vec::new();
        self.check_time(&mut problems);
        if let Some(error) = RecipeError::of(&self.source.name, problems) {
            return Err(error);
        }
        let mut recipe = self.clone();
        for (number, track) in self.tracks() {
            let path = format!("track.{number}");
            let value = self.track_value(&path, track, time)?;
            let target = track.get("set").and_then(Value::as_str).unwrap_or_default();
            let origin: Arc<str> = format!("{target} at time {time}{OF_TRACK}").into();
            put(
                &mut recipe.tree,
                &mut recipe.spans,
                &words(target),
                value,
                &origin,
            )
            .map_err(|(_, message, hint)| {
                let at = join(&path, "set");
                self.one(self.problem(&at, Part::Value, message, hint))
            })?;
        }
        recipe.time = Some(time);
        Ok(recipe)
    }

    fn one(&self, problem: Problem) -> RecipeError {
        RecipeError::one(&self.source.name, problem)
    }

    /// How many tracks there are. They count only for [`Recipe::at`]; a recipe that is built without a time has the values that are written
    /// in its warps.
    pub fn track_count(&self) -> usize {
        self.tracks().count()
    }

    fn tracks(&self) -> impl Iterator<Item = (usize, &Map<String, Value>)> {
        let list = self.tree.get("track").and_then(Value::as_array);
        let entries = list.into_iter().flatten().enumerate();
        entries.filter_map(|(number, track)| Some((number, track.as_object()?)))
    }

    /// What is wrong with everything that is about time.
    pub(crate) fn check_time(&self, problems: &mut Vec<Problem>) {
        if let Some(time) = self.tree.get("time") {
            match time.as_object() {
                None => {
                    let message = format!("`time` is a table, and this is {}", form(time));
                    problems.push(self.problem("time", Part::Value, message, "write [time]"));
                }
                Some(table) => {
                    self.unknown(table, "time", &TIME_KEYS, problems);
                    self.check_ease(table, "time", problems);
                    self.check_way(table, problems);
                    self.check_morph(table, problems);
                }
            }
        }
        match self.tree.get("track") {
            None => {}
            Some(Value::Array(list)) => {
                for (number, track) in list.iter().enumerate() {
                    self.check_track(&format!("track.{number}"), track, problems);
                }
                self.check_rivals(problems);
            }
            Some(other) => {
                let message = format!("`track` is a list of tables, and this is {}", form(other));
                let hint = "begin each track with [[track]]";
                problems.push(self.problem("track", Part::Key, message, hint));
            }
        }
        for (number, table) in self.warp_tables(&mut Vec::new()) {
            if let Some(schedule) = table.get("schedule") {
                let path = format!("warp.{number}.schedule");
                self.check_schedule(&path, schedule, true, problems);
                if self.way() == Some(WAYS[0]) && schedule.get("features").is_some() {
                    let message = "the way `result` blends the warped model as a whole, not feature by feature";
                    let hint = "take another `way` under [time], or leave out `features`";
                    let at = join(&path, "features");
                    problems.push(self.problem(&at, Part::Key, message, hint));
                }
            }
        }
    }

    fn unknown(
        &self,
        table: &Map<String, Value>,
        path: &str,
        known: &[&str],
        problems: &mut Vec<Problem>,
    ) {
        let known: Vec<String> = known.iter().map(|&key| key.to_owned()).collect();
        for key in table.keys().filter(|key| !known.contains(key)) {
            let message = format!("unknown key {}", quoted(key));
            let hint = suggestion(key, &known);
            problems.push(self.problem(&join(path, key), Part::Key, message, hint));
        }
    }

    pub(crate) fn check_ease(
        &self,
        table: &Map<String, Value>,
        path: &str,
        problems: &mut Vec<Problem>,
    ) {
        let Some(value) = table.get("ease") else {
            return;
        };
        if let Err(message) = ease(Some(value)) {
            let all = "`anamorph list eases` names them all";
            // The nearest name is of more use than all of them.
            let (message, near) = match message.split_once("; there are:") {
                Some((short, _)) => {
                    let names = eases::registry().iter().map(|entry| entry.name);
                    (
                        short.to_owned(),
                        nearest(value.as_str().unwrap_or_default(), names),
                    )
                }
                None => (message, None),
            };
            let hint = near.map_or(all.to_owned(), |name| {
                format!("did you mean `{name}`? {all}")
            });
            problems.push(self.problem(&join(path, "ease"), Part::Value, message, hint));
        }
    }

    fn check_way(&self, table: &Map<String, Value>, problems: &mut Vec<Problem>) {
        let Some(way) = table.get("way") else { return };
        if way.as_str().is_none_or(|word| !WAYS.contains(&word)) {
            let message = format!("{} is no way to vary a warp", form(way));
            let hint = "write \"result\", \"transformations\" or \"strengths\"; targets move by a [[track]]";
            problems.push(self.problem("time.way", Part::Value, message, hint));
        }
    }

    fn way(&self) -> Option<&str> {
        let time = self.tree.get("time").and_then(Value::as_object);
        time.and_then(|t| t.get("way")).and_then(Value::as_str)
    }

    /// Tracks that set one value, or a value and something inside of it.
    fn check_rivals(&self, problems: &mut Vec<Problem>) {
        let mut seen: Vec<(usize, Vec<&str>)> = Vec::new();
        for (number, track) in self.tracks() {
            let Some(set) = track.get("set").and_then(Value::as_str) else {
                continue;
            };
            let path = words(set);
            let rival = seen.iter().find(|(_, other)| {
                let common = path.len().min(other.len());
                path[..common] == other[..common]
            });
            if let Some((rival, _)) = rival {
                let message = format!("track {rival} sets this value, too");
                let hint = "set each value by one track";
                let at = format!("track.{number}.set");
                problems.push(self.problem(&at, Part::Value, message, hint));
            }
            seen.push((number, path));
        }
    }

    /// The recipe at every time at which a track has a key, to be checked like any other: its first and last times among them.
    ///
    /// # Errors
    ///
    /// As [`Recipe::at`].
    pub fn at_keys(&self) -> Result<Vec<Self>, RecipeError> {
        let keys = self
            .tracks()
            .filter_map(|(_, track)| track.get("keys")?.as_array());
        let times = keys.flatten().filter_map(|key| key.get(0)?.as_f64());
        let mut times: Vec<f64> = times.chain([0.0, 1.0]).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times.into_iter().map(|time| self.at(time)).collect()
    }

    fn check_track(&self, path: &str, track: &Value, problems: &mut Vec<Problem>) {
        let Some(table) = track.as_object() else {
            let message = format!("a track is a table, and this is {}", form(track));
            problems.push(self.problem(path, Part::Value, message, "begin it with [[track]]"));
            return;
        };
        self.unknown(table, path, &TRACK_KEYS, problems);
        self.check_ease(table, path, problems);
        let set = join(path, "set");
        match table.get("set") {
            Some(Value::String(text)) if words(text).iter().all(|word| !word.is_empty()) => {
                let first = words(text)[0].to_owned();
                if first != "warp" && first != "grid" {
                    let message = format!("{} is not inside of a warp", quoted(text));
                    let hint = "name a value of a warp, such as \"warp.0.angle\"";
                    problems.push(self.problem(&set, Part::Value, message, hint));
                }
            }
            other => {
                let message = match other {
                    None => "the track does not say what it sets".to_owned(),
                    Some(other) => format!("{} is no path", form(other)),
                };
                let part = if other.is_none() {
                    Part::Key
                } else {
                    Part::Value
                };
                let at = if other.is_none() { path } else { &set };
                let hint = "write `set = \"warp.0.angle\"`: keys and numbers with dots between";
                problems.push(self.problem(at, part, message, hint));
            }
        }
        let keys = join(path, "keys");
        let Some(list) = table.get("keys").and_then(Value::as_array) else {
            let hint = "write `keys = [[0, 0], [1, 90]]`: times from 0 to 1, each with a value";
            problems.push(self.problem(path, Part::Key, "the track has no list of keys", hint));
            return;
        };
        if list.is_empty() {
            let hint = "add one, such as [0, 90]";
            problems.push(self.problem(&keys, Part::Value, "the track has no keys", hint));
        }
        let mut before = f64::NEG_INFINITY;
        for (number, key) in list.iter().enumerate() {
            let at = format!("{keys}.{number}");
            let Some([time, _]) = key.as_array().map(Vec::as_slice) else {
                let hint = "write a time and a value, such as [0.5, \"30deg\"]";
                problems.push(self.problem(&at, Part::Value, "a key is a pair", hint));
                return;
            };
            match time.as_f64().filter(|time| (0.0..=1.0).contains(time)) {
                Some(time) if time > before => before = time,
                Some(_) => {
                    let hint = "write the keys in the order of their times, each time once";
                    let message = "this time is not after the one before it";
                    problems.push(self.problem(&at, Part::Value, message, hint));
                }
                None => {
                    let message = format!("the time is {}", form(time));
                    let hint = "times are numbers from 0 to 1";
                    problems.push(self.problem(&at, Part::Value, message, hint));
                }
            }
        }
        for (number, pair) in list.windows(2).enumerate() {
            if let Some(message) = between(&pair[0][1], &pair[1][1], 0.5).err() {
                let at = format!("{keys}.{}", number + 1);
                let hint = "give the values of a track one form: numbers, numbers with one unit, lists of the same length";
                problems.push(self.problem(&at, Part::Value, message, hint));
            }
        }
    }

    pub(crate) fn check_schedule(
        &self,
        path: &str,
        schedule: &Value,
        whole: bool,
        problems: &mut Vec<Problem>,
    ) {
        let Some(table) = schedule.as_object() else {
            let message = format!("a schedule is a table, and this is {}", form(schedule));
            let hint = "write { start = 0.2, end = 0.8 }, times from 0 to 1";
            problems.push(self.problem(path, Part::Value, message, hint));
            return;
        };
        let keys = if whole {
            &SCHEDULE_KEYS[..]
        } else {
            &SCHEDULE_KEYS[..3]
        };
        self.unknown(table, path, keys, problems);
        self.check_ease(table, path, problems);
        let mut times = [0.0, 1.0];
        for (key, time) in ["start", "end"].into_iter().zip(&mut times) {
            let Some(value) = table.get(key) else {
                continue;
            };
            match value.as_f64().filter(|time| (0.0..=1.0).contains(time)) {
                Some(given) => *time = given,
                None => {
                    let message = format!("{} is no time", form(value));
                    let hint = "times are numbers from 0 to 1";
                    problems.push(self.problem(&join(path, key), Part::Value, message, hint));
                }
            }
        }
        if times[1] < times[0] {
            let message = "the schedule ends before it starts";
            let hint = "write an `end` that is not less than `start`";
            problems.push(self.problem(path, Part::Value, message, hint));
        }
        match table.get("features") {
            None => {}
            Some(Value::Array(list)) => {
                for (number, schedule) in list.iter().enumerate() {
                    let path = format!("{path}.features.{number}");
                    self.check_schedule(&path, schedule, false, problems);
                }
            }
            Some(other) => {
                let message = format!(
                    "`features` is a list of schedules, and this is {}",
                    form(other)
                );
                let hint = "write one a feature, in their order: [{ end = 0.5 }, { start = 0.5 }]";
                problems.push(self.problem(&join(path, "features"), Part::Value, message, hint));
            }
        }
    }

    fn track_value(
        &self,
        path: &str,
        track: &Map<String, Value>,
        time: f64,
    ) -> Result<Value, RecipeError> {
        let keys = track.get("keys").and_then(Value::as_array);
        let keys: Vec<(f64, &Value)> = keys
            .into_iter()
            .flatten()
            .filter_map(|key| Some((key.get(0)?.as_f64()?, key.get(1)?)))
            .collect();
        let (Some(first), Some(last)) = (keys.first(), keys.last()) else {
            return Ok(Value::Null);
        };
        if time <= first.0 {
            return Ok(keys
                .get(1)
                .map_or(first.1.clone(), |next| with_unit(first.1, next.1)));
        }
        if time >= last.0 {
            let before = keys.len().checked_sub(2).map(|i| keys[i].1);
            return Ok(before.map_or(last.1.clone(), |before| with_unit(last.1, before)));
        }
        let after = keys.partition_point(|key| key.0 <= time);
        let ((from, a), (to, b)) = (keys[after - 1], keys[after]);
        let share = (time - from) / (to - from);
        let share = ease(track.get("ease")).map_or(share, |ease| ease.value(share));
        between(a, b, share).map_err(|message| {
            let at = format!("{path}.keys.{after}");
            self.one(self.problem(&at, Part::Value, message, ""))
        })
    }

    /// How much of a warp is in force; nothing where the recipe is not at a time.
    pub(crate) fn share(&self, table: &Map<String, Value>) -> Option<Share> {
        let time = self.time?;
        let common = self.tree.get("time").and_then(Value::as_object);
        let blend = self.way() == Some(WAYS[0]);
        let schedule = table.get("schedule").and_then(Value::as_object);
        let Some(schedule) = schedule else {
            // Tracks are a clock of their own.
            let still = common.is_none() && self.tree.contains_key("track");
            let share = if still {
                1.0
            } else {
                ease(common.and_then(|t| t.get("ease"))).map_or(time, |ease| ease.value(time))
            };
            return Some(Share {
                blend,
                common: share,
                features: Vec::new(),
            });
        };
        let usual = schedule.get("ease").or(common.and_then(|t| t.get("ease")));
        let number = |of: &Map<String, Value>, key: &str, default: f64| {
            of.get(key).and_then(Value::as_f64).unwrap_or(default)
        };
        let (start, end) = (number(schedule, "start", 0.0), number(schedule, "end", 1.0));
        let share = |of: &Map<String, Value>| {
            let (start, end) = (number(of, "start", start), number(of, "end", end));
            let x = if time >= end {
                1.0
            } else if time <= start {
                0.0
            } else {
                (time - start) / (end - start)
            };
            ease(of.get("ease").or(usual)).map_or(x, |ease| ease.value(x))
        };
        let features = schedule.get("features").and_then(Value::as_array);
        let features = features.into_iter().flatten().filter_map(Value::as_object);
        Some(Share {
            blend,
            common: share(schedule),
            features: features.map(share).collect(),
        })
    }
}

/// The ease that a recipe names; none is linear.
pub(crate) fn ease(value: Option<&Value>) -> Result<Box<dyn Ease>, String> {
    match value {
        None => Ok(Box::new(eases::Linear)),
        Some(Value::String(text)) => eases::parse(text).map_err(|error| error.to_string()),
        Some(other) => Err(format!(
            "an ease is text in quotes, and this is {}",
            form(other)
        )),
    }
}

/// A number with what stands behind it.
pub(crate) fn unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text
        .char_indices()
        .find(|(i, c)| {
            let exponent = matches!(c, 'e' | 'E')
                && text[i + 1..].starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+');
            !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+') || exponent)
        })
        .map_or(text.len(), |(i, _)| i);
    let number: f64 = text[..end].parse().ok()?;
    number.is_finite().then_some((number, text[end..].trim()))
}

/// A value, nothing (0) with the unit of the one beside it.
fn with_unit(value: &Value, beside: &Value) -> Value {
    match (value, beside) {
        (Value::Number(x), Value::String(text)) if x.as_f64() == Some(0.0) => {
            unit(text).map_or(value.clone(), |(_, of)| Value::from(format!("0{of}")))
        }
        (Value::Array(x), Value::Array(y)) => {
            Value::Array(x.iter().zip(y).map(|(a, b)| with_unit(a, b)).collect())
        }
        (Value::Object(x), Value::Object(y)) => {
            let each = x.iter().map(|(key, a)| {
                let beside = y.get(key).unwrap_or(&Value::Null);
                (key.clone(), with_unit(a, beside))
            });
            Value::Object(each.collect())
        }
        _ => value.clone(),
    }
}

/// A unit of angles as a share of a turn.
fn turn(unit: &str) -> Option<f64> {
    match unit {
        "turn" => Some(1.0),
        "deg" => Some(1.0 / 360.0),
        "rad" => Some(1.0 / core::f64::consts::TAU),
        _ => None,
    }
}

/// The value between two of one form: numbers, numbers with one unit, lists and tables of them; of anything else the first.
fn between(a: &Value, b: &Value, share: f64) -> Result<Value, String> {
    let mix = |a: f64, b: f64| {
        if share == 0.0 {
            a
        } else if share == 1.0 {
            b
        } else {
            a + (b - a) * share
        }
    };
    let unlike = || match (a, b) {
        (Value::Array(x), Value::Array(y)) => format!(
            "a list of {} does not go over into a list of {}",
            x.len(),
            y.len()
        ),
        _ => format!("{} does not go over into {}", form(a), form(b)),
    };
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = x.as_f64().zip(y.as_f64()).ok_or_else(unlike)?;
            Ok(Value::from(mix(x, y)))
        }
        (Value::String(x), Value::String(y)) => match (unit(x), unit(y)) {
            (Some((x, of)), Some((y, other))) if of == other => {
                Ok(Value::from(format!("{}{of}", mix(x, y))))
            }
            (Some((x, of)), Some((y, other))) if turn(of).zip(turn(other)).is_some() => {
                let turns = |of| turn(of).unwrap_or(1.0);
                let here = y * turns(other) / turns(of);
                Ok(Value::from(format!("{}{of}", mix(x, here))))
            }
            (None, None) => Ok(a.clone()),
            _ => Err(format!(
                "{} and {} have different units",
                quoted(x),
                quoted(y)
            )),
        },
        // Nothing is nothing in any unit.
        (Value::Number(x), Value::String(text)) | (Value::String(text), Value::Number(x))
            if x.as_f64() == Some(0.0) && unit(text).is_some_and(|(_, of)| !of.is_empty()) =>
        {
            let (size, of) = unit(text).unwrap_or_default();
            let (from, to) = if a.is_number() {
                (0.0, size)
            } else {
                (size, 0.0)
            };
            Ok(Value::from(format!("{}{of}", mix(from, to))))
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            let each = x.iter().zip(y).map(|(a, b)| between(a, b, share));
            Ok(Value::Array(each.collect::<Result<_, _>>()?))
        }
        (Value::Object(x), Value::Object(y)) if x.keys().eq(y.keys()) => {
            let each = x
                .iter()
                .zip(y)
                .map(|((key, a), (_, b))| Ok((key.clone(), between(a, b, share)?)));
            Ok(Value::Object(each.collect::<Result<_, String>>()?))
        }
        (Value::Bool(_), Value::Bool(_)) => Ok(a.clone()),
        _ => Err(unlike()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn recipe(text: &str) -> Recipe {
        Recipe::read(text.as_bytes(), "test.toml").unwrap()
    }

    const KEYED: &str = r#"
version = 1
[[warp]]
kind = "twist"
angle = "10deg"
[[warp]]
kind = "points"
pairs = [{ source = [0, 0], target = [1, 1] }]
[[track]]
set = "warp.0.angle"
keys = [[0.25, "10deg"], [0.5, "50deg"], [1, "30deg"]]
[[track]]
set = "warp.1.pairs.0.target"
keys = [[0, [0, 0]], [1, [4, "2"]]]
"#;

    #[test]
    fn tracks_set_values_between_their_keys() {
        let text = KEYED.replace("\"2\"", "2");
        let recipe = recipe(&text);
        let at = |time: f64| recipe.at(time).unwrap().tree;
        for (time, angle) in [
            (0.0, "10deg"),
            (0.375, "30deg"),
            (0.5, "50deg"),
            (0.75, "40deg"),
            (7.0, "30deg"),
        ] {
            assert_eq!(at(time)["warp"][0]["angle"], json!(angle), "{time}");
        }
        assert_eq!(at(0.5)["warp"][1]["pairs"][0]["target"], json!([2.0, 1.0]));
        // A recipe with tracks alone is in full force at all times.
        let middle = recipe.at(0.5).unwrap();
        let table = middle.tree["warp"][0].as_object().unwrap();
        assert_eq!(middle.share(table).unwrap().common, 1.0);
        assert!(recipe.share(table).is_none());
    }

    #[test]
    fn what_does_not_go_over_is_an_error_at_its_key() {
        let error = recipe(KEYED).at(0.5).unwrap_err().to_string();
        assert!(
            error.contains("test.toml:14") && error.contains("does not go over"),
            "{error}"
        );
        let wrong = [
            ("\"50deg\"", "\"50%\"", "different units"),
            ("[0.5, ", "[0.2, ", "not after the one before"),
            ("[1, \"30deg\"]", "[2, \"30deg\"]", "from 0 to 1"),
            (
                "set = \"warp.0.angle\"",
                "set = \"version\"",
                "not inside of a warp",
            ),
            (
                "set = \"warp.0.angle\"",
                "sets = \"warp.0.angle\"",
                "did you mean `set`",
            ),
            (
                "set = \"warp.0.angle\"",
                "set = \"warp.9.angle\"",
                "2 entries",
            ),
        ];
        for (from, to, message) in wrong {
            let text = KEYED.replace("\"2\"", "2").replacen(from, to, 1);
            let error = recipe(&text).at(0.5).unwrap_err().to_string();
            assert!(error.contains(message), "{to}: {error}");
        }
    }

    #[test]
    fn schedules_say_how_much_is_in_force() {
        let text = "version = 1\n[time]\nway = \"transformations\"\n[[warp]]\nkind = \"twist\"\n\
            schedule = { start = 0.2, end = 0.6, features = [{ end = 0.4 }, { start = 0.5, ease = \"steps(1)\" }] }\n\
            [[warp]]\nkind = \"bend\"\n";
        let recipe = recipe(text);
        let share = |time: f64, warp: usize| {
            let recipe = recipe.at(time).unwrap();
            recipe
                .share(recipe.tree["warp"][warp].as_object().unwrap())
                .unwrap()
        };
        let at = share(0.3, 0);
        assert!(!at.blend);
        assert!((at.common - 0.25).abs() < 1e-12 && (at.features[0] - 0.5).abs() < 1e-12);
        assert_eq!(at.features[1], 0.0);
        assert_eq!(share(0.6, 0).features, [1.0, 1.0]);
        assert_eq!((share(0.0, 0).common, share(1.0, 0).common), (0.0, 1.0));
        assert_eq!(share(0.3, 1).common, 0.3);
        for (from, to, message) in [
            ("end = 0.6", "end = 0.1", "ends before it starts"),
            ("\"transformations\"", "\"targets\"", "no way to vary"),
            (
                "\"transformations\"",
                "\"result\"",
                "not feature by feature",
            ),
            ("steps(1)", "wobble", "wobble"),
            ("features = [", "feature = [", "unknown key"),
        ] {
            let text = text.replacen(from, to, 1);
            let broken = Recipe::read(text.as_bytes(), "test.toml").unwrap();
            let error = broken.at(0.5).unwrap_err().to_string();
            assert!(error.contains(message), "{to}: {error}");
        }
    }
}
