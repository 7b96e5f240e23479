//! In-betweens of features: points and lines of the plane between their keys.
//!
//! A line goes by its end points, each on its own way, or by its midpoint, length and direction, turning the shorter way
//! round. By its ends a line that turns far gets shorter on the way, and one that turns half round vanishes; turning lines keep
//! their length.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992, §3.3, which names both; several keys
//! after [`KeyPath`]. Decision: half turns go counter-clockwise in the numbers (from x to y), as half turns do elsewhere
//! here (errata F18); a line without length takes the direction of the key before it, the first ones that of the first key
//! that has one.

use crate::names::{self, Named, UnknownName};
use crate::{KeyError, KeyPath};
use anamorph_core::{Plane, Space, glam::DVec2, math};

/// What of a line is interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LinePath {
    /// Its two end points.
    #[default]
    Ends,
    /// Its midpoint, length and direction, the shorter way round.
    Turning,
}

const LINE_PATHS: &[Named<LinePath>] = &[
    (
        LinePath::Ends,
        "ends",
        "the end points of lines go each their way",
    ),
    (
        LinePath::Turning,
        "turning",
        "midpoint, length and direction, the shorter way round",
    ),
];

impl LinePath {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        LINE_PATHS.iter().map(|row| row.0)
    }
    /// Its name in recipes and lists.
    pub fn name(self) -> &'static str {
        names::row_of(LINE_PATHS, self).0
    }
    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        names::row_of(LINE_PATHS, self).1
    }
    /// The one of that name.
    ///
    /// # Errors
    /// [`UnknownName`], which lists the names there are.
    pub fn by_name(name: &str) -> Result<Self, UnknownName> {
        names::by_name("path of lines", LINE_PATHS, name)
    }
}

/// The point `t` of the way from `first` to `second`: exactly these at 0 and 1. Outside [0, 1] the way goes on.
pub fn between_points<S: Space>(first: S, second: S, t: f64) -> S {
    if t == 1.0 {
        second
    } else {
        first + (second - first) * t
    }
}

/// The line `t` of the way from `first` to `second`: exactly these at 0 and 1.
///
/// # Errors
/// [`KeyError::Outside`] for `t` outside [0, 1].
pub fn between_lines(
    first: [Plane; 2],
    second: [Plane; 2],
    t: f64,
    way: LinePath,
) -> Result<[Plane; 2], KeyError> {
    line_at(&[first, second], t, KeyPath::Straight, way)
}

/// The line at `parameter` of the way through `keys`, of which key `k` is passed at `k`, exactly. Each turn is the shorter
/// one from key to key; a length that a smooth path would make negative is 0.
///
/// # Errors
/// [`KeyError`].
pub fn line_at(
    keys: &[[Plane; 2]],
    parameter: f64,
    path: KeyPath,
    way: LinePath,
) -> Result<[Plane; 2], KeyError> {
    let shares = path.shares(keys.len(), parameter)?;
    let base = keys[shares.base];
    if way == LinePath::Ends {
        return Ok([0, 1].map(|end| shares.mix(|key| keys[key][end])));
    }
    if shares.others().iter().all(|&(key, _)| keys[key] == base) {
        return Ok(base);
    }
    let spokes: Vec<DVec2> = keys.iter().map(|[a, b]| *b - *a).collect();
    let angles = unwrapped(&spokes);
    let middle = shares.mix(|key| keys[key][0] + (keys[key][1] - keys[key][0]) * 0.5);
    let length = shares.mix_numbers(|key| Space::length(spokes[key]));
    let (sine, cosine) = math::sin_cos(shares.mix_numbers(|key| angles[key]));
    let half = DVec2::new(cosine, sine) * (0.5 * length.max(0.0));
    Ok([middle - half, middle + half])
}

/// Angles of vectors in radians, each at most half a turn from the one before; null vectors point as those before them do.
fn unwrapped(vectors: &[DVec2]) -> Vec<f64> {
    let known = |v: &&DVec2| **v != DVec2::ZERO;
    let Some(first) = vectors.iter().find(known) else {
        return vec![0.0; vectors.len()];
    };
    let mut last = *first;
    let mut angle = math::atan2(last.y, last.x);
    let mut angles = Vec::with_capacity(vectors.len());
    for vector in vectors {
        if *vector != DVec2::ZERO {
            angle += turn(last, *vector);
            last = *vector;
        }
        angles.push(angle);
    }
    angles
}

/// The angle from one vector to the other, in (−π, π].
fn turn(from: DVec2, to: DVec2) -> f64 {
    // Directions, so that products do not overflow.
    let (from, to) = (from / Space::length(from), to / Space::length(to));
    let (sine, cosine) = (from.perp_dot(to), from.dot(to));
    if sine == 0.0 && cosine < 0.0 {
        std::f64::consts::PI
    } else {
        math::atan2(sine, cosine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    fn line(middle: DVec2, length: f64, degrees: f64) -> [Plane; 2] {
        let half = DVec2::from_angle(degrees.to_radians()) * (0.5 * length);
        [middle - half, middle + half]
    }

    fn near(found: [Plane; 2], expected: [Plane; 2]) {
        let far = found[0]
            .distance(expected[0])
            .max(found[1].distance(expected[1]));
        assert!(far < 1e-12, "{found:?} {expected:?}");
    }

    #[test]
    fn ends_are_exact_and_points_go_straight() {
        let (a, b) = (dvec2(0.1, 0.7), dvec2(0.3, -1.9));
        assert_eq!(between_points(a, b, 0.0), a);
        assert_eq!(between_points(a, b, 1.0), b);
        assert_eq!(between_points(a, a, 0.3), a);
        let lines = [line(a, 3.0, 17.0), line(b, 5.0, 190.0)];
        for way in LinePath::all() {
            assert_eq!(between_lines(lines[0], lines[1], 0.0, way), Ok(lines[0]));
            assert_eq!(between_lines(lines[0], lines[1], 1.0, way), Ok(lines[1]));
            assert_eq!(between_lines(lines[0], lines[0], 0.4, way), Ok(lines[0]));
            assert!(between_lines(lines[0], lines[1], 1.5, way).is_err());
            assert_eq!(LinePath::by_name(way.name()), Ok(way));
        }
    }

    #[test]
    fn turning_lines_keep_their_length_and_turn_the_shorter_way() {
        let (a, b) = (dvec2(1.0, 2.0), dvec2(5.0, 4.0));
        for (from, to, middle) in [
            (0.0, 90.0, 45.0),
            (170.0, -170.0, 180.0),
            (-170.0, 170.0, 180.0),
            (350.0, 370.0, 0.0),
            (10.0, 200.0, -75.0),
            // Half round: counter-clockwise.
            (0.0, 180.0, 90.0),
        ] {
            let found = between_lines(line(a, 2.0, from), line(b, 4.0, to), 0.5, LinePath::Turning)
                .unwrap();
            near(found, line(dvec2(3.0, 3.0), 3.0, middle));
        }
        // By its ends the same half turn shrinks to a point.
        let found = between_lines(line(a, 2.0, 0.0), line(a, 2.0, 180.0), 0.5, LinePath::Ends);
        near(found.unwrap(), [a, a]);
    }

    #[test]
    fn lines_through_several_keys_turn_on() {
        let keys: Vec<_> = [0.0, 120.0, 240.0, 360.0]
            .map(|angle| line(DVec2::ZERO, 2.0, angle))
            .to_vec();
        for path in KeyPath::all() {
            for i in 0..=30 {
                let parameter = f64::from(i) / 10.0;
                let found = line_at(&keys, parameter, path, LinePath::Turning).unwrap();
                near(found, line(DVec2::ZERO, 2.0, 120.0 * parameter));
            }
        }
    }

    #[test]
    fn lines_without_length_take_a_direction_and_never_turn_inside_out() {
        let point = [dvec2(1.0, 1.0); 2];
        let to = line(dvec2(1.0, 1.0), 4.0, 30.0);
        near(
            between_lines(point, to, 0.5, LinePath::Turning).unwrap(),
            line(dvec2(1.0, 1.0), 2.0, 30.0),
        );
        let both = between_lines(point, [dvec2(3.0, 1.0); 2], 0.5, LinePath::Turning);
        near(both.unwrap(), [dvec2(2.0, 1.0); 2]);
        // A smooth length would go below 0 here.
        let long = line(DVec2::ZERO, 10.0, 0.0);
        let short = line(DVec2::ZERO, 0.0, 0.0);
        let keys = [long, short, short, long];
        let found = line_at(&keys, 1.5, KeyPath::Smooth, LinePath::Turning).unwrap();
        near(found, [DVec2::ZERO; 2]);
    }
}
