//! Arc length `s(u)`, its inverse `U(s)`, and tables of both.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length"; errata C11 (five methods and closed
//! forms) and C13 (a tolerance on length). An `accuracy` is absolute, in scene units, and honoured on *length*: of a
//! parameter found for a length `s`, the curve's length up to it is within `accuracy` of `s`. Accuracies below about 1e-15
//! of the curve's length are beyond `f64` and taken as that.

pub mod closed;
mod cubic;
mod gauss;
mod inverse;
pub mod methods;
mod search;
mod table;
mod zeros;

pub use inverse::InverseArcLength;
pub use search::{cubic_parameter_at, cubic_parameters_at};
pub use table::LengthTable;

use crate::families::Lagrange;
use crate::{Bezier, PiecewiseBezier, PiecewiseCubic};
use anamorph_core::{Curve, Differentiable, Space};
use cubic::{Ruler, Stretch, WHOLE};

/// A curve whose length is known to any accuracy.
pub trait ArcLength<S: Space>: Differentiable<S> {
    /// The length between two parameters in scene units, negative where `end` lies before `start`. Parameters are brought into the domain;
    /// see [`Curve::within`].
    fn length_between(&self, start: f64, end: f64, accuracy: f64) -> f64;

    /// The length of the whole curve.
    fn length(&self, accuracy: f64) -> f64 {
        let (start, end) = self.domain();
        self.length_between(start, end, accuracy)
    }

    /// About how many times as long as that of a cubic the measuring of a short part takes: what bounds the work of tables.
    fn effort(&self) -> usize {
        1
    }
}

/// [`ArcLength::effort`] by velocities, for each control point that a velocity is summed of: seven rules of 16 nodes, where a cubic,
/// whose rule is known, has one of 8 and some work around it.
const BY_VELOCITY: usize = 4;

/// The accuracy that is possible and sensible: positive, and not below the rounding of the length.
fn sensible(accuracy: f64, size: f64) -> f64 {
    let least = 1e-15 * size;
    if accuracy > least {
        accuracy
    } else {
        least.max(f64::MIN_POSITIVE)
    }
}

impl<S: Space> PiecewiseCubic<S> {
    /// The stretches of pieces between two parameters of the domain, the first not greater.
    fn stretches(&self, start: f64, end: f64) -> impl Iterator<Item = (usize, Stretch)> {
        let (first, from, _) = self.locate(start);
        let (last, to, _) = self.locate(end);
        (first..=last).map(move |i| {
            let stretch = Stretch {
                from: if i == first { from } else { 0.0 },
                to: if i == last { to } else { 1.0 },
            };
            (i, stretch)
        })
    }

    /// A bound of the length: that of the control polygon.
    fn polygon(&self) -> f64 {
        let pieces = self.pieces().iter();
        pieces
            .map(|c| {
                let [a, b, c, d] = c.to_bezier();
                a.distance(b) + b.distance(c) + c.distance(d)
            })
            .sum()
    }
}

impl<S: Space> ArcLength<S> for PiecewiseCubic<S> {
    fn length_between(&self, start: f64, end: f64, accuracy: f64) -> f64 {
        let (start, end) = (self.within(start), self.within(end));
        let (from, to, sign) = if start <= end {
            (start, end, 1.0)
        } else {
            (end, start, -1.0)
        };
        let (first, last) = (self.locate(from).0, self.locate(to).0);
        let pieces = self.pieces()[first..=last].iter();
        let size: f64 = pieces
            .map(|c| c.0[1].length() + c.0[2].length() + c.0[3].length())
            .sum();
        let each = sensible(accuracy, size) / (last - first + 1) as f64;
        if first == last {
            let ((_, a, _), (_, b, _)) = (self.locate(from), self.locate(to));
            return sign * measured(&self.pieces()[first], Stretch { from: a, to: b }, each);
        }
        let parts = self
            .stretches(from, to)
            .map(|(i, s)| (&self.pieces()[i], s));
        let mut sum = 0.0;
        cubic::lengths(parts, each, |_, _, _, length| sum += length);
        sign * sum
    }
}

/// The length of a stretch of a cubic.
fn measured<S: Space>(
    cubic: &crate::Cubic<S>,
    Stretch { from, to }: Stretch,
    accuracy: f64,
) -> f64 {
    cubic::with_vectors!(vectors => Ruler::new(cubic).length(vectors, from, to, accuracy))
}

/// The length of a curve without a faster way, from its velocity; `breaks` are those of the curve.
fn by_velocity<S: Space, C: Differentiable<S> + ?Sized>(
    curve: &C,
    breaks: &[f64],
    start: f64,
    end: f64,
    accuracy: f64,
) -> f64 {
    let (start, end) = (curve.within(start), curve.within(end));
    if start > end {
        return -by_velocity(curve, breaks, end, start, accuracy);
    }
    let inner = &breaks[breaks.partition_point(|b| *b <= start)..];
    let inner = &inner[..inner.partition_point(|b| *b < end)];
    let mut cuts = Vec::with_capacity(inner.len() + 2);
    cuts.push(start);
    cuts.extend(inner);
    cuts.push(end);
    let mut speed = |u: f64| curve.velocity(u).length();
    let rough: f64 = cuts
        .windows(2)
        .map(|pair| gauss::integral(&mut speed, pair[0], pair[1]))
        .sum();
    // Speeds carry the rounding of all that they are summed of.
    let each = accuracy.max(1e-14 * rough).max(f64::MIN_POSITIVE) / (cuts.len() - 1) as f64;
    let mut sum = 0.0;
    for pair in cuts.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        // At a break the velocity is that of the piece behind it; nodes lie inside.
        sum += gauss::adaptive(&mut speed, a, b, each);
    }
    sum
}

impl<S: Space> ArcLength<S> for Bezier<S> {
    fn length_between(&self, start: f64, end: f64, accuracy: f64) -> f64 {
        if self.degree() > 3 {
            return by_velocity(self, &[0.0, 1.0], start, end, accuracy);
        }
        let (start, end) = (self.within_unit(start), self.within_unit(end));
        let (from, to, sign) = if start <= end {
            (start, end, 1.0)
        } else {
            (end, start, -1.0)
        };
        let cubic = self.cubic();
        let size = cubic.0[1].length() + cubic.0[2].length() + cubic.0[3].length();
        sign * measured(&cubic, Stretch { from, to }, sensible(accuracy, size))
    }

    fn effort(&self) -> usize {
        if self.degree() > 3 {
            BY_VELOCITY * self.points().len()
        } else {
            1
        }
    }
}

impl<S: Space> ArcLength<S> for PiecewiseBezier<S> {
    fn length_between(&self, start: f64, end: f64, accuracy: f64) -> f64 {
        by_velocity(self, self.breaks_in_place(), start, end, accuracy)
    }

    fn effort(&self) -> usize {
        BY_VELOCITY * self.pieces()[0].points().len()
    }
}

impl<S: Space> ArcLength<S> for Lagrange<S> {
    fn length_between(&self, start: f64, end: f64, accuracy: f64) -> f64 {
        by_velocity(self, self.nodes(), start, end, accuracy)
    }

    fn effort(&self) -> usize {
        BY_VELOCITY * self.to_bezier().points().len()
    }
}

/// The whole lengths of many cubic Bézier curves, each to `accuracy`: several times as fast as one at a time, and equal to
/// it bit for bit.
pub fn cubic_lengths<S: Space>(curves: &[[S; 4]], accuracy: f64, out: &mut Vec<f64>) {
    let cubics: Vec<crate::Cubic<S>> = curves
        .iter()
        .map(|p| crate::Cubic::from_bezier(*p))
        .collect();
    out.clear();
    out.resize(curves.len(), 0.0);
    cubic::lengths(
        cubics.iter().map(|c| (c, WHOLE)),
        accuracy,
        |i, _, _, length| out[i] += length,
    );
}
