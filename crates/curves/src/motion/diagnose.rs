//! Diagnosis of a motion: backing up, stalling, waiting, abrupt starts and ends, early and late arrival.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Working with time-distance curves": starts and ends abruptly; backs
//! up; stalls; starts partway along the curve and gets to the end before `t = 1`; waits a while before starting and
//! does not reach the end.
//!
//! Between its breaks a motion is analytic: its speed vanishes on a whole span or at single moments. Moments are zeros of
//! the speed between its turning points: for piecewise polynomials all of them are found, to the last digits; otherwise the
//! turning points are told from [`SAMPLES`] samples of the acceleration, and the zeros halved to the last digits.

use super::piecewise::{Coefficients, differentiated, evaluate, zeros, zeros_between};
use super::{Finding, SpeedControl};

/// Samples over all spans together; at least [`LEAST`] each, or of very many spans [`FEWEST`]. Motion that turns round more than once between two samples
/// may keep it secret.
const SAMPLES: usize = 16_384;
const LEAST: usize = 32;
/// Spans from which on fewer samples must do: a staircase of a million steps has as many spans.
const MANY: usize = 1 << 15;
const FEWEST: usize = 4;

/// Steps across each span to learn how far the motion goes.
const ACROSS: u32 = 8;

/// Shares of the mean speed: below the first it is at rest at a moment; above the second a speed at the ends is abrupt.
const REST: f64 = 1e-9;
const ABRUPT: f64 = 1e-6;

/// Share of the distance that counts as none, and of the duration.
const NEAR: f64 = 1e-9;

/// What there is to say about a motion that should cover the distance `total` in its own duration, in the order of time.
/// A negative `total` is a motion the other way: backing up is then going forward.
pub fn diagnose(control: &dyn SpeedControl, total: f64) -> Vec<Finding> {
    diagnose_until(control, total, control.duration())
}

/// The same for a motion that should have arrived at the time `due`.
pub fn diagnose_until(control: &dyn SpeedControl, total: f64, due: f64) -> Vec<Finding> {
    let breaks = control.breaks();
    let duration = control.duration();
    let within = breaks.windows(2).flat_map(|pair| {
        let step = (pair[1] - pair[0]) / f64::from(ACROSS);
        (0..=ACROSS).map(move |i| pair[0] + step * f64::from(i))
    });
    let reached = within.map(|time| control.distance(time).abs());
    let size = reached.fold(total.abs(), f64::max);
    if !(size > 0.0 && size.is_finite() && duration > 0.0) || breaks.len() < 2 {
        return Vec::new();
    }
    let probe = Probe {
        control,
        forward: if total < 0.0 { -1.0 } else { 1.0 },
        size,
        speed: size / duration,
        duration,
        spans: breaks.len() - 1,
    };
    let spans: Vec<Span> = (0..probe.spans)
        .map(|index| probe.span(index, breaks[index], breaks[index + 1]))
        .collect();
    let mut findings = probe.course(&spans, total, due);
    probe.off_path(&spans, total, &mut findings);
    let end = |finding: &Finding| finding.time().unwrap_or(f64::INFINITY);
    findings.sort_by(|a, b| end(a).total_cmp(&end(b)));
    findings
}

struct Probe<'a> {
    control: &'a dyn SpeedControl,
    /// 1, or −1 for a motion the other way.
    forward: f64,
    size: f64,
    speed: f64,
    duration: f64,
    spans: usize,
}

/// A stretch of time between two breaks.
struct Span {
    from: f64,
    to: f64,
    /// Whether the whole of it is at rest.
    rest: bool,
    /// The speeds inside at its ends, forward positive.
    speeds: [f64; 2],
    /// The moments inside at which the speed vanishes.
    moments: Vec<f64>,
    /// The distance over the time since the start, where it is a polynomial.
    piece: Option<Coefficients>,
}

/// A stretch of one sense: 1 forward, −1 back, 0 at rest.
#[derive(Clone, Copy)]
struct Run {
    from: f64,
    to: f64,
    sense: i8,
    /// The speeds inside at its ends.
    speeds: [f64; 2],
}

impl Probe<'_> {
    fn distance(&self, time: f64) -> f64 {
        self.forward * self.control.distance(time)
    }

    fn speed_at(&self, time: f64) -> f64 {
        self.forward * self.control.speed(time)
    }

    fn span(&self, index: usize, from: f64, to: f64) -> Span {
        let length = to - from;
        let piece = self
            .control
            .polynomials()
            .and_then(|curve| curve.piece(index));
        let piece = piece.map(|piece| piece.map(|c| self.forward * c));
        let tolerance = REST * self.speed;
        let (speeds, moments, rest);
        if let Some(piece) = piece {
            let slope = differentiated(&piece, 1);
            speeds = [slope[0], evaluate(&slope, length)];
            rest =
                (0..=16).all(|i| evaluate(&slope, length * f64::from(i) / 16.0).abs() <= tolerance);
            moments = if rest {
                Vec::new()
            } else {
                zeros(&slope, length, tolerance)
            };
        } else {
            speeds = [self.inside(from, length), self.inside(to, -length)];
            let least = if self.spans < MANY { LEAST } else { FEWEST };
            let samples = (SAMPLES / self.spans).max(least);
            #[allow(clippy::cast_precision_loss)]
            let at = |i: usize| length * (i as f64 + 0.5) / samples as f64;
            let slope = |since: f64| self.speed_at(from + since);
            rest = (0..samples).all(|i| slope(at(i)).abs() <= tolerance);
            moments = if rest {
                Vec::new()
            } else {
                let bend = |since: f64| self.control.acceleration(from + since);
                let mut turns = Vec::new();
                for i in 1..samples {
                    let (a, b) = (bend(at(i - 1)), bend(at(i)));
                    if (a > 0.0) != (b > 0.0) {
                        turns.push(super::piecewise::halved(&bend, at(i - 1), at(i)));
                    }
                }
                // The ends' own speeds may be those of the neighbouring spans: those from within decide.
                let inner = |since: f64| {
                    if since <= 0.0 {
                        speeds[0]
                    } else if since >= length {
                        speeds[1]
                    } else {
                        slope(since)
                    }
                };
                zeros_between(&inner, &turns, length, tolerance)
            };
        }
        Span {
            from,
            to,
            rest,
            speeds,
            moments: moments.iter().map(|since| from + since).collect(),
            piece,
        }
    }

    /// The speed at the end of a span, seen from within: that a little inside, unless the one at the end continues it.
    fn inside(&self, end: f64, length: f64) -> f64 {
        let (there, near) = (self.speed_at(end), self.speed_at(end + 1e-10 * length));
        let outer = end <= 0.0 || end >= self.duration;
        if outer || (there - near).abs() <= 1e-3 * self.speed {
            there
        } else {
            near
        }
    }

    /// The distance by which the motion jumps at a time: a difference that does not become smaller closer by, as it does
    /// where the speed is infinite.
    fn jump(&self, time: f64) -> Option<f64> {
        let gap = |share: f64| {
            let step = share * self.duration;
            self.distance(time + step) - self.distance(time - step)
        };
        let (close, wide) = (gap(1e-13), gap(1e-11));
        (close.abs() > 1e-7 * self.size && close.abs() > 0.7 * wide.abs()).then_some(close)
    }

    /// The motion as runs of one sense; moments at which it touches rest without turning round, and jumps, go straight to
    /// the findings.
    fn runs(&self, spans: &[Span], findings: &mut Vec<Finding>) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for span in spans {
            let mut jumped = false;
            if let Some(distance) = self.jump(span.from)
                && span.from > 0.0
            {
                jumped = true;
                findings.push(Finding::Jumps {
                    time: span.from,
                    distance,
                });
            }
            let mut places = vec![span.from];
            places.extend(&span.moments);
            places.push(span.to);
            let legs = places.len() - 1;
            for (leg, pair) in places.windows(2).enumerate() {
                let (from, to) = (pair[0], pair[1]);
                let sense = if span.rest {
                    0
                } else if self.speed_at(0.5 * (from + to)) < 0.0 {
                    -1
                } else {
                    1
                };
                let speeds = [
                    if leg == 0 { span.speeds[0] } else { 0.0 },
                    if leg + 1 == legs { span.speeds[1] } else { 0.0 },
                ];
                match runs.last_mut() {
                    Some(last) if last.sense == sense && !(leg == 0 && jumped) => {
                        if sense != 0 {
                            self.touch(from, [last.speeds[1], speeds[0]], findings);
                        }
                        last.to = to;
                        last.speeds[1] = speeds[1];
                    }
                    _ => runs.push(Run {
                        from,
                        to,
                        sense,
                        speeds,
                    }),
                }
            }
        }
        runs
    }

    /// A moment between two stretches of one sense: a stall, where the speed vanishes on either side.
    fn touch(&self, time: f64, [before, behind]: [f64; 2], findings: &mut Vec<Finding>) {
        let rests = |speed: f64| speed.abs() <= ABRUPT * self.speed;
        if !rests(before) && !rests(behind) {
            return;
        }
        findings.push(Finding::Stalls {
            from: time,
            to: time,
            distance: self.control.distance(time),
        });
        self.abrupt(time, [before, behind], findings);
    }

    /// From rest to a speed, or from a speed to rest, at once.
    fn abrupt(&self, time: f64, [before, behind]: [f64; 2], findings: &mut Vec<Finding>) {
        let fast = |speed: f64| speed.abs() > ABRUPT * self.speed;
        if fast(before) && !fast(behind) {
            let speed = self.forward * before;
            findings.push(Finding::EndsAbruptly { time, speed });
        }
        if fast(behind) && !fast(before) {
            let speed = self.forward * behind;
            findings.push(Finding::StartsAbruptly { time, speed });
        }
    }

    fn course(&self, spans: &[Span], total: f64, due: f64) -> Vec<Finding> {
        let mut findings = Vec::new();
        let start = self.distance(0.0);
        if start.abs() > NEAR * self.size {
            findings.push(Finding::StartsPartway {
                distance: self.forward * start,
            });
        }
        let runs = self.runs(spans, &mut findings);
        let last_jump = self.jump(self.duration);
        if let Some(distance) = last_jump {
            findings.push(Finding::Jumps {
                time: self.duration,
                distance,
            });
        }
        let mut arrival = self.duration;
        let mut before = 0.0;
        for (index, run) in runs.iter().enumerate() {
            let last = index + 1 == runs.len();
            // Turning round is no rest.
            if index == 0 || run.sense == 0 || runs[index - 1].sense == 0 {
                self.abrupt(run.from, [before, run.speeds[0]], &mut findings);
            }
            before = run.speeds[1];
            if run.sense < 0 {
                findings.push(Finding::BacksUp {
                    from: run.from,
                    to: run.to,
                    distance: self.distance(run.from) - self.distance(run.to),
                });
            }
            if run.sense != 0 {
                continue;
            }
            if last && last_jump.is_none() {
                arrival = run.from;
            } else if index == 0 {
                findings.push(Finding::Waits { until: run.to });
            } else {
                findings.push(Finding::Stalls {
                    from: run.from,
                    to: run.to,
                    distance: self.control.distance(0.5 * (run.from + run.to)),
                });
            }
        }
        self.abrupt(self.duration, [before, 0.0], &mut findings);
        let missing = self.forward * total - self.distance(self.duration);
        if missing > NEAR * self.size {
            findings.push(Finding::NeverArrives { missing });
        } else if missing >= -NEAR * self.size {
            let time = arrival;
            if time < due - NEAR * self.duration {
                findings.push(Finding::ArrivesEarly { time, due });
            } else if time > due + NEAR * self.duration {
                findings.push(Finding::ArrivesLate { time, due });
            }
        }
        findings
    }

    /// The stretches before the start of the path, and beyond its end.
    fn off_path(&self, spans: &[Span], total: f64, findings: &mut Vec<Finding>) {
        let near = NEAR * self.size;
        for (level, side) in [(0.0, -1.0), (self.forward * total, 1.0)] {
            let mut away: Option<(f64, f64, f64)> = None;
            for span in spans {
                let length = span.to - span.from;
                let over = |since: f64| match &span.piece {
                    Some(piece) => side * (evaluate(piece, since) - level),
                    None => {
                        // Inner ends are seen from within, as the motion may jump there.
                        let edge = 1e-12 * length;
                        let low = if span.from > 0.0 { edge } else { 0.0 };
                        let high = if span.to < self.duration { edge } else { 0.0 };
                        let since = since.clamp(low, length - high);
                        side * (self.distance(span.from + since) - level)
                    }
                };
                let turns: Vec<f64> = span.moments.iter().map(|time| time - span.from).collect();
                let mut places = vec![0.0];
                places.extend(zeros_between(&over, &turns, length, 1e-12 * self.size));
                places.push(length);
                for pair in places.windows(2) {
                    let inner = turns
                        .iter()
                        .copied()
                        .filter(|t| pair[0] < *t && *t < pair[1]);
                    let ends = [pair[0], 0.5 * (pair[0] + pair[1]), pair[1]];
                    let most = inner
                        .chain(ends)
                        .map(over)
                        .fold(f64::NEG_INFINITY, f64::max);
                    let (from, to) = (span.from + pair[0], span.from + pair[1]);
                    away = match (away, most > near) {
                        (None, false) => None,
                        (None, true) => Some((from, to, most)),
                        (Some((start, _, by)), true) => Some((start, to, by.max(most))),
                        (Some(stretch), false) => {
                            findings.push(leaves(stretch, side));
                            None
                        }
                    };
                }
            }
            findings.extend(away.map(|stretch| leaves(stretch, side)));
        }
    }
}

fn leaves((from, to, most): (f64, f64, f64), side: f64) -> Finding {
    Finding::LeavesPath {
        from,
        to,
        by: side * most,
    }
}
