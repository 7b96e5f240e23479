//! In-betweens of a flat mesh: numbered OBJ files, or one GLB whose morph targets an animation fades between.
//!
//! The mesh lies at z = 0 and is seen from above; with y growing downwards it is turned over, so that it looks the same. Triangles are wound
//! counterclockwise there, by the first frame. Texture coordinates are the caller's, `v` upwards; without any they are the places of
//! the first frame in its bounds.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, version 2.0.1, 2021: sections 3.7.2.2 "Morph Targets" and 3.11 "Animations".

use super::animation::refused;
use super::rounding::Rounding;
use crate::formats::gltf::morph::{MorphBase, MorphKeys, MorphReport, Storage};
use crate::formats::gltf_create::create_traced;
use crate::{Format, Geometry, Lost, Moved, NoCompanions, Points, ReadOptions, Values, WriteError};
use anamorph_core::glam::{DVec2, DVec3, dvec2};
use std::io::Write;

/// A mesh in the plane at several times.
#[derive(Debug, Clone)]
pub struct MeshFrames<'a> {
    /// Numbers of the corners of the triangles.
    pub triangles: &'a [[u32; 3]],
    /// The places of the points at each time, as many each.
    pub frames: &'a [Vec<DVec2>],
    /// Texture coordinates of the points, from 0 to 1, `v` upwards.
    pub textures: Option<&'a [DVec2]>,
    /// Whether y grows downwards.
    pub y_down: bool,
    /// Red, green, blue and opacity from 0 to 1, sRGB-encoded.
    pub fill: Option<[f64; 4]>,
    /// Frames in a second.
    pub rate: f64,
}

impl MeshFrames<'_> {
    fn check(&self) -> Result<(), WriteError> {
        let Some(first) = self.frames.first() else {
            return Err(refused("there is no frame", "give at least one"));
        };
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            let what = format!("{} frames a second are no animation", self.rate);
            return Err(refused(what, "give a positive number, such as 30"));
        }
        for (i, frame) in self.frames.iter().enumerate() {
            if frame.len() != first.len() {
                return Err(WriteError::Mismatch {
                    expected: first.len(),
                    space: "the plane",
                    got: frame.len(),
                    got_space: "the plane",
                });
            }
            if let Some(bad) = frame.iter().position(|point| !point.is_finite()) {
                return Err(refused(
                    format!("point {bad} of frame {} is not finite", i + 1),
                    "correct it",
                ));
            }
        }
        let corners = self.triangles.iter().flatten();
        if let Some(absent) = corners.copied().find(|c| *c as usize >= first.len()) {
            return Err(refused(
                format!("a triangle names point {absent} of {}, from 0", first.len()),
                "correct the number",
            ));
        }
        if let Some(textures) = self.textures.filter(|t| t.len() != first.len()) {
            return Err(refused(
                format!(
                    "there are {} texture coordinates for {} points",
                    textures.len(),
                    first.len()
                ),
                "give one for each",
            ));
        }
        Ok(())
    }

    fn place(&self, point: DVec2) -> DVec3 {
        let y = if self.y_down { 0.0 - point.y } else { point.y };
        DVec3::new(point.x, y, 0.0)
    }

    fn geometry(&self, frame: &[DVec2], first: &[DVec2], round: Option<Rounding>) -> Geometry {
        let place = |point: &DVec2| {
            let place = self.place(*point);
            match round {
                Some(rounding) => DVec3::new(rounding.round(place.x), rounding.round(place.y), 0.0),
                None => place,
            }
        };
        let corner = |i: u32| self.place(first[i as usize]).truncate();
        let doubled = |[a, b, c]: &[u32; 3]| {
            let a = corner(*a);
            (corner(*b) - a).perp_dot(corner(*c) - a)
        };
        let over = self.triangles.iter().map(doubled).sum::<f64>() < 0.0;
        let mut geometry = Geometry {
            points: frame.iter().map(place).collect(),
            ..Geometry::default()
        };
        for [a, b, c] in self.triangles {
            geometry.push_face(if over { [*a, *c, *b] } else { [*a, *b, *c] });
        }
        let textures = match self.textures {
            Some(textures) => textures.to_vec(),
            None => {
                let places: Vec<DVec2> = first.iter().map(|p| self.place(*p).truncate()).collect();
                let start = places.first().copied().unwrap_or_default();
                let low = places.iter().copied().fold(start, DVec2::min);
                let size = places.iter().copied().fold(start, DVec2::max) - low;
                let share = |value: f64, size: f64| if size > 0.0 { value / size } else { 0.0 };
                let within =
                    |p: &DVec2| dvec2(share(p.x - low.x, size.x), share(p.y - low.y, size.y));
                places.iter().map(within).collect()
            }
        };
        let shorten = |uv: DVec2| match round {
            Some(_) => dvec2(
                Rounding::places(6).round(uv.x),
                Rounding::places(6).round(uv.y),
            ),
            None => uv,
        };
        geometry.textures = Values::Points(textures.into_iter().map(shorten).collect());
        if let Some(fill) = self.fill {
            geometry.colours = vec![fill; frame.len()];
        }
        geometry
    }

    /// Writes one frame, from 0, as OBJ: vertices at z = 0, texture coordinates, triangles. The points keep their numbers.
    ///
    /// # Errors
    /// Frames of different numbers of points, numbers of points that are not there, a frame that is not there; what the receiver says.
    pub fn write_obj(
        &self,
        frame: usize,
        rounding: Rounding,
        out: &mut dyn Write,
    ) -> Result<Lost, WriteError> {
        self.check()?;
        let (Some(points), Some(first)) = (self.frames.get(frame), self.frames.first()) else {
            return Err(refused(
                format!("there is no frame {frame} of {}, from 0", self.frames.len()),
                "take another",
            ));
        };
        let target = crate::targets().iter().find(|target| target.name == "obj");
        let Some(target) = target else {
            return Err(refused("OBJ is not built", "take GLB"));
        };
        let mut geometry = self.geometry(points, first, Some(rounding));
        // Colours of points are an extension that few read.
        geometry.colours.clear();
        target.create(&geometry, out)
    }

    /// Writes all frames as one GLB: the first as a mesh, the others as its morph targets, and an animation that goes straight from each to
    /// the next. `storage` is empty, and holds the targets until the file is written. Points that no triangle uses are left out.
    ///
    /// # Errors
    /// As [`MeshFrames::write_obj`], and fewer than two frames; numbers beyond what 32 bits hold.
    pub fn write_glb(
        &self,
        storage: &mut dyn Storage,
        out: &mut dyn Write,
    ) -> Result<MorphReport, WriteError> {
        self.check()?;
        let first = &self.frames[0];
        let mut geometry = self.geometry(first, first, None);
        geometry.normals = Values::Points(vec![DVec3::Z; first.len()]);
        let mut glb = Vec::new();
        let (_, sources) = create_traced(&geometry, &mut glb)?;
        let options = ReadOptions::default();
        let document = crate::formats::gltf::Glb
            .read(glb, &options)
            .map_err(|error| refused(error.what, &error.mend))?;
        let base = MorphBase::of(&*document, &options, &NoCompanions)?;
        let mut frames = base.frames(storage);
        let Points::Solid(rest) = document.points() else {
            return Err(refused("the mesh is not in space", "report this"));
        };
        for (number, frame) in self.frames.iter().enumerate() {
            // What is shown first is the mesh as the file has it, rounded to 32 bits.
            let place = |(vertex, source): (usize, &u32)| {
                if number == 0 {
                    rest[vertex]
                } else {
                    self.place(frame[*source as usize])
                }
            };
            let places: Vec<DVec3> = sources.iter().enumerate().map(place).collect();
            frames.add(&Moved::new(Points::Solid(&places)))?;
        }
        let times: Vec<f64> = (0..self.frames.len())
            .map(|i| i as f64 / self.rate)
            .collect();
        let names: Vec<String> = (0..self.frames.len())
            .map(|i| format!("frame {i}"))
            .collect();
        let keys = MorphKeys {
            times: &times,
            names: &names,
            animation: "morph",
        };
        frames.finish(&keys, out)
    }
}
