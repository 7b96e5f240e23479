//! What accessors hold once the points of an instance have moved.
//!
//! Moved points go back through the inverse of the node's matrix `M`. A normal goes out by `M⁻ᵀ` and back by `Mᵀ`, a tangent
//! out by `M` and back by `M⁻¹`; both are scaled to unit length, as the format asks. The delta of a morph target is the
//! difference of two moved points, and of two carried directions.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, sections 3.7.2.1 (attributes; `w` of a tangent is the
//! handedness of the basis of normal, tangent and bitangent) and 3.7.2.2 "Morph Targets".

use super::Model;
use super::normals;
use super::scene::{Instance, Job};
use crate::normals::unit;
use crate::{Normals, WriteError};
use anamorph_core::glam::{DAffine3, DMat3, DVec3};
use core::hash::{Hash, Hasher};
use core::sync::atomic::{AtomicUsize, Ordering};

/// New numbers for an accessor, `width` an element. Equal is what is equal bit for bit.
pub(super) struct Content {
    pub(super) numbers: Vec<f32>,
    pub(super) width: usize,
}

impl PartialEq for Content {
    fn eq(&self, other: &Self) -> bool {
        self.width == other.width
            && self.numbers.len() == other.numbers.len()
            && self
                .numbers
                .iter()
                .zip(&other.numbers)
                .all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

impl Eq for Content {}

impl Hash for Content {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        self.width.hash(hasher);
        self.numbers.len().hash(hasher);
        for number in &self.numbers {
            number.to_bits().hash(hasher);
        }
    }
}

/// What the jobs of an instance's mesh make; `None` where all stays as it is.
pub(super) type Outcome = Vec<Option<Content>>;

/// Normals that changed, and that should have but had no usable direction.
#[derive(Default, Clone, Copy)]
pub(super) struct Tally {
    pub(super) changed: usize,
    pub(super) kept: usize,
}

/// Where the points went.
pub(super) struct Movement<'a> {
    pub(super) model: &'a Model,
    pub(super) data: Vec<&'a [u8]>,
    pub(super) new: &'a [DVec3],
    pub(super) normals: Normals<'a>,
    pub(super) tangents: Option<crate::NormalMap<'a>>,
}

/// From mesh to world and back.
#[derive(Clone, Copy)]
pub(super) struct Frame(Option<(DAffine3, DAffine3)>);

impl Frame {
    /// `None` if there is no way back.
    pub(super) fn of(world: Option<DAffine3>) -> Option<Self> {
        let Some(world) = world else {
            return Some(Self(None));
        };
        // A determinant that underflows is not zero yet: scaling first tells.
        let size = [world.x_axis, world.y_axis, world.z_axis]
            .map(|axis| axis.abs().max_element())
            .into_iter()
            .fold(0.0_f64, f64::max);
        let linear = DMat3::from_cols(world.x_axis, world.y_axis, world.z_axis) * size.recip();
        if !(size > 0.0 && linear.determinant() != 0.0) {
            return None;
        }
        let back = linear.inverse();
        let back = DMat3::from_cols(back.x_axis / size, back.y_axis / size, back.z_axis / size);
        let shift = -(back * world.translation);
        let back = DAffine3::from_mat3_translation(back, shift);
        back.is_finite().then_some(Self(Some((world, back))))
    }
    pub(super) fn back(&self, point: DVec3) -> DVec3 {
        self.0
            .map_or(point, |(_, back)| back.transform_point3(point))
    }
    fn delta_back(&self, delta: DVec3) -> DVec3 {
        self.0
            .map_or(delta, |(_, back)| back.transform_vector3(delta))
    }
    pub(super) fn normal_out(&self, normal: DVec3) -> DVec3 {
        match self.0 {
            None => normal,
            Some((_, back)) => {
                let columns = [back.x_axis, back.y_axis, back.z_axis];
                let out = DVec3::from_array(columns.map(|c| c.dot(normal)));
                unit(out).unwrap_or(normal)
            }
        }
    }
    pub(super) fn normal_back(&self, normal: DVec3) -> DVec3 {
        match self.0 {
            None => normal,
            Some((world, _)) => {
                let columns = [world.x_axis, world.y_axis, world.z_axis];
                DVec3::from_array(columns.map(|c| c.dot(normal)))
            }
        }
    }
    fn tangent_out(&self, tangent: DVec3) -> DVec3 {
        match self.0 {
            None => tangent,
            Some((world, _)) => unit(world.transform_vector3(tangent)).unwrap_or(tangent),
        }
    }
    /// Whether triangles run the other way in the world.
    pub(super) fn mirrors(&self) -> bool {
        self.0.is_some_and(|(world, _)| {
            DMat3::from_cols(world.x_axis, world.y_axis, world.z_axis).determinant() < 0.0
        })
    }
}

/// Whether two points are the same bit for bit.
pub(super) fn same(a: DVec3, b: DVec3) -> bool {
    a.to_array().map(f64::to_bits) == b.to_array().map(f64::to_bits)
}

/// Directions nearer than this are not told apart: the last place of a stored unit vector, so that rounding alone rewrites
/// nothing.
const SAME_DIRECTION: f64 = 1e-7;

/// What became of a direction.
#[derive(Clone, Copy)]
enum Carried {
    Same,
    New(DVec3),
    Unusable,
}

/// Elements worked on together.
const BATCH: usize = 1 << 12;

/// Lets `f` change every element, knowing its number; says how many it says it has changed. On all cores with the feature
/// `parallel`.
fn update<const N: usize>(
    values: &mut [[f32; N]],
    f: impl Fn(usize, &mut [f32; N]) -> bool + Sync,
) -> usize {
    let batch = |(number, batch): (usize, &mut [[f32; N]])| {
        let changed = batch
            .iter_mut()
            .enumerate()
            .map(|(i, value)| usize::from(f(number * BATCH + i, value)));
        changed.sum::<usize>()
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        values.par_chunks_mut(BATCH).enumerate().map(batch).sum()
    }
    #[cfg(not(feature = "parallel"))]
    {
        values.chunks_mut(BATCH).enumerate().map(batch).sum()
    }
}

fn set<const N: usize>(value: &mut [f32; N], new: DVec3) -> bool {
    let mut changed = false;
    for (slot, new) in value.iter_mut().zip(new.to_array()) {
        let new = new as f32;
        changed |= slot.to_bits() != new.to_bits();
        *slot = new;
    }
    changed
}

fn content<const N: usize>(values: Vec<[f32; N]>, changed: usize) -> Option<Content> {
    (changed > 0).then(|| Content {
        numbers: values.into_flattened(),
        width: N,
    })
}

fn vector(value: &[f32]) -> DVec3 {
    DVec3::new(
        f64::from(value[0]),
        f64::from(value[1]),
        f64::from(value[2]),
    )
}

impl Movement<'_> {
    fn accessor<const N: usize>(&self, accessor: usize) -> Vec<[f32; N]> {
        self.model.accessors[accessor].elements(&self.data)
    }

    /// The new contents for an instance.
    pub(super) fn outcome(&self, instance: &Instance) -> Result<(Outcome, Tally), WriteError> {
        let model = self.model;
        let mesh = &model.meshes[instance.mesh];
        let mut tally = Tally::default();
        let Some(frame) = Frame::of(instance.world) else {
            if self.moves(instance) {
                return Err(self.no_way_back(instance));
            }
            return Ok((mesh.jobs.iter().map(|_| None).collect(), tally));
        };
        let recomputed = match self.normals {
            Normals::Recompute => Some(normals::Recomputed::of(self, instance, &frame)),
            _ => None,
        };
        let mut outcome: Outcome = Vec::with_capacity(mesh.jobs.len());
        for job in &mesh.jobs {
            let made = match *job {
                Job::Position { slot } => self.position(instance, &frame, slot)?,
                Job::DeltaPosition { shadow } => self.delta(instance, &frame, shadow)?,
                Job::Normal { slot, accessor } => {
                    let mut values = self.accessor::<3>(accessor);
                    let kept = AtomicUsize::new(0);
                    let start = instance.starts[slot];
                    let changed = update(&mut values, |i, value| {
                        let old = vector(value);
                        let carried = match &recomputed {
                            Some(all) => all.normal(slot, accessor, i, old),
                            None => self.normal(&frame, start + i, old),
                        };
                        match carried {
                            Carried::New(new) => set(value, new),
                            Carried::Same => false,
                            Carried::Unusable => {
                                kept.fetch_add(1, Ordering::Relaxed);
                                false
                            }
                        }
                    });
                    tally.changed += changed;
                    tally.kept += kept.into_inner();
                    content(values, changed)
                }
                Job::Tangent {
                    slot,
                    accessor,
                    normal,
                } => self.tangent_job(instance, &frame, slot, accessor, normal),
                Job::DeltaNormal {
                    slot,
                    shadow,
                    base,
                    accessor,
                } => {
                    let job = mesh.numbers.get(&Job::Normal {
                        slot,
                        accessor: base,
                    });
                    let new = job.and_then(|job| outcome.get(*job)?.as_ref());
                    match &recomputed {
                        Some(all) => {
                            let mut values = self.accessor::<3>(accessor);
                            let deltas = all.deltas(self, instance, &frame, slot, shadow, base);
                            let changed = update(&mut values, |i, value| {
                                deltas
                                    .get(i)
                                    .copied()
                                    .flatten()
                                    .is_some_and(|new| set(value, new))
                            });
                            content(values, changed)
                        }
                        None => self.direction_deltas::<3>(
                            instance,
                            slot,
                            shadow,
                            base,
                            accessor,
                            new,
                            &|i, old| self.normal(&frame, i, old),
                        ),
                    }
                }
                Job::DeltaTangent {
                    slot,
                    shadow,
                    base,
                    normal,
                    accessor,
                } => {
                    let tangent = Job::Tangent {
                        slot,
                        accessor: base,
                        normal,
                    };
                    let new = mesh
                        .numbers
                        .get(&tangent)
                        .and_then(|job| outcome.get(*job)?.as_ref());
                    self.direction_deltas::<4>(
                        instance,
                        slot,
                        shadow,
                        base,
                        accessor,
                        new,
                        &|i, old| self.tangent(&frame, i, old),
                    )
                }
            };
            outcome.push(made);
        }
        Ok((outcome, tally))
    }

    fn moves(&self, instance: &Instance) -> bool {
        let mesh = &self.model.meshes[instance.mesh];
        let slots = instance.starts.iter().zip(&mesh.slots);
        let slots = slots.map(|(start, slot)| (*start, self.model.accessors[*slot].count));
        let shadows = instance.shadow_starts.iter().zip(&mesh.shadows);
        let shadows = shadows.map(|(start, shadow)| (*start, shadow.vertices.len()));
        slots.chain(shadows).any(|(start, count)| {
            let range = start..start + count;
            range
                .into_iter()
                .any(|i| !same(self.model.points[i], self.new[i]))
        })
    }

    fn node_name(&self, instance: &Instance) -> String {
        let Some(node) = instance.node else {
            return "a mesh".into();
        };
        match &self.model.nodes[node].name {
            Some(name) => format!("nodes[{node}] ({name:?})"),
            None => format!("nodes[{node}]"),
        }
    }

    fn no_way_back(&self, instance: &Instance) -> WriteError {
        WriteError::Refused {
            what: format!(
                "{} flattens its mesh (a scale of 0), so what the warp moved cannot be stored in the mesh",
                self.node_name(instance)
            ),
            mend: "give the node another scale, leave it out of the warp by a mask, or use the recipe key `space = \"local\"`"
                .into(),
        }
    }

    fn too_far(&self, instance: &Instance, vertex: usize) -> WriteError {
        WriteError::Refused {
            what: format!(
                "vertex {vertex} (from 0) of {} moves beyond the numbers that glTF can hold",
                self.node_name(instance)
            ),
            mend: "scale the model down, or mask the warp there".into(),
        }
    }

    fn position(
        &self,
        instance: &Instance,
        frame: &Frame,
        slot: usize,
    ) -> Result<Option<Content>, WriteError> {
        let accessor = self.model.meshes[instance.mesh].slots[slot];
        let start = instance.starts[slot];
        let mut values = self.accessor::<3>(accessor);
        let worst = AtomicUsize::new(usize::MAX);
        let changed = update(&mut values, |i, value| {
            let (old, new) = (self.model.points[start + i], self.new[start + i]);
            if same(old, new) || !old.is_finite() {
                return false;
            }
            let changed = set(value, frame.back(new));
            if !value.iter().all(|x| x.is_finite()) {
                worst.fetch_min(i, Ordering::Relaxed);
            }
            changed
        });
        match worst.into_inner() {
            usize::MAX => Ok(content(values, changed)),
            vertex => Err(self.too_far(instance, vertex)),
        }
    }

    fn delta(
        &self,
        instance: &Instance,
        frame: &Frame,
        shadow: usize,
    ) -> Result<Option<Content>, WriteError> {
        let found = &self.model.meshes[instance.mesh].shadows[shadow];
        let (start, shadow_start) = (instance.starts[found.slot], instance.shadow_starts[shadow]);
        let mut values = self.accessor::<3>(found.accessor);
        let mut changed = 0;
        for (k, &vertex) in found.vertices.iter().enumerate() {
            let (to, from) = (shadow_start + k, start + vertex as usize);
            let points = &self.model.points;
            let still = same(points[to], self.new[to]) && same(points[from], self.new[from]);
            if still || !points[to].is_finite() || !points[from].is_finite() {
                continue;
            }
            let value = &mut values[vertex as usize];
            changed += usize::from(set(value, frame.delta_back(self.new[to] - self.new[from])));
            if !value.iter().all(|x| x.is_finite()) {
                return Err(self.too_far(instance, vertex as usize));
            }
        }
        Ok(content(values, changed))
    }

    /// A direction at a point, in the coordinates of the mesh; scaled to unit length where it changes.
    fn carried(
        &self,
        point: usize,
        old: DVec3,
        out: DVec3,
        map: crate::NormalMap<'_>,
        back: impl Fn(DVec3) -> DVec3,
    ) -> Carried {
        if !self.model.points[point].is_finite() {
            return Carried::Same;
        }
        let new = map(point, out);
        if same(new, out) {
            return Carried::Same;
        }
        match unit(new).and_then(|new| unit(back(new))) {
            None => Carried::Unusable,
            Some(new)
                if unit(old)
                    .is_some_and(|old| (new - old).abs().max_element() < SAME_DIRECTION) =>
            {
                Carried::Same
            }
            Some(new) => Carried::New(new),
        }
    }

    fn normal(&self, frame: &Frame, point: usize, old: DVec3) -> Carried {
        match self.normals {
            Normals::Transform(map) if unit(old).is_some() => {
                self.carried(point, old, frame.normal_out(old), map, |n| {
                    frame.normal_back(n)
                })
            }
            _ => Carried::Same,
        }
    }

    fn tangent(&self, frame: &Frame, point: usize, old: DVec3) -> Carried {
        match self.tangents {
            Some(map) if unit(old).is_some() => {
                self.carried(point, old, frame.tangent_out(old), map, |t| {
                    frame.delta_back(t)
                })
            }
            _ => Carried::Same,
        }
    }

    /// Whether space is turned inside out at a point: then its normal and the image of the line along it point apart.
    fn reflects(&self, frame: &Frame, point: usize, normal: DVec3) -> bool {
        let (Normals::Transform(normals), Some(tangents)) = (self.normals, self.tangents) else {
            return false;
        };
        let out = frame.normal_out(normal);
        normals(point, out).dot(tangents(point, out)) < 0.0
    }

    fn tangent_job(
        &self,
        instance: &Instance,
        frame: &Frame,
        slot: usize,
        accessor: usize,
        normal: Option<usize>,
    ) -> Option<Content> {
        self.tangents?;
        let start = instance.starts[slot];
        let normals = normal.map(|normal| self.accessor::<3>(normal));
        let mut values = self.accessor::<4>(accessor);
        let changed = update(&mut values, |i, value| {
            let Carried::New(new) = self.tangent(frame, start + i, vector(&value[..])) else {
                return false;
            };
            let normal = normals.as_ref().and_then(|normals| normals.get(i));
            let flips = normal.is_some_and(|n| self.reflects(frame, start + i, vector(n)));
            let changed = set(value, new);
            if flips {
                value[3] = -value[3];
            }
            changed || flips
        });
        content(values, changed)
    }

    /// The deltas of a target's normals or tangents (`N` numbers of the base an element). `new` is what becomes of the base.
    #[allow(clippy::too_many_arguments)]
    fn direction_deltas<const N: usize>(
        &self,
        instance: &Instance,
        slot: usize,
        shadow: Option<usize>,
        base: usize,
        accessor: usize,
        new: Option<&Content>,
        carry: &(dyn Fn(usize, DVec3) -> Carried + Sync),
    ) -> Option<Content> {
        let mesh = &self.model.meshes[instance.mesh];
        let old = self.accessor::<N>(base);
        let start = instance.starts[slot];
        let mut values = self.accessor::<3>(accessor);
        let changed = update(&mut values, |i, value| {
            let place = shadow.and_then(|shadow| {
                let found = mesh.shadows[shadow].vertices.binary_search(&(i as u32));
                found.ok().map(|k| instance.shadow_starts[shadow] + k)
            });
            let delta = vector(value);
            if place.is_none() && delta == DVec3::ZERO {
                return false;
            }
            let from = vector(&old[i]);
            let morphed = from + delta;
            let length = morphed.length();
            let (true, Some(direction)) = (length.is_finite(), unit(morphed)) else {
                return false;
            };
            let to = match carry(place.unwrap_or(start + i), direction) {
                Carried::New(new) => new * length,
                _ => morphed,
            };
            let base = new.map_or(from, |content| vector(&content.numbers[i * N..]));
            let moved = to - base;
            // Rounding alone rewrites nothing.
            (moved - delta).abs().max_element() >= SAME_DIRECTION && set(value, moved)
        });
        content(values, changed)
    }
}

impl normals::Recomputed {
    fn normal(&self, slot: usize, accessor: usize, vertex: usize, old: DVec3) -> Carried {
        match self.get(slot, accessor, vertex) {
            Some(Some(new)) if old.is_finite() => {
                if unit(old).is_some_and(|old| (new - old).abs().max_element() < SAME_DIRECTION) {
                    Carried::Same
                } else {
                    Carried::New(new)
                }
            }
            Some(None) if old.is_finite() => Carried::Unusable,
            _ => Carried::Same,
        }
    }
}
