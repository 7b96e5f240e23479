//! `speed`: an ease, or distances, speeds or accelerations at times.

use super::path::refused;
use super::values::{Values, below, read, share, short, unknown};
use anamorph_catalog::ConstructError;
use anamorph_curves::CurveError;
use anamorph_curves::eases::{self, Ease, EaseParameter, Setting};
use anamorph_curves::motion::{
    AccelerationKey, AccelerationTime, Between, DistanceKey, DistanceTime, Eased, SpeedChange,
    SpeedControl, SpeedKey, SpeedTime,
};
use serde_json::Value;

/// A speed control with what became of what was asked for.
pub(super) struct Built {
    pub(super) control: Box<dyn SpeedControl>,
    pub(super) changes: Vec<SpeedChange>,
    /// The distance that the recipe asks for, if it does.
    pub(super) asked: Option<f64>,
    /// Keys that nobody will see.
    pub(super) notes: Vec<String>,
}

/// A control of which there is nothing to say.
fn quiet(control: Box<dyn SpeedControl>) -> Built {
    Built {
        control,
        changes: Vec::new(),
        asked: None,
        notes: Vec::new(),
    }
}

/// What there is to say of keys at these times that are later than the end of the motion.
pub(super) fn late(what: &str, times: &[f64], duration: f64) -> Option<String> {
    let beyond = |time: &f64| *time > duration * (1.0 + 1e-12);
    let first = times.iter().position(beyond)?;
    let last = times.iter().rposition(beyond)?;
    let which = if first == last {
        format!("key {first} of {what}, at {},", short(times[first]))
    } else {
        format!(
            "keys {first} to {last} of {what}, from {} to {},",
            short(times[first]),
            short(times[last])
        )
    };
    let verb = if first == last { "is" } else { "are" };
    Some(format!(
        "{which} {verb} later than the end of the motion, {}: it breaks off there; write times as shares of the duration, such as \
         \"50%\", for keys that follow it",
        short(duration)
    ))
}

/// Words of `repair`.
pub(super) const REPAIRS: [&str; 2] = ["monotone", "free"];
/// Words of `between`.
pub(super) const BETWEEN: [&str; 3] = ["smooth", "linear", "hold"];
/// The distance that is whatever the keys make of it.
pub(super) const AS_DRAWN: &str = "as-drawn";
/// What marks a key whose number is kept.
pub(super) const FIXED: &str = "fixed";

/// What a speed may refer to.
struct Scale {
    /// The whole path.
    total: f64,
    duration: Option<f64>,
}

impl Scale {
    /// What there is to say of keys at these times.
    fn late(&self, what: &str, times: &[f64]) -> Vec<String> {
        let duration = self.duration.into_iter();
        duration.filter_map(|end| late(what, times, end)).collect()
    }
}

/// A control from the table of a motion.
pub(super) fn build(
    table: &Values<'_>,
    total: f64,
    duration: Option<f64>,
) -> Result<Built, ConstructError> {
    let scale = Scale { total, duration };
    let value = match table.get("speed") {
        None => {
            return Ok(quiet(eased(
                table,
                Box::new(eases::Linear),
                total,
                duration,
            )?));
        }
        Some(Value::String(text)) => {
            let ease = eases::parse(text).map_err(|error| ease_refused("speed", text, &error))?;
            return Ok(quiet(eased(table, ease, total, duration)?));
        }
        Some(value) => value,
    };
    let speed = table.inside(value, "speed")?;
    let kinds = ["ease", "distances", "speeds", "accelerations"];
    let given: Vec<&str> = kinds
        .into_iter()
        .filter(|kind| speed.get(kind).is_some())
        .collect();
    match given.as_slice() {
        ["ease"] => {
            let asked = speed.share("distance", total)?;
            let ease = ease(&speed)?;
            Ok(Built {
                asked,
                ..quiet(eased(table, ease, asked.unwrap_or(total), duration)?)
            })
        }
        ["distances"] => distances(&speed, &scale),
        ["speeds"] => speeds(&speed, &scale),
        [_] => accelerations(&speed, &scale),
        [] => Err(
            ConstructError::new("speed", "the speed does not say what it is").with_hint(
                "write an ease in quotes, or one of `ease`, `distances`, `speeds`, `accelerations`",
            ),
        ),
        [one, other, ..] => Err(ConstructError::new(
            below("speed", other),
            format!("`{one}` and `{other}` say different things"),
        )
        .with_hint("keep one of them")),
    }
}

fn eased(
    table: &Values<'_>,
    ease: Box<dyn Ease>,
    distance: f64,
    duration: Option<f64>,
) -> Result<Box<dyn SpeedControl>, ConstructError> {
    let duration =
        duration.ok_or_else(|| table.missing("duration", "how many seconds it takes"))?;
    let eased = Eased::new(ease, duration, distance);
    Ok(Box::new(eased.map_err(|error| refused("speed", &error))?))
}

/// An ease that cannot be read: the nearest name where none has that name.
fn ease_refused(path: &str, text: &str, error: &CurveError) -> ConstructError {
    if let CurveError::UnknownName { what: "ease", .. } = error {
        let mut names: Vec<&str> = eases::registry().iter().map(|entry| entry.name).collect();
        names.extend(eases::registry().iter().flat_map(|entry| entry.aliases));
        names.extend(["step-start", "step-end"]);
        let mut refusal = unknown(path, "ease", text, &names);
        refusal
            .hint
            .push_str("; `anamorph list eases` names them all");
        return refusal;
    }
    refused(path, error)
}

/// An ease from a table with its parameters.
fn ease(table: &Values<'_>) -> Result<Box<dyn Ease>, ConstructError> {
    let name = table.text("ease")?.unwrap_or_default();
    let at = table.at("ease");
    let Some(entry) = eases::entry(name) else {
        // Perhaps one in the notation of style sheets; its parameters are in the text.
        let beside = table
            .map
            .keys()
            .find(|key| !["ease", "distance"].contains(&key.as_str()));
        if let Some(key) = beside.filter(|_| name.contains('(')) {
            let message = format!("`{key}` beside an ease that has its numbers in brackets");
            return Err(ConstructError::new(table.at(key), message)
                .with_hint("leave it out, or give all of them by their names"));
        }
        return eases::parse(name).map_err(|error| ease_refused(&at, name, &error));
    };
    let mut stops = Vec::new();
    for EaseParameter { name, default, .. } in entry.parameters {
        if matches!(default, Setting::Stops(_)) {
            for (i, value) in table.list(name)?.unwrap_or_default().iter().enumerate() {
                let at = below(&table.at(name), i);
                let pair: [f64; 2] = read(value, &at)?;
                if let Some((before, _)) = stops.last()
                    && pair[0] < *before
                {
                    let (time, before) = (short(pair[0]), short(*before));
                    let message = format!(
                        "the time of stop {i} is {time}, less than the one before it, {before}"
                    );
                    return Err(
                        ConstructError::new(at, message).with_hint("sort the stops by time")
                    );
                }
                stops.push((pair[0], pair[1]));
            }
        }
    }
    let mut settings: Vec<(&str, Setting<'_>)> = Vec::new();
    for EaseParameter { name, default, .. } in entry.parameters {
        if table.get(name).is_none() {
            continue;
        }
        let setting = match default {
            Setting::Number(_) => table.number(name)?.map(Setting::Number),
            Setting::Word(_) => table.text(name)?.map(Setting::Word),
            Setting::Stops(_) => Some(Setting::Stops(&stops)),
        };
        settings.extend(setting.map(|setting| (*name, setting)));
    }
    entry
        .construct(&settings)
        .map_err(|error| refused(&table.path, &error))
}

/// Time, number, what follows, and the path of a key.
type Row<'a> = (f64, &'a Value, Option<&'a Value>, String);

/// The rows of keys: a time and at least one number each, and what follows.
fn keys<'a>(
    table: &Values<'a>,
    key: &str,
    scale: &Scale,
    what: &str,
) -> Result<Vec<Row<'a>>, ConstructError> {
    let list = table.list(key)?.unwrap_or_default();
    let mut rows = Vec::with_capacity(list.len());
    for (i, row) in list.iter().enumerate() {
        let at = below(&table.at(key), i);
        let Some([time, rest @ ..]) = row.as_array().map(Vec::as_slice) else {
            let message = format!("{} where a key was expected", crate::words::form(row));
            return Err(ConstructError::new(at, message).with_hint(format!("write {what}")));
        };
        let (number, more) = match rest {
            [number] => (number, None),
            [number, more] => (number, Some(more)),
            _ => {
                let message = format!("a key of {} entries", rest.len() + 1);
                return Err(ConstructError::new(at, message).with_hint(format!("write {what}")));
            }
        };
        rows.push((
            self::time(time, &below(&at, 0), scale.duration)?,
            number,
            more,
            at,
        ));
    }
    Ok(rows)
}

/// A time: seconds, or a share of the duration.
pub(super) fn time(
    value: &Value,
    path: &str,
    duration: Option<f64>,
) -> Result<f64, ConstructError> {
    match duration {
        Some(duration) => share(value, path, duration),
        None => match value {
            Value::String(_) => Err(ConstructError::new(
                path,
                "a share of the duration, but the motion says none",
            )
            .with_hint("add `duration`, or write seconds")),
            _ => share(value, path, 0.0),
        },
    }
}

fn distances(table: &Values<'_>, scale: &Scale) -> Result<Built, ConstructError> {
    let mut list = Vec::new();
    let what = "[time, distance] or [time, distance, speed]";
    for (time, distance, speed, at) in keys(table, "distances", scale, what)? {
        list.push(DistanceKey {
            time,
            distance: share(distance, &below(&at, 1), scale.total)?,
            speed: speed
                .map(|speed| share(speed, &below(&at, 2), scale.total))
                .transpose()?,
        });
    }
    let control = match table.word("repair", &REPAIRS)? {
        Some(1) => DistanceTime::free(&list),
        _ => DistanceTime::monotone(&list),
    };
    let control = control.map_err(|error| refused(&table.at("distances"), &error))?;
    let times: Vec<f64> = list.iter().map(|key| key.time).collect();
    Ok(Built {
        changes: control.changes().to_vec(),
        notes: scale.late("distances", &times),
        ..quiet(Box::new(control))
    })
}

/// Whether the third entry of a key fixes it.
fn fixed(entry: Option<&Value>, at: &str) -> Result<bool, ConstructError> {
    match entry {
        None => Ok(false),
        Some(Value::String(word)) if word == FIXED => Ok(true),
        Some(other) => {
            let message = format!("{} behind the key", crate::words::form(other));
            Err(ConstructError::new(below(at, 2), message)
                .with_hint("write \"fixed\" to keep its number, or nothing"))
        }
    }
}

fn between(table: &Values<'_>) -> Result<Between, ConstructError> {
    Ok(match table.word("between", &BETWEEN)? {
        Some(1) => Between::Linear,
        Some(2) => Between::Hold,
        _ => Between::Smooth,
    })
}

fn speeds(table: &Values<'_>, scale: &Scale) -> Result<Built, ConstructError> {
    let mut list = Vec::new();
    for (time, speed, mark, at) in keys(
        table,
        "speeds",
        scale,
        "[time, speed] or [time, speed, \"fixed\"]",
    )? {
        list.push(SpeedKey {
            time,
            speed: share(speed, &below(&at, 1), scale.total)?,
            fixed: fixed(mark, &at)?,
        });
    }
    let between = between(table)?;
    let as_drawn = table.get("distance") == Some(&Value::String(AS_DRAWN.to_owned()));
    let mut asked = None;
    let control = if as_drawn {
        SpeedTime::as_drawn(&list, between)
    } else {
        asked = table.share("distance", scale.total)?;
        SpeedTime::new(&list, asked.unwrap_or(scale.total), between)
    };
    let control = control.map_err(|error| refused(&table.at("speeds"), &error))?;
    let times: Vec<f64> = list.iter().map(|key| key.time).collect();
    Ok(Built {
        asked,
        notes: scale.late("speeds", &times),
        ..quiet(Box::new(control))
    })
}

fn accelerations(table: &Values<'_>, scale: &Scale) -> Result<Built, ConstructError> {
    let mut list = Vec::new();
    let what = "[time, acceleration] or [time, acceleration, \"fixed\"]";
    for (time, acceleration, mark, at) in keys(table, "accelerations", scale, what)? {
        list.push(AccelerationKey {
            time,
            acceleration: share(acceleration, &below(&at, 1), scale.total)?,
            fixed: fixed(mark, &at)?,
        });
    }
    let asked = table.share("distance", scale.total)?;
    let total = asked.unwrap_or(scale.total);
    let start = table.share("start", scale.total)?.unwrap_or(0.0);
    let end = table.share("end", scale.total)?;
    let control = AccelerationTime::new(&list, start, end, total, between(table)?);
    let control = control.map_err(|error| refused(&table.at("accelerations"), &error))?;
    let times: Vec<f64> = list.iter().map(|key| key.time).collect();
    Ok(Built {
        asked,
        notes: scale.late("accelerations", &times),
        ..quiet(Box::new(control))
    })
}
