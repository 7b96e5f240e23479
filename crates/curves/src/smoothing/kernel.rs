//! Convolution: the neighbour average and kernels of any width.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Smoothing data": averaging of adjacent points (errata C5: `¼ ½ ¼`, not
//! three quarters), the kernels box, wide box, tent and Gaussian, and the area weights `1/8 3/4 1/8`, by which a point
//! is the mean, over its own interval, of the lines to its neighbours.
//!
//! Beyond the ends of an open path a kernel sees the path turned by half a turn about the end, `2P₀ − P(k)` for `P(−k)`.
//! Hence lines pass unchanged everywhere, and the ends of a path stay where they are under every kernel.

use super::{Filter, Weights, wrapped};
use crate::CurveError;
use anamorph_core::math;

/// The widest kernel, in points to each side: wider ones would cost more than a fit.
const WIDEST: usize = 100_000;

/// Symmetric weights whose sum is 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Kernel {
    /// Weight of the point, then of the neighbours at distance 1, 2, … on either side.
    half: Vec<f64>,
}

impl Kernel {
    /// Symmetric weights: that of the point, then those of the neighbours at distance 1, 2, … on either side. They are
    /// divided by their sum.
    ///
    /// # Errors
    /// [`CurveError::TooFewPoints`] without weights, [`CurveError::NotFinite`], [`CurveError::OutOfRange`] for a
    /// sum that is not positive, or more than 100 000 to a side.
    pub fn symmetric(half: &[f64]) -> Result<Self, CurveError> {
        if half.is_empty() {
            return Err(CurveError::TooFewPoints {
                what: "a kernel",
                needed: 1,
                found: 0,
            });
        }
        #[allow(clippy::cast_precision_loss)]
        if half.len() > WIDEST + 1 {
            return Err(CurveError::OutOfRange {
                name: "number of weights to a side",
                value: (half.len() - 1) as f64,
                range: "at most 100000",
            });
        }
        if let Some(index) = half.iter().position(|weight| !weight.is_finite()) {
            return Err(CurveError::NotFinite {
                what: "weight",
                index,
            });
        }
        // Small weights first.
        let side: f64 = half.iter().skip(1).rev().sum();
        let sum = 2.0 * side + half[0];
        if !sum.is_finite() || sum <= 0.0 {
            return Err(CurveError::OutOfRange {
                name: "sum of the weights",
                value: sum,
                range: "a positive number",
            });
        }
        Ok(Self {
            half: half.iter().map(|weight| weight / sum).collect(),
        })
    }

    fn of(radius: usize, weight: impl Fn(f64) -> f64) -> Result<Self, CurveError> {
        #[allow(clippy::cast_precision_loss)]
        if radius > WIDEST {
            return Err(CurveError::OutOfRange {
                name: "radius",
                value: radius as f64,
                range: "at most 100000 points",
            });
        }
        #[allow(clippy::cast_precision_loss)]
        let half: Vec<f64> = (0..=radius).map(|k| weight(k as f64)).collect();
        Self::symmetric(&half)
    }

    /// The mean of the point and `radius` neighbours on either side; 1 is the slides' box, 2 their wide box.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`] above 100 000.
    pub fn box_of(radius: usize) -> Result<Self, CurveError> {
        Self::of(radius, |_| 1.0)
    }

    /// Weights that fall evenly and would be 0 at the distance `radius + 1`; 1 is the neighbour average `¼ ½ ¼`.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`] above 100 000.
    pub fn tent(radius: usize) -> Result<Self, CurveError> {
        #[allow(clippy::cast_precision_loss)]
        let reach = radius as f64 + 1.0;
        Self::of(radius, |k| reach - k)
    }

    /// Weights `exp(−k²/(2a²))` at distance `k` for a deviation `a` of `deviation` points, from 0.01 to 10 000, as far as
    /// needed for what is cut off to be at most the share `cut` of the whole, from 1e-15 to 0.5; then normalized.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn gaussian(deviation: f64, cut: f64) -> Result<Self, CurveError> {
        if !(0.01..=1e4).contains(&deviation) {
            return Err(CurveError::OutOfRange {
                name: "deviation",
                value: deviation,
                range: "from 0.01 to 10000 points",
            });
        }
        if !(1e-15..=0.5).contains(&cut) {
            return Err(CurveError::OutOfRange {
                name: "cut",
                value: cut,
                range: "from 1e-15 to 0.5",
            });
        }
        let weight = |k: f64| math::exp(-0.5 * (k / deviation) * (k / deviation));
        // At nine deviations e^(−40.5) is left, below 3e-18; at least two points.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let far = (9.0 * deviation).ceil().max(2.0) as usize;
        #[allow(clippy::cast_precision_loss)]
        let mut half: Vec<f64> = (0..=far).map(|k| weight(k as f64)).collect();
        let whole = half[0] + 2.0 * half.iter().skip(1).rev().sum::<f64>();
        let mut lost = 0.0;
        while half.len() > 1 {
            lost += 2.0 * half[half.len() - 1];
            if lost > cut * whole {
                break;
            }
            half.pop();
        }
        Self::symmetric(&half)
    }

    /// The area weights `1/8 3/4 1/8`.
    pub fn area_weighted() -> Self {
        Self {
            half: vec![0.75, 0.125],
        }
    }

    /// Points to each side that it reads.
    pub fn radius(&self) -> usize {
        self.half.len() - 1
    }

    /// Weight of the point, then of the neighbours at distance 1, 2, … on either side.
    pub fn half(&self) -> &[f64] {
        &self.half
    }
}

struct Convolution<'a> {
    half: &'a [f64],
    count: usize,
    closed: bool,
}

impl Filter for Kernel {
    fn weights(&self, count: usize, closed: bool) -> Box<dyn Weights + '_> {
        Box::new(Convolution {
            half: &self.half,
            count,
            closed,
        })
    }
}

impl Weights for Convolution<'_> {
    fn row(&self, index: usize, row: &mut Vec<(usize, f64)>) {
        let last = self.count - 1;
        if !self.closed && (index == 0 || index == last) {
            // Pairs of points beyond an end and before it have the end as their middle.
            row.push((index, 1.0));
            return;
        }
        // Distances are below 2¹⁷, indices below 2⁶³.
        #[allow(clippy::cast_possible_wrap)]
        for (distance, &weight) in self.half.iter().enumerate() {
            let distance = distance as i64;
            let sides = if distance == 0 { &[0][..] } else { &[-1, 1] };
            for side in sides {
                let offset = side * distance;
                if self.closed {
                    row.push((wrapped(index, offset, self.count), weight));
                } else {
                    extended(index as i64 + offset, last, weight, row);
                }
            }
        }
    }
}

/// The point at `at` of a path continued beyond its ends, `0` and `last`, by half turns about them, as often as needed.
fn extended(at: i64, last: usize, weight: f64, row: &mut Vec<(usize, f64)>) {
    #[allow(clippy::cast_possible_wrap)]
    let period = 2 * last as i64;
    if (0..=period / 2).contains(&at) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        row.push((at as usize, weight));
        return;
    }
    // Two half turns are a shift by twice the vector from end to end.
    let (shifts, within) = (at.div_euclid(period), at.rem_euclid(period));
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let within = within as usize;
    let mut at_last = 0.0;
    if within <= last {
        row.push((within, weight));
    } else {
        row.push((2 * last - within, -weight));
        at_last += 2.0;
    }
    #[allow(clippy::cast_precision_loss)]
    let shift = 2.0 * shifts as f64;
    at_last += shift;
    row.push((last, at_last * weight));
    row.push((0, -shift * weight));
}

/// The average of a point with the mean of its neighbours, `¼ ½ ¼`. Lines pass unchanged; the ends of an open path stay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NeighbourAverage;

impl Filter for NeighbourAverage {
    fn weights(&self, count: usize, closed: bool) -> Box<dyn Weights + '_> {
        Box::new(Convolution {
            half: &[0.5, 0.25],
            count,
            closed,
        })
    }
}
