//! The smallest box around a curve.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, chapter 4: a coordinate of a polynomial piece is largest at an end or
//! where its derivative vanishes; all roots of the derivative are found in Bernstein form.

use crate::bezier::Pieces;
use crate::polynomial::crossings;
use anamorph_core::{Bounds, Curve, Space};

/// A curve whose smallest box is known.
pub trait TightBounds<S: Space> {
    /// The smallest box that holds the curve; its control points may lie outside.
    fn tight_bounds(&self) -> Bounds<S>;
}

impl<S: Space, C: Pieces<S> + ?Sized> TightBounds<S> for C {
    fn tight_bounds(&self) -> Bounds<S> {
        let (start, end) = self.domain();
        let mut points = vec![self.point(start), self.point(end)];
        for (_, _, piece) in self.bezier_pieces() {
            points.push(piece.point(0.0));
            let velocity = piece.differences();
            for axis in 0..S::DIM {
                let along: Vec<f64> = velocity.iter().map(|v| v.component(axis)).collect();
                let turns = crossings(&along);
                points.extend(turns.into_iter().map(|turn| piece.point(turn.at)));
            }
        }
        let first = points[0];
        let (min, max) = points
            .iter()
            .fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)));
        Bounds { min, max }
    }
}
