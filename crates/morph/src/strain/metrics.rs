//! What a morph is like: every frame for itself, and all of them over time.
//!
//! Measured are, from the source to the frame at the points of the elements: principal stretches `σ₁ ≥ σ₂`, the symmetric Dirichlet
//! energy `¼(σ₁² + σ₂² + σ₁⁻² + σ₂⁻²)`, conformal distortion `σ₁/σ₂`, isometric distortion `max(σ₁, 1/σ₂)` (all are 1 where nothing is strained), strains
//! against those that a method wants; determinants at corners; areas; crossings of the boundary; angles. Means are by area.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, Figure 3; J. Smith, S. Schaefer, *Bijective
//! Parameterization with Free Boundaries*, SIGGRAPH 2015, for the symmetric Dirichlet energy.

use super::body::area_and_centroid;
use super::cells::{Points, Where};
use super::crossings::{crossings, smallest_angle};
use super::tensor::cross;
use super::{Frame, FrameError, InBetween, Pair, Strain};
use anamorph_core::glam::DVec2;

/// A mean by area and the largest value.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub largest: f64,
}

/// What a frame is like.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameMetrics {
    /// Its time.
    pub time: f64,
    /// The sum of the elements' areas, those turned over counted below zero.
    pub area: f64,
    /// Elements with a corner that is turned over or flat.
    pub flips: usize,
    /// The smallest determinant of a corner over that of the source.
    pub smallest_determinant: f64,
    /// Of the points, against the source.
    pub symmetric_dirichlet: Spread,
    /// `σ₁/σ₂`.
    pub conformal: Spread,
    /// `max(σ₁, 1/σ₂)`.
    pub isometric: Spread,
    /// Fidelity: the root of the mean squared difference from the strains wanted; nothing of a method that wants none.
    pub strain_difference: Option<f64>,
    /// How far a component of strain is outside of what lies between those of both ends, at most.
    pub strain_overshoot: f64,
    /// Pairs of boundary edges that cross.
    pub crossings: usize,
    /// The smallest angle of an element, in radians.
    pub smallest_angle: f64,
    /// Newton's steps.
    pub steps: usize,
    /// Elements that had to be held up.
    pub held_up: usize,
    /// Parts whose search came to no end.
    pub unfinished: usize,
}

/// What a mesh is like, at both ends.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshQuality {
    /// Vertices.
    pub vertices: usize,
    /// Elements.
    pub elements: usize,
    /// Edges of one element only.
    pub boundary_edges: usize,
    /// Parts that nothing connects.
    pub parts: usize,
    /// The smallest angle in the source, in radians.
    pub smallest_angle_source: f64,
    /// The smallest angle in the target, in radians.
    pub smallest_angle_target: f64,
}

/// What a morph is like.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MorphMetrics {
    /// The method's name.
    pub method: String,
    /// Its frames, by time.
    pub frames: Vec<FrameMetrics>,
    /// Of the mesh.
    pub mesh: MeshQuality,
    /// How far the whole area leaves what lies between those of both ends, over the larger of these.
    pub area_overshoot: f64,
    /// The largest step of the whole area the wrong way, over the larger area.
    pub area_reversal: f64,
    /// Elements whose area goes one way only, to 1e-9 of the larger of both.
    pub monotone_elements: usize,
    /// The root of the mean squared difference of principal stretches from those that go evenly.
    pub stretch_unevenness: f64,
    /// How far the same morph from the target to the source differs, see [`asymmetry`]; nothing where it was not measured.
    pub asymmetry: Option<f64>,
}

impl MorphMetrics {
    /// Elements turned over in all frames together.
    pub fn flips(&self) -> usize {
        self.frames.iter().map(|frame| frame.flips).sum()
    }
    /// The smallest determinant of all frames.
    pub fn smallest_determinant(&self) -> f64 {
        let all = self.frames.iter().map(|frame| frame.smallest_determinant);
        all.fold(f64::INFINITY, f64::min)
    }
    /// Crossings of the boundary in all frames together.
    pub fn crossings(&self) -> usize {
        self.frames.iter().map(|frame| frame.crossings).sum()
    }
    /// The median of Newton's steps over the frames between both ends.
    pub fn median_steps(&self) -> usize {
        let inner = |frame: &&FrameMetrics| frame.time > 0.0 && frame.time < 1.0;
        let mut steps: Vec<usize> = self.frames.iter().filter(inner).map(|f| f.steps).collect();
        steps.sort_unstable();
        steps.get(steps.len() / 2).copied().unwrap_or(0)
    }
}

fn mesh_quality(pair: &Pair) -> MeshQuality {
    MeshQuality {
        vertices: pair.source().len(),
        elements: pair.elements().len(),
        boundary_edges: pair.boundary().len(),
        parts: pair.part_count(),
        smallest_angle_source: angle(pair, pair.source()),
        smallest_angle_target: angle(pair, pair.target()),
    }
}

fn angle(pair: &Pair, positions: &[DVec2]) -> f64 {
    let mut corners = Vec::with_capacity(4);
    let mut smallest = f64::INFINITY;
    for element in pair.elements() {
        corners.clear();
        corners.extend(element.vertices().iter().map(|&v| positions[v]));
        smallest = smallest.min(smallest_angle(&corners));
    }
    smallest
}

/// What frames are measured against.
struct Yardstick<'a> {
    pair: &'a Pair,
    points: Points,
    corners: Points,
    full: Vec<Strain>,
    /// Twice the areas of the source's elements, signed.
    areas: Vec<f64>,
    total: f64,
}

impl<'a> Yardstick<'a> {
    fn new(pair: &'a Pair) -> Self {
        let points = Points::new(pair.elements(), pair.source(), Where::Gauss);
        let mut full = Vec::with_capacity(points.len());
        points.each_gradient(pair.target(), |_, _, f| full.push(Strain::of(f)));
        let areas = pair.elements().iter();
        let areas = areas.map(|e| e.twice_area(|v| pair.source()[v])).collect();
        Self {
            pair,
            corners: Points::new(pair.elements(), pair.source(), Where::Corners),
            total: points.weights().sum(),
            points,
            full,
            areas,
        }
    }

    fn measure(&self, method: &dyn InBetween, frame: &Frame) -> FrameMetrics {
        let positions = &frame.positions;
        let mut found = FrameMetrics {
            time: frame.time,
            crossings: crossings(self.pair.boundary(), positions).len(),
            smallest_angle: angle(self.pair, positions),
            smallest_determinant: f64::INFINITY,
            steps: frame.solution.steps,
            held_up: frame.solution.held_up,
            unfinished: frame.solution.unfinished,
            ..FrameMetrics::default()
        };
        for (element, area) in self.pair.elements().iter().zip(&self.areas) {
            found.area += 0.5 * element.twice_area(|v| positions[v]) * area.signum();
        }
        let mut turned = vec![false; self.areas.len()];
        self.corners.each_gradient(positions, |_, element, f| {
            let determinant = cross(f.x_axis, f.y_axis);
            found.smallest_determinant = found.smallest_determinant.min(determinant);
            turned[element] |= determinant.is_nan() || determinant <= 0.0;
        });
        found.flips = turned.iter().filter(|&&t| t).count();
        let mut weights = self.points.weights();
        let mut squares = None;
        self.points.each_gradient(positions, |point, _, f| {
            let share = weights.next().unwrap_or(0.0) / self.total;
            let (strain, full) = (Strain::of(f), self.full[point]);
            let [large, small] = strain.stretches();
            let dirichlet = 0.25
                * (large * large
                    + small * small
                    + (large * large).recip()
                    + (small * small).recip());
            for (spread, value) in [
                (&mut found.symmetric_dirichlet, dirichlet),
                (&mut found.conformal, large / small),
                (&mut found.isometric, large.max(small.recip())),
            ] {
                spread.mean += share * value;
                spread.largest = spread.largest.max(value);
            }
            for (value, end) in [
                (strain.x, full.x),
                (strain.y, full.y),
                (strain.shear, full.shear),
            ] {
                let beyond = (value - end.max(0.0)).max(end.min(0.0) - value);
                found.strain_overshoot = found.strain_overshoot.max(beyond);
            }
            if let Some(wanted) = method.wanted(full, frame.time) {
                let (x, y) = (strain.x - wanted.x, strain.y - wanted.y);
                let shear = strain.shear - wanted.shear;
                *squares.get_or_insert(0.0) += share * (x * x + y * y + 0.5 * shear * shear);
            }
        });
        found.strain_difference = squares.map(f64::sqrt);
        found
    }
}

/// Measures the frames of a method at these times; both ends are added where they are missing.
///
/// # Errors
/// [`FrameError`].
pub fn measure(
    pair: &Pair,
    method: &dyn InBetween,
    times: &[f64],
) -> Result<MorphMetrics, FrameError> {
    let mut times: Vec<f64> = times.iter().copied().chain([0.0, 1.0]).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let frames = method.frames(&times)?;
    Ok(measure_frames(pair, method, &frames))
}

/// Measures frames that are there already, which have to be of that pair and by ascending time.
pub fn measure_frames(pair: &Pair, method: &dyn InBetween, frames: &[Frame]) -> MorphMetrics {
    let fits = |frame: &&Frame| frame.positions.len() == pair.source().len();
    let frames: Vec<&Frame> = frames.iter().filter(fits).collect();
    let yardstick = Yardstick::new(pair);
    let mut found = MorphMetrics {
        method: method.name().to_owned(),
        mesh: mesh_quality(pair),
        frames: frames
            .iter()
            .map(|frame| yardstick.measure(method, frame))
            .collect(),
        ..MorphMetrics::default()
    };
    let whole = |positions: &[DVec2]| {
        let elements = pair.elements().iter().zip(&yardstick.areas);
        elements
            .map(|(e, area)| 0.5 * e.twice_area(|v| positions[v]) * area.signum())
            .sum::<f64>()
    };
    let ends = [whole(pair.source()), whole(pair.target())];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    let way = (ends[1] - ends[0]).signum();
    for frame in &found.frames {
        let beyond = (frame.area - high).max(low - frame.area).max(0.0);
        found.area_overshoot = found.area_overshoot.max(beyond / high);
    }
    for (a, b) in found.frames.iter().zip(found.frames.iter().skip(1)) {
        let back = (way * (a.area - b.area)).max(0.0);
        found.area_reversal = found.area_reversal.max(back / high);
    }
    for element in pair.elements() {
        let area = |positions: &[DVec2]| element.twice_area(|v| positions[v]).abs();
        let largest = area(pair.source()).max(area(pair.target()));
        let steps = || {
            let pairs = frames.iter().zip(frames.iter().skip(1));
            pairs.map(|(a, b)| (area(&b.positions) - area(&a.positions)) / largest)
        };
        let monotone = steps().all(|s| s >= -1e-9) || steps().all(|s| s <= 1e-9);
        found.monotone_elements += usize::from(monotone);
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for frame in &frames {
        let mut weights = yardstick.points.weights();
        yardstick
            .points
            .each_gradient(&frame.positions, |point, _, f| {
                let share = weights.next().unwrap_or(0.0) / yardstick.total;
                let (now, end) = (Strain::of(f).stretches(), yardstick.full[point].stretches());
                for (now, end) in now.into_iter().zip(end) {
                    let off = now - (1.0 + frame.time * (end - 1.0));
                    sum += share * off * off;
                    count += share;
                }
            });
    }
    found.stretch_unevenness = if count > 0.0 {
        f64::sqrt(sum / count)
    } else {
        0.0
    };
    found
}

/// How far a morph and the one from the target back to the source differ: of the frames at `t` and `1 − t`, at these times, the largest mean distance of vertices
/// (root of mean square) after the best rigid motion, over the root of the source's area.
///
/// # Errors
/// [`FrameError`] of either.
pub fn asymmetry(
    pair: &Pair,
    forward: &dyn InBetween,
    backward: &dyn InBetween,
    times: &[f64],
) -> Result<f64, FrameError> {
    let back: Vec<f64> = times.iter().map(|t| 1.0 - t).collect();
    let (here, there) = (forward.frames(times)?, backward.frames(&back)?);
    let scale = area_and_centroid(pair.elements(), pair.source()).0.sqrt();
    let mut largest = 0.0_f64;
    for (a, b) in here.iter().zip(&there) {
        largest = largest.max(rigid_distance(&a.positions, &b.positions) / scale);
    }
    Ok(largest)
}

/// The root of the mean squared distance of places from others after the best rigid motion.
pub fn rigid_distance(places: &[DVec2], others: &[DVec2]) -> f64 {
    let count = places.len().min(others.len()).max(1) as f64;
    let pairs = || places.iter().zip(others);
    let mean = |list: &[DVec2]| list.iter().copied().sum::<DVec2>() / count;
    let (a, b) = (mean(places), mean(others));
    let (mut dot, mut turn) = (0.0, 0.0);
    for (p, q) in pairs() {
        dot += (*p - a).dot(*q - b);
        turn += cross(*p - a, *q - b);
    }
    let length = (dot * dot + turn * turn).sqrt();
    let rotation = if length > 0.0 {
        DVec2::new(dot, turn) / length
    } else {
        DVec2::X
    };
    let squares = pairs().map(|(p, q)| (rotation.rotate(*p - a)).distance_squared(*q - b));
    (squares.sum::<f64>() / count).sqrt()
}

impl std::fmt::Display for MorphMetrics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "{}: {} vertices, {} elements, smallest angles {:.1}° and {:.1}°",
            self.method,
            self.mesh.vertices,
            self.mesh.elements,
            self.mesh.smallest_angle_source.to_degrees(),
            self.mesh.smallest_angle_target.to_degrees(),
        )?;
        writeln!(
            f,
            "{:>8} {:>10} {:>5} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7}",
            "time",
            "area",
            "flips",
            "least det",
            "dirichlet",
            "conformal",
            "isometric",
            "strain",
            "overshoot",
            "crosses",
            "angle"
        )?;
        for frame in &self.frames {
            let difference = frame
                .strain_difference
                .map_or_else(|| "-".to_owned(), |value| format!("{value:.6}"));
            writeln!(
                f,
                "{:>8.4} {:>10.4} {:>5} {:>9.4} {:>9.4} {:>9.4} {:>9.4} {:>9} {:>9.5} {:>7} {:>6.1}°",
                frame.time,
                frame.area,
                frame.flips,
                frame.smallest_determinant,
                frame.symmetric_dirichlet.mean,
                frame.conformal.largest,
                frame.isometric.largest,
                difference,
                frame.strain_overshoot,
                frame.crossings,
                frame.smallest_angle.to_degrees(),
            )?;
        }
        write!(
            f,
            "area: {:.4} % beyond both ends, {:.4} % the wrong way; {} of {} elements go one way; stretches uneven by {:.5}; {} steps in the median",
            100.0 * self.area_overshoot,
            100.0 * self.area_reversal,
            self.monotone_elements,
            self.mesh.elements,
            self.stretch_unevenness,
            self.median_steps(),
        )?;
        if let Some(asymmetry) = self.asymmetry {
            write!(f, "; back and forth differ by {asymmetry:.2e}")?;
        }
        writeln!(f)
    }
}
