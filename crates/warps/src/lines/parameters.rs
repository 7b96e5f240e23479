//! How recipes describe lines and other elements.
//!
//! *Source*: Milliron et al. 2002, §4.2, §5.2; `a`, `b` and `p` are Beier and Neely's (SIGGRAPH 1992); the notation is a
//! decision.

use super::elements::ElementWarp;
use super::{ElementError, WeightConstants, global, local};
use crate::cages::expect_in_space;
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Built, ConstructError, Context, Features, Length, Offset, Place, Value, WarpEntry, parse,
    schemars, source_and_target,
};
use anamorph_core::{Plane, Scaling, Space, Warp};
use anamorph_features::ElementPair;
use anamorph_transforms::Rotational;
use serde::Deserialize;

/// One source line and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LineParameters {
    /// Both ends of the source line, first its beginning.
    source: Vec<Place>,
    /// Both ends of the target line.
    target: Option<Vec<Place>>,
    /// The offset from source to target, instead of `target`. With neither the line stays.
    by: Option<Offset>,
    /// Added to the distance to this line.
    a: Option<Length>,
    /// How fast its weight falls off with distance.
    b: Option<f64>,
    /// How much its weight grows with its length.
    p: Option<f64>,
}

/// Source lines are carried to their targets, and the rest follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LinesParameters {
    /// The lines; those of the files come before them.
    #[serde(default)]
    line: Vec<LineParameters>,
    /// A file with source lines.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// Added to the distance to lines that say nothing themselves, 0 if left out: then lines are met exactly.
    a: Option<Length>,
    /// How fast their weights fall off with distance, 2 if left out; 0 for not at all.
    b: Option<f64>,
    /// How much their weights grow with their lengths, 0 if left out: not at all; 1 in proportion.
    p: Option<f64>,
}

/// One source element and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ElementParameters {
    /// One place for a point, two for the ends of a segment, three for a corner of a rectangle and the two next to it, four
    /// for a corner of a box and the three next to it.
    source: Vec<Place>,
    /// As many places for the target.
    target: Option<Vec<Place>>,
    /// The offset from source to target, instead of `target`. With neither the element stays.
    by: Option<Offset>,
    /// Added to the distance to this element.
    a: Option<Length>,
    /// How fast its weight falls off with distance.
    b: Option<f64>,
    /// How much its weight grows with its size.
    p: Option<f64>,
}

/// Source points, segments, rectangles and boxes are carried to their targets, and the rest follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ElementsParameters {
    /// The elements; lines of the files come before them.
    #[serde(default)]
    element: Vec<ElementParameters>,
    /// A file with source lines.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// Added to the distance to elements that say nothing themselves, 0 if left out: then elements are met exactly.
    a: Option<Length>,
    /// How fast their weights fall off with distance, 2 if left out; 0 for not at all.
    b: Option<f64>,
    /// How much their weights grow with their sizes, 0 if left out: not at all; 1 in proportion to the mean length of the
    /// edges.
    p: Option<f64>,
}

/// The line segments of a file, in its order.
fn segments<S: Space>(
    key: &'static str,
    name: &str,
    context: &Context<'_, S>,
) -> Result<Vec<[S; 2]>, ConstructError> {
    let mesh = context.mesh(key, name)?;
    expect_in_space::<S>(key, name, &mesh)?;
    if mesh.lines.is_empty() {
        let message = format!("{name} has no line");
        return Err(ConstructError::new(key, message).with_hint(
            "draw lines in it: `l` elements of OBJ, edges without faces, paths of SVG, or `chains` of landmarks",
        ));
    }
    let point = |i: u32| {
        let place = mesh.points.get(i as usize)?;
        Some(S::from_fn(|axis| place[axis]))
    };
    let ends = mesh
        .lines
        .iter()
        .map(|[a, b]| Some([point(*a)?, point(*b)?]));
    ends.collect::<Option<_>>().ok_or_else(|| {
        ConstructError::new(
            key,
            format!("a line of {name} refers to a point that it does not have"),
        )
    })
}

/// The pairs of segments of two files.
fn from_files<S: Space>(
    source: Option<&String>,
    target: Option<&String>,
    context: &Context<'_, S>,
) -> Result<Vec<ElementPair<S>>, ConstructError> {
    let Some((from, to)) = source_and_target(source, target)? else {
        return Ok(Vec::new());
    };
    let sources = segments("source", from, context)?;
    let targets = segments("target", to, context)?;
    if sources.len() != targets.len() {
        let message = format!(
            "{from} has {} lines and {to} has {}",
            sources.len(),
            targets.len()
        );
        return Err(ConstructError::new("target", message)
            .with_hint("give one target for each line, in the same order"));
    }
    let both = sources.iter().zip(&targets).enumerate();
    both.map(|(number, (source, target))| {
        ElementPair::of_corners(source, target).map_err(|error| {
            ConstructError::new("source", format!("line {number} of {from}: {error}"))
        })
    })
    .collect()
}

/// The constants of one feature's weight, from its own parameters or the warp's.
fn constants<S: Space>(
    path: &str,
    own: (Option<Length>, Option<f64>, Option<f64>),
    common: (Option<Length>, Option<f64>, Option<f64>),
    context: &Context<'_, S>,
) -> Result<WeightConstants, ConstructError> {
    let place = |key: &str, is_own: bool| {
        if is_own {
            format!("{path}.{key}")
        } else {
            key.to_owned()
        }
    };
    let positive = |key: &str, is_own: bool, value: f64| {
        if value >= 0.0 && value.is_finite() {
            return Ok(value);
        }
        let message = format!("the number is {value}, and must not be negative");
        Err(ConstructError::new(place(key, is_own), message)
            .with_hint("write 0 or a positive number"))
    };
    let defaults = WeightConstants::default();
    let number = |key: &str, own: Option<f64>, common: Option<f64>, default: f64| {
        positive(key, own.is_some(), own.or(common).unwrap_or(default))
    };
    let a = match own.0.or(common.0) {
        Some(length) => {
            let value = length.resolve(&place("a", own.0.is_some()), context)?;
            positive("a", own.0.is_some(), value)?
        }
        None => defaults.a,
    };
    Ok(WeightConstants {
        a,
        b: number("b", own.1, common.1, defaults.b)?,
        p: number("p", own.2, common.2, defaults.p)?,
    })
}

/// The pair of one feature.
fn pair<S: Space>(
    path: &str,
    source: &[Place],
    target: Option<&Vec<Place>>,
    by: Option<&Offset>,
    context: &Context<'_, S>,
) -> Result<ElementPair<S>, ConstructError> {
    let places = |key: &str, list: &[Place]| {
        let all = list.iter().enumerate();
        all.map(|(i, place)| place.resolve(&format!("{path}.{key}.{i}"), context))
            .collect::<Result<Vec<S>, _>>()
    };
    let (key, count) = ("source", source.len());
    let source = places(key, source)?;
    let (key, target) = match (target, by) {
        (Some(_), Some(_)) => {
            let message = "both `target` and `by` are given";
            return Err(ConstructError::new(format!("{path}.by"), message)
                .with_hint("write the target with its places, or as an offset with `by`"));
        }
        (Some(target), None) => ("target", places("target", target)?),
        (None, Some(by)) => {
            let offset: S = by.resolve(&format!("{path}.by"), context)?;
            ("by", source.iter().map(|&p| p + offset).collect())
        }
        (None, None) => (key, source.clone()),
    };
    if count != target.len() {
        let message = format!(
            "the source has {count} places and the target {}",
            target.len()
        );
        return Err(ConstructError::new(format!("{path}.target"), message)
            .with_hint("write as many, in the same order"));
    }
    // Which of the two is at fault.
    anamorph_features::Element::new(&source)
        .map_err(|error| ConstructError::new(format!("{path}.source"), error.to_string()))?;
    ElementPair::of_corners(&source, &target)
        .map_err(|error| ConstructError::new(format!("{path}.{key}"), error.to_string()))
}

/// An error of a feature of the list `list`, before which come `filed` features of files.
fn located(list: &str, filed: usize, error: &ElementError) -> ConstructError {
    let Some(number) = error.feature().checked_sub(filed) else {
        return ConstructError::new("source", error.to_string());
    };
    let (key, message) = match error {
        ElementError::Constant { constant, .. } => (format!(".{constant}"), error.to_string()),
        ElementError::Feature { error, .. } => (String::new(), error.to_string()),
        ElementError::NoLine { .. } => (".source".to_owned(), error.to_string()),
        ElementError::ShortNormal { .. } => (String::new(), error.to_string()),
    };
    ConstructError::new(format!("{list}.{number}{key}"), message)
}

/// Constructs a warp of pairs with their constants.
type Construct<S> =
    fn(&[(ElementPair<S>, WeightConstants)], Scaling) -> Result<ElementWarp<S>, ElementError>;

/// The warp of pairs from `filed` ones of files and those of the list called `list`.
fn built<S: Rotational>(
    list: &'static str,
    filed: usize,
    all: &[(ElementPair<S>, WeightConstants)],
    scaling: Scaling,
    construct: Construct<S>,
) -> Result<Built<S>, ConstructError> {
    let warp = construct(all, scaling).map_err(|error| located(list, filed, &error))?;
    let constants: Vec<WeightConstants> = all.iter().map(|(_, constants)| *constants).collect();
    let with = move |sources: &[Vec<S>], targets: &[Vec<S>]| {
        let pairs = sources.iter().zip(targets).zip(&constants).enumerate();
        let pairs = pairs.map(|(number, ((source, target), constants))| {
            let pair = ElementPair::of_corners(source, target);
            let pair = pair.map_err(|error| {
                located(
                    list,
                    filed,
                    &ElementError::Feature {
                        feature: number,
                        error,
                    },
                )
            })?;
            Ok((pair, *constants))
        });
        let pairs = pairs.collect::<Result<Vec<_>, ConstructError>>()?;
        let warp = construct(&pairs, scaling).map_err(|error| located(list, filed, &error))?;
        Ok(Box::new(warp) as Box<dyn Warp<S>>)
    };
    let features = Features {
        sources: all.iter().map(|(pair, _)| pair.source.corners()).collect(),
        targets: all.iter().map(|(pair, _)| pair.target.corners()).collect(),
        with: Box::new(with),
    };
    Ok(Built::new(warp.marks(), Box::new(warp)).between(features))
}

/// Builds one of the two warps by lines.
fn lines(
    value: &Value,
    context: &Context<'_, Plane>,
    construct: Construct<Plane>,
) -> Result<Built<Plane>, ConstructError> {
    let p: LinesParameters = parse(value)?;
    let common = (p.a, p.b, p.p);
    let mut all = Vec::new();
    for pair in from_files(p.source.as_ref(), p.target.as_ref(), context)? {
        all.push((pair, constants("", (None, None, None), common, context)?));
    }
    let filed = all.len();
    for (i, line) in p.line.iter().enumerate() {
        let path = format!("line.{i}");
        for (key, list) in [
            ("source", Some(&line.source)),
            ("target", line.target.as_ref()),
        ] {
            if let Some(list) = list.filter(|list| list.len() != 2) {
                let message = format!("a line has 2 ends, and {} are given", list.len());
                return Err(ConstructError::new(format!("{path}.{key}"), message)
                    .with_hint("write [[x, y], [x, y]]"));
            }
        }
        let (target, by) = (line.target.as_ref(), line.by.as_ref());
        let pair = pair(&path, &line.source, target, by, context)?;
        let own = (line.a, line.b, line.p);
        all.push((pair, constants(&path, own, common, context)?));
    }
    if all.is_empty() {
        return Err(ConstructError::new("line", "there is no line").with_hint(
            "add a table `[[warp.line]]` with `source` and `target`, each both ends of a line, or name files as `source` and `target`",
        ));
    }
    let scaling = context.scaling.unwrap_or(Scaling::Displacement);
    built("line", filed, &all, scaling, construct)
}

/// The registry entry of the feature lines.
pub(crate) fn local_lines() -> WarpEntry<Plane> {
    WarpEntry {
        kind: "lines",
        system: "B10",
        figure: "§4.2, Fig. 11",
        summary: "carries source lines to their targets; the rest follows, each point the nearer lines",
        reference: "T. Beier and S. Neely, Feature-Based Image Metamorphosis, SIGGRAPH 1992",
        example: "line = [{ source = [[\"20%\", \"50%\"], [\"80%\", \"50%\"]], target = [[\"30%\", \"60%\"], [\"70%\", \"80%\"]] },\n\
                  { source = [[\"10%\", \"10%\"], [\"90%\", \"10%\"]] }]\n",
        schema: LinesParameters::json_schema,
        construct: |value, context| lines(value, context, local::construct),
    }
}

/// The registry entry of the global feature lines.
pub(crate) fn global_lines() -> WarpEntry<Plane> {
    WarpEntry {
        kind: "global-lines",
        system: "B12",
        figure: "§5.2, Fig. 15",
        summary: "as lines, but each is turned across by what all of them do: a shear of lines shears the plane",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §5.2",
        example: "a = \"1%\"\n\
                  line = [{ source = [[\"20%\", \"50%\"], [\"80%\", \"50%\"]], target = [[\"20%\", \"60%\"], [\"80%\", \"40%\"]] },\n\
                  { source = [[\"50%\", \"20%\"], [\"50%\", \"80%\"]], target = [[\"40%\", \"20%\"], [\"70%\", \"80%\"]] }]\n",
        schema: LinesParameters::json_schema,
        construct: |value, context| lines(value, context, global::construct),
    }
}

/// The registry entry of the elements.
pub(crate) fn elements<S: Rotational>() -> WarpEntry<S> {
    fn construct<S: Rotational>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: ElementsParameters = parse(value)?;
        let mut all = Vec::new();
        for pair in from_files(p.source.as_ref(), p.target.as_ref(), context)? {
            let constants = constants("", (None, None, None), (p.a, p.b, p.p), context)?;
            all.push((pair, constants));
        }
        let filed = all.len();
        for (i, element) in p.element.iter().enumerate() {
            let path = format!("element.{i}");
            let (target, by) = (element.target.as_ref(), element.by.as_ref());
            let pair = pair(&path, &element.source, target, by, context)?;
            let own = (element.a, element.b, element.p);
            all.push((pair, constants(&path, own, (p.a, p.b, p.p), context)?));
        }
        if all.is_empty() {
            return Err(
                ConstructError::new("element", "there is no element").with_hint(
                    "add a table `[[warp.element]]` with `source` and `target`, each the places of its corners",
                ),
            );
        }
        let scaling = context.scaling.unwrap_or(Scaling::Displacement);
        built("element", filed, &all, scaling, ElementWarp::construct)
    }
    WarpEntry {
        kind: "elements",
        system: "B11",
        figure: "§4.2",
        summary: "carries points, segments, rectangles and boxes to their targets; the rest follows",
        reference: "A. Lerios, C. D. Garfinkle and M. Levoy, Feature-Based Volume Metamorphosis, SIGGRAPH 1995",
        example: if S::DIM == 2 {
            "element = [{ source = [\"20%\"], by = \"10%\" },\n\
             { source = [[\"60%\", \"60%\"], [\"90%\", \"60%\"], [\"60%\", \"90%\"]], \
             target = [[\"60%\", \"50%\"], [\"100%\", \"60%\"], [\"50%\", \"90%\"]] }]\n"
        } else {
            "element = [{ source = [\"20%\"], by = \"10%\" },\n\
             { source = [[\"50%\", \"20%\", \"50%\"], [\"50%\", \"50%\", \"50%\"]], \
             target = [[\"50%\", \"20%\", \"50%\"], [\"70%\", \"60%\", \"50%\"]] },\n\
             { source = [[\"60%\", \"70%\", \"40%\"], [\"90%\", \"70%\", \"40%\"], [\"60%\", \"90%\", \"40%\"], \
             [\"60%\", \"70%\", \"70%\"]] }]\n"
        },
        schema: ElementsParameters::json_schema,
        construct: construct::<S>,
    }
}
