//! Points spread well over a model.
//!
//! *Source*: farthest-point sampling, T. F. Gonzalez, *Clustering to Minimize the Maximum Intercluster Distance*, Theoretical
//! Computer Science 38, 1985: each point is the one farthest from those before it. That the first is the one farthest from
//! the middle, and that the earlier of equals is taken, is a decision; so the choice depends on nothing but the points.

use anamorph_core::{Bounds, Space};

/// Indices of up to `count` finite points, each as far as can be from those before it. Fewer where there are not as many
/// different ones. Takes time proportional to `count` times the number of points.
pub fn spread<S: Space>(points: &[S], count: usize) -> Vec<usize> {
    let Some(bounds) = Bounds::of(points) else {
        return Vec::new();
    };
    let centre = bounds.centre();
    let mut chosen: Vec<usize> = Vec::new();
    // From the chosen points; at first from the middle. What is not finite is never the farthest.
    let mut distances: Vec<f64> = points
        .iter()
        .map(|p| {
            if p.is_finite() {
                p.distance(centre)
            } else {
                -1.0
            }
        })
        .collect();
    while chosen.len() < count {
        let mut farthest = (0, -1.0);
        for (index, &distance) in distances.iter().enumerate() {
            if distance > farthest.1 {
                farthest = (index, distance);
            }
        }
        let (index, distance) = farthest;
        if distance < 0.0 || (distance == 0.0 && !chosen.is_empty()) {
            break;
        }
        for (from, &point) in distances.iter_mut().zip(points) {
            if point.is_finite() {
                let distance = point.distance(points[index]);
                *from = if chosen.is_empty() {
                    distance
                } else {
                    from.min(distance)
                };
            }
        }
        chosen.push(index);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::{DVec2, dvec2};

    #[test]
    fn corners_come_first_and_doubles_never() {
        let mut points: Vec<DVec2> = (0..25)
            .map(|i| dvec2(f64::from(i % 5), f64::from(i / 5)))
            .collect();
        points.extend_from_within(..);
        points.push(dvec2(f64::NAN, 1e9));
        let mut corners = spread(&points, 4);
        corners.sort_unstable();
        assert_eq!(corners, [0, 4, 20, 24]);
        assert_eq!(spread(&points, 5)[4], 12);
        assert_eq!(spread(&points, 1000).len(), 25);
        assert_eq!(spread(&points, 0), [0_usize; 0]);
        assert_eq!(spread(&points[..1], 3), [0]);
        assert_eq!(spread::<DVec2>(&[], 3), [0_usize; 0]);
        // Each point keeps the distance that its turn gave it: none comes closer to an earlier one than the next.
        let order = spread(&points, 12);
        let gap = |n: usize| {
            let before = order[..n].iter();
            before.fold(f64::INFINITY, |least, &i| {
                least.min(points[i].distance(points[order[n]]))
            })
        };
        assert!((2..12).all(|n| gap(n) <= gap(n - 1)));
    }
}
