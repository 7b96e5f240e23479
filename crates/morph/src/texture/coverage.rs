//! How far outlines cover pixels: the exact area, from the signed areas to the right of edges.
//!
//! *Source*: R. Levien, *How the font-rs rasterizer works*, 2016: each edge adds to the pixels of its rows what it covers, and sums along the rows
//! are the areas.

use anamorph_core::glam::DVec2;
use anamorph_raster::Window;

/// The share of each pixel of a window that outlines cover, 0 to 1, row by row. Outlines go around positively with x to the right and y downwards,
/// holes the other way; what is covered twice counts once.
pub fn coverage(rings: &[Vec<DVec2>], window: Window) -> Vec<f64> {
    let (width, height) = (window.width(), window.height());
    // A column more for what lies to the right.
    let mut sums = Sums {
        line: width + 1,
        width: width as f64,
        height: height as f64,
        values: vec![0.0; (width + 1) * height],
    };
    let corner = window.corner();
    for ring in rings
        .iter()
        .filter(|ring| ring.iter().all(|p| p.is_finite()))
    {
        for (i, from) in ring.iter().enumerate() {
            let to = ring[(i + 1) % ring.len()];
            sums.edge(*from - corner, to - corner);
        }
    }
    let mut covered = Vec::with_capacity(width * height);
    for row in sums.values.chunks_exact(width + 1) {
        let mut sum = 0.0;
        for value in &row[..width] {
            sum += value;
            // What rounding leaves is not seen, and pixels inside are covered exactly.
            let share = sum.clamp(0.0, 1.0);
            covered.push(if share < 1e-9 {
                0.0
            } else if share > 1.0 - 1e-9 {
                1.0
            } else {
                share
            });
        }
    }
    covered
}

struct Sums {
    line: usize,
    width: f64,
    height: f64,
    values: Vec<f64>,
}

impl Sums {
    /// Adds an edge, cut where it leaves the window to the left or right.
    fn edge(&mut self, from: DVec2, to: DVec2) {
        if from.y == to.y {
            return;
        }
        // Positive where what is covered lies to the right: edges that go up.
        let (sign, top, bottom) = if from.y < to.y {
            (-1.0, from, to)
        } else {
            (1.0, to, from)
        };
        let slope = (bottom.x - top.x) / (bottom.y - top.y);
        let at = |y: f64| {
            let x = top.x + (y - top.y) * slope;
            x.clamp(top.x.min(bottom.x), top.x.max(bottom.x))
        };
        let (low, high) = (top.y.max(0.0), bottom.y.min(self.height));
        if low >= high {
            return;
        }
        let mut cuts = [low, high, high, high];
        let mut count = 1;
        for border in [0.0, self.width] {
            let y = top.y + (border - top.x) / slope;
            if y > low && y < high {
                cuts[count] = y;
                count += 1;
            }
        }
        cuts[count] = high;
        cuts[..=count].sort_by(f64::total_cmp);
        for ends in cuts[..=count].windows(2) {
            self.piece(ends[0], ends[1], &at, sign);
        }
    }

    /// Adds what an edge covers between two heights, between which it does not cross the sides of the window.
    fn piece(&mut self, low: f64, high: f64, at: &impl Fn(f64) -> f64, sign: f64) {
        let mut y = low;
        while y < high {
            let row = y.floor();
            let next = (row + 1.0).min(high);
            let (a, b) = (
                at(y).clamp(0.0, self.width),
                at(next).clamp(0.0, self.width),
            );
            let line = row as usize * self.line;
            self.cell_row(line, a.min(b), a.max(b), (next - y) * sign);
            y = next;
        }
    }

    /// Adds an edge within a row that goes from `left` to `right` over a height.
    fn cell_row(&mut self, line: usize, left: f64, right: f64, height: f64) {
        let first = left.floor() as usize;
        if first + 1 >= self.line {
            return;
        }
        let (mut before, slope) = (0.0, right - left);
        let mut column = first;
        loop {
            // The area to the right of the edge in this column and those before, less what these had.
            let border = (column + 1) as f64;
            let area = if slope > 0.0 {
                // How much of the height the edge has passed at both sides of the column.
                let passed = |x: f64| ((x - left) / slope).clamp(0.0, 1.0);
                let (start, end) = (passed(column as f64), passed(border));
                let from = (column as f64).max(left);
                let to = border.min(right);
                // Full where the edge lies further left; under the edge the mean.
                start + (end - start) * (border - 0.5 * (from + to))
            } else {
                border - left
            };
            let share = if right <= column as f64 { 1.0 } else { area };
            self.values[line + column] += (share - before) * height;
            before = share;
            column += 1;
            if share >= 1.0 || column + 1 >= self.line {
                break;
            }
        }
    }
}
