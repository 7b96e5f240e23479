//! Regions of the plane: an outer outline and its holes.
//!
//! Coordinates are the caller's; the outer outline has positive area by the shoelace formula, holes have negative, which is
//! counterclockwise and clockwise where x goes right and y goes up. Rings are not closed by a repeated point.

use anamorph_core::glam::DVec2;

/// An outer outline and its holes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// The outer outline, of positive area.
    pub outer: Vec<DVec2>,
    /// Holes in it, of negative area.
    pub holes: Vec<Vec<DVec2>>,
}
