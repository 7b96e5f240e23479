//! How a picture is taken: its size, its colours, its camera.

use anamorph_core::glam::DVec3;
use core::f64::consts::{FRAC_PI_2, PI};

use crate::PreviewError;

/// Least width and height of a picture, in pixels.
pub(crate) const LEAST_SIDE: u32 = 32;
/// Greatest width and height of a picture, in pixels.
pub(crate) const MOST_SIDE: u32 = 16_384;
/// Greatest number of samples in a picture (4 × 4 in a picture of 3840 × 2160); it bounds the memory at about 1.5 GiB.
pub(crate) const MOST_SAMPLES: u64 = 1 << 27;

/// Light or dark surroundings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// A near-white studio.
    #[default]
    Light,
    /// A charcoal studio.
    Dark,
}

/// Which coordinate axis points up in the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// `+x` up; the front is `+z`, the right `−y`.
    X,
    /// `+y` up; the front is `+z`, the right `+x` (glTF and most OBJ files).
    #[default]
    Y,
    /// `+z` up; the front is `−y`, the right `+x` (CAD, scans, terrain).
    Z,
}

/// How depth becomes smaller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Parallel lines stay parallel.
    Orthographic,
    /// Lines meet at a distance.
    Perspective {
        /// Angle between the upper and the lower edge of a panel, radians, above 0 and below 2.6.
        field_of_view: f64,
    },
}

/// From where a model in space is seen. The distance follows from the model: all of it is in the picture.
///
/// Models in the plane are seen straight from the front, `x` to the right and `y` up; the camera is not read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where the camera stands around the model, radians: 0 before its front, positive towards its right (the right of
    /// the picture as seen from the front), π behind it.
    pub azimuth: f64,
    /// How high the camera stands, radians from `−π/2` (below) to `π/2` (above).
    pub elevation: f64,
    /// What is up.
    pub up: Up,
    /// Perspective or not.
    pub projection: Projection,
}

impl Default for Camera {
    /// Three-quarter view from the front right and slightly above, long lens.
    fn default() -> Self {
        Self {
            azimuth: PI / 180.0 * 35.0,
            elevation: PI / 180.0 * 18.0,
            up: Up::Y,
            projection: Projection::Perspective {
                field_of_view: PI / 180.0 * 24.0,
            },
        }
    }
}

impl Camera {
    /// The default view taken from the other end: for models that look along the negative front axis.
    #[must_use]
    pub fn from_behind(self) -> Self {
        Self {
            azimuth: self.azimuth + PI,
            ..self
        }
    }

    /// The same camera with another axis up.
    #[must_use]
    pub fn with_up(self, up: Up) -> Self {
        Self { up, ..self }
    }

    /// The same camera at another place, both angles in radians.
    #[must_use]
    pub fn at(self, azimuth: f64, elevation: f64) -> Self {
        Self {
            azimuth,
            elevation,
            ..self
        }
    }

    /// The same camera gone round the model by an angle in radians.
    #[must_use]
    pub fn turned(self, angle: f64) -> Self {
        Self {
            azimuth: self.azimuth + angle,
            ..self
        }
    }

    pub(crate) fn check(&self) -> Result<(), PreviewError> {
        if !self.azimuth.is_finite() {
            return Err(PreviewError::Camera {
                what: "azimuth",
                value: self.azimuth,
                mend: "a finite angle in radians",
            });
        }
        if !self.elevation.is_finite() || self.elevation.abs() > FRAC_PI_2 + 1e-9 {
            return Err(PreviewError::Camera {
                what: "elevation",
                value: self.elevation,
                mend: "an angle in radians from −π/2 to π/2",
            });
        }
        if let Projection::Perspective { field_of_view } = self.projection
            && !(field_of_view > 1e-3 && field_of_view < 2.6)
        {
            return Err(PreviewError::Camera {
                what: "field of view",
                value: field_of_view,
                mend: "an angle in radians above 0.001 and below 2.6, or an orthographic projection",
            });
        }
        Ok(())
    }
}

/// How a picture is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Width of the whole picture in pixels, 32 to 16 384.
    pub width: u32,
    /// Height of the whole picture in pixels, 32 to 16 384.
    pub height: u32,
    /// Light or dark.
    pub theme: Theme,
    /// From where.
    pub camera: Camera,
    /// Samples along each side of a pixel, 1 to 8: 3 means that a pixel is the mean of 9.
    pub samples: u32,
    /// Whether the picture has room for the model seen from every azimuth, so that a series of pictures of a camera that
    /// goes round does not jump.
    pub turning: bool,
    /// Two corners of a box for which there must be room, too, so that a series of pictures of a model that moves does not jump.
    pub around: Option<[DVec3; 2]>,
}

impl Default for Options {
    /// 1600 × 900 pixels, light, three-quarter view, 3 × 3 samples.
    fn default() -> Self {
        Self {
            width: 1600,
            height: 900,
            theme: Theme::Light,
            camera: Camera::default(),
            samples: 3,
            turning: false,
            around: None,
        }
    }
}

impl Options {
    /// Whether a picture can be taken so; every drawing function begins with it.
    ///
    /// # Errors
    ///
    /// [`PreviewError::Size`] and [`PreviewError::Camera`].
    pub fn check(&self) -> Result<(), PreviewError> {
        let sides = LEAST_SIDE..=MOST_SIDE;
        let total = u64::from(self.width)
            .saturating_mul(u64::from(self.height))
            .saturating_mul(u64::from(self.samples).saturating_mul(u64::from(self.samples)));
        if !sides.contains(&self.width)
            || !sides.contains(&self.height)
            || !(1..=8).contains(&self.samples)
            || total > MOST_SAMPLES
        {
            return Err(PreviewError::Size {
                width: self.width,
                height: self.height,
                samples: self.samples,
                least: LEAST_SIDE,
                most: MOST_SIDE,
                budget: MOST_SAMPLES,
            });
        }
        self.camera.check()
    }
}
