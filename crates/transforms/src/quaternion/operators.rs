//! The operators of the construction on the sphere: `double`, `bisect`, lerp, de Casteljau, squad, signs, inner points.
//!
//! *Source*: K. Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985 (`double`, `bisect`, Bézier on the
//! sphere); K. Shoemake, *Quaternion Calculus and Fast Animation*, SIGGRAPH course notes 10, 1987 (squad). Errata C7
//! (de Casteljau as it should have been printed), C8 (a third of the way; opposite quaternions), C15 (unequal times).

use super::arc::OPPOSITE;
use super::basics::{exp, from_wxyz, ln, nearer, slerp};
use anamorph_core::glam::DQuat;

/// The rotation from `p` to `q` applied to `q` once more: the reflection of `p` in `q`, `2(p·q)q − p`.
pub fn double(p: DQuat, q: DQuat) -> DQuat {
    q * (2.0 * p.dot(q)) - p
}

/// Half way from `a` to `b`, `(a + b)/‖a + b‖`, with the signs as they are. Of `q` and `−q` it is `q·i`, where their
/// [`slerp`] passes (errata C8).
pub fn bisect(a: DQuat, b: DQuat) -> DQuat {
    middle(a, b).unwrap_or_else(|| a * from_wxyz([0.0, 1.0, 0.0, 0.0]))
}

/// [`bisect`], or `None` where the two are opposite.
fn middle(a: DQuat, b: DQuat) -> Option<DQuat> {
    let sum = a + b;
    let length = sum.dot(sum).sqrt();
    (length >= OPPOSITE).then(|| sum / length)
}

/// Linear interpolation, made a unit quaternion again: the great arc of [`slerp`], not at constant speed. Signs as they are;
/// halfway between `q` and `−q`, where the line passes the null quaternion, the answer is that of [`bisect`].
pub fn lerp(a: DQuat, b: DQuat, t: f64) -> DQuat {
    if t == 0.0 {
        return a;
    }
    if t == 1.0 {
        return b;
    }
    let q = a * (1.0 - t) + b * t;
    let length = q.dot(q).sqrt();
    if length >= OPPOSITE {
        q / length
    } else {
        bisect(a, b)
    }
}

/// The point at `t` of the Bézier curve on the sphere with these control points, by de Casteljau's construction with
/// [`slerp`] for the straight line (errata C7: every level takes its own neighbours, `t23 = slerp(t2, t3)`). Signs as they are.
/// `None` without control points.
pub fn bezier(controls: &[DQuat], t: f64) -> Option<DQuat> {
    let mut points = controls.to_vec();
    for level in (1..points.len()).rev() {
        for i in 0..level {
            points[i] = slerp(points[i], points[i + 1], t);
        }
    }
    points.first().copied()
}

/// Shoemake's squad: `slerp(slerp(a, b, t), slerp(inner_a, inner_b, t), 2t(1 − t))`. No slerp flips a sign (errata C15).
pub fn squad(a: DQuat, inner_a: DQuat, inner_b: DQuat, b: DQuat, t: f64) -> DQuat {
    slerp(
        slerp(a, b, t),
        slerp(inner_a, inner_b, t),
        2.0 * t * (1.0 - t),
    )
}

/// Chooses of `q` and `−q`, which are the same rotation, the one nearer to the key before, along the whole sequence. The
/// first key and those at a right angle (dot product 0: half turns) keep their sign.
///
/// A closed sequence comes back to [`nearer`]`(last, first)`, which may be the negative of the first key.
pub fn repair_signs(keys: &mut [DQuat]) {
    for i in 1..keys.len() {
        keys[i] = nearer(keys[i - 1], keys[i]);
    }
}

/// How far from a key the inner control points of cubic Bézier segments stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InnerPoints {
    /// A third of the way, as a cubic needs it: even keys turn evenly (errata C8).
    #[default]
    Thirds,
    /// The whole way, as the slides print it: three times too far. The motion stalls amid every segment.
    AsPrinted,
}

/// The Bézier control points before and after a key: `[b, a]`, the third control point of the segment that ends there and
/// the second of the one that starts.
///
/// `spans` are the times from `previous` to `key` and from `key` to `next`, positive. With equal spans
/// `a = slerp(key, bisect(double(previous, key), next), 1/3)` and `b = double(a, key)`; in general both lie on that arc
/// as far out as their spans are long, so that the angular velocity at the key is the same on both sides: the turn from
/// `previous` to `next` over the whole time (errata C8, C15: chord weights). Where `double(previous, key)` and `next` are
/// opposite, two half turns that cancel, both are the key itself.
pub fn inner_points(
    previous: DQuat,
    key: DQuat,
    next: DQuat,
    spans: [f64; 2],
    distance: InnerPoints,
) -> [DQuat; 2] {
    let Some(toward) = middle(double(previous, key), next) else {
        return [key; 2];
    };
    let part = match distance {
        InnerPoints::Thirds => 1.0 / 3.0,
        InnerPoints::AsPrinted => 1.0,
    };
    // `toward` is half of the turn from `previous` to `next`.
    let share = spans.map(|span| 2.0 * part * (span / (spans[0] + spans[1])));
    [slerp(key, toward, -share[0]), slerp(key, toward, share[1])]
}

/// Squad's inner points of a key, for the segment that ends there and for the one that starts; the same one twice when the
/// `spans` (as in [`inner_points`]) are equal: Shoemake's `key·exp(−(ln(key⁻¹·next) + ln(key⁻¹·previous))/4)`. The angular
/// velocity at the key is the sum of both turns over the whole time, on both sides (errata C15).
pub fn squad_points(previous: DQuat, key: DQuat, next: DQuat, spans: [f64; 2]) -> [DQuat; 2] {
    let inverse = key.conjugate();
    let (arrives, leaves) = (-ln(inverse * previous), ln(inverse * next));
    let [before, after] = spans.map(|span| (arrives + leaves) * (span / (spans[0] + spans[1])));
    [
        key * exp((arrives - before) * 0.5),
        key * exp((after - leaves) * 0.5),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::from_axis_angle;
    use crate::testing::Random;
    use anamorph_core::glam::DVec3;

    fn apart(a: DQuat, b: DQuat) -> f64 {
        let d = a - b;
        d.dot(d).sqrt()
    }

    fn random_quaternion(random: &mut Random) -> DQuat {
        from_axis_angle(random.direction(), random.between(-6.0, 6.0))
    }

    #[test]
    fn double_continues_and_bisect_halves() {
        let mut random = Random::new(41);
        for _ in 0..1000 {
            let (p, q) = (
                random_quaternion(&mut random),
                random_quaternion(&mut random),
            );
            assert!(apart(double(p, q), slerp(p, q, 2.0)) < 1e-12);
            // The rotation from p to q, applied to q.
            assert!(apart(double(p, q), q * p.conjugate() * q) < 1e-14);
            assert!(apart(bisect(p, q), slerp(p, q, 0.5)) < 1e-12);
            assert!(apart(bisect(p, q), lerp(p, q, 0.5)) < 1e-14);
            assert!(apart(double(p, p), p) < 1e-15 * 4.0);
        }
    }

    #[test]
    fn opposite_quaternions_have_answers() {
        let q = from_axis_angle(DVec3::new(1.0, -2.0, 0.5), 2.0);
        let through = q * from_wxyz([0.0, 1.0, 0.0, 0.0]);
        assert!(apart(bisect(q, -q), through) < 1e-15);
        assert!(apart(slerp(q, -q, 0.5), through) < 1e-15);
        assert!(apart(lerp(q, -q, 0.5), through) < 1e-15);
        // Two half turns that cancel: the inner points rest at the key.
        let half = from_axis_angle(DVec3::Y, core::f64::consts::PI) * q;
        assert_eq!(
            inner_points(half, q, half, [1.0, 3.0], InnerPoints::Thirds),
            [q; 2]
        );
    }

    #[test]
    fn a_curve_of_one_arc_is_the_arc() {
        // Bernstein polynomials reproduce the parameter, on a great arc too.
        let (axis, angle) = (DVec3::new(1.0, 2.0, 2.0) / 3.0, 2.5);
        let on = |t: f64| from_axis_angle(axis, angle * t);
        let controls = [on(0.0), on(1.0 / 3.0), on(2.0 / 3.0), on(1.0)];
        for i in 0..=20 {
            let t = f64::from(i) / 20.0;
            assert!(apart(bezier(&controls, t).unwrap(), on(t)) < 1e-14);
        }
        assert_eq!(bezier(&[], 0.5), None);
        assert_eq!(bezier(&controls[..1], 0.7), Some(controls[0]));
    }
}
