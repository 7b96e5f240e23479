//! The linear map that carries a vertex's fan of edges to its target fan.
//!
//! With edges as rows `E` and `E*`, `A = R̂ + Σ_k f(σ_k/σ₁)/σ_k · v_k u_kᵀ (E* − E R̂)`: singular triples of `E`, `R̂` the best rotation (of
//! determinant +1) of `EᵀE*` times `‖E*‖/‖E‖`, `f` a smoothstep from 0 to 1 on [0, 0.1]. Where `σ₃ ≥ 0.1 σ₁` this is the least-squares map
//! `E⁺E*` of the paper; a flat fan, whose pseudo-inverse would flatten everything, is turned and scaled instead.
//!
//! *Source*: Milliron et al. 2002, §6; errata F11 (`A` acts on rows: its transpose on points), F12 (about the vertex), F13. The best
//! rotation is W. Kabsch's (*A solution for the best rotation to relate two sets of vectors*, Acta Crystallographica A32, 1976); eigenvectors
//! by Jacobi's method.

use anamorph_core::{Linear, Space, math};
use anamorph_transforms::Rotational;

/// Below this share of the largest singular value a direction of the source counts for less than fully.
const THIN: f64 = 0.1;
/// A source fan whose second singular value is below this share of the first tells no rotation.
const LINE: f64 = 1e-3;
/// Singular values of `EᵀE*` below this share of the first, or closer, tell no rotation.
const VAGUE: f64 = 1e-9;

/// Eigenvalues, the largest first, and unit eigenvectors of a symmetric matrix.
fn eigen<S: Space>(matrix: &S::Linear) -> ([f64; 3], [S; 3]) {
    let mut a = [[0.0_f64; 3]; 3];
    let mut v = [S::ZERO; 3];
    for (row, entries) in a.iter_mut().enumerate().take(S::DIM) {
        for (column, entry) in entries.iter_mut().enumerate().take(S::DIM) {
            *entry = 0.5 * (matrix.entry(row, column) + matrix.entry(column, row));
        }
        v[row] = S::unit(row);
    }
    let size: f64 = a.iter().flatten().fold(0.0, |m, e| m.max(e.abs()));
    // Cyclic sweeps converge quadratically: six or seven are the most ever needed.
    for _ in 0..32 {
        let mut off = 0.0_f64;
        for p in 0..S::DIM {
            for q in p + 1..S::DIM {
                off = off.max(a[p][q].abs());
                if a[p][q].abs() <= 1e-300 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let t = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (above, below) = a.split_at_mut(q);
                for (x, y) in above[p].iter_mut().zip(&mut below[0]) {
                    (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                }
                (v[p], v[q]) = (v[p] * c - v[q] * s, v[p] * s + v[q] * c);
            }
        }
        if off <= 1e-17 * size {
            break;
        }
    }
    let mut order = [0, 1, 2];
    order[..S::DIM].sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
    (order.map(|i| a[i][i].max(0.0)), order.map(|i| v[i]))
}

/// The rotation `Q` of determinant +1 for which `Σ‖Q e − e*‖²` is least, if it is unique.
fn best_rotation<S: Rotational>(edges: &[(S, S)]) -> Option<S::Linear> {
    if S::DIM == 2 {
        // The angle of Σ e* conj(e).
        let (mut along, mut across) = (0.0, 0.0);
        let mut size = 0.0;
        for (e, t) in edges {
            along += e.dot(*t);
            across += e.component(0) * t.component(1) - e.component(1) * t.component(0);
            size += e.length() * t.length();
        }
        let angle = math::atan2(across, along);
        let clear = (along * along + across * across).sqrt() > VAGUE * size;
        return clear.then(|| S::rotation(S::ZERO, angle));
    }
    let mut source = S::Linear::ZERO;
    let mut both = S::Linear::ZERO;
    for (e, t) in edges {
        source = source + S::Linear::outer(*e, *e);
        both = both + S::Linear::outer(*t, *e);
    }
    let (spread, _) = eigen::<S>(&source);
    // Singular values are roots of these.
    if spread[1] <= LINE * LINE * spread[0] {
        return None;
    }
    let (values, right) = eigen::<S>(&both.transposed().after(&both));
    let values = values.map(f64::sqrt);
    let turned_over = both.determinant() < 0.0;
    let gap = if turned_over {
        values[1] - values[2]
    } else {
        values[1]
    };
    if gap <= VAGUE * values[0] {
        return None;
    }
    let left = [
        both.apply(right[0]).normalized()?,
        both.apply(right[1]).normalized()?,
    ];
    let left_last = third::<S>(left[0], left[1])?;
    let right_last = third::<S>(right[0], right[1])?;
    Some(
        S::Linear::outer(left[0], right[0])
            + S::Linear::outer(left[1], right[1])
            + S::Linear::outer(left_last, right_last),
    )
}

/// The unit vector that makes a right-handed frame of two perpendicular ones in space.
fn third<S: Space>(a: S, b: S) -> Option<S> {
    let at = |v: S, i: usize| v.component(i % 3);
    S::from_fn(|i| at(a, i + 1) * at(b, i + 2) - at(a, i + 2) * at(b, i + 1)).normalized()
}

/// Whether a fan's own edges were enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Told {
    /// They were, or those of rings around it.
    Rotation,
    /// The whole component lies on a line: the smallest rotation was taken.
    Line,
}

/// The map of a fan `edges` (source and target vectors), which acts on vectors from the vertex. `more(ring)` gives the edges of so many
/// more rings around, the fan's own included, and `None` when there are no more.
pub(super) fn fan<S: Rotational>(
    edges: &[(S, S)],
    mut more: impl FnMut(usize) -> Option<Vec<(S, S)>>,
) -> (S::Linear, Told) {
    let length = |side: fn(&(S, S)) -> S| {
        let squares = edges.iter().map(|e| side(e).dot(side(e)));
        squares.sum::<f64>().sqrt()
    };
    let (source, target) = (length(|e| e.0), length(|e| e.1));
    if source == 0.0 {
        return (S::Linear::IDENTITY, Told::Rotation);
    }
    let mut told = Told::Rotation;
    let mut rotation = best_rotation(edges);
    if rotation.is_some() && edges.iter().all(|(e, t)| e == t) {
        // To the last bit, so that what nobody edited moves nothing.
        return (S::Linear::IDENTITY, told);
    }
    let mut ring = 1;
    while rotation.is_none() {
        match more(ring) {
            Some(edges) => rotation = best_rotation(&edges),
            None => break,
        }
        ring += 1;
    }
    let rotation = rotation.unwrap_or_else(|| {
        told = Told::Line;
        let (from, to) = longest(edges);
        S::turn_between(from, to).map_or(S::Linear::IDENTITY, |turn| turn.matrix(1.0))
    });
    let similar = rotation * (target / source);
    // Scaled, so that squares neither overflow nor vanish.
    let per = 1.0 / source;
    let mut spread = S::Linear::ZERO;
    let mut rest = S::Linear::ZERO;
    for (e, t) in edges {
        let e = *e * per;
        let left = *t * per - similar.apply(e);
        spread = spread + S::Linear::outer(e, e);
        rest = rest + S::Linear::outer(left, e);
    }
    let (squares, directions) = eigen::<S>(&spread);
    let mut map = similar;
    for (square, direction) in squares.iter().zip(directions).take(S::DIM) {
        // f(x)/σ², x = σ/(0.1 σ₁): 3 − 2x times 1/(0.1 σ₁)² where f is not yet 1.
        let x = (square / squares[0]).sqrt() / THIN;
        let factor = if x >= 1.0 {
            1.0 / square
        } else {
            (3.0 - 2.0 * x) / (THIN * THIN * squares[0])
        };
        map = map + S::Linear::outer(rest.apply(direction), direction) * factor;
    }
    (map, told)
}

/// The longest edge, with its target.
fn longest<S: Space>(edges: &[(S, S)]) -> (S, S) {
    let by_length = |a: &&(S, S), b: &&(S, S)| a.0.length().total_cmp(&b.0.length());
    let found = edges.iter().max_by(by_length);
    found.copied().unwrap_or((S::ZERO, S::ZERO))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::Solid;
    use anamorph_core::glam::{DMat3, dvec2, dvec3};

    fn none(_: usize) -> Option<Vec<(Solid, Solid)>> {
        None
    }

    fn turn() -> DMat3 {
        DMat3::from_axis_angle(dvec3(1.0, 2.0, -0.5).normalize(), 2.2)
    }

    #[test]
    fn a_full_fan_gets_the_least_squares_map() {
        let map = DMat3::from_cols(
            dvec3(2.0, 0.1, 0.0),
            dvec3(-0.4, 1.0, 0.3),
            dvec3(0.2, 0.5, 0.7),
        );
        let edges: Vec<(Solid, Solid)> = [Solid::X, Solid::Y, Solid::Z, dvec3(1.0, 1.0, -1.0)]
            .into_iter()
            .map(|e| (e, map * e))
            .collect();
        let (found, told) = fan(&edges, none);
        assert_eq!(told, Told::Rotation);
        for i in 0..3 {
            assert!((found.col(i) - map.col(i)).length() < 1e-12);
        }
    }

    #[test]
    fn a_fan_that_stays_has_the_identity_to_the_last_bit() {
        let edges = [
            dvec3(0.3, 0.1, 0.7),
            dvec3(-0.6, 0.2, 0.1),
            dvec3(0.1, -0.9, 0.4),
        ];
        let stays: Vec<_> = edges.iter().map(|&e| (e, e)).collect();
        assert_eq!(fan(&stays, none), (DMat3::IDENTITY, Told::Rotation));
        // A fan along a line turns with the rings around it.
        let line = [(Solid::X, Solid::X), (-Solid::X, -Solid::X)];
        let turned = |_| Some(edges.iter().map(|&e| (e, turn() * e)).collect());
        let (found, _) = fan(&line, turned);
        assert!(found != DMat3::IDENTITY);
    }

    #[test]
    fn similarities_of_flat_fans_are_exact_and_the_stretch_of_nearly_flat_ones_is_bounded() {
        let flat = [
            Solid::X,
            Solid::Y,
            dvec3(-1.0, 0.5, 0.0),
            dvec3(0.2, -1.0, 0.0),
        ];
        for scale in [1.0, 3.0] {
            let edges: Vec<_> = flat.iter().map(|&e| (e, turn() * e * scale)).collect();
            let (found, _) = fan(&edges, none);
            for i in 0..3 {
                assert!(
                    (found.col(i) - turn().col(i) * scale).length() < 1e-12,
                    "{scale}"
                );
            }
        }
        for height in [1e-12, 1e-6, 1e-3] {
            let bump = |e: Solid, h: f64| dvec3(e.x, e.y, h);
            let edges: Vec<_> = flat
                .iter()
                .enumerate()
                .map(|(i, &e)| (bump(e, height * i as f64), bump(e, 0.2)))
                .collect();
            let (found, _) = fan(&edges, none);
            assert!(found.col(2).length() < 20.0, "{height} {found}");
        }
    }

    #[test]
    fn a_line_asks_its_rings_and_else_takes_the_smallest_turn() {
        let edges = [
            (Solid::X, Solid::Y * 2.0),
            (Solid::X * -2.0, Solid::Y * -4.0),
        ];
        let (found, told) = fan(&edges, none);
        assert_eq!(told, Told::Line);
        assert!((found * Solid::X - Solid::Y * 2.0).length() < 1e-12);
        assert!((found * Solid::Z - Solid::Z * 2.0).length() < 1e-12);
        // A ring around it says how it is turned about itself.
        let quarter = DMat3::from_cols(Solid::Y, Solid::Z, Solid::X);
        let rings = |ring: usize| {
            (ring < 3).then(|| {
                vec![
                    (Solid::X, quarter * Solid::X),
                    (Solid::Z, quarter * Solid::Z),
                ]
            })
        };
        let (found, told) = fan(&edges, rings);
        assert_eq!(told, Told::Rotation);
        assert!((found * Solid::Z - quarter * Solid::Z * 2.0).length() < 1e-12);
    }

    #[test]
    fn the_plane_needs_one_edge() {
        let edges = [(dvec2(1.0, 0.0), dvec2(0.0, 3.0))];
        let (found, told) = fan(&edges, |_| None);
        assert_eq!(told, Told::Rotation);
        assert!((found * dvec2(0.0, 1.0) - dvec2(-3.0, 0.0)).length() < 1e-12);
    }
}
