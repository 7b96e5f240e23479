//! glTF 2.0, as JSON (`.gltf`) and as a binary file (`.glb`).
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, version 2.0.1, 2021 (ISO/IEC 12113:2022), and the extension
//! `KHR_mesh_quantization`. Where it leaves a choice:
//!
//! - Points are the vertices of every mesh as its node places it in the world, a mesh of several nodes once for each, in the
//!   order of the nodes; then meshes that no node has, as they are. [`ReadOptions::local`] gives every mesh once, in its own
//!   coordinates.
//! - Skinned meshes are in their bind pose, placed as their first joint places it.
//! - Behind those points come the places that morph targets lead vertices to, for each vertex that a target moves. The new
//!   delta of a target is the difference of the two moved points, so that the morphed model is the warped one at weight 1.
//! - Nothing but what has to change does: the JSON is kept as text and edited where it stands, and buffers are rewritten in
//!   place where an accessor has its bytes for itself. Where it has not (shared, sparse or quantized data), new data is
//!   added at the end of the buffer, or in a buffer of its own. Files beside a `.gltf` are never changed.
//! - Compressed geometry (`KHR_draco_mesh_compression`, `EXT_meshopt_compression`) is refused.

mod accessor;
mod container;
mod content;
mod elements;
mod geometry;
mod inspect;
mod json;
pub(crate) mod morph;
mod normals;
mod numbers;
mod scene;
#[cfg(test)]
mod tests;
mod write;

use crate::{
    Companions, Document, Format, Inspection, Mesh, Moved, NoCompanions, Points, ReadError,
    ReadErrorKind, ReadOptions, Recognition, WriteError, WriteReport,
};
use accessor::Accessor;
use anamorph_core::glam::DVec3;
use container::Chunks;
use core::fmt;
use core::ops::Range;
use json::{Json, Kind, Value};
use scene::{Instance, Node};
use std::io::Write;

/// The text format.
pub(crate) struct Gltf;
/// The binary format.
pub(crate) struct Glb;

/// A place in the JSON: `accessors[3]`.
struct At<'a>(&'a str, usize);

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}]", self.0, self.1)
    }
}

/// An error about what the JSON says.
fn fail(kind: ReadErrorKind, what: impl Into<String>) -> ReadError {
    ReadError::new(
        kind,
        what,
        "export the model again, or correct it in the JSON",
    )
}

/// Where the content of a buffer is.
enum Source {
    /// In the BIN chunk.
    Chunk,
    /// In the JSON; the text before the content, up to the comma.
    Data { head: String },
    /// In a file beside this one.
    File,
    /// Nowhere: extensions use such buffers as placeholders.
    Nowhere,
}

struct Buffer {
    source: Source,
    /// As the JSON says; the content is at least as long.
    length: usize,
    /// Content of a buffer that is needed and not in the BIN chunk.
    content: Vec<u8>,
}

/// A glTF in memory.
struct Model {
    format: &'static str,
    /// A GLB as it was read; of a text nothing, because it is all in `json`.
    bytes: Vec<u8>,
    chunks: Option<Chunks>,
    json: Json,
    buffers: Vec<Buffer>,
    accessors: Vec<Accessor>,
    nodes: Vec<Node>,
    meshes: Vec<scene::Mesh>,
    instances: Vec<Instance>,
    points: Vec<DVec3>,
    visible: usize,
    nonfinite: Vec<usize>,
    companions: Vec<String>,
    local: bool,
}

/// Points and corners that a small file may place by instances and by accessors without bytes, and how many more for each of
/// its bytes: a scene that repeats its meshes has room, and memory stays in proportion to the file.
const FREE: usize = 1 << 22;
const PER_BYTE: usize = 4;

/// Extensions that keep geometry where we do not read it.
const COMPRESSED: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

impl Format for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }
    fn title(&self) -> &'static str {
        "glTF 2.0"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["gltf"]
    }
    fn recognises(&self, head: &[u8]) -> Recognition {
        const KEYS: [&[u8]; 7] = [
            b"\"asset\"",
            b"\"accessors\"",
            b"\"bufferViews\"",
            b"\"buffers\"",
            b"\"meshes\"",
            b"\"nodes\"",
            b"\"scenes\"",
        ];
        let head = head
            .strip_prefix(crate::text::BYTE_ORDER_MARK)
            .unwrap_or(head)
            .trim_ascii_start();
        if !head.starts_with(b"{") {
            return Recognition::No;
        }
        let found = KEYS
            .iter()
            .filter(|key| memchr::memmem::find(head, key).is_some());
        match found.count() {
            0 => Recognition::No,
            1 => Recognition::Possible,
            _ => Recognition::Certain,
        }
    }
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        self.read_with(bytes, options, &NoCompanions)
    }
    fn read_with(
        &self,
        bytes: Vec<u8>,
        options: &ReadOptions,
        companions: &dyn Companions,
    ) -> Result<Box<dyn Document>, ReadError> {
        if let Some(error) = crate::text::is_wide(&bytes)
            .then(|| crate::text::encoding_error(&bytes, "JSON"))
            .flatten()
        {
            return Err(error);
        }
        let json = Json::read(bytes)?;
        Ok(Box::new(Model::read(
            self.name(),
            Vec::new(),
            None,
            json,
            options,
            companions,
        )?))
    }
}

impl Format for Glb {
    fn name(&self) -> &'static str {
        "glb"
    }
    fn title(&self) -> &'static str {
        "glTF 2.0, binary"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["glb"]
    }
    fn recognises(&self, head: &[u8]) -> Recognition {
        if head.starts_with(container::MAGIC) {
            Recognition::Certain
        } else {
            Recognition::No
        }
    }
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        self.read_with(bytes, options, &NoCompanions)
    }
    fn read_with(
        &self,
        bytes: Vec<u8>,
        options: &ReadOptions,
        companions: &dyn Companions,
    ) -> Result<Box<dyn Document>, ReadError> {
        let chunks = container::chunks(&bytes)?;
        let json = Json::read(bytes[chunks.json.clone()].to_vec())?;
        Ok(Box::new(Model::read(
            self.name(),
            bytes,
            Some(chunks),
            json,
            options,
            companions,
        )?))
    }
}

/// The values of a list of the root; none if there is no such list.
fn listed<'a>(root: Value<'a>, key: &str) -> Vec<Value<'a>> {
    root.get(key)
        .map(|list| list.items().collect())
        .unwrap_or_default()
}

/// Refuses what is not glTF 2, and geometry that is compressed.
fn check_kind(root: Value<'_>, meshes: &[Value<'_>], views: &[Value<'_>]) -> Result<(), ReadError> {
    if root.kind() != Kind::Table {
        return Err(fail(
            ReadErrorKind::Shape,
            "the JSON is no table of keys, so it is no glTF",
        ));
    }
    let Some(version) = root
        .get("asset")
        .and_then(|asset| asset.get("version")?.text())
    else {
        return Err(fail(
            ReadErrorKind::Header,
            "there is no `asset` with a `version`, so it is no glTF",
        ));
    };
    if !version.starts_with("2.") {
        return Err(ReadError::new(
            ReadErrorKind::Unsupported,
            format!("the file is glTF {version:?}"),
            "convert it to glTF 2.0",
        ));
    }
    let has = |value: &Value<'_>, name: &str| {
        value
            .get("extensions")
            .is_some_and(|extensions| extensions.get(name).is_some())
    };
    for name in COMPRESSED {
        let required = listed(root, "extensionsRequired");
        let required = required
            .iter()
            .any(|value| value.text().is_some_and(|text| text == name));
        let mut primitives = meshes
            .iter()
            .filter_map(|mesh| mesh.get("primitives"))
            .flat_map(Value::items);
        if required
            || primitives.any(|primitive| has(&primitive, name))
            || views.iter().any(|view| has(view, name))
        {
            return Err(ReadError::new(
                ReadErrorKind::Unsupported,
                format!("the geometry is compressed by {name}"),
                "export the model without compression, or decompress it (`npx @gltf-transform/cli copy IN OUT` does)",
            ));
        }
    }
    Ok(())
}

impl Model {
    fn read(
        format: &'static str,
        bytes: Vec<u8>,
        chunks: Option<Chunks>,
        json: Json,
        options: &ReadOptions,
        companions: &dyn Companions,
    ) -> Result<Self, ReadError> {
        let root = json.root();
        let lists = ["meshes", "bufferViews", "accessors", "nodes", "buffers"];
        let [mesh_list, view_list, accessor_list, node_list, buffer_list] =
            lists.map(|key| listed(root, key));
        check_kind(root, &mesh_list, &view_list)?;
        let lengths = scene::buffer_lengths(&buffer_list)?;
        let views = accessor::views(&view_list, &lengths)?;
        let accessors = accessor::accessors(&accessor_list, &views)?;
        let meshes = scene::meshes(&mesh_list, &accessors)?;
        let nodes = scene::nodes(&node_list, meshes.len())?;
        let skins = scene::skins(&listed(root, "skins"), &nodes, &accessors)?;
        if let Some((i, node)) = nodes
            .iter()
            .enumerate()
            .find(|(_, node)| node.skin.is_some_and(|skin| skin >= skins.len()))
        {
            let skin = node.skin.unwrap_or_default();
            return Err(fail(
                ReadErrorKind::Reference,
                format!("nodes[{i}] has skin {skin}, and there are {}", skins.len()),
            ));
        }
        let needed = scene::needed_buffers(&meshes, &skins, &accessors, lengths.len());

        let bin = chunks.as_ref().and_then(|chunks| chunks.bin.clone());
        let mut buffers = Vec::with_capacity(lengths.len());
        let mut names = Vec::new();
        for (i, value) in buffer_list.iter().enumerate() {
            let buffer = Buffer::read(*value, i, lengths[i], needed[i], bin.clone(), companions)?;
            if matches!(buffer.source, Source::File) {
                names.extend(value.get("uri").and_then(file_name));
            }
            buffers.push(buffer);
        }
        let images = listed(root, "images");
        names.extend(
            images
                .iter()
                .filter_map(|image| file_name(image.get("uri")?)),
        );
        names.sort_unstable();
        names.dedup();

        let mut model = Self {
            format,
            bytes,
            chunks,
            buffers,
            accessors,
            instances: Vec::new(),
            nodes,
            meshes,
            points: Vec::new(),
            visible: 0,
            nonfinite: Vec::new(),
            companions: names,
            local: options.local,
            json,
        };
        let binds = scene::bind_places(&skins, &model.nodes, &model.accessors, &model.data());
        model.instances = scene::instances(&model.nodes, &model.meshes, &binds, model.local);
        model.check_sizes()?;
        model.check_content(options)?;
        model.find_points();
        model.check_points(options)?;
        Ok(model)
    }

    /// The content of every buffer, as far as it is needed.
    fn data(&self) -> Vec<&[u8]> {
        let bin = self.chunks.as_ref().and_then(|chunks| chunks.bin.clone());
        let bin = bin.map_or(&[][..], |range| &self.bytes[range]);
        self.buffers
            .iter()
            .map(|buffer| match buffer.source {
                Source::Chunk => &bin[..buffer.length.min(bin.len())],
                _ => &buffer.content[..],
            })
            .collect()
    }

    /// Bounds points and corners by what the file really holds.
    fn check_sizes(&self) -> Result<(), ReadError> {
        let contents: usize = self.buffers.iter().map(|b| b.content.len()).sum();
        let held = self.bytes.len() + self.json.text.len() + contents;
        let allowed = held
            .saturating_mul(PER_BYTE)
            .saturating_add(FREE)
            .min(u32::MAX as usize - 1);
        let (mut points, mut corners) = (0usize, 0usize);
        for instance in &self.instances {
            let mesh = &self.meshes[instance.mesh];
            let deltas = mesh.shadows.iter().map(|shadow| shadow.accessor);
            // Directions that are carried take as much as the points they belong to, those of targets most of all.
            let directions = mesh.jobs.iter().filter_map(|job| match job {
                scene::Job::DeltaNormal { accessor, .. }
                | scene::Job::DeltaTangent { accessor, .. } => Some(*accessor),
                _ => None,
            });
            let held = mesh.slots.iter().copied().chain(deltas).chain(directions);
            let counts = held.map(|accessor| self.accessors[accessor].count);
            points = counts.fold(points, usize::saturating_add);
            corners = corners.saturating_add(mesh.corners);
        }
        if points.max(corners) > allowed {
            let (what, number) = if points > corners {
                ("vertices", points)
            } else {
                ("corners of faces", corners)
            };
            return Err(ReadError::new(
                ReadErrorKind::TooLarge,
                format!(
                    "the scene has {number} {what}, far more than a file of {held} bytes should"
                ),
                "check the counts of its accessors; if meshes are meant to be repeated so often, use the recipe key `space = \"local\"`",
            ));
        }
        Ok(())
    }

    /// Checks what only the bytes tell: indices.
    fn check_content(&self, options: &ReadOptions) -> Result<(), ReadError> {
        let data = self.data();
        for i in scene::mesh_accessors(&self.meshes) {
            self.accessors[i].check_sparse(&data, &At("accessors", i))?;
        }
        if options.allow_broken_elements {
            return Ok(());
        }
        for (m, mesh) in self.meshes.iter().enumerate() {
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                if let Some((highest, count)) = self.beyond(mesh, primitive, &data) {
                    return Err(ReadError::new(
                        ReadErrorKind::Element,
                        format!(
                            "meshes[{m}].primitives[{p}] has a corner at vertex {highest} (from 0), and there are {count} vertices"
                        ),
                        "export the model again; `anamorph inspect` says more",
                    ));
                }
            }
        }
        Ok(())
    }

    /// The highest index of a primitive and the number of its vertices, if there is no such vertex.
    fn beyond(
        &self,
        mesh: &scene::Mesh,
        primitive: &scene::Primitive,
        data: &[&[u8]],
    ) -> Option<(u32, usize)> {
        let count = self.accessors[mesh.slots[primitive.slot?]].count;
        let highest = self.accessors[primitive.indices?].highest(data)?;
        (highest as usize >= count).then_some((highest, count))
    }

    /// The points of all instances, then those that morph targets lead to.
    fn find_points(&mut self) {
        let mut points: Vec<DVec3> = Vec::new();
        let mut starts = Vec::with_capacity(self.instances.len());
        let data = self.data();
        for instance in &self.instances {
            let mut own = Vec::new();
            for slot in &self.meshes[instance.mesh].slots {
                own.push(points.len());
                let mut found = self.accessors[*slot].points(&data);
                if let Some(world) = instance.world {
                    for point in &mut found {
                        *point = world.transform_point3(*point);
                    }
                }
                if points.is_empty() {
                    points = found;
                } else {
                    points.extend(found);
                }
            }
            starts.push(own);
        }
        let visible = points.len();
        let mut vertices = Vec::with_capacity(self.meshes.len());
        for mesh in &self.meshes {
            let moves = mesh.shadows.iter().map(|shadow| {
                let deltas: Vec<[f32; 3]> = self.accessors[shadow.accessor].elements(&data);
                let moving = deltas.iter().enumerate().filter(|(_, d)| **d != [0.0; 3]);
                moving.map(|(i, _)| i as u32).collect::<Vec<u32>>()
            });
            vertices.push(moves.collect::<Vec<_>>());
        }
        let mut shadow_starts = Vec::with_capacity(self.instances.len());
        for instance in &self.instances {
            let mesh = &self.meshes[instance.mesh];
            let mut own = Vec::new();
            for (shadow, moving) in mesh.shadows.iter().zip(&vertices[instance.mesh]) {
                own.push(points.len());
                if moving.is_empty() {
                    continue;
                }
                let base = self.accessors[mesh.slots[shadow.slot]].points(&data);
                let deltas = self.accessors[shadow.accessor].points(&data);
                points.extend(moving.iter().map(|&i| {
                    let point = base[i as usize] + deltas[i as usize];
                    match instance.world {
                        Some(world) => world.transform_point3(point),
                        None => point,
                    }
                }));
            }
            shadow_starts.push(own);
        }
        self.points = points;
        self.visible = visible;
        for (mesh, moving) in self.meshes.iter_mut().zip(vertices) {
            for (shadow, moving) in mesh.shadows.iter_mut().zip(moving) {
                shadow.vertices = moving;
            }
        }
        for ((instance, starts), shadows) in
            self.instances.iter_mut().zip(starts).zip(shadow_starts)
        {
            instance.starts = starts;
            instance.shadow_starts = shadows;
        }
    }

    /// Refuses files without points, and points that are not finite.
    fn check_points(&mut self, options: &ReadOptions) -> Result<(), ReadError> {
        if self.visible == 0 {
            return Err(ReadError::new(
                ReadErrorKind::NoPoints,
                "there are no meshes with positions in it",
                "check what was exported",
            ));
        }
        let bad = self
            .points
            .iter()
            .enumerate()
            .filter(|(_, p)| !p.is_finite());
        self.nonfinite = bad.map(|(i, _)| i).collect();
        match self.nonfinite.first() {
            Some(&first) if !options.allow_nonfinite => Err(ReadError::new(
                ReadErrorKind::NonFinite,
                format!(
                    "{} has a NaN or infinite coordinate",
                    self.name_of_point(first)
                ),
                "mend it in the model, or pass such points through (--allow-nonfinite)",
            )),
            _ => Ok(()),
        }
    }

    /// A point in the file's own terms.
    fn name_of_point(&self, index: usize) -> String {
        for instance in &self.instances {
            let mesh = &self.meshes[instance.mesh];
            for (start, slot) in instance.starts.iter().zip(&mesh.slots) {
                if (*start..start + self.accessors[*slot].count).contains(&index) {
                    let vertex = index - start;
                    return format!("vertex {vertex} (from 0) of {}", At("accessors", *slot));
                }
            }
            for (start, shadow) in instance.shadow_starts.iter().zip(&mesh.shadows) {
                if let Some(vertex) = index
                    .checked_sub(*start)
                    .and_then(|i| shadow.vertices.get(i))
                {
                    let accessor = At("accessors", shadow.accessor);
                    return format!(
                        "vertex {vertex} (from 0) moved by the morph target {accessor}"
                    );
                }
            }
        }
        format!("point {}", index + 1)
    }
}

/// The name of a file beside this one, if that is what a URI means.
fn file_name(uri: Value<'_>) -> Option<String> {
    let uri = uri.text()?;
    if container::data_start(&uri).is_some() || is_remote(&uri) {
        return None;
    }
    String::from_utf8(container::unescaped(&uri)).ok()
}

/// Whether a URI has a scheme, such as `https:`.
fn is_remote(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.len() > 1
            && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    })
}

impl Buffer {
    fn read(
        value: Value<'_>,
        number: usize,
        length: usize,
        needed: bool,
        bin: Option<Range<usize>>,
        companions: &dyn Companions,
    ) -> Result<Self, ReadError> {
        let place = At("buffers", number);
        let short = |has: usize| {
            Err(ReadError::new(
                ReadErrorKind::Reference,
                format!("{place} should have {length} bytes, and there are {has}"),
                "check that the file was copied whole, or export it again",
            ))
        };
        let Some(uri) = value.get("uri") else {
            return match bin.filter(|_| number == 0) {
                Some(bin) if bin.len() < length => short(bin.len()),
                Some(_) => Ok(Self {
                    source: Source::Chunk,
                    length,
                    content: Vec::new(),
                }),
                None if needed => Err(fail(
                    ReadErrorKind::Reference,
                    format!("{place} has neither a `uri` nor a BIN chunk, and a mesh needs it"),
                )),
                None => Ok(Self {
                    source: Source::Nowhere,
                    length,
                    content: Vec::new(),
                }),
            };
        };
        let Some(uri) = uri.text() else {
            return Err(fail(
                ReadErrorKind::Shape,
                format!("{place}: `uri` is no text"),
            ));
        };
        let (source, content) = if let Some(start) = container::data_start(&uri) {
            let content = if needed {
                container::decoded(&uri)
                    .map_err(|what| fail(ReadErrorKind::Encoding, format!("{place}: {what}")))?
            } else {
                Vec::new()
            };
            let head = uri[..start].to_owned();
            (Source::Data { head }, content)
        } else if !needed {
            (Source::File, Vec::new())
        } else if is_remote(&uri) {
            return Err(ReadError::new(
                ReadErrorKind::Companion,
                format!("{place} is at the address {uri:?}"),
                "download it, put it beside the model, and write its name there",
            ));
        } else {
            let name = String::from_utf8(container::unescaped(&uri)).unwrap_or_default();
            let content = companions.read(&name).map_err(|why| ReadError {
                kind: ReadErrorKind::Companion,
                line: None,
                column: None,
                what: format!("{place} cannot be read"),
                mend: why,
            })?;
            (Source::File, content)
        };
        if needed && content.len() < length {
            return short(content.len());
        }
        Ok(Self {
            source,
            length,
            content,
        })
    }
}

impl Document for Model {
    fn format(&self) -> &'static str {
        self.format
    }
    fn points(&self) -> Points<'_> {
        Points::Solid(&self.points)
    }
    fn visible(&self) -> usize {
        self.visible
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn companions(&self) -> Vec<String> {
        self.companions.clone()
    }
    fn notes(&self) -> Vec<String> {
        inspect::notes(self)
    }
    fn normals(&self) -> usize {
        let jobs = self.meshes.iter().flat_map(|mesh| &mesh.jobs);
        let counts = jobs.map(|job| match job {
            scene::Job::Normal { accessor, .. } => self.accessors[*accessor].count,
            _ => 0,
        });
        counts.sum()
    }
    fn mesh(&self) -> Option<Mesh> {
        elements::mesh(self)
    }
    fn attributes(&self) -> Vec<String> {
        elements::attributes(self)
    }
    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        elements::attribute(self, name)
    }
    fn inspect(&self) -> Inspection {
        inspect::inspect(self)
    }
    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        write::write(self, moved, self.format == "glb", out)
    }
    fn geometry(&self, moved: &Moved<'_>) -> Result<crate::Geometry, WriteError> {
        geometry::geometry(self, moved)
    }
    fn sisters(&self) -> &'static [&'static str] {
        if self.format == "glb" {
            &["gltf"]
        } else {
            &["glb"]
        }
    }
    fn write_as(
        &self,
        sister: &str,
        moved: &Moved<'_>,
        out: &mut dyn Write,
    ) -> Result<WriteReport, WriteError> {
        let binary = match sister {
            "glb" => true,
            "gltf" => false,
            _ => self.format == "glb",
        };
        write::write(self, moved, binary, out)
    }
}
