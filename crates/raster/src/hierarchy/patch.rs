//! The interpolant of a cell.
//!
//! With values `f` and derivatives at the corners of the unit square the edges are cubic Hermite curves, and the inside is
//! their Coons patch with linear blending: along a row it is a cubic. Bubbles, quartics that vanish with their slopes at both ends of an
//! edge, make it agree with values in the middles of the edges and of the cell, too.

use anamorph_core::glam::{DMat2, DVec2};
use anamorph_core::simd::{Level, Simd, dispatch, fearless_simd::f32x8, prelude::*};

/// Lanes of a vector: four offsets.
const LANES: usize = 8;

/// A bound of the rounding of an offset of that size stored as `f32`.
pub(super) fn rounding(offset: f64) -> f64 {
    offset * f64::from(f32::EPSILON) * 0.5
}

/// A cubic `c₀ + c₁ s + c₂ s² + c₃ s³`.
type Cubic = [DVec2; 4];

fn hermite(f0: DVec2, f1: DVec2, d0: DVec2, d1: DVec2) -> Cubic {
    let rise = f1 - f0;
    [f0, d0, 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise]
}

/// What is known of a cell's corners: above left, above right, below left, below right.
pub(super) struct Corners {
    /// Displacements.
    values: [DVec2; 4],
    /// Their derivatives across and down, times the cell's size.
    across: [DVec2; 4],
    down: [DVec2; 4],
}

/// Shares of both ends' values and derivatives in a cubic Hermite curve at ¼ and at ¾.
const QUARTERS: [[f64; 4]; 2] = [
    [27.0 / 32.0, 5.0 / 32.0, 9.0 / 64.0, -3.0 / 64.0],
    [5.0 / 32.0, 27.0 / 32.0, 3.0 / 64.0, -9.0 / 64.0],
];
/// The bubble there.
const QUARTER_BUBBLE: f64 = 9.0 / 16.0;

impl Corners {
    pub(super) fn new(values: [DVec2; 4], jacobians: [DMat2; 4], size: usize) -> Self {
        let h = size as f64;
        Self {
            values,
            across: jacobians.map(|j| j.x_axis * h),
            down: jacobians.map(|j| j.y_axis * h),
        }
    }

    /// What is missing at exact values in the middles of the upper, lower, left and right edge and of the cell: there the error
    /// of a patch without bubbles is largest where the map is smooth.
    pub(super) fn missing_in_middles(&self, exact: [DVec2; 5]) -> [DVec2; 5] {
        let [a, b, c, d] = self.values;
        let ([ax, bx, cx, dx], [ay, by, cy, dy]) = (self.across, self.down);
        let middle = |f: DVec2, g: DVec2, df: DVec2, dg: DVec2| 0.5 * (f + g) + 0.125 * (df - dg);
        let above = middle(a, b, ax, bx);
        let below = middle(c, d, cx, dx);
        let left = middle(a, c, ay, cy);
        let right = middle(b, d, by, dy);
        let centre = 0.5 * ((above + below) + (left + right)) - 0.25 * ((a + b) + (c + d));
        [
            exact[0] - above,
            exact[1] - below,
            exact[2] - left,
            exact[3] - right,
            exact[4] - centre,
        ]
    }

    /// A bound of what rounding adds to a stored offset: the sum of the sizes of a row's terms, each rounded a few times.
    pub(super) fn rounding(&self, bubbles: Option<&Bubbles>) -> f64 {
        let most = |all: &[DVec2]| {
            let largest = all.iter().fold(DVec2::ZERO, |most, v| most.max(v.abs()));
            largest.max_element()
        };
        let [a, b, c, d] = self.values;
        let rises = most(&[b - a, d - c, c - a, d - b]);
        let slopes = most(&self.across).max(most(&self.down));
        // Coefficients of a bubble add up to 64 times its height.
        let bubble = bubbles.map_or(0.0, |b| 64.0 * b.largest());
        8.0 * rounding(most(&self.values) + 5.0 * rises + 6.0 * slopes + bubble)
    }

    /// The bubbles that make good what is missing in the middles.
    pub(super) fn bubbles(missing: [DVec2; 5]) -> Bubbles {
        let [above, below, left, right, centre] = missing;
        Bubbles {
            edges: [above, below, left, right],
            middle: centre - 0.5 * ((above + below) + (left + right)),
        }
    }

    /// What is missing at exact values in the middles of the quarters.
    pub(super) fn missing_in_quarters(
        &self,
        bubbles: Option<&Bubbles>,
        exact: [DVec2; 4],
    ) -> [DVec2; 4] {
        let along = |share: &[f64; 4], f: DVec2, g: DVec2, df: DVec2, dg: DVec2| {
            (share[0] * f + share[1] * g) + (share[2] * df + share[3] * dg)
        };
        let [a, b, c, d] = self.values;
        let ([ax, bx, cx, dx], [ay, by, cy, dy]) = (self.across, self.down);
        let above = QUARTERS.each_ref().map(|q| along(q, a, b, ax, bx));
        let below = QUARTERS.each_ref().map(|q| along(q, c, d, cx, dx));
        let left = QUARTERS.each_ref().map(|q| along(q, a, c, ay, cy));
        let right = QUARTERS.each_ref().map(|q| along(q, b, d, by, dy));
        let mut missing = exact;
        for (number, missing) in missing.iter_mut().enumerate() {
            let (i, j) = (number % 2, number / 2);
            let (s, t) = (0.25 + 0.5 * i as f64, 0.25 + 0.5 * j as f64);
            let mix = |from: DVec2, to: DVec2, share: f64| from + (to - from) * share;
            let corners = mix(mix(a, b, s), mix(c, d, s), t);
            let mut value = mix(above[i], below[i], t) + mix(left[j], right[j], s) - corners;
            if let Some(Bubbles { edges, middle }) = bubbles {
                let [above, below, left, right] = *edges;
                let sum = mix(above, below, t) + mix(left, right, s) + QUARTER_BUBBLE * *middle;
                value += QUARTER_BUBBLE * sum;
            }
            *missing -= value;
        }
        missing
    }
}

/// The largest length; not a number where one of them is not.
pub(super) fn largest(all: &[DVec2]) -> f64 {
    let squared = all.iter().map(|v| v.length_squared());
    let most = squared.fold(0.0_f64, |most, size| {
        if size > most || size.is_nan() {
            size
        } else {
            most
        }
    });
    most.sqrt()
}

/// Displacements over a square cell: along a row, the polynomial in `s` whose coefficients are polynomials in `t`.
pub(super) struct Patch {
    constant: Cubic,
    linear: Cubic,
    square: [DVec2; 2],
    cube: [DVec2; 2],
    bubbles: Option<Bubbles>,
}

/// What is missing in the middles of the upper, lower, left and right edge, and, when that is made good, in the middle of the cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bubbles {
    pub(super) edges: [DVec2; 4],
    pub(super) middle: DVec2,
}

impl Bubbles {
    /// The largest of them.
    pub(super) fn largest(&self) -> f64 {
        let [a, b, c, d] = self.edges;
        largest(&[a, b, c, d, self.middle])
    }
}

/// `16 s² (1 − s)²`: 1 in the middle, 0 with its slope at both ends.
fn bubble(s: f64) -> f64 {
    let both = 4.0 * s * (1.0 - s);
    both * both
}

impl Patch {
    /// From a cell's corners, made to agree with its middles, too, where bubbles are given: quartic along the edges.
    pub(super) fn new(corners: &Corners, bubbles: Option<Bubbles>) -> Self {
        let [a, b, c, d] = corners.values;
        let ([ax, bx, cx, dx], [ay, by, cy, dy]) = (corners.across, corners.down);
        Self::of_edges(
            hermite(a, b, ax, bx),
            hermite(c, d, cx, dx),
            hermite(a, c, ay, cy),
            hermite(b, d, by, dy),
            bubbles,
        )
    }

    /// The bilinear interpolant of the corners.
    pub(super) fn bilinear([a, b, c, d]: [DVec2; 4]) -> Self {
        let line = |from: DVec2, to: DVec2| [from, to - from, DVec2::ZERO, DVec2::ZERO];
        Self::of_edges(line(a, b), line(c, d), line(a, c), line(b, d), None)
    }

    /// The patch of Coons between four curves. The straight line between the blended corners is in both blends, and taken away
    /// once.
    fn of_edges(
        above: Cubic,
        below: Cubic,
        left: Cubic,
        right: Cubic,
        bubbles: Option<Bubbles>,
    ) -> Self {
        let rise = |edge: &Cubic| edge[1] + edge[2] + edge[3];
        let twist = (below[1] - above[1]) + (right[1] - left[1]) - (rise(&below) - rise(&above));
        Self {
            constant: left,
            linear: [above[1], twist, right[2] - left[2], right[3] - left[3]],
            square: [above[2], below[2] - above[2]],
            cube: [above[3], below[3] - above[3]],
            bubbles,
        }
    }

    /// The quartic along the row at `t`; its last coefficient is 0 without bubbles.
    #[inline(always)]
    fn row(&self, t: f64) -> [DVec2; 5] {
        let cubic = |c: &Cubic| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        let mut c0 = cubic(&self.constant);
        let mut c1 = cubic(&self.linear);
        let mut c2 = self.square[0] + t * self.square[1];
        let mut c3 = self.cube[0] + t * self.cube[1];
        let Some(Bubbles { edges, middle }) = &self.bubbles else {
            return [c0, c1, c2, c3, DVec2::ZERO];
        };
        let [above, below, left, right] = *edges;
        let own = bubble(t);
        let across = 16.0 * (above + (below - above) * t + own * *middle);
        c0 += own * left;
        c1 += own * (right - left);
        c2 += across;
        c3 -= 2.0 * across;
        [c0, c1, c2, c3, across]
    }

    /// The displacement at `(s, t)` in the unit square.
    pub(super) fn value(&self, s: f64, t: f64) -> DVec2 {
        let [c0, c1, c2, c3, c4] = self.row(t);
        c0 + s * (c1 + s * (c2 + s * (c3 + s * c4)))
    }

    /// Writes the pixels of a cell of `size` pixels whose top left one is the first of `out`, as many columns and rows as
    /// are in the picture; `stride` pixels from row to row.
    pub(super) fn draw(&self, size: usize, columns: usize, out: &mut [[f32; 2]], stride: usize) {
        let mut steps = [[0.0_f32; LANES]; 8];
        for (i, step) in steps.as_flattened_mut().iter_mut().enumerate() {
            // Two numbers, across and down, for each pixel.
            *step = (i / 2) as f32 / size as f32;
        }
        let steps = &steps[..size / 4];
        dispatch!(Level::new(), v => self.rows(v, size, steps, columns, out, stride));
    }

    #[inline(always)]
    fn rows<V: Simd>(
        &self,
        v: V,
        size: usize,
        steps: &[[f32; LANES]],
        columns: usize,
        out: &mut [[f32; 2]],
        stride: usize,
    ) {
        for (row, line) in out.chunks_mut(stride).take(size).enumerate() {
            let quartic = self.row(row as f64 / size as f64);
            let [c0, c1, c2, c3, c4] = quartic.map(|c| {
                let (x, y) = (c.x as f32, c.y as f32);
                f32x8::simd_from(v, [x, y, x, y, x, y, x, y])
            });
            let line = line[..columns.min(size)].as_flattened_mut();
            let (blocks, rest) = line.as_chunks_mut::<LANES>();
            let value = |step: &[f32; LANES]| -> [f32; LANES] {
                let s = f32x8::simd_from(v, *step);
                (c0 + s * (c1 + s * (c2 + s * (c3 + s * c4)))).into()
            };
            let mut left = steps.iter();
            for (block, step) in blocks.iter_mut().zip(&mut left) {
                *block = value(step);
            }
            if !rest.is_empty()
                && let Some(step) = steps.get(blocks.len())
            {
                let last = value(step);
                rest.copy_from_slice(&last[..rest.len()]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn cubics_are_reproduced() {
        let f = |x: f64, y: f64| {
            dvec2(
                1.0 + x - 2.0 * y + x * y * 3.0 - x * x * y + 0.5 * y * y * y,
                x * x * x - y * x * x * x + 2.0 * x * y * y * y - y,
            )
        };
        let jacobian = |x: f64, y: f64| {
            DMat2::from_cols(
                dvec2(
                    1.0 + 3.0 * y - 2.0 * x * y,
                    3.0 * x * x - 3.0 * y * x * x + 2.0 * y * y * y,
                ),
                dvec2(
                    -2.0 + 3.0 * x - x * x + 1.5 * y * y,
                    -x * x * x + 6.0 * x * y * y - 1.0,
                ),
            )
        };
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let scale = 16.0;
        let of_corners = Corners::new(
            corners.map(|(x, y)| f(x, y)),
            corners.map(|(x, y)| jacobian(x, y) * (1.0 / scale)),
            16,
        );
        let middles = [(0.5, 0.0), (0.5, 1.0), (0.0, 0.5), (1.0, 0.5), (0.5, 0.5)];
        let quarters = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
        let missing = of_corners.missing_in_middles(middles.map(|(x, y)| f(x, y)));
        assert!(largest(&missing) < 1e-14);
        let missing = of_corners.missing_in_quarters(None, quarters.map(|(x, y)| f(x, y)));
        assert!(largest(&missing) < 1e-14);
        let patch = Patch::new(&of_corners, None);
        let rounding = of_corners.rounding(None);
        let mut out = vec![[0.0; 2]; 16 * 20];
        patch.draw(16, 13, &mut out[3..], 20);
        for row in 0..16 {
            for column in 0..13 {
                let (x, y) = (column as f64 / scale, row as f64 / scale);
                assert!(patch.value(x, y).distance(f(x, y)) < 1e-14);
                let [u, w] = out[3 + row * 20 + column];
                let drawn = dvec2(f64::from(u), f64::from(w));
                assert!(drawn.distance(f(x, y)) <= rounding);
            }
            assert_eq!(out[3 + row * 20 + 13], [0.0; 2]);
        }
        // Quartics along the edges, with the middles.
        let f = |x: f64, y: f64| f(x, y) + dvec2(x.powi(4) - y.powi(4) * x, 2.0 * x.powi(4) * y);
        let jacobian = |x: f64, y: f64| {
            jacobian(x, y)
                + DMat2::from_cols(
                    dvec2(4.0 * x.powi(3) - y.powi(4), 8.0 * x.powi(3) * y),
                    dvec2(-4.0 * y.powi(3) * x, 2.0 * x.powi(4)),
                )
        };
        let of_corners = Corners::new(
            corners.map(|(x, y)| f(x, y)),
            corners.map(|(x, y)| jacobian(x, y) * (1.0 / scale)),
            16,
        );
        let patch = Patch::new(&of_corners, None);
        assert!(patch.value(0.5, 0.0).distance(f(0.5, 0.0)) > 0.05);
        let exact = middles.map(|(x, y)| f(x, y));
        let missing = of_corners.missing_in_middles(exact);
        for ((x, y), missing) in middles.into_iter().zip(missing) {
            assert!((patch.value(x, y) + missing).distance(f(x, y)) < 1e-13);
        }
        let exact = quarters.map(|(x, y)| f(x, y));
        for ((x, y), missing) in quarters
            .into_iter()
            .zip(of_corners.missing_in_quarters(None, exact))
        {
            assert!((patch.value(x, y) + missing).distance(f(x, y)) < 1e-13);
        }
        let bubbles = Corners::bubbles(missing);
        let missing = of_corners.missing_in_quarters(Some(&bubbles), exact);
        assert!(largest(&missing) < 1e-13);
        let rounding = of_corners.rounding(Some(&bubbles));
        let patch = Patch::new(&of_corners, Some(bubbles));
        patch.draw(16, 16, &mut out, 20);
        for row in 0..16 {
            for column in 0..16 {
                let (x, y) = (column as f64 / scale, row as f64 / scale);
                assert!(patch.value(x, y).distance(f(x, y)) < 1e-13, "{x} {y}");
                let [u, w] = out[row * 20 + column];
                let drawn = dvec2(f64::from(u), f64::from(w));
                assert!(drawn.distance(f(x, y)) <= rounding);
            }
        }
        let line = Patch::bilinear(corners.map(|(x, y)| dvec2(x * y, x - y)));
        assert!(line.value(0.3, 0.6).distance(dvec2(0.18, -0.3)) < 1e-15);
    }
}
