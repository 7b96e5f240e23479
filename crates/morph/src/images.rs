//! Metamorphosis of images: both are drawn in the shape between them, and one dissolves into the other.
//!
//! Computes `(1 − c)·A(a(x)) + c·B(b(x))` for the pixels `x` of the in-between, where `a` and `b` lead from the in-between back to the two
//! images and `c` is the share of the colours. Maps are hierarchical where an error is allowed; images that stand still are not resampled, so
//! that the first and the last frame are the images themselves.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992, §3.3; G. Wolberg, *Image Morphing: A Survey*, The
//! Visual Computer 14, 1998; the dissolve is that of [`anamorph_raster::cross_dissolve`].

use crate::grid::{GridWarp, TwoPassMemory, two_pass_into};
use anamorph_core::{Deformation, Plane};
use anamorph_raster::{
    Bound, Edge, Filter, Hierarchy, HierarchyReport, PixelMap, Raster, RasterError, Window,
    dissolve_into, hierarchical_map_into, resample_into,
};

/// What leads from the in-between back to an image.
#[derive(Clone, Copy)]
pub enum Back<'a> {
    /// Nothing moves.
    Still,
    /// A deformation from places of the in-between to places of the image.
    Map(&'a dyn Deformation<Plane>),
    /// Two passes over rows and columns, from a grid on the in-between to one on the image.
    Grid(&'a GridWarp),
}

/// How images are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawing {
    /// How pixels are read between their centres.
    pub filter: Filter,
    /// What stands beyond an image.
    pub edge: Edge,
    /// How far the place of a pixel may be off, in pixels; 0 evaluates the deformation at each of them.
    pub max_error: f64,
}

/// How good maps were, over all that were made.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accuracy {
    /// How many hierarchical maps there were.
    pub maps: usize,
    /// The largest error, in pixels, that was asked for or that rounding makes.
    pub max_error: f64,
    /// The largest error measured, in pixels.
    pub measured: f64,
    /// Whether any map rests on an estimate rather than a bound.
    pub estimated: bool,
    /// Evaluations of deformations.
    pub evaluations: usize,
    /// Pixels that the maps are for.
    pub pixels: usize,
}

impl Accuracy {
    fn add(&mut self, report: &HierarchyReport, pixels: usize) {
        self.maps += 1;
        self.max_error = self.max_error.max(report.max_error);
        self.measured = self.measured.max(report.measured);
        self.estimated |= report.bound == Bound::Estimated;
        self.evaluations += report.evaluations;
        self.pixels += pixels;
    }
}

/// Draws the in-betweens of images of one size, in memory that is made once.
pub struct Mixer {
    map: PixelMap,
    drawn: [Raster; 2],
    memory: TwoPassMemory,
    /// How good the maps were so far.
    pub accuracy: Accuracy,
}

impl Mixer {
    /// Memory for in-betweens of a window with so many channels.
    ///
    /// # Errors
    /// As of [`Raster::new`].
    pub fn new(window: Window, display: Window, channels: usize) -> Result<Self, RasterError> {
        let empty = || Ok(Raster::new(window, channels)?.with_display(display));
        Ok(Self {
            map: PixelMap::identity(window)?,
            drawn: [empty()?, empty()?],
            memory: TwoPassMemory::default(),
            accuracy: Accuracy::default(),
        })
    }

    /// The in-between of two images, `dissolve` from 0 (the colours of the first) to 1. An image whose colours have no share in it is not
    /// looked at.
    ///
    /// # Errors
    /// [`RasterError::Channels`] for images of other channels; [`RasterError::OutOfRange`] for a `dissolve` outside of [0, 1], or an error
    /// that is not allowed.
    pub fn draw(
        &mut self,
        images: [(&Raster, Back<'_>); 2],
        dissolve: f64,
        drawing: &Drawing,
    ) -> Result<&Raster, RasterError> {
        if !(0.0..=1.0).contains(&dissolve) {
            return Err(RasterError::OutOfRange {
                name: "dissolve",
                value: dissolve,
                range: "from 0 to 1",
            });
        }
        let shares = [1.0 - dissolve, dissolve];
        for (number, ((image, back), share)) in images.into_iter().zip(shares).enumerate() {
            if share > 0.0 {
                self.one(number, image, back, drawing)?;
            }
        }
        if dissolve == 1.0 {
            return Ok(&self.drawn[1]);
        }
        let [first, second] = &mut self.drawn;
        if dissolve > 0.0 {
            dissolve_into(first, second, dissolve)?;
        }
        Ok(first)
    }

    fn one(
        &mut self,
        number: usize,
        image: &Raster,
        back: Back<'_>,
        drawing: &Drawing,
    ) -> Result<(), RasterError> {
        let target = &mut self.drawn[number];
        let same = image.window() == target.window() && image.channels() == target.channels();
        match back {
            Back::Still if same => {
                target.samples_mut().copy_from_slice(image.samples());
                return Ok(());
            }
            Back::Grid(warp) => {
                return two_pass_into(image, warp, drawing.edge, &mut self.memory, target);
            }
            Back::Still => self.map = PixelMap::identity(target.window())?,
            Back::Map(deformation) if drawing.max_error == 0.0 => self.map.evaluate(deformation),
            Back::Map(deformation) => {
                let allowed = Hierarchy::within(drawing.max_error);
                let report = hierarchical_map_into(deformation, &allowed, &mut self.map)?;
                self.accuracy.add(&report, self.map.offsets().len());
            }
        }
        resample_into(image, &self.map, drawing.filter, drawing.edge, target)
    }
}
