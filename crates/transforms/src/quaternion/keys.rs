//! Keys made ready for interpolation: unit quaternions, signs chosen along the whole sequence, times that increase.

use super::basics::{nearer, normalized};
use super::error::OrientationError;
use super::operators::{double, repair_signs};
use anamorph_core::glam::DQuat;

/// Spans of time outside of this range make rates, or their squares, overflow.
const SPANS: core::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// A sequence of orientations with their times.
///
/// The keys are normalized, and of `q` and `−q` that is taken which is nearer to the key before
/// ([`repair_signs`](super::repair_signs)), so that flipping the sign of any key changes no rotation of any path. A
/// closed sequence returns to its first key, with the sign nearer to the last.
///
/// Singular sequences have answers: one key is constant; between equal neighbours slerp and lerp rest; a pair at a half
/// turn, for which both ways round are equally long, keeps the signs as they are given.
#[derive(Debug, Clone, PartialEq)]
pub struct Keys {
    /// With the return to the first, if closed.
    keys: Vec<DQuat>,
    times: Vec<f64>,
    closed: bool,
}

/// A key with its neighbours; at an open end the missing neighbour is the other one reflected in the key (errata C9).
pub(super) struct Neighbourhood {
    pub(super) previous: DQuat,
    pub(super) key: DQuat,
    pub(super) next: DQuat,
    /// Times from the previous key, and to the next.
    pub(super) spans: [f64; 2],
}

impl Keys {
    /// An open sequence: `times` are as many as `keys`, strictly increasing, in any unit. Keys need not be of length 1.
    ///
    /// # Errors
    /// No keys, a key that is null or not finite, another number of times, times that are not finite or not increasing,
    /// or spans of time outside [1e-30, 1e30].
    pub fn new(keys: &[DQuat], times: &[f64]) -> Result<Self, OrientationError> {
        Self::prepared(keys, times.to_vec(), false)
    }

    /// An open sequence with the times 0, 1, 2, ….
    ///
    /// # Errors
    /// No keys, or a key that is null or not finite.
    pub fn even(keys: &[DQuat]) -> Result<Self, OrientationError> {
        Self::prepared(keys, (0..keys.len()).map(|i| i as f64).collect(), false)
    }

    /// A closed sequence: `times` has one more entry than `keys`, the time at which the first key comes again.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn closed(keys: &[DQuat], times: &[f64]) -> Result<Self, OrientationError> {
        Self::prepared(keys, times.to_vec(), true)
    }

    /// A closed sequence with the times 0, 1, 2, …, the first key coming again at `keys.len()`.
    ///
    /// # Errors
    /// As [`Self::even`].
    pub fn closed_even(keys: &[DQuat]) -> Result<Self, OrientationError> {
        Self::prepared(keys, (0..=keys.len()).map(|i| i as f64).collect(), true)
    }

    fn prepared(given: &[DQuat], times: Vec<f64>, closed: bool) -> Result<Self, OrientationError> {
        if given.is_empty() {
            return Err(OrientationError::NoKeys);
        }
        let expected = given.len() + usize::from(closed);
        if times.len() != expected {
            return Err(OrientationError::Count {
                keys: given.len(),
                times: times.len(),
                expected,
            });
        }
        let mut keys = Vec::with_capacity(expected);
        for (key, &q) in given.iter().enumerate() {
            if !q.is_finite() {
                return Err(OrientationError::KeyNotFinite { key });
            }
            keys.push(normalized(q).ok_or(OrientationError::NullKey { key })?);
        }
        if let Some(time) = times.iter().position(|t| !t.is_finite()) {
            return Err(OrientationError::TimeNotFinite { time });
        }
        for (i, pair) in times.windows(2).enumerate() {
            let (time, before, after) = (i + 1, pair[0], pair[1]);
            if after <= before {
                return Err(OrientationError::TimesNotIncreasing {
                    time,
                    before,
                    after,
                });
            }
            let span = after - before;
            if !SPANS.contains(&span) {
                return Err(OrientationError::Span { time, span });
            }
        }
        repair_signs(&mut keys);
        if closed {
            keys.push(nearer(keys[keys.len() - 1], keys[0]));
        }
        Ok(Self {
            keys,
            times,
            closed,
        })
    }

    /// The keys with length 1 and signs chosen, the return to the first included if closed.
    pub fn keys(&self) -> &[DQuat] {
        &self.keys
    }

    /// The times of [`Self::keys`].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether the sequence returns to its first key.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// How many spans lie between the keys: 0 for one key of an open sequence.
    pub(super) fn segments(&self) -> usize {
        self.keys.len() - 1
    }

    /// The time from key `i` to key `i + 1`.
    pub(super) fn span(&self, i: usize) -> f64 {
        self.times[i + 1] - self.times[i]
    }

    /// What `build` makes of the number of each span; for one key, of no span, what `rest` is.
    pub(super) fn each_segment<T>(&self, rest: T, build: impl FnMut(usize) -> T) -> Vec<T> {
        match self.segments() {
            0 => vec![rest],
            count => (0..count).map(build).collect(),
        }
    }

    /// The surroundings of key `i`; there must be a span.
    pub(super) fn around(&self, i: usize) -> Neighbourhood {
        let (key, last) = (self.keys[i], self.segments());
        // The first key and the return to it may differ in sign; their neighbours then do, too.
        let wrapped = |q: DQuat| {
            if self.keys[last] == self.keys[0] {
                q
            } else {
                -q
            }
        };
        let before = match i.checked_sub(1) {
            Some(before) => Some((self.keys[before], self.span(before))),
            None if self.closed => Some((wrapped(self.keys[last - 1]), self.span(last - 1))),
            None => None,
        };
        let after = if i < last {
            Some((self.keys[i + 1], self.span(i)))
        } else if self.closed {
            Some((wrapped(self.keys[1]), self.span(0)))
        } else {
            None
        };
        let resting = (key, 1.0);
        let (previous, next) = match (before, after) {
            (Some(before), Some(after)) => (before, after),
            (None, Some((q, span))) => ((double(q, key), span), (q, span)),
            (Some((q, span)), None) => ((q, span), (double(q, key), span)),
            (None, None) => (resting, resting),
        };
        Neighbourhood {
            previous: previous.0,
            key,
            next: next.0,
            spans: [previous.1, next.1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::from_axis_angle;
    use anamorph_core::glam::DVec3;

    #[test]
    fn bad_sequences_are_refused_by_element() {
        let q = DQuat::IDENTITY;
        let bad = |keys: &[DQuat], times: &[f64]| Keys::new(keys, times).unwrap_err();
        assert_eq!(bad(&[], &[]), OrientationError::NoKeys);
        assert_eq!(
            bad(&[q, q * 0.0], &[0.0, 1.0]),
            OrientationError::NullKey { key: 1 }
        );
        assert_eq!(
            bad(&[q, q * f64::NAN], &[0.0, 1.0]),
            OrientationError::KeyNotFinite { key: 1 }
        );
        assert_eq!(
            bad(&[q, q], &[0.0, f64::INFINITY]),
            OrientationError::TimeNotFinite { time: 1 }
        );
        for after in [1.0, 0.5] {
            assert_eq!(
                bad(&[q, q, q], &[0.0, 1.0, after]),
                OrientationError::TimesNotIncreasing {
                    time: 2,
                    before: 1.0,
                    after
                }
            );
        }
        assert!(matches!(
            bad(&[q, q], &[-1e308, 1e308]),
            OrientationError::Span { time: 1, .. }
        ));
        assert!(matches!(
            bad(&[q, q], &[0.0, 5e-324]),
            OrientationError::Span { time: 1, .. }
        ));
        let count = bad(&[q, q], &[0.0]);
        assert_eq!(
            count.to_string(),
            "2 keys come with 1 times; give 2, one for each key"
        );
        let count = Keys::closed(&[q, q], &[0.0, 1.0]).unwrap_err();
        assert_eq!(
            count.to_string(),
            "2 keys come with 2 times; give 3, one for each key and one for the return to the first"
        );
    }

    #[test]
    fn signs_follow_the_sequence_and_the_return_too() {
        let about = |angle: f64| from_axis_angle(DVec3::Y, angle);
        // A whole turn in steps of 100 degrees: the return is the negative of the first key.
        let step = 100.0_f64.to_radians();
        let given = [about(0.0), -about(step), about(2.0 * step)];
        let keys = Keys::closed_even(&given).unwrap();
        assert_eq!(keys.keys().len(), 4);
        for pair in keys.keys().windows(2) {
            assert!(pair[0].dot(pair[1]) >= 0.0);
        }
        assert_eq!(keys.keys()[3], -given[0]);
        // The first key's predecessor is on its side, and the last key's successor on that of the return.
        assert!(keys.around(0).previous.dot(keys.around(0).key) > 0.0);
        assert!(keys.around(3).next.dot(keys.around(3).key) > 0.0);
        // Half turns keep their sign (errata C8).
        let half = DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0);
        for key in [half, -half] {
            let keys = Keys::even(&[DQuat::IDENTITY, key]).unwrap();
            assert_eq!(keys.keys()[1], key);
        }
    }
}
