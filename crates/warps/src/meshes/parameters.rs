//! How recipes describe coarse meshes.
//!
//! *Source*: Milliron et al. 2002, §6; the notation is a decision.

use super::{MeshError, MeshWarp, Reaches, Uncovered};
use crate::cages::load;
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Built, ConstructError, Context, Offset, Place, Value, WarpEntry, parse, schemars,
};
use anamorph_core::Space;
use anamorph_transforms::Rotational;
use serde::Deserialize;

/// One vertex and where it goes.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MoveParameters {
    /// Number of the vertex, from 0.
    index: usize,
    /// Where it goes.
    to: Option<Place>,
    /// How far it goes, instead of `to`; added to what the target says.
    by: Option<Offset>,
}

/// What becomes of points that no vertex reaches.
#[derive(Deserialize, JsonSchema, Default, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum UncoveredName {
    /// They stay.
    #[default]
    Stay,
    /// They go with the nearest vertex.
    Nearest,
}

/// The vertices of a coarse mesh carry the model with them.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct MeshParameters {
    /// A file with the coarse mesh, such as from `anamorph cage --mesh`; its faces and wires are the edges.
    source: Option<String>,
    /// The same mesh with its vertices moved.
    target: Option<String>,
    /// The vertices, instead of a file.
    #[serde(default)]
    points: Vec<Place>,
    /// Which vertices are joined, by their numbers from 0.
    #[serde(default)]
    edges: Vec<[u32; 2]>,
    /// Edits of single vertices.
    #[serde(default, rename = "move")]
    moves: Vec<MoveParameters>,
    /// Up to this share of a vertex's longest edge the distance from it does not count; 0.1 if left out.
    alpha: Option<f64>,
    /// At this share of a vertex's longest edge its weight ends; 1 if left out.
    beta: Option<f64>,
    /// Up to this share along an edge the edge does not count; 0.1 if left out.
    gamma: Option<f64>,
    /// At this share along an edge the weight ends; 1 if left out.
    mu: Option<f64>,
    /// What becomes of points that no vertex reaches.
    #[serde(default)]
    uncovered: UncoveredName,
}

/// Source vertices, target vertices, edges.
type Coarse<S> = (Vec<S>, Vec<S>, Vec<[u32; 2]>);

/// The coarse mesh of files.
fn from_files<S: Space>(
    p: &MeshParameters,
    context: &Context<'_, S>,
) -> Result<Option<Coarse<S>>, ConstructError> {
    let Some(source) = load("source", p.source.as_ref(), context)? else {
        return match &p.target {
            None => Ok(None),
            Some(_) => Err(ConstructError::new(
                "target",
                "there is a `target` file and no `source`",
            )
            .with_hint("name the mesh as it was as `source`")),
        };
    };
    if !(p.points.is_empty() && p.edges.is_empty()) {
        let at = if p.points.is_empty() {
            "edges"
        } else {
            "points"
        };
        return Err(ConstructError::new(at, "the mesh comes from a file")
            .with_hint("leave out `points` and `edges`, or `source`"));
    }
    let targets = match load("target", p.target.as_ref(), context)? {
        Some(target) => {
            let places = target.one_for_each(&source)?;
            target.expect_faces_of(&source)?;
            places
        }
        None => source.points.clone(),
    };
    let edges = source.edges();
    Ok(Some((source.points, targets, edges)))
}

/// The registry entry of the mesh warp.
pub(crate) fn mesh<S: Rotational>() -> WarpEntry<S> {
    fn construct<S: Rotational>(
        value: &Value,
        context: &Context<'_, S>,
    ) -> Result<Built<S>, ConstructError> {
        let p: MeshParameters = parse(value)?;
        let (source, mut target, edges) = match from_files(&p, context)? {
            Some(coarse) => coarse,
            None => {
                let each = p.points.iter().enumerate();
                let source: Vec<S> = each
                    .map(|(i, point)| point.resolve(&format!("points.{i}"), context))
                    .collect::<Result<_, _>>()?;
                if source.is_empty() {
                    return Err(ConstructError::new("points", "there is no coarse mesh")
                        .with_hint(
                            "name files as `source` and `target`, or write `points` and `edges`",
                        ));
                }
                (source.clone(), source, p.edges.clone())
            }
        };
        for (i, edit) in p.moves.iter().enumerate() {
            let path = format!("move.{i}");
            let count = target.len();
            let Some(place) = target.get_mut(edit.index) else {
                let message = format!(
                    "there is no vertex {}; the vertices are 0 to {}",
                    edit.index,
                    count.saturating_sub(1)
                );
                return Err(ConstructError::new(format!("{path}.index"), message));
            };
            match (&edit.to, &edit.by) {
                (Some(_), Some(_)) => {
                    return Err(
                        ConstructError::new(path, "`to` and `by` say different things")
                            .with_hint("keep one of them"),
                    );
                }
                (Some(to), None) => *place = to.resolve(&format!("{path}.to"), context)?,
                (None, Some(by)) => *place += by.resolve(&format!("{path}.by"), context)?,
                (None, None) => {
                    return Err(ConstructError::new(path, "the edit does not say where to")
                        .with_hint("write `to` (a place) or `by` (a displacement)"));
                }
            }
        }
        let usual = Reaches::default();
        let reaches = Reaches {
            alpha: p.alpha.unwrap_or(usual.alpha),
            beta: p.beta.unwrap_or(usual.beta),
            gamma: p.gamma.unwrap_or(usual.gamma),
            mu: p.mu.unwrap_or(usual.mu),
        };
        let uncovered = match p.uncovered {
            UncoveredName::Stay => Uncovered::Stay,
            UncoveredName::Nearest => Uncovered::Nearest,
        };
        let inline = p.source.is_none();
        let warp =
            MeshWarp::construct(&source, &target, &edges, reaches, uncovered).map_err(|error| {
                let path = match &error {
                    MeshError::Number { name, .. } => (*name).to_owned(),
                    MeshError::NotFinite { vertex } if inline => format!("points.{vertex}"),
                    MeshError::Edge { .. } | MeshError::Empty if inline => "edges".to_owned(),
                    _ if inline => "points".to_owned(),
                    _ => "source".to_owned(),
                };
                ConstructError::new(path, error.to_string())
            })?;
        Ok(Built::new(warp.marks(), Box::new(warp)))
    }
    WarpEntry {
        kind: "mesh",
        system: "B17",
        figure: "§6, Figs. 17–18",
        summary: "carries a model along with the edited vertices of a coarse mesh",
        reference: "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG \
                    21(1), 2002, §6",
        example: if S::DIM == 2 {
            "points = [[\"0%\", \"0%\"], [\"100%\", \"0%\"], [\"100%\", \"100%\"], [\"0%\", \"100%\"]]\n\
             edges = [[0, 1], [1, 2], [2, 3], [3, 0]]\n\
             move = [{ index = 2, by = [\"25%\", \"20%\"] }]\n"
        } else {
            "points = [[\"0%\", \"0%\", \"0%\"], [\"100%\", \"0%\", \"0%\"], [\"0%\", \"100%\", \"0%\"], [\"100%\", \"100%\", \"0%\"], \
             [\"0%\", \"0%\", \"100%\"], [\"100%\", \"0%\", \"100%\"], [\"0%\", \"100%\", \"100%\"], [\"100%\", \"100%\", \"100%\"]]\n\
             edges = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]]\n\
             move = [{ index = 7, by = [\"20%\", \"25%\", \"10%\"] }]\n"
        },
        schema: MeshParameters::json_schema,
        construct: construct::<S>,
    }
}
