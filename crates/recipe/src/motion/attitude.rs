//! `orientation`: frames along the path, or keys of orientations in time.

use super::Subject;
use super::path;
use super::speed::time;
use super::values::{Values, below, point, read, short, unknown};
use anamorph_catalog::{Angle, Axis, ConstructError, Coordinate};
use anamorph_core::Solid;
use anamorph_core::glam::DQuat;
use anamorph_curves::motion::Motion;
use anamorph_curves::orientation::Orienter;
use anamorph_curves::orientation::registry::{
    MODIFIERS, ORIENTATIONS, Orientation, Parameter, SharedPath, Takes, Value as Setting,
};
use anamorph_transforms::quaternion::{
    BezierPath, Ends, EvenTurning, Keys, LerpPath, OrientationError, Orientations, RotationSpline,
    SlerpPath, SquadPath, from_axis_angle, from_wxyz, nearer,
};
use serde_json::Value;
use std::sync::Arc;

/// How a motion is turned.
pub enum Attitude {
    /// By frames along its path.
    Along(Box<dyn Orienter>),
    /// By keys in time.
    Keyed(Box<dyn Orientations>),
}

impl Attitude {
    /// The rotations of a subject at times.
    pub(super) fn rotations(
        &self,
        motion: &Motion<Solid>,
        subject: Subject,
        times: &[f64],
    ) -> Vec<DQuat> {
        let mut all = Vec::with_capacity(times.len());
        match self {
            Self::Along(frames) => {
                let mut parameters = times.iter().map(|time| motion.parameter(*time));
                frames.stream(&mut parameters, &mut |frame| {
                    all.push(match subject {
                        Subject::Object => frame.to_quaternion(),
                        Subject::Camera => frame.camera_quaternion(),
                    });
                });
            }
            Self::Keyed(path) => all.extend(times.iter().map(|time| path.orientation(*time))),
        }
        for i in 1..all.len() {
            all[i] = nearer(all[i - 1], all[i]);
        }
        all
    }

    /// The times at which its keys are, where it has keys.
    #[must_use]
    pub fn key_times(&self) -> &[f64] {
        match self {
            Self::Along(_) => &[],
            Self::Keyed(path) => path.times(),
        }
    }
}

/// Builds a path through keys.
type Make = fn(&Keys) -> Result<Box<dyn Orientations>, OrientationError>;

/// A way from key to key by name.
pub struct KeyedOrientation {
    /// Its name in recipes.
    pub name: &'static str,
    /// Its name in sentences.
    pub title: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    make: Make,
}

/// All ways from key to key.
pub static KEYED: &[KeyedOrientation] = &[
    KeyedOrientation {
        name: "lerp",
        title: "Lerp between keys",
        reference: "Interpolation Techniques, chapter 3",
        summary: "from key to key on the great arc, not quite evenly; corners at the keys",
        make: |keys| Ok(Box::new(LerpPath::new(keys))),
    },
    KeyedOrientation {
        name: "slerp",
        title: "Slerp between keys",
        reference: "Shoemake 1985",
        summary: "from key to key evenly on the great arc; corners at the keys",
        make: |keys| Ok(Box::new(SlerpPath::new(keys))),
    },
    KeyedOrientation {
        name: "squad",
        title: "Squad through keys",
        reference: "Shoemake 1987",
        summary: "through the keys with continuous angular velocity, by three slerps",
        make: |keys| Ok(Box::new(SquadPath::new(keys))),
    },
    KeyedOrientation {
        name: "bezier",
        title: "Bézier curves on the sphere through keys",
        reference: "Shoemake 1985",
        summary: "through the keys with continuous angular velocity, by de Casteljau's construction",
        make: |keys| Ok(Box::new(BezierPath::new(keys))),
    },
    KeyedOrientation {
        name: "spline",
        title: "Rotation spline through keys",
        reference: "Park and Ravani 1997",
        summary: "through the keys with continuous angular acceleration",
        make: |keys| Ok(Box::new(RotationSpline::new(keys, Ends::NATURAL)?)),
    },
];

/// The angle of even turning is met to this, in radians.
const EVEN: f64 = 1e-9;

/// A path by time whose turning is even: the angle turned grows with the time.
struct EvenInTime {
    even: EvenTurning<Box<dyn Orientations>>,
    domain: [f64; 2],
}

impl EvenInTime {
    fn angle(&self, time: f64) -> f64 {
        let [start, end] = self.domain;
        self.even.total() * ((time - start) / (end - start))
    }
}

impl Orientations for EvenInTime {
    fn times(&self) -> &[f64] {
        &self.domain
    }
    fn is_closed(&self) -> bool {
        self.even.is_closed()
    }
    fn orientation(&self, time: f64) -> DQuat {
        let [start, end] = self.domain;
        let time = if self.is_closed() {
            time
        } else {
            time.clamp(start, end)
        };
        self.even.orientation(self.angle(time))
    }
    fn angular_velocity(&self, time: f64) -> Solid {
        let [start, end] = self.domain;
        self.even.angular_velocity(self.angle(time)) * (self.even.total() / (end - start))
    }
}

/// Whether a number of an orientation is an angle, which recipes write with its unit.
pub(super) fn is_angle(parameter: &Parameter) -> bool {
    parameter.meaning.contains("radians")
}

/// Whether a number is a length along the path, which may be a share of it.
pub(super) fn is_length(parameter: &Parameter) -> bool {
    matches!(parameter.name, "distance" | "smoothing")
}

/// The settings of parameters from a table.
fn settings(
    table: &Values<'_>,
    parameters: &[Parameter],
    length: f64,
) -> Result<Vec<(String, Setting)>, ConstructError> {
    let mut settings = Vec::new();
    for parameter in parameters {
        let name = parameter.name;
        let Some(value) = table.get(name) else {
            continue;
        };
        let at = table.at(name);
        let setting = match parameter.takes {
            Takes::Number(_) if is_angle(parameter) => {
                Setting::Number(read::<Angle>(value, &at)?.radians())
            }
            Takes::Number(_) if is_length(parameter) => {
                Setting::Number(match read::<Coordinate>(value, &at)? {
                    Coordinate::Absolute(number) => number,
                    Coordinate::Relative(share) => share * length,
                })
            }
            Takes::Number(_) => Setting::Number(read(value, &at)?),
            Takes::Vector(_) if name == "target" => Setting::Vector(point(value, &at)?.0),
            Takes::Vector(_) => Setting::Vector(read::<Axis>(value, &at)?.resolve(&at)?),
            Takes::Word(_) => Setting::Word(read(value, &at)?),
            Takes::Curve => Setting::Curve(path::build(&table.inside(value, name)?)?.curve),
        };
        settings.push((name.to_owned(), setting));
    }
    if let Some(missing) = parameters
        .iter()
        .find(|p| p.required && table.get(p.name).is_none())
    {
        return Err(table.missing(missing.name, missing.meaning));
    }
    Ok(settings)
}

/// The error of frames at the table.
fn refused(path: &str, error: &dyn std::fmt::Display) -> ConstructError {
    let text = error.to_string();
    match text.split_once([';', ':']) {
        Some((message, hint)) => ConstructError::new(path, message).with_hint(hint.trim_start()),
        None => ConstructError::new(path, text),
    }
}

fn along(
    table: &Values<'_>,
    entry: &'static Orientation,
    motion: &Motion<Solid>,
) -> Result<Box<dyn Orienter>, ConstructError> {
    let shared: SharedPath = Arc::clone(motion.path());
    let length = motion.table().length();
    let mut frames = entry
        .make(
            Arc::clone(&shared),
            &settings(table, entry.parameters, length)?,
        )
        .map_err(|error| refused(&table.path, &error))?;
    for modifier in MODIFIERS {
        let Some(value) = table.get(modifier.name) else {
            continue;
        };
        if value == &Value::Bool(false) {
            continue;
        }
        let none = serde_json::Map::new();
        let inner = match value {
            Value::Bool(_) => Values {
                path: table.at(modifier.name),
                map: &none,
                context: table.context,
            },
            value => table.inside(value, modifier.name)?,
        };
        let mut given = settings(&inner, modifier.parameters, length)?;
        if inner.get("speed").is_none() && modifier.parameters.iter().any(|p| p.name == "speed") {
            // The motion's own, on the mean.
            given.push((
                "speed".to_owned(),
                Setting::Number(length / motion.duration()),
            ));
        }
        frames = modifier
            .modify(frames, Arc::clone(&shared), &given)
            .map_err(|error| refused(&inner.path, &error))?;
    }
    Ok(frames)
}

/// How banking is written, for those who take it for an orientation.
pub(super) const BANKING: &str = "banking goes on top of an orientation: write `{ kind = \"rotation-minimizing\", banking = true }`";

/// What is known of a key's turn, where it is by an angle about an axis.
type Turn = Option<(Solid, f64)>;

/// What there is to say of keys that are more than half a turn apart about one axis: a quaternion does not know whole turns.
fn too_far(turns: &[Turn]) -> Vec<String> {
    let mut said = Vec::new();
    for (i, pair) in turns.windows(2).enumerate() {
        let [Some((axis, from)), Some((other, to))] = *pair else {
            continue;
        };
        let along = axis.normalize_or_zero().dot(other.normalize_or_zero());
        let by = if from == 0.0 || along >= 1.0 - 1e-9 {
            to - from
        } else if along <= 1e-9 - 1.0 || to == 0.0 {
            -to - from
        } else {
            continue;
        };
        let degrees = by.abs().to_degrees();
        if degrees <= 180.0 + 1e-9 {
            continue;
        }
        let rest = degrees % 360.0;
        let seen = rest.min(360.0 - rest);
        said.push(format!(
            "keys {i} and {} are {} degrees apart, but a quaternion holds no more than half a turn from key to key, and it \
             turns by {}: put keys between them, each less than 180 degrees from the next",
            i + 1,
            short(degrees),
            short((1e6 * seen).round() / 1e6)
        ));
    }
    said
}

/// The rotation of a key.
fn rotation(key: &Values<'_>) -> Result<(DQuat, Turn), ConstructError> {
    if let Some(value) = key.get("quaternion") {
        for other in ["axis", "angle"] {
            if key.get(other).is_some() {
                return Err(ConstructError::new(
                    key.at(other),
                    format!("`quaternion` and `{other}` say different things"),
                )
                .with_hint("keep `quaternion`, or `axis` and `angle`"));
            }
        }
        let at = key.at("quaternion");
        let numbers: [f64; 4] = read(value, &at)?;
        let q = from_wxyz(numbers);
        if !(q.length_squared() > 0.0 && q.length_squared().is_finite()) {
            let message = "a quaternion without length is no rotation";
            return Err(ConstructError::new(at, message)
                .with_hint("write [w, x, y, z]; [1, 0, 0, 0] turns nothing"));
        }
        return Ok((q, None));
    }
    let angle = match key.get("angle") {
        Some(value) => read::<Angle>(value, &key.at("angle"))?.radians(),
        None => return Err(key.missing("quaternion", "[w, x, y, z]; or `axis` and `angle`")),
    };
    let axis = match key.get("axis") {
        Some(value) => read::<Axis>(value, &key.at("axis"))?.resolve(&key.at("axis"))?,
        None => return Err(key.missing("axis", "what it turns about, such as \"y\" or [1, 0, 1]")),
    };
    Ok((from_axis_angle(axis, angle), Some((axis, angle))))
}

fn keyed(
    table: &Values<'_>,
    entry: &KeyedOrientation,
    duration: f64,
) -> Result<(Box<dyn Orientations>, Vec<String>), ConstructError> {
    let Some(list) = table.list("keys")? else {
        return Err(table.missing(
            "keys",
            "a list such as [{ time = 0, axis = \"y\", angle = \"90deg\" }]",
        ));
    };
    let (mut rotations, mut times, mut turns) = (Vec::new(), Vec::new(), Vec::new());
    for (i, value) in list.iter().enumerate() {
        let key = table.inside(value, &below("keys", i))?;
        let at = key.at("time");
        let Some(value) = key.get("time") else {
            return Err(key.missing("time", "seconds, or a share of the duration"));
        };
        let time = time(value, &at, Some(duration))?;
        if time < 0.0 {
            let message = format!(
                "the time of key {i} is {}, but motion begins at 0",
                short(time)
            );
            return Err(ConstructError::new(at, message).with_hint("write 0 or more seconds"));
        }
        times.push(time);
        let (q, turn) = rotation(&key)?;
        rotations.push(q);
        turns.push(turn);
    }
    let mut notes = too_far(&turns);
    let at = table.at("keys");
    let later = super::speed::late("the orientation", &times, duration);
    let fails = |error: OrientationError| match (&error, &later) {
        // A shorter motion, some of whose keys are at shares of it.
        (OrientationError::TimesNotIncreasing { .. }, Some(later)) => {
            ConstructError::new(&at, format!("the keys do not increase: {later}"))
        }
        _ => refused(&at, &error),
    };
    notes.extend(later.clone());
    let keys = if table.flag("closed")? {
        let last = times.last().copied().unwrap_or(0.0);
        let returns = match table.get("return") {
            Some(value) => time(value, &table.at("return"), Some(duration))?,
            None => duration,
        };
        if returns <= last {
            let message = format!(
                "the first key returns at {}, not after the last at {}",
                short(returns),
                short(last)
            );
            return Err(ConstructError::new(table.at("return"), message)
                .with_hint("write a later `return`, or remove the last key"));
        }
        times.push(returns);
        Keys::closed(&rotations, &times).map_err(fails)?
    } else {
        Keys::new(&rotations, &times).map_err(fails)?
    };
    let path = (entry.make)(&keys).map_err(fails)?;
    if !table.flag("even")? || times.len() < 2 {
        return Ok((path, notes));
    }
    let even = EvenTurning::new(path, EVEN).map_err(fails)?;
    let even = EvenInTime {
        even,
        domain: [times[0], times[times.len() - 1]],
    };
    Ok((Box::new(even), notes))
}

/// The point that an orientation looks at.
pub(super) fn target(table: &Values<'_>) -> Result<Option<Solid>, ConstructError> {
    let target = table
        .get("orientation")
        .and_then(|value| value.get("target"));
    let read = target
        .map(|value| point(value, "orientation.target"))
        .transpose()?;
    Ok(read.map(|(point, _)| point))
}

/// The orientation of a motion, its name, and what there is to say of its keys.
pub(super) fn build(
    table: &Values<'_>,
    motion: &Motion<Solid>,
) -> Result<(&'static str, Attitude, Vec<String>), ConstructError> {
    let none = serde_json::Map::new();
    let plain = |path: String| Values {
        path,
        map: &none,
        context: table.context,
    };
    let (inner, kind, at) = match table.get("orientation") {
        None => (
            plain("orientation".to_owned()),
            "rotation-minimizing",
            "orientation".to_owned(),
        ),
        Some(Value::String(kind)) => (
            plain("orientation".to_owned()),
            kind.as_str(),
            "orientation".to_owned(),
        ),
        Some(value) => {
            let inner = table.inside(value, "orientation")?;
            let kind = inner.text("kind")?.ok_or_else(|| {
                inner.missing("kind", "such as \"rotation-minimizing\" or \"look-at\"")
            })?;
            let at = inner.at("kind");
            (inner, kind, at)
        }
    };
    if let Some(entry) = ORIENTATIONS.iter().find(|entry| entry.name == kind) {
        let frames = along(&inner, entry, motion)?;
        return Ok((entry.name, Attitude::Along(frames), Vec::new()));
    }
    if let Some(entry) = KEYED.iter().find(|entry| entry.name == kind) {
        let (path, notes) = keyed(&inner, entry, motion.duration())?;
        return Ok((entry.name, Attitude::Keyed(path), notes));
    }
    let along = ORIENTATIONS.iter().map(|entry| entry.name);
    let names: Vec<&str> = along.chain(KEYED.iter().map(|entry| entry.name)).collect();
    let refusal = unknown(&at, "orientation", kind, &names);
    Err(if kind == "banking" {
        refusal.with_hint(BANKING)
    } else {
        refusal
    })
}
