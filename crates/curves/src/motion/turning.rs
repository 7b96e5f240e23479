//! Where something turns at once.
//!
//! Orientations along a path may jump: where a view passes through its target or along its up vector, at corners and cusps,
//! where leans follow a curvature that jumps. A turn between two samples is one of them if it stays as large however close
//! they are; those that only are quick become small. *Decision*: it is at once within [`AT_ONCE`] of the duration, which is less
//! than a frame, and it is worth a word from [`TURN`] on, which is seen.

use super::Finding;
use anamorph_core::glam::DQuat;

/// Samples at equal times to begin with.
const SAMPLES: u32 = 2048;
/// Share of the duration within which a turn is at once.
const AT_ONCE: f64 = 1e-5;
/// The least turn that counts, in radians: two degrees.
const TURN: f64 = 0.034_906_585_039_886_59;
/// Turns that are looked at more closely at a time; the first of them, where there are more.
const MOST: usize = 512;

/// The angle between two rotations, in radians.
fn angle(a: DQuat, b: DQuat) -> f64 {
    let between = a.conjugate() * b;
    2.0 * anamorph_core::math::atan2(between.xyz().length(), between.w.abs())
}

/// The moments at which something turns by two degrees or more at once.
///
/// `rotations` gives the unit rotations at increasing times; it is asked again for finer ones. `goes_on(a, b)` says whether two
/// times belong together: where the motion itself is in another place at once, a turn is no wonder.
pub fn turns_at_once(
    duration: f64,
    rotations: &mut dyn FnMut(&[f64]) -> Vec<DQuat>,
    goes_on: &dyn Fn(f64, f64) -> bool,
) -> Vec<Finding> {
    let even = (0..=SAMPLES).map(|i| duration * (f64::from(i) / f64::from(SAMPLES)));
    let mut times: Vec<f64> = even.collect();
    loop {
        let turned = rotations(&times);
        let mut more = Vec::new();
        let mut found = Vec::new();
        for (pair, q) in times.windows(2).zip(turned.windows(2)) {
            let by = angle(q[0], q[1]);
            if by < TURN || more.len() + found.len() >= MOST || !goes_on(pair[0], pair[1]) {
                continue;
            }
            let middle = 0.5 * (pair[0] + pair[1]);
            if pair[1] - pair[0] > AT_ONCE * duration && middle > pair[0] && middle < pair[1] {
                more.push(middle);
            } else {
                found.push(Finding::TurnsAtOnce {
                    time: middle,
                    angle: by,
                });
            }
        }
        if more.is_empty() {
            return merged(found, duration);
        }
        times.extend(more);
        times.sort_by(f64::total_cmp);
    }
}

/// The turn from one rotation to another at a time, if it counts.
pub(super) fn between(from: DQuat, to: DQuat, time: f64) -> Option<Finding> {
    let angle = angle(from, to);
    (angle >= TURN).then_some(Finding::TurnsAtOnce { time, angle })
}

/// Turns next to each other as one: a moment on a sample is seen on both its sides.
fn merged(found: Vec<Finding>, duration: f64) -> Vec<Finding> {
    let mut all: Vec<Finding> = Vec::with_capacity(found.len());
    for finding in found {
        if let (
            Some(Finding::TurnsAtOnce { time, angle }),
            Finding::TurnsAtOnce {
                time: next,
                angle: by,
            },
        ) = (all.last_mut(), finding)
            && next - *time <= 2.0 * AT_ONCE * duration
        {
            *angle = (*angle + by).min(core::f64::consts::PI);
            continue;
        }
        all.push(finding);
    }
    all
}
