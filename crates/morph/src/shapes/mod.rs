//! What a shape is, and what it needs before it can be meshed.
//!
//! - [`Shape`]: rings with a [`FillRule`]; [`Shape::regions`] makes of it regions whose rings are simple and touch nowhere, and
//!   lists in [`Mended`] all that had to be changed.
//! - [`pair_parts`]: which part of a drawing becomes which part of another.
//! - [`pair_holes`]: which hole of a region becomes which of another, and where the others open.
//! - [`crossings`]: where rings cross or touch, exactly.
//!
//! Crossing outlines are resolved by the crate `i_overlay` on a grid of whole numbers, a [`GRID_BITS`]th power of two of
//! steps across the drawing. Only new points, where edges cross, lie on the grid; points as given keep their bits, unless
//! that makes edges cross again, when all of the region goes to the grid.
//!
//! *Source*: decisions of the project. Boolean operations with snapping to a grid: J. Hobby, *Practical Segment Intersection with Finite
//! Precision Output*, Computational Geometry 13(4), 1999, is the theory behind them.

mod crossings;
mod inside;
mod mend;
mod pairing;

pub use crossings::{Crossing, crossings};
pub use inside::{clearance, contains, mean_value_weights};
pub use mend::{FillRule, GRID_BITS, Mended, Ring, Shape, ShapeError};
pub(crate) use pairing::carry;
pub use pairing::{HolePairing, Opening, Part, PartPairing, Pieces, pair_holes, pair_parts};

use anamorph_core::glam::DVec2;

/// The area of a closed ring, positive where it goes around counterclockwise with y up.
pub fn area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else {
        return 0.0;
    };
    let twice: f64 = (1..ring.len())
        .map(|i| (ring[i] - origin).perp_dot(ring[(i + 1) % ring.len()] - origin))
        .sum();
    twice * 0.5
}

/// The centroid of what a ring encloses; the mean of its points where that is nothing.
pub fn centroid(ring: &[DVec2]) -> DVec2 {
    let Some(&origin) = ring.first() else {
        return DVec2::ZERO;
    };
    let (mut sum, mut twice) = (DVec2::ZERO, 0.0);
    for i in 1..ring.len() {
        let (p, q) = (ring[i] - origin, ring[(i + 1) % ring.len()] - origin);
        let part = p.perp_dot(q);
        twice += part;
        sum += (p + q) * part;
    }
    let centre = sum / (3.0 * twice);
    if centre.is_finite() {
        return origin + centre;
    }
    let mean: DVec2 = ring.iter().map(|p| *p - origin).sum();
    origin + mean / ring.len() as f64
}
