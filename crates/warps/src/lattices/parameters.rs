//! How recipes describe lattices and edits of their control points.
//!
//! *Source*: Milliron et al. 2002, §4.1 and §5.1; the notation is a decision.

use super::bernstein::BernsteinLattice;
use super::bspline::{BsplineLattice, Knots};
use super::frames::FrameLattice;
use super::placement::{BoxParameters, Placed, Placement, frame_maps, located};
use super::{Grid, LatticeError, PointLattice};
use crate::cages::{CageKind, load};
use crate::features::turn_and_scale;
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Angle, Axis, Built, ConstructError, Context, Length, Offset, Place, Value, WarpEntry, parse,
    schemars,
};
use anamorph_core::{Affine, Scaling, Space, Transformation};
use anamorph_transforms::{Composed, Rotational};
use serde::Deserialize;

/// Which control points along one axis.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "an index is a whole number (negative counts from the end), \"*\", or a list of numbers"
)]
#[schemars(inline)]
enum Selector {
    /// One index from 0; negative counts from the end, −1 is the last.
    One(i64),
    /// Several indices.
    Some(Vec<i64>),
    /// `"*"`: all.
    All(Star),
}

#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[schemars(inline)]
enum Star {
    /// All indices.
    #[serde(rename = "*")]
    Star,
}

/// One edit of control points.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MoveParameters {
    /// Index of the control point along each axis: a number from 0 (negative counts from the end), a list, or "*".
    index: Vec<Selector>,
    /// Offset by which the points move, after turning and scaling.
    by: Option<Offset>,
    /// Place to which a single point moves, instead of `by`.
    to: Option<Place>,
    /// Angle by which the points turn, about `axis` in space.
    turn: Option<Angle>,
    /// Axis of the turn, in space.
    axis: Option<Axis>,
    /// Factor by which the points draw apart (above 1) or together.
    scale: Option<f64>,
    /// Fixed point of turn and scale; the middle of the chosen points if left out.
    about: Option<Place>,
}

/// Flat indices chosen by selectors.
fn choose<S: Space>(
    path: &str,
    grid: &Grid<S>,
    index: &[Selector],
) -> Result<Vec<usize>, ConstructError> {
    if index.len() != S::DIM {
        let message = format!(
            "{} indices where the lattice has {} axes",
            index.len(),
            S::DIM
        );
        return Err(ConstructError::new(path, message).with_hint("write one index per axis"));
    }
    let mut axes: [Vec<usize>; 3] = [vec![0], vec![0], vec![0]];
    for (axis, selector) in index.iter().enumerate() {
        let count = grid.shape()[axis];
        let resolve = |i: i64| {
            let signed = i64::try_from(count).unwrap_or(i64::MAX);
            let from_start = if i < 0 { i + signed } else { i };
            usize::try_from(from_start)
                .ok()
                .filter(|&i| i < count)
                .ok_or_else(|| {
                    let message = {
                        let axis = ["x", "y", "z"].get(axis).copied().unwrap_or("?");
                        format!("there is no control point {i} along {axis}: it has {count}")
                    };
                    ConstructError::new(format!("{path}.{axis}"), message).with_hint(format!(
                        "indices run from 0 to {}, or from -1 backwards",
                        count - 1
                    ))
                })
        };
        axes[axis] = match selector {
            Selector::One(i) => vec![resolve(*i)?],
            Selector::Some(list) => list.iter().map(|&i| resolve(i)).collect::<Result<_, _>>()?,
            Selector::All(Star::Star) => (0..count).collect(),
        };
    }
    let mut chosen = Vec::new();
    for &i in &axes[0] {
        for &j in &axes[1] {
            chosen.extend(axes[2].iter().map(|&k| grid.flat([i, j, k])));
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

/// Applies the edits in order to the points of a lattice, which start from where a cage has them.
pub(crate) fn edit<S: Space>(
    grid: &Grid<S>,
    rest: &[S],
    target: Option<Vec<S>>,
    moves: &[MoveParameters],
    context: &Context<'_, S>,
) -> Result<Vec<S>, ConstructError> {
    let mut points = target.unwrap_or_else(|| rest.to_vec());
    for (number, edit) in moves.iter().enumerate() {
        let path = format!("move.{number}");
        let chosen = choose(&format!("{path}.index"), grid, &edit.index)?;
        if let Some(to) = &edit.to {
            if edit.by.is_some() || edit.turn.is_some() || edit.scale.is_some() {
                return Err(
                    ConstructError::new(format!("{path}.to"), "`to` stands alone")
                        .with_hint("remove `by`, `turn` and `scale`, or use them instead"),
                );
            }
            let [one] = chosen.as_slice() else {
                let message = format!(
                    "`to` would put {} control points in one place",
                    chosen.len()
                );
                return Err(ConstructError::new(format!("{path}.to"), message)
                    .with_hint("use `by` for several points"));
            };
            points[*one] = to.resolve(&format!("{path}.to"), context)?;
            continue;
        }
        if edit.by.is_none() && edit.turn.is_none() && edit.scale.is_none() {
            return Err(ConstructError::new(path, "the edit says nothing")
                .with_hint("give it `by`, `to`, `turn` or `scale`"));
        }
        let by = match &edit.by {
            Some(by) => by.resolve(&format!("{path}.by"), context)?,
            None => S::ZERO,
        };
        let linear = turn_and_scale::<S>(&path, edit.turn, edit.axis.as_ref(), edit.scale)?;
        let about = match &edit.about {
            Some(place) => place.resolve(&format!("{path}.about"), context)?,
            None => {
                let sum = chosen.iter().fold(S::ZERO, |sum, &i| sum + points[i]);
                #[allow(clippy::cast_precision_loss)]
                let count = chosen.len().max(1) as f64;
                sum / count
            }
        };
        let affine = Affine::about(about, linear, by);
        for &i in &chosen {
            // As a displacement, so that points the edit does not move stay exactly.
            let displacement = affine.displacement(points[i]);
            points[i] += displacement;
        }
    }
    Ok(points)
}

/// A lattice of control points from its cage and the edits of its points.
fn displaced<S: Space, L: PointLattice<S> + 'static>(
    placement: &Placement<'_, S>,
    kind: CageKind,
    moves: &[MoveParameters],
    context: &Context<'_, S>,
    construct: impl Fn(Grid<S>, Vec<S>) -> Result<L, LatticeError> + 'static,
) -> Result<Built<S>, ConstructError> {
    let Placed { grid, rest, target } = placement.place(kind, context)?;
    let targets = edit(&grid, &rest, target, moves, context)?;
    let displacements: Vec<S> = targets
        .iter()
        .zip(&rest)
        .map(|(&target, &rest)| target - rest)
        .collect();
    let built = move |changes: &[S]| {
        let moved = displacements.iter().zip(changes).map(|(&d, &c)| d + c);
        let warp = construct(grid.clone(), moved.collect()).map_err(|error| located(&error))?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    };
    let unchanged = vec![S::ZERO; rest.len()];
    Ok(built(&unchanged)?.fitted_by(rest.len(), built))
}

/// A box of control points; moving them moves the model inside by Bernstein polynomials.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct LatticeParameters {
    /// Number of control points along each axis, 2 to 32; `source` says it, too.
    shape: Option<Vec<usize>>,
    /// A file with the cage as it was, from `anamorph cage`: it says the shape and the box.
    source: Option<String>,
    /// A file with the cage as it was edited.
    target: Option<String>,
    /// The box where no `source` says it: "fit" (the model's bounds, also if left out), `{ min, max }`, or
    /// `{ origin, edges }`.
    #[serde(rename = "box")]
    bounds: Option<BoxParameters>,
    /// Length by which an upright box is made larger on all sides.
    margin: Option<Length>,
    /// Edits of control points, applied in order, after those of `target`.
    #[serde(default, rename = "move")]
    moves: Vec<MoveParameters>,
}

/// The registry entry of the Bernstein lattice.
pub(crate) fn lattice<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: LatticeParameters = parse(value)?;
        let placement = Placement {
            shape: p.shape.as_deref(),
            bounds: p.bounds.as_ref(),
            margin: p.margin,
            source: load("source", p.source.as_ref(), context)?,
            target: load("target", p.target.as_ref(), context)?,
        };
        let construct = BernsteinLattice::construct;
        displaced(&placement, CageKind::Lattice, &p.moves, context, construct)
    }
    WarpEntry {
        kind: "lattice",
        system: "B3",
        figure: "§4.1, Fig. 10",
        summary: "free-form deformation: a box of control points moves the model inside",
        reference: "T. W. Sederberg and S. R. Parry, Free-Form Deformation of Solid Geometric Models, SIGGRAPH 1986",
        example: if S::DIM == 2 {
            "shape = [4, 4]\nmove = [{ index = [\"*\", -1], by = [\"25%\", 0] }]\n"
        } else {
            "shape = [4, 4, 4]\nmove = [{ index = [\"*\", -1, \"*\"], by = [\"25%\", 0, 0] }]\n"
        },
        schema: LatticeParameters::json_schema,
        construct: construct::<S>,
    }
}

/// How knots are spread.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum KnotsParameter {
    /// Equally spaced; the outer control points lie outside the box. So it is if nothing is said.
    Uniform,
    /// Repeated at the faces; the outer control points lie on the faces.
    Clamped,
}

/// A box of control points with local control: each moves only what is near, by B-splines.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct SplineLatticeParameters {
    /// Number of control points along each axis, at least `degree` + 1; `source` says it, too.
    shape: Option<Vec<usize>>,
    /// A file with the cage as it was, from `anamorph cage`: it says the shape and the box.
    source: Option<String>,
    /// A file with the cage as it was edited.
    target: Option<String>,
    /// Degree of the splines, 1 to 5; 3 if left out.
    degree: Option<usize>,
    /// How knots are spread; control points stand at the Greville abscissae.
    knots: Option<KnotsParameter>,
    /// The box where no `source` says it: "fit" (the model's bounds, also if left out), `{ min, max }`, or
    /// `{ origin, edges }`.
    #[serde(rename = "box")]
    bounds: Option<BoxParameters>,
    /// Length by which an upright box is made larger on all sides.
    margin: Option<Length>,
    /// Edits of control points, applied in order, after those of `target`.
    #[serde(default, rename = "move")]
    moves: Vec<MoveParameters>,
}

/// The registry entry of the B-spline lattice.
pub(crate) fn spline_lattice<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: SplineLatticeParameters = parse(value)?;
        let placement = Placement {
            shape: p.shape.as_deref(),
            bounds: p.bounds.as_ref(),
            margin: p.margin,
            source: load("source", p.source.as_ref(), context)?,
            target: load("target", p.target.as_ref(), context)?,
        };
        let said = placement.said();
        let own = p.knots.map(|knots| match knots {
            KnotsParameter::Uniform => Knots::Uniform,
            KnotsParameter::Clamped => Knots::Clamped,
        });
        for (key, differs) in [
            (
                "degree",
                p.degree
                    .is_some_and(|own| said.degree.is_some_and(|said| said != own)),
            ),
            (
                "knots",
                own.is_some_and(|own| said.knots.is_some_and(|said| said != own)),
            ),
        ] {
            if differs {
                let message = format!("the cage was made for another `{key}`");
                return Err(ConstructError::new(key, message)
                    .with_hint("remove it here, or make the cage again"));
            }
        }
        let degree = p.degree.or(said.degree).unwrap_or(3);
        let knots = own.or(said.knots).unwrap_or(Knots::Uniform);
        let kind = CageKind::Spline(degree, knots);
        displaced(
            &placement,
            kind,
            &p.moves,
            context,
            move |grid, displacements| {
                BsplineLattice::construct(grid, degree, knots, displacements)
            },
        )
    }
    WarpEntry {
        kind: "spline-lattice",
        system: "B4",
        figure: "§4.1",
        summary: "free-form deformation with local control: each control point moves only what is near",
        reference: "J. Griessmair and W. Purgathofer, Deformation of Solids with Trivariate B-Splines, Eurographics 1989",
        example: if S::DIM == 2 {
            "shape = [6, 6]\nmove = [{ index = [3, 3], by = [\"25%\", \"15%\"] }]\n"
        } else {
            "shape = [6, 6, 6]\nmove = [{ index = [[2, 3], -2, [2, 3]], by = [0, \"45%\", 0] }]\n"
        },
        schema: SplineLatticeParameters::json_schema,
        construct: construct::<S>,
    }
}

/// What happens to chosen control frames.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrameEdit {
    /// Index of the control frame along each axis: a number from 0 (negative counts from the end), a list, or "*".
    index: Vec<Selector>,
    /// Offset of the frame's origin.
    by: Option<Offset>,
    /// Angle by which the frame turns about its origin, about `axis` in space.
    turn: Option<Angle>,
    /// Axis of the turn, in space.
    axis: Option<Axis>,
    /// Factor of the frame's basis vectors.
    scale: Option<f64>,
}

/// A box of control frames; turning or scaling one turns or scales the model about it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FrameLatticeParameters {
    /// Number of control frames along each axis, 2 to 32; `source` says it, too.
    shape: Option<Vec<usize>>,
    /// A file with the frames as they were, from `anamorph cage --frames`: it says the shape and the box.
    source: Option<String>,
    /// A file with the frames as they were turned, scaled and moved.
    target: Option<String>,
    /// The box where no `source` says it: "fit" (the model's bounds, also if left out), `{ min, max }`, or
    /// `{ origin, edges }`.
    #[serde(rename = "box")]
    bounds: Option<BoxParameters>,
    /// Length by which an upright box is made larger on all sides.
    margin: Option<Length>,
    /// Edits of control frames, after those of `target`; a later edit of the same frame comes after the earlier ones.
    #[serde(default)]
    frame: Vec<FrameEdit>,
}

/// The registry entry of the lattice of frames.
pub(crate) fn frame_lattice<S: Rotational>() -> WarpEntry<S> {
    fn construct<S: Rotational>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: FrameLatticeParameters = parse(value)?;
        let placement = Placement {
            shape: p.shape.as_deref(),
            bounds: p.bounds.as_ref(),
            margin: p.margin,
            source: load("source", p.source.as_ref(), context)?,
            target: load("target", p.target.as_ref(), context)?,
        };
        let Placed { grid, rest, target } = placement.place(CageKind::Frames, context)?;
        let still: Vec<S> = rest.iter().step_by(S::DIM + 1).copied().collect();
        let mut affines = match target {
            Some(target) => frame_maps(&rest, &target)?,
            None => vec![Affine::IDENTITY; grid.len()],
        };
        for (number, edit) in p.frame.iter().enumerate() {
            let path = format!("frame.{number}");
            let chosen = choose(&format!("{path}.index"), &grid, &edit.index)?;
            if edit.by.is_none() && edit.turn.is_none() && edit.scale.is_none() {
                return Err(ConstructError::new(path, "the edit says nothing")
                    .with_hint("give it `by`, `turn` or `scale`"));
            }
            let by = match &edit.by {
                Some(by) => by.resolve(&format!("{path}.by"), context)?,
                None => S::ZERO,
            };
            let linear = turn_and_scale::<S>(&path, edit.turn, edit.axis.as_ref(), edit.scale)?;
            for flat in chosen {
                let centre = affines[flat].apply(still[flat]);
                affines[flat] = Affine::about(centre, linear, by).after(&affines[flat]);
            }
        }
        let scaling = context.scaling.unwrap_or(Scaling::Composition);
        let mut transformations: Vec<Box<dyn Transformation<S>>> = Vec::new();
        for (flat, affine) in affines.iter().enumerate() {
            transformations.push(match scaling {
                Scaling::Displacement => Box::new(*affine),
                Scaling::Composition => {
                    let composed = Composed::new(*affine, still[flat]);
                    Box::new(
                        composed
                            .map_err(|error| ConstructError::new("frame", error.to_string()))?,
                    )
                }
            });
        }
        let warp = FrameLattice::construct(grid, transformations).map_err(|error| match error {
            LatticeError::NotFinite { .. } => ConstructError::new("frame", error.to_string()),
            error => located(&error),
        })?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "frame-lattice",
        system: "B9",
        figure: "§5.1, Fig. 14",
        summary: "free-form deformation by frames: turning one turns the model about it",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §5.1",
        example: if S::DIM == 2 {
            "shape = [3, 3]\nframe = [{ index = [1, 1], turn = \"70deg\" }]\n"
        } else {
            "shape = [3, 3, 3]\nframe = [{ index = [1, 1, 1], turn = \"70deg\", axis = \"y\" }]\n"
        },
        schema: FrameLatticeParameters::json_schema,
        construct: construct::<S>,
    }
}
