//! Right-handed orthonormal frames: which way a thing on a path faces, and which way is up for it.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Frenet Frame – local coordinate system": axes `u`, `v`, `w`; errata
//! C10 (`u = v × w`: the slides' `w × v` is a mirror) and C16 (rotation and view matrix are named apart).

use anamorph_core::glam::{DMat3, DMat4, DQuat, DVec3};
use anamorph_core::{Space, math};
use core::f64::consts::PI;

/// Sine of the angle between a direction and an up vector below which they count as parallel. Above it the side vector
/// keeps seven digits.
pub(super) const PARALLEL: f64 = 1e-9;

/// Length of the sum of two unit vectors below which they count as opposite: a millionth of a radian from half a turn. Above
/// it the axis between them keeps nine digits.
const OPPOSITE: f64 = 1e-6;

/// A right-handed orthonormal frame.
///
/// | axis | slides | meaning | object's axis | camera's axis |
/// | --- | --- | --- | --- | --- |
/// | [`side`](Self::side) | `u = v × w` | left of who faces forward | `x` | `−x` |
/// | [`up`](Self::up) | `v` | up | `y` | `y` |
/// | [`forward`](Self::forward) | `w` | direction of motion or view | `z` | `−z` |
///
/// Objects face `+z` and cameras look along `−z`, both with `+y` up, as in glTF and OpenGL. Orthonormal to 1e-15.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Frame {
    forward: DVec3,
    up: DVec3,
}

/// The world's axes: forward along `z`, up along `y`.
impl Default for Frame {
    fn default() -> Self {
        Self {
            forward: DVec3::Z,
            up: DVec3::Y,
        }
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Frame {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        struct Data {
            forward: DVec3,
            up: DVec3,
        }
        let data = Data::deserialize(deserializer)?;
        Self::new(data.forward, data.up).ok_or_else(|| {
            serde::de::Error::custom(
                "a frame's `forward` and `up` must be vectors that are not parallel",
            )
        })
    }
}

impl Frame {
    /// The frame that faces `forward` with its up axis as near to `up` as can be (errata C10: `u = up × w`, `v = w × u`).
    /// Neither needs unit length. `None` where one is null or not finite, or where they are parallel (to 1e-9 radians).
    #[must_use]
    pub fn new(forward: DVec3, up: DVec3) -> Option<Self> {
        let (w, up) = (Space::normalized(forward)?, Space::normalized(up)?);
        let side = up.cross(w);
        let sine = Space::length(side);
        (sine > PARALLEL).then(|| Self {
            forward: w,
            up: w.cross(side / sine),
        })
    }

    /// As [`Self::new`], with an answer where `forward` and `up` are parallel: that of someone who faced
    /// [`heading`]`(up)` and then tilted straight up or down, so that `up` of the frame is against or along the heading. A
    /// direction that is null or not finite counts as the heading itself, an up vector as the `y` axis.
    #[must_use]
    pub fn level(forward: DVec3, up: DVec3) -> Self {
        let up = Space::normalized(up).unwrap_or(DVec3::Y);
        let ahead = heading(up);
        let w = Space::normalized(forward).unwrap_or(ahead);
        let tilted = if w.dot(up) > 0.0 { -ahead } else { ahead };
        Self::new(w, up)
            .or_else(|| Self::new(w, tilted))
            .unwrap_or_default()
    }

    /// The frame of a unit direction and a vector that is nearly perpendicular to it.
    pub(super) fn nearly(forward: DVec3, up: DVec3) -> Self {
        Self::new(forward, up).unwrap_or_else(|| Self::level(forward, DVec3::Y))
    }

    /// `u`: to the left of who faces forward, `up × forward`.
    #[must_use]
    pub fn side(&self) -> DVec3 {
        self.up.cross(self.forward)
    }

    /// `v`: up.
    #[must_use]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// `w`: the direction of motion or view.
    #[must_use]
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The rotation of an object: columns `u`, `v`, `w`; carries the object's axes to the world's. The object faces `+z`.
    #[must_use]
    pub fn to_matrix(&self) -> DMat3 {
        DMat3::from_cols(self.side(), self.up, self.forward)
    }

    /// [`Self::to_matrix`] as a unit quaternion.
    #[must_use]
    pub fn to_quaternion(&self) -> DQuat {
        DQuat::from_mat3(&self.to_matrix()).normalize()
    }

    /// The frame of an object's rotation, the inverse of [`Self::to_quaternion`]. A quaternion that is null or not finite gives
    /// the world's axes.
    #[must_use]
    pub fn from_quaternion(rotation: DQuat) -> Self {
        let length = rotation.length();
        if !(length > 0.0 && length.is_finite()) {
            return Self::default();
        }
        let q = rotation / length;
        Self::new(q * DVec3::Z, q * DVec3::Y).unwrap_or_default()
    }

    /// The *rotation* of a camera, camera to world: columns right `−u`, up `v`, back `−w`. The camera looks along `−z`.
    #[must_use]
    pub fn camera_to_world(&self) -> DMat3 {
        DMat3::from_cols(-self.side(), self.up, -self.forward)
    }

    /// [`Self::camera_to_world`] as a unit quaternion.
    #[must_use]
    pub fn camera_quaternion(&self) -> DQuat {
        DQuat::from_mat3(&self.camera_to_world()).normalize()
    }

    /// The *view matrix* of a camera at `eye`, world to camera: the inverse of its rotation and position, as `gluLookAt` gives
    /// it. Points in front of the camera get negative `z`.
    #[must_use]
    pub fn view_matrix(&self, eye: DVec3) -> DMat4 {
        let to_camera = self.camera_to_world().transpose();
        DMat4::from_mat3_translation(to_camera, -(to_camera * eye))
    }

    /// The frame turned about its direction by `angle` radians, by the right-hand rule: seen by who faces forward,
    /// clockwise, the head towards the right.
    #[must_use]
    pub fn rolled(&self, angle: f64) -> Self {
        if angle == 0.0 {
            return *self;
        }
        let (sin, cos) = math::sin_cos(angle);
        let up = self.up * cos + self.forward.cross(self.up) * sin;
        Self::new(self.forward, up).unwrap_or(*self)
    }

    /// The frame turned by the smallest rotation that carries its direction to `forward`. Where that is opposite (to 1e-6
    /// radians), there is no smallest: it turns about its up axis, which stays. A direction that is null or not finite changes
    /// nothing.
    #[must_use]
    pub fn turned(&self, forward: DVec3) -> Self {
        let Some(to) = Space::normalized(forward) else {
            return *self;
        };
        let sum = self.forward + to;
        let squared = sum.length_squared();
        if squared <= OPPOSITE * OPPOSITE {
            return Self::nearly(to, self.up);
        }
        // x ↦ x − (a + b)(a + b)·x/(1 + a·b) + 2b(a·x), where a·x = 0 and 1 + a·b = |a + b|²/2 does not cancel.
        let up = self.up - sum * (2.0 * to.dot(self.up) / squared);
        Self::nearly(to, up)
    }

    /// The angle in radians, in (−π, π], by which this frame must be [`rolled`](Self::rolled) to become `other`, after the
    /// smallest rotation that makes their directions equal.
    #[must_use]
    pub fn twist_to(&self, other: &Self) -> f64 {
        let here = if self.forward == other.forward {
            *self
        } else {
            self.turned(other.forward)
        };
        let sine = other.up.dot(here.forward.cross(here.up));
        let angle = math::atan2(sine, other.up.dot(here.up));
        if angle <= -PI { PI } else { angle }
    }

    /// Double reflection: the frame carried along `chord` to where the direction is `forward`, a unit vector. Where the chord
    /// says nothing, by the smallest rotation.
    pub(super) fn reflected(&self, chord: Option<DVec3>, forward: DVec3) -> Self {
        let Some(first) = chord.and_then(Space::normalized) else {
            return self.turned(forward);
        };
        let mirror = |x: DVec3, n: DVec3, squared: f64| x - n * (2.0 * n.dot(x) / squared);
        let (up, along) = (
            mirror(self.up, first, 1.0),
            mirror(self.forward, first, 1.0),
        );
        let second = forward - along;
        let squared = second.length_squared();
        if squared < 0.25 {
            // The chord lies across both directions: no reflection along it.
            return self.turned(forward);
        }
        Self::nearly(forward, mirror(up, second, squared))
    }
}

/// Where someone faces who stands upright along `up` and looks nowhere in particular: the part of a coordinate axis that
/// is perpendicular to `up`: of `z`, or of `x` where `up` is within a quarter of a right angle of `z`. For `up = y` that is `z`.
#[must_use]
pub fn heading(up: DVec3) -> DVec3 {
    let up = Space::normalized(up).unwrap_or(DVec3::Y);
    let axis = if up.z.abs() < 0.92 {
        DVec3::Z
    } else {
        DVec3::X
    };
    let across = axis - up * up.dot(axis);
    Space::normalized(across).unwrap_or(DVec3::Z)
}
