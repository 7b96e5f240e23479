//! Writing a glTF with moved points.
//!
//! Every instance says what the accessors of its mesh should hold. Instances of a mesh that agree share it; where they do
//! not, the mesh is copied for the others. Then every accessor that is to change gets its content: in place where its bytes
//! are its own, else as new data to which the accessor, or a new one, leads. A text becomes a GLB by taking its first buffer
//! into the BIN chunk, a GLB a text by giving that buffer a data URI.

use super::accessor::{Component, Layout};
use super::container;
use super::content::{Content, Movement, Outcome, same};
use super::json::{Edits, Value, quoted, rebuilt};
use super::numbers::{array, bounds, put, stretched};
use super::scene::Job;
use super::{Model, Source, listed};
use crate::{Document, Moved, Points, WriteError, WriteReport};
use core::hash::{Hash, Hasher};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Write;

/// `bufferView.target` of vertex attributes.
const ARRAY_BUFFER: usize = 34962;
/// `accessor.componentType` of floats.
const FLOAT: usize = 5126;

pub(super) fn write(
    model: &Model,
    moved: &Moved<'_>,
    binary: bool,
    out: &mut dyn Write,
) -> Result<WriteReport, WriteError> {
    model.points().check(&moved.points)?;
    let new = if let Points::Solid(new) = moved.points {
        new
    } else {
        &[]
    };
    let movement = Movement {
        model,
        data: model.data(),
        new,
        normals: moved.normals,
        tangents: moved.tangents,
    };
    let mut report = WriteReport::default();
    let finite = |i: &usize| model.points[*i].is_finite();
    report.moved_points = (0..model.visible)
        .filter(|&i| !same(model.points[i], new[i]))
        .filter(finite)
        .count();

    let mut outcomes = Vec::with_capacity(model.instances.len());
    for instance in &model.instances {
        let (outcome, tally) = movement.outcome(instance)?;
        report.changed_normals += tally.changed;
        report.kept_normals += tally.kept;
        outcomes.push(outcome);
    }
    let mut plan = Plan::new(model, &movement.data);
    let wanted = plan.split(&outcomes);
    plan.store(wanted, &outcomes);
    plan.write(binary, &mut report, out)?;
    Ok(report)
}

/// A content by instance and job.
type Made = (usize, usize);

/// A version of a mesh: the mesh itself, or a copy of it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Version {
    Original,
    Copy(usize),
}

/// One content that some uses of an accessor want.
struct Wanted {
    made: Made,
    /// Where the number of the accessor stands, and in which version of the mesh.
    uses: Vec<(Version, core::ops::Range<usize>)>,
    /// Whether it is positions, which need their bounds.
    bounded: bool,
}

/// What is wanted of an accessor.
#[derive(Default)]
struct Wishes {
    /// Somebody wants it as it is.
    kept: bool,
    new: Vec<Wanted>,
}

/// A mesh to be added.
struct Copied {
    mesh: usize,
    edits: Edits,
}

struct Plan<'a> {
    model: &'a Model,
    data: &'a [&'a [u8]],
    edits: Edits,
    copies: Vec<Copied>,
    /// New content of buffers, as far as it could not stay where it is.
    patched: BTreeMap<usize, Vec<u8>>,
    /// Contents that take the place of a whole stretch of the BIN chunk, by its first byte.
    stretches: BTreeMap<usize, &'a [f32]>,
    /// What a text's first buffer becomes in a BIN chunk.
    packed: Option<Vec<u8>>,
    /// Bytes to be added.
    added: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

fn hash(value: &impl Hash) -> u64 {
    let mut hasher = std::collections::hash_map::DefaultHasher::new();
    value.hash(&mut hasher);
    hasher.finish()
}

impl<'a> Plan<'a> {
    fn new(model: &'a Model, data: &'a [&'a [u8]]) -> Self {
        Self {
            model,
            data,
            edits: Edits::default(),
            copies: Vec::new(),
            patched: BTreeMap::new(),
            stretches: BTreeMap::new(),
            packed: None,
            added: Vec::new(),
            views: Vec::new(),
            accessors: Vec::new(),
        }
    }

    /// Gives instances that disagree meshes of their own; says what is wanted of each accessor.
    fn split(&mut self, outcomes: &'a [Outcome]) -> BTreeMap<usize, Wishes> {
        let model = self.model;
        let mut of_mesh: Vec<Vec<usize>> = vec![Vec::new(); model.meshes.len()];
        for (i, instance) in model.instances.iter().enumerate() {
            of_mesh[instance.mesh].push(i);
        }
        let mut wishes: BTreeMap<usize, Wishes> = BTreeMap::new();
        let root = model.json.root();
        let (mesh_values, node_values) = (listed(root, "meshes"), listed(root, "nodes"));
        for (mesh, instances) in of_mesh.iter().enumerate() {
            let mut groups: Vec<Vec<usize>> = Vec::new();
            let mut by_hash: HashMap<u64, Vec<usize>> = HashMap::new();
            for &instance in instances {
                let alone = instances.len() == 1;
                let key = if alone { 0 } else { hash(&outcomes[instance]) };
                let alike = by_hash.entry(key).or_default();
                let known = alike
                    .iter()
                    .find(|g| outcomes[groups[**g][0]] == outcomes[instance]);
                match known {
                    Some(group) => groups[*group].push(instance),
                    None => {
                        alike.push(groups.len());
                        groups.push(vec![instance]);
                    }
                }
            }
            // The mesh itself stays with those that have not changed, or else with the first.
            let still = |group: &Vec<usize>| outcomes[group[0]].iter().all(Option::is_none);
            let keeper = groups.iter().position(still).unwrap_or(0);
            for (g, group) in groups.iter().enumerate() {
                let version = if g == keeper {
                    Version::Original
                } else {
                    let number = self.copies.len();
                    let value = mesh_values[mesh];
                    let mut edits = Edits::default();
                    rename(&mut edits, value, model, group[0]);
                    self.copies.push(Copied { mesh, edits });
                    for &instance in group {
                        let node = model.instances[instance].node;
                        if let Some(number_of) = node.and_then(|node| node_values[node].get("mesh"))
                        {
                            self.edits
                                .replace(number_of, (mesh_values.len() + number).to_string());
                        }
                    }
                    Version::Copy(number)
                };
                self.wish(mesh, group[0], version, &outcomes[group[0]], &mut wishes);
            }
        }
        for accessor in other_uses(model, root) {
            if let Some(wishes) = wishes.get_mut(&accessor) {
                wishes.kept = true;
            }
        }
        wishes
    }

    /// Adds what a version of a mesh wants of its accessors.
    fn wish(
        &self,
        mesh: usize,
        instance: usize,
        version: Version,
        outcome: &Outcome,
        wishes: &mut BTreeMap<usize, Wishes>,
    ) {
        let mut known: HashMap<(usize, usize), usize> = HashMap::new();
        let mesh = &self.model.meshes[mesh];
        for found in &mesh.uses {
            let wishes = wishes.entry(found.accessor).or_default();
            if outcome[found.job].is_none() {
                wishes.kept = true;
                continue;
            }
            let place = *known.entry((found.accessor, found.job)).or_insert_with(|| {
                wishes.new.push(Wanted {
                    made: (instance, found.job),
                    uses: Vec::new(),
                    bounded: matches!(
                        mesh.jobs[found.job],
                        Job::Position { .. } | Job::DeltaPosition { .. }
                    ),
                });
                wishes.new.len() - 1
            });
            wishes.new[place].uses.push((version, found.span.clone()));
        }
    }

    /// Finds room for every content.
    fn store(&mut self, mut wishes: BTreeMap<usize, Wishes>, outcomes: &'a [Outcome]) {
        wishes.retain(|_, wishes| !wishes.new.is_empty());
        if wishes.is_empty() {
            return;
        }
        let root = self.model.json.root();
        let values = listed(root, "accessors");
        let shared = shared(self.model, root);
        for (accessor, wishes) in wishes {
            let content = |made: Made| outcomes[made.0][made.1].as_ref();
            let new = merged(wishes.new, &content);
            let alone = !wishes.kept && new.len() == 1;
            for wanted in new {
                let Some(content) = content(wanted.made) else {
                    continue;
                };
                let value = values[accessor];
                if alone && !shared.contains(&accessor) && self.in_place(accessor, content) {
                    self.bounds_in_place(value, content);
                    continue;
                }
                let text = self.redefined(value, content, wanted.bounded);
                if alone {
                    self.edits.replace(value, text);
                    continue;
                }
                let number = (values.len() + self.accessors.len()).to_string();
                self.accessors.push(text);
                for (version, span) in wanted.uses {
                    match version {
                        Version::Original => self.edits.replace_span(span, number.clone()),
                        Version::Copy(copy) => {
                            self.copies[copy].edits.replace_span(span, number.clone());
                        }
                    }
                }
            }
        }
    }

    /// Writes a content over the accessor's own bytes, if they can hold it.
    fn in_place(&mut self, number: usize, content: &'a Content) -> bool {
        let accessor = &self.model.accessors[number];
        let can_change = accessor.layouts().all(|layout| {
            matches!(
                self.model.buffers[layout.buffer].source,
                Source::Chunk | Source::Data { .. }
            )
        });
        if accessor.component != Component::F32 || accessor.width != content.width || !can_change {
            return false;
        }
        let width = content.width;
        if let (true, None, Some(base)) =
            (accessor.is_tight(width), &accessor.sparse, accessor.base)
            && matches!(self.model.buffers[base.buffer].source, Source::Chunk)
        {
            self.stretches.insert(base.start, &content.numbers);
            return true;
        }
        let replaced = accessor.replaced(self.data);
        if accessor.base.is_none() {
            // All but the replaced elements are zeros and must stay so.
            let mut next = replaced.iter().peekable();
            for (i, element) in content.numbers.chunks_exact(width).enumerate() {
                if next.next_if(|at| **at == i).is_none()
                    && element.iter().any(|x| x.to_bits() != 0)
                {
                    return false;
                }
            }
        }
        if let Some(base) = accessor.base {
            let bytes = self.bytes_of(base.buffer);
            put(bytes, &base, content.numbers.chunks_exact(width), &replaced);
        }
        if let Some(sparse) = &accessor.sparse {
            let bytes = self.bytes_of(sparse.values.buffer);
            let elements = replaced
                .iter()
                .filter_map(|at| content.numbers.get(at * width..(at + 1) * width));
            put(bytes, &sparse.values, elements, &[]);
        }
        true
    }

    /// The content of a buffer, to be changed.
    fn bytes_of(&mut self, buffer: usize) -> &mut Vec<u8> {
        let model = self.model;
        let data = self.data;
        self.patched.entry(buffer).or_insert_with(|| {
            match (&model.buffers[buffer].source, &model.chunks) {
                // With its padding.
                (Source::Chunk, Some(chunks)) => {
                    let bin = chunks.bin.clone().unwrap_or(0..0);
                    model.bytes[bin].to_vec()
                }
                _ => data[buffer].to_vec(),
            }
        })
    }

    /// Corrects the bounds of an accessor that has them.
    fn bounds_in_place(&mut self, value: Value<'_>, content: &Content) {
        let Some((low, high)) = bounds(content) else {
            return;
        };
        for (key, new) in [("min", low), ("max", high)] {
            let Some(old) = value.get(key) else {
                continue;
            };
            // A number that means the same stays as it is written.
            let stored: Vec<Option<f32>> = old.items().map(|x| Some(x.number()? as f32)).collect();
            let agrees = stored.len() == new.len()
                && stored.iter().zip(&new).all(|(old, new)| *old == Some(*new));
            if !agrees {
                self.edits.replace(old, array(&new));
            }
        }
    }

    /// The accessor with new data at the end.
    fn redefined(&mut self, value: Value<'_>, content: &Content, bounded: bool) -> String {
        let root = self.model.json.root();
        let offset = self.added.len();
        self.added
            .extend(content.numbers.iter().flat_map(|x| x.to_le_bytes()));
        let (buffer, base) = self.room();
        let view = listed(root, "bufferViews").len() + self.views.len();
        self.views.push(format!(
            "{{\"buffer\":{buffer},\"byteOffset\":{},\"byteLength\":{},\"target\":{ARRAY_BUFFER}}}",
            base + offset,
            self.added.len() - offset
        ));
        let mut changes = vec![
            ("bufferView", Some(view.to_string())),
            ("byteOffset", None),
            ("componentType", Some(FLOAT.to_string())),
            ("normalized", None),
            ("sparse", None),
        ];
        let had = |key: &str| value.get(key).is_some();
        if bounded || had("min") || had("max") {
            let (low, high) = bounds(content).unzip();
            changes.push(("min", low.map(|low| array(&low))));
            changes.push(("max", high.map(|high| array(&high))));
        }
        rebuilt(value, &changes)
    }

    /// The buffer that new data goes to, and where in it: the end of the BIN chunk, or a buffer of its own.
    fn room(&self) -> (usize, usize) {
        match self.model.buffers.first() {
            Some(buffer) if matches!(buffer.source, Source::Chunk) => {
                (0, buffer.length.next_multiple_of(4))
            }
            _ => (self.model.buffers.len(), 0),
        }
    }

    /// The bytes of the first buffer as they are to be written, if it has any.
    fn first(&self) -> Option<&[u8]> {
        let buffer = self.model.buffers.first()?;
        let bytes = match (self.patched.get(&0), &buffer.source) {
            (_, Source::Nowhere) => return None,
            (Some(bytes), _) => &bytes[..],
            (None, _) => self.data.first()?,
        };
        Some(bytes)
    }

    /// Moves the first buffer between the JSON and the BIN chunk, where the form changes.
    fn change_form(&mut self, binary: bool) {
        let root = self.model.json.root();
        let Some(value) = listed(root, "buffers").first().copied() else {
            return;
        };
        match (&self.model.buffers[0].source, binary) {
            (Source::Data { .. } | Source::File, true) => {
                self.packed = self.first_content(value);
                // One whose content is not at hand stays where it is.
                if self.packed.is_some() {
                    self.edits.replace(value, rebuilt(value, &[("uri", None)]));
                }
            }
            (Source::Chunk, false) => {
                let mut bytes = self.first().unwrap_or_default().to_vec();
                for (&start, numbers) in &self.stretches {
                    let stretch = bytes.get_mut(start..start + 4 * numbers.len());
                    let places = stretch.unwrap_or_default().as_chunks_mut::<4>().0;
                    for (place, number) in places.iter_mut().zip(*numbers) {
                        *place = number.to_le_bytes();
                    }
                }
                let content = container::to_base64(&bytes);
                let uri = quoted(&format!("data:application/octet-stream;base64,{content}"));
                self.edits.insert(value, "uri", &uri);
            }
            _ => {}
        }
    }

    /// All bytes of the first buffer of a text, also where no mesh needs them.
    fn first_content(&self, value: Value<'_>) -> Option<Vec<u8>> {
        let length = self.model.buffers[0].length;
        let whole = |bytes: &[u8]| (bytes.len() >= length).then(|| bytes[..length].to_vec());
        if let Some(bytes) = self.first().and_then(whole) {
            return Some(bytes);
        }
        let uri = value.get("uri")?.text()?;
        whole(&container::decoded(&uri).ok()?)
    }

    /// Makes the edits that follow from all others.
    fn finish(&mut self, binary: bool) {
        let root = self.model.json.root();
        let texts = self.copies.iter().map(|copy| {
            let value = listed(root, "meshes")[copy.mesh];
            copy.edits.apply(&self.model.json.text, value.span())
        });
        let meshes: Vec<String> = texts.collect();
        let mut buffers = Vec::new();
        let (buffer, base) = self.room();
        if !self.added.is_empty() {
            if let Some(value) = listed(root, "buffers").get(buffer) {
                let bytes = self.bytes_of(buffer);
                bytes.resize(base, 0);
                let added = core::mem::take(&mut self.added);
                let bytes = self.bytes_of(buffer);
                bytes.extend(added);
                let length = bytes.len();
                if let Some(number) = value.get("byteLength") {
                    self.edits.replace(number, length.to_string());
                }
            } else {
                let content = container::to_base64(&self.added);
                buffers.push(format!(
                    "{{\"byteLength\":{},\"uri\":\"data:application/octet-stream;base64,{content}\"}}",
                    self.added.len()
                ));
            }
        }
        for (&number, bytes) in &self.patched {
            let Source::Data { head } = &self.model.buffers[number].source else {
                continue;
            };
            if number == 0 && binary {
                continue;
            }
            // What was written with percent signs is written in base64 now.
            let head = head.trim_end_matches(',');
            let kind = if head.to_ascii_lowercase().ends_with(";base64") {
                ""
            } else {
                ";base64"
            };
            let uri = format!("{head}{kind},{}", container::to_base64(bytes));
            if let Some(value) = listed(root, "buffers")[number].get("uri") {
                self.edits.replace(value, quoted(&uri));
            }
        }
        let added = [
            ("meshes", &meshes),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
            ("buffers", &buffers),
        ];
        for (key, values) in added {
            if values.is_empty() {
                continue;
            }
            match root.get(key) {
                Some(list) => self.edits.append(list, values),
                None => self
                    .edits
                    .insert(root, key, &format!("[{}]", values.join(","))),
            }
        }
    }

    fn write(
        mut self,
        binary: bool,
        report: &mut WriteReport,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        self.finish(binary);
        let model = self.model;
        let refused = |what: &str, mend: &str| WriteError::Refused {
            what: what.to_owned(),
            mend: mend.to_owned(),
        };
        if model.chunks.is_some() != binary {
            self.change_form(binary);
        }
        let text = (!self.edits.is_empty())
            .then(|| self.edits.apply(&model.json.text, 0..model.json.text.len()));
        if !binary {
            if model.chunks.as_ref().is_some_and(|c| !c.rest.is_empty()) {
                return Err(refused(
                    "the model has chunks of its own kind, which only a GLB holds",
                    "name the output .glb",
                ));
            }
            let text = text.as_ref().unwrap_or(&model.json.text);
            let text = if model.chunks.is_some() {
                text.trim_end_matches([' ', '\0'])
            } else {
                text
            };
            return report.put(text.as_bytes(), out);
        }
        let mut rest = &[][..];
        let mut json = match (&model.chunks, text) {
            (Some(chunks), text) => {
                if text.is_none() && self.patched.is_empty() && self.stretches.is_empty() {
                    return report.put(&model.bytes, out);
                }
                rest = &model.bytes[chunks.rest.clone()];
                match text {
                    Some(text) => text.trim_end_matches([' ', '\0']).as_bytes().to_vec(),
                    None => model.bytes[chunks.json.clone()].to_vec(),
                }
            }
            (None, text) => text.unwrap_or_else(|| model.json.text.clone()).into_bytes(),
        };
        json.resize(json.len().next_multiple_of(4), b' ');
        // An unchanged chunk is written with the padding it has.
        let bin = match (&model.chunks, self.patched.get(&0)) {
            (Some(chunks), None) => chunks.bin.clone().map(|range| &model.bytes[range]),
            (Some(_), Some(bytes)) => Some(&bytes[..]),
            (None, _) => self.packed.as_deref(),
        };
        let padding = bin.map_or(0, |bin| bin.len().next_multiple_of(4) - bin.len());
        let length = bin.map(|bin| bin.len() + padding);
        let Some(header) = container::glb_header(json.len(), length, rest.len()) else {
            return Err(refused(
                "the warped model has more than 4 GiB, which a GLB cannot hold",
                "save the model as .gltf, with its buffers in files of their own, and warp that",
            ));
        };
        report.put(&header, out)?;
        report.put(&container::chunk_header(true, json.len()), out)?;
        report.put(&json, out)?;
        if let (Some(bin), Some(length)) = (bin, length) {
            report.put(&container::chunk_header(false, length), out)?;
            stretched(bin, &self.stretches, report, out)?;
            report.put(&[0; 3][..padding], out)?;
        }
        report.put(rest, out)
    }
}

/// Joins wishes for the same content.
fn merged<'c>(list: Vec<Wanted>, content: &impl Fn(Made) -> Option<&'c Content>) -> Vec<Wanted> {
    if list.len() < 2 {
        return list;
    }
    let mut out: Vec<Wanted> = Vec::new();
    let mut by_hash: HashMap<u64, Vec<usize>> = HashMap::new();
    for wanted in list {
        let alike = by_hash.entry(hash(&content(wanted.made))).or_default();
        let known = alike
            .iter()
            .find(|i| content(out[**i].made) == content(wanted.made));
        match known {
            Some(&i) => {
                out[i].bounded |= wanted.bounded;
                out[i].uses.extend(wanted.uses);
            }
            None => {
                alike.push(out.len());
                out.push(wanted);
            }
        }
    }
    out
}

/// Names the copy of a mesh after its node.
pub(super) fn rename(edits: &mut Edits, mesh: Value<'_>, model: &Model, instance: usize) {
    let node = model.instances[instance].node;
    let Some(node) = node.and_then(|node| model.nodes[node].name.as_ref()) else {
        return;
    };
    match mesh.get("name") {
        Some(old) => {
            let name = old.text().unwrap_or_default();
            edits.replace(old, quoted(&format!("{name} ({node})")));
        }
        None => edits.insert(mesh, "name", &quoted(node)),
    }
}

/// Accessors that something else than the attributes we rewrite refers to.
fn other_uses(model: &Model, root: Value<'_>) -> BTreeSet<usize> {
    let uses = model.meshes.iter().flat_map(|mesh| &mesh.uses);
    let ours: std::collections::HashSet<usize> = uses.map(|found| found.span.start).collect();
    let mut others = BTreeSet::new();
    let mut add = |value: Option<Value<'_>>| {
        if let Some(value) = value.filter(|value| !ours.contains(&value.span().start)) {
            others.extend(value.whole());
        }
    };
    for mesh in listed(root, "meshes") {
        for primitive in listed(mesh, "primitives") {
            add(primitive.get("indices"));
            let targets = listed(primitive, "targets");
            for table in targets.into_iter().chain(primitive.get("attributes")) {
                table.entries().for_each(|(_, value)| add(Some(value)));
            }
        }
    }
    for skin in listed(root, "skins") {
        add(skin.get("inverseBindMatrices"));
    }
    for animation in listed(root, "animations") {
        for sampler in listed(animation, "samplers") {
            add(sampler.get("input"));
            add(sampler.get("output"));
        }
    }
    // What extensions mean by a number we cannot know; one that could be an accessor counts as one.
    let mut open: Vec<Value<'_>> = vec![root];
    while let Some(value) = open.pop() {
        for (key, part) in value.entries() {
            if key == "extensions" {
                numbers_in(part, &mut add);
            } else if key != "extras" {
                open.push(part);
            }
        }
        open.extend(value.items());
    }
    others
}

/// All numbers in a value.
fn numbers_in<'v>(value: Value<'v>, add: &mut impl FnMut(Option<Value<'v>>)) {
    let mut open = vec![value];
    while let Some(value) = open.pop() {
        add(Some(value));
        open.extend(value.entries().map(|(_, part)| part));
        open.extend(value.items());
    }
}

/// Comparisons of places that are made for each place; beyond, what is left counts as shared.
const EFFORT: usize = 256;

/// Accessors with a byte that another accessor, an image or an extension has, too.
fn shared(model: &Model, root: Value<'_>) -> BTreeSet<usize> {
    let mut places: Vec<(Layout, Option<usize>)> = Vec::new();
    for (i, accessor) in model.accessors.iter().enumerate() {
        places.extend(accessor.layouts().map(|layout| (layout, Some(i))));
    }
    places.extend(whole_views(root).map(|layout| (layout, None)));
    places.sort_unstable();
    let mut shared = BTreeSet::new();
    let mut effort = places.len() * EFFORT;
    for (i, (layout, owner)) in places.iter().enumerate() {
        for (other, other_owner) in &places[i + 1..] {
            if other.buffer != layout.buffer || other.start >= layout.end() || effort == 0 {
                break;
            }
            effort -= 1;
            if layout.overlaps(other) {
                shared.extend(*owner);
                shared.extend(*other_owner);
            }
        }
        if effort == 0 {
            shared.extend(*owner);
        }
    }
    if effort == 0 {
        // What came before may overlap what was not looked at.
        shared.extend(0..model.accessors.len());
    }
    shared
}

/// The buffer views that images and extensions refer to.
fn whole_views(root: Value<'_>) -> impl Iterator<Item = Layout> {
    let views = listed(root, "bufferViews");
    let mut numbers: Vec<usize> = Vec::new();
    let mut open: Vec<Value<'_>> = root
        .entries()
        .filter(|(key, _)| key != "accessors")
        .map(|(_, value)| value)
        .collect();
    while let Some(value) = open.pop() {
        for (key, part) in value.entries() {
            if key == "bufferView" {
                numbers.extend(part.whole());
            } else {
                open.push(part);
            }
        }
        open.extend(value.items());
    }
    numbers.sort_unstable();
    numbers.dedup();
    numbers.into_iter().filter_map(move |number| {
        let view = views.get(number)?;
        let length = view.get("byteLength")?.whole()?;
        Some(Layout {
            buffer: view.get("buffer")?.whole()?,
            start: view.get("byteOffset").map_or(Some(0), Value::whole)?,
            stride: length,
            size: length,
            count: 1,
        })
    })
}
