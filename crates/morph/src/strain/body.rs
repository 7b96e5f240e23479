//! A part of a pair as its frames need it: numbered for itself, of unit area, with everything that no time changes.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004; errata S8 (strains are measured in the axes
//! of the source as it is given), S9 (both domains, each divided by its own area), S12 and S13.

use super::cells::{Points, Where};
use super::pair::{Element, Pair, Part};
use super::rotations::unwind;
use super::schemes::Scheme;
use super::stitching::Stitching;
use super::system::{System, gauge};
use super::tensor::{Strain, cross, rotation, shorter};
use anamorph_core::glam::DVec2;
use anamorph_solvers::SolverError;

/// The barrier in units of the energy, of an element of mean size.
const STIFFNESS: f64 = 1e-2;

/// The barrier at each guard, as strong as what may push against it: energies grow with the square of strains.
fn stiffness(shares: &[f64], full: &[Strain]) -> Vec<f64> {
    let strong = |s: &Strain| 1.0 + s.x * s.x + s.y * s.y + 0.5 * s.shear * s.shear;
    let each = shares.iter().zip(full);
    each.map(|(share, full)| STIFFNESS * share * strong(full))
        .collect()
}

/// A domain that strains are measured from.
#[derive(Debug, Clone)]
pub(crate) struct Domain {
    pub(crate) points: Points,
    /// Strains at the other end.
    pub(crate) full: Vec<Strain>,
    /// Whether this is the target, in which time runs back.
    pub(crate) reversed: bool,
}

/// The triangle of a corner, and the sense in which it lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corner {
    pub(crate) nodes: [u32; 3],
    pub(crate) sense: f64,
    /// Twice its area in the source.
    pub(crate) area: f64,
}

/// A prepared part.
#[derive(Debug)]
pub(crate) struct Body {
    /// Its vertices in the whole.
    pub(crate) vertices: Vec<usize>,
    /// Its elements in the whole.
    pub(crate) numbers: Vec<usize>,
    /// Its elements by its own vertices.
    pub(crate) elements: Vec<Element>,
    /// How many elements each of its corners belongs to.
    pub(crate) corner_elements: Vec<u32>,
    /// Places, about their own origins, in units of `scale`.
    pub(crate) source: Vec<DVec2>,
    pub(crate) target: Vec<DVec2>,
    /// The root of its area.
    pub(crate) scale: f64,
    pub(crate) domains: Vec<Domain>,
    pub(crate) corners: Vec<Corner>,
    /// Corners of quadrilaterals and middles of triangles, for determinants, with the strains of the target there.
    pub(crate) guards: Points,
    pub(crate) guarded: Vec<Strain>,
    /// What guards count beside their areas: small elements as much as those of mean size, since they are not to vanish either.
    pub(crate) shares: Vec<f64>,
    /// Of the barrier, in units of the energy.
    pub(crate) stiffness: Vec<f64>,
    pub(crate) system: System,
    pub(crate) stitching: Stitching,
    pub(crate) gauge: [usize; 2],
    /// Rotations at the points of the first domain from source to target, unwound.
    pub(crate) angles: Vec<f64>,
    /// Their mean by area.
    pub(crate) mean_angle: f64,
    /// Neighbours, in the whole, whose rotations do not close.
    pub(crate) open: Vec<(usize, usize)>,
}

/// The strains of a map at all points.
fn strains(points: &Points, positions: &[DVec2]) -> Vec<Strain> {
    let mut list = Vec::with_capacity(points.len());
    points.each_gradient(positions, |_, _, gradient| list.push(Strain::of(gradient)));
    list
}

/// A vertex-sharing pair of elements for each further element of a vertex.
fn hinges(elements: &[Element], vertices: usize) -> Vec<(usize, usize)> {
    let mut first = vec![usize::MAX; vertices];
    let mut pairs = Vec::new();
    for (number, element) in elements.iter().enumerate() {
        for &vertex in element.vertices() {
            if first[vertex] == usize::MAX {
                first[vertex] = number;
            } else {
                pairs.push((first[vertex], number));
            }
        }
    }
    pairs
}

/// The centroid of the area of elements and the area, both signed as most of it is.
pub(crate) fn area_and_centroid(elements: &[Element], positions: &[DVec2]) -> (f64, DVec2) {
    let origin = positions.first().copied().unwrap_or_default();
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for element in elements {
        let vertices = element.vertices();
        let a = positions[vertices[0]] - origin;
        // Quadrilaterals as two triangles; senses do not matter for the centroid of what lies one way.
        let sign = if element.twice_area(|v| positions[v]) < 0.0 {
            -1.0
        } else {
            1.0
        };
        for k in 1..vertices.len() - 1 {
            let (b, c) = (
                positions[vertices[k]] - origin,
                positions[vertices[k + 1]] - origin,
            );
            let twice = sign * cross(b - a, c - a);
            area += 0.5 * twice;
            moment += (a + b + c) * (twice / 6.0);
        }
    }
    if area > 0.0 {
        return (area, origin + moment / area);
    }
    let sum: DVec2 = positions.iter().map(|&p| p - origin).sum();
    (area, origin + sum / positions.len().max(1) as f64)
}

/// The elements of a part by its own vertices, and the places of those in the source and in the target.
pub(crate) fn cut(pair: &Pair, part: &Part) -> (Vec<Element>, Vec<DVec2>, Vec<DVec2>) {
    let own = |vertex: usize| part.vertices.binary_search(&vertex).unwrap_or(0);
    let elements = part.elements.iter().map(|&e| match pair.elements()[e] {
        Element::Triangle(list) => Element::Triangle(list.map(own)),
        Element::Quadrilateral(list) => Element::Quadrilateral(list.map(own)),
    });
    let elements = elements.collect();
    let places = |list: &[DVec2]| part.vertices.iter().map(|&v| list[v]).collect();
    (elements, places(pair.source()), places(pair.target()))
}

impl Body {
    pub(crate) fn new(pair: &Pair, part: &Part, symmetric: bool) -> Result<Self, SolverError> {
        let (elements, source, target) = cut(pair, part);
        let (area, middle) = area_and_centroid(&elements, &source);
        let scale = area.sqrt();
        let local = |list: Vec<DVec2>, middle: DVec2| -> Vec<DVec2> {
            list.iter().map(|&p| (p - middle) / scale).collect()
        };
        let source = local(source, middle);
        let (_, middle) = area_and_centroid(&elements, &target);
        let target = local(target, middle);
        let count = source.len();

        let mut points = Points::new(&elements, &source, Where::Gauss);
        let held = gauge(&points, &source);
        let system = System::of_places(&points, count, held)?;
        let stitching = Stitching::new(&points, count, held[0], false)?;
        let guards = Points::new(&elements, &source, Where::Corners);
        let guarded = strains(&guards, &target);
        let mean = guards.weights().sum::<f64>() / guards.len().max(1) as f64;
        let share = |weight: f64| {
            if weight > 0.0 {
                (mean / weight).clamp(1.0, 1e12)
            } else {
                1.0
            }
        };
        let shares: Vec<f64> = guards.weights().map(share).collect();

        // Rotations in the middles of elements, unwound, lead those at the points.
        let mut middles = vec![0.0; elements.len()];
        let middle_points = Points::new(&elements, &source, Where::Middle);
        middle_points.each_gradient(&target, |_, element, gradient| {
            middles[element] = rotation(gradient);
        });
        let own = |e: usize| part.elements.binary_search(&e).unwrap_or(usize::MAX);
        let neighbours: Vec<(usize, usize)> = pair
            .neighbours()
            .iter()
            .map(|&(a, b)| (own(a), own(b)))
            .filter(|&(a, b)| a != usize::MAX && b != usize::MAX)
            .collect();
        let open = unwind(&mut middles, &neighbours, &hinges(&elements, count));
        let open = open
            .iter()
            .map(|&(a, b)| (part.elements[a], part.elements[b]))
            .collect();
        let mut angles = Vec::with_capacity(points.len());
        points.each_gradient(&target, |_, element, gradient| {
            let middle = middles[element];
            angles.push(middle + shorter(rotation(gradient) - middle));
        });
        let (mut total, mut turned) = (0.0, 0.0);
        for (angle, weight) in angles.iter().zip(points.weights()) {
            total += weight;
            turned += weight * angle;
        }
        let mean_angle = turned / total;

        let full = strains(&points, &target);
        let mut domains = Vec::new();
        if symmetric {
            points.divide_weights(points.weights().sum());
        }
        domains.push(Domain {
            points,
            full,
            reversed: false,
        });
        if symmetric {
            let mut points = Points::new(&elements, &target, Where::Gauss);
            points.divide_weights(points.weights().sum());
            let full = strains(&points, &source);
            domains.push(Domain {
                points,
                full,
                reversed: true,
            });
        }

        let (mut corners, mut corner_elements) = (Vec::new(), Vec::new());
        for (number, element) in elements.iter().enumerate() {
            for nodes in element.corners() {
                // Counts of a pair fit 31 bits.
                #[allow(clippy::cast_possible_truncation)]
                let narrow = |v: usize| v as u32;
                let [a, b, c] = nodes.map(|v| source[v]);
                let area = cross(b - a, c - a);
                corners.push(Corner {
                    nodes: nodes.map(narrow),
                    sense: area.signum(),
                    area: area.abs(),
                });
                corner_elements.push(narrow(number));
            }
        }
        Ok(Self {
            vertices: part.vertices.clone(),
            numbers: part.elements.clone(),
            elements,
            corner_elements,
            source,
            target,
            scale,
            domains,
            corners,
            guards,
            stiffness: stiffness(&shares, &guarded),
            guarded,
            shares,
            system,
            stitching,
            gauge: held,
            angles,
            mean_angle,
            open,
        })
    }

    /// The strains wanted at time `t`, domain by domain.
    pub(crate) fn want(&self, scheme: &dyn Scheme, t: f64, wanted: &mut [Vec<Strain>]) {
        for (domain, list) in self.domains.iter().zip(wanted) {
            let t = if domain.reversed { 1.0 - t } else { t };
            list.clear();
            list.extend(domain.full.iter().map(|&full| scheme.strain(full, t)));
        }
    }

    /// The smallest ratio of the determinant of a corner to that of the source, and the element.
    pub(crate) fn smallest_determinant(&self, positions: &[DVec2]) -> (f64, usize) {
        let mut smallest = (f64::INFINITY, 0);
        for (corner, &element) in self.corners.iter().zip(&self.corner_elements) {
            let ratio = corner.determinant(positions) / corner.area;
            if ratio < smallest.0 || ratio.is_nan() {
                smallest = (ratio, element as usize);
            }
        }
        (smallest.0, self.numbers[smallest.1])
    }
}

impl Corner {
    /// Twice its area, positive as long as it lies as in the source.
    #[inline]
    pub(crate) fn determinant(&self, positions: &[DVec2]) -> f64 {
        let [a, b, c] = self.nodes.map(|node| positions[node as usize]);
        self.sense * cross(b - a, c - a)
    }

    /// The first share of the steps at which it has no area: the smallest positive root of a quadratic, by the form that loses no digits.
    #[inline]
    pub(crate) fn first_root(&self, positions: &[DVec2], steps: &[DVec2]) -> f64 {
        let [a, b, c] = self.nodes.map(|node| positions[node as usize]);
        let [da, db, dc] = self.nodes.map(|node| steps[node as usize]);
        let (u, v, du, dv) = (b - a, c - a, db - da, dc - da);
        let constant = self.sense * cross(u, v);
        let slope = self.sense * (cross(du, v) + cross(u, dv));
        let square = self.sense * cross(du, dv);
        first_root(square, slope, constant)
    }
}

/// The smallest positive root of `a x² + b x + c`, `c > 0`: `2c / (−b + √Δ)`; infinite if there is none.
pub(crate) fn first_root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let below = discriminant.sqrt() - b;
    if below > 0.0 {
        2.0 * c / below
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::first_root;

    #[test]
    fn the_first_root_is_found_whatever_the_signs() {
        for (a, b, c, wanted) in [
            (1.0, -3.0, 2.0, 1.0),
            (0.0, -2.0, 1.0, 0.5),
            (-1.0, 0.0, 4.0, 2.0),
            (-1.0, 3.0, 4.0, 4.0),
            (1.0, 3.0, 2.0, f64::INFINITY),
            (1.0, 0.0, 1.0, f64::INFINITY),
            (0.0, 1.0, 1.0, f64::INFINITY),
            (1e-18, -2.0, 1.0, 0.5),
        ] {
            let found = first_root(a, b, c);
            assert!(
                found == wanted || (found - wanted).abs() < 1e-15,
                "{a} {b} {c}: {found}"
            );
        }
    }
}
