//! Functions along one line of pixels: from where in the result to where in the image.
//!
//! A line meets the curves of a grid at knots: the place where it meets one in the result, and how far that moves to its place
//! in the image. Between knots the displacement is a cubic with the slopes of the [`Spline`], limited for `monotone` so
//! that the place in the image increases strictly; beyond the outermost knots it is theirs. Displacements, not places, are
//! interpolated, so that where nothing moves places keep their bits.
//!
//! *Source*: G. Wolberg, *Digital Image Warping*, 1990, §7.7.4; [`Spline`] names the splines'. Beyond the grid: a decision,
//! because continued slopes would make curves cross.

use super::Spline;
use super::spline::parabola;

/// Where a line meets a curve of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Knot {
    /// Where in the result, in pixels along the line.
    pub(super) at: f64,
    /// How far it is from there to the place in the image.
    pub(super) shift: f64,
}

/// The displacement between two neighbouring knots, or beyond the outermost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// From here on it holds.
    start: f64,
    /// From here on the next one does.
    pub(super) end: f64,
    /// Where its parameter is 0, and how fast it grows; then the cubic's coefficients by ascending power.
    numbers: [f64; NUMBERS],
}

/// How many numbers a span is evaluated with.
pub(super) const NUMBERS: usize = 6;

/// The place in the image of a place in the result, by the numbers of a span.
#[inline(always)]
pub(super) fn evaluate([origin, rate, a, b, c, d]: [f64; NUMBERS], at: f64) -> f64 {
    let t = (at - origin) * rate;
    let shift = a + (b + (c + d * t) * t) * t;
    // Adding 0 would change the sign of a negative zero.
    if shift == 0.0 { at } else { at + shift }
}

impl Span {
    /// The place in the image of a place in the result.
    #[inline(always)]
    pub(super) fn place(&self, at: f64) -> f64 {
        evaluate(self.numbers, at)
    }

    /// What [`evaluate`] takes.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        self.numbers
    }

    /// Whether it holds for that place in the result.
    #[inline]
    pub(super) fn holds(&self, at: f64) -> bool {
        at >= self.start && at < self.end
    }

    /// A place in the result within the span at which places in the image do not increase.
    pub(super) fn turning_back(&self) -> Option<f64> {
        let [origin, rate, _, b, c, d] = self.numbers;
        if rate == 0.0 {
            return None;
        }
        // The slope of the place by the parameter: width + b + 2ct + 3dt².
        let width = 1.0 / rate;
        let slope = |t: f64| width + b + (2.0 * c + 3.0 * d * t) * t;
        let inner = -c / (3.0 * d);
        let inside = d > 0.0 && inner > 0.0 && inner < 1.0;
        let places = [0.0, 1.0, if inside { inner } else { 0.0 }];
        let lowest = places
            .into_iter()
            .min_by(|p, q| slope(*p).total_cmp(&slope(*q)));
        lowest
            .filter(|t| slope(*t) <= 0.0)
            .map(|t| origin + t * width)
    }
}

/// The span of `count` knots, at least one, that holds at `at`.
pub(super) fn span(spline: Spline, count: usize, knot: impl Fn(usize) -> Knot, at: f64) -> Span {
    // The first knot behind `at`.
    let (mut low, mut high) = (0, count);
    while low < high {
        let middle = low + (high - low) / 2;
        if knot(middle).at <= at {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    span_before(spline, count, knot, low)
}

/// The span that ends at knot `behind`; behind the last one the span that has no end.
pub(super) fn span_before(
    spline: Spline,
    count: usize,
    knot: impl Fn(usize) -> Knot,
    behind: usize,
) -> Span {
    let still = |knot: Knot, start: f64, end: f64| Span {
        start,
        end,
        numbers: [knot.at, 0.0, knot.shift, 0.0, 0.0, 0.0],
    };
    if behind == 0 {
        let first = knot(0);
        return still(first, f64::NEG_INFINITY, first.at);
    }
    let from = knot(behind - 1);
    if behind == count {
        return still(from, from.at, f64::INFINITY);
    }
    let to = knot(behind);
    let width = to.at - from.at;
    let rise = to.shift - from.shift;
    let (rate, chord) = (1.0 / width, rise / width);
    if spline == Spline::Linear {
        return Span {
            start: from.at,
            end: to.at,
            numbers: [from.at, rate, from.shift, rise, 0.0, 0.0],
        };
    }
    let slope = |before: f64, behind: f64, width: f64, next: f64| {
        let slope = parabola(before, behind, width, next);
        if spline == Spline::Monotone {
            // Of the place, which is 1 steeper: between 0 and twice the smaller chord.
            slope.min(2.0 * before.min(behind) + 1.0).max(-1.0)
        } else {
            slope
        }
    };
    let leaving = if behind >= 2 {
        let (far, next) = (knot(behind - 2), width);
        let width = from.at - far.at;
        slope((from.shift - far.shift) / width, chord, width, next)
    } else {
        chord
    };
    let arriving = if behind + 1 < count {
        let far = knot(behind + 1);
        let next = far.at - to.at;
        slope(chord, (far.shift - to.shift) / next, width, next)
    } else {
        chord
    };
    let (leaving, arriving) = (leaving * width, arriving * width);
    Span {
        start: from.at,
        end: to.at,
        numbers: [
            from.at,
            rate,
            from.shift,
            leaving,
            3.0 * rise - 2.0 * leaving - arriving,
            leaving + arriving - 2.0 * rise,
        ],
    }
}

/// The place in the image of a place in the result.
pub(super) fn place(spline: Spline, count: usize, knot: impl Fn(usize) -> Knot, at: f64) -> f64 {
    span(spline, count, knot, at).place(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knots(places: &[(f64, f64)]) -> Vec<Knot> {
        let knot = |&(at, image): &(f64, f64)| Knot {
            at,
            shift: image - at,
        };
        places.iter().map(knot).collect()
    }
    fn value(spline: Spline, knots: &[Knot], at: f64) -> f64 {
        place(spline, knots.len(), |i| knots[i], at)
    }

    #[test]
    fn knots_are_met_and_beyond_them_the_shift_goes_on() {
        let knots = knots(&[(0.0, 1.0), (2.0, 2.5), (2.5, 6.0), (9.0, 7.0)]);
        for spline in Spline::all() {
            for (at, image) in [
                (0.0, 1.0),
                (2.0, 2.5),
                (2.5, 6.0),
                (9.0, 7.0),
                (-100.0, -99.0),
                (1e9, 1e9 - 2.0),
            ] {
                assert!(
                    (value(spline, &knots, at) - image).abs() < 1e-12,
                    "{spline:?} {at}"
                );
            }
            for knot in &knots {
                // No jump.
                let (before, behind) = (knot.at - 1e-9, knot.at + 1e-9);
                let jump = value(spline, &knots, behind) - value(spline, &knots, before);
                assert!(jump.abs() < 1e-7);
            }
        }
    }

    #[test]
    fn what_stays_keeps_its_bits() {
        let knots = knots(&[(0.1, 0.1), (0.7, 0.7), (1.9, 1.9)]);
        for spline in Spline::all() {
            for at in [-0.0, -5.3, 0.1, 0.3, 1.9, 77.7] {
                assert_eq!(value(spline, &knots, at).to_bits(), at.to_bits());
            }
        }
    }

    #[test]
    fn monotone_lines_increase_where_catmull_rom_turns_back() {
        let steep = knots(&[(0.0, 0.0), (1.0, 0.01), (1.1, 5.0), (4.0, 5.01), (4.2, 9.0)]);
        let backwards = |spline| {
            let spans = (0..=5).map(|i| span_before(spline, 5, |k| steep[k], i));
            spans.filter(|span| span.turning_back().is_some()).count()
        };
        assert_eq!(backwards(Spline::Monotone), 0);
        assert_eq!(backwards(Spline::Linear), 0);
        assert!(backwards(Spline::CatmullRom) > 0);
        for spline in [Spline::Monotone, Spline::Linear] {
            let all: Vec<f64> = (-10..600)
                .map(|i| value(spline, &steep, f64::from(i) / 100.0))
                .collect();
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{spline:?}");
        }
        // Where it turns back, places do decrease.
        let span = (0..=5)
            .map(|i| span_before(Spline::CatmullRom, 5, |k| steep[k], i))
            .find(|span| span.turning_back().is_some())
            .unwrap();
        let at = span.turning_back().unwrap();
        assert!(span.place(at + 1e-4) < span.place(at - 1e-4));
    }
}
