//! How recipes describe point, frame and vortex features.
//!
//! *Source*: Milliron et al. 2002, §3.2–3.3; the notation is a decision.

use super::frames::FrameWarp;
use super::points::PointWarp;
use super::vortex::Vortex;
use super::{FeatureError, Reach};
use crate::cages::{Feature, load};
use crate::lattices::frame_pairs;
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Angle, Axis, Between, Built, ConstructError, Context, Features, Length, Offset, Place, Value,
    WarpEntry, parse, schemars, source_and_target,
};
use anamorph_core::{Linear, Scaling, Space, Warp};
use anamorph_features::{Frame, FramePair, PointPair};
use anamorph_fields::recipe::FalloffName;
use anamorph_transforms::Rotational;
use serde::Deserialize;

/// An error of a feature of the list `list`, before which come `from_files` features of files.
fn located(list: &str, from_files: usize, error: &FeatureError) -> ConstructError {
    let at = |feature: usize, key: &str| match feature.checked_sub(from_files) {
        Some(number) => format!("{list}.{number}{key}"),
        None => "target".to_owned(),
    };
    let path = match error {
        FeatureError::NotFinite { feature } => at(*feature, ""),
        FeatureError::Radius { feature, .. } => at(*feature, ".radius"),
        FeatureError::Flat { feature, .. } => at(*feature, ""),
        FeatureError::NoAxis => "axis".to_owned(),
        FeatureError::Angle => "angle".to_owned(),
    };
    ConstructError::new(path, error.to_string())
}

/// The reach of one feature, from its own parameters or the warp's.
fn reach<S: Space>(
    path: &str,
    own: (Option<Length>, Option<FalloffName>),
    common: (Option<Length>, Option<FalloffName>),
    context: &Context<'_, S>,
) -> Result<Reach, ConstructError> {
    let radius = match (own.0, common.0) {
        (Some(length), _) => Some(length.resolve_positive(&format!("{path}.radius"), context)?),
        (None, Some(length)) => Some(length.resolve_positive("radius", context)?),
        (None, None) => None,
    };
    let falloff = own.1.or(common.1).unwrap_or_default();
    if radius.is_some() && !falloff.get().compact() {
        let at = if own.1.is_some() {
            format!("{path}.falloff")
        } else {
            "falloff".to_owned()
        };
        let message = format!("`{}` does not end at a radius", falloff.get().name());
        return Err(
            ConstructError::new(at, message).with_hint("take one that does, such as \"wires\"")
        );
    }
    Ok(Reach {
        radius,
        falloff: falloff.get(),
    })
}

/// Source points and their targets.
pub(crate) type Both<S> = (Vec<S>, Vec<S>);

/// The files of a warp.
pub(crate) struct Files<S> {
    source: Option<Feature<S>>,
    target: Option<Feature<S>>,
}

impl<S: Space> Files<S> {
    pub(crate) fn load(
        source: Option<&String>,
        target: Option<&String>,
        context: &Context<'_, S>,
    ) -> Result<Self, ConstructError> {
        Ok(Self {
            source: load("source", source, context)?,
            target: load("target", target, context)?,
        })
    }

    /// The points of both, if there are files; `kind` is what a cage may say that it is for.
    pub(crate) fn points(&self, kind: &str) -> Result<Option<Both<S>>, ConstructError> {
        let both = source_and_target(self.source.as_ref(), self.target.as_ref())?;
        let Some((source, target)) = both else {
            return Ok(None);
        };
        source.expect_kind(kind)?;
        target.expect_kind(kind)?;
        let targets = target.one_for_each(source)?;
        Ok(Some((source.points.clone(), targets)))
    }
}

/// The target of a feature: a place, or an offset from the source.
pub(crate) fn target<S: Space>(
    path: &str,
    source: S,
    to: Option<&Place>,
    by: Option<&Offset>,
    context: &Context<'_, S>,
) -> Result<S, ConstructError> {
    match (to, by) {
        (Some(to), None) => to.resolve(&format!("{path}.to"), context),
        (None, Some(by)) => Ok(source + by.resolve(&format!("{path}.by"), context)?),
        (None, None) => Ok(source),
        (Some(_), Some(_)) => Err(ConstructError::new(
            format!("{path}.by"),
            "both `to` and `by` are given",
        )
        .with_hint("write the target as a place with `to`, or as an offset with `by`")),
    }
}

/// The pairs of features that are points.
pub(crate) fn point_pairs<S: Space>(sources: &[Vec<S>], targets: &[Vec<S>]) -> Vec<PointPair<S>> {
    let each = sources.iter().flatten().zip(targets.iter().flatten());
    each.map(|(&source, &target)| PointPair { source, target })
        .collect()
}

/// Pairs of points as features of a warp.
pub(crate) fn point_features<'a, S: Space>(
    pairs: impl Iterator<Item = &'a PointPair<S>> + Clone,
    with: Box<Between<S>>,
) -> Features<S> {
    Features {
        sources: pairs.clone().map(|pair| vec![pair.source]).collect(),
        targets: pairs.map(|pair| vec![pair.target]).collect(),
        with,
    }
}

/// One source point and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PointParameters {
    /// The source point.
    from: Place,
    /// The target point.
    to: Option<Place>,
    /// The offset from source to target, instead of `to`. With neither the point is pinned.
    by: Option<Offset>,
    /// How far this point reaches.
    radius: Option<Length>,
    /// How its strength falls off within the radius.
    falloff: Option<FalloffName>,
}

/// Source points are carried to their targets, and the rest follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PointsParameters {
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<PointParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// How far points reach that say nothing themselves; everywhere if left out.
    radius: Option<Length>,
    /// Their falloff, "wires" if left out.
    falloff: Option<FalloffName>,
}

/// The registry entry of the point warp.
pub(crate) fn points<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: PointsParameters = parse(value)?;
        let files = Files::load(p.source.as_ref(), p.target.as_ref(), context)?;
        let mut pairs = Vec::new();
        if let Some((sources, targets)) = files.points("points")? {
            let reach = reach("", (None, None), (p.radius, p.falloff), context)?;
            for (source, target) in sources.into_iter().zip(targets) {
                pairs.push((PointPair { source, target }, reach));
            }
        }
        let from_files = pairs.len();
        for (i, point) in p.point.iter().enumerate() {
            let path = format!("point.{i}");
            let source: S = point.from.resolve(&format!("{path}.from"), context)?;
            let target = target(&path, source, point.to.as_ref(), point.by.as_ref(), context)?;
            let reach = reach(
                &path,
                (point.radius, point.falloff),
                (p.radius, p.falloff),
                context,
            )?;
            pairs.push((PointPair { source, target }, reach));
        }
        if pairs.is_empty() {
            return Err(ConstructError::new("point", "there is no point").with_hint(
                "add a table `[[warp.point]]` with `from` and `to`, or name files as `source` and `target`",
            ));
        }
        let count = pairs.len();
        let reaches: Vec<Reach> = pairs.iter().map(|(_, reach)| *reach).collect();
        let with = move |sources: &[Vec<S>], targets: &[Vec<S>]| {
            let pairs = point_pairs(sources, targets).into_iter();
            let warp = PointWarp::construct(pairs.zip(reaches.iter().copied()).collect())
                .map_err(|error| located("point", from_files, &error))?;
            Ok(Box::new(warp) as Box<dyn Warp<S>>)
        };
        let features = point_features(pairs.iter().map(|(pair, _)| pair), Box::new(with));
        let built = move |changes: &[S]| {
            let mut pairs = pairs.clone();
            for ((pair, _), change) in pairs.iter_mut().zip(changes) {
                pair.target += *change;
            }
            let warp = PointWarp::construct(pairs)
                .map_err(|error| located("point", from_files, &error))?;
            Ok(Built::new(warp.marks(), Box::new(warp)))
        };
        Ok(built(&vec![S::ZERO; count])?
            .fitted_by(count, built)
            .between(features))
    }
    WarpEntry {
        kind: "points",
        system: "B1",
        figure: "§3.2, Figs. 2–4",
        summary: "carries source points to their targets; the rest follows",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §3.2",
        example: if S::DIM == 2 {
            "radius = \"45%\"\npoint = [{ from = \"50%\", by = [\"30%\", \"20%\"] }]\n"
        } else {
            "radius = \"45%\"\npoint = [{ from = \"50%\", by = [\"30%\", \"20%\", 0] }]\n"
        },
        schema: PointsParameters::json_schema,
        construct: construct::<S>,
    }
}

/// One source frame and its target.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrameParameters {
    /// Origin of the source frame.
    at: Place,
    /// Basis vectors of the source frame, the coordinate axes if left out.
    axes: Option<Vec<Vec<f64>>>,
    /// Origin of the target frame.
    to: Option<Place>,
    /// The offset from source to target origin, instead of `to`. With neither the origin stays.
    by: Option<Offset>,
    /// Basis vectors of the target frame, instead of `turn` and `scale`.
    target_axes: Option<Vec<Vec<f64>>>,
    /// Angle by which the target frame is turned, about `axis` in space.
    turn: Option<Angle>,
    /// Axis of the turn, in space.
    axis: Option<Axis>,
    /// Factor of the target frame's basis vectors.
    scale: Option<f64>,
    /// How far this frame reaches.
    radius: Option<Length>,
    /// How its strength falls off within the radius.
    falloff: Option<FalloffName>,
}

/// Source frames are carried to their targets, and the rest follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FramesParameters {
    /// The frames; those of the files come before them.
    #[serde(default)]
    frame: Vec<FrameParameters>,
    /// A file with source frames, such as from `anamorph cage --frames`: an origin and the tips of the basis vectors each.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// How far frames reach that say nothing themselves; everywhere if left out.
    radius: Option<Length>,
    /// Their falloff, "wires" if left out.
    falloff: Option<FalloffName>,
}

/// A basis from its vectors as rows of a list.
fn basis<S: Space>(path: &str, rows: &[Vec<f64>]) -> Result<S::Linear, ConstructError> {
    if rows.len() != S::DIM || rows.iter().any(|row| row.len() != S::DIM) {
        let message = format!(
            "a basis of the {} is {} vectors of {} numbers",
            S::NAME,
            S::DIM,
            S::DIM
        );
        return Err(ConstructError::new(path, message).with_hint("write one list per vector"));
    }
    Ok(S::Linear::from_columns(|i| S::from_fn(|j| rows[i][j])))
}

/// The linear map of `turn`, `axis` and `scale`.
pub(crate) fn turn_and_scale<S: Space>(
    path: &str,
    turn: Option<Angle>,
    axis: Option<&Axis>,
    scale: Option<f64>,
) -> Result<S::Linear, ConstructError> {
    let direction = match (axis, turn, S::DIM) {
        (Some(_), _, 2) => {
            return Err(ConstructError::new(
                format!("{path}.axis"),
                "a turn in the plane has no axis",
            )
            .with_hint("remove it"));
        }
        (Some(_), None, _) => {
            return Err(ConstructError::new(
                format!("{path}.axis"),
                "there is an axis but no turn about it",
            )
            .with_hint("write `turn`, for example \"30deg\", or remove the axis"));
        }
        (None, Some(_), 3) => {
            return Err(ConstructError::new(path, "a turn in space needs an `axis`")
                .with_hint("write, for example, `axis = \"y\"`"));
        }
        (Some(axis), _, _) => axis.resolve(&format!("{path}.axis"))?,
        (None, _, _) => S::ZERO,
    };
    let factor = scale.unwrap_or(1.0);
    if !(factor.is_finite() && factor != 0.0) {
        return Err(ConstructError::new(
            format!("{path}.scale"),
            format!("the factor is {factor}"),
        )
        .with_hint("write a finite number that is not 0"));
    }
    Ok(S::rotation(direction, turn.map_or(0.0, Angle::radians)) * factor)
}

/// The registry entry of the frame warp.
pub(crate) fn frames<S: Rotational>() -> WarpEntry<S> {
    fn construct<S: Rotational>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: FramesParameters = parse(value)?;
        let files = Files::load(p.source.as_ref(), p.target.as_ref(), context)?;
        let mut pairs = Vec::new();
        if let Some((sources, targets)) = files.points("frame-lattice")? {
            if sources.len() % (S::DIM + 1) != 0 {
                let message = format!(
                    "{} has {} points, and a frame takes {}: its origin and the tips of its basis vectors",
                    p.source.as_deref().unwrap_or_default(),
                    sources.len(),
                    S::DIM + 1
                );
                return Err(ConstructError::new("source", message)
                    .with_hint("make such a file with `anamorph cage --frames`"));
            }
            let reach = reach("", (None, None), (p.radius, p.falloff), context)?;
            let all = frame_pairs(&sources, &targets)?.into_iter();
            for (pair, origin) in all.zip(sources.chunks_exact(S::DIM + 1)) {
                let still = || {
                    let basis = S::Linear::from_columns(|axis| origin[axis + 1] - origin[0]);
                    Frame::new(origin[0], basis).map(|frame| FramePair {
                        source: frame,
                        target: frame,
                    })
                };
                let pair = pair.map_or_else(still, Ok);
                let pair =
                    pair.map_err(|error| ConstructError::new("source", error.to_string()))?;
                pairs.push((pair, reach));
            }
        }
        let from_files = pairs.len();
        for (i, frame) in p.frame.iter().enumerate() {
            let path = format!("frame.{i}");
            let at: S = frame.at.resolve(&format!("{path}.at"), context)?;
            let origin = target(&path, at, frame.to.as_ref(), frame.by.as_ref(), context)?;
            let source_axes = match &frame.axes {
                Some(rows) => basis::<S>(&format!("{path}.axes"), rows)?,
                None => S::Linear::IDENTITY,
            };
            let target_axes = match &frame.target_axes {
                Some(rows) => {
                    if frame.turn.is_some() || frame.scale.is_some() {
                        let message =
                            "`target_axes` already says how the frame is turned and scaled";
                        return Err(ConstructError::new(path, message)
                            .with_hint("remove `turn` and `scale`"));
                    }
                    basis::<S>(&format!("{path}.target_axes"), rows)?
                }
                None => turn_and_scale::<S>(&path, frame.turn, frame.axis.as_ref(), frame.scale)?
                    .after(&source_axes),
            };
            let source = Frame::new(at, source_axes)
                .map_err(|error| ConstructError::new(format!("{path}.axes"), error.to_string()))?;
            let goal = Frame::new(origin, target_axes).map_err(|error| {
                ConstructError::new(format!("{path}.target_axes"), error.to_string())
            })?;
            let reach = reach(
                &path,
                (frame.radius, frame.falloff),
                (p.radius, p.falloff),
                context,
            )?;
            pairs.push((
                FramePair {
                    source,
                    target: goal,
                },
                reach,
            ));
        }
        if pairs.is_empty() {
            return Err(ConstructError::new("frame", "there is no frame").with_hint(
                "add a table `[[warp.frame]]` with `at`, `turn` and `axis`, or name files as `source` and `target`",
            ));
        }
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        let warp = FrameWarp::construct(pairs, scaling)
            .map_err(|error| located("frame", from_files, &error))?;
        let length = context
            .bounds
            .map_or(1.0, |bounds| 0.15 * bounds.diagonal());
        Ok(Built::new(warp.marks(length), Box::new(warp)))
    }
    WarpEntry {
        kind: "frames",
        system: "B2",
        figure: "§3.3, Fig. 5",
        summary: "carries source coordinate frames to their targets; the rest follows",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §3.3",
        example: "radius = \"50%\"\nframe = [{ at = \"50%\", by = \"10%\", scale = 1.4 }]\n",
        schema: FramesParameters::json_schema,
        construct: construct::<S>,
    }
}

/// A swirl about a centre (2-D) or a line (3-D) that dies out with distance.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct VortexParameters {
    /// The centre, or a point of the axis.
    centre: Place,
    /// Direction of the axis; needed in space, absent in the plane.
    axis: Option<Axis>,
    /// Angle at the centre, counter-clockwise, by the right-hand rule about the axis.
    angle: Angle,
    /// Distance from the centre or axis at which the swirl has died out.
    radius: Length,
    /// How the angle falls off, "wires" if left out.
    falloff: Option<FalloffName>,
}

/// The registry entry of the vortex.
pub(crate) fn vortex<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: VortexParameters = parse(value)?;
        let centre: S = p.centre.resolve("centre", context)?;
        let axis = match (&p.axis, S::DIM) {
            (None, 3) => {
                return Err(ConstructError::new("", "a vortex in space needs an `axis`")
                    .with_hint("write, for example, `axis = \"y\"`"));
            }
            (Some(_), 2) => {
                return Err(
                    ConstructError::new("axis", "a vortex in the plane has no axis")
                        .with_hint("remove it"),
                );
            }
            (Some(axis), _) => axis.resolve("axis")?,
            (None, _) => S::ZERO,
        };
        let radius = p.radius.resolve_positive("radius", context)?;
        let falloff = p.falloff.unwrap_or_default().get();
        if !falloff.compact() {
            let message = format!("`{}` does not end at a radius", falloff.name());
            return Err(ConstructError::new("falloff", message)
                .with_hint("take one that does, such as \"wires\""));
        }
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        let warp = Vortex::construct(centre, axis, p.angle.radians(), radius, falloff, scaling)
            .map_err(|error| located("", 0, &error))?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "vortex",
        system: "B2",
        figure: "§3.3, after Wolberg 1990",
        summary: "swirls a model about a centre or a line; the turn dies out with distance",
        reference: "G. Wolberg, Digital Image Warping, IEEE Computer Society Press, 1990",
        example: if S::DIM == 2 {
            "centre = \"50%\"\nangle = \"140deg\"\nradius = \"40%\"\n"
        } else {
            "centre = \"50%\"\naxis = \"y\"\nangle = \"140deg\"\nradius = \"40%\"\n"
        },
        schema: VortexParameters::json_schema,
        construct: construct::<S>,
    }
}
