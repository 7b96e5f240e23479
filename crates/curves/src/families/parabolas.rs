//! Blended parabolas: each span blends the parabolas through three points before and behind it.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Blended parabolas/Catmull–Rom"; A. Overhauser, *Analytic definition of
//! curves and surfaces by parabolic blending*, 1968. On the span from `P_i` to `P_{i+1}` the curve is `(1 − x)·A + x·B`,
//! `A` the parabola through `P_{i−1}, P_i, P_{i+1}` and `B` that through `P_i, P_{i+1}, P_{i+2}` at unit steps. Inside it
//! equals the uniform Catmull–Rom curve; the end spans are their one parabola, so that the whole does with equal end rules
//! (errata C20).

use super::{Generator, through};
use crate::error::enough;
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// A curve through all points, of blended parabolas.
#[derive(Clone, Debug, PartialEq)]
pub struct BlendedParabolas<S> {
    /// Points to pass: at least three.
    pub points: Vec<S>,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

/// Coefficients by `x` of the parabola through `a, b, c` at `x = −1, 0, 1`.
fn parabola<S: Space>(a: S, b: S, c: S) -> [S; 3] {
    [b, (c - a) * 0.5, (a + c) * 0.5 - b]
}

impl<S: Space> Generator<S> for BlendedParabolas<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let points = &self.points;
        enough("a curve of blended parabolas", 3, points)?;
        let n = points.len();
        let spans = (0..n - usize::from(!self.closed)).map(|i| {
            let at = |k: usize| points[k % n];
            let first = (self.closed || i > 0).then(|| parabola(at(i + n - 1), at(i), at(i + 1)));
            let second = (self.closed || i + 2 < n).then(|| {
                // Through the points at x = 0, 1, 2: moved by one.
                let [p, q, r] = parabola(at(i), at(i + 1), at(i + 2));
                [p - q + r, q - r * 2.0, r]
            });
            let [a, b] = match (first, second) {
                (Some(a), Some(b)) => [a, b],
                (Some(a), None) => [a, a],
                (None, Some(b)) => [b, b],
                (None, None) => [[at(i), at(i + 1) - at(i), S::ZERO]; 2],
            };
            Cubic([
                at(i),
                a[1] + (b[0] - a[0]),
                a[2] + (b[1] - a[1]),
                b[2] - a[2],
            ])
        });
        through(points, spans.collect(), None, self.closed)
    }
}
