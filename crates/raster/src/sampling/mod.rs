//! Reading a raster between its pixels.
//!
//! - [`Filter`]: how pixels become a function of the plane, by name. [`Edge`]: what stands beyond the raster, by name.
//! - [`Sampler`]: a raster with both; the elliptical filter's pyramid is built once.
//!
//! Rules that hold for all of them: a tap without weight is not read, so that what is not finite shows where it is
//! sampled and as far as the filter reaches, and no further. A position that is not finite gives zeros. At a pixel's
//! centre every interpolating filter gives that pixel, bit for bit.

mod edge;
mod ellipses;
mod elliptical;
mod filter;
mod pyramid;
mod separable;

pub use edge::Edge;
pub use filter::Filter;

use crate::Raster;
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::simd::{Level, dispatch};
pub(crate) use ellipses::Around;
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
        self.sample_at(position - self.raster.window().corner(), jacobian, out);
    }

    /// The same for a position from the raster's corner.
    #[inline(always)]
    fn sample_at(&self, local: DVec2, jacobian: DMat2, out: &mut [f32]) {
        if !local.is_finite() {
            out.fill(0.0);
            return;
        }
        let grid = self.grid();
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

    #[inline(always)]
    fn one_by_one<'b>(
        &self,
        pixels: impl Iterator<Item = ((usize, DVec2), &'b mut [f32])>,
        jacobian: impl Fn(usize) -> DMat2,
    ) {
        for ((i, at), pixel) in pixels {
            self.sample_at(at, jacobian(i), pixel);
        }
    }

    fn grid(&self) -> Grid<'a> {
        Grid::new(
            self.raster.samples(),
            self.raster.width(),
            self.raster.height(),
            self.raster.channels(),
            self.edge,
        )
    }

    /// Fills a row of pixels: from `first`, the centre of the first, and the offsets of their source positions. The same
    /// numbers as [`Sampler::sample`], but that small offsets are not rounded to the precision of large positions.
    pub(crate) fn row(
        &self,
        first: DVec2,
        offsets: &[[f32; 2]],
        around: &Around<'_>,
        out: &mut [f32],
    ) {
        let channels = self.raster.channels();
        // From the raster's corner, once for all: the same rounding in all ways through.
        let first = first - self.raster.window().corner();
        let positions = (0..).zip(offsets).map(|(column, offset): (u32, _)| {
            let [x, y] = offset.map(f64::from);
            dvec2(first.x + f64::from(column) + x, first.y + y)
        });
        let grid = self.grid();
        let slow = |at: DVec2, pixel: &mut [f32]| {
            self.sample_at(at, DMat2::IDENTITY, pixel);
        };
        if let Kernel::Separable { taps, weights } = self.filter.kernel() {
            macro_rules! quick {
                ($taps:literal, $weights:expr, $($channels:literal)*) => {
                    match channels {
                        $($channels => return separable::row::<$taps, $channels>(
                            &grid, $weights, first, offsets, out, slow,
                        ),)*
                        _ => {}
                    }
                };
            }
            if self.filter == Filter::BILINEAR {
                quick!(2, |t| [1.0 - t, t], 1 2 3 4);
            } else if self.filter == Filter::CATMULL_ROM {
                quick!(4, |t| first_weights(filter::catmull_rom, t), 1 2 3 4);
            } else if self.filter == Filter::MITCHELL {
                quick!(4, |t| first_weights(filter::mitchell, t), 1 2 3 4);
            } else if taps == 6 {
                quick!(6, |t| first_weights(weights, t), 1 2 3 4);
            }
        }
        if let (Kernel::Elliptical, Some(pyramid)) = (self.filter.kernel(), &self.pyramid) {
            let slow = |at: DVec2, ellipse: &Ellipse, pixel: &mut [f32]| {
                if at.is_finite() {
                    elliptical::filtered(&grid, pyramid, at, ellipse, pixel);
                } else {
                    pixel.fill(0.0);
                }
            };
            macro_rules! quick {
                ($($channels:literal)*) => {
                    match channels {
                        $($channels => return ellipses::row::<$channels>(
                            &grid, first, offsets, around, out, slow,
                        ),)*
                        _ => {}
                    }
                };
            }
            quick!(1 3 4);
        }
        let jacobian = |column: usize| around.jacobian(column, offsets);
        let pixels = positions.enumerate().zip(out.chunks_exact_mut(channels));
        // With the processor's widest vectors; their operations are the same as without.
        dispatch!(Level::new(), _v => self.one_by_one(pixels, jacobian));
    }
}

/// The first weights of a filter.
#[inline(always)]
fn first_weights<const T: usize>(
    weights: impl Fn(f64, &mut [f64; filter::TAPS]),
    t: f32,
) -> [f32; T] {
    let mut list = [0.0; filter::TAPS];
    weights(f64::from(t), &mut list);
    core::array::from_fn(|tap| list[tap] as f32)
}
