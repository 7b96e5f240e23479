//! Pairs of points.
//!
//! *Source*: Milliron et al. 2002, §3.2 (Figs. 2–4): a point feature with a source and a target position is mapped to the
//! translation between them.

use crate::{FeatureError, Pair};
use anamorph_core::{Affine, Mark, Role, Shape, Space};

/// A source point and the target it should land on.
pub type PointPair<S> = Pair<S>;

impl<S: Space> Pair<S> {
    /// The pair of two points with finite coordinates.
    ///
    /// # Errors
    /// [`FeatureError::NotFinite`] naming the source or the target.
    pub fn checked(source: S, target: S) -> Result<Self, FeatureError> {
        if !source.is_finite() {
            return Err(FeatureError::NotFinite {
                what: "source point",
            });
        }
        if !target.is_finite() {
            return Err(FeatureError::NotFinite {
                what: "target point",
            });
        }
        Ok(Self { source, target })
    }

    /// From the source to the target.
    pub fn displacement(&self) -> S {
        self.target - self.source
    }

    /// The translation that takes the source to the target.
    pub fn affine(&self) -> Affine<S> {
        Affine::translation(self.displacement())
    }

    /// The source point: where the feature takes hold.
    pub fn centre(&self) -> S {
        self.source
    }

    /// The source point, the target point and, if they differ, an arrow from the one to the other.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let mut marks = vec![
            Mark::new(Role::Source, Shape::Point(self.source)),
            Mark::new(Role::Target, Shape::Point(self.target)),
        ];
        if self.source != self.target {
            let arrow = Shape::Arrow(self.source, self.target);
            marks.push(Mark::new(Role::TargetGuide, arrow));
        }
        marks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

    #[test]
    fn the_map_takes_source_to_target() {
        let pair = PointPair::checked(dvec3(1.0, 2.0, 3.0), dvec3(0.5, 2.0, -1.0)).unwrap();
        assert_eq!(pair.affine().apply(pair.source), pair.target);
        assert_eq!(pair.affine().displacement(DVec3::ZERO), pair.displacement());
        let back = pair.reversed().affine();
        assert_eq!(back.apply(pair.target), pair.source);
        assert_eq!(pair.centre(), pair.source);
    }

    #[test]
    fn marks_show_both_ends_and_the_way() {
        let pair = PointPair::new(DVec2::ZERO, DVec2::X);
        let marks = pair.marks();
        assert_eq!(marks[0], Mark::new(Role::Source, Shape::Point(DVec2::ZERO)));
        assert_eq!(marks[1], Mark::new(Role::Target, Shape::Point(DVec2::X)));
        assert_eq!(marks[2].shape, Shape::Arrow(DVec2::ZERO, DVec2::X));
        // A pinned point has no way to go.
        assert_eq!(PointPair::new(DVec2::X, DVec2::X).marks().len(), 2);
    }

    #[test]
    fn points_that_are_not_finite_are_named() {
        let bad = dvec2(0.0, f64::NAN);
        let error = PointPair::checked(bad, DVec2::ZERO).unwrap_err();
        assert!(error.to_string().contains("source point"));
        let error = PointPair::checked(DVec2::ZERO, bad).unwrap_err();
        assert!(error.to_string().contains("target point"));
    }
}
