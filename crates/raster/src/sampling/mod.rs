//! Reading a raster between its pixels.
//!
//! - [`Filter`]: how pixels become a function of the plane, by name. [`Edge`]: what stands beyond the raster, by name.
//! - [`Sampler`]: a raster with both; the elliptical filter's pyramid is built once.
//!
//! Rules that hold for all of them: a tap without weight is not read, so that what is not finite shows where it is
//! sampled and as far as the filter reaches, and no further. A position that is not finite gives zeros. At a pixel's
//! centre every interpolating filter gives that pixel, bit for bit.

mod edge;
mod elliptical;
mod filter;
mod pyramid;
mod separable;

pub use edge::Edge;
pub use filter::Filter;

use crate::Raster;
use anamorph_core::glam::{DMat2, DVec2};
use elliptical::Ellipse;
use filter::Kernel;
use pyramid::Pyramid;
use separable::Grid;

/// A raster ready to be read between its pixels.
#[derive(Debug)]
pub struct Sampler<'a> {
    raster: &'a Raster,
    filter: Filter,
    edge: Edge,
    pyramid: Option<Pyramid>,
}

impl<'a> Sampler<'a> {
    /// Reads `raster` by `filter`, and what lies beyond it by `edge`. For [`Filter::ANISOTROPIC`] this builds the pyramid,
    /// a third more memory.
    pub fn new(raster: &'a Raster, filter: Filter, edge: Edge) -> Self {
        let pyramid = matches!(filter.kernel(), Kernel::Elliptical).then(|| Pyramid::new(raster));
        Self {
            raster,
            filter,
            edge,
            pyramid,
        }
    }

    /// The filter.
    pub fn filter(&self) -> Filter {
        self.filter
    }
    /// The raster that is read.
    pub fn raster(&self) -> &'a Raster {
        self.raster
    }

    /// Writes the value at `position` (pixel coordinates) to `out`, which has a place for every channel.
    ///
    /// `jacobian` is the derivative of the source position by the target position: what a pixel of the target covers.
    /// Only [`Filter::ANISOTROPIC`] reads it; one that is not finite counts as the identity.
    pub fn sample(&self, position: DVec2, jacobian: DMat2, out: &mut [f32]) {
        let local = position - self.raster.window().corner();
        if !local.is_finite() {
            out.fill(0.0);
            return;
        }
        let grid = Grid::new(
            self.raster.samples(),
            self.raster.width(),
            self.raster.height(),
            self.raster.channels(),
            self.edge,
        );
        match (self.filter.kernel(), &self.pyramid) {
            (Kernel::Nearest, _) => separable::nearest(&grid, local, out),
            (Kernel::Separable { taps, weights }, _) => {
                separable::filtered(&grid, local, taps, weights, out);
            }
            (Kernel::Elliptical, Some(pyramid)) => {
                let ellipse = Ellipse::new(jacobian);
                elliptical::filtered(&grid, pyramid, local, &ellipse, out);
            }
            (Kernel::Elliptical, None) => out.fill(0.0),
        }
    }

    /// Fills a row of pixels from their positions, which `position(i)` gives. The same numbers as [`Sampler::sample`].
    #[inline]
    pub(crate) fn row(
        &self,
        position: impl Fn(usize) -> DVec2,
        jacobian: impl Fn(usize) -> DMat2,
        out: &mut [f32],
    ) {
        let channels = self.raster.channels();
        if channels == 4 && self.filter == Filter::BILINEAR {
            let (pixels, _) = out.as_chunks_mut::<4>();
            let corner = self.raster.window().corner();
            let quads = separable::Quads::new(self.raster);
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let position = position(i);
                match quads.bilinear(position - corner) {
                    Some(value) => *pixel = value,
                    None => self.sample(position, DMat2::IDENTITY, pixel),
                }
            }
            return;
        }
        for (i, pixel) in out.chunks_exact_mut(channels).enumerate() {
            self.sample(position(i), jacobian(i), pixel);
        }
    }
}
