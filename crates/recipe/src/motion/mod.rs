//! Motions: the table `[motion]` of a recipe becomes a path, a speed along it and an orientation.
//!
//! *Source*: *Interpolation Techniques*, chapters 2 (curves, speed control, orientation, smoothing) and 3 (quaternions). What
//! a motion may name is what the registries of the curves crate hold; the JSON Schema is made from them, and every
//! key is held against it.

mod attitude;
mod path;
pub(crate) mod schema;
mod speed;
mod values;

pub use attitude::{Attitude, KEYED, KeyedOrientation};
pub use path::{SMOOTHINGS, SmoothingEntry};

use crate::Recipe;
use crate::error::{Problem, RecipeError};
use crate::keys::Walk;
use crate::tree::{Part, join};
use crate::words::{form, plain};
use anamorph_catalog::{ConstructError, Context, Meshes};
use anamorph_core::Solid;
use anamorph_core::glam::DQuat;
use anamorph_curves::motion::{Finding, Measure, Motion, SpeedChange};
use serde_json::{Map, Value};
use values::{Values, short};

/// What moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subject {
    /// An object: it faces its own `+z`, up is `+y`.
    #[default]
    Object,
    /// A camera: it looks along its own `−z`, up is `+y`.
    Camera,
}

/// A motion as a recipe describes it.
pub struct BuiltMotion {
    /// Where it is at which time.
    pub motion: Motion<Solid>,
    /// How it is turned.
    pub attitude: Attitude,
    /// What moves.
    pub subject: Subject,
    /// The points of the path as the recipe gives them, smoothed if it says so.
    pub points: Vec<Solid>,
    /// The point that it looks at, if it looks at one.
    pub target: Option<Solid>,
    /// Whether the path is one of the plane, z being 0.
    pub plane: bool,
    /// Name of the path's family.
    pub family: &'static str,
    /// Name of the orientation.
    pub orientation: &'static str,
    /// What becomes of keys otherwise than one might think, a sentence each.
    pub notes: Vec<String>,
    /// Speeds at keys that could not be had.
    pub changes: Vec<SpeedChange>,
    /// What an animator would want to know.
    pub findings: Vec<Finding>,
}

impl BuiltMotion {
    /// The rotations of the subject at times, in order: unit quaternions that carry its own axes to the world's. Of `q` and `−q`
    /// that which is nearer to the one before.
    #[must_use]
    pub fn rotations(&self, times: &[f64]) -> Vec<DQuat> {
        self.attitude.rotations(&self.motion, self.subject, times)
    }
}

/// Words of `subject`.
const SUBJECTS: [&str; 2] = ["object", "camera"];
/// Words of `by`.
const MEASURES: [&str; 2] = ["length", "parameter"];

/// Share of the path's size to which its lengths are known.
const ACCURACY: f64 = 1e-10;

impl Recipe {
    /// Whether it describes a motion, rather than warps.
    #[must_use]
    pub fn is_motion(&self) -> bool {
        self.tree.contains_key("motion")
    }

    /// Checks every key of a recipe of a motion.
    ///
    /// # Errors
    ///
    /// All problems found, in the order of the file: also warps beside the motion, and no motion.
    pub fn check_motion(&self) -> Result<(), RecipeError> {
        let mut problems = Vec::new();
        problems.extend(self.version_problem());
        self.check_root(&mut problems);
        match self.tree.get("motion") {
            None => problems.push(self.problem(
                "motion",
                Part::Key,
                "the recipe has no motion",
                match self.tree.get("warp") {
                    Some(_) => "it is one of warps: use `anamorph warp`",
                    None => "add a table [motion] with a `path`",
                },
            )),
            Some(Value::Object(table)) => self.check_table(table, &mut problems),
            Some(other) => {
                let message = format!("`motion` is a table, and this is {}", form(other));
                problems.push(self.problem("motion", Part::Value, message, "write [motion]"));
            }
        }
        RecipeError::of(&self.source.name, problems).map_or(Ok(()), Err)
    }

    fn check_table(&self, table: &Map<String, Value>, problems: &mut Vec<Problem>) {
        if let Some(warps) = self.tree.get("warp") {
            let message = format!(
                "a recipe has warps or a motion, and this has both ({})",
                form(warps)
            );
            problems.push(self.problem("warp", Part::Key, message, "keep them in two files"));
        }
        for key in ["mapping", "track", "time"] {
            if self.tree.contains_key(key) {
                let message = format!("a motion has no `{key}`");
                problems.push(self.problem(key, Part::Key, message, "leave it out"));
            }
        }
        if self.tree.contains_key("space") {
            let message = "`space` is for warps; a motion is in the coordinates of its path";
            problems.push(self.problem("space", Part::Key, message, "leave it out"));
        }
        if let Some(error) = path::too_many(table) {
            let at = join("motion", &error.path);
            problems.push(self.problem(&at, Part::Value, error.message, error.hint));
            return;
        }
        let mut definitions = Map::new();
        let schema = schema::motion(&mut definitions);
        let mut walk = Walk::new(&definitions);
        walk.compare(&plainly_eased(table), &schema, "motion", &[]);
        problems.extend(walk.unknown.into_iter().map(|mut unknown| {
            reworded(&mut unknown);
            let part = if unknown.is_key {
                Part::Key
            } else {
                Part::Value
            };
            self.problem(&unknown.path, part, unknown.message, unknown.hint)
        }));
    }

    /// Checks the recipe ([`Recipe::check_motion`]) and constructs its motion. `meshes` are the files it may name.
    ///
    /// # Errors
    ///
    /// All unknown keys, or the first value that is wrong, at its line.
    pub fn build_motion(&self, meshes: Option<&dyn Meshes>) -> Result<BuiltMotion, RecipeError> {
        self.check_motion()?;
        let none = Map::new();
        let table = self.tree.get("motion").and_then(Value::as_object);
        let context = Context {
            meshes,
            ..Context::default()
        };
        build(&Values::new(table.unwrap_or(&none), &context)).map_err(|error| {
            let (message, hint) = plain(&error.message);
            let hint = if error.hint.is_empty() {
                hint.unwrap_or_default()
            } else {
                error.hint
            };
            let path = join("motion", &error.path);
            let problem = self.problem(&path, Part::Value, message, hint);
            RecipeError::one(&self.source.name, problem)
        })
    }

    /// What is wrong with asking for warps here, if the recipe is of a motion.
    pub(crate) fn motion_problem(&self) -> Option<Problem> {
        self.is_motion().then(|| {
            let message = "this recipe is of a motion, which moves no model";
            let hint = "use `anamorph motion`; warps go into a recipe of their own";
            self.problem("motion", Part::Key, message, hint)
        })
    }
}

/// The table with an ease that is written as in style sheets, `{ ease = "steps(4)" }`, by its name alone: its parameters are not
/// the schema's matter.
fn plainly_eased(table: &Map<String, Value>) -> Value {
    let mut table = table.clone();
    if let Some(Value::String(ease)) = table.get_mut("speed").and_then(|s| s.get_mut("ease"))
        && let Some((name, _)) = ease.split_once('(')
    {
        *ease = match name.trim() {
            "linear" => "stops".to_owned(),
            name => name.to_owned(),
        };
    }
    Value::Object(table)
}

/// What is known by another name, or elsewhere.
fn reworded(unknown: &mut crate::keys::Unknown) {
    if unknown.is_key && unknown.path == "motion.path.closed" {
        "a curve of this family cannot be closed".clone_into(&mut unknown.message);
        "leave `closed` out, or take another family, such as \"catmull-rom\""
            .clone_into(&mut unknown.hint);
    }
    if !unknown.is_key
        && unknown.path == "motion.orientation.kind"
        && unknown.message.contains("`banking`")
    {
        attitude::BANKING.clone_into(&mut unknown.hint);
    }
}

/// Where a motion turns at once.
fn turning(motion: &Motion<Solid>, attitude: &Attitude, subject: Subject) -> Vec<Finding> {
    motion.diagnose_turning(&mut |times| attitude.rotations(motion, subject, times))
}

/// A motion from its table.
fn build(table: &Values<'_>) -> Result<BuiltMotion, ConstructError> {
    let path = path::build(&table.table("path")?)?;
    let measure = match table.word("by", &MEASURES)? {
        Some(1) => Measure::Parameter,
        _ => Measure::Length,
    };
    let subject = match table.word("subject", &SUBJECTS)? {
        Some(1) => Subject::Camera,
        _ => Subject::Object,
    };
    let duration = table.number("duration")?;
    if let Some(duration) = duration.filter(|d| !(*d >= 1e-6 && *d <= 1e9)) {
        let message = format!("the duration is {} seconds", short(duration));
        return Err(ConstructError::new("duration", message)
            .with_hint("write a number of seconds from 1e-6 to 1e9"));
    }
    let of_path = |error: anamorph_curves::CurveError| path::refused("path.points", &error);
    anamorph_curves::LengthTable::check(path.curve.as_ref()).map_err(of_path)?;
    // Curves that swing far beyond their points are measured by their own size.
    let rough = path.curve.length(1e-3 * path.size);
    let size = if rough > 32.0 * path.size {
        rough
    } else {
        path.size
    };
    let lengths =
        anamorph_curves::LengthTable::new(path.curve.as_ref(), ACCURACY * size).map_err(of_path)?;
    if !lengths.is_complete() {
        let message = "the path is too wild, or of too high a degree for so many points, to be measured to 1e-10 of its \
                       size: that takes more than a million intervals, or more than the measuring of two million cubics";
        return Err(ConstructError::new("path.points", message)
            .with_hint("take fewer points, or a family of lower degree"));
    }
    let (start, end) = path.curve.domain();
    let total = match measure {
        Measure::Length => lengths.length(),
        Measure::Parameter => end - start,
    };
    let speed = speed::build(table, total, duration)?;
    let mut motion = Motion::prepared(
        std::sync::Arc::clone(&path.curve),
        lengths,
        speed.control,
        measure,
    );
    if let Some(duration) = duration {
        motion = motion
            .lasting(duration)
            .map_err(|error| path::refused("duration", &error))?;
    }
    let (orientation, attitude, mut turned) = attitude::build(table, &motion)?;
    let mut findings = match speed.asked {
        Some(distance) => motion.diagnose_over(distance),
        None => motion.diagnose(),
    };
    findings.extend(turning(&motion, &attitude, subject));
    findings.sort_by(|a, b| {
        let time = |finding: &Finding| finding.time().unwrap_or(f64::INFINITY);
        time(a).total_cmp(&time(b))
    });
    let mut notes = speed.notes;
    notes.append(&mut turned);
    Ok(BuiltMotion {
        findings,
        notes,
        motion,
        attitude,
        subject,
        points: path.points,
        target: attitude::target(table)?,
        plane: path.plane,
        family: path.family,
        orientation,
        changes: speed.changes,
    })
}
