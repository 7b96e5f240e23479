//! Polynomials of the time, one a span, and their zeros.
//!
//! *Source*: the zeros of a polynomial lie between those of its derivative, on each of whose intervals it is monotone and
//! halving is sure (Rolle's theorem; e.g. J. F. Traub, *Iterative Methods for the Solution of Equations*, 1964).

/// Coefficients of a polynomial, the constant first.
pub(crate) type Coefficients = [f64; 6];

/// A function that is a polynomial of degree at most 5 on each of its spans. Constant before and behind them.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewisePolynomial {
    breaks: Vec<f64>,
    /// In the time since the span's start.
    pieces: Vec<Coefficients>,
    /// The value at the end, exactly.
    last: f64,
}

impl PiecewisePolynomial {
    /// From at least two increasing breaks, one piece fewer, and the value at the end.
    pub(crate) fn new(breaks: Vec<f64>, pieces: Vec<Coefficients>, last: f64) -> Self {
        debug_assert_eq!(breaks.len(), pieces.len() + 1);
        Self {
            breaks,
            pieces,
            last,
        }
    }

    /// Where the spans begin and end, increasing.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// The coefficients over a span, by the time since it began, the constant first.
    pub fn piece(&self, span: usize) -> Option<&[f64; 6]> {
        self.pieces.get(span)
    }

    /// The end of the last span.
    pub fn end(&self) -> f64 {
        self.breaks[self.breaks.len() - 1]
    }

    /// The span of a time, and the time since its start. Not before the first break nor after the last.
    fn locate(&self, time: f64) -> (usize, f64) {
        let after = self.breaks.partition_point(|&b| b <= time);
        let span = after.saturating_sub(1).min(self.pieces.len() - 1);
        (span, time - self.breaks[span])
    }

    /// The value at a time; what is not a number counts as the start.
    pub fn value(&self, time: f64) -> f64 {
        if time >= self.end() {
            self.last
        } else if time > self.breaks[0] {
            let (span, since) = self.locate(time);
            evaluate(&self.pieces[span], since)
        } else {
            self.pieces[0][0]
        }
    }

    /// A derivative at a time, from the span behind it; at the end from the last; 0 outside.
    pub fn derivative(&self, time: f64, order: usize) -> f64 {
        if !(time >= self.breaks[0] && time <= self.end()) {
            return 0.0;
        }
        let (span, since) = self.locate(time);
        evaluate(&differentiated(&self.pieces[span], order), since)
    }
}

/// The value of a polynomial.
pub(crate) fn evaluate(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * at + c)
}

/// The coefficients of a derivative.
pub(crate) fn differentiated(coefficients: &Coefficients, order: usize) -> Coefficients {
    let mut result = *coefficients;
    for _ in 0..order {
        for power in 1..result.len() {
            #[allow(clippy::cast_precision_loss)]
            {
                result[power - 1] = result[power] * power as f64;
            }
        }
        result[result.len() - 1] = 0.0;
    }
    result
}

/// The zeros of a polynomial strictly inside `(0, end)`, increasing, and the places at which it touches 0 without
/// more than rounding. `tolerance` is the value that counts as 0 at a turning point.
pub(crate) fn zeros(coefficients: &[f64], end: f64, tolerance: f64) -> Vec<f64> {
    let degree = coefficients.iter().rposition(|&c| c != 0.0).unwrap_or(0);
    if degree == 0 {
        return Vec::new();
    }
    #[allow(clippy::cast_precision_loss)]
    let slope: Vec<f64> = (1..=degree).map(|k| coefficients[k] * k as f64).collect();
    // A turning point is wherever the slope vanishes exactly.
    let turns = zeros(&slope, end, 0.0);
    let f = |t: f64| evaluate(&coefficients[..=degree], t);
    zeros_between(&f, &turns, end, tolerance)
}

/// The zeros strictly inside `(0, end)` of a function that is monotone between its turning points.
pub(crate) fn zeros_between(
    f: &dyn Fn(f64) -> f64,
    turns: &[f64],
    end: f64,
    tolerance: f64,
) -> Vec<f64> {
    let mut places = vec![0.0];
    places.extend(turns);
    places.push(end);
    let mut found: Vec<f64> = Vec::new();
    for pair in places.windows(2) {
        let (start, stop) = (pair[0], pair[1]);
        let (a, b) = (f(start), f(stop));
        // Ends that count as zero are listed themselves, where they are turning points.
        if a.abs() > tolerance && b.abs() > tolerance && (a > 0.0) != (b > 0.0) {
            found.push(halved(f, start, stop));
        }
        if stop < end && b.abs() <= tolerance {
            found.push(stop);
        }
    }
    found.dedup();
    found.retain(|&t| t > 0.0 && t < end);
    found
}

/// The zero between two places at which a function has opposite signs, by halving to neighbouring numbers.
pub(crate) fn halved(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let rising = f(low) < 0.0;
    // Halving a bracket of ordinary size takes about 60 steps, one from 0 at most 1100.
    for _ in 0..1100 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        let value = f(middle);
        if value == 0.0 {
            return middle;
        }
        if (value < 0.0) == rising {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The piece with given values and slopes at both ends of a span.
pub(crate) fn hermite(span: f64, from: f64, to: f64, start: f64, stop: f64) -> Coefficients {
    let chord = (to - from) / span;
    let second = (3.0 * chord - 2.0 * start - stop) / span;
    let third = (start + stop - 2.0 * chord) / (span * span);
    [from, start, second, third, 0.0, 0.0]
}

/// The integral of a piece, with a constant. Of the piece's six coefficients the last must be 0.
pub(crate) fn integrated(piece: &Coefficients, constant: f64) -> Coefficients {
    let mut result = [constant, 0.0, 0.0, 0.0, 0.0, 0.0];
    for power in 1..result.len() {
        #[allow(clippy::cast_precision_loss)]
        {
            result[power] = piece[power - 1] / power as f64;
        }
    }
    result
}
