//! Headings of a straightest walk: where it starts, and how it goes on behind an edge and a vertex.
//!
//! *Source*: K. Polthier and M. Schmies, *Straightest Geodesics on Polyhedral Surfaces*, in: Mathematical Visualization,
//! Springer, 1998, §3 (definition 4: equal angles on both sides) and §4.

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_core::math;
use core::f64::consts::PI;

use super::unfold::{Entry, Flat, cross};
use super::{PathError, StraightestStop};
use crate::{Corner, Surface, SurfacePoint};

/// Unit directions whose part along the surface is smaller are perpendicular to it.
const PERPENDICULAR: f64 = 1e-12;

/// Angles (radians) this near to π at a boundary vertex are straight: sums of as many angles as a fan has faces.
const STRAIGHT: f64 = 1e-9;

/// A place and direction in a face laid flat.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading {
    pub(super) flat: Flat,
    pub(super) origin: DVec2,
    pub(super) direction: DVec2,
    pub(super) from: Entry,
}

/// The heading behind a side: the next face laid on the same base, with the same direction.
pub(super) fn over_side(
    surface: &Surface,
    flat: &Flat,
    side: usize,
    fraction: f64,
    direction: DVec2,
) -> Result<Heading, StraightestStop> {
    let stop = StraightestStop::NoTangent;
    let edge = flat.edge(surface, side).ok_or(stop)?;
    let next = surface
        .topology()
        .across(flat.face, edge)
        .ok_or_else(|| outside(surface, edge))?;
    let (right, left) = (side, (side + 1) % 3);
    let (a, b) = (flat.corners[right], flat.corners[left]);
    let along = (b - a).try_normalize().ok_or(stop)?;
    // Seen from the next face, which lies to the right of the side, the side runs the other way.
    let laid = Flat::along(surface, next, flat.vertices[left], flat.vertices[right]).ok_or(stop)?;
    let inward = (-cross(along, direction)).max(0.0);
    let direction = DVec2::new(-direction.dot(along), inward);
    Ok(Heading {
        flat: laid,
        origin: DVec2::new(laid.corners[1].x * (1.0 - fraction), 0.0),
        direction: direction.try_normalize().ok_or(stop)?,
        from: Entry::Base,
    })
}

/// Why no face lies behind an edge.
fn outside(surface: &Surface, edge: usize) -> StraightestStop {
    if surface.topology().is_boundary_edge(edge) {
        StraightestStop::Boundary
    } else {
        StraightestStop::NonManifold
    }
}

/// The other end of an edge of a vertex.
fn far_end(surface: &Surface, edge: usize, vertex: usize) -> usize {
    let [a, b] = surface.topology().ends(edge);
    if a == vertex { b } else { a }
}

/// A face laid with a vertex at the origin and the edge by which it is entered, going around, along the x axis.
fn laid_at(surface: &Surface, vertex: usize, corner: &Corner) -> Option<Flat> {
    Flat::along(
        surface,
        corner.face,
        vertex,
        far_end(surface, corner.before, vertex),
    )
}

/// The angle of two vectors in radians, between 0 and π; 0 where one is null.
fn angle(a: DVec2, b: DVec2) -> f64 {
    math::atan2(cross(a, b).abs(), a.dot(b))
}

/// The angle of a face at the vertex that is its first corner; 0 where that has no meaning.
fn corner_angle(flat: &Flat) -> f64 {
    angle(flat.corners[1], flat.corners[2])
}

/// The heading behind a vertex: half the angle of the fan away from the way back.
pub(super) fn through_corner(
    surface: &Surface,
    flat: &Flat,
    corner: usize,
    direction: DVec2,
) -> Result<Heading, StraightestStop> {
    let stop = StraightestStop::NoTangent;
    let vertex = flat.vertices[corner];
    let topology = surface.topology();
    let (fan, own) = topology
        .fans(vertex)
        .find_map(|fan| {
            let own = fan.iter().position(|c| c.face == flat.face)?;
            Some((fan, own))
        })
        .ok_or(stop)?;
    let mut laid = Vec::with_capacity(fan.len());
    for corner in fan {
        let flat = laid_at(surface, vertex, corner).ok_or(stop)?;
        laid.push((flat, corner_angle(&flat)));
    }
    let total: f64 = laid.iter().map(|&(_, angle)| angle).sum();
    if total <= 0.0 {
        return Err(stop);
    }
    // The way back, as an angle from the edge at which the fan begins.
    let before = laid[own].0.vertices[1];
    let spoke = (0..3).find(|&k| flat.vertices[k] == before).ok_or(stop)?;
    let spoke = flat.corners[spoke] - flat.corners[corner];
    let within = angle(spoke, -direction).min(laid[own].1);
    let back = laid[..own].iter().map(|&(_, angle)| angle).sum::<f64>() + within;

    let mut ahead = if topology.is_closed(fan) {
        let half = 0.5 * total;
        if back < half {
            back + half
        } else {
            back - half
        }
    } else {
        let (left, right) = (back, total - back);
        let straight = |side: f64| side >= PI - STRAIGHT;
        if straight(left) && (left <= right || !straight(right)) {
            (left - PI).max(0.0)
        } else if straight(right) {
            (left + PI).min(total)
        } else {
            let edges = [fan.first().map(|c| c.before), fan.last().map(|c| c.after)];
            let at_boundary = |edge: &usize| topology.is_boundary_edge(*edge);
            return Err(if edges.iter().flatten().any(at_boundary) {
                StraightestStop::Boundary
            } else {
                StraightestStop::NonManifold
            });
        }
    };
    let last = laid.len() - 1;
    for (k, (flat, angle)) in laid.into_iter().enumerate() {
        // Faces without an angle are left out; rounding must not lose the last.
        if (ahead <= angle && angle > 0.0) || k == last {
            let (sin, cos) = math::sin_cos(ahead.min(angle));
            return Ok(Heading {
                flat,
                origin: DVec2::ZERO,
                direction: DVec2::new(cos, sin),
                from: Entry::Origin,
            });
        }
        ahead -= angle;
    }
    Err(stop)
}

pub(super) fn in_face(
    surface: &Surface,
    start: SurfacePoint,
    face: usize,
    direction: DVec3,
) -> Result<Option<Heading>, PathError> {
    let flat = Flat::on_longest_side(surface, face).ok_or(PathError::NoTangent)?;
    let part = flat
        .part_of(surface, direction)
        .ok_or(PathError::NoTangent)?;
    Ok(Some(Heading {
        flat,
        origin: flat.place(surface, start),
        direction: tangent(part)?,
        from: Entry::Inside,
    }))
}

/// A part along the surface as a unit vector.
fn tangent(part: DVec2) -> Result<DVec2, PathError> {
    if part.length() > PERPENDICULAR {
        Ok(part.normalize())
    } else {
        Err(PathError::Perpendicular)
    }
}

/// `None` where the direction leaves the surface at once.
pub(super) fn on_edge(
    surface: &Surface,
    start: SurfacePoint,
    edge: usize,
    direction: DVec3,
) -> Result<Option<Heading>, PathError> {
    let [low, high] = surface.topology().ends(edge);
    let faces = surface.topology().edge_faces(edge);
    let laid: Vec<Flat> = faces
        .iter()
        .filter_map(|&face| Flat::along(surface, face, low, high))
        .collect();
    let inward = |flat: &Flat| flat.in_space(surface, DVec2::Y);
    let (a, b) = (surface.positions()[low], surface.positions()[high]);
    let along = (b - a).try_normalize().ok_or(PathError::NoTangent)?;

    let (flat, across) = match laid.as_slice() {
        [one, two] => {
            let across = match (inward(one), inward(two)) {
                (Some(u), Some(v)) => (u - v).try_normalize().unwrap_or(u),
                (Some(u), None) => u,
                (None, Some(v)) => -v,
                (None, None) => return Err(PathError::NoTangent),
            };
            let part = direction.dot(across);
            (if part >= 0.0 { one } else { two }, part.abs())
        }
        faces => {
            let (flat, part) = faces
                .iter()
                .filter_map(|flat| Some((flat, direction.dot(inward(flat)?))))
                .reduce(|best, next| if next.1 > best.1 { next } else { best })
                .ok_or(PathError::NoTangent)?;
            if part < -PERPENDICULAR && faces.len() == 1 {
                return Ok(None);
            }
            (flat, part.max(0.0))
        }
    };
    Ok(Some(Heading {
        flat: *flat,
        origin: flat.place(surface, start),
        direction: tangent(DVec2::new(direction.dot(along), across))?,
        from: Entry::Base,
    }))
}

/// `None` where the direction leaves the surface at once.
pub(super) fn at_vertex(
    surface: &Surface,
    vertex: usize,
    direction: DVec3,
) -> Result<Option<Heading>, PathError> {
    let mut best = nearest_heading(surface, vertex, direction).ok_or(PathError::NoTangent)?;
    if best.tangent <= PERPENDICULAR {
        return Err(PathError::Perpendicular);
    }
    if best.cosine <= PERPENDICULAR && !best.leaves {
        if surface.topology().is_boundary_vertex(vertex) {
            return Ok(None);
        }
        // The surface falls away from the direction on all sides, as at the point of a spike: its level part decides.
        let normal = surface.normal(SurfacePoint::Vertex(vertex));
        let normal = normal.ok_or(PathError::Perpendicular)?;
        let level = direction - normal * normal.dot(direction);
        if level.length() <= PERPENDICULAR {
            return Err(PathError::Perpendicular);
        }
        best = nearest_heading(surface, vertex, level.normalize()).ok_or(PathError::NoTangent)?;
        if best.cosine <= PERPENDICULAR {
            return Err(PathError::Perpendicular);
        }
    }
    Ok((!best.leaves).then_some(best.heading))
}

/// A direction of the surface at a vertex, compared with one in space.
struct NearestHeading {
    heading: Heading,
    /// The cosine of the angle between the two.
    cosine: f64,
    /// Whether the direction in space points over the boundary here.
    leaves: bool,
    /// The largest part that the direction in space has in any face.
    tangent: f64,
}

/// The direction of the surface at a vertex that is nearest to a unit vector of space; the first of several, and `None`
/// where no face has area.
fn nearest_heading(surface: &Surface, vertex: usize, direction: DVec3) -> Option<NearestHeading> {
    let topology = surface.topology();
    let mut best: Option<NearestHeading> = None;
    let mut tangent = 0.0_f64;
    for corner in topology.corners(vertex) {
        let Some(flat) = laid_at(surface, vertex, corner) else {
            continue;
        };
        let Some(part) = flat.part_of(surface, direction) else {
            continue;
        };
        let length = part.length();
        tangent = tangent.max(length);
        let mut consider = |cosine: f64, direction: DVec2, leaves: bool| {
            if best.as_ref().is_none_or(|best| cosine > best.cosine) {
                let heading = Heading {
                    flat,
                    origin: DVec2::ZERO,
                    direction,
                    from: Entry::Origin,
                };
                best = Some(NearestHeading {
                    heading,
                    cosine,
                    leaves,
                    tangent: 0.0,
                });
            }
        };
        let after = flat.corners[2].normalize_or_zero();
        // How far the part is outside of the face, over the edge at which it enters and that at which it is left.
        let over = [-part.y, cross(after, part)];
        if over[0] <= 0.0 && over[1] <= 0.0 && length > PERPENDICULAR {
            consider(length, part / length, false);
            continue;
        }
        let spokes = [(DVec2::X, corner.before), (after, corner.after)];
        for ((spoke, edge), over) in spokes.into_iter().zip(over) {
            let leaves = over > STRAIGHT * length && topology.is_boundary_edge(edge);
            consider(part.dot(spoke), spoke, leaves);
        }
    }
    best.map(|best| NearestHeading { tangent, ..best })
}
