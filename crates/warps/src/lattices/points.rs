//! What lattices of control points have in common, whatever their basis.
//!
//! Computes the transformation of a control point, `T = P* − P` scaled by a strength as a displacement, and the conditions
//! `P ↦ P*` that the lattice is built from.
//!
//! *Source*: Milliron et al. 2002, §4.1; errata F2 (`T = P* − P`, not `P*`).

use super::Grid;
use anamorph_core::{Address, Affine, Condition, Mark, Space, Warp};

/// A lattice whose control points are moved by displacements.
pub trait PointLattice<S: Space>: Warp<S> + Sized {
    /// The box and its grid.
    fn grid(&self) -> &Grid<S>;
    /// Displacements of the control points (flat index, last axis fastest).
    fn displacements(&self) -> &[S];
    /// Rest position of a control point by its flat index.
    fn control_point(&self, flat: usize) -> S;

    /// The cage before and after, for pictures.
    fn marks(&self) -> Vec<Mark<S>> {
        let moves = self.displacements();
        let rest: Vec<S> = (0..moves.len()).map(|i| self.control_point(i)).collect();
        let targets: Vec<S> = rest.iter().zip(moves).map(|(&p, &d)| p + d).collect();
        let moved: Vec<bool> = moves.iter().map(|d| *d != S::ZERO).collect();
        let mut marks = self.grid().cage(&rest, &moved, false);
        marks.extend(self.grid().cage(&targets, &moved, true));
        marks
    }
}

/// The scaled transformation of the control point at `address`.
pub(crate) fn scaled<S: Space>(
    lattice: &impl PointLattice<S>,
    address: Address,
    strength: f64,
) -> Affine<S> {
    let displacement = lattice.displacements().get(address.feature as usize);
    Affine::translation(displacement.copied().unwrap_or(S::ZERO) * strength)
}

/// Conditions at the control points that move.
pub(crate) fn conditions<S: Space>(lattice: &impl PointLattice<S>) -> Vec<Condition<S>> {
    let moves = lattice.displacements().iter().enumerate();
    moves
        .filter(|(_, d)| **d != S::ZERO)
        .map(|(flat, &d)| {
            let source = lattice.control_point(flat);
            Condition {
                feature: u32::try_from(flat).unwrap_or(u32::MAX),
                source,
                target: source + d,
            }
        })
        .collect()
}
