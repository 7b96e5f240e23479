//! The curve that relaxes: the given points with others between them, so that it can bend.

use super::MOST;
use anamorph_core::glam::DVec2;

/// Points that a curve has at least: two rows of neighbours on each side, and then some.
const LEAST: usize = 8;

/// A polyline through the given points.
pub(super) struct Curve {
    /// Its points; the first is a given one.
    pub(super) points: Vec<DVec2>,
    /// Which of them were given, in order.
    marks: Vec<usize>,
    /// Where those were in the beginning.
    start: Vec<DVec2>,
    closed: bool,
    spacing: f64,
}

/// The length of a polyline.
fn length(points: &[DVec2]) -> f64 {
    points
        .windows(2)
        .map(|pair| pair[0].distance(pair[1]))
        .sum()
}

/// `count` points at the same distance from each other along a polyline, from its beginning to its end, the last not among
/// them where it is that of a closed curve.
fn spread(line: &[DVec2], count: usize, with_last: bool, out: &mut Vec<DVec2>) {
    let whole = length(line);
    let pieces = if with_last { count - 1 } else { count }.max(1);
    let (mut segment, mut before) = (0, 0.0);
    for number in 0..count {
        let at = whole * number as f64 / pieces as f64;
        while segment + 2 < line.len() && before + line[segment].distance(line[segment + 1]) < at {
            before += line[segment].distance(line[segment + 1]);
            segment += 1;
        }
        let Some(&[from, to]) = line.get(segment..segment + 2).and_then(|p| p.first_chunk()) else {
            out.extend(line.first());
            continue;
        };
        let own = from.distance(to);
        let share = if own > 0.0 {
            ((at - before) / own).clamp(0.0, 1.0)
        } else {
            0.0
        };
        out.push(from + (to - from) * share);
    }
}

impl Curve {
    /// The curve through `points`, with others at most `spacing` apart; `None` where those are too many.
    pub(super) fn new(points: &[DVec2], closed: bool, spacing: f64) -> Option<Self> {
        let mut line = points.to_vec();
        if closed {
            line.extend(points.first());
        }
        let spacing = spacing.min(length(&line) / LEAST as f64);
        let given = Self {
            points: points.to_vec(),
            marks: (0..points.len()).collect(),
            start: points.to_vec(),
            closed,
            spacing,
        };
        given.respaced()
    }

    /// The stretches from each given point to the next, both with them.
    fn stretches(&self) -> impl Iterator<Item = Vec<DVec2>> + '_ {
        let count = self.marks.len();
        let stretches = if self.closed { count } else { count - 1 };
        (0..stretches).map(move |number| {
            let from = self.marks[number];
            match self.marks.get(number + 1) {
                Some(&to) => self.points[from..=to].to_vec(),
                None => {
                    let mut line = self.points[from..].to_vec();
                    line.extend(self.points.first());
                    line
                }
            }
        })
    }

    /// The same curve with the points between the given ones spread anew; `None` where they are too many.
    pub(super) fn respaced(&self) -> Option<Self> {
        let mut points = Vec::new();
        let mut marks = Vec::with_capacity(self.marks.len());
        for line in self.stretches() {
            marks.push(points.len());
            let pieces = (length(&line) / self.spacing).ceil().max(1.0);
            if points.len() as f64 + pieces > MOST as f64 {
                return None;
            }
            spread(&line, pieces as usize, false, &mut points);
        }
        if !self.closed {
            marks.push(points.len());
            points.extend(self.points.last());
        }
        Some(Self {
            points,
            marks,
            start: self.start.clone(),
            closed: self.closed,
            spacing: self.spacing,
        })
    }

    /// The same curve with its points in other places.
    pub(super) fn with_points(&self, points: Vec<DVec2>) -> Self {
        Self {
            points,
            marks: self.marks.clone(),
            start: self.start.clone(),
            closed: self.closed,
            spacing: self.spacing,
        }
    }

    /// For each point the segment of the first shape that it lay on; of a given point both ends are its own place.
    pub(super) fn origins(&self) -> Vec<[DVec2; 2]> {
        let mut origins = Vec::with_capacity(self.points.len());
        for (number, &mark) in self.marks.iter().enumerate() {
            let next = (number + 1) % self.start.len();
            let own = [self.start[number], self.start[next]];
            let end = self.marks.get(number + 1).copied();
            origins.push([own[0]; 2]);
            origins.extend((mark + 1..end.unwrap_or(self.points.len())).map(|_| own));
        }
        origins
    }

    /// Lengths from each point to the next; of a closed curve also from the last to the first.
    pub(super) fn lengths(&self) -> Vec<f64> {
        let wrap = self
            .closed
            .then(|| [self.points.last(), self.points.first()]);
        let wrap = wrap.and_then(|[last, first]| Some(last?.distance(*first?)));
        let inner = self.points.windows(2).map(|pair| pair[0].distance(pair[1]));
        inner.chain(wrap).collect()
    }

    /// The unit vector across the curve at a point, by its neighbours; 0 where they are in one place.
    pub(super) fn normal(&self, i: usize) -> DVec2 {
        let count = self.points.len();
        let (before, after) = if self.closed {
            ((i + count - 1) % count, (i + 1) % count)
        } else {
            (i.saturating_sub(1), (i + 1).min(count - 1))
        };
        (self.points[after] - self.points[before])
            .perp()
            .normalize_or_zero()
    }

    /// The result: so many points the same distance apart, or the given ones.
    pub(super) fn result(&self, count: Option<usize>) -> Vec<DVec2> {
        count.map_or_else(|| self.given(), |count| self.resampled(count))
    }

    /// About which point of the curve a point of the result is.
    pub(super) fn place_of(&self, number: usize, count: Option<usize>) -> usize {
        let last = self.points.len() - 1;
        match count {
            Some(count) => {
                let pieces = if self.closed { count } else { count - 1 };
                (number * last / pieces.max(1)).min(last)
            }
            None => self.marks.get(number).copied().unwrap_or(last),
        }
    }

    /// The given points.
    pub(super) fn given(&self) -> Vec<DVec2> {
        self.marks.iter().map(|&mark| self.points[mark]).collect()
    }

    /// `count` points the same distance apart.
    pub(super) fn resampled(&self, count: usize) -> Vec<DVec2> {
        let mut line = self.points.clone();
        if self.closed {
            line.extend(self.points.first());
        }
        let mut out = Vec::with_capacity(count);
        spread(&line, count, !self.closed, &mut out);
        out
    }

    /// The mean of a function over the curve's points.
    pub(super) fn mean(&self, value: impl Fn(DVec2) -> f64) -> f64 {
        self.points.iter().map(|&p| value(p)).sum::<f64>() / self.points.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn given_points_stay_among_the_others() {
        let corners = [
            dvec2(0.0, 0.0),
            dvec2(10.0, 0.0),
            dvec2(10.0, 3.3),
            dvec2(0.0, 9.0),
        ];
        for closed in [false, true] {
            let curve = Curve::new(&corners, closed, 1.0).unwrap();
            assert_eq!(curve.given(), corners);
            assert!(curve.lengths().iter().all(|&l| l <= 1.0 + 1e-12 && l > 0.5));
            let pieces = if closed {
                curve.points.len()
            } else {
                curve.points.len() - 1
            };
            assert_eq!(curve.lengths().len(), pieces);
            assert_eq!(curve.respaced().unwrap().points.len(), curve.points.len());
        }
        // Doubled points have stretches of length 0, which stay.
        let doubled = [corners[0], corners[0], corners[1]];
        let curve = Curve::new(&doubled, false, 1.0).unwrap();
        assert_eq!(curve.given(), doubled);
    }

    #[test]
    fn resampling_is_even_and_keeps_ends() {
        let line = [dvec2(0.0, 0.0), dvec2(4.0, 0.0), dvec2(4.0, 8.0)];
        let open = Curve::new(&line, false, 1.0).unwrap().resampled(5);
        let known = [(0.0, 0.0), (3.0, 0.0), (4.0, 2.0), (4.0, 5.0), (4.0, 8.0)];
        for (point, (x, y)) in open.iter().zip(known) {
            assert!(point.distance(dvec2(x, y)) < 1e-12, "{point}");
        }
        let square = [
            dvec2(0.0, 0.0),
            dvec2(4.0, 0.0),
            dvec2(4.0, 4.0),
            dvec2(0.0, 4.0),
        ];
        let closed = Curve::new(&square, true, 1.0).unwrap().resampled(8);
        assert_eq!(closed.len(), 8);
        assert!(closed[7].distance(dvec2(0.0, 2.0)) < 1e-12, "{}", closed[7]);
    }
}
