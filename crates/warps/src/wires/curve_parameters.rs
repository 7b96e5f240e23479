//! How recipes describe curves of warps: a table as a motion's path has it, or the polylines of a file.
//!
//! *Source*: the families are those of `anamorph-curves`; the notation is a decision.

use crate::cages::expect_in_space;
use anamorph_catalog::schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use anamorph_catalog::{
    ConstructError, Context, FeatureMesh, Offset, Place, Value, parse, schemars,
};
use anamorph_core::Space;
use anamorph_curves::families::registry::{FAMILIES, Given, InFamily, Path, family};
use anamorph_curves::{CurveError, Indexed};
use serde::Deserialize;
use std::borrow::Cow;
use std::sync::Arc;

/// The family of a curve that names none.
const FAMILY: &str = "catmull-rom";

/// A curve of a recipe with its index for nearest points.
pub(super) type RecipeCurve<S> = Indexed<S, Arc<dyn Path<S>>>;

/// A curve as a parameter: kept as written until the model is known.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
pub(super) struct CurveParameter(Value);

/// A list of places or the name of a file, kept as written.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
struct PointsParameter(Value);

impl JsonSchema for PointsParameter {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "CurvePoints".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let places = Vec::<Place>::json_schema(generator);
        json_schema!({
            "description": "the points of a curve as places, or the name of a file whose polyline they are",
            "anyOf": [places, { "type": "string" }]
        })
    }
}

/// The name of a family, for the schema.
struct FamilyName;

impl JsonSchema for FamilyName {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "CurveFamily".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
        json_schema!({ "description": "the family of curves, \"catmull-rom\" if left out", "type": "string", "enum": names })
    }
}

/// A curve of a family.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CurveTable {
    /// The family of curves, "catmull-rom" if left out.
    #[schemars(with = "Option<FamilyName>")]
    kind: Option<String>,
    /// The points as places, or the name of a file whose polyline they are.
    points: PointsParameter,
    /// Which polyline of the file, from 0.
    line: Option<usize>,
    /// Whether the curve returns to its start; as the file has it if left out.
    closed: Option<bool>,
    /// Velocities at the points, of the family "hermite".
    velocities: Option<Vec<Offset>>,
    /// Times of the points, of families that read them.
    times: Option<Vec<f64>>,
    /// Nodes of the points, of the family "lagrange".
    nodes: Option<Vec<f64>>,
    /// Knots, of the family "b-spline".
    knots: Option<Vec<f64>>,
    /// Power of the distance between knots, of the family "catmull-rom".
    spacing: Option<f64>,
    /// Degree, of the family "b-spline"; 1 is a polyline.
    degree: Option<f64>,
    /// 1: from the first to the last control point; 0: uniform knots; of the family "b-spline".
    clamped: Option<f64>,
    /// Tension, of the family "tension-continuity-bias".
    tension: Option<f64>,
    /// Continuity, of the family "tension-continuity-bias".
    continuity: Option<f64>,
    /// Bias, of the family "tension-continuity-bias".
    bias: Option<f64>,
}

impl JsonSchema for CurveParameter {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Curve".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<CurveTable>();
        json_schema!({
            "description": "a curve: a table with a family and points, or the name of a file with polylines",
            "anyOf": [{ "type": "string" }, table]
        })
    }
}

/// The curves crate's error at a path.
fn refused(path: &str, error: &CurveError) -> ConstructError {
    let text = error.to_string();
    // Its hints stand behind a colon or a semicolon.
    match text.rsplit_once(": ").or_else(|| text.rsplit_once("; ")) {
        Some((message, hint)) => ConstructError::new(path, message).with_hint(hint),
        None => ConstructError::new(path, text),
    }
}

/// A curve through points, and whether the file says that it is closed.
pub(super) struct Polyline<S> {
    pub(super) points: Vec<S>,
    pub(super) closed: bool,
}

/// The polylines of a file in the order in which they begin; all its points in their order where it has no lines.
pub(super) fn polylines<S: Space>(
    path: &str,
    name: &str,
    context: &Context<'_, S>,
) -> Result<Vec<Polyline<S>>, ConstructError> {
    let mesh = context.mesh(path, name)?;
    expect_in_space::<S>(path, name, &mesh)?;
    let chains = chains(&mesh).ok_or_else(|| {
        let message = format!("lines of {name} meet in a branch");
        ConstructError::new(path, message).with_hint(
            "keep polylines that do not branch, or remove all lines to take the points in their order",
        )
    })?;
    let lines = chains.into_iter().map(|(indices, closed)| Polyline {
        points: indices
            .iter()
            .map(|&i| S::from_fn(|axis| mesh.points[i][axis]))
            .collect(),
        closed,
    });
    Ok(lines.collect())
}

/// The points of each chain of lines and whether it is a ring; `None` where three lines meet or an index is out of range.
fn chains(mesh: &FeatureMesh) -> Option<Vec<(Vec<usize>, bool)>> {
    if mesh.lines.is_empty() {
        return Some(vec![((0..mesh.points.len()).collect(), false)]);
    }
    let mut beside: Vec<[Option<usize>; 2]> = vec![[None; 2]; mesh.points.len()];
    for &[a, b] in &mesh.lines {
        for (from, to) in [(a as usize, b as usize), (b as usize, a as usize)] {
            let places = beside.get_mut(from)?;
            let free = places.iter_mut().find(|place| place.is_none())?;
            *free = Some(to);
        }
    }
    let mut seen = vec![false; mesh.points.len()];
    let mut chains = Vec::new();
    let mut walk = |start: usize, towards: Option<usize>, seen: &mut Vec<bool>| {
        let mut chain = vec![start];
        seen[start] = true;
        let (mut before, mut next) = (start, towards);
        while let Some(here) = next.filter(|&here| !seen[here]) {
            seen[here] = true;
            chain.push(here);
            let other = beside[here].iter().flatten().find(|&&to| to != before);
            (before, next) = (here, other.copied());
        }
        chains.push((chain, next == Some(start)));
    };
    // In the order of the lines: a chain begins where a line names one of its ends first; rings begin where they are named.
    for ends_only in [true, false] {
        for line in &mesh.lines {
            for (start, other) in [(line[0], line[1]), (line[1], line[0])] {
                let (start, other) = (start as usize, other as usize);
                let end = beside[start].iter().flatten().count() == 1;
                if !seen[start] && (end || !ends_only) {
                    walk(start, Some(other), &mut seen);
                }
            }
        }
    }
    Some(chains)
}

/// A curve of a family through the points of a polyline.
pub(super) fn through<S: InFamily>(
    path: &str,
    line: Polyline<S>,
) -> Result<RecipeCurve<S>, ConstructError> {
    let given = Given {
        points: line.points,
        velocities: Vec::new(),
        times: Vec::new(),
        closed: line.closed,
        numbers: Vec::new(),
    };
    make(path, FAMILY, &given)
}

fn make<S: InFamily>(
    path: &str,
    kind: &str,
    given: &Given<S>,
) -> Result<RecipeCurve<S>, ConstructError> {
    let names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
    let key = |key: &str| {
        if path.is_empty() {
            key.to_owned()
        } else {
            format!("{path}.{key}")
        }
    };
    let family = family(kind).ok_or_else(|| {
        let message = format!("no family of curves is called `{kind}`");
        ConstructError::new(key("kind"), message)
            .with_hint(format!("the families are {}", names.join(", ")))
    })?;
    let curve = family.make(given).map_err(|error| refused(path, &error))?;
    Ok(Indexed::new(Arc::from(curve)))
}

impl CurveParameter {
    /// The curve; `path` names the parameter in errors.
    pub(super) fn resolve<S: InFamily>(
        &self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<RecipeCurve<S>, ConstructError> {
        if let Value::String(name) = &self.0 {
            return through(path, chosen(path, name, None, context)?);
        }
        if !self.0.is_object() {
            return Err(ConstructError::new(path, "this is no curve").with_hint(
                "write { points = [[0, 0, 0], [1, 0, 0]] } with places, or the name of a file in quotes",
            ));
        }
        let table: CurveTable = parse(&self.0).map_err(|error| error.under(path))?;
        let at = |key: &str| format!("{path}.{key}");
        let kind = table.kind.as_deref().unwrap_or(FAMILY);
        let (points, ring) = match &table.points.0 {
            Value::String(name) => {
                let line = chosen(&at("points"), name, table.line, context)?;
                (line.points, line.closed)
            }
            list => {
                if table.line.is_some() {
                    return Err(ConstructError::new(at("line"), "there is no file")
                        .with_hint("name a file as `points`, or remove `line`"));
                }
                let places: Vec<Place> = parse(list).map_err(|error| error.under(&at("points")))?;
                let mut points = Vec::with_capacity(places.len());
                for (i, place) in places.iter().enumerate() {
                    points.push(place.resolve(&format!("{path}.points.{i}"), context)?);
                }
                (points, false)
            }
        };
        let mut velocities = Vec::new();
        for (i, velocity) in table.velocities.iter().flatten().enumerate() {
            velocities.push(velocity.resolve(&format!("{path}.velocities.{i}"), context)?);
        }
        let mut times = Vec::new();
        for (word, list) in [
            ("times", &table.times),
            ("nodes", &table.nodes),
            ("knots", &table.knots),
        ] {
            let Some(list) = list else { continue };
            if family(kind).is_some_and(|family| family.times != Some(word)) {
                return Err(ConstructError::new(
                    at(word),
                    format!("curves of the family `{kind}` have no {word}"),
                )
                .with_hint("remove it"));
            }
            times.clone_from(list);
        }
        let numbers = [
            ("spacing", table.spacing),
            ("degree", table.degree),
            ("clamped", table.clamped),
            ("tension", table.tension),
            ("continuity", table.continuity),
            ("bias", table.bias),
        ];
        let numbers = numbers
            .into_iter()
            .filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let closes = family(kind).is_some_and(|family| family.closes);
        let given = Given {
            points,
            velocities,
            times,
            closed: table.closed.unwrap_or(ring && closes),
            numbers: numbers.collect(),
        };
        make(path, kind, &given)
    }
}

/// One polyline of a file.
fn chosen<S: Space>(
    path: &str,
    name: &str,
    line: Option<usize>,
    context: &Context<'_, S>,
) -> Result<Polyline<S>, ConstructError> {
    let mut lines = polylines(path, name, context)?;
    let count = lines.len();
    match line {
        None if count > 1 => Err(ConstructError::new(
            path,
            format!("{name} has {count} polylines"),
        )
        .with_hint(format!("choose one: {{ points = \"{name}\", line = 0 }}"))),
        Some(line) if line >= count => {
            Err(
                ConstructError::new(path, format!("{name} has no polyline {line}")).with_hint(
                    format!("write a number from 0 to {}", count.saturating_sub(1)),
                ),
            )
        }
        line => Ok(lines.swap_remove(line.unwrap_or(0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(count: usize, lines: &[[u32; 2]]) -> FeatureMesh {
        FeatureMesh {
            dimension: 3,
            points: vec![anamorph_core::Solid::ZERO; count],
            lines: lines.to_vec(),
            ..FeatureMesh::default()
        }
    }

    #[test]
    fn polylines_keep_their_order_and_direction() {
        let found = chains(&mesh(
            9,
            &[[3, 2], [2, 1], [5, 6], [7, 8], [6, 7], [8, 5], [0, 4]],
        ));
        let expected = vec![
            (vec![3, 2, 1], false),
            (vec![0, 4], false),
            (vec![5, 6, 7, 8], true),
        ];
        assert_eq!(found, Some(expected));
        assert_eq!(chains(&mesh(3, &[])), Some(vec![(vec![0, 1, 2], false)]));
        assert_eq!(chains(&mesh(4, &[[0, 1], [0, 2], [0, 3]])), None);
        assert_eq!(chains(&mesh(2, &[[0, 7]])), None);
        // A line to itself and a line drawn twice end.
        assert!(chains(&mesh(2, &[[0, 0], [0, 1]])).is_none());
        assert_eq!(
            chains(&mesh(2, &[[0, 1], [1, 0]])).map(|c| c[0].0.len()),
            Some(2)
        );
    }
}
