//! A glTF as another format may hold it: the scene as it stands, with normals and texture coordinates.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, section 3.7.2.1 "Overview" (of attributes). Texture coordinates
//! run downwards there and upwards here.

use super::content::Frame;
use super::json::Value;
use super::scene::Primitive;
use super::{Model, listed};
use crate::normals::unit;
use crate::{Document, Geometry, Moved, Normals, Values, WriteError};
use anamorph_core::glam::{DVec2, DVec3};

/// What the JSON may list that no other format here holds, and what it is called.
const BEYOND: [(&str, &str); 5] = [
    ("materials", "material"),
    ("textures", "texture"),
    ("skins", "skin"),
    ("animations", "animation"),
    ("cameras", "camera"),
];

pub(super) fn geometry(model: &Model, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
    let mut geometry = Geometry::of(model, moved)?;
    geometry.beyond.clear();
    let count = geometry.points.len();
    let root = model.json.root();

    let stored = per_point(model, count, |_, primitive| primitive.normal);
    geometry.normals = match stored {
        Some(all) => Values::Points(match moved.normals {
            Normals::Recompute => {
                anamorph_core::vertex_normals(&geometry.points, &mesh_triangles(&geometry))
            }
            Normals::Keep => all,
            Normals::Transform(carry) => carried(all, carry),
        }),
        None => {
            if model.normals() > 0 {
                geometry
                    .beyond
                    .push("normals of some of the meshes".to_owned());
            }
            Values::None
        }
    };
    let textures = texture_coordinates(model, root, count);
    let some = |set: &str| root_attributes(root).any(|a| a.get(set).is_some());
    if textures.is_none() && some("TEXCOORD_0") {
        let what = "texture coordinates of some of the meshes";
        geometry.beyond.push(what.to_owned());
    }
    geometry.textures = textures.map_or(Values::None, Values::Points);
    if some("TEXCOORD_1") {
        geometry
            .beyond
            .push("second texture coordinates".to_owned());
    }
    if some("TANGENT") {
        geometry.beyond.push("tangents".to_owned());
    }
    let targets: usize = model.meshes.iter().map(|mesh| mesh.targets).sum();
    let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    if targets > 0 {
        geometry.beyond.push(counted(targets, "morph target"));
    }
    for (key, what) in BEYOND {
        let n = listed(root, key).len();
        if n > 0 {
            geometry.beyond.push(counted(n, what));
        }
    }
    Ok(geometry)
}

fn mesh_triangles(geometry: &Geometry) -> Vec<[u32; 3]> {
    let faces = geometry.faces().map(|(_, face)| face);
    faces.filter_map(|face| face.try_into().ok()).collect()
}

/// Attributes of every primitive, as the JSON has them.
fn root_attributes(root: Value<'_>) -> impl Iterator<Item = Value<'_>> {
    let meshes = listed(root, "meshes").into_iter();
    let primitives = meshes.flat_map(|mesh| listed(mesh, "primitives"));
    primitives.filter_map(|primitive| primitive.get("attributes"))
}

/// The stored normals in the world, one a point; `None` unless all primitives with positions have some.
fn per_point(
    model: &Model,
    count: usize,
    accessor: impl Fn(usize, &Primitive) -> Option<usize>,
) -> Option<Vec<DVec3>> {
    let data = model.data();
    let mut out = vec![DVec3::ZERO; count];
    let mut any = false;
    for instance in &model.instances {
        let frame = Frame::of(instance.world)?;
        let mesh = &model.meshes[instance.mesh];
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let Some(slot) = primitive.slot else { continue };
            let found = &model.accessors[accessor(number, primitive)?];
            let values: Vec<[f64; 3]> = found.elements(&data);
            let places = out.get_mut(instance.starts[slot]..)?;
            for (value, place) in values.iter().zip(places) {
                *place = frame.normal_out(DVec3::from_array(*value));
                any = true;
            }
        }
    }
    any.then_some(out)
}

/// Normals after a warp; one without a usable direction stays.
fn carried(normals: Vec<DVec3>, carry: crate::NormalMap<'_>) -> Vec<DVec3> {
    let new = |(i, normal): (usize, DVec3)| unit(carry(i, normal)).unwrap_or(normal);
    normals.into_iter().enumerate().map(new).collect()
}

/// The first texture coordinates, `v` upwards, one pair a point; `None` unless all primitives with positions have some.
fn texture_coordinates(model: &Model, root: Value<'_>, count: usize) -> Option<Vec<DVec2>> {
    let data = model.data();
    let meshes = listed(root, "meshes");
    let mut out = vec![DVec2::ZERO; count];
    let mut any = false;
    for instance in &model.instances {
        let mesh = &model.meshes[instance.mesh];
        let values = listed(*meshes.get(instance.mesh)?, "primitives");
        for (primitive, value) in mesh.primitives.iter().zip(values) {
            let Some(slot) = primitive.slot else { continue };
            let named = value.get("attributes")?.get("TEXCOORD_0")?.whole()?;
            let found = model.accessors.get(named)?;
            if found.width != 2 || found.count != model.accessors[mesh.slots[slot]].count {
                return None;
            }
            // The buffer may have been left out as not needed.
            let reachable = found.layouts().all(|layout| {
                let bytes = data.get(layout.buffer);
                bytes.is_some_and(|bytes| layout.end() <= bytes.len())
            });
            if !reachable {
                return None;
            }
            let pairs: Vec<[f64; 2]> = found.elements(&data);
            let places = out.get_mut(instance.starts[slot]..)?;
            for (&[u, v], place) in pairs.iter().zip(places) {
                *place = DVec2::new(u, 1.0 - v);
                any = true;
            }
        }
    }
    any.then_some(out)
}
