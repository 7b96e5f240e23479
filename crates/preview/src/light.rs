//! Light on the model: a sky all around and a key light of some breadth, both with true shadows.
//!
//! Each light is a depth map of the model seen from its direction (L. Williams, *Casting curved shadows on curved
//! surfaces*, SIGGRAPH 1978); the mean over many directions is the ambient occlusion (S. Zhukov, A. Iones, G. Kronin,
//! *An ambient light illumination model*, EGWR 1998) and the soft shadow of the key light at once. The directions are
//! fixed relative to the camera, so that every view is lit well, and sums run in their order: the result does not
//! depend on threads.

use anamorph_core::glam::DVec3;

use crate::mesh::Mesh;
use crate::parallel;
use crate::shadow::{Casters, Map, Room, dot};
use crate::view::View;

/// Side of a depth map of the sky and of the key light. A shadow's finest detail is about the model's size over half of
/// this.
const SIDES: [usize; 2] = [320, 512];
/// Directions of the sky, and of the key light. Fewer show as bands in soft shadows; more cost time.
const DIRECTIONS: [usize; 2] = [160, 32];
/// Sine of the key light's angular radius: the softness of its shadow.
const KEY_BREADTH: f64 = 0.13;
/// Depth maps held at a time.
const BATCH: usize = 8;

/// A place that receives light, and what it has received.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Receiver {
    /// Place in the frame.
    pub point: [f32; 3],
    /// Unit normal towards the viewer; null for a small dot, which receives from all sides alike.
    pub normal: [f32; 3],
    /// Nearness; negative infinity where nothing receives.
    pub near: f32,
    /// Light of the sky and of its reflection from the floor: 1 for an open place that faces up.
    pub sky: [f32; 3],
    /// Visible part of the key light, 0 to 1, whatever the normal.
    pub key: f32,
}

/// A set of parallel lights.
#[derive(Debug)]
pub(crate) struct Lights {
    /// Unit vector to the middle of the key light.
    pub key: DVec3,
    /// Unit vector to the fill light, which casts no shadow.
    pub fill: DVec3,
    lights: Vec<Light>,
}

#[derive(Debug, Clone, Copy)]
struct Light {
    /// Unit vector to the light.
    direction: DVec3,
    /// Contribution to the sky; null for a part of the key light.
    sky: [f32; 3],
    /// Contribution to the key light.
    key: f32,
}

impl Lights {
    /// The lights for a camera.
    pub(crate) fn new(view: &View) -> Self {
        let up = view.up;
        let side = view.right;
        let front = side.cross(up);
        // From the upper left of the camera, as in most drawings.
        let key = (front * 0.78 - side * 0.60 + up * 1.12).normalize();
        let [sky_count, key_count] = DIRECTIONS;
        let mut lights = Vec::with_capacity(sky_count + key_count);
        let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        for index in 0..sky_count {
            let height = 1.0 - (2.0 * index as f64 + 1.0) / sky_count as f64;
            let (sin, cos) = (golden * index as f64 + 0.4).sin_cos();
            let level = (1.0 - height * height).sqrt();
            let direction = side * (level * cos) + front * (level * sin) + up * height;
            // The mean of max(0, n·d) over the sphere is a quarter.
            let weight = 4.0 / sky_count as f64;
            lights.push(Light {
                direction,
                sky: sky_colour(height).map(|part| (part * weight) as f32),
                key: 0.0,
            });
        }
        let (across, along) = key.any_orthonormal_pair();
        for index in 0..key_count {
            let radius = KEY_BREADTH * ((index as f64 + 0.5) / key_count as f64).sqrt();
            let (sin, cos) = (golden * index as f64).sin_cos();
            let direction = (key + across * (radius * cos) + along * (radius * sin)).normalize();
            lights.push(Light {
                direction,
                sky: [0.0; 3],
                key: 1.0 / key_count as f32,
            });
        }
        let fill = (front * 0.35 + side * 0.9 + up * 0.25).normalize();
        Self { key, fill, lights }
    }

    /// Adds to every receiver the light that reaches it past the model.
    pub(crate) fn cast(&self, mesh: &Mesh, receivers: &mut [Receiver]) {
        let Some(room) = Room::of(mesh) else { return };
        let casters = SIDES.map(|side| Casters::new(mesh, &room, side));
        let mut maps: Vec<Map> = (0..BATCH).map(|_| Map::new()).collect();
        for batch in self.lights.chunks(BATCH) {
            parallel::chunks(&mut maps[..batch.len()], 1, |number, maps| {
                for map in maps {
                    let light = &batch[number];
                    map.render(&casters[usize::from(light.key > 0.0)], light.direction);
                }
            });
            parallel::chunks(receivers, 1 << 12, |_, chunk| {
                for receiver in chunk
                    .iter_mut()
                    .filter(|receiver| receiver.near > f32::NEG_INFINITY)
                {
                    for (light, map) in batch.iter().zip(&maps) {
                        let facing = if receiver.normal == [0.0; 3] {
                            0.5
                        } else {
                            dot(receiver.normal, map.direction())
                        };
                        if facing > 0.0 {
                            let visible = map.visible(receiver.point, receiver.normal);
                            receiver.sky = [0, 1, 2]
                                .map(|k| receiver.sky[k] + light.sky[k] * (facing * visible));
                            receiver.key += light.key * visible;
                        }
                    }
                }
            });
        }
    }
}

/// Light from a direction of the given height (−1 to 1): cool from above, warm and dim from the floor.
fn sky_colour(height: f64) -> [f64; 3] {
    let zenith = [0.97, 1.0, 1.05];
    let horizon = [0.92, 0.93, 0.95];
    let floor = [0.50, 0.46, 0.42];
    let blend = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t);
    if height > 0.0 {
        blend(horizon, zenith, height)
    } else {
        blend(horizon, floor, (-height * 3.0).min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Frame;
    use crate::{Camera, Model};

    fn open_receiver(point: DVec3, normal: DVec3) -> Receiver {
        Receiver {
            point: point.to_array().map(|part| part as f32),
            normal: normal.to_array().map(|part| part as f32),
            near: 1.0,
            ..Receiver::default()
        }
    }

    /// A roof of two triangles at height 0.5 over the origin.
    fn roof() -> Mesh {
        let points = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, z)| DVec3::new(x, 0.5, z));
        let frame = Frame {
            centre: DVec3::ZERO,
            half: 1.0,
        };
        Mesh::new(&Model::mesh(&points, &[[0, 1, 2], [0, 2, 3]]), &frame)
    }

    #[test]
    fn open_sky_is_one_and_a_roof_takes_most_of_it() {
        let view = View::fit(
            &Camera::default(),
            [100, 100],
            core::iter::once(DVec3::ZERO),
        );
        let lights = Lights::new(&view);
        let roof = roof();
        let mut receivers = [
            open_receiver(DVec3::Y, DVec3::Y),
            open_receiver(DVec3::ZERO, DVec3::Y),
        ];
        lights.cast(&roof, &mut receivers);
        assert!(
            (receivers[0].sky[1] - 0.98).abs() < 0.03,
            "{:?}",
            receivers[0]
        );
        assert!((receivers[0].key - 1.0).abs() < 1e-5);
        // Seen from the middle of the floor the roof covers all directions steeper than about 27° to 35°.
        assert!(receivers[1].sky[1] < 0.4, "{:?}", receivers[1]);
        assert!(receivers[1].sky[1] > 0.1, "{:?}", receivers[1]);
    }

    #[test]
    fn a_surface_does_not_shade_itself() {
        let view = View::fit(
            &Camera::default(),
            [100, 100],
            core::iter::once(DVec3::ZERO),
        );
        let lights = Lights::new(&view);
        let mut receivers: Vec<Receiver> = (-9..=9)
            .map(|step| open_receiver(DVec3::new(f64::from(step) * 0.1, 0.5, 0.03), DVec3::Y))
            .collect();
        lights.cast(&roof(), &mut receivers);
        assert!(receivers.iter().all(|receiver| receiver.key > 0.999));
    }
}
