//! Paths through keys: where a thing is between the places it has at whole numbers of the parameter.
//!
//! A path is linear in its keys, so that one list of shares serves points, grids, lengths and angles alike. *Straight* takes
//! `(1 − t, t)` of the two keys around; *smooth* is the uniform Catmull–Rom curve through all keys, with the reflected
//! neighbour at its ends, which is straight where there are two keys.
//!
//! *Source*: *Interpolation Techniques*, slides, chapter 2, "Morphing" ("this interpolation can be done linearly, or grids from
//! adjacent key frames can be used to perform higher-order interpolation"); E. Catmull and R. Rom, *A class of local
//! interpolating splines*, 1974. Reflected ends as in `anamorph-curves`.

use crate::names::{self, Named, UnknownName};
use anamorph_core::Space;

/// How a thing goes through its keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum KeyPath {
    /// Straight from each key to the next.
    #[default]
    Straight,
    /// Smoothly through all: a Catmull–Rom curve with keys at even times.
    Smooth,
}

const KEY_PATHS: &[Named<KeyPath>] = &[
    (
        KeyPath::Straight,
        "straight",
        "straight from each key to the next",
    ),
    (
        KeyPath::Smooth,
        "smooth",
        "a Catmull-Rom curve through all keys",
    ),
];

/// Why there is no place at a parameter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KeyError {
    /// No key at all.
    #[error("there are no keys; give at least one")]
    None,
    /// A parameter before the first key, behind the last, or not a number.
    #[error(
        "the parameter {parameter} lies outside the keys, which go from 0 to {last}; keep it within"
    )]
    Outside {
        /// The parameter.
        parameter: f64,
        /// That of the last key.
        last: usize,
    },
}

/// Up to four keys and how much of each is taken, beside the key that they are differences from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shares {
    /// The key at or before the parameter.
    pub(crate) base: usize,
    /// Keys and their shares of what they differ from the base; those behind the first `count` are nothing.
    keys: [(usize, f64); 3],
    count: usize,
}

impl Shares {
    /// The keys that count beside the base, and their shares.
    pub(crate) fn others(&self) -> &[(usize, f64)] {
        &self.keys[..self.count]
    }

    /// `value(base) + Σ share · (value(key) − value(base))`: a thing that is the same at all keys stays so, bit for bit.
    pub(crate) fn mix<S: Space>(&self, value: impl Fn(usize) -> S) -> S {
        let base = value(self.base);
        let others = self.others().iter();
        others.fold(base, |sum, &(key, share)| sum + (value(key) - base) * share)
    }

    /// As [`Shares::mix`], of numbers.
    pub(crate) fn mix_numbers(&self, value: impl Fn(usize) -> f64) -> f64 {
        let base = value(self.base);
        let others = self.others().iter();
        others.fold(base, |sum, &(key, share)| sum + (value(key) - base) * share)
    }
}

impl KeyPath {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        KEY_PATHS.iter().map(|row| row.0)
    }
    /// Its name in recipes and lists.
    pub fn name(self) -> &'static str {
        names::row_of(KEY_PATHS, self).0
    }
    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        names::row_of(KEY_PATHS, self).1
    }
    /// The one of that name.
    ///
    /// # Errors
    /// [`UnknownName`], which lists the names there are.
    pub fn by_name(name: &str) -> Result<Self, UnknownName> {
        names::by_name("path through keys", KEY_PATHS, name)
    }

    /// The point at `parameter` of the path through `keys`: key `k` is passed at `k`, exactly.
    ///
    /// # Errors
    /// [`KeyError`].
    pub fn point<S: Space>(self, keys: &[S], parameter: f64) -> Result<S, KeyError> {
        let shares = self.shares(keys.len(), parameter)?;
        Ok(shares.mix(|key| keys[key]))
    }

    /// The number at `parameter` of the path through `keys`.
    ///
    /// # Errors
    /// [`KeyError`].
    pub fn number(self, keys: &[f64], parameter: f64) -> Result<f64, KeyError> {
        let shares = self.shares(keys.len(), parameter)?;
        Ok(shares.mix_numbers(|key| keys[key]))
    }

    /// What each of `count` keys gives at `parameter`.
    pub(crate) fn shares(self, count: usize, parameter: f64) -> Result<Shares, KeyError> {
        let last = count.checked_sub(1).ok_or(KeyError::None)?;
        if !(parameter >= 0.0 && parameter <= last as f64) {
            return Err(KeyError::Outside { parameter, last });
        }
        let base = parameter as usize;
        let t = parameter - base as f64;
        let alone = Shares {
            base,
            keys: [(base, 0.0); 3],
            count: 0,
        };
        if t == 0.0 {
            return Ok(alone);
        }
        let straight = [(base + 1, t), (base, 0.0), (base, 0.0)];
        match self {
            Self::Straight => Ok(Shares {
                keys: straight,
                count: 1,
                ..alone
            }),
            Self::Smooth => {
                // Hermite's polynomials of the velocities at both ends.
                let rest = 1.0 - t;
                let (leaving, arriving) = (t * rest * rest, -t * t * rest);
                let (mut before, mut behind) = (0.0, 0.0);
                let mut next = t * t * (3.0 - 2.0 * t);
                if base > 0 {
                    // ½(next − before)
                    next += 0.5 * leaving;
                    before = -0.5 * leaving;
                } else {
                    // next − base
                    next += leaving;
                }
                if base + 1 < last {
                    // ½(behind − base)
                    behind = 0.5 * arriving;
                } else {
                    // next − base
                    next += arriving;
                }
                let mut keys = straight;
                let mut count = 1;
                keys[0].1 = next;
                if base > 0 {
                    keys[count] = (base - 1, before);
                    count += 1;
                }
                if base + 1 < last {
                    keys[count] = (base + 2, behind);
                    count += 1;
                }
                if last == 1 {
                    keys[0].1 = t;
                }
                Ok(Shares {
                    keys,
                    count,
                    ..alone
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Curve, Plane, Solid, glam::dvec2, glam::dvec3};
    use anamorph_curves::families::{CatmullRom, Generator, Spacing};

    const KEYS: [Plane; 5] = [
        dvec2(0.0, 1.0),
        dvec2(3.0, -2.0),
        dvec2(0.1, 0.2),
        dvec2(7.0, 7.0),
        dvec2(-4.0, 2.5),
    ];

    #[test]
    fn smooth_paths_are_uniform_catmull_rom_curves() {
        for count in 2..=KEYS.len() {
            let keys = &KEYS[..count];
            let curve = CatmullRom::new(keys.to_vec())
                .spaced(Spacing::Uniform)
                .curve()
                .unwrap();
            for i in 0..=40 * (count - 1) {
                let parameter = i as f64 / 40.0;
                let here = KeyPath::Smooth.point(keys, parameter).unwrap();
                assert!(here.distance(curve.point(parameter)) < 1e-13);
            }
        }
    }

    #[test]
    fn keys_are_met_exactly_and_what_rests_rests() {
        let still = [dvec3(0.1, 0.2, 0.3); 4];
        for path in KeyPath::all() {
            for (k, key) in KEYS.iter().enumerate() {
                assert_eq!(path.point(&KEYS, k as f64), Ok(*key));
            }
            for i in 0..=30 {
                let here: Solid = path.point(&still, i as f64 / 10.0).unwrap();
                assert_eq!(here, still[0]);
            }
            // Two keys are a straight way, however it is called; whole motions are kept by affine maps.
            let half = path.number(&[2.0, 4.0], 0.25).unwrap();
            assert_eq!(half, 2.5);
        }
    }

    #[test]
    fn there_is_nothing_outside_the_keys() {
        let no: [Plane; 0] = [];
        assert_eq!(KeyPath::Smooth.point(&no, 0.0), Err(KeyError::None));
        for parameter in [-1e-9, 4.1, f64::NAN, f64::INFINITY] {
            let error = KeyPath::Straight.point(&KEYS, parameter);
            assert!(matches!(error, Err(KeyError::Outside { last: 4, .. })));
        }
        assert_eq!(KeyPath::Smooth.point(&KEYS[..1], 0.0), Ok(KEYS[0]));
        assert!(KeyPath::Smooth.point(&KEYS[..1], 0.5).is_err());
    }

    #[test]
    fn names_are_found_and_others_listed() {
        for path in KeyPath::all() {
            assert_eq!(KeyPath::by_name(path.name()), Ok(path));
            assert!(!path.title().is_empty());
        }
        let message = KeyPath::by_name("crooked").unwrap_err().to_string();
        assert!(message.contains("straight, smooth"), "{message}");
    }
}
