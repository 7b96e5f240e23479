//! Strain against time, as the paper plots it.
//!
//! Computes eq. (1) of an element at each of the frames: at the only point of a triangle, or the mean by area over the points of a
//! quadrilateral.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eq. (1) and Figure 3.

use super::cells::{Points, Where};
use super::{Frame, Pair, Strain};
use anamorph_core::glam::DVec2;

/// The strain of an element over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StrainSeries {
    /// The times of the frames.
    pub times: Vec<f64>,
    /// The strains at these times.
    pub strains: Vec<Strain>,
}

impl StrainSeries {
    /// The series of an element; nothing if there is no such element, or frames are of another mesh.
    pub fn new(pair: &Pair, element: usize, frames: &[Frame]) -> Option<Self> {
        let chosen = *pair.elements().get(element)?;
        let points = Points::new(&[chosen], pair.source(), Where::Gauss);
        let mut series = Self::default();
        for frame in frames {
            if frame.positions.len() != pair.source().len() {
                return None;
            }
            series.times.push(frame.time);
            series
                .strains
                .extend(strains_of(&points, 1, &frame.positions));
        }
        Some(series)
    }

    /// Whether each component goes one way only, but for going back by `slack` in all.
    pub fn is_monotone(&self, slack: f64) -> bool {
        let components: [fn(&Strain) -> f64; 3] = [|s| s.x, |s| s.y, |s| s.shear];
        components.iter().all(|component| {
            let back = |sign: f64| {
                let (mut highest, mut back) = (f64::NEG_INFINITY, 0.0_f64);
                for strain in &self.strains {
                    let value = sign * component(strain);
                    highest = highest.max(value);
                    back = back.max(highest - value);
                }
                back
            };
            back(1.0) <= slack || back(-1.0) <= slack
        })
    }
}

/// The strains of all elements in a frame, eq. (1); empty if it is of another mesh.
pub fn strains(pair: &Pair, positions: &[DVec2]) -> Vec<Strain> {
    if positions.len() != pair.source().len() {
        return Vec::new();
    }
    let points = Points::new(pair.elements(), pair.source(), Where::Gauss);
    strains_of(&points, pair.elements().len(), positions)
}

fn strains_of(points: &Points, elements: usize, positions: &[DVec2]) -> Vec<Strain> {
    let mut sums = vec![(Strain::default(), 0.0); elements];
    let mut weights = points.weights();
    points.each_gradient(positions, |_, element, gradient| {
        let (found, weight) = (Strain::of(gradient), weights.next().unwrap_or(0.0));
        let (sum, total) = &mut sums[element];
        // The mean so far moves by its share, so that one point is its own mean to the bit.
        *total += weight;
        let share = weight / *total;
        sum.x += (found.x - sum.x) * share;
        sum.y += (found.y - sum.y) * share;
        sum.shear += (found.shear - sum.shear) * share;
    });
    sums.into_iter().map(|(strain, _)| strain).collect()
}
