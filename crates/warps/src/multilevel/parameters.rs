//! How recipes describe multilevel free-form deformations.
//!
//! *Source*: Lee, Wolberg and Shin 1997; Lee, Chwa and Shin 1995; the notation is that of the warp `points` (Milliron et al. 2002,
//! §3.2).

use super::{Hierarchy, Multilevel, MultilevelError};
use crate::features::parameters::{point_features, point_pairs};
use crate::lattices::{Corners, Fit, LatticeError};
use crate::radial::parameters::{LandmarkParameters, landmarks};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{Built, ConstructError, Context, Length, Value, WarpEntry, parse, schemars};
use anamorph_core::{Bounds, Space, Warp};
use anamorph_features::PointPair;
use serde::Deserialize;

/// Where nothing is said, the box is larger than model and points by this share of its diagonal on all sides.
const MARGIN: f64 = 0.1;
/// Where nothing is said, points may be missed by this share of the box's diagonal.
const TOLERANCE: f64 = 1e-6;

/// An upright box.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a box is \"fit\", or a table with `min` and `max`"
)]
#[schemars(inline)]
enum UprightBox {
    /// The bounds of the model and of the points.
    Named(Fit),
    /// A box between two corners.
    Corners(Corners),
}

/// What happens at the faces of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Faces {
    /// They move like all else, and what is outside stays.
    Free,
    /// They stay, and there is no crease between inside and outside.
    Still,
}

/// Lattices from coarse to fine carry source points to their targets.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MultilevelParameters {
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<LandmarkParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// The box that the lattices cover: "fit" (the bounds of the model and of the points, also if left out), or `{ min, max }`.
    #[serde(rename = "box")]
    bounds: Option<UprightBox>,
    /// Length by which the box is made larger on all sides; 10 % of its diagonal if left out.
    margin: Option<Length>,
    /// How many levels at most, 1 to 16; 8 if left out, 7 in space.
    levels: Option<usize>,
    /// How far points may be missed; a millionth of the box's diagonal if left out.
    tolerance: Option<Length>,
    /// Whether the faces of the box are "free" or "still"; free if left out.
    faces: Option<Faces>,
    /// Whether levels are composed of moves so short that no two places meet; `false` if left out.
    #[serde(default)]
    one_to_one: bool,
}

impl MultilevelParameters {
    fn bounds<S: Space>(
        &self,
        points: &[S],
        context: &Context<'_, S>,
    ) -> Result<Bounds<S>, ConstructError> {
        let bounds = match &self.bounds {
            Some(UprightBox::Corners(corners)) => corners.bounds(context)?,
            None | Some(UprightBox::Named(Fit::Fit)) => {
                let model = context.bounds("box")?;
                Bounds::of(points).map_or(model, |bounds| model.union(bounds))
            }
        };
        let margin = match self.margin {
            Some(length) => length.resolve("margin", context)?,
            None => MARGIN * bounds.diagonal(),
        };
        if !(margin >= 0.0 && margin.is_finite()) {
            let message = format!("the margin is {margin}");
            return Err(ConstructError::new("margin", message)
                .with_hint("write a length that is not negative"));
        }
        Ok(Bounds {
            min: bounds.min - S::splat(margin),
            max: bounds.max + S::splat(margin),
        })
    }
}

/// An error at its parameter; before the points of the list come `from_files` of files.
fn located(from_files: usize, error: &MultilevelError) -> ConstructError {
    let path = match error {
        MultilevelError::NotFinite { point }
        | MultilevelError::Coincident { second: point, .. }
        | MultilevelError::Outside { point, .. } => match point.checked_sub(from_files) {
            Some(number) => format!("point.{number}"),
            None => "source".to_owned(),
        },
        MultilevelError::NoPoint => "point".to_owned(),
        MultilevelError::Levels { .. } | MultilevelError::TooFine { .. } => "levels".to_owned(),
        MultilevelError::Tolerance { .. } => "tolerance".to_owned(),
        MultilevelError::Box(LatticeError::NotFinite { .. }) => "point".to_owned(),
        MultilevelError::Box(_) => "box".to_owned(),
    };
    let hint = match error {
        MultilevelError::NoPoint => {
            "add a table `[[warp.point]]` with `from` and `to`, or name files as `source` and `target`"
        }
        _ => "",
    };
    ConstructError::new(path, error.to_string()).with_hint(hint)
}

/// The registry entry.
pub(crate) fn multilevel<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: MultilevelParameters = parse(value)?;
        let files = (p.source.as_ref(), p.target.as_ref());
        let (pairs, from_files) = landmarks(files, &p.point, context)?;
        if p.one_to_one && p.faces == Some(Faces::Free) {
            let message = "with `one_to_one` the faces of the box stay";
            return Err(ConstructError::new("faces", message).with_hint("remove `faces`"));
        }
        let both = pairs.iter().flat_map(|pair| [pair.source, pair.target]);
        let bounds = p.bounds(&both.collect::<Vec<S>>(), context)?;
        let tolerance = match p.tolerance {
            Some(length) => length.resolve("tolerance", context)?,
            None => TOLERANCE * bounds.diagonal(),
        };
        let hierarchy = Hierarchy {
            levels: p.levels,
            tolerance,
            still_faces: p.faces == Some(Faces::Still),
            one_to_one: p.one_to_one,
        };
        let construct = move |pairs: Vec<PointPair<S>>| {
            Multilevel::construct(pairs, bounds, hierarchy)
                .map_err(|error| located(from_files, &error))
        };
        let with = move |sources: &[Vec<S>], targets: &[Vec<S>]| {
            let warp = construct(point_pairs(sources, targets))?;
            Ok(Box::new(warp) as Box<dyn Warp<S>>)
        };
        let features = point_features(pairs.iter(), Box::new(with));
        let warp = construct(pairs)?;
        Ok(Built::new(warp.marks(), Box::new(warp)).between(features))
    }
    WarpEntry {
        kind: "multilevel",
        system: "B8",
        figure: "",
        summary: "carries points to their targets by lattices from coarse to fine",
        reference: "S. Lee, G. Wolberg and S. Y. Shin, Scattered Data Interpolation with Multilevel B-Splines, IEEE TVCG 3(3), 1997",
        example: "point = [{ from = \"30%\", by = \"12%\" }, { from = \"75%\" }]\n",
        schema: MultilevelParameters::json_schema,
        construct: construct::<S>,
    }
}
