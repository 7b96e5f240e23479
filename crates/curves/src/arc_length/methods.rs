//! The five ways of the slides to measure a curve, side by side.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length": forward differencing, supersampling, the
//! adaptive approach, quadrature, adaptive quadrature (errata C11). All take an accuracy and refine until two successive
//! approximations agree to it, or their cap is reached, and say which. Agreement is evidence, not proof: of the five only
//! the last also looks at halves apart, and [`ArcLength`](super::ArcLength) knows the error beforehand.
//! The document `curves.md` plots their errors against evaluations.

use super::gauss;
use crate::bezier::Pieces;
use anamorph_core::Space;

/// What a method found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The length, in scene units.
    pub length: f64,
    /// Points or velocities of the curve that were computed.
    pub evaluations: usize,
    /// Whether two approximations agreed to the accuracy before the cap was reached.
    pub converged: bool,
}

/// A way to measure a curve.
pub trait LengthMethod<S: Space>: Sync {
    /// Its name, as the slides call it.
    fn name(&self) -> &'static str;
    /// Measures the whole curve to `accuracy` in scene units.
    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured;
}

/// The five, in the order of the slides.
#[must_use]
pub fn methods<S: Space>() -> [&'static dyn LengthMethod<S>; 5] {
    [
        &ForwardDifferencing,
        &Supersampling,
        &Adaptive,
        &Quadrature,
        &AdaptiveQuadrature,
    ]
}

/// Evaluations after which a method stops.
pub const CAP: usize = 1 << 22;

/// Doubles the number of steps until two approximations agree: of an error that falls with the square of the step, that of
/// the finer is a third of the difference.
fn doubled(accuracy: f64, mut approximate: impl FnMut(usize) -> (f64, usize)) -> Measured {
    let mut steps = 4;
    let (mut before, mut evaluations) = approximate(steps);
    // Two agreements in a row: one may be chance.
    let mut agreed = false;
    loop {
        steps *= 2;
        let (length, more) = approximate(steps);
        evaluations += more;
        let near = (length - before).abs() / 3.0 <= accuracy;
        let converged = near && agreed;
        if converged || evaluations >= CAP {
            return Measured {
                length,
                evaluations,
                converged,
            };
        }
        agreed = near;
        before = length;
    }
}

/// Points at equal steps of the parameter by sums of differences, and the chords between them.
///
/// A polynomial of degree `d` needs `d` additions a point and no multiplication; sums of differences gather rounding errors,
/// about 1e-16 of the size times the cube of the steps.
#[derive(Clone, Copy, Debug)]
pub struct ForwardDifferencing;

impl<S: Space> LengthMethod<S> for ForwardDifferencing {
    fn name(&self) -> &'static str {
        "forward differencing"
    }

    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured {
        let pieces = curve.bezier_pieces();
        let each = accuracy / pieces.len() as f64;
        total(pieces.iter().map(|(_, _, bezier)| {
            doubled(each, |steps| {
                let degree = bezier.degree();
                // Differences of the first points become those of all.
                let mut row: Vec<S> = (0..=degree)
                    .map(|i| {
                        anamorph_core::Curve::point(bezier, (i as f64 / steps as f64).min(1.0))
                    })
                    .collect();
                if steps < degree {
                    let chords = row.windows(2).map(|w| w[0].distance(w[1]));
                    return (chords.sum(), degree + 1);
                }
                for level in 1..=degree {
                    for i in (level..=degree).rev() {
                        row[i] = row[i] - row[i - 1];
                    }
                }
                let mut length = 0.0;
                for _ in 0..steps {
                    let before = row[0];
                    for i in 0..degree {
                        let next = row[i + 1];
                        row[i] += next;
                    }
                    length += row[0].distance(before);
                }
                (length, steps + 1)
            })
        }))
    }
}

/// Points at equal steps of the parameter, and the chords between them.
#[derive(Clone, Copy, Debug)]
pub struct Supersampling;

impl<S: Space> LengthMethod<S> for Supersampling {
    fn name(&self) -> &'static str {
        "supersampling"
    }

    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured {
        let breaks = curve.breaks();
        let each = accuracy / (breaks.len() - 1) as f64;
        total(breaks.windows(2).map(|w| {
            doubled(each, |steps| {
                let at = |i: usize| curve.point(w[0] + (w[1] - w[0]) * (i as f64 / steps as f64));
                let mut before = at(0);
                let mut length = 0.0;
                for i in 1..=steps {
                    let point = at(i);
                    length += point.distance(before);
                    before = point;
                }
                (length, steps + 1)
            })
        }))
    }
}

/// Halves an interval where its chord and the chords of its halves disagree; the first three halvings are made without
/// asking, since a chord and two halves may agree by symmetry.
#[derive(Clone, Copy, Debug)]
pub struct Adaptive;

impl<S: Space> LengthMethod<S> for Adaptive {
    fn name(&self) -> &'static str {
        "adaptive"
    }

    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured {
        const UNASKED: u32 = 3;
        const DEPTH: u32 = 48;
        let breaks = curve.breaks();
        let each = accuracy / (breaks.len() - 1) as f64;
        total(breaks.windows(2).map(|w| {
            let (a, b) = (curve.point(w[0]), curve.point(w[1]));
            let mut stack = vec![(w[0], a, w[1], b, each, 0)];
            let mut sum = Measured {
                length: 0.0,
                evaluations: 2,
                converged: true,
            };
            while let Some((u, a, v, b, accuracy, depth)) = stack.pop() {
                let middle = 0.5 * (u + v);
                let m = curve.point(middle);
                sum.evaluations += 1;
                let halves = a.distance(m) + m.distance(b);
                // The error of the halves is a third of the difference.
                let agree = (halves - a.distance(b)) / 3.0 <= accuracy && depth >= UNASKED;
                if agree || depth >= DEPTH || sum.evaluations >= CAP {
                    sum.converged &= agree;
                    sum.length += halves;
                } else {
                    stack.push((middle, m, v, b, 0.5 * accuracy, depth + 1));
                    stack.push((u, a, middle, m, 0.5 * accuracy, depth + 1));
                }
            }
            sum
        }))
    }
}

/// Gauss' rule of 16 nodes on ever more equal intervals.
#[derive(Clone, Copy, Debug)]
pub struct Quadrature;

impl<S: Space> LengthMethod<S> for Quadrature {
    fn name(&self) -> &'static str {
        "quadrature"
    }

    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured {
        let breaks = curve.breaks();
        let each = accuracy / (breaks.len() - 1) as f64;
        total(breaks.windows(2).map(|w| {
            doubled(each, |steps| {
                // Four steps are one interval, so that this method starts where the others do.
                let count = steps / 4;
                let width = (w[1] - w[0]) / count as f64;
                let mut speed = |u: f64| curve.velocity(u).length();
                let parts = (0..count).map(|i| {
                    let start = w[0] + width * i as f64;
                    gauss::integral(&mut speed, start, start + width)
                });
                (parts.sum(), 16 * count)
            })
        }))
    }
}

/// Gauss' rule of 16 nodes, with intervals halved where a whole and its halves disagree.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveQuadrature;

impl<S: Space> LengthMethod<S> for AdaptiveQuadrature {
    fn name(&self) -> &'static str {
        "adaptive quadrature"
    }

    fn measure(&self, curve: &dyn Pieces<S>, accuracy: f64) -> Measured {
        let breaks = curve.breaks();
        let each = accuracy / (breaks.len() - 1) as f64;
        total(breaks.windows(2).map(|w| {
            let mut evaluations = 0;
            let mut speed = |u: f64| {
                evaluations += 1;
                curve.velocity(u).length()
            };
            let (length, converged) = gauss::adaptive_or_not(&mut speed, w[0], w[1], each);
            Measured {
                length,
                evaluations,
                converged,
            }
        }))
    }
}

fn total(parts: impl Iterator<Item = Measured>) -> Measured {
    let none = Measured {
        length: 0.0,
        evaluations: 0,
        converged: true,
    };
    parts.fold(none, |sum, part| Measured {
        length: sum.length + part.length,
        evaluations: sum.evaluations + part.evaluations,
        converged: sum.converged && part.converged,
    })
}
