//! From scene units to pixels: one frame and one camera for all panels of a picture.

use anamorph_core::glam::DVec3;

use crate::{Camera, Projection, Up};

/// Maps the bounds of everything drawn to the cube from −1 to 1 about the origin, whatever the magnitude.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Centre of the bounds, scene units.
    pub centre: DVec3,
    /// Half the longest side of the bounds, scene units; 0 for a single place.
    pub half: f64,
}

impl Frame {
    /// The frame of the finite points among `points`; `None` if there are none.
    pub(crate) fn around(points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let mut least = DVec3::INFINITY;
        let mut most = DVec3::NEG_INFINITY;
        for point in points.filter(|point| point.is_finite()) {
            least = least.min(point);
            most = most.max(point);
        }
        if least.x > most.x {
            return None;
        }
        // Halved first: the sum and the difference of two finite numbers may overflow.
        let centre = least * 0.5 + most * 0.5;
        let half = (most * 0.5 - least * 0.5).max_element();
        Some(Self { centre, half })
    }

    /// The point in the frame.
    pub(crate) fn place(&self, point: DVec3) -> DVec3 {
        if self.half > 0.0 {
            // The added zero turns −0 into 0, so that equal places have equal bits.
            (point * 0.5 - self.centre * 0.5) / self.half * 2.0 + DVec3::ZERO
        } else {
            DVec3::ZERO
        }
    }
}

/// Right, up and front of the scene in its own coordinates.
fn scene_axes(up: Up) -> [DVec3; 3] {
    match up {
        Up::X => [DVec3::NEG_Y, DVec3::X, DVec3::Z],
        Up::Y => [DVec3::X, DVec3::Y, DVec3::Z],
        Up::Z => [DVec3::X, DVec3::Z, DVec3::NEG_Y],
    }
}

/// A place in the picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pixel {
    /// Pixels from the left edge of the panel.
    pub x: f64,
    /// Pixels from the upper edge of the panel.
    pub y: f64,
    /// Nearness: greater is nearer to the camera, and it is linear over the picture along any straight line.
    pub near: f64,
}

/// A camera aimed at a panel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    /// Unit vector to the right of the picture, in the frame.
    pub right: DVec3,
    /// Unit vector to its top.
    pub top: DVec3,
    /// Unit vector towards the camera.
    pub toward: DVec3,
    /// What is up in the scene.
    pub up: DVec3,
    /// Size of the panel in pixels.
    pub size: [usize; 2],
    perspective: bool,
    /// Pixels per unit at distance 1 (perspective) or everywhere (orthographic).
    scale: f64,
    /// Where the axis of the camera passes, along `right` and `top`.
    axis: [f64; 2],
    /// Place of the camera along `toward`.
    distance: f64,
}

/// Room kept free around what is drawn, as a part of the shorter side of the panel. Less and the marks' round ends and
/// the shadow touch the edge; more and the model looks lost.
const MARGIN: f64 = 0.075;

impl View {
    /// The tightest view of `points` (in the frame, finite) from the direction of `camera` in a panel of `size` pixels.
    ///
    /// For a perspective camera with tangent `t` at the edge, a point at `(x, z)` is inside when
    /// `|x − a| ≤ t (d − z)`; with `u = max(x + t z)` and `v = max(−x + t z)` the nearest camera stands at
    /// `d = (u + v) / 2t` on the axis `a = (u − v) / 2`.
    pub(crate) fn fit(
        camera: &Camera,
        size: [usize; 2],
        points: impl Iterator<Item = DVec3>,
    ) -> Self {
        let [right, up, front] = scene_axes(camera.up);
        let (sin_a, cos_a) = camera.azimuth.sin_cos();
        let (sin_e, cos_e) = camera.elevation.sin_cos();
        let level = front * cos_a + right * sin_a;
        let mut view = Self {
            right: right * cos_a - front * sin_a,
            top: up * cos_e - level * sin_e,
            toward: level * cos_e + up * sin_e,
            up,
            size,
            perspective: false,
            scale: 1.0,
            axis: [0.0; 2],
            distance: 0.0,
        };
        let [width, height] = [size[0] as f64, size[1] as f64];
        let margin = MARGIN * width.min(height);
        let tangent = match camera.projection {
            Projection::Orthographic => 0.0,
            Projection::Perspective { field_of_view } => {
                view.perspective = true;
                (field_of_view * 0.5).tan()
            }
        };
        let tangents = [
            tangent * (width - 2.0 * margin) / height,
            tangent * (height - 2.0 * margin) / height,
        ];
        let mut reach = [[f64::NEG_INFINITY; 2]; 2];
        let mut nearest = f64::NEG_INFINITY;
        for point in points {
            let z = point.dot(view.toward);
            nearest = nearest.max(z);
            for (side, along) in [view.right, view.top].into_iter().enumerate() {
                let x = point.dot(along);
                reach[side][0] = reach[side][0].max(x + tangents[side] * z);
                reach[side][1] = reach[side][1].max(-x + tangents[side] * z);
            }
        }
        if nearest == f64::NEG_INFINITY {
            nearest = 0.0;
            reach = [[0.0; 2]; 2];
        }
        view.axis = reach.map(|[u, v]| (u - v) * 0.5);
        if view.perspective {
            let needed =
                (0..2).map(|side| (reach[side][0] + reach[side][1]) / (2.0 * tangents[side]));
            // A single place needs no distance at all; stand where the unit cube would be seen.
            view.distance = needed.fold(nearest + 0.5, f64::max);
            view.scale = height * 0.5 / tangent;
        } else {
            let extent = reach.map(|[u, v]| (u + v) * 0.5);
            let scale = (0..2)
                .map(|side| (size[side] as f64 * 0.5 - margin) / extent[side].max(1e-9))
                .fold(f64::INFINITY, f64::min);
            // Ditto: no closer than a cube a tenth of the frame's.
            view.scale = scale.min(width.min(height) * 5.0);
            view.distance = nearest + 1.0;
        }
        view
    }

    /// The tightest view of all that `points` sweep when the scene turns about its vertical axis through the origin: the same
    /// from every azimuth but for the turn.
    pub(crate) fn fit_turning(
        camera: &Camera,
        size: [usize; 2],
        points: impl Iterator<Item = DVec3>,
    ) -> Self {
        /// Heights that are told apart, and azimuths of each ring: fine enough to be off by less than a pixel.
        const HEIGHTS: usize = 256;
        const AZIMUTHS: u32 = 64;
        let [right, up, front] = scene_axes(camera.up);
        // The largest ring and the extreme heights in each slice of the frame's cube.
        let mut slices = [None::<(f64, f64, f64)>; HEIGHTS];
        for point in points {
            let height = point.dot(up);
            let radius = point.dot(right).hypot(point.dot(front));
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let slice = ((height + 1.0) * 0.5 * (HEIGHTS - 1) as f64).max(0.0) as usize;
            let slot = &mut slices[slice.min(HEIGHTS - 1)];
            let (largest, low, high) = slot.unwrap_or((radius, height, height));
            *slot = Some((largest.max(radius), low.min(height), high.max(height)));
        }
        let rings = slices.iter().flatten();
        let swept = rings.flat_map(|&(radius, low, high)| {
            (0..AZIMUTHS).flat_map(move |step| {
                let turn = f64::from(step) / f64::from(AZIMUTHS) * core::f64::consts::TAU;
                let (sin, cos) = (camera.azimuth + turn).sin_cos();
                let out = (front * cos + right * sin) * radius;
                [out + up * low, out + up * high]
            })
        });
        Self::fit(camera, size, swept)
    }

    /// Straight from the front with `x` right and `y` up, for the plane.
    pub(crate) fn fit_plane(size: [usize; 2], points: impl Iterator<Item = DVec3>) -> Self {
        let camera = Camera {
            azimuth: 0.0,
            elevation: 0.0,
            up: Up::Y,
            projection: Projection::Orthographic,
        };
        Self::fit(&camera, size, points)
    }

    /// Where a point of the frame appears.
    pub(crate) fn project(&self, point: DVec3) -> Pixel {
        let x = point.dot(self.right) - self.axis[0];
        let y = point.dot(self.top) - self.axis[1];
        let distance = self.distance - point.dot(self.toward);
        let (factor, near) = if self.perspective {
            (self.scale / distance, 1.0 / distance)
        } else {
            (self.scale, -distance)
        };
        Pixel {
            x: self.size[0] as f64 * 0.5 + x * factor,
            y: self.size[1] as f64 * 0.5 - y * factor,
            near,
        }
    }

    /// Distance from the camera's plane, from the nearness.
    pub(crate) fn distance_of(&self, near: f64) -> f64 {
        if self.perspective { 1.0 / near } else { -near }
    }

    /// Nearness at a distance from the camera's plane.
    pub(crate) fn nearness(&self, distance: f64) -> f64 {
        if self.perspective {
            1.0 / distance
        } else {
            -distance
        }
    }

    /// Length in the frame of one pixel at a distance.
    pub(crate) fn pixel_length(&self, distance: f64) -> f64 {
        if self.perspective {
            distance / self.scale
        } else {
            1.0 / self.scale
        }
    }

    /// The ray through a place in the picture: origin and direction (away from the camera).
    pub(crate) fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let x = (x - self.size[0] as f64 * 0.5) / self.scale;
        let y = (self.size[1] as f64 * 0.5 - y) / self.scale;
        let base =
            self.right * self.axis[0] + self.top * self.axis[1] + self.toward * self.distance;
        if self.perspective {
            (base, self.right * x + self.top * y - self.toward)
        } else {
            (base + self.right * x + self.top * y, -self.toward)
        }
    }

    /// Weights of the corners of a triangle in space, from those in the picture and the corners' nearness.
    pub(crate) fn true_weights(&self, weights: [f64; 3], near: [f64; 3]) -> [f64; 3] {
        if !self.perspective {
            return weights;
        }
        let scaled = [
            weights[0] * near[0],
            weights[1] * near[1],
            weights[2] * near[2],
        ];
        let sum = scaled[0] + scaled[1] + scaled[2];
        if sum > 0.0 {
            scaled.map(|weight| weight / sum)
        } else {
            weights
        }
    }

    /// Unit vector from a point of the frame towards the camera.
    pub(crate) fn toward_camera(&self, point: DVec3) -> DVec3 {
        if !self.perspective {
            return self.toward;
        }
        let eye = self.right * self.axis[0] + self.top * self.axis[1] + self.toward * self.distance;
        (eye - point).normalize_or(self.toward)
    }
}
