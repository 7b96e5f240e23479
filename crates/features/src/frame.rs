//! Coordinate frames and pairs of them.
//!
//! *Source*: Milliron et al. 2002, §3.3 (Fig. 5): a source frame `f` and a target frame `f*` are mapped to the affine
//! transformation `T` with `T⟨f⟩ = f*`; errata F18: it is scaled about the source frame's origin.

use crate::{FeatureError, Pair};
use anamorph_core::{Affine, Linear, Mark, Role, Shape, Space};

/// Basis vectors whose determinant is below this share of the product of their lengths are dependent: it is the sine of
/// the angle between them (in space a product of two sines), and beyond it the map to the frame loses all but four digits.
const INDEPENDENT: f64 = 1e-12;

/// An origin with independent basis vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<S: Space> {
    origin: S,
    basis: S::Linear,
}

impl<S: Space> Frame<S> {
    /// The frame with the given origin, whose basis vectors are the columns of `basis`: of any lengths, at any angles,
    /// right-handed or left-handed.
    ///
    /// # Errors
    /// [`FeatureError::NotFinite`], or [`FeatureError::Degenerate`] when the basis vectors are dependent.
    pub fn new(origin: S, basis: S::Linear) -> Result<Self, FeatureError> {
        if !origin.is_finite() {
            return Err(FeatureError::NotFinite {
                what: "origin of the frame",
            });
        }
        let mut unit = S::Linear::ZERO;
        for i in 0..S::DIM {
            if !basis.column(i).is_finite() {
                return Err(FeatureError::NotFinite {
                    what: "basis of the frame",
                });
            }
            // A null vector stays null and makes the determinant 0.
            let column = basis.column(i).normalized().unwrap_or(S::ZERO);
            unit = unit + S::Linear::outer(column, S::unit(i));
        }
        if unit.determinant().abs() <= INDEPENDENT {
            return Err(FeatureError::Degenerate {
                flat: if S::DIM == 2 { "line" } else { "plane" },
                count: S::DIM,
            });
        }
        Ok(Self { origin, basis })
    }

    /// The frame with the given origin along the coordinate axes.
    ///
    /// # Errors
    /// [`FeatureError::NotFinite`].
    pub fn at(origin: S) -> Result<Self, FeatureError> {
        Self::new(origin, S::Linear::IDENTITY)
    }

    /// The origin.
    pub fn origin(&self) -> S {
        self.origin
    }
    /// The basis vectors, as columns.
    pub fn basis(&self) -> S::Linear {
        self.basis
    }
    /// The point with the given coordinates in the frame.
    pub fn point(&self, coordinates: S) -> S {
        self.origin + self.basis.apply(coordinates)
    }
    /// The image of the frame under an affine map.
    ///
    /// # Errors
    /// Those of [`Frame::new`], when the map is singular or overflows.
    pub fn moved(&self, map: &Affine<S>) -> Result<Self, FeatureError> {
        Self::new(map.apply(self.origin), map.linear.after(&self.basis))
    }
    /// Length of the longest basis vector.
    fn longest(&self) -> f64 {
        (0..S::DIM).fold(0.0, |longest, i| longest.max(self.basis.column(i).length()))
    }
    /// The basis vectors times `scale` as arrows from the origin.
    fn arrows(&self, role: Role, scale: f64) -> impl Iterator<Item = Mark<S>> {
        let frame = *self;
        (0..S::DIM).map(move |i| {
            let tip = frame.origin + frame.basis.column(i) * scale;
            Mark::new(role, Shape::Arrow(frame.origin, tip))
        })
    }
}

/// A source frame and the target frame it should become.
pub type FramePair<S> = Pair<Frame<S>>;

impl<S: Space> Pair<Frame<S>> {
    /// The affine map that takes the source frame to the target frame, origin to origin and basis vector to basis vector.
    ///
    /// # Errors
    /// [`FeatureError::Overflow`] when the frames are so different in size that an entry of the map is not finite.
    pub fn affine(&self) -> Result<Affine<S>, FeatureError> {
        let inverse = self.source.basis.inverted().ok_or(FeatureError::Overflow)?;
        // Equal bases are a translation, exactly.
        let linear = if self.source.basis == self.target.basis {
            S::Linear::IDENTITY
        } else {
            self.target.basis.after(&inverse)
        };
        let offset = self.target.origin - self.source.origin;
        let map = Affine::about(self.source.origin, linear, offset);
        if map.is_finite() {
            Ok(map)
        } else {
            Err(FeatureError::Overflow)
        }
    }

    /// The source frame's origin: the centre about which the map is scaled (errata F18).
    pub fn centre(&self) -> S {
        self.source.origin
    }

    /// Both frames as arrows from their origins, with the origins as points. The longest basis vector of the source is
    /// drawn `length` scene units long and all others, the target's too, to the same scale, so that a stretch shows.
    pub fn marks(&self, length: f64) -> Vec<Mark<S>> {
        let longest = self.source.longest();
        let scale = if longest > 0.0 { length / longest } else { 1.0 };
        let mut marks = vec![
            Mark::new(Role::Source, Shape::Point(self.source.origin)),
            Mark::new(Role::Target, Shape::Point(self.target.origin)),
        ];
        marks.extend(self.source.arrows(Role::Source, scale));
        marks.extend(self.target.arrows(Role::Target, scale));
        marks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::{DMat2, DMat3, DVec2, DVec3, dvec2, dvec3};

    /// Marsaglia's xorshift generator, seeded.
    struct Random(u64);

    impl Random {
        fn vector<S: Space>(&mut self) -> S {
            S::from_fn(|_| {
                self.0 ^= self.0 << 13;
                self.0 ^= self.0 >> 7;
                self.0 ^= self.0 << 17;
                2.0 * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
            })
        }
        fn frame<S: Space>(&mut self, size: f64) -> Frame<S> {
            loop {
                let basis = S::Linear::from_columns(|_| self.vector::<S>() * size);
                let origin = self.vector();
                if let (true, Ok(frame)) = (
                    basis.determinant().abs() > 0.1 * size.powi(S::DIM as i32),
                    Frame::new(origin, basis),
                ) {
                    return frame;
                }
            }
        }
    }

    fn frames_go_to_frames<S: Space>() {
        let mut random = Random(0x1234_5678_9ABC_DEF1);
        for step in 0..500 {
            let (from, to) = ([1e-3, 1.0, 40.0][step % 3], [1.0, 1e-3, 7.0][step % 3]);
            let pair = FramePair::<S>::new(random.frame(from), random.frame(to));
            let map = pair.affine().unwrap();
            let error = |coordinates: S| {
                let landed = map.apply(pair.source.point(coordinates));
                (landed - pair.target.point(coordinates)).length()
            };
            // Relative to the entries of the map, which multiply the rounding of the origin.
            let slack = 1e-13 * (1.0 + to / from) * (1.0 + from);
            assert!(error(S::ZERO) < slack);
            for i in 0..S::DIM {
                assert!(error(S::unit(i)) < slack);
            }
            assert!(error(random.vector()) < slack);
            let moved = pair.source.moved(&map).unwrap();
            assert!((moved.origin() - pair.target.origin()).length() < slack);
            // The way back undoes it.
            let back = pair.reversed().affine().unwrap().after(&map);
            let p = random.vector::<S>();
            assert!((back.apply(p) - p).length() < 1e-12 * (1.0 + from / to) * (1.0 + to / from));
        }
    }

    #[test]
    fn frames_go_to_frames_in_plane_and_space() {
        frames_go_to_frames::<DVec2>();
        frames_go_to_frames::<DVec3>();
    }

    #[test]
    fn equal_bases_are_translations_exactly() {
        let basis = DMat2::from_cols(dvec2(0.3, 0.1), dvec2(-0.7, 0.9));
        let source = Frame::new(dvec2(0.1, 0.2), basis).unwrap();
        let target = Frame::new(dvec2(5.1, 0.2), basis).unwrap();
        let map = FramePair::new(source, target).affine().unwrap();
        assert_eq!(map, Affine::translation(dvec2(5.1, 0.2) - dvec2(0.1, 0.2)));
        assert_eq!(
            FramePair::new(source, source).affine().unwrap(),
            Affine::IDENTITY
        );
    }

    #[test]
    fn degenerate_frames_are_refused_whatever_their_size() {
        for size in [1e-200, 1.0, 1e200] {
            let flat = DMat3::from_cols(DVec3::X, DVec3::Y, dvec3(1.0, 1.0, 1e-14)) * size;
            let error = Frame::new(DVec3::ZERO, flat).unwrap_err();
            assert_eq!(
                error,
                FeatureError::Degenerate {
                    flat: "plane",
                    count: 3
                }
            );
            let thin = DMat3::from_cols(DVec3::X, DVec3::Y, dvec3(1.0, 1.0, 1e-6)) * size;
            assert!(Frame::new(DVec3::ZERO, thin).is_ok());
            let null = DMat2::from_cols(DVec2::X * size, DVec2::ZERO);
            let error = Frame::new(DVec2::ZERO, null).unwrap_err();
            assert!(error.to_string().contains("one line; give 2 directions"));
        }
        // Very unequal lengths are fine.
        let long = DMat2::from_cols(DVec2::X * 1e-9, DVec2::Y * 1e9);
        assert!(Frame::new(DVec2::ZERO, long).is_ok());
    }

    #[test]
    fn bad_numbers_are_named() {
        let error = Frame::<DVec2>::at(dvec2(f64::INFINITY, 0.0)).unwrap_err();
        assert!(error.to_string().contains("origin"));
        let error = Frame::new(DVec2::ZERO, DMat2::IDENTITY * f64::NAN).unwrap_err();
        assert!(error.to_string().contains("basis"));
        let tiny = Frame::new(DVec2::ZERO, DMat2::IDENTITY * 1e-200).unwrap();
        let huge = Frame::new(DVec2::ZERO, DMat2::IDENTITY * 1e200).unwrap();
        let error = FramePair::new(tiny, huge).affine().unwrap_err();
        assert_eq!(error, FeatureError::Overflow);
    }

    #[test]
    fn marks_show_the_stretch() {
        let source = Frame::<DVec2>::at(DVec2::ZERO).unwrap();
        let basis = DMat2::from_cols(dvec2(0.0, 2.0), dvec2(-1.0, 0.0));
        let target = Frame::new(dvec2(3.0, 0.0), basis).unwrap();
        let pair = FramePair::new(source, target);
        let marks = pair.marks(0.5);
        let arrows: Vec<_> = marks
            .iter()
            .filter_map(|mark| match mark.shape {
                Shape::Arrow(from, to) => Some((mark.role, to - from)),
                _ => None,
            })
            .collect();
        assert_eq!(
            arrows,
            [
                (Role::Source, dvec2(0.5, 0.0)),
                (Role::Source, dvec2(0.0, 0.5)),
                (Role::Target, dvec2(0.0, 1.0)),
                (Role::Target, dvec2(-0.5, 0.0)),
            ]
        );
        assert_eq!(pair.centre(), DVec2::ZERO);
    }
}
