//! How recipes describe constraints of points.
//!
//! *Source*: Borrel and Rappoport 1994; the notation is that of the warp `points` (Milliron et al. 2002, §3.2).

use super::{Basis, Constraint, ScodefError, ScodefWarp};
use crate::features::parameters::{Files, point_features, point_pairs, target};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Built, ConstructError, Context, Length, Offset, Place, Value, WarpEntry, parse, schemars,
};
use anamorph_core::{Space, Warp};
use anamorph_features::PointPair;
use serde::Deserialize;

/// How far a point reaches.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a radius is a length, or one along each axis such as [\"30%\", \"10%\", \"30%\"] | write a positive length, or a list of \
                 as many as there are axes"
)]
#[schemars(inline)]
enum Extent {
    /// The same in all directions.
    One(Length),
    /// Along each axis; percentages are of the model's extent along it.
    Each(Offset),
}

/// The function about a point.
#[derive(Debug, Clone, Copy, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum BasisName {
    /// A cubic B-spline of the distance.
    #[default]
    BSpline,
    /// A product of cubic B-splines along the axes.
    Box,
}

/// One source point and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ConstraintParameters {
    /// The source point.
    from: Place,
    /// The target point.
    to: Option<Place>,
    /// The offset from source to target, instead of `to`. With neither the point is pinned.
    by: Option<Offset>,
    /// How far this point reaches; with the basis "box" also a list of one length for each axis.
    radius: Option<Extent>,
}

/// Constraint points come to their targets, each with a surrounding of its own.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ScodefParameters {
    /// The points; those of the files come before them.
    #[serde(default)]
    point: Vec<ConstraintParameters>,
    /// A file with source points, such as from `anamorph cage --points`.
    source: Option<String>,
    /// A file with their targets, one for each in the same order.
    target: Option<String>,
    /// How far points reach that say nothing themselves; with the basis "box" also a list of one length for each axis.
    radius: Option<Extent>,
    /// The function about each point, "b-spline" if left out: a cubic B-spline of the distance; "box": a product of one for each axis.
    basis: Option<BasisName>,
}

/// An error of a point of the list, before which come `from_files` points of files.
fn located(from_files: usize, error: &ScodefError) -> ConstructError {
    let path = match error {
        ScodefError::NotFinite { point }
        | ScodefError::Radius { point, .. }
        | ScodefError::Overflow { point }
        | ScodefError::Coincident { second: point, .. } => match point.checked_sub(from_files) {
            Some(number) => format!("point.{number}"),
            None => "source".to_owned(),
        },
        ScodefError::NoPoint | ScodefError::TooMany { .. } => "point".to_owned(),
    };
    let hint = match error {
        ScodefError::NoPoint => {
            "add a table `[[warp.point]]` with `from`, `to` and `radius`, or name files as `source` and `target`"
        }
        _ => "",
    };
    ConstructError::new(path, error.to_string()).with_hint(hint)
}

/// The function of a name and an extent; `path` is that of the extent.
fn basis<S: Space>(
    name: BasisName,
    extent: &Extent,
    path: &str,
    context: &Context<'_, S>,
) -> Result<Basis<S>, ConstructError> {
    let each = match (name, extent) {
        (BasisName::BSpline, Extent::One(length)) => {
            let radius = length.resolve_positive(path, context)?;
            return Ok(Basis::BSpline { radius });
        }
        (BasisName::Box, Extent::One(length)) => {
            let radii = S::splat(length.resolve_positive(path, context)?);
            return Ok(Basis::Box { radii });
        }
        (BasisName::BSpline, Extent::Each(_)) => {
            let message = "a B-spline of the distance has one radius, not one for each axis";
            return Err(ConstructError::new(path, message)
                .with_hint("write one length, or take `basis = \"box\"`"));
        }
        (BasisName::Box, Extent::Each(each)) => each,
    };
    let radii: S = each.resolve(path, context)?;
    for (axis, name) in ["x", "y", "z"].iter().enumerate().take(S::DIM) {
        let radius = radii.component(axis);
        if !(radius > 0.0 && radius.is_finite()) {
            let message =
                format!("the radius along {name} is {radius}, and must be greater than 0");
            return Err(ConstructError::new(path, message)
                .with_hint("write positive lengths; along an axis without extent in scene units"));
        }
    }
    Ok(Basis::Box { radii })
}

/// The constraints of the files and of the list, and how many are of the files.
fn constraints<S: Space>(
    p: &ScodefParameters,
    context: &Context<'_, S>,
) -> Result<(Vec<Constraint<S>>, usize), ConstructError> {
    let name = p.basis.unwrap_or_default();
    let of = |own: Option<&Extent>, path: &str| match (own, &p.radius) {
        (Some(extent), _) => basis(name, extent, &format!("{path}.radius"), context),
        (None, Some(extent)) => basis(name, extent, "radius", context),
        (None, None) => Err(
            ConstructError::new(path, "a point has no `radius`").with_hint(
                "write how far it reaches, such as `radius = \"30%\"`, beside the point or for all",
            ),
        ),
    };
    let files = Files::load(p.source.as_ref(), p.target.as_ref(), context)?;
    let mut list = Vec::new();
    if let Some((sources, targets)) = files.points("points")? {
        let basis = of(None, "source")?;
        let both = sources.into_iter().zip(targets);
        list.extend(both.map(|(source, target)| Constraint {
            pair: PointPair { source, target },
            basis,
        }));
    }
    let from_files = list.len();
    for (i, point) in p.point.iter().enumerate() {
        let path = format!("point.{i}");
        let source: S = point.from.resolve(&format!("{path}.from"), context)?;
        let target = target(&path, source, point.to.as_ref(), point.by.as_ref(), context)?;
        list.push(Constraint {
            pair: PointPair { source, target },
            basis: of(point.radius.as_ref(), &path)?,
        });
    }
    Ok((list, from_files))
}

/// The registry entry of simple constrained deformations.
pub(crate) fn scodef<S: Space>() -> WarpEntry<S> {
    fn construct<S: Space>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: ScodefParameters = parse(value)?;
        let (list, from_files) = constraints(&p, context)?;
        let warp = ScodefWarp::construct(list).map_err(|error| located(from_files, &error))?;
        let bases: Vec<Basis<S>> = warp.constraints().iter().map(|c| c.basis).collect();
        let with = move |sources: &[Vec<S>], targets: &[Vec<S>]| {
            let pairs = point_pairs(sources, targets).into_iter().zip(&bases);
            let list = pairs.map(|(pair, &basis)| Constraint { pair, basis });
            let warp = ScodefWarp::construct(list.collect())
                .map_err(|error| located(from_files, &error))?;
            Ok(Box::new(warp) as Box<dyn Warp<S>>)
        };
        let pairs = warp.constraints().iter().map(|constraint| &constraint.pair);
        let features = point_features(pairs, Box::new(with));
        Ok(Built::new(warp.marks(), Box::new(warp)).between(features))
    }
    WarpEntry {
        kind: "scodef",
        system: "B19",
        figure: "",
        summary: "carries points to their targets, and each only what is within its own radius",
        reference: "P. Borrel and A. Rappoport, Simple Constrained Deformations for Geometric Modeling and Interactive Design, ACM \
                    TOG 13(2), 1994",
        example: "radius = \"45%\"\npoint = [{ from = \"35%\", by = \"15%\" }, { from = \"65%\", radius = \"30%\" }]\n",
        schema: ScodefParameters::json_schema,
        construct: construct::<S>,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_catalog::serde_json::json;
    use anamorph_core::{Bounds, Deformation, Site, Solid, glam::dvec3};

    fn build(value: &Value) -> Result<Built<Solid>, ConstructError> {
        let bounds = Some(Bounds::new(Solid::ZERO, dvec3(10.0, 20.0, 40.0)));
        let context = Context {
            bounds,
            ..Context::default()
        };
        (scodef().construct)(value, &context)
    }

    #[test]
    fn a_list_of_radii_is_of_the_extents_and_a_length_of_the_diagonal() {
        let at = |built: &Built<Solid>, p: Solid| built.warp.map(&Site::anywhere(p)) - p;
        let point = json!([{ "from": "50%", "by": ["10%", 0, 0] }]);
        let own = json!({ "basis": "box", "radius": ["40%", "40%", 3], "point": point });
        let built = build(&own).ok().unwrap();
        let middle = dvec3(5.0, 10.0, 20.0);
        for (axis, radius) in [(0, 4.0), (1, 8.0), (2, 3.0)] {
            let along = Solid::unit(axis) * radius;
            assert_eq!(at(&built, middle + along), Solid::ZERO);
            let half = at(&built, middle + along * 0.5);
            assert!((half - Solid::X * 0.25).length() < 1e-14);
        }
        let built = build(&json!({ "radius": "20%", "point": point }))
            .ok()
            .unwrap();
        let radius = 0.2 * 2100.0_f64.sqrt();
        let half = at(&built, middle + Solid::Y * (0.5 * radius));
        assert!((half - Solid::X * 0.25).length() < 1e-12);
    }

    #[test]
    fn it_is_built_again_between_other_points_with_the_same_radii() {
        let value = json!({ "radius": 6, "point": [
            { "from": [1, 1, 1], "by": [1, 0, 0] }, { "from": [4, 1, 1], "radius": 2 },
        ] });
        let features = build(&value).ok().unwrap().features.unwrap();
        assert_eq!(features.sources.len(), 2);
        let (from, to) = (dvec3(2.0, 1.0, 1.0), dvec3(2.0, 3.0, 1.0));
        let still = dvec3(9.0, 1.0, 1.0);
        let between = (features.with)(&[vec![from], vec![still]], &[vec![to], vec![still]]);
        let between = between.ok().unwrap();
        let at = |p: Solid| between.map(&Site::anywhere(p)) - p;
        assert!((at(from) - (to - from)).length() < 1e-14);
        // Six from the first and two from the second: in reach of neither.
        assert_eq!(at(dvec3(9.0, 3.5, 1.0)), Solid::ZERO);
        assert!(at(dvec3(7.5, 1.0, 1.0)).length() > 0.0);
    }

    #[test]
    fn errors_say_where_they_are() {
        let rows = [
            (json!({ "radius": 1 }), "point", "no point"),
            (
                json!({ "point": [{ "from": "1%" }] }),
                "point.0",
                "no `radius`",
            ),
            (
                json!({ "point": [{ "from": "1%", "radius": 0 }] }),
                "point.0.radius",
                "greater than 0",
            ),
            (
                json!({ "radius": [1, 2, 3], "point": [{ "from": "1%" }] }),
                "radius",
                "one radius",
            ),
            (
                json!({ "basis": "box", "radius": [1, 2], "point": [{ "from": "1%" }] }),
                "radius",
                "[x, y, z]",
            ),
            (
                json!({ "basis": "box", "point": [{ "from": "1%", "radius": [1, -2, 3] }] }),
                "point.0.radius",
                "along y is -2",
            ),
            (
                json!({ "radius": true, "point": [{ "from": "1%" }] }),
                "radius",
                "a radius is a length",
            ),
            (
                json!({ "basis": "spline", "radius": 1, "point": [{ "from": "1%" }] }),
                "basis",
                "b-spline",
            ),
            (
                json!({ "radius": 1, "point": [{ "from": "1%" }, { "from": "2%" }, { "from": "1%", "by": "3%" }] }),
                "point.2",
                "points 0 and 2",
            ),
        ];
        for (value, path, words) in rows {
            let error = build(&value).err().unwrap();
            assert_eq!(error.path, path, "{error}");
            assert!(error.to_string().contains(words), "{error}");
        }
    }
}
