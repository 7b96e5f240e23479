//! Rotations of elements, unwound: how far each has turned, not only up to whole turns.
//!
//! Angles are known up to whole turns. Those of neighbours are taken to differ by less than half a turn, along a tree of the smallest
//! differences over the dual graph, so that a spiral of one and a half turns uncurls. About a hole the differences may not add up; the
//! neighbours at which they do not are reported, and the tree's choice stands, which breaks where neighbours differ most.
//!
//! *Source*: decision, errata S12; J. B. Kruskal, *On the shortest spanning subtree of a graph*, 1956.

use super::pair::root;
use super::tensor::shorter;

/// Adds whole turns to the angles of elements; returns the pairs of neighbours that stay more than half a turn apart.
///
/// `neighbours` share an edge. `hinges` share only a vertex, and count where nothing else connects.
pub(crate) fn unwind(
    angles: &mut [f64],
    neighbours: &[(usize, usize)],
    hinges: &[(usize, usize)],
) -> Vec<(usize, usize)> {
    let mut above: Vec<usize> = (0..angles.len()).collect();
    let mut tree: Vec<(usize, usize)> = Vec::with_capacity(2 * angles.len());
    for list in [neighbours, hinges] {
        let mut sorted: Vec<(f64, usize, usize)> = list
            .iter()
            .map(|&(a, b)| (shorter(angles[a] - angles[b]).abs(), a, b))
            .collect();
        sorted.sort_unstable_by(|x, y| {
            x.0.total_cmp(&y.0)
                .then_with(|| (x.1, x.2).cmp(&(y.1, y.2)))
        });
        for (_, a, b) in sorted {
            let (from, to) = (root(&mut above, a), root(&mut above, b));
            if from != to {
                above[from.max(to)] = from.min(to);
                tree.push((a, b));
                tree.push((b, a));
            }
        }
    }
    tree.sort_unstable();
    let first = |element: usize| tree.partition_point(|&(from, _)| from < element);
    let mut done = vec![false; angles.len()];
    let mut waiting = Vec::new();
    for start in 0..angles.len() {
        if done[start] {
            continue;
        }
        done[start] = true;
        waiting.push(start);
        while let Some(element) = waiting.pop() {
            let from = first(element);
            for &(_, next) in tree[from..].iter().take_while(|edge| edge.0 == element) {
                if !done[next] {
                    done[next] = true;
                    angles[next] = angles[element] + shorter(angles[next] - angles[element]);
                    waiting.push(next);
                }
            }
        }
    }
    let apart =
        |&&(a, b): &&(usize, usize)| (angles[a] - angles[b]).abs() > std::f64::consts::PI + 1e-9;
    neighbours.iter().filter(apart).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_chain_of_angles_is_unwound_and_a_ring_that_does_not_close_is_reported() {
        let whole: Vec<f64> = (0..40).map(|k| 0.5 * f64::from(k)).collect();
        let mut angles: Vec<f64> = whole.iter().map(|&a| shorter(a)).collect();
        let chain: Vec<(usize, usize)> = (0..39).map(|k| (k, k + 1)).collect();
        assert!(unwind(&mut angles, &chain, &[]).is_empty());
        for (angle, wanted) in angles.iter().zip(&whole) {
            assert!((angle - angles[0] - wanted).abs() < 1e-12);
        }
        // Once around while the ring closes: one pair has to differ by a turn, and it is that of the largest step.
        let steps = [0.6, 0.6, 0.6, 1.6, 0.6, 0.6, 0.6, TAU - 5.2];
        let mut ring = vec![0.0];
        for step in &steps[..7] {
            ring.push(shorter(ring[ring.len() - 1] + step));
        }
        let around: Vec<(usize, usize)> = (0..8).map(|k| (k, (k + 1) % 8)).collect();
        assert_eq!(unwind(&mut ring, &around, &[]), [(3, 4)]);
    }

    #[test]
    fn what_hangs_together_by_a_vertex_is_unwound_too() {
        let mut angles = [3.0, -3.0, 0.1];
        assert!(unwind(&mut angles, &[], &[(0, 1), (1, 2)]).is_empty());
        assert!((angles[1] - (TAU - 3.0)).abs() < 1e-12);
        assert!((angles[2] - 0.1).abs() < 1e-12 || (angles[2] - 0.1 - TAU).abs() < 1e-12);
    }
}
