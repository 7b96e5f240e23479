//! The elastic system of a snake: `(M + K) u = M f`, pentadiagonal, cyclic for closed curves.
//!
//! `M` is the length that belongs to each point, `K` the stiffness of `α|u′|² + β|u″|²` by differences on points that need not be evenly
//! spaced. The matrix is symmetric and positive definite. Its last two rows and columns, which hold what joins the ends of a
//! closed curve, are eliminated first; the rest is factored as `L D Lᵀ` along its band.
//!
//! *Source*: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th edition, 2013, §4.1.2 and §4.3 (banded `L D Lᵀ`), §3.2.11 (block
//! elimination); the system is that of Kass, Witkin and Terzopoulos 1988, appendix A.

use anamorph_core::glam::{DVec2, dvec2};

/// Lengths below this share of the mean count as this much: points in one place would be joined by infinite stiffness.
const SHORTEST: f64 = 1e-3;

/// The factored system.
pub(super) struct Stiffness {
    mass: Vec<f64>,
    /// Of the band: `1/D`, and the entries of `L` one and two below the diagonal.
    pivots: Vec<f64>,
    lower: Vec<[f64; 2]>,
    /// Solutions of the band for its two columns in the border.
    border: Vec<DVec2>,
    /// Inverse of what is left of the border, row by row.
    corner: [[f64; 2]; 2],
}

/// Rows of a symmetric cyclic matrix: the diagonal, and the entries one and two to the right.
struct Rows(Vec<[f64; 3]>);

impl Rows {
    fn add(&mut self, i: usize, j: usize, value: f64) {
        let count = self.0.len();
        let ahead = (j + count - i) % count;
        match ahead {
            0..=2 => self.0[i][ahead] += value,
            _ => self.0[j][(count - ahead).min(2)] += value,
        }
    }
    /// Adds `weight` times the square of a combination of unknowns; those of `held` are 0.
    fn square(&mut self, parts: &[(usize, f64)], weight: f64, held: impl Fn(usize) -> bool) {
        for (n, &(i, a)) in parts.iter().enumerate() {
            for &(j, b) in &parts[n..] {
                if !held(i) && !held(j) {
                    self.add(i, j, weight * a * b);
                }
            }
        }
    }
}

impl Stiffness {
    /// For points with the given lengths from each to the next, at least six points. `fixed`: the first and the last do not move.
    pub(super) fn new(lengths: &[f64], closed: bool, fixed: bool, alpha: f64, beta: f64) -> Self {
        let count = if closed {
            lengths.len()
        } else {
            lengths.len() + 1
        };
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let lengths: Vec<f64> = lengths.iter().map(|l| l.max(SHORTEST * mean)).collect();
        let mut mass = vec![0.0; count];
        let mut rows = Rows(vec![[0.0; 3]; count]);
        let held = |i: usize| fixed && (i == 0 || i + 1 == count);
        for (i, &h) in lengths.iter().enumerate() {
            let next = (i + 1) % count;
            mass[i] += 0.5 * h;
            mass[next] += 0.5 * h;
            rows.square(&[(i, -1.0), (next, 1.0)], alpha / h, held);
            let after = (i + 2) % count;
            let following = if closed {
                Some(lengths[next])
            } else {
                lengths.get(i + 1).copied()
            };
            if let Some(g) = following {
                // The second derivative at `next`, over the length that belongs to it.
                let own = 0.5 * (h + g);
                let parts = [
                    (i, 1.0 / (h * own)),
                    (next, -1.0 / (h * own) - 1.0 / (g * own)),
                    (after, 1.0 / (g * own)),
                ];
                rows.square(&parts, beta * own, held);
            }
        }
        for (i, &m) in mass.iter().enumerate() {
            rows.0[i][0] += m;
        }
        Self::factored(&rows, mass, held)
    }

    fn factored(rows: &Rows, mut mass: Vec<f64>, held: impl Fn(usize) -> bool) -> Self {
        let count = mass.len();
        // Points that are held have rows of their own, and no force.
        for (i, mass) in mass.iter_mut().enumerate() {
            if held(i) {
                *mass = 0.0;
            }
        }
        let band = count - 2;
        let entry = |i: usize, ahead: usize| {
            if i + ahead < band {
                rows.0[i][ahead]
            } else {
                0.0
            }
        };
        let (mut pivots, mut lower) = (vec![0.0; band], vec![[0.0; 2]; band]);
        let mut diagonal = vec![0.0; band];
        for i in 0..band {
            let mut d = rows.0[i][0];
            let mut one = entry(i, 1);
            if let Some(before) = i.checked_sub(1) {
                let [l, m] = lower[before];
                d -= l * l * diagonal[before];
                one -= l * m * diagonal[before];
            }
            if let Some(before) = i.checked_sub(2) {
                d -= lower[before][1] * lower[before][1] * diagonal[before];
            }
            diagonal[i] = d;
            pivots[i] = 1.0 / d;
            lower[i] = [one / d, entry(i, 2) / d];
        }
        let mut system = Self {
            mass,
            pivots,
            lower,
            border: Vec::new(),
            corner: [[0.0; 2]; 2],
        };
        // The two columns of the border above their own rows: `x` of the last but one, `y` of the last.
        let (p, q) = (band, band + 1);
        let mut columns = vec![DVec2::ZERO; band];
        columns[band - 1].x += rows.0[band - 1][1];
        columns[band - 2].x += rows.0[band - 2][2];
        columns[band - 1].y += rows.0[band - 1][2];
        columns[0].x += rows.0[p][2];
        columns[0].y += rows.0[q][1];
        columns[1].y += rows.0[q][2];
        let mut border = columns.clone();
        system.solve_band(&mut border);
        let mut rest = [[rows.0[p][0], rows.0[p][1]], [rows.0[p][1], rows.0[q][0]]];
        for (column, solved) in columns.iter().zip(&border) {
            rest[0][0] -= column.x * solved.x;
            rest[0][1] -= column.x * solved.y;
            rest[1][0] -= column.y * solved.x;
            rest[1][1] -= column.y * solved.y;
        }
        let determinant = rest[0][0] * rest[1][1] - rest[0][1] * rest[1][0];
        system.border = border;
        system.corner = [
            [rest[1][1] / determinant, -rest[0][1] / determinant],
            [-rest[1][0] / determinant, rest[0][0] / determinant],
        ];
        system
    }

    fn solve_band(&self, right: &mut [DVec2]) {
        let count = self.pivots.len();
        for i in 0..count {
            let mut sum = right[i];
            if let Some(before) = i.checked_sub(1) {
                sum -= right[before] * self.lower[before][0];
            }
            if let Some(before) = i.checked_sub(2) {
                sum -= right[before] * self.lower[before][1];
            }
            right[i] = sum;
        }
        for (x, pivot) in right.iter_mut().zip(&self.pivots) {
            *x *= *pivot;
        }
        for i in (0..count).rev() {
            let mut sum = right[i];
            for (after, l) in (i + 1..count).zip(self.lower[i]) {
                sum -= right[after] * l;
            }
            right[i] = sum;
        }
    }

    /// Replaces `f` by `u`; both coordinates at once.
    pub(super) fn solve(&self, values: &mut [DVec2]) {
        for (value, mass) in values.iter_mut().zip(&self.mass) {
            *value *= *mass;
        }
        let (band, ends) = values.split_at_mut(self.pivots.len());
        // Against the border's solved columns: it is symmetric.
        let (mut p, mut q) = (ends[0], ends[1]);
        for (value, border) in band.iter().zip(&self.border) {
            p -= *value * border.x;
            q -= *value * border.y;
        }
        let [a, b] = self.corner;
        let (u, v) = (p * a[0] + q * a[1], p * b[0] + q * b[1]);
        self.solve_band(band);
        for (value, border) in band.iter_mut().zip(&self.border) {
            *value -= dvec2(
                border.x * u.x + border.y * v.x,
                border.x * u.y + border.y * v.y,
            );
        }
        (ends[0], ends[1]) = (u, v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(M + K) u` from the energy, term by term.
    fn product(
        lengths: &[f64],
        closed: bool,
        alpha: f64,
        beta: f64,
        u: &[DVec2],
    ) -> (Vec<DVec2>, Vec<f64>) {
        let count = u.len();
        let (mut out, mut mass) = (vec![DVec2::ZERO; count], vec![0.0; count]);
        for (i, h) in lengths.iter().enumerate() {
            let next = (i + 1) % count;
            mass[i] += h / 2.0;
            mass[next] += h / 2.0;
            let slope = (u[next] - u[i]) / h;
            out[next] += slope * alpha;
            out[i] -= slope * alpha;
            let following = i + 1;
            if !closed && following >= lengths.len() {
                continue;
            }
            let g = lengths[following % lengths.len()];
            let (after, own) = ((i + 2) % count, (h + g) / 2.0);
            let bend = ((u[after] - u[next]) / g - slope) / own;
            let moment = bend * beta;
            out[after] += moment / g;
            out[next] -= moment / g + moment / *h;
            out[i] += moment / *h;
        }
        for ((out, u), mass) in out.iter_mut().zip(u).zip(&mass) {
            *out += *u * *mass;
        }
        (out, mass)
    }

    #[test]
    fn solutions_fulfil_the_system() {
        for count in [8_usize, 9, 31] {
            for closed in [false, true] {
                let pieces = if closed { count } else { count - 1 };
                let lengths: Vec<f64> = (0..pieces)
                    .map(|i| 0.6 + ((i * 7) % 5) as f64 * 0.1)
                    .collect();
                let u: Vec<DVec2> = (0..count)
                    .map(|i| dvec2(((i * i) % 11) as f64 - 5.0, ((3 * i) % 7) as f64))
                    .collect();
                for (alpha, beta) in [(0.0, 0.0), (1.5, 0.0), (0.3, 4.0), (100.0, 1e4)] {
                    let (right, mass) = product(&lengths, closed, alpha, beta, &u);
                    let mut f: Vec<DVec2> = right.iter().zip(&mass).map(|(r, m)| *r / *m).collect();
                    Stiffness::new(&lengths, closed, false, alpha, beta).solve(&mut f);
                    for (found, known) in f.iter().zip(&u) {
                        assert!(
                            found.distance(*known) < 1e-8,
                            "{count} {closed} {alpha} {beta}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn fixed_ends_stay_and_their_neighbours_follow() {
        let lengths = [1.0; 11];
        let mut f = vec![dvec2(1.0, -2.0); 12];
        Stiffness::new(&lengths, false, true, 4.0, 0.0).solve(&mut f);
        assert_eq!((f[0], f[11]), (DVec2::ZERO, DVec2::ZERO));
        assert!(f[1].x > 0.0 && f[1].x < f[2].x && f[5].x < 1.0 && f[5].x > f[4].x);
        assert!(f.iter().all(|u| (u.y + 2.0 * u.x).abs() < 1e-12));
    }
}
