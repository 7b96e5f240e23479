//! Rails: points and frames along a curve, tabled once so that a kernel reads them in a few operations.
//!
//! A rail holds cubic Hermite pieces: the point, the directions across and the direction along. Between two breaks of the curve
//! pieces are even and their slopes are differences of fourth order within the same stretch, so that the whole is C¹ where the
//! curve is smooth, and errs by the fourth power of the step. Steps are halved until the error, measured at three places of every
//! piece, is as asked for; the rail says what it reached ([`Rail::error`]), and whether directions jump at a corner
//! ([`Rail::has_corners`]).
//!
//! *Source*: C. de Boor, *A Practical Guide to Splines*, 1978, chapter IV (cubic Hermite interpolation); the table is a decision.

use super::WireError;
use anamorph_core::{Linear, Space};

/// A point of a curve with a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station<S: Space> {
    /// The point.
    pub point: S,
    /// Columns: the unit direction along the curve, then those across it (one in the plane, two in space).
    pub frame: S::Linear,
}

/// Numbers of a station: the point and three directions.
const NUMBERS: usize = 12;
/// The fewest pieces of a stretch, for five knots, and the most of a rail.
const PIECES: (usize, usize) = (4, 4096);
/// Stretches at most; of curves with more breaks only so many are kept, evenly chosen.
const MOST_STRETCHES: usize = 1024;
/// How far before the end of a stretch, as a share of it, its direction is read twice to extrapolate it to the end, where the curve's own
/// answer is that of the next stretch.
const BEFORE: f64 = 1e-6;
/// Directions that differ by more at a break make a corner.
const CORNER: f64 = 1e-5;

/// Where the direction along begins: behind the others, because a kernel needs it beyond the ends only.
const ALONG: usize = 9;

/// Coefficients of a piece by the share of it that lies before: of `1`, `t`, `t²`, `t³`.
pub(super) type Piece = [[f64; NUMBERS]; 4];

/// Even pieces between two breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    from: f64,
    /// Pieces a unit of the share.
    density: f64,
    first: usize,
    count: usize,
}

/// Stations along a curve, tabled.
#[derive(Debug, Clone, PartialEq)]
pub struct Rail<S: Space> {
    pieces: Vec<Piece>,
    stretches: Vec<Stretch>,
    /// For even steps of the share: the stretch in which the step begins.
    guide: Vec<u32>,
    error: f64,
    corners: bool,
    space: core::marker::PhantomData<S>,
}

fn flat<S: Space>(station: &Station<S>) -> [f64; NUMBERS] {
    let mut numbers = [0.0; NUMBERS];
    for axis in 0..S::DIM {
        numbers[axis] = station.point.component(axis);
        numbers[ALONG + axis] = station.frame.entry(axis, 0);
        for column in 1..S::DIM {
            numbers[3 * column + axis] = station.frame.entry(axis, column);
        }
    }
    numbers
}

impl<S: Space> Rail<S> {
    /// Tables the stations that a function gives for the shares 0 to 1 of a curve's length (or of its domain), to an error of `tolerance`:
    /// of points as a share of their extent, of directions as it is. `breaks` are the shares between which stations are smooth,
    /// ascending; 0 and 1 need not be among them.
    ///
    /// # Errors
    /// [`WireError::NotFinite`] when a station is not finite, [`WireError::NoLength`] when all points are the same.
    pub fn new(
        which: &'static str,
        breaks: &[f64],
        station: &dyn Fn(f64) -> Station<S>,
        tolerance: f64,
    ) -> Result<Self, WireError> {
        let lost = WireError::NotFinite { feature: 0, which };
        let wanted = if tolerance > 0.0 { tolerance } else { 0.0 };
        let ends = ends(breaks);
        let rough: Vec<_> = (0..=64)
            .map(|i| flat(&station(f64::from(i) / 64.0)))
            .collect();
        if rough.iter().flatten().any(|n| !n.is_finite()) {
            return Err(lost);
        }
        let extent = extent(&rough);
        if extent == 0.0 {
            return Err(WireError::NoLength { feature: 0, which });
        }
        let most = (PIECES.1 / (ends.len() - 1)).max(PIECES.0);
        let mut rail = Self {
            pieces: Vec::new(),
            stretches: Vec::new(),
            guide: Vec::new(),
            error: 0.0,
            corners: false,
            space: core::marker::PhantomData,
        };
        let mut last: Option<[f64; NUMBERS]> = None;
        for pair in ends.windows(2) {
            let (from, width) = (pair[0], pair[1] - pair[0]);
            // The end as seen from inside: the point itself, and directions extrapolated.
            let end = {
                let mut end = flat(&station(pair[1]));
                let near = flat(&station(pair[1] - BEFORE * width));
                let farther = flat(&station(pair[1] - 2.0 * BEFORE * width));
                for n in 3..NUMBERS {
                    end[n] = near[n] + (near[n] - farther[n]);
                }
                end
            };
            let at = |x: f64| {
                if x >= 1.0 {
                    end
                } else {
                    flat(&station(from + width * x))
                }
            };
            let start = at(0.0);
            if let Some(last) = last {
                let apart = start[3..]
                    .iter()
                    .zip(&last[3..])
                    .map(|(a, b)| (a - b).abs());
                rail.corners |= apart.fold(0.0, f64::max) > CORNER;
            }
            last = Some(end);
            let mut count = PIECES.0;
            let (pieces, error) = loop {
                let knots: Vec<_> = (0..=count).map(|i| at(i as f64 / count as f64)).collect();
                let pieces = pieces(&knots);
                if pieces.iter().flatten().flatten().any(|n| !n.is_finite()) {
                    return Err(lost);
                }
                let mut error = 0.0_f64;
                for (i, piece) in pieces.iter().enumerate() {
                    for quarter in 1..4 {
                        let exact = at((4 * i + quarter) as f64 / (4 * count) as f64);
                        let found: [f64; NUMBERS] = value(piece, 0, 0.25 * quarter as f64);
                        for (n, (f, e)) in found.iter().zip(exact).enumerate() {
                            let unit = if n < 3 { extent } else { 1.0 };
                            let off = (f - e).abs() / unit;
                            error = if off > error || off.is_nan() {
                                off
                            } else {
                                error
                            };
                        }
                    }
                }
                if error.is_nan() {
                    return Err(lost);
                }
                if error <= wanted || 2 * count > most {
                    break (pieces, error);
                }
                count *= 2;
            };
            rail.error = rail.error.max(error);
            rail.stretches.push(Stretch {
                from,
                density: count as f64 / width,
                first: rail.pieces.len(),
                count,
            });
            rail.pieces.extend(pieces);
        }
        let steps = 4 * rail.stretches.len();
        let mut stretch = 0;
        for step in 0..steps {
            let share = step as f64 / steps as f64;
            while rail
                .stretches
                .get(stretch + 1)
                .is_some_and(|s| s.from <= share)
            {
                stretch += 1;
            }
            rail.guide.push(u32::try_from(stretch).unwrap_or(0));
        }
        Ok(rail)
    }

    /// Whether directions jump somewhere inside.
    #[must_use]
    pub fn has_corners(&self) -> bool {
        self.corners
    }

    /// The greatest error measured: of points as a share of their extent, of directions as it is.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Number of pieces.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// The piece of a share from 0 to 1, and the share of the piece that lies before.
    #[inline(always)]
    pub(super) fn piece(&self, share: f64) -> (&Piece, f64) {
        let mut stretch = &self.stretches[0];
        if self.stretches.len() > 1 {
            // A NaN becomes 0, what is too large the last step.
            let step = ((share * self.guide.len() as f64) as usize).min(self.guide.len() - 1);
            let mut index = self.guide[step] as usize;
            stretch = &self.stretches[index];
            while let Some(next) = self.stretches.get(index + 1).filter(|s| s.from <= share) {
                index += 1;
                stretch = next;
            }
        }
        let scaled = (share - stretch.from) * stretch.density;
        let index = (scaled as usize).min(stretch.count - 1);
        (&self.pieces[stretch.first + index], scaled - index as f64)
    }

    /// The station at a share of the curve, which is brought to 0 to 1.
    #[must_use]
    pub fn station(&self, share: f64) -> Station<S> {
        let (piece, t) = self.piece(if share > 0.0 { share.min(1.0) } else { 0.0 });
        let across = across(piece, t);
        let along = along(piece, t);
        Station {
            point: S::from_fn(|axis| across[axis]),
            frame: S::Linear::from_columns(|column| {
                S::from_fn(|axis| match column {
                    0 => along[axis],
                    column => across[3 * column + axis],
                })
            }),
        }
    }
}

/// 0, the breaks strictly between, and 1.
fn ends(breaks: &[f64]) -> Vec<f64> {
    let mut inner: Vec<f64> = Vec::new();
    for &at in breaks {
        // Stretches narrower than this have no five knots that rounding tells apart.
        let last = inner.last().copied().unwrap_or(0.0);
        if at > last + 1e-6 && at < 1.0 - 1e-6 {
            inner.push(at);
        }
    }
    let skip = inner.len().div_ceil(MOST_STRETCHES - 1).max(1);
    let mut ends = vec![0.0];
    ends.extend(inner.into_iter().step_by(skip));
    ends.push(1.0);
    ends
}

/// The largest extent of the points along a coordinate axis.
fn extent(knots: &[[f64; NUMBERS]]) -> f64 {
    (0..3)
        .map(|axis| {
            let values = knots.iter().map(|k| k[axis]);
            let low = values.clone().fold(f64::INFINITY, f64::min);
            values.fold(f64::NEG_INFINITY, f64::max) - low
        })
        .fold(0.0, f64::max)
}

/// `N` numbers of a piece from the one with number `first` on.
#[inline(always)]
fn value<const N: usize>(piece: &Piece, first: usize, t: f64) -> [f64; N] {
    let mut numbers = [0.0; N];
    for (n, number) in numbers.iter_mut().enumerate() {
        let n = first + n;
        *number = piece[0][n] + t * (piece[1][n] + t * (piece[2][n] + t * piece[3][n]));
    }
    numbers
}

/// Point and directions across at a place of a piece.
#[inline(always)]
pub(super) fn across(piece: &Piece, t: f64) -> [f64; 9] {
    value(piece, 0, t)
}

/// The direction along at a place of a piece.
#[inline(always)]
pub(super) fn along(piece: &Piece, t: f64) -> [f64; 3] {
    value(piece, ALONG, t)
}

/// Weights of five neighbouring knots, twelfths of a step, for the slope at the first to the last of them.
const SLOPES: [[f64; 5]; 5] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];

fn pieces(knots: &[[f64; NUMBERS]]) -> Vec<Piece> {
    let last = knots.len() - 1;
    let slope = |i: usize, n: usize| {
        let first = i.saturating_sub(2).min(last - 4);
        let weights = &SLOPES[i - first];
        let terms = weights.iter().enumerate();
        terms.map(|(k, w)| w * knots[first + k][n]).sum::<f64>() / 12.0
    };
    let mut pieces = Vec::with_capacity(last);
    for i in 0..last {
        let mut piece = [[0.0; NUMBERS]; 4];
        for n in 0..NUMBERS {
            let (from, to) = (knots[i][n], knots[i + 1][n]);
            let (leaves, enters) = (slope(i, n), slope(i + 1, n));
            let rise = to - from;
            piece[0][n] = from;
            piece[1][n] = leaves;
            piece[2][n] = 3.0 * rise - 2.0 * leaves - enters;
            piece[3][n] = leaves + enters - 2.0 * rise;
        }
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::{DMat2, DVec2};
    use anamorph_core::{Plane, math};

    fn circle(share: f64) -> Station<Plane> {
        let (sin, cos) = math::sin_cos(5.0 * share);
        Station {
            point: DVec2::new(cos, sin) * 3.0,
            frame: DMat2::from_cols(DVec2::new(-sin, cos), DVec2::new(-cos, -sin)),
        }
    }

    #[test]
    fn rails_are_as_good_as_asked_for_and_of_fourth_order() {
        for tolerance in [1e-4, 1e-7, 1e-10] {
            let rail = Rail::new("target", &[], &circle, tolerance).unwrap();
            assert!(rail.error() <= tolerance);
            for i in 0..=1000 {
                let share = f64::from(i) / 1000.0;
                let (a, b) = (rail.station(share), circle(share));
                assert!(a.point.distance(b.point) <= 1.5 * tolerance * 6.0);
                assert!((a.frame.x_axis - b.frame.x_axis).length() <= 1.5 * tolerance);
            }
        }
        let [coarse, fine] = [1e-5, 1e-9].map(|t| Rail::new("target", &[], &circle, t).unwrap());
        let steps = fine.pieces() as f64 / coarse.pieces() as f64;
        let order = (coarse.error() / fine.error()).ln() / steps.ln();
        assert!((3.5..4.5).contains(&order), "{order}");
    }

    #[test]
    fn rails_refuse_points_and_say_what_corners_cost() {
        let still = |_: f64| Station {
            point: DVec2::ONE,
            frame: DMat2::IDENTITY,
        };
        let error = Rail::<Plane>::new("target", &[], &still, 1e-9).unwrap_err();
        assert!(matches!(error, WireError::NoLength { .. }));
        let lost = |share: f64| Station {
            point: DVec2::splat(1.0 / (share - 0.5)),
            frame: DMat2::IDENTITY,
        };
        assert!(Rail::<Plane>::new("target", &[], &lost, 1e-9).is_err());
        let corner = |share: f64| {
            let rising = share >= 0.3;
            let along = DVec2::new(1.0, if rising { 1.0 } else { -1.0 }).normalize();
            Station {
                point: DVec2::new(share, (share - 0.3).abs()),
                frame: DMat2::from_cols(along, along.perp()),
            }
        };
        // Where the corner is known nothing is lost, where it is not, the rail says so.
        let rail = Rail::<Plane>::new("target", &[0.3, 0.6], &corner, 1e-9).unwrap();
        assert!(rail.error() <= 1e-9 && rail.has_corners() && rail.pieces() == 12);
        for share in [0.0, 0.1, 0.299_999, 0.3, 0.45, 0.6, 0.61, 1.0] {
            let (a, b) = (rail.station(share), corner(share));
            assert!(a.point.distance(b.point) < 1e-9, "{share}");
            assert!((a.frame.x_axis - b.frame.x_axis).length() < 1e-9, "{share}");
        }
        let rail = Rail::<Plane>::new("target", &[], &corner, 1e-9).unwrap();
        assert!(rail.error() > 1e-9 && rail.pieces() == 4096);
    }
}
