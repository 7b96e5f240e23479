//! Bend: the axis becomes a circular arc (within a range), straight on both sides of it.
//!
//! With `θ(z) = k (ẑ − z₀)` the point at axis coordinate `z` is carried by the rigid map that takes `(0, 0, z)` to the bent
//! axis `c(z)` and turns by `θ` towards local `x`:
//! `(x, y, z) ↦ (c_x + x cos θ, y, c_z − x sin θ)`, `c′ = (sin θ, cos θ)`, `c(z₀) = (0, z₀)`.
//! Within a clamped range `c` is Barr's closed form, `c_x = (1 − cos θ)/k`, `c_z = z₀ + sin θ / k`; at smooth limits the
//! curvature falls off continuously and `c` is integrated (Gauss–Legendre). The axis keeps its length either way.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984, §3.4 (global linear bends).

use super::axis::{Law, LocalMap, limited, limited_block, range_note};
use super::{AxialWarp, AxisError, AxisFrame};
use anamorph_core::simd::{self, Simd};
use anamorph_core::{Scaling, Smoothness, Space, math};
use anamorph_fields::{AxisRange, Limit};

/// Nodes and weights of eight-point Gauss–Legendre quadrature on [−1, 1] (positive half).
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];
/// Turn between two nodes of the integrated axis, in radians: small enough that eight points are exact to rounding.
const TURN_BETWEEN_NODES: f64 = 0.5;
/// Most nodes; beyond it the axis is wound up thousands of times and nobody can tell.
const MOST_NODES: f64 = 4096.0;

/// The bent axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Bend {
    curvature: f64,
    centre: f64,
    range: Option<AxisRange>,
    /// For smooth limits: axis coordinates and the bent axis `(c_x, c_z)` there, ascending.
    nodes: Vec<(f64, [f64; 2])>,
}

impl Bend {
    /// A bend of `frame`'s axis towards its local `x` with the given curvature (radians per scene unit). The point of the
    /// axis at coordinate `centre` stays and keeps its direction.
    ///
    /// # Errors
    /// [`AxisError::NotFinite`] for a curvature or centre that is not finite.
    pub fn construct<S: Space>(
        frame: AxisFrame<S>,
        curvature: f64,
        centre: f64,
        range: Option<AxisRange>,
        scaling: Scaling,
    ) -> Result<AxialWarp<S, Self>, AxisError> {
        if !curvature.is_finite() {
            return Err(AxisError::NotFinite {
                what: "the curvature",
            });
        }
        if !centre.is_finite() {
            return Err(AxisError::NotFinite { what: "the centre" });
        }
        let mut law = Self {
            curvature,
            centre,
            range,
            nodes: Vec::new(),
        };
        law.nodes = law.axis_nodes();
        Ok(AxialWarp::new(frame, law, scaling))
    }

    fn smooth_range(&self) -> Option<&AxisRange> {
        self.range
            .as_ref()
            .filter(|range| range.limit() != Limit::Clamp)
    }

    /// Turning angle at a coordinate.
    fn angle(&self, z: f64) -> f64 {
        self.curvature * (limited(self.range.as_ref(), z).0 - self.limited_centre())
    }

    /// `ẑ` at the centre: the angle is zero there also when the centre lies outside the range.
    fn limited_centre(&self) -> f64 {
        limited(self.range.as_ref(), self.centre).0
    }

    /// ∫ (sin θ, cos θ) from `a` to `b`.
    fn integral(&self, a: f64, b: f64) -> [f64; 2] {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut sum = [0.0; 2];
        for (node, weight) in GAUSS {
            for node in [-node, node] {
                let (sin, cos) = math::sin_cos(self.angle(middle + half * node));
                sum[0] += weight * sin;
                sum[1] += weight * cos;
            }
        }
        sum.map(|s| s * half)
    }

    /// Nodes over the curved stretch, starting from the centre outwards, so that `c(centre) = (0, centre)`.
    fn axis_nodes(&self) -> Vec<(f64, [f64; 2])> {
        let Some(range) = self.smooth_range() else {
            return Vec::new();
        };
        let half = match range.limit() {
            Limit::Clamp => 0.0,
            Limit::Smooth { width } => 0.5 * width,
        };
        let (low, low_end) = (range.min() - half, range.min() + half);
        let (high_start, high) = (range.max() - half, range.max() + half);
        // Polynomial pieces of ẑ end at the zones' ends; every node list contains them.
        let mut breaks = vec![low, low_end, high_start, high];
        if self.centre > low && self.centre < high {
            breaks.push(self.centre);
        }
        breaks.sort_by(f64::total_cmp);
        let mut stations = vec![breaks[0]];
        for pair in breaks.windows(2) {
            let turn = (self.curvature * (pair[1] - pair[0])).abs();
            let pieces = (turn / TURN_BETWEEN_NODES).ceil().clamp(1.0, MOST_NODES);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            for piece in 1..=pieces as u32 {
                let next = pair[0] + (pair[1] - pair[0]) * (f64::from(piece) / pieces);
                if stations.last().is_none_or(|&last| next > last) {
                    stations.push(next);
                }
            }
        }
        // Bent axis relative to the first station, then moved so that the centre keeps its place.
        let mut nodes = vec![(stations[0], [0.0, 0.0])];
        for pair in stations.windows(2) {
            let step = self.integral(pair[0], pair[1]);
            let last = nodes[nodes.len() - 1].1;
            nodes.push((pair[1], [last[0] + step[0], last[1] + step[1]]));
        }
        let here = axis_point(self, &nodes, self.centre);
        for node in &mut nodes {
            node.1[0] -= here[0];
            node.1[1] += self.centre - here[1];
        }
        nodes
    }

    /// The same bend with another curvature, for composition scaling.
    fn with_strength(&self, strength: f64) -> Self {
        let mut law = Self {
            curvature: self.curvature * strength,
            nodes: Vec::new(),
            ..self.clone()
        };
        law.nodes = law.axis_nodes();
        law
    }

    /// Bent axis at `z` as `(c_x, c_z)`.
    fn axis(&self, z: f64) -> [f64; 2] {
        if !self.nodes.is_empty() {
            return axis_point(self, &self.nodes, z);
        }
        let base = self.limited_centre();
        let limited = limited(self.range.as_ref(), z).0;
        let theta = self.curvature * (limited - base);
        let (s, c) = math::sin_cos(0.5 * theta);
        let (across, along) = if self.curvature == 0.0 {
            (0.0, limited - base)
        } else {
            // 1 − cos θ = 2 sin²(θ/2) keeps its digits for small angles.
            (2.0 * s * s / self.curvature, 2.0 * s * c / self.curvature)
        };
        let (sin, cos) = (2.0 * s * c, 1.0 - 2.0 * s * s);
        let beyond = z - limited;
        // A centre outside the range lies on a straight part.
        [across + beyond * sin, base + along + beyond * cos]
    }
}

/// The bent axis between and beyond nodes.
fn axis_point(bend: &Bend, nodes: &[(f64, [f64; 2])], z: f64) -> [f64; 2] {
    let after = nodes.partition_point(|node| node.0 <= z);
    let (at, [x, along]) = nodes[after.max(1) - 1];
    let step = if after == 0 || after == nodes.len() {
        // Straight beyond the last zone.
        let (sin, cos) = math::sin_cos(bend.angle(z));
        [(z - at) * sin, (z - at) * cos]
    } else {
        bend.integral(at, z)
    };
    [x + step[0], along + step[1]]
}

impl Law for Bend {
    fn at(&self, z: f64, strength: f64) -> LocalMap {
        if strength == 0.0 || self.curvature == 0.0 {
            return LocalMap::IDENTITY;
        }
        if strength != 1.0 {
            return self.with_strength(strength).at(z, 1.0);
        }
        let (sin, cos) = math::sin_cos(self.angle(z));
        let [cx, cz] = self.axis(z);
        // The rigid map about (0, 0, z).
        LocalMap {
            linear: [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]],
            translation: [cx - z * sin, 0.0, cz - z * cos],
        }
    }

    fn slope(&self, z: f64) -> LocalMap {
        let rate = self.curvature * limited(self.range.as_ref(), z).1;
        let (sin, cos) = math::sin_cos(self.angle(z));
        // d/dz of the rotation, and of c − z (sin θ, cos θ): what is left after c′ cancels is −z θ′ (cos θ, −sin θ).
        LocalMap {
            linear: [
                [-sin * rate, 0.0, cos * rate],
                [0.0; 3],
                [-cos * rate, 0.0, -sin * rate],
            ],
            translation: [-z * rate * cos, 0.0, z * rate * sin],
        }
    }

    #[inline(always)]
    fn map_block<V: Simd>(&self, v: V, q: simd::Block<V>) -> simd::Block<V> {
        if self.curvature == 0.0 {
            return q;
        }
        let s = |value: f64| simd::splat(v, value);
        let [x, y, z] = q;
        if !self.nodes.is_empty() {
            let heights: [f64; simd::LANES] = z.into();
            let axis = heights.map(|z| axis_point(self, &self.nodes, z));
            let angles = heights.map(|z| self.angle(z));
            let (sin, cos) = simd::sin_cos(v, simd::lanes(v, |lane| angles[lane]));
            let cx = simd::lanes(v, |lane| axis[lane][0]);
            let cz = simd::lanes(v, |lane| axis[lane][1]);
            return [cx + x * cos, y, cz - x * sin];
        }
        let base = self.limited_centre();
        let limited = limited_block(v, self.range.as_ref(), z);
        let along = limited - s(base);
        let (sh, ch) = simd::sin_cos(v, along * s(0.5 * self.curvature));
        let radius = 1.0 / self.curvature;
        let (sin, versine) = (s(2.0) * sh * ch, s(2.0) * sh * sh);
        let cos = s(1.0) - versine;
        let beyond = z - limited;
        let moved_x = versine * s(radius) + beyond * sin + x * cos;
        // z̃ = z₀ + sin θ / k + beyond cos θ − x sin θ, as a change of z, so that an unbent point keeps its bits.
        let change = (sin * s(radius) - along) - beyond * versine - x * sin;
        [moved_x, y, z + change]
    }

    fn smoothness(&self) -> Smoothness {
        self.range
            .as_ref()
            .map_or(Smoothness::Smooth, AxisRange::smoothness)
    }
    fn range(&self) -> Option<&AxisRange> {
        self.range.as_ref()
    }
    fn notes(&self) -> Vec<String> {
        range_note(self.range.as_ref())
    }
    fn is_identity(&self) -> bool {
        self.curvature == 0.0
    }
}
