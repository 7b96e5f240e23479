//! How recipes describe Barr deformations.
//!
//! *Source*: Milliron et al. 2002, §4.3; the notation is a decision.

use super::axial::Axial;
use super::bend::Bend;
use super::taper::Taper;
use super::twist::Twist;
use super::{AxialWarp, AxisError, AxisFrame, Course, Law};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Along, Angle, Axis, Built, ConstructError, Context, Coordinate, Length, Place, Value,
    WarpEntry, parse, schemars,
};
use anamorph_core::{Scaling, Solid, Space};
use anamorph_fields::{AxisRange, Ends, Limit, Profile};
use serde::Deserialize;

/// What becomes of the deformation at the ends of its range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Limits {
    /// It stops at once (C0).
    #[default]
    Clamp,
    /// It dies out over a blend (C2).
    Smooth,
}

/// The axis and the range that all Barr deformations share.
struct AxisParameters<'a> {
    axis: &'a Axis,
    across: Option<(&'static str, &'a Axis)>,
    centre: Option<&'a Place>,
    range: Option<&'a [Along; 2]>,
    limits: Limits,
    blend: Option<f64>,
}

/// The resolved axis and range.
struct Resolved<S: Space> {
    frame: AxisFrame<S>,
    range: AxisRange,
}

/// Resolves the axis and range of a Barr deformation's parameters, whose fields have the same names in all of them (a
/// shared structure cannot be flattened into them without losing the refusal of unknown keys).
macro_rules! resolved {
    ($parameters:ident, $across:expr, $context:expr) => {
        Resolved::new(
            &AxisParameters {
                axis: &$parameters.axis,
                across: $across,
                centre: $parameters.centre.as_ref(),
                range: $parameters.range.as_ref(),
                limits: $parameters.limits,
                blend: $parameters.blend,
            },
            $context,
        )
    };
}

impl<S: Space> Resolved<S> {
    fn new(
        parameters: &AxisParameters<'_>,
        context: &Context<'_, S>,
    ) -> Result<Self, ConstructError> {
        let axis: S = parameters.axis.resolve("axis")?;
        let centre = match parameters.centre {
            Some(place) => place.resolve("centre", context)?,
            None => context.bounds("centre")?.centre(),
        };
        let across = match parameters.across {
            Some((path, across)) => Some((path, across.resolve::<S>(path)?)),
            None => None,
        };
        let frame =
            AxisFrame::new(centre, axis, across.map(|(_, across)| across)).map_err(|error| {
                match error {
                    AxisError::Parallel => ConstructError::new(
                        across.map_or("axis", |(path, _)| path),
                        "it is parallel to the axis",
                    )
                    .with_hint("name a direction across the axis"),
                    error => ConstructError::new("axis", error.to_string()),
                }
            })?;
        let whole = [
            Along(Coordinate::Relative(0.0)),
            Along(Coordinate::Relative(1.0)),
        ];
        let [from, to] = parameters.range.copied().unwrap_or(whole);
        let from = from.resolve("range.0", centre, axis, context)?;
        let to = to.resolve("range.1", centre, axis, context)?;
        if from >= to {
            let message = format!("the range runs from {from} to {to} along the axis");
            return Err(ConstructError::new("range", message).with_hint(
                if parameters.range.is_none() {
                    "the model has no extent along the axis; write `range` as two numbers"
                } else if from == to {
                    "write two different coordinates, the smaller one first"
                } else {
                    "write the smaller coordinate first"
                },
            ));
        }
        let range = match parameters.limits {
            Limits::Clamp => {
                if parameters.blend.is_some() {
                    return Err(ConstructError::new("blend", "a clamp has no blend")
                        .with_hint("write `limits = \"smooth\"`, or leave `blend` out"));
                }
                AxisRange::new(from, to, Limit::Clamp)
            }
            Limits::Smooth => {
                let share = parameters.blend.unwrap_or(0.2);
                if !(share > 0.0 && share <= 0.5) {
                    return Err(ConstructError::new(
                        "blend",
                        format!("{share} is not a share of the range"),
                    )
                    .with_hint("write a number greater than 0 and at most 0.5"));
                }
                AxisRange::new(
                    from,
                    to,
                    Limit::Smooth {
                        width: share * (to - from),
                    },
                )
            }
        };
        let range = range.map_err(|error| ConstructError::new("range", error.to_string()))?;
        Ok(Self { frame, range })
    }

    fn length(&self) -> f64 {
        self.range.max() - self.range.min()
    }

    /// A curve drawn over the share of the range.
    fn drawn(&self, path: &str, points: &[[f64; 2]], scale: f64) -> Result<Course, ConstructError> {
        if let Some((i, point)) = points
            .iter()
            .enumerate()
            .find(|(_, point)| !(0.0..=1.0).contains(&point[0]))
        {
            return Err(ConstructError::new(
                format!("{path}.{i}.0"),
                format!("{} is not a share of the range", point[0]),
            )
            .with_hint("write a number from 0 (the start) to 1 (the end)"));
        }
        // A curve that spans the whole range is never asked beyond its ends; then they need not be flattened.
        let spans = points.first().is_some_and(|p| p[0] == 0.0)
            && points.last().is_some_and(|p| p[0] == 1.0);
        let ends = if spans { Ends::Linear } else { Ends::Constant };
        let profile = Profile::through_with_ends(points, ends)
            .map_err(|error| ConstructError::new(path, error.to_string()))?;
        Ok(Course::Drawn {
            profile,
            from: self.range.min(),
            per_length: 1.0 / self.length(),
            scale,
        })
    }

    /// The course that `profile` draws, else the polynomial, which holds everywhere unless a range is asked for.
    fn drawn_or_polynomial(
        &self,
        profile: Option<Vec<[f64; 2]>>,
        polynomial: Option<Vec<f64>>,
        ranged: bool,
    ) -> Result<(Course, Option<AxisRange>), ConstructError> {
        match profile {
            Some(points) => Ok((self.drawn("profile", &points, 1.0)?, Some(self.range))),
            None => Ok((
                Course::Polynomial(polynomial.unwrap_or_default()),
                ranged.then_some(self.range),
            )),
        }
    }

    /// A straight course over the range.
    fn linear(&self, start: f64, end: f64) -> Course {
        Course::linear(self.range.min(), start, self.range.max(), end)
    }

    fn built<L: Law + 'static>(
        &self,
        warp: Result<AxialWarp<S, L>, AxisError>,
    ) -> Result<Built<S>, ConstructError> {
        let warp = warp.map_err(|error| ConstructError::new("", error.to_string()))?;
        let margin = 0.1 * self.length();
        let marks = warp.marks(self.range.min() - margin, self.range.max() + margin);
        Ok(Built::new(marks, Box::new(warp)))
    }
}

/// Points [share of the range, angle] in radians.
fn angles(points: &[(f64, Angle)]) -> Vec<[f64; 2]> {
    let points = points.iter();
    points.map(|(at, angle)| [*at, angle.radians()]).collect()
}

/// Exactly one of several ways to say the same.
fn one_of(given: &[(&str, bool)]) -> Result<(), ConstructError> {
    let named: Vec<&str> = given
        .iter()
        .filter(|(_, given)| *given)
        .map(|(name, _)| *name)
        .collect();
    let all: Vec<String> = given.iter().map(|(name, _)| format!("`{name}`")).collect();
    match named.as_slice() {
        [_] => Ok(()),
        [] => Err(
            ConstructError::new("", format!("one of {} is missing", all.join(", ")))
                .with_hint("write the one that suits you"),
        ),
        [_, second, ..] => Err(ConstructError::new(
            *second,
            format!("only one of {} can be given", all.join(", ")),
        )
        .with_hint("remove the others")),
    }
}

/// A model is scaled across an axis by a factor that varies along it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TaperParameters {
    /// Direction of the axis.
    axis: Axis,
    /// A point of the axis; the middle of the model if left out.
    centre: Option<Place>,
    /// Where along the axis the factor varies; the whole model if left out. Beyond it the factor stays.
    range: Option<[Along; 2]>,
    /// What happens at the ends of the range.
    #[serde(default)]
    limits: Limits,
    /// Width of each smooth end as a share of the range (at most 0.5), 0.2 if left out.
    blend: Option<f64>,
    /// The factor at the end of the range; it is 1 at the start and linear in between.
    factor: Option<f64>,
    /// The factor drawn by points [share of the range, factor], smooth through them.
    #[schemars(length(min = 1))]
    profile: Option<Vec<[f64; 2]>>,
    /// The factor as a polynomial c0 + c1 z + c2 z² … of the coordinate along the axis in scene units.
    #[schemars(length(min = 1))]
    polynomial: Option<Vec<f64>>,
}

/// The registry entry of the taper.
pub(crate) fn taper<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: TaperParameters = parse(value)?;
        one_of(&[
            ("factor", p.factor.is_some()),
            ("profile", p.profile.is_some()),
            ("polynomial", p.polynomial.is_some()),
        ])?;
        let resolved = resolved!(p, None, context)?;
        let (factor, range) = if let Some(factor) = p.factor {
            (resolved.linear(1.0, factor), Some(resolved.range))
        } else {
            resolved.drawn_or_polynomial(p.profile, p.polynomial, p.range.is_some())?
        };
        let scaling = context.scaling.unwrap_or(Scaling::Displacement);
        resolved.built(Taper::construct(resolved.frame, factor, range, scaling))
    }
    WarpEntry {
        kind: "taper",
        system: "B13",
        figure: "§4.3.1, Fig. 12",
        summary: "scales a model across an axis by a factor that varies along it",
        reference: "A. H. Barr, Global and Local Deformations of Solid Primitives, SIGGRAPH 1984",
        example: "axis = \"y\"\nprofile = [[0, 1], [0.5, 0.55], [1, 1.1]]\n",
        schema: TaperParameters::json_schema,
        construct: construct::<S>,
    }
}

/// A model is turned about an axis by an angle that varies along it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct TwistParameters {
    /// Direction of the axis; the model turns about it by the right-hand rule.
    axis: Axis,
    /// A point of the axis; the middle of the model if left out.
    centre: Option<Place>,
    /// Where along the axis the angle varies; the whole model if left out. Beyond it the angle stays.
    range: Option<[Along; 2]>,
    /// What happens at the ends of the range.
    #[serde(default)]
    limits: Limits,
    /// Width of each smooth end as a share of the range (at most 0.5), 0.2 if left out.
    blend: Option<f64>,
    /// The angle at the end of the range; it grows evenly from `start`.
    angle: Option<Angle>,
    /// The angle at the start of the range, 0 if left out.
    start: Option<Angle>,
    /// The angle drawn by points [share of the range, angle], smooth through them.
    #[schemars(length(min = 1))]
    profile: Option<Vec<(f64, Angle)>>,
    /// The angle as a polynomial c0 + c1 z + c2 z² … in radians, of the coordinate along the axis in scene units.
    #[schemars(length(min = 1))]
    polynomial: Option<Vec<f64>>,
}

/// The registry entry of the twist.
pub(crate) fn twist() -> WarpEntry<Solid> {
    fn construct(
        value: &Value,
        context: &Context<'_, Solid>,
    ) -> Result<Built<Solid>, ConstructError> {
        let p: TwistParameters = parse(value)?;
        one_of(&[
            ("angle", p.angle.is_some()),
            ("profile", p.profile.is_some()),
            ("polynomial", p.polynomial.is_some()),
        ])?;
        if p.start.is_some() && p.angle.is_none() {
            return Err(
                ConstructError::new("start", "it only goes with `angle`").with_hint("remove it")
            );
        }
        let resolved = resolved!(p, None, context)?;
        let (angle, range) = if let Some(angle) = p.angle {
            let start = p.start.map_or(0.0, Angle::radians);
            (
                resolved.linear(start, angle.radians()),
                Some(resolved.range),
            )
        } else {
            let profile = p.profile.as_deref().map(angles);
            resolved.drawn_or_polynomial(profile, p.polynomial, p.range.is_some())?
        };
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        resolved.built(Twist::construct(resolved.frame, angle, range, scaling))
    }
    WarpEntry {
        kind: "twist",
        system: "B13",
        figure: "§4.3.2",
        summary: "turns a model about an axis by an angle that varies along it",
        reference: "A. H. Barr, Global and Local Deformations of Solid Primitives, SIGGRAPH 1984",
        example: "axis = \"y\"\nangle = \"120deg\"\n",
        schema: TwistParameters::json_schema,
        construct,
    }
}

/// The axis of a model becomes a circular arc, straight on both sides of it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BendParameters {
    /// Direction of the axis that is bent.
    axis: Axis,
    /// Direction towards which the axis bends; its part across the axis counts.
    toward: Axis,
    /// A point of the axis; the middle of the model if left out.
    centre: Option<Place>,
    /// The part of the axis that bends; the whole model if left out. Beyond it the axis stays straight.
    range: Option<[Along; 2]>,
    /// What happens at the ends of the range.
    #[serde(default)]
    limits: Limits,
    /// Width of each smooth end as a share of the range (at most 0.5), 0.2 if left out.
    blend: Option<f64>,
    /// The angle between the ends of the range.
    angle: Option<Angle>,
    /// The radius of the arc, instead of the angle.
    radius: Option<Length>,
    /// The place on the axis that stays where it is; the start of the range if left out.
    pivot: Option<Along>,
}

/// The registry entry of the bend.
pub(crate) fn bend<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: BendParameters = parse(value)?;
        one_of(&[("angle", p.angle.is_some()), ("radius", p.radius.is_some())])?;
        let resolved = resolved!(p, Some(("toward", &p.toward)), context)?;
        let curvature = match (p.angle, p.radius) {
            (_, Some(radius)) => 1.0 / radius.resolve_positive("radius", context)?,
            (angle, None) => angle.map_or(0.0, Angle::radians) / resolved.length(),
        };
        let pivot = match p.pivot {
            Some(pivot) => pivot.resolve(
                "pivot",
                resolved.frame.origin,
                resolved.frame.basis[2],
                context,
            )?,
            None => resolved.range.min(),
        };
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        resolved.built(Bend::construct(
            resolved.frame,
            curvature,
            pivot,
            Some(resolved.range),
            scaling,
        ))
    }
    WarpEntry {
        kind: "bend",
        system: "B13",
        figure: "§4.3.2",
        summary: "bends the axis of a model into a circular arc",
        reference: "A. H. Barr, Global and Local Deformations of Solid Primitives, SIGGRAPH 1984",
        example: "axis = \"y\"\ntoward = \"x\"\nangle = \"70deg\"\nlimits = \"smooth\"\n",
        schema: BendParameters::json_schema,
        construct: construct::<S>,
    }
}

/// Scaling across, turning about and shifting from an axis, each drawn along it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxialParameters {
    /// Direction of the axis.
    axis: Axis,
    /// First direction across the axis. If left out: in space the coordinate axis least aligned with it, in the plane the
    /// normal to its left.
    across: Option<Axis>,
    /// A point of the axis; the middle of the model if left out.
    centre: Option<Place>,
    /// The part of the axis over which everything is drawn; the whole model if left out.
    range: Option<[Along; 2]>,
    /// What happens at the ends of the range.
    #[serde(default)]
    limits: Limits,
    /// Width of each smooth end as a share of the range (at most 0.5), 0.2 if left out.
    blend: Option<f64>,
    /// Points [share of the range, factor along `across`, factor along the third direction].
    #[schemars(length(min = 1))]
    scale: Option<Vec<[f64; 3]>>,
    /// Points [share of the range, angle about the axis]; in space only.
    #[schemars(length(min = 1))]
    turn: Option<Vec<(f64, Angle)>>,
    /// Points [share of the range, shift along `across`, along the third direction, along the axis]; lengths, also as
    /// percentages of the diagonal.
    #[schemars(length(min = 1))]
    shift: Option<Vec<(f64, Length, Length, Length)>>,
}

/// The registry entry of the generalized Barr deformation.
pub(crate) fn axial<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: AxialParameters = parse(value)?;
        if p.scale.is_none() && p.turn.is_none() && p.shift.is_none() {
            return Err(
                ConstructError::new("", "none of `scale`, `turn` and `shift` is given")
                    .with_hint("draw at least one of them along the axis"),
            );
        }
        let resolved = resolved!(
            p,
            p.across.as_ref().map(|across| ("across", across)),
            context
        )?;
        let constant = |value: f64| Course::Polynomial(vec![value]);
        let mut law = Axial {
            factors: [constant(1.0), constant(1.0)],
            turn: constant(0.0),
            shifts: [constant(0.0), constant(0.0), constant(0.0)],
            range: Some(resolved.range),
        };
        if let Some(scale) = &p.scale {
            for side in 0..2 {
                let points: Vec<[f64; 2]> =
                    scale.iter().map(|row| [row[0], row[1 + side]]).collect();
                law.factors[side] = resolved.drawn("scale", &points, 1.0)?;
            }
        }
        if let Some(turn) = &p.turn {
            law.turn = resolved.drawn("turn", &angles(turn), 1.0)?;
        }
        if let Some(shift) = &p.shift {
            let mut points: [Vec<[f64; 2]>; 3] = Default::default();
            for (i, (at, x, y, z)) in shift.iter().enumerate() {
                for (side, length) in [x, y, z].into_iter().enumerate() {
                    points[side].push([
                        *at,
                        length.resolve(&format!("shift.{i}.{}", side + 1), context)?,
                    ]);
                }
            }
            for (course, points) in law.shifts.iter_mut().zip(&points) {
                *course = resolved.drawn("shift", points, 1.0)?;
            }
        }
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        resolved.built(law.construct(resolved.frame, scaling))
    }
    WarpEntry {
        kind: "axial",
        system: "B13",
        figure: "§4.3.2",
        summary: "scales across, turns about and shifts from an axis, each drawn along it",
        reference: "A. H. Barr, Global and Local Deformations of Solid Primitives, SIGGRAPH 1984; generalized as in \
                    Milliron et al., A Framework for Geometric Warps and Deformations, ACM TOG 2002",
        example: "axis = \"y\"\nscale = [[0, 1, 1], [0.5, 1.3, 0.7], [1, 1, 1]]\n\
                  shift = [[0, 0, 0, 0], [0.5, \"8%\", 0, 0], [1, 0, 0, 0]]\n",
        schema: AxialParameters::json_schema,
        construct: construct::<S>,
    }
}
