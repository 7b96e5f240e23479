//! Motion along a path: `P(U(S(t)))`.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Controlling motion along p = P(u)" and "Speed control": a speed
//! control says which distance is covered at a time, the arc length's inverse which parameter that is, the path which
//! point. Without the middle step the control says the parameter itself, and the speed varies with the path's.

use super::clipped::clipped;
use super::{Finding, SpeedControl, diagnose_until, turning, turns_at_once};
use crate::families::registry::Path;
use crate::{CurveError, LengthTable};
use anamorph_core::Space;
use anamorph_core::glam::DQuat;
use std::sync::Arc;

/// Samples on each span of a control between which it is taken to be monotone when [`Motion::knots`] are sought.
const SAMPLES: u32 = 64;
/// Knots beyond which [`Motion::knots`] gives up: motions that circle a path for ever.
const MOST_KNOTS: usize = 1 << 16;
/// Halvings of a bracket of time; 60 of them reach neighbouring numbers.
const HALVINGS: u32 = 64;

/// What a speed control's distances are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Lengths along the path, in scene units: a constant speed is even.
    #[default]
    Length,
    /// Parameters of the path, from the start of its domain: a constant speed is as uneven as the path's own.
    Parameter,
}

/// A point that moves along a path. All answers are total, as those of [`SpeedControl`] and of curves are: motion that goes
/// beyond an open path waits at its end, and on a closed path goes round again.
pub struct Motion<S: Space> {
    path: Arc<dyn Path<S>>,
    table: LengthTable,
    control: Box<dyn SpeedControl>,
    measure: Measure,
    duration: f64,
}

impl<S: Space> Motion<S> {
    /// A motion that covers what `control` says and lasts as long.
    ///
    /// `accuracy` is that of the lengths, in scene units ([`LengthTable`]).
    ///
    /// # Errors
    /// A path without length, and an accuracy that is not positive.
    pub fn new(
        path: Arc<dyn Path<S>>,
        control: Box<dyn SpeedControl>,
        measure: Measure,
        accuracy: f64,
    ) -> Result<Self, CurveError> {
        let table = LengthTable::new(path.as_ref(), accuracy)?;
        Ok(Self::prepared(path, table, control, measure))
    }

    /// The same with a table that was made for `path`.
    #[must_use]
    pub fn prepared(
        path: Arc<dyn Path<S>>,
        table: LengthTable,
        control: Box<dyn SpeedControl>,
        measure: Measure,
    ) -> Self {
        Self {
            path,
            table,
            duration: control.duration(),
            control,
            measure,
        }
    }

    /// The motion with another duration, greater than 0. The control's times stay: a longer motion waits at the end, a shorter one
    /// breaks off.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn lasting(mut self, duration: f64) -> Result<Self, CurveError> {
        self.duration = super::positive_duration(duration)?;
        Ok(self)
    }

    /// How long it lasts.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &Arc<dyn Path<S>> {
        &self.path
    }

    /// The lengths along the path.
    #[must_use]
    pub fn table(&self) -> &LengthTable {
        &self.table
    }

    /// Which distance is covered at which time.
    #[must_use]
    pub fn control(&self) -> &dyn SpeedControl {
        self.control.as_ref()
    }

    /// What the control's distances are.
    #[must_use]
    pub fn measure(&self) -> Measure {
        self.measure
    }

    /// The parameter `U(S(t))` of the path at a time, within its domain.
    #[must_use]
    pub fn parameter(&self, time: f64) -> f64 {
        let covered = self.control.distance(self.within(time));
        match self.measure {
            Measure::Length => self.table.parameter(covered),
            Measure::Parameter => self.path.within(self.path.domain().0 + covered),
        }
    }

    /// The point at a time.
    #[must_use]
    pub fn position(&self, time: f64) -> S {
        self.path.point(self.parameter(time))
    }

    /// The length from the start of the path to the point at a time, in scene units. Rounds of a closed path count.
    #[must_use]
    pub fn distance(&self, time: f64) -> f64 {
        let covered = self.control.distance(self.within(time));
        match self.measure {
            Measure::Length if self.path.is_closed() => covered,
            Measure::Length => covered.clamp(0.0, self.table.length()),
            Measure::Parameter => {
                let (start, end) = self.path.domain();
                let rounds = if self.path.is_closed() {
                    (covered / (end - start)).floor()
                } else {
                    0.0
                };
                let rest = (covered - rounds * (end - start)).clamp(0.0, end - start);
                rounds * self.table.length() + self.table.length_to(start + rest)
            }
        }
    }

    /// The speed along the path at a time, in scene units for a unit of time; negative where it goes back, 0 where it waits
    /// at an end.
    #[must_use]
    pub fn speed(&self, time: f64) -> f64 {
        let time = self.within(time);
        let speed = self.control.speed(time);
        let covered = self.control.distance(time);
        if !self.path.is_closed() && !(0.0..=self.total()).contains(&covered) {
            return 0.0;
        }
        match self.measure {
            Measure::Length => speed,
            Measure::Parameter => speed * self.path.velocity(self.parameter(time)).length(),
        }
    }

    /// The velocity at a time.
    #[must_use]
    pub fn velocity(&self, time: f64) -> S {
        let along = self.path.velocity(self.parameter(time)).normalized();
        along.map_or(S::ZERO, |direction| direction * self.speed(time))
    }

    /// The time brought into the motion's own.
    fn within(&self, time: f64) -> f64 {
        if time >= 0.0 {
            time.min(self.duration)
        } else {
            0.0
        }
    }

    /// The whole path in the control's measure.
    fn total(&self) -> f64 {
        match self.measure {
            Measure::Length => self.table.length(),
            Measure::Parameter => {
                let (start, end) = self.path.domain();
                end - start
            }
        }
    }

    /// What there is to say about the motion: see [`diagnose`](super::diagnose). It is due at the end of its duration. Beyond the
    /// end of an open path it waits there. On a closed path it is due where it starts, after as many rounds as it comes
    /// nearest to, at least one, and may go on there as fast as it came.
    #[must_use]
    pub fn diagnose(&self) -> Vec<Finding> {
        let round = self.total();
        if !self.path.is_closed() {
            let findings = diagnose_until(self.control.as_ref(), round, self.duration);
            return clipped(findings, self.control.as_ref(), round);
        }
        let end = self.control.distance(self.control.duration());
        self.diagnose_over(round * (end / round).round().max(1.0))
    }

    /// The same of a motion along a closed path that is to cover a distance, in what its control measures: it arrives there, be it
    /// whole rounds or not. Along an open path it is [`Self::diagnose`].
    #[must_use]
    pub fn diagnose_over(&self, distance: f64) -> Vec<Finding> {
        if !self.path.is_closed() {
            return self.diagnose();
        }
        let total = distance;
        let mut findings = diagnose_until(self.control.as_ref(), total, self.duration);
        findings.retain(|finding| !matches!(finding, Finding::LeavesPath { .. }));
        if self.closes(total) {
            let abrupt = |f: &Finding| {
                matches!(
                    f,
                    Finding::StartsAbruptly { .. } | Finding::EndsAbruptly { .. }
                )
            };
            let [first, last] = [0.0, self.duration].map(|time| self.control.speed(time));
            if (first - last).abs() <= 1e-6 * first.abs().max(last.abs()) {
                findings.retain(|finding| !abrupt(finding));
            }
        }
        findings
    }

    /// Whether it covers that distance, from the start of a closed path, and these are whole rounds.
    fn closes(&self, total: f64) -> bool {
        let rounds = total / self.total();
        let end = self.control.distance(self.control.duration());
        self.path.is_closed()
            && (rounds - rounds.round()).abs() <= 1e-9 * rounds.abs()
            && (end - total).abs() <= 1e-9 * total.abs()
            && self.control.distance(0.0) == 0.0
    }

    /// Where something that moves like this turns at once: see [`turns_at_once`]. `rotations` gives its rotations at increasing
    /// times. Where it jumps, a turn does not count; where whole rounds of a closed path end, the first rotation is what the
    /// last has to be.
    pub fn diagnose_turning(
        &self,
        rotations: &mut dyn FnMut(&[f64]) -> Vec<DQuat>,
    ) -> Vec<Finding> {
        // A hundredth of the path in a ten-thousandth of the time is a jump.
        let (soon, near) = (1e-4 * self.duration, 1e-2 * self.total());
        let goes_on = |a: f64, b: f64| {
            let [from, to] = [a, b].map(|time| self.control.distance(time));
            b - a > soon || (to - from).abs() < near
        };
        let mut findings = turns_at_once(self.duration, rotations, &goes_on);
        let end = self.control.distance(self.control.duration());
        let late = |finding: &Finding| {
            finding
                .time()
                .is_some_and(|time| time >= self.duration * (1.0 - 1e-4))
        };
        if self.closes(end) && !findings.last().is_some_and(late) {
            let ends = rotations(&[0.0, self.duration]);
            if let [first, last] = ends[..] {
                findings.extend(turning::between(first, last, self.duration));
            }
        }
        findings
    }

    /// The times between which the motion is smooth, both ends included, strictly increasing: where the control or the path
    /// has a break. A control that is not made of polynomials and turns round more than once within a 64th of one of its
    /// spans may hide some. `None` where there are more than 65536.
    #[must_use]
    pub fn knots(&self) -> Option<Vec<f64>> {
        let breaks = self.breaks_in_measure();
        let round = self.total();
        let mut knots = Vec::new();
        let mut controls: Vec<f64> = self.control.breaks();
        if controls.len() > MOST_KNOTS {
            return None;
        }
        controls.retain(|time| *time < self.duration);
        controls.push(self.duration);
        for pair in controls.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            knots.push(from);
            let at = |step: u32| from + (to - from) * (f64::from(step) / f64::from(SAMPLES));
            let mut begin = (from, self.control.distance(from));
            for step in 1..=SAMPLES {
                let time = if step == SAMPLES { to } else { at(step) };
                let end = (time, self.control.distance(time));
                self.crossings(begin, end, &breaks, round, &mut knots)?;
                begin = end;
            }
        }
        knots.push(self.duration);
        knots.sort_by(f64::total_cmp);
        // Crossings that rounding cannot tell from a break are that break.
        let near = 1e-12 * self.duration;
        knots.dedup_by(|b, a| *b - *a <= near);
        if let (Some(last), true) = (knots.last_mut(), controls.len() > 1) {
            *last = self.duration;
        }
        Some(knots)
    }

    /// The breaks of the path in the control's measure.
    fn breaks_in_measure(&self) -> Vec<f64> {
        let breaks = self.path.breaks();
        let start = self.path.domain().0;
        let each = breaks.iter().map(|b| match self.measure {
            Measure::Length => self.table.length_to(*b),
            Measure::Parameter => b - start,
        });
        let mut all: Vec<f64> = each.collect();
        if let Some(last) = all.last_mut() {
            // The end of a closed domain wraps to its start.
            *last = self.total();
        }
        all
    }

    /// Adds the times between two at which the control's distance passes a break, and of its next rounds.
    fn crossings(
        &self,
        begin: (f64, f64),
        end: (f64, f64),
        breaks: &[f64],
        round: f64,
        knots: &mut Vec<f64>,
    ) -> Option<()> {
        let (low, high) = (begin.1.min(end.1), begin.1.max(end.1));
        let (first, last) = if self.path.is_closed() {
            ((low / round).floor(), (high / round).floor())
        } else {
            (0.0, 0.0)
        };
        let mut turn = first;
        while turn <= last {
            let shift = turn * round;
            let from = breaks.partition_point(|b| b + shift <= low);
            for target in breaks[from..].iter().map(|b| b + shift) {
                if target >= high {
                    break;
                }
                knots.push(self.time_of(target, begin, end));
                if knots.len() > MOST_KNOTS {
                    return None;
                }
            }
            if turn + 1.0 == turn || knots.len() > MOST_KNOTS {
                return None;
            }
            turn += 1.0;
        }
        Some(())
    }

    /// The time at which a distance between those of two times is reached.
    fn time_of(&self, target: f64, begin: (f64, f64), end: (f64, f64)) -> f64 {
        let rising = end.1 > begin.1;
        let (mut low, mut high) = (begin.0, end.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if (self.control.distance(middle) < target) == rising {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}

impl<S: Space> core::fmt::Debug for Motion<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Motion")
            .field("length", &self.table.length())
            .field("control", &self.control)
            .field("measure", &self.measure)
            .field("duration", &self.duration)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eases::{Linear, Sinusoidal};
    use crate::families::registry::{Given, family};
    use crate::motion::{DistanceKey, DistanceTime, Eased};
    use anamorph_core::Solid;
    use anamorph_core::glam::dvec3;

    fn path(kind: &str, closed: bool) -> Arc<dyn Path<Solid>> {
        let given = Given {
            points: vec![
                dvec3(0.0, 0.0, 0.0),
                dvec3(1.0, 2.0, 0.5),
                dvec3(4.0, 1.0, -1.0),
                dvec3(5.0, -2.0, 1.0),
            ],
            closed,
            ..Given::default()
        };
        Arc::from(family(kind).unwrap().make(&given).unwrap())
    }

    fn eased(distance: f64, duration: f64) -> Box<dyn SpeedControl> {
        Box::new(Eased::new(Sinusoidal, duration, distance).unwrap())
    }

    #[test]
    fn speed_is_the_length_covered_by_time() {
        let path = path("catmull-rom", false);
        let length = path.length(1e-10);
        for measure in [Measure::Length, Measure::Parameter] {
            let total = match measure {
                Measure::Length => length,
                Measure::Parameter => path.domain().1 - path.domain().0,
            };
            let motion = Motion::new(Arc::clone(&path), eased(total, 2.0), measure, 1e-10).unwrap();
            assert_eq!(motion.position(0.0), dvec3(0.0, 0.0, 0.0));
            assert!((motion.position(9.0) - dvec3(5.0, -2.0, 1.0)).length() < 1e-12);
            assert!((motion.distance(2.0) - length).abs() < 1e-9);
            for step in 1..40 {
                let (t, h) = (0.05 * f64::from(step) + 0.003, 1e-5);
                let by_length = (motion.distance(t + h) - motion.distance(t - h)) / (2.0 * h);
                assert!(
                    (by_length - motion.speed(t)).abs() < 1e-5,
                    "{measure:?} {t}"
                );
                let slope = (motion.position(t + h) - motion.position(t - h)) / (2.0 * h);
                assert!(
                    (slope - motion.velocity(t)).length() < 1e-4,
                    "{measure:?} {t}"
                );
                let there = path.length_between(path.domain().0, motion.parameter(t), 1e-11);
                assert!((there - motion.distance(t)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn knots_are_where_control_and_path_break() {
        let path = path("catmull-rom", false);
        let length = path.length(1e-10);
        let motion = Motion::new(
            Arc::clone(&path),
            Box::new(Eased::new(Linear, 3.0, length).unwrap()),
            Measure::Length,
            1e-10,
        )
        .unwrap();
        let knots = motion.knots().unwrap();
        let inner: Vec<f64> = path.breaks()[1..3]
            .iter()
            .map(|b| 3.0 * path.length_between(path.domain().0, *b, 1e-11) / length)
            .collect();
        assert_eq!(knots.len(), 4, "{knots:?}");
        assert_eq!((knots[0], knots[3]), (0.0, 3.0));
        assert!((knots[1] - inner[0]).abs() < 1e-8 && (knots[2] - inner[1]).abs() < 1e-8);

        // There and back again, and rounds of a closed path.
        let keys = [(0.0, 0.0), (1.0, length), (2.0, 0.0)];
        let keys = keys.map(|(t, s)| DistanceKey::new(t, s));
        let back = DistanceTime::monotone(&keys).unwrap();
        let motion = Motion::new(path, Box::new(back), Measure::Length, 1e-10).unwrap();
        assert_eq!(motion.knots().unwrap().len(), 7);
        assert_eq!(motion.position(2.0), dvec3(0.0, 0.0, 0.0));
        let ring = self::path("catmull-rom", true);
        let around = ring.length(1e-10);
        let motion = Motion::new(ring, eased(3.0 * around, 1.0), Measure::Length, 1e-10).unwrap();
        assert_eq!(motion.knots().unwrap().len(), 13);
        assert!(motion.position(1.0).length() < 1e-8);
        assert!((motion.distance(1.0) - 3.0 * around).abs() < 1e-9);
        assert!(motion.diagnose().is_empty(), "{:?}", motion.diagnose());
    }

    #[test]
    fn too_many_rounds_have_no_knots() {
        let ring = path("catmull-rom", true);
        let motion = Motion::new(ring, eased(1e30, 1.0), Measure::Length, 1e-9).unwrap();
        assert_eq!(motion.knots(), None);
        assert!(motion.position(0.7).is_finite());
    }

    #[test]
    fn a_motion_may_break_off_or_wait() {
        let path = path("bezier", false);
        let length = path.length(1e-10);
        let make = || Motion::new(Arc::clone(&path), eased(length, 2.0), Measure::Length, 1e-9);
        let long = make().unwrap().lasting(3.0).unwrap();
        assert_eq!(long.position(2.5), long.position(2.0));
        assert_eq!(long.diagnose().len(), 1, "{:?}", long.diagnose());
        assert_eq!(long.knots().unwrap(), [0.0, 2.0, 3.0]);
        let short = make().unwrap().lasting(1.0).unwrap();
        assert!((short.distance(5.0) - 0.5 * length).abs() < 1e-9);
        assert!(make().unwrap().lasting(0.0).is_err());
        assert!(make().unwrap().lasting(f64::NAN).is_err());
        let still = Given {
            points: vec![Solid::ONE; 4],
            ..Given::default()
        };
        let still: Arc<dyn Path<Solid>> =
            Arc::from(family("bezier").unwrap().make(&still).unwrap());
        let none = Motion::new(still, eased(1.0, 1.0), Measure::Length, 1e-9);
        assert_eq!(none.unwrap_err(), CurveError::NoLength);
    }
}
