//! How recipes describe axial deformation.
//!
//! *Source*: F. Lazarus, S. Coquillart, P. Jancène, *Axial deformations*, Computer-Aided Design 26(8), 1994; the notation is a
//! decision. Frames are the rotation-minimizing ones of `anamorph-curves`; the target's first frame is the axis's, turned by the
//! smallest rotation.

use super::curve_parameters::{CurveParameter, RecipeCurve};
use super::parameters::Numbers;
use super::{AxialCurve, AxialReach, Axis as CurveAxis, Rail, Station, WireError};
use crate::barr::{AxisError, AxisFrame};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Along, Angle, Axis, Built, ConstructError, Context, Coordinate, Length, Place, Value,
    WarpEntry, parse, schemars,
};
use anamorph_core::{Differentiable, Linear, Plane, Solid, Space};
use anamorph_curves::LengthTable;
use anamorph_curves::families::registry::{InFamily, Path};
use anamorph_curves::orientation::{Orienter, RotationMinimizing};
use anamorph_fields::Profile;
use anamorph_fields::recipe::FalloffName;
use anamorph_transforms::Rotational;
use serde::Deserialize;
use std::sync::Arc;

/// Error of the tables of points and frames.
const TABLE: f64 = 1e-9;

/// Frames at parameters of a curve.
pub(crate) type Frames<S> = Box<dyn Fn(f64) -> <S as Space>::Linear>;

/// Spaces in which curves carry frames.
pub(crate) trait Framed: Rotational + InFamily {
    /// The frames along a curve, the first with its second direction as near to `across` as can be.
    fn frames(path: Arc<dyn Path<Self>>, across: Self) -> Result<Frames<Self>, String>;
    /// A frame turned about its first direction.
    fn twisted(frame: Self::Linear, angle: f64) -> Self::Linear;
}

impl Framed for Plane {
    fn frames(path: Arc<dyn Path<Self>>, _: Self) -> Result<Frames<Self>, String> {
        let whole: Arc<dyn Differentiable<Self>> = Arc::new(Whole(path));
        let tangents = super::tangents::Tangents::new(whole)
            .filter(|tangents| tangents.polygon > 0.0)
            .ok_or("the curve has no length; give points that differ")?;
        Ok(Box::new(move |at| {
            let along = tangents.point_and_direction(at).1.unwrap_or(Plane::X);
            Linear::from_columns(|i| if i == 0 { along } else { along.perp() })
        }))
    }
    fn twisted(frame: Self::Linear, _: f64) -> Self::Linear {
        frame
    }
}

impl Framed for Solid {
    fn frames(path: Arc<dyn Path<Self>>, across: Self) -> Result<Frames<Self>, String> {
        let settings = RotationMinimizing {
            up: across,
            ..RotationMinimizing::default()
        };
        let frames = settings.along(path).map_err(|error| error.to_string())?;
        Ok(Box::new(move |at| {
            let frame = frames.frame(at);
            let columns = [frame.forward(), frame.up(), -frame.side()];
            Linear::from_columns(|i| columns[i])
        }))
    }
    fn twisted(frame: Self::Linear, angle: f64) -> Self::Linear {
        if angle == 0.0 {
            return frame;
        }
        <Solid as Space>::rotation(frame.x_axis, angle) * frame
    }
}

/// A path as a curve with derivatives.
struct Whole<S>(Arc<dyn Path<S>>);

impl<S: Space> anamorph_core::Curve<S> for Whole<S> {
    fn domain(&self) -> (f64, f64) {
        self.0.domain()
    }
    fn point(&self, parameter: f64) -> S {
        self.0.point(parameter)
    }
    fn is_closed(&self) -> bool {
        self.0.is_closed()
    }
}

impl<S: Space> Differentiable<S> for Whole<S> {
    fn jet(&self, parameter: f64) -> anamorph_core::Jet<S> {
        self.0.jet(parameter)
    }
    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }
}

/// What the axis does with its length.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Lengthwise {
    /// It spans the whole target, evenly by length.
    #[default]
    Stretch,
    /// It keeps its length from the target's start, and goes on straight where the target is shorter.
    Keep,
}

/// An axis through the model is bent into a curve, and the model follows.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxialParameters {
    /// Direction of a straight axis.
    axis: Option<Axis>,
    /// A point of the straight axis; the middle of the model if left out.
    centre: Option<Place>,
    /// Where the straight axis starts and ends; the whole model if left out.
    range: Option<[Along; 2]>,
    /// A curved axis, instead of `axis`.
    source: Option<CurveParameter>,
    /// The curve that the axis becomes.
    target: CurveParameter,
    /// What the axis does with its length, in `stretch` if left out.
    length: Option<Lengthwise>,
    /// First direction across the axis at its start, in space.
    across: Option<Axis>,
    /// Points [share of the axis, angle about it], in space.
    twist: Option<Vec<(f64, Angle)>>,
    /// Factor across the axis, also drawn along it.
    scale: Option<Numbers>,
    /// Distances from the axis: up to the first the model follows wholly, from the second on it stays.
    reach: Option<[Length; 2]>,
    /// How the strength falls off between the two, "wires" if left out.
    falloff: Option<FalloffName>,
}

fn at_curve(key: &'static str) -> impl Fn(WireError) -> ConstructError {
    move |error| {
        let message = match error {
            WireError::NoLength { .. } => "the curve has no length; give points that differ",
            _ => "the curve is not finite; give finite points",
        };
        ConstructError::new(key, message)
    }
}

/// The first frame of the axis, and the axis without its rail if it is curved.
enum Given<S: Space> {
    Line {
        start: S,
        frame: S::Linear,
        length: f64,
    },
    Curve {
        curve: RecipeCurve<S>,
        frame: S::Linear,
        frames: Frames<S>,
    },
}

impl<S: Space> Given<S> {
    fn frame(&self) -> &S::Linear {
        match self {
            Self::Line { frame, .. } | Self::Curve { frame, .. } => frame,
        }
    }
}

impl AxialParameters {
    fn line<S: Framed>(
        &self,
        axis: &Axis,
        across: Option<S>,
        context: &Context<'_, S>,
    ) -> Result<Given<S>, ConstructError> {
        let direction: S = axis.resolve("axis")?;
        let centre = match &self.centre {
            Some(place) => place.resolve("centre", context)?,
            None => context.bounds("centre")?.centre(),
        };
        let frame = AxisFrame::new(centre, direction, across).map_err(|error| match error {
            AxisError::Parallel => ConstructError::new("across", "it is parallel to the axis")
                .with_hint("name a direction across the axis"),
            error => ConstructError::new("axis", error.to_string()),
        })?;
        let whole = [
            Along(Coordinate::Relative(0.0)),
            Along(Coordinate::Relative(1.0)),
        ];
        let [from, to] = self.range.unwrap_or(whole);
        let from = from.resolve("range.0", centre, direction, context)?;
        let to = to.resolve("range.1", centre, direction, context)?;
        if from >= to {
            let message = format!("the range runs from {from} to {to} along the axis");
            return Err(
                ConstructError::new("range", message).with_hint(if self.range.is_none() {
                    "the model has no extent along the axis; write `range` as two numbers"
                } else {
                    "write the smaller coordinate first"
                }),
            );
        }
        let [x, y, z] = frame.basis;
        let columns = [z, x, y];
        Ok(Given::Line {
            start: frame.place([0.0, 0.0, from]),
            frame: S::Linear::from_columns(|i| columns[i]),
            length: to - from,
        })
    }

    fn curve<S: Framed>(
        &self,
        source: &CurveParameter,
        across: Option<S>,
        context: &Context<'_, S>,
    ) -> Result<Given<S>, ConstructError> {
        for (key, given) in [
            ("centre", self.centre.is_some()),
            ("range", self.range.is_some()),
        ] {
            if given {
                let message = format!("a curved axis has no `{key}`");
                return Err(ConstructError::new(key, message).with_hint("remove it"));
            }
        }
        let curve = source.resolve::<S>("source", context)?;
        let up = across.unwrap_or_else(|| S::unit(1));
        let frames = S::frames(curve_path(&curve), up)
            .map_err(|message| ConstructError::new("source", message))?;
        let frame = frames(anamorph_core::Curve::domain(&curve).0);
        Ok(Given::Curve {
            curve,
            frame,
            frames,
        })
    }

    /// The rail of the target: points and frames by the share of the axis.
    fn rail<S: Framed>(
        &self,
        given: &Given<S>,
        context: &Context<'_, S>,
    ) -> Result<Rail<S>, ConstructError> {
        let target = self.target.resolve::<S>("target", context)?;
        let path = curve_path(&target);
        let (start, end) = anamorph_core::Curve::domain(&target);
        // The target's first frame: the axis's, turned by the smallest rotation.
        let first = S::frames(path.clone(), given.frame().column(1))
            .map_err(|message| ConstructError::new("target", message))?(start);
        let turn = S::turn_between(given.frame().column(0), first.column(0));
        let across = turn.map_or(given.frame().column(1), |turn| {
            turn.matrix(1.0).apply(given.frame().column(1))
        });
        let frames = S::frames(path.clone(), across)
            .map_err(|message| ConstructError::new("target", message))?;
        let scale = match &self.scale {
            Some(scale) => scale.resolve("scale")?,
            None => super::Along::constant(1.0),
        };
        let twist = match &self.twist {
            None => None,
            Some(_) if S::DIM == 2 => {
                return Err(ConstructError::new("twist", "the plane has no twist")
                    .with_hint("remove it, or use it on a 3-D model"));
            }
            Some(points) => {
                let points: Vec<[f64; 2]> = points
                    .iter()
                    .map(|(at, angle)| [*at, angle.radians()])
                    .collect();
                let profile = Profile::through(&points)
                    .map_err(|error| ConstructError::new("twist", error.to_string()))?;
                Some(profile)
            }
        };
        let finished = |share: f64, point: S, frame: S::Linear| {
            let angle = twist.as_ref().map_or(0.0, |twist| twist.value(share));
            let (frame, factor) = (S::twisted(frame, angle), scale.value(share));
            Station {
                point,
                frame: S::Linear::from_columns(|i| {
                    if i == 0 {
                        frame.column(0)
                    } else {
                        frame.column(i) * factor
                    }
                }),
            }
        };
        let length = match given {
            Given::Line { length, .. } => *length,
            // Of a curved axis the same parameters correspond.
            Given::Curve { .. } => {
                if self.length == Some(Lengthwise::Keep) {
                    let message = "a curved axis takes the target's parameters";
                    return Err(ConstructError::new("length", message)
                        .with_hint("remove it, or use a straight `axis`"));
                }
                let station = |share: f64| {
                    let at = start * (1.0 - share) + end * share;
                    finished(share, path.point(at), frames(at))
                };
                let breaks = shares(&target);
                return Rail::new("target", &breaks, &station, TABLE).map_err(at_curve("target"));
            }
        };
        let whole = path.length(1e-12);
        let table = LengthTable::new(path.as_ref(), 1e-11 * whole)
            .map_err(|error| ConstructError::new("target", error.to_string()))?;
        let span = match self.length.unwrap_or_default() {
            Lengthwise::Stretch => table.length(),
            Lengthwise::Keep => length,
        };
        let station = |share: f64| {
            let s = share * span;
            let at = if s >= table.length() {
                end
            } else {
                table.parameter(s)
            };
            let (point, frame) = (path.point(at), frames(at));
            let beyond = (s - table.length()).max(0.0);
            finished(share, point + frame.column(0) * beyond, frame)
        };
        let breaks = path
            .breaks()
            .into_iter()
            .map(|at| table.length_to(at) / span);
        let breaks: Vec<f64> = breaks.collect();
        Rail::new("target", &breaks, &station, TABLE).map_err(at_curve("target"))
    }

    fn reach<S: Space>(
        &self,
        context: &Context<'_, S>,
    ) -> Result<Option<AxialReach>, ConstructError> {
        let Some([inner, outer]) = self.reach else {
            if self.falloff.is_some() {
                return Err(
                    ConstructError::new("falloff", "without a reach nothing falls off")
                        .with_hint("write `reach`, such as [\"10%\", \"30%\"], or remove it"),
                );
            }
            return Ok(None);
        };
        let falloff = self.falloff.unwrap_or_default().get();
        if !falloff.compact() {
            let message = format!("`{}` does not end at a distance", falloff.name());
            return Err(ConstructError::new("falloff", message)
                .with_hint("take one that does, such as \"wires\""));
        }
        let inner = inner.resolve("reach.0", context)?;
        let outer = outer.resolve_positive("reach.1", context)?;
        if !(inner >= 0.0 && inner < outer) {
            let message = format!("the reach runs from {inner} to {outer}");
            return Err(ConstructError::new("reach", message)
                .with_hint("write two distances, the smaller one first, from 0"));
        }
        Ok(Some(AxialReach {
            inner,
            outer,
            falloff,
        }))
    }
}

/// The breaks of a curve as shares of its domain.
fn shares<S: Space>(curve: &RecipeCurve<S>) -> Vec<f64> {
    let (start, end) = anamorph_core::Curve::domain(curve);
    let breaks = curve.breaks().into_iter();
    breaks.map(|at| (at - start) / (end - start)).collect()
}

fn curve_path<S: Space>(curve: &RecipeCurve<S>) -> Arc<dyn Path<S>> {
    curve.handle().clone()
}

/// The registry entry of axial deformation.
pub(crate) fn axial_curve<S: Framed>() -> WarpEntry<S> {
    fn construct<S: Framed>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: AxialParameters = parse(value)?;
        let across = match &p.across {
            Some(_) if S::DIM == 2 => {
                return Err(
                    ConstructError::new("across", "the plane has one direction across")
                        .with_hint("remove it"),
                );
            }
            Some(axis) => Some(axis.resolve::<S>("across")?),
            None => None,
        };
        let given = match (&p.axis, &p.source) {
            (Some(axis), None) => p.line::<S>(axis, across, context)?,
            (None, Some(source)) => p.curve::<S>(source, across, context)?,
            (Some(_), Some(_)) => {
                return Err(
                    ConstructError::new("source", "both `axis` and `source` are given")
                        .with_hint("write a straight `axis` or a curved `source`"),
                );
            }
            (None, None) => {
                return Err(ConstructError::new("", "missing field `axis`")
                    .with_hint("write a straight `axis`, such as \"y\", or a curved `source`"));
            }
        };
        let rail = p.rail::<S>(&given, context)?;
        let axis = match given {
            Given::Line {
                start,
                frame,
                length,
            } => CurveAxis::Line {
                origin: start,
                frame,
                length,
            },
            Given::Curve { curve, frames, .. } => {
                let path = curve_path(&curve);
                let (start, end) = anamorph_core::Curve::domain(&curve);
                let station = |share: f64| {
                    let at = start * (1.0 - share) + end * share;
                    Station {
                        point: path.point(at),
                        frame: frames(at),
                    }
                };
                let breaks = shares(&curve);
                let rail =
                    Rail::new("source", &breaks, &station, TABLE).map_err(at_curve("source"))?;
                CurveAxis::Curve {
                    curve: Arc::new(curve),
                    rail,
                }
            }
        };
        let warp = AxialCurve::construct(axis, rail, p.reach(context)?)
            .map_err(|error| ConstructError::new("", error.to_string()))?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "axial-curve",
        system: "B16",
        figure: "§4.4",
        summary: "bends an axis of a model into any curve; the model follows without twist",
        reference: "F. Lazarus, S. Coquillart and P. Jancène, Axial Deformations: An Intuitive Deformation Technique, \
                    Computer-Aided Design 26(8), 1994",
        example: if S::DIM == 2 {
            "axis = \"y\"\n\
             target = { points = [[\"50%\", \"0%\"], [\"40%\", \"35%\"], [\"75%\", \"70%\"], [\"120%\", \"75%\"]] }\n"
        } else {
            "axis = \"y\"\n\
             target = { points = [[\"50%\", \"0%\", \"50%\"], [\"40%\", \"35%\", \"50%\"], [\"75%\", \"70%\", \"60%\"], [\"120%\", \"75%\", \"100%\"]] }\n"
        },
        schema: AxialParameters::json_schema,
        construct: construct::<S>,
    }
}
