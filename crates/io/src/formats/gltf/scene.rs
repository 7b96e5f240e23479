//! Nodes and meshes: which points there are, and where the scene puts them.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, sections 3.5 "Scenes and Nodes" and 3.7 "Meshes". A point of a mesh
//! stands where the product of the matrices from the root to the node puts it.
//!
//! A node with a skin is an exception: its own place does not count (section 3.7.3.3), its joints place the vertices. As long
//! as the skeleton is in the bind pose, the matrix of a joint times its inverse bind matrix is the same for every joint and
//! takes the mesh to the world as a whole. We take that of the first joint, so the mesh is seen in its bind pose, at the size
//! and the way up that the scene gives it, whatever pose the skeleton is in.

use super::accessor::{Accessor, needed, whole};
use super::content::Frame;
use super::json::{Kind, Value};
use super::{At, fail};
use crate::{ReadError, ReadErrorKind};
use anamorph_core::glam::{DAffine3, DMat3, DQuat, DVec3};
use core::ops::Range;
use std::collections::HashMap;

/// A node that may carry a mesh.
pub(super) struct Node {
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    /// From its own coordinates to those of the world.
    pub(super) world: DAffine3,
    pub(super) name: Option<String>,
}

/// Numbers at a key, if it is there.
fn numbers<const N: usize>(
    table: Value<'_>,
    key: &str,
    place: &At<'_>,
) -> Result<Option<[f64; N]>, ReadError> {
    let Some(list) = table.get(key) else {
        return Ok(None);
    };
    let all: Vec<f64> = list.items().filter_map(Value::number).collect();
    match <[f64; N]>::try_from(all) {
        Ok(array) if array.iter().all(|x| x.is_finite()) => Ok(Some(array)),
        _ => Err(fail(
            ReadErrorKind::Shape,
            format!("{place}: `{key}` is not {N} finite numbers"),
        )),
    }
}

/// The node's own matrix.
fn local(node: Value<'_>, place: &At<'_>) -> Result<DAffine3, ReadError> {
    if let Some(m) = numbers::<16>(node, "matrix", place)? {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            return Err(fail(
                ReadErrorKind::Scene,
                format!("{place}: the last row of `matrix` is not 0, 0, 0, 1"),
            ));
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
        let linear = DMat3::from_cols(column(0), column(4), column(8));
        return Ok(DAffine3::from_mat3_translation(linear, column(12)));
    }
    let shift = numbers(node, "translation", place)?.map_or(DVec3::ZERO, DVec3::from_array);
    let scale = numbers(node, "scale", place)?.map_or(DVec3::ONE, DVec3::from_array);
    let turn = match numbers::<4>(node, "rotation", place)? {
        None | Some([0.0, 0.0, 0.0, 1.0]) => DMat3::IDENTITY,
        Some(q) => {
            let turn = DQuat::from_array(q);
            let length = turn.length();
            if !(length > 0.0 && length.is_finite()) {
                return Err(fail(
                    ReadErrorKind::Scene,
                    format!("{place}: `rotation` is no unit quaternion"),
                ));
            }
            // Files round to single precision; the rotation that is meant has length 1.
            DMat3::from_quat(turn / length)
        }
    };
    let linear = DMat3::from_cols(
        turn.x_axis * scale.x,
        turn.y_axis * scale.y,
        turn.z_axis * scale.z,
    );
    Ok(DAffine3::from_mat3_translation(linear, shift))
}

/// Reads the nodes. Those without a parent are roots, whether a scene names them or not.
pub(super) fn nodes(list: &[Value<'_>], meshes: usize) -> Result<Vec<Node>, ReadError> {
    let mut nodes = Vec::with_capacity(list.len());
    let mut parents: Vec<Option<usize>> = vec![None; list.len()];
    let mut children: Vec<Vec<usize>> = Vec::with_capacity(list.len());
    for (i, value) in list.iter().enumerate() {
        let place = At("nodes", i);
        let mesh = whole(*value, "mesh", &place)?;
        if let Some(mesh) = mesh.filter(|mesh| *mesh >= meshes) {
            return Err(fail(
                ReadErrorKind::Reference,
                format!("{place} has mesh {mesh}, and there are {meshes}"),
            ));
        }
        let mut own = Vec::new();
        for child in value.get("children").into_iter().flat_map(Value::items) {
            let Some(child) = child.whole().filter(|child| *child < list.len()) else {
                return Err(fail(
                    ReadErrorKind::Reference,
                    format!(
                        "{place} has the child {}, and there are {} nodes",
                        child.raw(),
                        list.len()
                    ),
                ));
            };
            if let Some(other) = parents[child].replace(i) {
                return Err(fail(
                    ReadErrorKind::Scene,
                    format!(
                        "{} is a child of both nodes[{other}] and {place}",
                        At("nodes", child)
                    ),
                ));
            }
            own.push(child);
        }
        children.push(own);
        nodes.push(Node {
            mesh,
            skin: whole(*value, "skin", &place)?,
            world: local(*value, &place)?,
            name: value.get("name").and_then(Value::text).map(Into::into),
        });
    }
    let mut placed = vec![false; list.len()];
    let mut open: Vec<usize> = (0..list.len()).filter(|i| parents[*i].is_none()).collect();
    while let Some(node) = open.pop() {
        placed[node] = true;
        for &child in &children[node] {
            nodes[child].world = nodes[node].world * nodes[child].world;
            open.push(child);
        }
    }
    if let Some(lost) = placed.iter().position(|placed| !placed) {
        return Err(fail(
            ReadErrorKind::Scene,
            format!(
                "{} is among its own ancestors, so it has no place",
                At("nodes", lost)
            ),
        ));
    }
    Ok(nodes)
}

/// The first joint of each skin, and the accessor of its inverse bind matrices.
pub(super) fn skins(
    list: &[Value<'_>],
    nodes: &[Node],
    accessors: &[Accessor],
) -> Result<Vec<(usize, Option<usize>)>, ReadError> {
    let read = |(i, value): (usize, &Value<'_>)| {
        let place = At("skins", i);
        let joints = value.get("joints").and_then(|list| list.items().next());
        let joint = joints.and_then(Value::whole);
        let matrices = whole(*value, "inverseBindMatrices", &place)?;
        let fits = |accessor: usize| accessors.get(accessor).is_some_and(|a| a.width == 16);
        match joint.filter(|joint| *joint < nodes.len()) {
            Some(joint) if matrices.is_none_or(fits) => Ok((joint, matrices)),
            Some(_) => Err(fail(
                ReadErrorKind::Reference,
                format!("{place}: `inverseBindMatrices` is no accessor of matrices"),
            )),
            None => Err(fail(
                ReadErrorKind::Reference,
                format!("{place} has no joint, or one that is no node"),
            )),
        }
    };
    list.iter().enumerate().map(read).collect()
}

/// Where each skin puts its mesh in the bind pose; where that cannot be told, the mesh's own coordinates are the world's.
pub(super) fn bind_places(
    skins: &[(usize, Option<usize>)],
    nodes: &[Node],
    accessors: &[Accessor],
    data: &[&[u8]],
) -> Vec<DAffine3> {
    let place = |(joint, matrices): &(usize, Option<usize>)| {
        let back = match matrices {
            None => DAffine3::IDENTITY,
            Some(accessor) => {
                let m = accessors[*accessor].first::<16>(data)?;
                let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]);
                let linear = DMat3::from_cols(column(0), column(4), column(8));
                DAffine3::from_mat3_translation(linear, column(12))
            }
        };
        let place = nodes[*joint].world * back;
        (place.is_finite() && Frame::of(Some(place)).is_some()).then_some(place)
    };
    skins
        .iter()
        .map(|skin| place(skin).unwrap_or(DAffine3::IDENTITY))
        .collect()
}

/// What has to be computed again when a mesh moves. Slots are numbers in [`Mesh::slots`], shadows in [`Mesh::shadows`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Job {
    Position {
        slot: usize,
    },
    Normal {
        slot: usize,
        accessor: usize,
    },
    Tangent {
        slot: usize,
        accessor: usize,
        normal: Option<usize>,
    },
    DeltaPosition {
        shadow: usize,
    },
    /// `base` is the accessor of the normals that the deltas are added to.
    DeltaNormal {
        slot: usize,
        shadow: Option<usize>,
        base: usize,
        accessor: usize,
    },
    /// As of normals; `normal` is the accessor of the primitive's normals.
    DeltaTangent {
        slot: usize,
        shadow: Option<usize>,
        base: usize,
        normal: Option<usize>,
        accessor: usize,
    },
}

/// A place in the JSON that names an accessor whose content a job makes.
pub(super) struct Use {
    pub(super) job: usize,
    pub(super) accessor: usize,
    /// Where the accessor's number stands.
    pub(super) span: Range<usize>,
}

/// The places that a morph target leads the vertices of a slot to.
pub(super) struct Shadow {
    pub(super) slot: usize,
    /// Accessor of the deltas.
    pub(super) accessor: usize,
    /// The vertices that it moves, ascending.
    pub(super) vertices: Vec<u32>,
}

pub(super) struct Primitive {
    /// The slot of its positions; a primitive without is not ours.
    pub(super) slot: Option<usize>,
    pub(super) mode: usize,
    pub(super) indices: Option<usize>,
    pub(super) normal: Option<usize>,
    pub(super) colour: Option<usize>,
    /// Single numbers of the application's own, by name.
    pub(super) scalars: Vec<(String, usize)>,
}

#[derive(Default)]
pub(super) struct Mesh {
    /// Accessors of positions, each once.
    pub(super) slots: Vec<usize>,
    pub(super) shadows: Vec<Shadow>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) jobs: Vec<Job>,
    /// The number of each job.
    pub(super) numbers: HashMap<Job, usize>,
    pub(super) uses: Vec<Use>,
    pub(super) targets: usize,
    /// Corners of its primitives.
    pub(super) corners: usize,
}

/// Reads a mesh: all but the bytes.
struct Reader<'a> {
    accessors: &'a [Accessor],
    mesh: Mesh,
    slots: HashMap<usize, usize>,
    shadows: HashMap<(usize, usize), usize>,
}

impl<'a> Reader<'a> {
    /// The accessor that a value names.
    fn accessor(&self, value: Value<'_>, place: &str) -> Result<(usize, &'a Accessor), ReadError> {
        let found = value
            .whole()
            .and_then(|i| Some((i, self.accessors.get(i)?)));
        found.ok_or_else(|| {
            fail(
                ReadErrorKind::Reference,
                format!(
                    "{place} is accessor {}, and there are {}",
                    value.raw(),
                    self.accessors.len()
                ),
            )
        })
    }
    /// As [`Reader::accessor`], with as many numbers an element and as many elements as there have to be.
    fn fitting(
        &self,
        value: Value<'_>,
        width: usize,
        count: Option<usize>,
        place: &str,
    ) -> Result<usize, ReadError> {
        let (i, accessor) = self.accessor(value, place)?;
        if accessor.width != width {
            return Err(fail(
                ReadErrorKind::Shape,
                format!(
                    "{place} has {} numbers an element instead of {width}",
                    accessor.width
                ),
            ));
        }
        if let Some(count) = count.filter(|count| *count != accessor.count) {
            return Err(fail(
                ReadErrorKind::Shape,
                format!(
                    "{place} has {} elements for {count} vertices",
                    accessor.count
                ),
            ));
        }
        Ok(i)
    }
    fn job(&mut self, job: Job, accessor: usize, value: Value<'_>) {
        let jobs = &mut self.mesh.jobs;
        let number = *self.mesh.numbers.entry(job).or_insert_with(|| {
            jobs.push(job);
            jobs.len() - 1
        });
        self.mesh.uses.push(Use {
            job: number,
            accessor,
            span: value.span(),
        });
    }

    fn primitive(&mut self, value: Value<'_>, place: &str) -> Result<(), ReadError> {
        let Some(attributes) = value.get("attributes").filter(|a| a.kind() == Kind::Table) else {
            return Err(fail(
                ReadErrorKind::Shape,
                format!("{place} has no `attributes`"),
            ));
        };
        let mode = value.get("mode").map_or(Some(4), Value::whole);
        let Some(mode) = mode.filter(|mode| *mode <= 6) else {
            return Err(fail(
                ReadErrorKind::Element,
                format!("{place}: `mode` is none of 0 to 6"),
            ));
        };
        let mut primitive = Primitive {
            slot: None,
            mode,
            indices: None,
            normal: None,
            colour: None,
            scalars: Vec::new(),
        };
        let Some(position) = attributes.get("POSITION") else {
            self.mesh.primitives.push(primitive);
            return Ok(());
        };
        let accessor = self.fitting(position, 3, None, &format!("POSITION of {place}"))?;
        let count = self.accessors[accessor].count;
        let slots = &mut self.mesh.slots;
        let slot = *self.slots.entry(accessor).or_insert_with(|| {
            slots.push(accessor);
            slots.len() - 1
        });
        primitive.slot = Some(slot);
        self.job(Job::Position { slot }, accessor, position);

        let (mut normal, mut tangent) = (None, None);
        for (name, value) in attributes.entries() {
            let what = || format!("{name} of {place}");
            match &*name {
                "POSITION" => {}
                "NORMAL" => normal = Some((self.fitting(value, 3, Some(count), &what())?, value)),
                "TANGENT" => tangent = Some((self.fitting(value, 4, Some(count), &what())?, value)),
                _ => {
                    let (i, found) = self.accessor(value, &what())?;
                    self.fitting(value, found.width, Some(count), &what())?;
                    if name == "COLOR_0" {
                        primitive.colour = Some(i);
                    } else if name.starts_with('_') && found.width == 1 {
                        primitive.scalars.push((name.into_owned(), i));
                    }
                }
            }
        }
        if let Some((accessor, value)) = normal {
            primitive.normal = Some(accessor);
            self.job(Job::Normal { slot, accessor }, accessor, value);
        }
        let normal = primitive.normal;
        if let Some((accessor, value)) = tangent {
            let job = Job::Tangent {
                slot,
                accessor,
                normal,
            };
            self.job(job, accessor, value);
        }
        let tangent = tangent.map(|(accessor, _)| accessor);

        self.mesh.corners += count;
        if let Some(indices) = value.get("indices") {
            let what = format!("`indices` of {place}");
            let (i, found) = self.accessor(indices, &what)?;
            if !found.is_index() {
                return Err(fail(
                    ReadErrorKind::Shape,
                    format!("{what}: the accessor does not hold unsigned whole numbers"),
                ));
            }
            self.mesh.corners += found.count;
            primitive.indices = Some(i);
        }

        let targets: Vec<Value<'_>> = value
            .get("targets")
            .into_iter()
            .flat_map(Value::items)
            .collect();
        for (number, target) in targets.iter().enumerate() {
            self.target(
                *target,
                slot,
                count,
                normal,
                tangent,
                &format!("target {number} of {place}"),
            )?;
        }
        let first = self.mesh.primitives.is_empty();
        if !first && self.mesh.targets != targets.len() {
            return Err(fail(
                ReadErrorKind::Shape,
                format!(
                    "{place} has {} morph targets, and the primitives before it have {}",
                    targets.len(),
                    self.mesh.targets
                ),
            ));
        }
        self.mesh.targets = targets.len();
        self.mesh.primitives.push(primitive);
        Ok(())
    }

    fn target(
        &mut self,
        target: Value<'_>,
        slot: usize,
        count: usize,
        normal: Option<usize>,
        tangent: Option<usize>,
        place: &str,
    ) -> Result<(), ReadError> {
        let mut found = Vec::new();
        for (name, value) in target.entries() {
            let what = format!("{name} of {place}");
            let accessor = match &*name {
                "POSITION" | "NORMAL" | "TANGENT" => self.fitting(value, 3, Some(count), &what)?,
                _ => {
                    let (i, other) = self.accessor(value, &what)?;
                    self.fitting(value, other.width, Some(count), &what)?;
                    i
                }
            };
            found.push((name, value, accessor));
        }
        let mut shadow = None;
        for (name, value, accessor) in &found {
            if name == "POSITION" {
                let shadows = &mut self.mesh.shadows;
                let number = *self.shadows.entry((slot, *accessor)).or_insert_with(|| {
                    shadows.push(Shadow {
                        slot,
                        accessor: *accessor,
                        vertices: Vec::new(),
                    });
                    shadows.len() - 1
                });
                shadow = Some(number);
                self.job(Job::DeltaPosition { shadow: number }, *accessor, *value);
            }
        }
        for (name, value, accessor) in found {
            let job = match (&*name, normal, tangent) {
                ("NORMAL", Some(base), _) => Job::DeltaNormal {
                    slot,
                    shadow,
                    base,
                    accessor,
                },
                ("TANGENT", normal, Some(base)) => Job::DeltaTangent {
                    slot,
                    shadow,
                    base,
                    normal,
                    accessor,
                },
                _ => continue,
            };
            self.job(job, accessor, value);
        }
        Ok(())
    }
}

/// Reads the meshes.
pub(super) fn meshes(list: &[Value<'_>], accessors: &[Accessor]) -> Result<Vec<Mesh>, ReadError> {
    let read = |(i, value): (usize, &Value<'_>)| {
        let mut reader = Reader {
            accessors,
            mesh: Mesh::default(),
            slots: HashMap::new(),
            shadows: HashMap::new(),
        };
        let primitives = value.get("primitives").into_iter().flat_map(Value::items);
        for (number, primitive) in primitives.enumerate() {
            reader.primitive(primitive, &format!("meshes[{i}].primitives[{number}]"))?;
        }
        Ok(reader.mesh)
    };
    list.iter().enumerate().map(read).collect()
}

/// A mesh where a node puts it, and which of the document's points are its own.
pub(super) struct Instance {
    pub(super) mesh: usize,
    pub(super) node: Option<usize>,
    /// From mesh to world, where that is not the identity.
    pub(super) world: Option<DAffine3>,
    /// The first point of each slot.
    pub(super) starts: Vec<usize>,
    /// The first point of each shadow.
    pub(super) shadow_starts: Vec<usize>,
}

/// The instances in the order of the nodes, then the meshes that no node has; or, for local coordinates, every mesh once.
/// `binds` are the places of the skins.
pub(super) fn instances(
    nodes: &[Node],
    meshes: &[Mesh],
    binds: &[DAffine3],
    local: bool,
) -> Vec<Instance> {
    let instance = |mesh: usize, node: Option<usize>, world: Option<DAffine3>| Instance {
        mesh,
        node,
        world: world.filter(|world| *world != DAffine3::IDENTITY),
        starts: Vec::new(),
        shadow_starts: Vec::new(),
    };
    if local {
        return (0..meshes.len())
            .map(|mesh| instance(mesh, None, None))
            .collect();
    }
    let mut used = vec![false; meshes.len()];
    let mut list = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        if let Some(mesh) = node.mesh {
            used[mesh] = true;
            let bind = node.skin.and_then(|skin| binds.get(skin)).copied();
            list.push(instance(mesh, Some(i), Some(bind.unwrap_or(node.world))));
        }
    }
    let unused = (0..meshes.len()).filter(|mesh| !used[*mesh]);
    list.extend(unused.map(|mesh| instance(mesh, None, None)));
    list
}

/// The buffers that the meshes and skins need.
pub(super) fn needed_buffers(
    meshes: &[Mesh],
    skins: &[(usize, Option<usize>)],
    accessors: &[Accessor],
    buffers: usize,
) -> Vec<bool> {
    let mut needed = vec![false; buffers];
    let matrices = skins.iter().filter_map(|skin| skin.1);
    for accessor in mesh_accessors(meshes).chain(matrices) {
        for buffer in accessors[accessor].buffers() {
            needed[buffer] = true;
        }
    }
    needed
}

/// All accessors that are read for meshes; one may come several times.
pub(super) fn mesh_accessors(meshes: &[Mesh]) -> impl Iterator<Item = usize> {
    meshes.iter().flat_map(|mesh| {
        let used = mesh.uses.iter().map(|found| found.accessor);
        let others = mesh.primitives.iter().flat_map(|primitive| {
            let scalars = primitive.scalars.iter().map(|(_, accessor)| *accessor);
            scalars.chain(primitive.indices).chain(primitive.colour)
        });
        used.chain(others)
    })
}

/// The URI, or `None` for a buffer without; and the length of each buffer.
pub(super) fn buffer_lengths(list: &[Value<'_>]) -> Result<Vec<usize>, ReadError> {
    list.iter()
        .enumerate()
        .map(|(i, value)| needed(*value, "byteLength", &At("buffers", i)))
        .collect()
}
