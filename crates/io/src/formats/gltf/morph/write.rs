//! The file: the base with targets in its meshes, weights in an animation, and new bytes behind those it has.

use super::super::container;
use super::super::json::{Edits, Kind, Value, quoted};
use super::super::write::rename;
use super::super::{Model, listed};
use super::{MorphFrames, MorphReport, MorphTarget, MorphTrack, refused};
use crate::formats::gltf::scene::Job;
use crate::{WriteError, WriteReport};
use std::collections::BTreeMap;
use std::io::Write;

/// When the frames are shown, and what they are called.
#[derive(Debug, Clone, Copy)]
pub struct MorphKeys<'a> {
    /// Seconds of each frame, ascending, at least two; rounded to 32 bits.
    pub times: &'a [f64],
    /// The name of each frame, which its target gets.
    pub names: &'a [String],
    /// The name of the animation.
    pub animation: &'a str,
}

/// Instances of a mesh that show the same all the time.
struct Group {
    mesh: usize,
    instances: Vec<usize>,
}

/// What the JSON gets.
struct Plan<'a> {
    model: &'a Model,
    edits: Edits,
    /// Meshes to be added.
    copies: Vec<String>,
    accessors: Vec<String>,
    views: Vec<String>,
    samplers: Vec<String>,
    channels: Vec<String>,
    /// Instances whose weights are animated, one for each sampler.
    animated: Vec<usize>,
    report: MorphReport,
}

/// Instances that have the same mesh and the same track.
fn groups(model: &Model, tracks: &[MorphTrack]) -> Vec<Group> {
    let mut of_mesh: BTreeMap<usize, Vec<Group>> = BTreeMap::new();
    for (number, instance) in model.instances.iter().enumerate() {
        if model.nodes_of(instance).is_empty() {
            continue;
        }
        let groups = of_mesh.entry(instance.mesh).or_default();
        let alike = groups
            .iter_mut()
            .find(|group| tracks[group.instances[0]] == tracks[number]);
        match alike {
            Some(group) => group.instances.push(number),
            None => groups.push(Group {
                mesh: instance.mesh,
                instances: vec![number],
            }),
        }
    }
    of_mesh.into_values().flatten().collect()
}

/// The times in the numbers of glTF.
fn times(keys: &MorphKeys<'_>, frames: usize) -> Result<Vec<f32>, WriteError> {
    let times: Vec<f32> = keys.times.iter().map(|time| *time as f32).collect();
    let ascending = times.windows(2).all(|pair| pair[0] < pair[1]);
    let finite = times.iter().all(|time| time.is_finite() && *time >= 0.0);
    if frames < 2 || times.len() != frames || keys.names.len() != frames || !ascending || !finite {
        return Err(refused(
            format!(
                "{frames} frames with {} times and {} names are no animation",
                times.len(),
                keys.names.len()
            ),
            "give at least two frames, each with a name and a time that 32 bits tell from the one before",
        ));
    }
    Ok(times)
}

pub(super) fn write(
    mut frames: MorphFrames<'_>,
    keys: &MorphKeys<'_>,
    written: &mut WriteReport,
    out: &mut dyn Write,
) -> Result<MorphReport, WriteError> {
    let model = &frames.base.model;
    let count = frames.tracks.first().map_or(0, |track| track.frames.len());
    let times = times(keys, count)?;
    let mut plan = Plan {
        model,
        edits: Edits::default(),
        copies: Vec::new(),
        accessors: Vec::new(),
        views: Vec::new(),
        samplers: Vec::new(),
        channels: Vec::new(),
        animated: Vec::new(),
        report: MorphReport::default(),
    };
    let groups = groups(model, &frames.tracks);
    let moving = |group: &Group| !frames.tracks[group.instances[0]].targets.is_empty();
    if !groups.iter().any(moving) {
        written.put(&model.bytes, out)?;
        return Ok(plan.report);
    }
    // Where the targets of a primitive differ in what they have, zeros make them alike.
    let mut zeros: BTreeMap<usize, usize> = BTreeMap::new();
    for group in &groups {
        let track = &frames.tracks[group.instances[0]];
        for (i, job) in model.meshes[group.mesh].jobs.iter().enumerate() {
            let mut has = track.targets.iter().map(|target| target[i].is_some());
            let wanted = matches!(job, Job::Position { .. }) || has.clone().any(|has| has);
            let count = job_count(model, group.mesh, job);
            if wanted && has.any(|has| !has) && !zeros.contains_key(&count) {
                zeros.insert(count, frames.blobs.zeros(count)?);
            }
        }
    }
    let root = model.json.root();
    let accessors = listed(root, "accessors").len();
    let mut meshes_with_original: Vec<bool> = vec![false; model.meshes.len()];
    for group in groups.iter().filter(|group| !moving(group)) {
        meshes_with_original[group.mesh] = true;
    }
    for group in groups.iter().filter(|group| moving(group)) {
        let original = !std::mem::replace(&mut meshes_with_original[group.mesh], true);
        plan.group(group, original, &frames.tracks, accessors, &zeros, keys)?;
    }

    // The new bytes: displacements, times, weights.
    let length = model.buffers.first().map_or(0, |buffer| buffer.length);
    let base = length.next_multiple_of(4) as u64;
    let views = listed(root, "bufferViews").len();
    let (mut accessor_list, view_list) = frames.blobs.described(base, views);
    plan.views = view_list;
    plan.report.accessors = frames.blobs.len();
    plan.report.sparse = frames.blobs.sparse();
    let mut at = base + frames.blobs.bytes();
    let mut scalar = |plan: &mut Plan<'_>, count: usize, bounds: String| {
        let view = views + plan.views.len();
        plan.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"SCALAR"{bounds}}}"#
        ));
        plan.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{at},"byteLength":{}}}"#,
            4 * count
        ));
        at += 4 * count as u64;
    };
    let (first, last) = (f64::from(times[0]), f64::from(times[count - 1]));
    scalar(
        &mut plan,
        count,
        format!(r#","min":[{first:?}],"max":[{last:?}]"#),
    );
    let input = accessors + accessor_list.len();
    for sampler in 0..plan.animated.len() {
        let track = &frames.tracks[plan.animated[sampler]];
        scalar(&mut plan, count * track.targets.len(), String::new());
        plan.samplers.push(format!(
            r#"{{"input":{input},"output":{},"interpolation":"LINEAR"}}"#,
            input + 1 + sampler
        ));
    }
    accessor_list.append(&mut plan.accessors);
    plan.accessors = accessor_list;

    let text = plan.finish(at, keys);
    let mut json = text.trim_end_matches([' ', '\0']).as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunks = model.chunks.as_ref();
    let rest = chunks.map_or(&[][..], |chunks| &model.bytes[chunks.rest.clone()]);
    let bin = usize::try_from(at).ok();
    let header = bin.and_then(|bin| {
        Some((
            container::glb_header(json.len(), Some(bin), rest.len())?,
            bin,
        ))
    });
    let Some((header, bin)) = header else {
        return Err(refused(
            format!("the animation takes {at} bytes, and a GLB holds at most 4294967295"),
            "take fewer frames, or write numbered files",
        ));
    };
    let report = plan.report;
    let animated = plan.animated;
    written.put(&header, out)?;
    written.put(&container::chunk_header(true, json.len()), out)?;
    written.put(&json, out)?;
    written.put(&container::chunk_header(false, bin), out)?;
    let own = chunks.and_then(|chunks| chunks.bin.clone());
    let own = own.map_or(&[][..], |range| &model.bytes[range]);
    let own = &own[..length.min(own.len())];
    written.put(own, out)?;
    written.put(&[0; 3][..base as usize - own.len()], out)?;
    frames.blobs.copy(|piece| written.put(piece, out))?;
    let bytes = |numbers: &[f32]| -> Vec<u8> {
        numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect()
    };
    written.put(&bytes(&times), out)?;
    for instance in animated {
        let track = &frames.tracks[instance];
        for shown in &track.frames {
            written.put(&bytes(&weights(track, *shown)), out)?;
        }
    }
    written.put(rest, out)?;
    Ok(report)
}

/// The weights while a target is shown.
fn weights(track: &MorphTrack, shown: Option<usize>) -> Vec<f32> {
    let mut weights = vec![0.0; track.targets.len()];
    if let Some(weight) = shown.and_then(|shown| weights.get_mut(shown)) {
        *weight = 1.0;
    }
    weights
}

/// How many elements the accessor of a job has.
fn job_count(model: &Model, mesh: usize, job: &Job) -> usize {
    let accessor = match *job {
        Job::Position { slot } => model.meshes[mesh].slots[slot],
        Job::Normal { accessor, .. }
        | Job::Tangent { accessor, .. }
        | Job::DeltaNormal { accessor, .. }
        | Job::DeltaTangent { accessor, .. } => accessor,
        Job::DeltaPosition { shadow } => model.meshes[mesh].shadows[shadow].accessor,
    };
    model.accessors[accessor].count
}

impl Plan<'_> {
    /// Gives a group's mesh its targets, and its nodes their weights.
    fn group(
        &mut self,
        group: &Group,
        original: bool,
        tracks: &[MorphTrack],
        accessors: usize,
        zeros: &BTreeMap<usize, usize>,
        keys: &MorphKeys<'_>,
    ) -> Result<(), WriteError> {
        let model = self.model;
        let root = model.json.root();
        let track = &tracks[group.instances[0]];
        let values = listed(root, "meshes");
        let value = values[group.mesh];
        let mut edits = Edits::default();
        let mesh = &model.meshes[group.mesh];
        for (number, primitive) in listed(value, "primitives").into_iter().enumerate() {
            let found = mesh.primitives.get(number);
            let Some(slot) = found.and_then(|found| found.slot) else {
                return Err(refused(
                    format!(
                        "meshes[{}].primitives[{number}] has no positions, and so no morph targets as the others get",
                        group.mesh
                    ),
                    "export the model again, or write numbered files",
                ));
            };
            let text = targets(model, group.mesh, number, slot, track, accessors, zeros);
            put(&mut edits, primitive, "targets", &text);
        }
        let first: Vec<String> = weights(track, track.frames.first().copied().flatten())
            .iter()
            .map(|weight| format!("{weight:?}"))
            .collect();
        put(
            &mut edits,
            value,
            "weights",
            &format!("[{}]", first.join(",")),
        );
        let names: Vec<String> = (0..track.targets.len())
            .map(|target| {
                let frame = track.frames.iter().position(|shown| *shown == Some(target));
                quoted(
                    frame
                        .and_then(|frame| keys.names.get(frame))
                        .map_or("", |name| name),
                )
            })
            .collect();
        let names = format!("[{}]", names.join(","));
        match value.get("extras") {
            Some(extras) if extras.kind() == Kind::Table => {
                put(&mut edits, extras, "targetNames", &names);
            }
            Some(_) => {}
            None => edits.insert(value, "extras", &format!(r#"{{"targetNames":{names}}}"#)),
        }
        self.report.targets += track.targets.len();
        let sampler = self.animated.len();
        self.animated.push(group.instances[0]);
        let nodes: Vec<usize> = group
            .instances
            .iter()
            .flat_map(|instance| model.nodes_of(&model.instances[*instance]))
            .collect();
        self.report.nodes += nodes.len();
        let node_values = listed(root, "nodes");
        let copy = values.len() + self.copies.len();
        for node in nodes {
            if !original && let Some(number) = node_values[node].get("mesh") {
                self.edits.replace(number, copy.to_string());
            }
            if let Some(own) = node_values[node].get("weights") {
                self.edits.replace(own, format!("[{}]", first.join(",")));
            }
            self.channels.push(format!(
                r#"{{"sampler":{sampler},"target":{{"node":{node},"path":"weights"}}}}"#
            ));
        }
        if original {
            self.edits.join(edits);
        } else {
            rename(&mut edits, value, model, group.instances[0]);
            self.copies
                .push(edits.apply(&model.json.text, value.span()));
        }
        Ok(())
    }

    /// The JSON with everything in it; `bytes` are those of the first buffer.
    fn finish(&mut self, bytes: u64, keys: &MorphKeys<'_>) -> String {
        let root = self.model.json.root();
        let mut buffers = Vec::new();
        match listed(root, "buffers").first() {
            Some(buffer) => put(&mut self.edits, *buffer, "byteLength", &bytes.to_string()),
            None => buffers.push(format!(r#"{{"byteLength":{bytes}}}"#)),
        }
        let animation = format!(
            r#"{{"name":{},"samplers":[{}],"channels":[{}]}}"#,
            quoted(keys.animation),
            self.samplers.join(","),
            self.channels.join(",")
        );
        let added = [
            ("meshes", &self.copies),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
            ("buffers", &buffers),
            ("animations", &vec![animation]),
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
        let text = &self.model.json.text;
        self.edits.apply(text, 0..text.len())
    }
}

/// Sets a key of a table.
fn put(edits: &mut Edits, table: Value<'_>, key: &str, value: &str) {
    match table.get(key) {
        Some(old) => edits.replace(old, value),
        None => edits.insert(table, key, value),
    }
}

/// The targets of a primitive. All have positions, and the directions that any of them changes.
fn targets(
    model: &Model,
    number: usize,
    primitive: usize,
    slot: usize,
    track: &MorphTrack,
    accessors: usize,
    zeros: &BTreeMap<usize, usize>,
) -> String {
    let mesh = &model.meshes[number];
    let normal = mesh.primitives[primitive].normal;
    let tangent = tangent(model, number, primitive);
    let wanted = mesh.jobs.iter().enumerate().filter_map(|(i, job)| {
        let name = match *job {
            Job::Position { slot: own } if own == slot => "POSITION",
            Job::Normal {
                slot: own,
                accessor,
            } if own == slot && normal == Some(accessor) => "NORMAL",
            Job::Tangent {
                slot: own,
                accessor,
                normal: beside,
            } if own == slot && tangent == Some(accessor) && beside == normal => "TANGENT",
            _ => return None,
        };
        let some = |target: &MorphTarget| target[i].is_some();
        (name == "POSITION" || track.targets.iter().any(some)).then(|| {
            let zero = zeros.get(&job_count(model, number, job)).copied();
            (i, name, zero)
        })
    });
    let wanted: Vec<(usize, &str, Option<usize>)> = wanted.collect();
    let texts = track.targets.iter().map(|target| {
        let entries = wanted.iter().filter_map(|(i, name, zero)| {
            let blob = target[*i].or(*zero)?;
            Some(format!(r#""{name}":{}"#, accessors + blob))
        });
        format!("{{{}}}", entries.collect::<Vec<_>>().join(","))
    });
    format!("[{}]", texts.collect::<Vec<_>>().join(","))
}

/// The accessor of a primitive's tangents.
fn tangent(model: &Model, mesh: usize, primitive: usize) -> Option<usize> {
    let mesh = listed(model.json.root(), "meshes").get(mesh).copied()?;
    let primitive = listed(mesh, "primitives").get(primitive).copied()?;
    primitive.get("attributes")?.get("TANGENT")?.whole()
}
