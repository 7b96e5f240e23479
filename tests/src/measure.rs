//! Measurements that decide a law: equality to the bit, differences relative to scale, continuity along lines.

use anamorph_core::{Linear, Smoothness, Space};

/// Whether two points are the same to the bit.
pub fn same_bits<S: Space>(a: S, b: S) -> bool {
    (0..S::DIM).all(|i| a.component(i).to_bits() == b.component(i).to_bits())
}

/// The first index at which two lists of points differ in a bit.
pub fn first_difference<S: Space>(a: &[S], b: &[S]) -> Option<usize> {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).position(|(&a, &b)| !same_bits(a, b))
}

/// Largest entry of the difference of two linear maps.
pub fn linear_distance<S: Space>(a: &S::Linear, b: &S::Linear) -> f64 {
    (0..S::DIM).fold(0.0, |m, i| m.max((a.column(i) - b.column(i)).largest()))
}

/// Largest entry of a linear map.
pub fn linear_size<S: Space>(a: &S::Linear) -> f64 {
    (0..S::DIM).fold(0.0, |m, i| m.max(a.column(i).largest()))
}

/// Samples on a line for [`breaks`]: one more than a power of two.
pub const SAMPLES: usize = 4097;
/// The coarse step of [`breaks`], in samples.
const COARSE: usize = 8;

/// Differences of order `order + 1` of a curve given by [`SAMPLES`] samples, at the fine step and at an eight times
/// coarser one, each over step^order. A jump in the derivative of that order leaves the first as large as the second; where the
/// next derivative is bounded the first is an eighth of the second.
fn ends<S: Space>(samples: &[S], order: usize) -> (f64, f64) {
    let largest = |stride: usize| {
        let mut row: Vec<S> = samples.iter().copied().step_by(stride).collect();
        for _ in 0..=order {
            row = row.windows(2).map(|w| w[1] - w[0]).collect();
        }
        let step = f64::from(u32::try_from(stride).unwrap());
        let power = step.powi(i32::try_from(order).unwrap());
        row.iter().fold(0.0_f64, |m, d| m.max(d.largest())) / power
    };
    (largest(1), largest(COARSE))
}

/// What differences say about a curve's derivative of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Break {
    /// Which derivative.
    pub order: usize,
    /// Size of the differences at the fine step relative to that at the coarse one: 1 at a jump, an eighth if smooth.
    pub ratio: f64,
}

/// Looks for a jump in the derivatives that `class` declares continuous (orders 0 to 2) along a sampled line. `noise` is
/// the size of rounding errors of a sample.
pub fn breaks<S: Space>(samples: &[S], class: Smoothness, noise: f64) -> Option<Break> {
    let most = match class {
        Smoothness::Jump => return None,
        Smoothness::C(k) => usize::from(k).min(2),
        Smoothness::Smooth => 2,
    };
    (0..=most).find_map(|order| {
        let (fine, coarse) = ends(samples, order);
        let rounding = noise * f64::from(1 << (order + 3));
        // Jumps too small to matter, in derivatives by the share of the line: what is born near a sample's end looks like
        // one to differences of any step.
        let (step, length) = (1.0 / 4096.0, samples[0].distance(samples[SAMPLES - 1]));
        let small = [1e-5, 1e-3 * step, 1e-1 * step * step][order] * length;
        (fine > 0.5 * coarse + rounding + small).then_some(Break {
            order,
            ratio: fine / coarse,
        })
    })
}

/// How large a jump of derivative `order` is along a sampled line, as a share of the coarse differences; 1 for a jump.
pub fn jump_share<S: Space>(samples: &[S], order: usize) -> f64 {
    let (fine, coarse) = ends(samples, order);
    fine / coarse.max(f64::MIN_POSITIVE)
}
