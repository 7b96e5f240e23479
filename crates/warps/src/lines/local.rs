//! Feature lines: directed segments of the plane are carried to their targets, and the rest follows.
//!
//! Computes eq. (3) with `T_i` the map of the frame `(P, Q − P, N)`, `N` the unit normal of the segment, to that of the
//! target, strength 1 and weight `(length^p / (a + d))^b`, `d` the distance to the segment. Of the frame's axes only the one
//! along the line scales with it.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992; Milliron et al. 2002, §4.2, Fig. 11.
//! Errata F6, C18 (the coordinate across is signed, and a length).

use super::elements::ElementWarp;
use super::{ElementError, WeightConstants};
use anamorph_core::{Plane, Scaling};
use anamorph_features::ElementPair;

/// Refuses what is no segment.
pub(super) fn check_lines(
    lines: &[(ElementPair<Plane>, WeightConstants)],
) -> Result<(), ElementError> {
    let odd = lines.iter().position(|(p, _)| p.source.dimension() != 1);
    odd.map_or(Ok(()), |feature| {
        Err(ElementError::NoLine {
            feature,
            corners: lines[feature].0.source.dimension() + 1,
        })
    })
}

/// The warp that carries every source line to its target. A source line without length is a point and moves without
/// turning; a target line without length keeps the direction across of its source.
///
/// # Errors
/// [`ElementError`] for elements that are no segments, constants that are negative or not finite, and lines whose map
/// overflows.
pub fn construct(
    lines: &[(ElementPair<Plane>, WeightConstants)],
    scaling: Scaling,
) -> Result<ElementWarp<Plane>, ElementError> {
    check_lines(lines)?;
    ElementWarp::construct(lines, scaling)
}
