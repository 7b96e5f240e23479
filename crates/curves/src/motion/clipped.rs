//! What there is to say of a motion that cannot leave its path: beyond the end of an open path it waits there.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Working with time-distance curves". A diagnosis looks at distances alone, which
//! may go anywhere; what is seen of them is what lies on the path.

use super::{Finding, SpeedControl};

/// Halvings of a bracket of time; 60 of them reach neighbouring numbers.
const HALVINGS: u32 = 64;
/// Share of the path that counts as none.
const NEAR: f64 = 1e-9;

/// The time between two at which a distance that falls between them is reached.
fn falls_to(control: &dyn SpeedControl, level: f64, [mut early, mut late]: [f64; 2]) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (early + late);
        if middle <= early || middle >= late {
            break;
        }
        if control.distance(middle) > level {
            early = middle;
        } else {
            late = middle;
        }
    }
    0.5 * (early + late)
}

/// The findings of a motion over distances as those of one that stays on the path from 0 to `total`, positive.
pub(super) fn clipped(
    findings: Vec<Finding>,
    control: &dyn SpeedControl,
    total: f64,
) -> Vec<Finding> {
    let near = NEAR * total;
    let on = |distance: f64| distance.clamp(0.0, total);
    let off = |distance: f64| distance > total + near || distance < -near;
    let beside = |time: f64| {
        let step = 1e-12 * control.duration();
        [time - step, time + step].map(|time| control.distance(time))
    };
    let each = findings.into_iter().filter_map(|finding| match finding {
        Finding::BacksUp { from, to, .. } => {
            let (start, end) = (control.distance(from), control.distance(to));
            let distance = on(start) - on(end);
            let since = if start > total {
                falls_to(control, total, [from, to])
            } else {
                from
            };
            let until = if end < 0.0 {
                falls_to(control, 0.0, [from, to])
            } else {
                to
            };
            (distance > near).then_some(Finding::BacksUp {
                from: since,
                to: until,
                distance,
            })
        }
        Finding::Stalls { distance, .. } if off(distance) => None,
        Finding::StartsPartway { distance } => {
            let distance = on(distance);
            (distance > near).then_some(Finding::StartsPartway { distance })
        }
        Finding::Jumps { time, .. } => {
            let [before, behind] = beside(time).map(on);
            let distance = behind - before;
            (distance.abs() > near).then_some(Finding::Jumps { time, distance })
        }
        Finding::StartsAbruptly { time, .. } | Finding::EndsAbruptly { time, .. }
            if beside(time).into_iter().all(off) =>
        {
            None
        }
        other => Some(other),
    });
    each.collect()
}
