//! Pairs of meshes in files: what `anamorph mesh` writes, and what `anamorph morph` goes between without matching.

use super::Step;
use super::inputs::Input;
use crate::error::Failure;
use crate::files;
use anamorph_core::glam::DVec2;
use anamorph_io::outlines::{Fill, Pair, PairPart, PairRing};
use anamorph_meshing::compatible::CompatiblePair;
use anamorph_meshing::planar::orientation;
use anamorph_morph::figures::Figure;
use anamorph_morph::matching::{Anchor, AnchorPlace};
use anamorph_morph::shapes::area;
use anamorph_morph::strain::{self, Settings};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// Black, where a file says nothing of colours.
const BLACK: Fill = [0.0, 0.0, 0.0, 1.0];

/// Meshes of a file, y downwards, triangles in the order of numbers of the plane.
pub(super) struct Meshes {
    parts: Vec<Part>,
}

struct Part {
    mesh: CompatiblePair,
    fills: [Option<Fill>; 2],
}

/// Reads a pair.
pub(super) fn read(path: &Path) -> Result<([Input; 2], Meshes), Failure> {
    let shown = files::shown(path);
    let failed = |error: &dyn std::fmt::Display| Failure::new(format!("{shown}: {error}"));
    let mut pair = Pair::read(&files::read(path)?).map_err(|error| failed(&error))?;
    if !pair.y_down {
        for point in pair.source.iter_mut().chain(&mut pair.target) {
            point.y = 0.0 - point.y;
        }
        pair.canvas = pair.canvas.map(|[x, y, w, h]| [x, 0.0 - (y + h), w, h]);
        pair.y_down = true;
    }
    let mut parts = Vec::new();
    if pair.parts.is_empty() {
        for (triangles, rings) in components(&pair) {
            parts.push(part(&pair, &triangles, &rings, [Some(BLACK); 2]));
        }
    } else {
        for slice in pair.split() {
            parts.push(part(&pair, slice.triangles, slice.rings, slice.part.fills));
        }
    }
    if parts.is_empty() {
        return Err(failed(&"the pair has no triangle; list at least one"));
    }
    let view = pair.canvas.unwrap_or_else(|| bounds(&pair));
    let name = |side: usize| match pair.names[side].as_str() {
        "" => format!("{shown} ({})", ["source", "target"][side]),
        name => name.to_owned(),
    };
    let inputs = [0, 1].map(|side| Input::of_pair(name(side), view, Vec::new()));
    Ok((inputs, Meshes { parts }))
}

/// The least box that holds both meshes, and a twentieth of its longer side around it.
fn bounds(pair: &Pair) -> [f64; 4] {
    let all = || pair.source.iter().chain(&pair.target).copied();
    let low = all().fold(DVec2::INFINITY, DVec2::min);
    let size = all().fold(DVec2::NEG_INFINITY, DVec2::max) - low;
    let edge = 0.05 * size.max_element();
    let corner = low - edge;
    [corner.x, corner.y, size.x + 2.0 * edge, size.y + 2.0 * edge]
}

type Component = (Vec<[u32; 3]>, Vec<PairRing>);

/// What nothing connects: overlapping parts of one mesh are filled each for itself.
fn components(pair: &Pair) -> Vec<Component> {
    let mut root: Vec<usize> = (0..pair.source.len()).collect();
    fn find(root: &mut [usize], mut point: usize) -> usize {
        while root[point] != point {
            root[point] = root[root[point]];
            point = root[point];
        }
        point
    }
    for triangle in &pair.triangles {
        let first = find(&mut root, triangle[0] as usize);
        for &corner in &triangle[1..] {
            let other = find(&mut root, corner as usize);
            root[other] = first;
        }
    }
    let mut numbers: HashMap<usize, usize> = HashMap::new();
    let mut found: Vec<Component> = Vec::new();
    for triangle in &pair.triangles {
        let own = find(&mut root, triangle[0] as usize);
        let number = *numbers.entry(own).or_insert_with(|| {
            found.push(Component::default());
            found.len() - 1
        });
        found[number].0.push(*triangle);
    }
    for ring in &pair.rings {
        let own = find(&mut root, ring.points[0] as usize);
        if let Some(number) = numbers.get(&own) {
            found[*number].1.push(ring.clone());
        }
    }
    found
}

/// A part with points of its own, every triangle positive in the source, rings as the triangles have them.
fn part(pair: &Pair, triangles: &[[u32; 3]], rings: &[PairRing], fills: [Option<Fill>; 2]) -> Part {
    let mut own: BTreeMap<u32, u32> = BTreeMap::new();
    for point in triangles.iter().flatten() {
        own.insert(*point, 0);
    }
    for (number, value) in own.values_mut().enumerate() {
        *value = number as u32;
    }
    let places = |all: &[DVec2]| own.keys().map(|point| all[*point as usize]).collect();
    let mut mesh = CompatiblePair {
        source: places(&pair.source),
        target: places(&pair.target),
        ..CompatiblePair::default()
    };
    for triangle in triangles {
        let [a, b, c] = triangle.map(|point| own.get(&point).copied().unwrap_or_default());
        let [p, q, r] = [a, b, c].map(|point| mesh.source[point as usize]);
        let is_turned = orientation(p, q, r) < 0.0;
        mesh.triangles
            .push(if is_turned { [a, c, b] } else { [a, b, c] });
    }
    let edges: HashSet<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
        .collect();
    for ring in rings {
        let points = ring.points.iter();
        let mut points: Vec<u32> = points.filter_map(|point| own.get(point).copied()).collect();
        if let [first, second, ..] = points[..]
            && !edges.contains(&[first, second])
            && edges.contains(&[second, first])
        {
            points.reverse();
        }
        if points.len() >= 3 {
            mesh.rings.push(points);
        }
    }
    if mesh.rings.is_empty() {
        mesh.rings = border(&edges);
    }
    Part { mesh, fills }
}

/// The closed chains of edges with a triangle on one side only.
fn border(edges: &HashSet<[u32; 2]>) -> Vec<Vec<u32>> {
    let alone = edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a]));
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for [a, b] in alone {
        next.entry(*a).or_default().push(*b);
    }
    for list in next.values_mut() {
        list.sort_unstable();
    }
    let mut rings = Vec::new();
    while let Some(&first) = next.keys().next() {
        let (mut ring, mut at) = (Vec::new(), first);
        while let Some(to) = next.get_mut(&at).and_then(Vec::pop) {
            ring.push(at);
            if next.get(&at).is_some_and(Vec::is_empty) {
                next.remove(&at);
            }
            at = to;
        }
        rings.push(ring);
    }
    rings
}

impl Meshes {
    /// What is between, by a method.
    pub(super) fn step(&self, name: &str, method: &strain::Method) -> Result<Step, Failure> {
        let meshes = self.parts.iter().enumerate().map(|(number, part)| {
            // What has no fill on one side comes or goes, and is not to be seen there.
            let any = part.fills.iter().any(Option::is_some);
            let ends = part
                .fills
                .map(|fill| (fill.is_some() || !any).then_some(number));
            (ends, part.mesh.clone())
        });
        let figure = Figure::of_meshes(meshes, method, &Settings::default());
        Ok(Step {
            figure: figure.map_err(|error| Failure::new(format!("{name}: {error}")))?,
            fills: self.parts.iter().map(|part| part.fills).collect(),
        })
    }
}

/// The pair of a step, all parts in one mesh.
pub(super) fn of(inputs: &[Input], step: &Step, anchors: &[Anchor], view: [f64; 4]) -> Pair {
    let mut pair = Pair {
        y_down: true,
        canvas: Some(view),
        names: [inputs[0].short_name(), inputs[1].short_name()],
        ..Pair::default()
    };
    let anchored = largest(inputs, step);
    for (number, couple) in step.figure.couples().iter().enumerate() {
        let first = pair.source.len() as u32;
        let mesh = &couple.mesh;
        if let Some(part) = couple.source.filter(|_| anchored == Some(number)) {
            let outline = &inputs[0].parts[part].region.outer;
            let found = anchors.iter().filter_map(|a| placed(a, outline, mesh));
            pair.anchors.extend(found.map(|point| point + first));
            pair.anchors.sort_unstable();
            pair.anchors.dedup();
        }
        pair.source.extend(&mesh.source);
        pair.target.extend(&mesh.target);
        let triangles = mesh.triangles.iter();
        pair.triangles
            .extend(triangles.map(|t| t.map(|i| i + first)));
        for (ring, points) in mesh.rings.iter().enumerate() {
            pair.rings.push(PairRing {
                points: points.iter().map(|i| i + first).collect(),
                hole: ring > 0,
            });
        }
        pair.parts.push(PairPart {
            name: part_name(inputs, step, number),
            points: mesh.source.len(),
            triangles: mesh.triangles.len(),
            rings: mesh.rings.len(),
            fills: step.fills[number],
        });
    }
    pair
}

/// The couple that anchors are of.
fn largest(inputs: &[Input], step: &Step) -> Option<usize> {
    let size = |side: usize, part: Option<usize>| {
        let part = part.and_then(|part| inputs[side].parts.get(part));
        part.map_or(0.0, |part| area(&part.region.outer).abs())
    };
    let couples = step.figure.couples().iter().enumerate();
    let sizes = couples.map(|(i, c)| (i, size(0, c.source).min(size(1, c.target))));
    let largest = sizes.max_by(|(i, a), (j, b)| a.total_cmp(b).then(j.cmp(i)));
    largest.map(|(number, _)| number)
}

/// The point of the outer ring that stands where an anchor is on the source's outline; none where no point is needed there.
fn placed(anchor: &Anchor, outline: &[DVec2], mesh: &CompatiblePair) -> Option<u32> {
    let count = outline.len();
    let edge = |i: usize| [outline[i], outline[(i + 1) % count]];
    let length = |i: usize| edge(i)[0].distance(edge(i)[1]);
    let total: f64 = (0..count).map(length).sum();
    let place = match anchor.source {
        AnchorPlace::Point(point) => *outline.get(point)?,
        AnchorPlace::Fraction(share) => {
            let mut rest = share * total;
            let on = (0..count).find(|i| {
                let reached = rest <= length(*i);
                rest -= if reached { 0.0 } else { length(*i) };
                reached
            });
            let [from, to] = edge(on.unwrap_or(0));
            from + (to - from).normalize_or_zero() * rest
        }
    };
    let ring = mesh.rings.first()?.iter().copied();
    let far = |point: u32| mesh.source[point as usize].distance(place);
    let nearest = ring.min_by(|a, b| far(*a).total_cmp(&far(*b)))?;
    (far(nearest) <= 1e-9 * total).then_some(nearest)
}

/// What a part is called: after its part in the source or in the target, or by its number.
pub(super) fn part_name(inputs: &[Input], step: &Step, number: usize) -> String {
    let couple = step.figure.couples().get(number);
    let id = |side: usize, part: Option<usize>| {
        let part = part.and_then(|part| inputs[side].parts.get(part));
        part.and_then(|part| part.id.clone())
    };
    let named = couple.and_then(|couple| id(0, couple.source).or_else(|| id(1, couple.target)));
    named.unwrap_or_else(|| format!("part {}", number + 1))
}
