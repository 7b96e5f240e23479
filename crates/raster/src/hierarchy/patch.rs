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

fn at(cubic: &Cubic, s: f64) -> DVec2 {
    cubic[0] + s * (cubic[1] + s * (cubic[2] + s * cubic[3]))
}

/// Displacements over a square cell.
pub(super) struct Patch {
    above: Cubic,
    below: Cubic,
    left: Cubic,
    right: Cubic,
    bubbles: Option<Bubbles>,
}

/// What is missing in the middles of the upper, lower, left and right edge, and, when that is made good, in the middle of the cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bubbles {
    pub(super) edges: [DVec2; 4],
    pub(super) middle: DVec2,
}

/// `16 s² (1 − s)²`: 1 in the middle, 0 with its slope at both ends.
fn bubble(s: f64) -> f64 {
    let both = 4.0 * s * (1.0 - s);
    both * both
}

impl Patch {
    /// From the corners (above left, above right, below left, below right) with their Jacobians, for a cell of `size` pixels.
    pub(super) fn new(values: [DVec2; 4], jacobians: [DMat2; 4], size: usize) -> Self {
        let h = size as f64;
        let [a, b, c, d] = values;
        let [ja, jb, jc, jd] = jacobians;
        Self {
            above: hermite(a, b, ja.x_axis * h, jb.x_axis * h),
            below: hermite(c, d, jc.x_axis * h, jd.x_axis * h),
            left: hermite(a, c, ja.y_axis * h, jc.y_axis * h),
            right: hermite(b, d, jb.y_axis * h, jd.y_axis * h),
            bubbles: None,
        }
    }

    /// The same made to agree with values in the middles of the edges and of the cell, too: quartic along the edges.
    pub(super) fn with_middles(mut self, edges: [DVec2; 4], middle: DVec2) -> Self {
        let places = [(0.5, 0.0), (0.5, 1.0), (0.0, 0.5), (1.0, 0.5)];
        let mut missing = edges;
        for (missing, (s, t)) in missing.iter_mut().zip(places) {
            *missing -= self.value(s, t);
        }
        let [above, below, left, right] = missing;
        let filled = self.value(0.5, 0.5) + 0.5 * ((above + below) + (left + right));
        self.bubbles = Some(Bubbles {
            edges: missing,
            middle: middle - filled,
        });
        self
    }

    /// The largest of what was missing in the middles.
    pub(super) fn largest_bubble(&self) -> f64 {
        let Some(bubbles) = &self.bubbles else {
            return 0.0;
        };
        let all = bubbles.edges.iter().chain([&bubbles.middle]);
        // Not a number where one of them is not.
        all.map(|missing| missing.length()).fold(0.0, |most, size| {
            if size > most || size.is_nan() {
                size
            } else {
                most
            }
        })
    }

    /// The bilinear interpolant of the corners.
    pub(super) fn bilinear([a, b, c, d]: [DVec2; 4]) -> Self {
        let line = |from: DVec2, to: DVec2| [from, to - from, DVec2::ZERO, DVec2::ZERO];
        Self {
            above: line(a, b),
            below: line(c, d),
            left: line(a, c),
            right: line(b, d),
            bubbles: None,
        }
    }

    /// The quartic along the row at `t`; its last coefficient is 0 without bubbles.
    fn row(&self, t: f64) -> [DVec2; 5] {
        let [mut c0, mut c1, mut c2, mut c3] = self.cubic(t);
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

    /// The cubic along the row at `t`, without bubbles.
    fn cubic(&self, t: f64) -> Cubic {
        let mix = |i: usize| self.above[i] + (self.below[i] - self.above[i]) * t;
        let (left, right) = (at(&self.left, t), at(&self.right, t));
        // The straight line between the blended corners is in both blends, and taken away once.
        let rise = |edge: &Cubic| edge[1] + edge[2] + edge[3];
        let (above, below) = (rise(&self.above), rise(&self.below));
        let corners = above + (below - above) * t;
        [left, mix(1) + (right - left) - corners, mix(2), mix(3)]
    }

    /// The displacement at `(s, t)` in the unit square.
    pub(super) fn value(&self, s: f64, t: f64) -> DVec2 {
        let [c0, c1, c2, c3, c4] = self.row(t);
        c0 + s * (c1 + s * (c2 + s * (c3 + s * c4)))
    }

    /// A bound of what rounding adds to a stored offset: the sum of the terms' sizes, each rounded a few times.
    pub(super) fn rounding(&self) -> f64 {
        let size = |cubic: &Cubic| cubic.iter().fold(0.0, |sum, c| sum + c.abs().max_element());
        let edges = [&self.above, &self.below, &self.left, &self.right];
        // Coefficients of a bubble add up to 64 times its height.
        let bubbles = 64.0 * self.largest_bubble();
        8.0 * rounding(edges.into_iter().map(size).fold(0.0, f64::max) + bubbles)
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
        let patch = Patch::new(
            corners.map(|(x, y)| f(x, y)),
            corners.map(|(x, y)| jacobian(x, y) * (1.0 / scale)),
            16,
        );
        let mut out = vec![[0.0; 2]; 16 * 20];
        patch.draw(16, 13, &mut out[3..], 20);
        for row in 0..16 {
            for column in 0..13 {
                let (x, y) = (column as f64 / scale, row as f64 / scale);
                assert!(patch.value(x, y).distance(f(x, y)) < 1e-14);
                let [u, w] = out[3 + row * 20 + column];
                let drawn = dvec2(f64::from(u), f64::from(w));
                assert!(drawn.distance(f(x, y)) <= patch.rounding() * 1.5);
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
        let patch = Patch::new(
            corners.map(|(x, y)| f(x, y)),
            corners.map(|(x, y)| jacobian(x, y) * (1.0 / scale)),
            16,
        );
        assert!(patch.value(0.5, 0.0).distance(f(0.5, 0.0)) > 0.05);
        let edges = [(0.5, 0.0), (0.5, 1.0), (0.0, 0.5), (1.0, 0.5)].map(|(x, y)| f(x, y));
        let patch = patch.with_middles(edges, f(0.5, 0.5));
        patch.draw(16, 16, &mut out, 20);
        for row in 0..16 {
            for column in 0..16 {
                let (x, y) = (column as f64 / scale, row as f64 / scale);
                assert!(patch.value(x, y).distance(f(x, y)) < 1e-13, "{x} {y}");
                let [u, w] = out[row * 20 + column];
                let drawn = dvec2(f64::from(u), f64::from(w));
                assert!(drawn.distance(f(x, y)) <= patch.rounding() * 1.5);
            }
        }
        let line = Patch::bilinear(corners.map(|(x, y)| dvec2(x * y, x - y)));
        assert!(line.value(0.3, 0.6).distance(dvec2(0.18, -0.3)) < 1e-15);
    }
}
