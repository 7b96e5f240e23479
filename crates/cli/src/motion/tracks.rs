//! A motion as tracks of glTF, with the error that is made between keys.
//!
//! Positions are written as cubics where they are cubics of the time, which is tested, not assumed: between two knots of the
//! motion the cubic through four of its points is compared with others. Elsewhere the track is straight from frame to frame. Rotations
//! are written at the keys of the recipe where slerp from key to key is the motion, else at the frames.
//!
//! Either way the largest error that was met is said: that of the numbers that are written, which have 32 bits, times too. Between
//! keys it is measured as if a player computed without rounding.

use super::frames::{Frames, MOST};
use crate::files::short;
use anamorph_core::glam::DQuat;
use anamorph_core::{Bounds, Solid};
use anamorph_io::Track;
use anamorph_recipe::BuiltMotion;

/// Places between two keys at which errors are measured, and how many between many keys.
const BETWEEN: u32 = 8;
const FEW: u32 = 1;
/// From here on keys are many.
const MANY: usize = 100_000;
/// Shares of the path's size that 32-bit numbers leave open: what errs no more is exact in a glTF.
const ROUNDING: f64 = 1.2e-7;
/// Radians that they leave open in a quaternion.
const TURNING: f64 = 5e-7;

/// The tracks of a motion.
pub(crate) struct Tracks {
    pub(crate) translation: Track<Solid>,
    pub(crate) rotation: Track<DQuat>,
    /// Largest distance between the track and the motion, in scene units.
    pub(crate) translation_error: f64,
    /// Largest angle between the track and the motion, in radians.
    pub(crate) rotation_error: f64,
}

/// Share of the path's size from which rounding to 32 bits is seen.
const COARSE: f64 = 1e-4;
/// Half of the last place of 32-bit numbers, in shares of them, and of the smallest.
const HALF: f64 = 6e-8;
const LEAST: f64 = 7e-46;

/// What there is to say of a path that 32-bit numbers hardly hold: far from the origin for its size, or too small.
pub(crate) fn coarse(built: &BuiltMotion) -> Option<String> {
    let (step, size) = ((HALF * size(built)).max(LEAST), extent(built));
    (step > COARSE * size).then(|| {
        format!(
            "the 32-bit numbers of glTF hold places here to {} only, and the path is {} in size: move it to the origin, or scale it",
            short(step),
            short(size)
        )
    })
}

/// The largest side of the path's box.
fn extent(built: &BuiltMotion) -> f64 {
    let line = line(built);
    Bounds::of(&line).map_or(0.0, |bounds| (bounds.max - bounds.min).max_element())
}

/// Places along the path.
fn line(built: &BuiltMotion) -> Vec<Solid> {
    let path = built.motion.path();
    let (start, end) = path.domain();
    let places = (0..=64).map(|i| path.point(start + (end - start) * (f64::from(i) / 64.0)));
    places.collect()
}

/// A time as 32 bits hold it.
fn time32(time: f64) -> f64 {
    f64::from(time as f32)
}

/// A place as 32 bits hold it.
fn place32(place: Solid) -> Solid {
    place.as_vec3().as_dvec3()
}

/// The motion's tracks; `frames` are where they have keys if they cannot be exact.
pub(crate) fn of(built: &BuiltMotion, frames: &Frames) -> Tracks {
    let size = size(built);
    // What 32 bits leave open, but nothing that is seen.
    let tolerance = (ROUNDING * size).min(1e-6 * extent(built));
    let translation = cubics(built, tolerance).unwrap_or_else(|| straight(built, frames));
    let translation_error = off(built, &translation);
    let (rotation, rotation_error) = rotation(built, frames);
    Tracks {
        translation,
        rotation,
        translation_error,
        rotation_error,
    }
}

/// The farthest that the path gets from the origin along an axis, at least its own size.
pub(crate) fn size(built: &BuiltMotion) -> f64 {
    line(built)
        .into_iter()
        .map(|p| p.abs().max_element())
        .fold(f64::MIN_POSITIVE, f64::max)
}

/// Places between two of that many keys.
fn places(keys: usize) -> u32 {
    if keys < MANY { BETWEEN } else { FEW }
}

/// Times inside a span.
fn inside(from: f64, to: f64, count: u32) -> impl Iterator<Item = (f64, f64)> {
    (1..=count).map(move |i| {
        let share = f64::from(i) / f64::from(count + 1);
        (share, from + (to - from) * share)
    })
}

/// The largest distance between a track of places, as it is written, and the motion.
fn off(built: &BuiltMotion, track: &Track<Solid>) -> f64 {
    let motion = &built.motion;
    let mut worst = 0.0_f64;
    let mut compare = |value: Solid, time: f64| {
        worst = worst.max((value - motion.position(time)).length());
    };
    match track {
        Track::Linear(keys) => {
            let count = places(keys.len());
            for pair in keys.windows(2) {
                let [(from, a), (to, b)] = [0, 1].map(|i| (time32(pair[i].0), place32(pair[i].1)));
                compare(a, from);
                for (share, time) in inside(from, to, count) {
                    compare(a + (b - a) * share, time);
                }
                compare(b, to);
            }
        }
        Track::Cubic(keys) => {
            let count = places(keys.len());
            for pair in keys.windows(2) {
                let [(from, a), (to, b)] =
                    [0, 1].map(|i| (time32(pair[i].0), pair[i].1.map(place32)));
                let width = to - from;
                for (x, time) in inside(from, to, count) {
                    let (x2, x3) = (x * x, x * x * x);
                    let value = a[1] * (2.0 * x3 - 3.0 * x2 + 1.0)
                        + a[2] * (width * (x3 - 2.0 * x2 + x))
                        + b[1] * (3.0 * x2 - 2.0 * x3)
                        + b[0] * (width * (x3 - x2));
                    compare(value, time);
                }
                compare(a[1], from);
                compare(b[1], to);
            }
        }
    }
    worst
}

/// Cubics between the knots of the motion, if it is made of those.
fn cubics(built: &BuiltMotion, tolerance: f64) -> Option<Track<Solid>> {
    let motion = &built.motion;
    let knots = motion.knots()?;
    if knots.len() > MOST {
        return None;
    }
    let mut keys: Vec<(f64, [Solid; 3])> =
        vec![(knots[0], [Solid::ZERO, motion.position(0.0), Solid::ZERO])];
    let mut worst = 0.0_f64;
    for pair in knots.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let width = to - from;
        // The cubic through four points inside, in powers of the share of the span.
        let at = |share: f64| motion.position(from + width * share);
        let [a, b, c, d] = [0.125, 0.375, 0.625, 0.875].map(at);
        let power = interpolated([a, b, c, d]);
        let value = |x: f64| power[0] + (power[1] + (power[2] + power[3] * x) * x) * x;
        // The ends may be looked at from the other side of a jump: what is inside counts.
        for (share, time) in inside(from, to, 2 * BETWEEN) {
            let error = (value(share) - motion.position(time)).length();
            worst = worst.max(error);
        }
        for (share, time) in [(0.0, from), (1.0, to)] {
            worst = worst.max((value(share) - motion.position(time)).length());
        }
        if worst.is_nan() || worst > tolerance {
            return None;
        }
        let leave = power[1] / width;
        let reach = (power[1] + power[2] * 2.0 + power[3] * 3.0) / width;
        if let Some(last) = keys.last_mut() {
            last.1[2] = leave;
        }
        keys.push((to, [reach, motion.position(to), Solid::ZERO]));
    }
    Some(Track::Cubic(keys))
}

/// Powers of the cubic with these values at 1/8, 3/8, 5/8, 7/8.
fn interpolated([a, b, c, d]: [Solid; 4]) -> [Solid; 4] {
    // Newton's differences at steps of 1/4 from 1/8.
    let (ab, bc, cd) = ((b - a) * 4.0, (c - b) * 4.0, (d - c) * 4.0);
    let (abc, bcd) = ((bc - ab) * 2.0, (cd - bc) * 2.0);
    let all = (bcd - abc) * (4.0 / 3.0);
    // a + (x − x0)(ab + (x − x1)(abc + (x − x2) all)), multiplied out.
    let (x0, x1, x2) = (0.125, 0.375, 0.625);
    let two = [abc - all * x2, all];
    let three = [ab - two[0] * x1, two[0] - two[1] * x1, two[1]];
    [
        a - three[0] * x0,
        three[0] - three[1] * x0,
        three[1] - three[2] * x0,
        three[2],
    ]
}

/// A straight track from frame to frame; the frames' times as 32 bits hold them, so that their rounding costs nothing.
fn straight(built: &BuiltMotion, frames: &Frames) -> Track<Solid> {
    let motion = &built.motion;
    let times = frames.times.iter().map(|time| time32(*time));
    Track::Linear(times.map(|t| (t, motion.position(t))).collect())
}

/// Slerp between the recipe's keys where that is exact, else from frame to frame.
fn rotation(built: &BuiltMotion, frames: &Frames) -> (Track<DQuat>, f64) {
    let duration = built.motion.duration();
    let keys = built.attitude.key_times();
    if keys.len() <= MOST && !keys.is_empty() {
        let mut times: Vec<f64> = vec![0.0];
        times.extend(keys.iter().copied().filter(|t| *t > 0.0 && *t < duration));
        times.push(duration);
        let (track, worst) = slerped(built, &times);
        if worst <= TURNING {
            // As they are written; orientations by keys do not depend on what was asked before.
            let rounded: Vec<f64> = times.iter().map(|time| time32(*time)).collect();
            let seen = built.rotations(&with_places(&rounded));
            let worst = turned_off(&track, &seen, true);
            return (Track::Linear(track), worst);
        }
    }
    let times: Vec<f64> = frames.times.iter().map(|time| time32(*time)).collect();
    let (track, worst) = slerped(built, &times);
    (Track::Linear(track), worst)
}

/// The times, and places between each two of them.
fn with_places(times: &[f64]) -> Vec<f64> {
    let between = places(times.len());
    let mut all = Vec::with_capacity(times.len() * (between as usize + 1));
    for pair in times.windows(2) {
        all.push(pair[0]);
        all.extend(inside(pair[0], pair[1], between).map(|(_, time)| time));
    }
    all.extend(times.last());
    all
}

/// The rotations at times, and how far slerp between them, as it is written where times are those of 32 bits, is off.
fn slerped(built: &BuiltMotion, times: &[f64]) -> (Vec<(f64, DQuat)>, f64) {
    // Keys and the places between them in one run: frames that depend on those before them see the same ones.
    let seen = built.rotations(&with_places(times));
    let step = places(times.len()) as usize + 1;
    let mut track: Vec<(f64, DQuat)> = Vec::with_capacity(times.len());
    for (time, q) in times.iter().zip(seen.iter().step_by(step)) {
        // The nearer of both signs at each key, for players that do not look for it.
        let near = track.last().is_none_or(|(_, last)| last.dot(*q) >= 0.0);
        track.push((*time, if near { *q } else { -*q }));
    }
    let rounded = times.iter().all(|time| time32(*time) == *time);
    let worst = turned_off(&track, &seen, rounded);
    (track, worst)
}

/// The largest angle between slerp from key to key and what was seen at the keys and the places between them.
fn turned_off(keys: &[(f64, DQuat)], seen: &[DQuat], rounded: bool) -> f64 {
    let step = places(keys.len()) as usize + 1;
    let written = |q: DQuat| {
        if rounded {
            q.as_quat().as_dquat().normalize()
        } else {
            q
        }
    };
    let mut worst = 0.0_f64;
    for (i, pair) in keys.windows(2).enumerate() {
        let (a, b) = (written(pair[0].1), written(pair[1].1));
        for (k, q) in seen[i * step..=(i + 1) * step].iter().enumerate() {
            #[allow(clippy::cast_precision_loss)]
            let share = k as f64 / step as f64;
            worst = worst.max(angle(a.slerp(b, share), *q));
        }
    }
    worst
}

/// The angle between two rotations, accurate where it is small.
fn angle(a: DQuat, b: DQuat) -> f64 {
    let between = (a.conjugate() * b).normalize();
    2.0 * between.xyz().length().atan2(between.w.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_points_make_their_cubic() {
        let f = |x: f64| Solid::new(1.0 - x * x * x, 2.0 * x * x + x, -4.0);
        let power = interpolated([0.125, 0.375, 0.625, 0.875].map(f));
        let wanted = [
            Solid::new(1.0, 0.0, -4.0),
            Solid::new(0.0, 1.0, 0.0),
            Solid::new(0.0, 2.0, 0.0),
            Solid::new(-1.0, 0.0, 0.0),
        ];
        for (found, wanted) in power.iter().zip(wanted) {
            assert!((*found - wanted).length() < 1e-13, "{found}");
        }
    }

    #[test]
    fn small_angles_are_told() {
        let q = DQuat::from_rotation_y(1e-9);
        assert!((angle(DQuat::IDENTITY, q) - 1e-9).abs() < 1e-20);
        assert!(angle(q, -q) < 1e-15);
    }
}
