//! Frames of a warp as morph targets of a GLB, and an animation that fades from each to the next.
//!
//! The mesh stays as it is, at weights of zero; the displacement of a frame becomes a target, and the animation gives it weight 1 at the
//! frame's time. Between two frames their weights cross over in a straight line, so that every vertex goes straight from one place to the
//! next. A frame that shows the mesh as it is needs no target, frames that show the same share one, and equal displacements of different
//! meshes are stored once. Displacements of few vertices are sparse: where that takes at most half of the bytes.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, version 2.0.1, 2021: sections 3.6.2.3 "Sparse Accessors", 3.7.2.2 "Morph Targets",
//! 3.11 "Animations" (`LINEAR`). That in-betweens are straight is this module's choice; [`MorphFrames::farthest`] measures what it costs.

mod blobs;
mod write;

use super::container;
use super::content::{Frame, Movement, same};
use super::json::Json;
use super::scene::{Instance, Job};
use super::{Model, Source, listed};
use crate::{
    Companions, Document, Lost, Moved, Normals, Points, ReadOptions, WriteError, WriteReport,
};
use anamorph_core::glam::DVec3;
use blobs::Blobs;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::{Read, Seek, Write};

pub use write::MorphKeys;

/// Where the displacements wait until all are known: a temporary file, or memory (`std::io::Cursor<Vec<u8>>`).
pub trait Storage: Read + Write + Seek {}

impl<T: Read + Write + Seek> Storage for T {}

/// The GLB that targets are added to: a document's own content if it is a glTF, else what it becomes by conversion.
pub struct MorphBase<'d> {
    document: &'d dyn Document,
    model: Model,
    /// The document's point of each vertex; nothing where they are the same.
    sources: Option<Vec<u32>>,
    lost: Lost,
}

/// What [`MorphFrames::finish`] wrote.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MorphReport {
    /// Morph targets, those of all meshes together.
    pub targets: usize,
    /// Accessors of displacements, and how many of them are sparse.
    pub accessors: usize,
    /// Sparse ones among them.
    pub sparse: usize,
    /// Nodes whose weights are animated; with none there is no animation.
    pub nodes: usize,
    /// Bytes of the file.
    pub bytes: u64,
}

/// A point of the model, and how far the file has it from where the warp puts it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// The document's point, from 0.
    pub point: usize,
    /// The distance in the world.
    pub distance: f64,
}

fn refused(what: impl Into<String>, mend: &str) -> WriteError {
    WriteError::Refused {
        what: what.into(),
        mend: mend.to_owned(),
    }
}

fn parsed(
    glb: Vec<u8>,
    options: &ReadOptions,
    companions: &dyn Companions,
) -> Result<Model, WriteError> {
    let read = || {
        let chunks = container::chunks(&glb)?;
        let json = Json::read(glb[chunks.json.clone()].to_vec())?;
        Ok((chunks, json))
    };
    let failed = |error: crate::ReadError| refused(error.what, &error.mend);
    let (chunks, json) = read().map_err(failed)?;
    Model::read("glb", glb, Some(chunks), json, options, companions).map_err(failed)
}

impl<'d> MorphBase<'d> {
    /// The base of a document that was read with these options and companions. A glTF keeps everything; of another format comes along
    /// what conversion takes, see [`MorphBase::lost`].
    ///
    /// # Errors
    /// What [`Document::write_as`] or the conversion says; a GLB whose first buffer is in a file that is not at hand.
    pub fn of(
        document: &'d dyn Document,
        options: &ReadOptions,
        companions: &dyn Companions,
    ) -> Result<Self, WriteError> {
        let rest = Moved::new(document.points());
        let mut glb = Vec::new();
        if !matches!(document.format(), "glb" | "gltf") {
            let geometry = document.geometry(&rest)?;
            let (lost, sources) = super::super::gltf_create::create_traced(&geometry, &mut glb)?;
            let options = ReadOptions::default().allow_nonfinite(true);
            return Ok(Self {
                document,
                model: parsed(glb, &options, companions)?,
                sources: Some(sources),
                lost,
            });
        }
        document.write_as("glb", &rest, &mut glb)?;
        let mut model = parsed(glb, options, companions)?;
        if !model.has_room() {
            // As a text the first buffer is where a GLB is made from.
            let (mut text, mut glb) = (Vec::new(), Vec::new());
            document.write_as("gltf", &rest, &mut text)?;
            let read = |text| {
                let json = Json::read(text)?;
                Model::read("gltf", Vec::new(), None, json, options, companions)
            };
            let text = read(text).map_err(|error| refused(error.what, &error.mend))?;
            text.write_as("glb", &Moved::new(text.points()), &mut glb)?;
            model = parsed(glb, options, companions)?;
        }
        if !model.has_room() {
            return Err(refused(
                "the model's first buffer is not at hand, so that nothing can be added to it",
                "put the file that it refers to beside the model",
            ));
        }
        Ok(Self {
            document,
            model,
            sources: None,
            lost: Lost::default(),
        })
    }

    /// What the document holds and the GLB does not.
    #[must_use]
    pub fn lost(&self) -> &Lost {
        &self.lost
    }

    /// Vertices of the nodes' meshes, which a frame moves.
    #[must_use]
    pub fn vertices(&self) -> usize {
        let instances = self.animated();
        let counts = instances.flat_map(|instance| &self.model.meshes[instance.mesh].slots);
        counts.map(|slot| self.model.accessors[*slot].count).sum()
    }

    /// The most bytes that this many frames can take: each with a displacement of its own for every vertex, normal and tangent.
    #[must_use]
    pub fn most_bytes(&self, frames: usize) -> u64 {
        let frames = frames as u64;
        let mut bytes = self.model.bytes.len() as u64;
        for instance in self.animated() {
            let mesh = &self.model.meshes[instance.mesh];
            let counts = mesh.jobs.iter().map(|job| match *job {
                Job::Position { slot } => self.model.accessors[mesh.slots[slot]].count,
                Job::Normal { accessor, .. } | Job::Tangent { accessor, .. } => {
                    self.model.accessors[accessor].count
                }
                _ => 0,
            });
            let displaced = 12 * counts.sum::<usize>() as u64;
            let weights = frames.saturating_mul(4);
            bytes = bytes.saturating_add(frames.saturating_mul(displaced.saturating_add(weights)));
        }
        bytes
    }

    fn animated(&self) -> impl Iterator<Item = &Instance> {
        let instances = self.model.instances.iter();
        instances.filter(|instance| !self.model.nodes_of(instance).is_empty())
    }

    /// The document's point that a point of the model is.
    fn source(&self, point: usize) -> usize {
        match &self.sources {
            Some(sources) => sources.get(point).map_or(point, |source| *source as usize),
            None => point,
        }
    }

    /// Begins the frames; `storage` is empty.
    pub fn frames<'a>(&'a self, storage: &'a mut dyn Storage) -> MorphFrames<'a> {
        let instances = self.model.instances.len();
        MorphFrames {
            base: self,
            data: self.model.data(),
            blobs: Blobs::new(storage),
            tracks: (0..instances).map(|_| MorphTrack::default()).collect(),
            known: vec![HashMap::new(); instances],
            last: [Vec::new(), Vec::new()],
        }
    }
}

impl Model {
    /// Whether data can be added to the BIN chunk: it is the first buffer, or there is none.
    fn has_room(&self) -> bool {
        let first = self.buffers.first();
        first.is_none_or(|buffer| matches!(buffer.source, Source::Chunk))
    }

    /// The nodes that show an instance: its own, or, in local coordinates, all that have its mesh.
    fn nodes_of(&self, instance: &Instance) -> Vec<usize> {
        if let Some(node) = instance.node {
            return vec![node];
        }
        let having =
            |(i, node): (usize, &super::Node)| (node.mesh == Some(instance.mesh)).then_some(i);
        if self.local {
            self.nodes.iter().enumerate().filter_map(having).collect()
        } else {
            Vec::new()
        }
    }
}

/// Displacements of a target by job of the mesh, as numbers of blobs; nothing for one that is zero.
type MorphTarget = Vec<Option<usize>>;

/// The targets of an instance, and which of them each frame shows; nothing for the mesh as it is.
#[derive(Default, PartialEq)]
struct MorphTrack {
    targets: Vec<MorphTarget>,
    frames: Vec<Option<usize>>,
}

/// Displacements of the positions of an instance, by slot; nothing where all are zero.
type Displaced = Vec<Option<Vec<[f32; 3]>>>;

/// Frames on their way into a file. Of positions only the last two frames are held.
pub struct MorphFrames<'a> {
    base: &'a MorphBase<'a>,
    data: Vec<&'a [u8]>,
    blobs: Blobs<'a>,
    /// By instance.
    tracks: Vec<MorphTrack>,
    /// The number of each target, by instance.
    known: Vec<HashMap<MorphTarget, usize>>,
    /// Of the frame before and of this one, by instance.
    last: [Vec<Displaced>; 2],
}

fn to_f32(value: DVec3) -> [f32; 3] {
    // Adding 0 turns −0 into 0.
    value.to_array().map(|x| x as f32 + 0.0)
}

impl MorphFrames<'_> {
    /// Adds the next frame: the document's points, moved.
    ///
    /// # Errors
    /// As [`Document::write`]; a mesh that moves and has morph targets of its own; [`WriteError::Output`] where the storage fails.
    pub fn add(&mut self, moved: &Moved<'_>) -> Result<(), WriteError> {
        let base = self.base;
        let model = &base.model;
        base.document.points().check(&moved.points)?;
        let new = self.places(&moved.points);
        let source =
            |map: crate::NormalMap<'_>, vertex: usize, old: DVec3| map(base.source(vertex), old);
        let normals = moved.normals;
        let carry = |vertex: usize, old: DVec3| match normals {
            Normals::Transform(map) => source(map, vertex, old),
            _ => old,
        };
        let tangents = moved.tangents;
        let along = |vertex: usize, old: DVec3| match tangents {
            Some(map) => source(map, vertex, old),
            None => old,
        };
        let movement = Movement {
            model,
            data: self.data.clone(),
            new: &new,
            normals: match normals {
                Normals::Transform(_) => Normals::Transform(&carry),
                other => other,
            },
            tangents: tangents.is_some().then_some(&along as crate::NormalMap<'_>),
        };
        let mut displaced: Vec<Displaced> = Vec::with_capacity(model.instances.len());
        for (number, instance) in model.instances.iter().enumerate() {
            let mesh = &model.meshes[instance.mesh];
            let mut places: Displaced = vec![None; mesh.slots.len()];
            let mut target: MorphTarget = Vec::with_capacity(mesh.jobs.len());
            if !model.nodes_of(instance).is_empty() {
                let (outcome, _) = movement.outcome(instance)?;
                if mesh.targets > 0 && outcome.iter().any(Option::is_some) {
                    return Err(own_targets(model, instance.mesh));
                }
                for (job, content) in mesh.jobs.iter().zip(&outcome) {
                    let Some(content) = content else {
                        target.push(None);
                        continue;
                    };
                    let values = match *job {
                        Job::Position { slot } => {
                            displacements(model, &self.data, instance, slot, &new)?
                        }
                        Job::Normal { accessor, .. } => {
                            let old = model.accessors[accessor].elements::<3, f64>(&self.data);
                            differences(&old, content)
                        }
                        Job::Tangent { accessor, .. } => {
                            let old = model.accessors[accessor].elements::<4, f64>(&self.data);
                            differences(&old, content)
                        }
                        _ => Vec::new(),
                    };
                    target.push(self.blobs.add(&values)?);
                    if let Job::Position { slot } = *job {
                        places[slot] = Some(values);
                    }
                }
            }
            displaced.push(places);
            let track = &mut self.tracks[number];
            let still = target.iter().all(Option::is_none);
            let shown = (!still).then(|| {
                *self.known[number]
                    .entry(target)
                    .or_insert_with_key(|target| {
                        track.targets.push(target.clone());
                        track.targets.len() - 1
                    })
            });
            track.frames.push(shown);
        }
        self.last.swap(0, 1);
        self.last[1] = displaced;
        Ok(())
    }

    /// Where the vertices of the base go. One whose point has not moved stays, whatever the base rounds.
    fn places<'p>(&self, moved: &Points<'p>) -> Cow<'p, [DVec3]> {
        let new = moved.solid();
        let Some(sources) = &self.base.sources else {
            return new;
        };
        let rest = self.base.document.points();
        let rest = rest.solid();
        let vertices = sources.iter().zip(&self.base.model.points);
        let place = |(&source, &vertex): (&u32, &DVec3)| {
            let source = source as usize;
            if same(rest[source], new[source]) {
                vertex
            } else {
                new[source]
            }
        };
        vertices.map(place).collect()
    }

    /// The largest distance, over the vertices that nodes show, between where the file has a point at a share of the way from the frame
    /// before to the last one added (1 is the last) and where it has been moved to. The file's numbers are taken as they are, rounded to 32
    /// bits, and added without rounding.
    #[must_use]
    pub fn farthest(&self, share: f64, moved: &Points<'_>) -> Option<Farthest> {
        let model = &self.base.model;
        let new = moved.solid();
        let mut worst: Option<Farthest> = None;
        for (number, instance) in model.instances.iter().enumerate() {
            if model.nodes_of(instance).is_empty() {
                continue;
            }
            for (slot, start) in instance.starts.iter().enumerate() {
                let of = |frame: usize| self.last[frame].get(number)?.get(slot)?.as_deref();
                let (before, after) = (of(0), of(1));
                let count = model.accessors[model.meshes[instance.mesh].slots[slot]].count;
                for vertex in 0..count {
                    let at = |list: Option<&[[f32; 3]]>| {
                        let found = list.and_then(|list| list.get(vertex));
                        found.map_or(DVec3::ZERO, |d| DVec3::from_array(d.map(f64::from)))
                    };
                    let mut displaced = at(after) * share;
                    if share < 1.0 {
                        displaced += at(before) * (1.0 - share);
                    }
                    if let Some(world) = instance.world {
                        displaced = world.transform_vector3(displaced);
                    }
                    let point = self.base.source(start + vertex);
                    let file = model.points[start + vertex] + displaced;
                    let Some(distance) = new.get(point).map(|new| file.distance(*new)) else {
                        continue;
                    };
                    if worst.is_none_or(|worst| distance > worst.distance) {
                        worst = Some(Farthest { point, distance });
                    }
                }
            }
        }
        worst
    }
}

/// The displacements of a slot's vertices in the coordinates of the mesh.
fn displacements(
    model: &Model,
    data: &[&[u8]],
    instance: &Instance,
    slot: usize,
    new: &[DVec3],
) -> Result<Vec<[f32; 3]>, WriteError> {
    let start = instance.starts[slot];
    let accessor = &model.accessors[model.meshes[instance.mesh].slots[slot]];
    let mut old = accessor.points(data);
    let frame = Frame::of(instance.world);
    let mut values = Vec::with_capacity(old.len());
    for (vertex, old) in old.drain(..).enumerate() {
        let (from, to) = (model.points[start + vertex], new[start + vertex]);
        let moves = !same(from, to) && from.is_finite();
        let value = match &frame {
            Some(frame) if moves => to_f32(frame.back(to) - old),
            _ => [0.0; 3],
        };
        if !value.iter().all(|x| x.is_finite()) {
            return Err(refused(
                format!(
                    "vertex {vertex} (from 0) moves farther than the numbers that glTF can hold"
                ),
                "scale the model down, or mask the warp there",
            ));
        }
        values.push(value);
    }
    Ok(values)
}

/// What has to be added to directions to get the new ones.
fn differences<const N: usize>(old: &[[f64; N]], new: &super::content::Content) -> Vec<[f32; 3]> {
    let pairs = old.iter().zip(new.numbers.chunks_exact(N));
    pairs
        .map(|(old, new)| {
            let part = |axis: usize| f64::from(new[axis]) - old[axis];
            let value = to_f32(DVec3::new(part(0), part(1), part(2)));
            if value.iter().all(|x| x.is_finite()) {
                value
            } else {
                [0.0; 3]
            }
        })
        .collect()
}

fn own_targets(model: &Model, mesh: usize) -> WriteError {
    let value = listed(model.json.root(), "meshes").get(mesh).copied();
    let name = value.and_then(|value| Some(value.get("name")?.text()?.into_owned()));
    let name = name.map_or(String::new(), |name| format!(" ({name:?})"));
    refused(
        format!(
            "meshes[{mesh}]{name} has {} morph targets of its own, and a mesh that changes its form as it is warped cannot be shown by adding more",
            model.meshes[mesh].targets
        ),
        "write numbered files (such as out.%04d.glb), mask the warp there, or export the model without them",
    )
}

impl MorphFrames<'_> {
    /// Writes the base with the targets, and an animation with one key a frame.
    ///
    /// # Errors
    /// Keys that are not one a frame; more than 4 GiB; [`WriteError::Output`].
    pub fn finish(
        self,
        keys: &MorphKeys<'_>,
        out: &mut dyn Write,
    ) -> Result<MorphReport, WriteError> {
        let mut written = WriteReport::default();
        let mut report = write::write(self, keys, &mut written, out)?;
        report.bytes = written.bytes;
        Ok(report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NoCompanions, read};
    use std::io::Cursor;

    fn fixture(name: &str) -> Vec<u8> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/valid/");
        std::fs::read(format!("{folder}{name}")).unwrap()
    }

    fn points(document: &dyn Document) -> Vec<DVec3> {
        document.points().solid().into_owned()
    }

    /// Three frames of which the second and third are moved by these.
    fn film(
        document: &dyn Document,
        moves: [&dyn Fn(DVec3) -> DVec3; 2],
        times: &[f64],
    ) -> Result<(Vec<u8>, MorphReport), WriteError> {
        let base = MorphBase::of(document, &ReadOptions::default(), &NoCompanions)?;
        let mut storage = Cursor::new(Vec::new());
        let mut frames = base.frames(&mut storage);
        let rest = points(document);
        frames.add(&Moved::new(Points::Solid(&rest)))?;
        for step in moves {
            let new: Vec<DVec3> = rest.iter().map(|p| step(*p)).collect();
            frames.add(&Moved::new(Points::Solid(&new)))?;
            let found = frames.farthest(1.0, &Points::Solid(&new)).unwrap();
            assert!(found.distance < 1e-6, "{found:?}");
        }
        let names = ["a", "b", "c"].map(str::to_owned);
        let keys = MorphKeys {
            times,
            names: &names,
            animation: "quotes \"too\"",
        };
        let mut out = Vec::new();
        let report = frames.finish(&keys, &mut out)?;
        assert_eq!(report.bytes, out.len() as u64);
        Ok((out, report))
    }

    #[test]
    fn a_binary_whose_buffer_is_in_its_text_gets_a_chunk() {
        let mut json = fixture("gltf-sparse.gltf");
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut glb = container::glb_header(json.len(), None, 0).unwrap();
        glb.extend(container::chunk_header(true, json.len()));
        glb.extend(json);
        let document = read(glb, None, &ReadOptions::default()).unwrap();
        assert_eq!(document.format(), "glb");
        let lift = |p: DVec3| p + DVec3::Y;
        let (out, report) = film(document.as_ref(), [&lift, &lift], &[0.0, 1.0, 2.0]).unwrap();
        // Both frames show the same; a lift in the world is another one in each turned node, or the same.
        assert!(
            report.nodes >= 1 && report.targets <= report.nodes,
            "{report:?}"
        );
        let again = read(out.clone(), None, &ReadOptions::default()).unwrap();
        let count = document.visible();
        assert_eq!(
            points(again.as_ref())[..count],
            points(document.as_ref())[..count]
        );
        let other = gltf::Gltf::from_slice(&out).unwrap();
        assert_eq!(other.animations().len(), 1);
    }

    #[test]
    fn few_moving_vertices_are_stored_sparsely_with_indices_as_small_as_they_can_be() {
        for (count, size) in [(200_usize, 1), (300, 2), (70_000, 4)] {
            let mut values = vec![[0.0; 3]; count];
            values[7] = [1.0, 0.0, -2.0];
            values[count - 1] = [0.0, 3.0, 0.0];
            let mut storage = Cursor::new(Vec::new());
            let mut blobs = Blobs::new(&mut storage);
            assert_eq!(blobs.add(&vec![[0.0; 3]; count]).unwrap(), None);
            assert_eq!(blobs.add(&values).unwrap(), Some(0));
            assert_eq!(blobs.add(&values).unwrap(), Some(0));
            let bytes = (2_usize * size).next_multiple_of(4) + 24;
            assert_eq!(blobs.bytes(), bytes as u64);
            let (accessors, views) = blobs.described(100, 5);
            assert!(
                accessors[0].contains(r#""min":[0,0,-2],"max":[1,3,0]"#),
                "{accessors:?}"
            );
            assert!(accessors[0].contains(r#""sparse":{"count":2,"indices":{"bufferView":5"#));
            assert_eq!(views.len(), 2);
            // More than half of the vertices take the room of all.
            let many = vec![[1.0, 2.0, 3.0]; count];
            assert_eq!(blobs.add(&many).unwrap(), Some(1));
            assert_eq!(blobs.bytes(), (bytes + 12 * count) as u64);
            assert_eq!(blobs.sparse(), 1);
        }
    }

    #[test]
    fn keys_that_are_none_are_refused() {
        let document = read(
            fixture("tetrahedron-ascii.stl"),
            None,
            &ReadOptions::default(),
        );
        let document = document.unwrap();
        let lift = |p: DVec3| p + DVec3::Y;
        for times in [
            &[0.0, 1.0][..],
            &[0.0, 0.0, 1.0],
            &[0.0, 1.0, f64::NAN],
            &[-1.0, 0.0, 1.0],
        ] {
            let error = film(document.as_ref(), [&lift, &lift], times).unwrap_err();
            assert!(error.to_string().contains("no animation"), "{error}");
        }
        let far = |p: DVec3| p * 1e300;
        assert!(film(document.as_ref(), [&lift, &far], &[0.0, 1.0, 2.0]).is_err());
        film(document.as_ref(), [&lift, &lift], &[0.0, 1.0, 2.0]).unwrap();
    }
}
