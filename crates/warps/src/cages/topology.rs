//! Whether a file still has the points and wires of the cage it came from.
//!
//! Finds the run of points that belongs to the cage (a modeller may save other objects with it), holds its wires to those
//! expected, and recognises points that were put in another order. Comments, names, and how wires are cut into segments do
//! not count; faces may stand in for wires where they join neighbours only.
//!
//! *Source*: a decision. A cage that was renumbered would warp a model into a knot, so that every doubt is an error.

use anamorph_catalog::FeatureMesh;
use anamorph_core::{Linear, Space};
use std::collections::{BTreeMap, HashMap};

/// What a cage must look like.
pub(crate) struct Expected<'a> {
    /// Number of points.
    pub(crate) count: usize,
    /// Pairs of joined points, the smaller index first, sorted.
    pub(crate) edges: &'a [[u32; 2]],
    /// Whether a face may join two points.
    pub(crate) near: &'a dyn Fn(u32, u32) -> bool,
    /// Where the cage comes from, as messages say it: `cage.obj`, `the recipe's shape`.
    pub(crate) origin: &'a str,
}

/// A wire by the numbers that files count vertices with.
fn shown(edge: [u32; 2], first: usize) -> String {
    let number = |index: u32| index as usize + first + 1;
    format!("v {} – v {}", number(edge[0]), number(edge[1]))
}

fn plural(count: usize, word: &str) -> String {
    let end = if count == 1 { "" } else { "s" };
    format!("{count} {word}{end}")
}

/// Pairs of joined points, the smaller index first, sorted, each once.
fn sorted(pairs: impl Iterator<Item = [u32; 2]>) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = pairs
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// The sides of triangles.
fn sides(triangles: &[[u32; 3]]) -> impl Iterator<Item = [u32; 2]> {
    triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
}

/// The first of the run of points that is the cage. What else is in the file must be objects of their own.
///
/// # Errors
/// What changed, and how to mend it.
pub(crate) fn locate(
    name: &str,
    mesh: &FeatureMesh,
    expected: &Expected<'_>,
) -> Result<usize, (String, String)> {
    let found = mesh.points.len();
    let count = |hint: &str| {
        let Expected { origin, count, .. } = expected;
        let message = format!(
            "{name} has {} where {origin} has {count}",
            plural(found, "point")
        );
        (message, hint.to_owned())
    };
    if found < expected.count {
        return Err(count(
            "keep every vertex: undo merging and deleting, then save it again",
        ));
    }
    let lines = sorted(mesh.lines.iter().copied());
    let first = if found == expected.count {
        0
    } else {
        let extra =
            count("a cage takes no new vertices: undo adding and subdividing, then save it again");
        alone(mesh, &lines, expected).ok_or(extra)?
    };
    compare(name, mesh, &lines, expected, first)?;
    Ok(first)
}

/// Where the cage begins among other objects: the only place where the wires are all there, and nothing reaches across.
fn alone(mesh: &FeatureMesh, lines: &[[u32; 2]], expected: &Expected<'_>) -> Option<usize> {
    let &[a, _] = expected.edges.first()?;
    let most = mesh.points.len() - expected.count;
    let fits = |first: usize| {
        let shift = u32::try_from(first).ok()?;
        let all = expected
            .edges
            .iter()
            .all(|&[a, b]| lines.binary_search(&[a + shift, b + shift]).is_ok());
        all.then_some(first)
    };
    let mut starts: Vec<usize> = lines
        .iter()
        .filter_map(|&[start, _]| start.checked_sub(a))
        .map(|first| first as usize)
        .filter(|&first| first <= most)
        .collect();
    starts.dedup();
    let mut places = starts.into_iter().filter_map(fits);
    let first = places.next()?;
    if places.next().is_some() {
        return None;
    }
    let inside = |index: u32| (first..first + expected.count).contains(&(index as usize));
    let mut used = vec![false; mesh.points.len()];
    for [a, b] in lines.iter().copied().chain(sides(&mesh.triangles)) {
        if inside(a) != inside(b) {
            return None;
        }
        used[a as usize] = true;
        used[b as usize] = true;
    }
    // A point that nothing uses was added to the cage by mistake.
    let others =
        (0..mesh.points.len()).filter(|&index| !(first..first + expected.count).contains(&index));
    others.into_iter().all(|index| used[index]).then_some(first)
}

/// Holds the wires and faces of the cage to those expected.
fn compare(
    name: &str,
    mesh: &FeatureMesh,
    lines: &[[u32; 2]],
    expected: &Expected<'_>,
    first: usize,
) -> Result<(), (String, String)> {
    let Expected {
        count,
        edges,
        near,
        origin,
    } = expected;
    let inside = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|index| (index as usize).checked_sub(first));
        let small = |index: usize| u32::try_from(index).ok();
        match (a, b) {
            (Some(a), Some(b)) if a < *count && b < *count => Some([small(a)?, small(b)?]),
            _ => None,
        }
    };
    let wires: Vec<[u32; 2]> = lines.iter().filter_map(inside).collect();
    let sides = sorted(sides(&mesh.triangles));
    let sides: Vec<[u32; 2]> = sides.iter().filter_map(inside).collect();
    let keep = "keep the vertices in their order and the wires as they are; exporters have a setting such as \"keep vertex \
                order\"";
    if let Some(&far) = sides.iter().find(|&&[a, b]| !near(a, b)) {
        let message = format!(
            "a face of {name} joins {}, which are no neighbours in {origin}: its vertices were reordered, or the face does \
             not belong to the cage",
            shown(far, first)
        );
        return Err((message, keep.to_owned()));
    }
    if wires.is_empty() {
        return Ok(());
    }
    let new: Vec<[u32; 2]> = wires
        .iter()
        .copied()
        .filter(|wire| edges.binary_search(wire).is_err())
        .collect();
    let gone: Vec<[u32; 2]> = edges
        .iter()
        .copied()
        .filter(|edge| wires.binary_search(edge).is_err() && sides.binary_search(edge).is_err())
        .collect();
    let part = |list: &[[u32; 2]], what: &str| {
        let one = *list.first()?;
        Some(format!(
            "{} {what}, such as {}",
            plural(list.len(), "wire"),
            shown(one, first)
        ))
    };
    let parts: Vec<String> = [part(&new, "more"), part(&gone, "fewer")]
        .into_iter()
        .flatten()
        .collect();
    if parts.is_empty() {
        return Ok(());
    }
    let message = format!(
        "{name} joins its points in another way than {origin}: {}",
        parts.join("; ")
    );
    Err((
        message,
        format!("its vertices were reordered or its wires changed; {keep}"),
    ))
}

/// Whether a coordinate is `source` as modellers write it when nobody touched it: rounded to 32 bits, to six decimals, or to
/// six digits. `size` is the extent of the cage: what is a visible part of it is a move.
fn untouched(source: f64, target: f64, size: f64) -> bool {
    if source == target {
        return true;
    }
    let difference = (source - target).abs();
    if difference.is_nan() || difference > 1e-6 * size.max(source.abs()) {
        return false;
    }
    #[allow(clippy::cast_possible_truncation)]
    let single = f64::from(source as f32);
    let written = |text: String| text.parse() == Ok(target);
    target == single
        || [source, single]
            .into_iter()
            .any(|value| written(format!("{value:.6}")) || written(format!("{value:.5e}")))
}

/// Target points, with every coordinate that was merely rounded set back to the source's, so that what nobody touched does
/// not move.
pub(crate) fn settle<S: Space>(source: &[S], target: &[S]) -> Vec<S> {
    let first = source.first().copied().unwrap_or(S::ZERO);
    let size = source
        .iter()
        .fold(0.0, |most: f64, &p| most.max((p - first).largest()));
    let settle = |(&source, &target): (&S, &S)| {
        S::from_fn(|axis| {
            let (a, b) = (source.component(axis), target.component(axis));
            if untouched(a, b, size) { a } else { b }
        })
    };
    source.iter().zip(target).map(settle).collect()
}

/// A point that stands where another stood, and that other, if the points can be nothing but the source's in another order:
/// no two of them in one place, and some exchanged in a circle so that `edges` break, or most of them exchanged so that most
/// edges break or everything is mirrored. An edit that carries points onto places that others have left is none of that.
pub(crate) fn reordered<S: Space>(
    source: &[S],
    target: &[S],
    edges: &[[u32; 2]],
) -> Option<(usize, usize)> {
    let first = source.first().copied()?;
    let size = source
        .iter()
        .fold(0.0, |most: f64, &p| most.max((p - first).largest()));
    let cell = 1e-5 * size;
    if !(cell > 0.0 && cell.is_finite()) {
        return None;
    }
    #[allow(clippy::cast_possible_truncation)]
    let key = |point: S| -> [i64; 3] {
        core::array::from_fn(|axis| {
            ((point.component(axis) - first.component(axis)) / cell).round() as i64
        })
    };
    let mut places: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (index, &point) in source.iter().enumerate() {
        places.entry(key(point)).or_default().push(index);
    }
    let depth = if S::DIM == 2 { 0..=0 } else { -1..=1 };
    let standing = |point: S| {
        let [x, y, z] = key(point);
        let mut found = None;
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            for dz in depth.clone() {
                let cell = [
                    x.saturating_add(dx),
                    y.saturating_add(dy),
                    z.saturating_add(dz),
                ];
                for &index in places.get(&cell).into_iter().flatten() {
                    if found.is_some_and(|other| other != index) {
                        return None;
                    }
                    found = Some(index);
                }
            }
        }
        found
    };
    let images: Vec<Option<usize>> = target
        .iter()
        .zip(source)
        .enumerate()
        .map(|(index, (&t, &s))| if t == s { Some(index) } else { standing(t) })
        .collect();
    let mut taken = vec![false; source.len()];
    for &image in images.iter().flatten() {
        if core::mem::replace(&mut taken[image], true) {
            // Two in one place: someone has drawn the cage together.
            return None;
        }
    }
    let moved = |index: usize| Some((index, images[index].filter(|&image| image != index)?));
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let broken: Vec<[usize; 2]> = edges
        .iter()
        .map(|edge| edge.map(|end| end as usize))
        .filter(|&[a, b]| match (images[a], images[b]) {
            (Some(x), Some(y)) => {
                let pair = [index(x.min(y)), index(x.max(y))];
                edges.binary_search(&pair).is_err()
            }
            _ => false,
        })
        .collect();
    let circles = circles(&images);
    let ends = broken.iter().flatten().copied();
    let exchanged = ends.filter_map(moved).find(|&(index, _)| circles[index]);
    if exchanged.is_some() {
        return exchanged;
    }
    let count = (0..images.len()).filter_map(moved).count();
    let most_broken = 2 * broken.len() > edges.len();
    if 2 * count > images.len()
        && (most_broken || mirrored(source, target, &images, edges) == Some(true))
    {
        return (0..images.len()).find_map(moved);
    }
    None
}

/// Which points come back to their own place by going on from place to place.
fn circles(images: &[Option<usize>]) -> Vec<bool> {
    let mut closed = vec![false; images.len()];
    let mut seen = vec![false; images.len()];
    for start in 0..images.len() {
        let mut path = Vec::new();
        let mut at = start;
        while !core::mem::replace(&mut seen[at], true) {
            path.push(at);
            match images[at] {
                Some(next) => at = next,
                None => break,
            }
        }
        // No two points lead to one place, so that a path can only close where it began.
        if path.last().is_some_and(|&last| images[last] == Some(start)) {
            for index in path {
                closed[index] = true;
            }
        }
    }
    closed
}

/// Whether a corner whose wires all lead to known places has been turned inside out; `None` if there is no such corner.
fn mirrored<S: Space>(
    source: &[S],
    target: &[S],
    images: &[Option<usize>],
    edges: &[[u32; 2]],
) -> Option<bool> {
    let mut corners: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for &[a, b] in edges {
        if images[a as usize].is_some() && images[b as usize].is_some() {
            corners.entry(a).or_default().push(b as usize);
        }
    }
    corners.into_iter().find_map(|(corner, ends)| {
        let (corner, ends) = (corner as usize, ends.get(..S::DIM)?);
        let volume = |points: &[S]| {
            S::Linear::from_columns(|axis| points[ends[axis]] - points[corner]).determinant()
        };
        let (before, after) = (volume(source), volume(target));
        (before != 0.0 && after != 0.0).then_some((before > 0.0) != (after > 0.0))
    })
}

#[cfg(test)]
mod tests {
    use super::super::grid_edges;
    use super::*;
    use anamorph_core::glam::{DVec3, dvec3};

    #[test]
    fn rounding_is_no_move() {
        for (source, target, still) in [
            (0.1, 0.1, true),
            (1.0 / 3.0, 0.333_333, true),
            (1.0 / 3.0, f64::from(1.0_f32 / 3.0), true),
            (1.0 / 3.0, 0.333_334, false),
            (0.5, 0.500_001, false),
            (1_234.567_89, 1_234.57, false),
            (1e-7, 0.0, true),
            (f64::NAN, 0.0, false),
        ] {
            assert_eq!(untouched(source, target, 1.0), still, "{source} {target}");
        }
        // Six decimals are a visible part of a cage this small.
        assert!(!untouched(1e-7, 0.0, 1e-6));
    }

    fn points() -> Vec<DVec3> {
        (0..27)
            .map(|i| dvec3(f64::from(i / 9), f64::from(i / 3 % 3), f64::from(i % 3)))
            .collect()
    }

    #[test]
    fn another_order_is_told_from_an_edit() {
        let edges = grid_edges([3, 3, 3]);
        let source = points();
        assert_eq!(reordered(&source, &source, &edges), None);
        // Edits: a point onto its neighbour, a layer onto another, a turn of the whole, a shift by a cell.
        let mut edited = source.clone();
        edited[0] = source[1];
        assert_eq!(reordered(&source, &edited, &edges), None);
        let onto: Vec<DVec3> = source
            .iter()
            .map(|p| dvec3(p.x.max(1.0), p.y, p.z))
            .collect();
        assert_eq!(reordered(&source, &onto, &edges), None);
        let turned: Vec<DVec3> = source.iter().map(|p| dvec3(p.z, p.y, 2.0 - p.x)).collect();
        assert_eq!(reordered(&source, &turned, &edges), None);
        // A layer onto the place of the next, which went away.
        let pushed: Vec<DVec3> = source
            .iter()
            .map(|p| if p.x > 0.0 { *p + DVec3::X } else { *p })
            .collect();
        assert_eq!(reordered(&source, &pushed, &edges), None);
        let reversed: Vec<DVec3> = source.iter().rev().copied().collect();
        assert_eq!(reordered(&source, &reversed, &edges), Some((0, 26)));
        let shifted: Vec<DVec3> = source.iter().map(|p| *p + DVec3::X).collect();
        assert_eq!(reordered(&source, &shifted, &edges), None);
        // Another order: two exchanged, and all but one, which was edited too.
        let mut exchanged = source.clone();
        exchanged.swap(3, 26);
        assert!(reordered(&source, &exchanged, &edges).is_some());
        let mut mixed: Vec<DVec3> = (0..27).map(|i| source[i * 7 % 27]).collect();
        mixed[5] += dvec3(0.3, 0.2, 0.1);
        assert!(reordered(&source, &mixed, &edges).is_some());
    }
}
