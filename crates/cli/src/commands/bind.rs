//! `anamorph bind`: the fields of a recipe, evaluated once on a model and kept; and what `warp --binding` makes of them.

use crate::arguments::BindOptions;
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::meshes::RecipeFiles;
use crate::model::{self, ModelSpace};
use anamorph_core::{
    Average, Binding, Bound, Deformation, Fingerprint, Masked, Plane, Site, Solid, Stack,
    map_all_parallel,
};
use anamorph_fields::Attribute;
use anamorph_io::bindings::{BindingFile, BoundWarp};
use anamorph_io::{Document, Points, ReadOptions};
use anamorph_recipe::{BuiltPart, BuiltRecipe, Recipe};
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// Points bound by a task.
const RUN: usize = 16_384;

pub(crate) fn run(options: &BindOptions) -> Result<(), Failure> {
    files::at_most_one_stream([&options.model, &options.recipe])?;
    files::refuse_existing(&options.output, options.force)?;
    let known = |path: &Path| (!files::is_stream(path)).then(|| files::identity(path));
    let output = known(&options.output);
    if output.is_some()
        && [&options.model, &options.recipe]
            .iter()
            .any(|p| known(p) == output)
    {
        return Err(Failure::usage(format!(
            "{}: the binding would replace what it is made from; choose another name",
            options.output.display()
        )));
    }
    let recipe = model::read_recipe(&options.recipe, &options.set)?;
    if recipe.is_inverse() {
        return Err(Failure::usage(
            "a binding keeps the fields of warps as they are; leave out `mapping = \"inverse\"`",
        ));
    }
    let read_options = ReadOptions::default().local(recipe.is_local());
    let document = model::read(&options.model, &read_options, options.allow_outside)?;
    match document.points() {
        Points::Plane(_) => bind::<Plane>(options, &recipe, document.as_ref()),
        Points::Solid(_) => bind::<Solid>(options, &recipe, document.as_ref()),
    }
}

fn bind<S: ModelSpace>(
    options: &BindOptions,
    recipe: &Recipe,
    document: &dyn Document,
) -> Result<(), Failure> {
    let rest = S::points(document.points()).unwrap_or_default();
    let beside = RecipeFiles::beside(&options.recipe, options.allow_outside);
    let built: BuiltRecipe<S> = model::build(recipe, document, rest, &beside)?;
    let name = files::shown(&options.model);
    if built.parts.is_empty() {
        return Err(Failure::new(format!(
            "{}: the recipe has no warp to bind",
            files::shown(&options.recipe)
        )));
    }
    if !options.quiet {
        #[allow(clippy::cast_precision_loss)]
        let (each, count) = (
            built
                .parts
                .iter()
                .map(|part| Binding::bytes_per_point(&part.warp, rest))
                .sum::<f64>(),
            rest.len() as f64,
        );
        say!(
            "{name}: about {each:.0} bytes a point, {:.1} MB for {} points",
            each * count * 1e-6,
            rest.len()
        );
    }
    let mut here = rest.to_vec();
    let mut direct = rest.to_vec();
    let mut warps = Vec::new();
    for part in &built.parts {
        let bound = BoundWarp {
            kind: part.kind.to_owned(),
            structure: part.structure,
            binding: bound_part(part, &here, options.drop_below),
            mask: part
                .mask
                .as_ref()
                .filter(|m| m.constant().is_none())
                .map(|mask| {
                    let sites = here.iter().enumerate();
                    sites.map(|(i, &p)| mask.value(&Site::new(i, p))).collect()
                }),
        };
        let stage = stage(part, &bound)?;
        let _ = map_all_parallel(&stage, &mut here, &|_| {});
        if options.drop_below > 0.0 {
            let _ = map_all_parallel(&part.deformation, &mut direct, &|_| {});
        }
        warps.push(bound);
    }
    let dropped = if options.drop_below > 0.0 {
        let apart = direct.iter().zip(&here).map(|(a, b)| a.distance(*b));
        apart.filter(|d| d.is_finite()).fold(0.0, f64::max)
    } else {
        0.0
    };
    let influences: usize = warps.iter().map(|w| w.binding.influence_count()).sum();
    let file = BindingFile {
        model: options
            .model
            .file_name()
            .map_or_else(|| name.clone(), |n| n.to_string_lossy().into_owned()),
        points: rest.len(),
        fingerprint: Fingerprint::of(rest),
        dimension: S::DIM,
        drop_below: options.drop_below,
        dropped,
        warps,
    };
    let mut pending = Pending::create(&options.output, options.force)?;
    pending.fill(|out| file.write(out))?;
    files::keep_all([pending])?;
    if !options.quiet {
        say!(
            "{name} -> {}: {influences} influences of {} points",
            files::shown_output(&options.output),
            rest.len()
        );
        if built.parts.len() > 1 {
            say!(
                "  note: warps after the first are bound to the model as it arrives there now; other targets of an earlier one do not \
                 move what the later ones were bound to"
            );
        }
        let whole: usize = if options.drop_below > 0.0 {
            let parts = built.parts.iter();
            parts.map(|part| undroppable(part)).map(usize::from).sum()
        } else {
            0
        };
        if whole == built.parts.len() {
            say!(
                "  note: nothing is dropped: the weights of {} follow targets, or are sums without an average",
                if whole == 1 {
                    "this warp"
                } else {
                    "these warps"
                }
            );
        } else if options.drop_below > 0.0 {
            say!(
                "  influences below {} of a point's weight are dropped: points move by up to {} otherwise",
                files::short(options.drop_below),
                files::short(dropped)
            );
        }
    }
    Ok(())
}

/// The influences of a part on points as they arrive there, in order, on all threads.
fn bound_part<S: ModelSpace>(part: &BuiltPart<S>, points: &[S], share: f64) -> Binding {
    let runs: Vec<Binding> = points
        .par_chunks(RUN)
        .enumerate()
        .map(|(number, run)| {
            let all = Binding::of_run(&part.warp, number * RUN, run);
            if share > 0.0 {
                all.without_shares_below(&part.warp, share)
            } else {
                all
            }
        })
        .collect();
    let mut whole = Binding::default();
    runs.iter().for_each(|run| whole.append(run));
    whole
}

/// A bound part with its mask: what moves points.
fn stage<S: ModelSpace>(
    part: &BuiltPart<S>,
    bound: &BoundWarp,
) -> Result<Box<dyn Deformation<S>>, Failure> {
    let warp = Box::new(Bound::new(Arc::clone(&part.warp), bound.binding.clone()));
    Ok(match (&bound.mask, &part.mask) {
        (Some(values), _) => {
            let values = Attribute::new("mask", values.as_slice()).map_err(Failure::new)?;
            Box::new(Masked::new(warp, Box::new(values)))
        }
        (None, Some(mask)) => Box::new(Masked::new(warp, Box::new(Arc::clone(mask)))),
        (None, None) => warp,
    })
}

/// Whether a part keeps all influences whatever their shares.
fn undroppable<S: ModelSpace>(part: &BuiltPart<S>) -> bool {
    part.warp.facts().weights_follow_targets || part.warp.average() == Average::Plain
}

/// The first point at which a part's mask is not the one that was bound.
fn other_mask<S: ModelSpace>(bound: &BoundWarp, part: &BuiltPart<S>, rest: &[S]) -> Option<usize> {
    let values = bound.mask.as_ref()?;
    let mask = part.mask.as_ref()?;
    let mut sites = rest.iter().zip(values).enumerate();
    let other = sites.find(|(index, (point, value))| {
        mask.value(&Site::new(*index, **point)).to_bits() != value.to_bits()
    });
    other.map(|(index, _)| index)
}

/// A recipe's warps with the influences of a binding, for the model it was made for.
pub(crate) fn bound_stack<S: ModelSpace>(
    path: &Path,
    built: &BuiltRecipe<S>,
    rest: &[S],
    model: &str,
    quiet: bool,
) -> Result<Stack<S>, Failure> {
    let name = files::shown(path);
    let file = BindingFile::read(&files::read(path)?)
        .map_err(|error| Failure::new(format!("{name}: {error}")))?;
    let again = "bind it again with `anamorph bind`";
    if file.points != rest.len() || file.dimension != S::DIM {
        return Err(Failure::new(format!(
            "{name}: this binding was made for {} with {} points in {} dimensions, and {model} has {} in {}; {again}",
            file.model,
            file.points,
            file.dimension,
            rest.len(),
            S::DIM
        )));
    }
    if file.fingerprint != Fingerprint::of(rest) {
        return Err(Failure::new(format!(
            "{name}: this binding was made for {}, and the points of {model} are others; {again}",
            file.model
        )));
    }
    let kinds = |list: Vec<&str>| list.join(", ");
    if file.warps.len() != built.parts.len()
        || file
            .warps
            .iter()
            .zip(&built.parts)
            .any(|(a, b)| a.kind != b.kind)
    {
        return Err(Failure::new(format!(
            "{name}: it binds {}, and the recipe's warps are {}; {again}",
            kinds(file.warps.iter().map(|w| w.kind.as_str()).collect()),
            kinds(built.parts.iter().map(|p| p.kind).collect())
        )));
    }
    if let Some((part, _)) = built
        .parts
        .iter()
        .zip(&file.warps)
        .find(|(part, bound)| part.structure != bound.structure)
    {
        return Err(Failure::new(format!(
            "{name}: {} is described otherwise than when it was bound, and not only by numbers; {again}",
            part.title()
        )));
    }
    // Later warps were bound to the model as it arrived there then; only the first can be compared.
    if let (Some(bound), Some(part)) = (file.warps.first(), built.parts.first())
        && let Some(index) = bound
            .binding
            .outdated(&part.warp, rest, file.drop_below > 0.0)
            .or_else(|| other_mask(bound, part, rest))
    {
        return Err(Failure::new(format!(
            "{name}: the sources or fields of {} are not those that were bound (seen at point {}); only targets and constant \
             strengths may change. Otherwise {again}",
            part.title(),
            index + 1
        )));
    }
    if !quiet && file.drop_below > 0.0 {
        say!(
            "  note: influences below {} of a point's weight were dropped, which moved points by up to {} then; with other targets it may \
             be more",
            files::short(file.drop_below),
            files::short(file.dropped)
        );
    }
    if !quiet && built.parts.len() > 1 {
        say!(
            "  note: warps after the first use the influences of the model as it arrived there when it was bound"
        );
    }
    let stages: Result<Vec<_>, Failure> = built
        .parts
        .iter()
        .zip(&file.warps)
        .map(|(part, bound)| stage(part, bound))
        .collect();
    Ok(Stack::new(stages?))
}
