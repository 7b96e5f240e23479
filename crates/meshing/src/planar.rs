//! Regions of the plane: a polygon with holes, exact tests, and a triangulation of its inside.
//!
//! Signs of areas are exact ([`orientation`]), so that *positive* means positive. The triangulation is a constrained Delaunay
//! triangulation; the inside is what an odd number of rings surrounds. Refinement adds points inside until angles are large enough; it
//! never adds any on the rings.
//!
//! *Source*: J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997, and
//! *Delaunay Refinement Algorithms for Triangular Mesh Generation*, 2002, through the crates `robust` and `spade`; Yan, Hu and Martin
//! 2004, "Triangulation and Patching".

use anamorph_core::glam::DVec2;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation,
};
use std::collections::{HashMap, HashSet};

/// A polygon with holes. Rings do not repeat their first point at the end. The outer one goes counterclockwise where x goes right and y
/// goes up (positive area), holes the other way.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Region {
    /// The outline.
    pub outer: Vec<DVec2>,
    /// Outlines of what is missing inside.
    pub holes: Vec<Vec<DVec2>>,
}

/// What is wrong with a region. Rings are numbered from 0, the outer one, points in each from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// Fewer than three points.
    #[error("ring {ring} has {count} points; a ring needs at least 3")]
    TooFew {
        /// Which ring.
        ring: usize,
        /// Its points.
        count: usize,
    },
    /// A coordinate that is no number, or too large to be squared.
    #[error(
        "point {point} of ring {ring} has a coordinate that is not finite, or beyond 1e100; remove it"
    )]
    NotFinite {
        /// Which ring.
        ring: usize,
        /// Which point of it.
        point: usize,
    },
    /// Two points in one place.
    #[error(
        "point {point} of ring {ring} and point {other} of ring {other_ring} are both at ({}, {}); remove one",
        place.x, place.y
    )]
    Repeated {
        /// Which ring.
        ring: usize,
        /// Which point of it.
        point: usize,
        /// The other's ring.
        other_ring: usize,
        /// The other point.
        other: usize,
        /// Where.
        place: DVec2,
    },
    /// Edges that meet where they should not.
    #[error(
        "the edges after point {point} of ring {ring} and after point {other} of ring {other_ring} cross or touch; rings must not"
    )]
    Crossing {
        /// Which ring.
        ring: usize,
        /// The point where the edge begins.
        point: usize,
        /// The other's ring.
        other_ring: usize,
        /// Where the other begins.
        other: usize,
    },
    /// A ring that goes round the wrong way, or encloses nothing.
    #[error(
        "ring {ring} has area {area}; the outer ring must have a positive area, holes a negative one"
    )]
    Orientation {
        /// Which ring.
        ring: usize,
        /// Twice half its area: by the shoelace formula.
        area: f64,
    },
    /// A hole that is not inside.
    #[error("ring {ring}, a hole, lies outside the outer ring or in another hole")]
    HoleOutside {
        /// Which ring.
        ring: usize,
    },
    /// The triangulation could not be made.
    #[error("the region could not be triangulated: {reason}")]
    Triangulation {
        /// What stood in the way.
        reason: String,
    },
}

/// Twice the area of a triangle, with the exact sign: positive counterclockwise.
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// The area of a ring by the shoelace formula, about its first point: positive counterclockwise.
pub fn area(ring: &[DVec2]) -> f64 {
    let Some((&first, rest)) = ring.split_first() else {
        return 0.0;
    };
    let sum = rest
        .windows(2)
        .map(|w| (w[0] - first).perp_dot(w[1] - first));
    0.5 * sum.sum::<f64>()
}

/// Whether a point is inside a ring, by the parity of crossings; of points on it nothing is said.
pub fn contains(ring: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a.y > p.y) != (b.y > p.y) && (orientation(a, b, p) > 0.0) == (b.y > a.y) {
            inside = !inside;
        }
    }
    inside
}

/// Whether two closed segments have a point in common.
pub(crate) fn segments_meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let boxes = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    let apart = |p: DVec2, q: DVec2, r: DVec2, s: DVec2| {
        let (x, y) = (orientation(p, q, r), orientation(p, q, s));
        (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0)
    };
    boxes && !apart(a, b, c, d) && !apart(c, d, a, b)
}

impl Region {
    /// All rings, the outer one first.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<DVec2>> {
        core::iter::once(&self.outer).chain(&self.holes)
    }

    /// Points of all rings.
    pub fn len(&self) -> usize {
        self.rings().map(Vec::len).sum()
    }
    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Area without the holes.
    pub fn area(&self) -> f64 {
        self.rings().map(|ring| area(ring)).sum()
    }

    /// Ring and number in it of a point, counted over all rings.
    fn place(&self, mut point: usize) -> (usize, usize) {
        for (ring, points) in self.rings().enumerate() {
            if point < points.len() {
                return (ring, point);
            }
            point -= points.len();
        }
        (0, 0)
    }

    /// The edges of all rings, by numbers of points over all rings.
    pub(crate) fn edges(&self) -> Vec<[usize; 2]> {
        let (mut edges, mut first) = (Vec::new(), 0);
        for ring in self.rings() {
            let count = ring.len();
            edges.extend((0..count).map(|i| [first + i, first + (i + 1) % count]));
            first += count;
        }
        edges
    }

    /// Says what is wrong with a region, if anything is: rings of three points and more that neither cross nor touch, the outer one with
    /// a positive area, holes with a negative one, inside it and outside each other. Exact; n log n but for rings that hug each other.
    ///
    /// # Errors
    /// [`RegionError`].
    pub fn check(&self) -> Result<(), RegionError> {
        for (ring, points) in self.rings().enumerate() {
            if points.len() < 3 {
                let count = points.len();
                return Err(RegionError::TooFew { ring, count });
            }
            let wild = |p: &DVec2| !p.is_finite() || p.abs().max_element() >= 1e100;
            if let Some(point) = points.iter().position(wild) {
                return Err(RegionError::NotFinite { ring, point });
            }
        }
        self.check_repeated()?;
        self.check_crossings()?;
        for (ring, points) in self.rings().enumerate() {
            let area = area(points);
            if (ring == 0 && area <= 0.0) || (ring > 0 && area >= 0.0) {
                return Err(RegionError::Orientation { ring, area });
            }
        }
        // Rings do not touch: one point tells of all.
        for (number, hole) in self.holes.iter().enumerate() {
            let others = self.holes.iter().enumerate().filter(|(i, _)| *i != number);
            let in_hole = others
                .into_iter()
                .any(|(_, other)| contains(other, hole[0]));
            if in_hole || !contains(&self.outer, hole[0]) {
                return Err(RegionError::HoleOutside { ring: number + 1 });
            }
        }
        Ok(())
    }

    fn check_repeated(&self) -> Result<(), RegionError> {
        let mut all: Vec<(DVec2, usize)> = self.rings().flatten().copied().zip(0..).collect();
        all.sort_by(|(a, i), (b, j)| {
            let order = a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
            order.then(i.cmp(j))
        });
        for pair in all.windows(2) {
            if pair[0].0 == pair[1].0 {
                let ((other_ring, other), (ring, point)) =
                    (self.place(pair[0].1), self.place(pair[1].1));
                return Err(RegionError::Repeated {
                    ring,
                    point,
                    other_ring,
                    other,
                    place: pair[0].0,
                });
            }
        }
        Ok(())
    }

    /// A sweep over x with the edges that are open.
    fn check_crossings(&self) -> Result<(), RegionError> {
        let points: Vec<DVec2> = self.rings().flatten().copied().collect();
        let mut edges = self.edges();
        let left = |e: &[usize; 2]| points[e[0]].x.min(points[e[1]].x);
        edges.sort_by(|a, b| left(a).total_cmp(&left(b)).then(a.cmp(b)));
        let mut open: Vec<[usize; 2]> = Vec::new();
        for edge in edges {
            let ends = edge.map(|i| points[i]);
            let x = left(&edge);
            open.retain(|o| points[o[0]].x.max(points[o[1]].x) >= x);
            for other in &open {
                let theirs = other.map(|i| points[i]);
                let shared = edge.iter().any(|i| other.contains(i));
                let meets = if shared {
                    // Neighbours meet in their common point, and nowhere else unless one folds back onto the other.
                    let common = if other.contains(&edge[0]) { 0 } else { 1 };
                    let (corner, own) = (ends[common], ends[1 - common]);
                    let far = if other[0] == edge[common] {
                        theirs[1]
                    } else {
                        theirs[0]
                    };
                    orientation(corner, own, far) == 0.0 && (own - corner).dot(far - corner) > 0.0
                } else {
                    segments_meet(ends, theirs)
                };
                if meets {
                    let ((ring, point), (other_ring, other)) =
                        (self.place(edge[0]), self.place(other[0]));
                    return Err(RegionError::Crossing {
                        ring,
                        point,
                        other_ring,
                        other,
                    });
                }
            }
            open.push(edge);
        }
        Ok(())
    }
}

/// Triangles between points of the plane. Every triangle goes counterclockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlanarMesh {
    /// First the points of the rings, in their order, then the inner ones that were asked for, then those that were added.
    pub points: Vec<DVec2>,
    /// Triangles by numbers of points.
    pub triangles: Vec<[u32; 3]>,
}

/// How fine a triangulation is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Angles to strive for, in degrees, from 0 (no points are added) to 30. Angles between the rings' own edges may be smaller.
    pub smallest_angle: f64,
    /// The largest triangle, as a share of the region's area; infinite for none.
    pub largest_triangle: f64,
    /// At most so many points are added.
    pub most_points: usize,
}

impl Default for Fineness {
    /// Angles of 20°, triangles of any size, at most 20 000 points more.
    fn default() -> Self {
        Self {
            smallest_angle: 20.0,
            largest_triangle: f64::INFINITY,
            most_points: 20_000,
        }
    }
}

/// Coordinates about the middle of all points and at most of size 1, where nothing over- or underflows.
struct Frame {
    middle: DVec2,
    scale: f64,
}

/// The constrained Delaunay triangulation of points with some edges.
fn loaded(
    all: &[DVec2],
    edges: Vec<[usize; 2]>,
) -> Result<(ConstrainedDelaunayTriangulation<Point2<f64>>, Frame), RegionError> {
    let failed = |reason: String| RegionError::Triangulation { reason };
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in all {
        (low, high) = (low.min(*p), high.max(*p));
    }
    let size = (high - low).max_element();
    let scale = 2.0_f64.powi(-(size.log2().ceil() as i32));
    let middle = 0.5 * (low + high);
    // Numbers that the triangulation would take for too small are 0.
    let small = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
    let own = |p: DVec2| {
        let p = (p - middle) * scale;
        Point2::new(small(p.x), small(p.y))
    };
    let mut crossing = None;
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(
        all.iter().map(|p| own(*p)).collect(),
        edges,
        |edge| crossing = Some(edge),
    )
    .map_err(|error| failed(error.to_string()))?;
    if crossing.is_some() || cdt.num_vertices() != all.len() {
        return Err(failed(
            "points stand on each other, or on a ring, to the last digits".to_owned(),
        ));
    }
    Ok((cdt, Frame { middle, scale }))
}

/// The triangles inside of a border whose edges have the inside on their left, with further edges inside; no point is added.
pub(crate) fn constrained(
    points: &[DVec2],
    border: &[[usize; 2]],
    inner: &[[usize; 2]],
) -> Result<Vec<[u32; 3]>, RegionError> {
    let (cdt, _) = loaded(points, border.iter().chain(inner).copied().collect())?;
    let all: Vec<[u32; 3]> = cdt
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .collect();
    let mut sides: HashMap<[u32; 2], usize> = HashMap::new();
    for (number, t) in all.iter().enumerate() {
        for i in 0..3 {
            sides.insert([t[i], t[(i + 1) % 3]], number);
        }
    }
    // From the left of the border, over all edges but those of the border.
    let closed: HashSet<[u32; 2]> = border.iter().map(|e| e.map(|i| i as u32)).collect();
    let mut inside = vec![false; all.len()];
    let mut todo: Vec<usize> = Vec::new();
    for edge in &closed {
        if let Some(&number) = sides.get(edge)
            && !inside[number]
        {
            inside[number] = true;
            todo.push(number);
        }
    }
    while let Some(number) = todo.pop() {
        let t = all[number];
        for i in 0..3 {
            let edge = [t[i], t[(i + 1) % 3]];
            if closed.contains(&edge) {
                continue;
            }
            if let Some(&next) = sides.get(&[edge[1], edge[0]])
                && !inside[next]
            {
                inside[next] = true;
                todo.push(next);
            }
        }
    }
    let kept = all.into_iter().zip(inside);
    let kept = kept.filter(|(t, inside)| {
        let [a, b, c] = t.map(|i| points[i as usize]);
        *inside && orientation(a, b, c) > 0.0
    });
    Ok(kept.map(|(t, _)| t).collect())
}

/// Triangulates the inside of a region; `inner` are points inside that become vertices, too.
///
/// # Errors
/// [`RegionError`]: those of [`Region::check`], and [`RegionError::Triangulation`] for inner points that are not inside or stand on
/// each other.
pub fn triangulate(
    region: &Region,
    inner: &[DVec2],
    fineness: &Fineness,
) -> Result<PlanarMesh, RegionError> {
    region.check()?;
    let failed = |reason: String| RegionError::Triangulation { reason };
    let ring_points = region.len();
    let all: Vec<DVec2> = region.rings().flatten().chain(inner).copied().collect();
    let (mut cdt, frame) = loaded(&all, region.edges())?;
    let scale = frame.scale;
    let area = region.area() * scale * scale;
    let mut parameters = RefinementParameters::<f64>::new()
        .exclude_outer_faces(true)
        .keep_constraint_edges()
        .with_min_required_area(area * 1e-9)
        .with_angle_limit(AngleLimit::from_deg(
            fineness.smallest_angle.clamp(0.0, 30.0),
        ))
        .with_max_additional_vertices(fineness.most_points);
    if fineness.largest_triangle.is_finite() {
        parameters = parameters.with_max_allowed_area(area * fineness.largest_triangle);
    }
    if fineness.smallest_angle <= 0.0 && fineness.largest_triangle.is_infinite() {
        parameters = parameters.with_max_additional_vertices(0);
    }
    let refined = cdt.refine(parameters);
    let outer: HashSet<_> = refined.excluded_faces.into_iter().collect();
    let mut points = all;
    for vertex in cdt.vertices().skip(points.len()) {
        let p = vertex.position();
        points.push(DVec2::new(p.x, p.y) / scale + frame.middle);
    }
    let mut triangles = Vec::new();
    for face in cdt
        .inner_faces()
        .filter(|face| !outer.contains(&face.fix()))
    {
        let [a, b, c] = face.vertices().map(|v| v.fix().index() as u32);
        let corners = [a, b, c].map(|i| points[i as usize]);
        // Slivers between points of a straight piece of a ring.
        if orientation(corners[0], corners[1], corners[2]) > 0.0 {
            triangles.push([a, b, c]);
        }
    }
    let mut used = vec![false; points.len()];
    for &corner in triangles.as_flattened() {
        used[corner as usize] = true;
    }
    if let Some(lost) = used.iter().position(|used| !used) {
        let p = points[lost];
        return Err(failed(if lost < ring_points {
            format!("its outline is too thin at ({}, {})", p.x, p.y)
        } else {
            format!("the inner point ({}, {}) is not inside", p.x, p.y)
        }));
    }
    Ok(PlanarMesh { points, triangles })
}
