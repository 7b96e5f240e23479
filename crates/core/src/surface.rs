//! What happens to normals and tangents under a deformation.
//!
//! A tangent is carried by the Jacobian, a normal by its inverse transpose.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984, §2 (tangent and normal
//! transformation rules). We use the cofactor matrix, `det · J⁻ᵀ`, which is defined for singular maps too and keeps the
//! normal on the side that the moved faces' winding says.

use crate::{Linear, Space};

/// The unit normal after a deformation with Jacobian `jacobian`. A normal that the deformation leaves undefined (the
/// surface collapses there) or that is not finite is returned as it was.
pub fn carry_normal<S: Space>(jacobian: &S::Linear, normal: S) -> S {
    jacobian
        .cofactor()
        .apply(normal)
        .normalized()
        .unwrap_or(normal)
}

/// The unit tangent after a deformation with Jacobian `jacobian`; unchanged where it collapses.
pub fn carry_tangent<S: Space>(jacobian: &S::Linear, tangent: S) -> S {
    jacobian.apply(tangent).normalized().unwrap_or(tangent)
}

/// Vertex normals of a triangle mesh in space: sums of face normals weighted by the angle at the vertex (Thürmer and
/// Wüthrich, *Computing vertex normals from polygonal facets*, JGT 3(1), 1998). One unit vector a point; null for points
/// of no face with area. Triangles with an index out of range are left out.
pub fn vertex_normals(points: &[crate::Solid], triangles: &[[u32; 3]]) -> Vec<crate::Solid> {
    use crate::Solid;
    let mut normals = vec![Solid::ZERO; points.len()];
    for triangle in triangles {
        let corner = |i: usize| points.get(triangle[i] as usize).copied();
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else {
            continue;
        };
        let Some(face) = Space::normalized((b - a).cross(c - a)) else {
            continue;
        };
        let corners = [a, b, c];
        for i in 0..3 {
            let (p, q, r) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
            let (Some(u), Some(v)) = (Space::normalized(q - p), Space::normalized(r - p)) else {
                continue;
            };
            normals[triangle[i] as usize] += face * crate::math::acos(Space::dot(u, v));
        }
    }
    for normal in &mut normals {
        *normal = Space::normalized(*normal).unwrap_or(Solid::ZERO);
    }
    normals
}
