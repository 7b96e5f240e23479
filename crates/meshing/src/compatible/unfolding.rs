//! Laying triangles into a region whose border is held: an energy that unfolds what is folded.
//!
//! Minimizes `Σ (tr JᵀJ + λ(1 + det²J)) / χ(det J)`, `J` the Jacobian of the map from a triangle of the source, enlarged to the size that the
//! target has there, to its place in the target, `χ(D) = (D + √(ε² + D²))/2`. As `ε` goes to 0, a folded triangle costs without bound. Each
//! step solves with a positive definite part of the Hessian, and goes as far along it as the energy falls; once no triangle is folded, none
//! is folded again. The first placement is the discrete harmonic map with equal weights (Tutte).
//!
//! *Source*: V. Garanzha, I. Kaporin, L. Kudryavtseva, F. Protais, N. Ray and D. Sokolov, *Foldover-free maps in 50 lines of code*, ACM TOG 40(4),
//! 2021 (the energy and the rule for ε); W. T. Tutte, *How to Draw a Graph*, 1963. The part of the Hessian that is kept and the sizes are decisions.

use super::mesh::Mesh;
use anamorph_core::glam::{DMat2, DVec2};
use anamorph_solvers::{Arithmetic, Factor, Pattern, SolverError, Symbolic};

/// What the spread of areas counts beside that of angles.
const LAMBDA: f64 = 0.1;
/// Steps while something is folded.
const STEPS: usize = 400;
/// Steps without fewer folded triangles than ever before, after which the search ends.
const PATIENCE: usize = 40;
/// Steps after that.
const POLISH: usize = 12;
/// Largest factor.
const MOST_ENTRIES: usize = 1 << 28;

/// Numbers of unknowns of points; none for those that are held.
fn unknowns(mesh: &Mesh) -> impl Fn(u32) -> Option<usize> + use<> {
    let fixed = mesh.fixed;
    move |point| (point as usize).checked_sub(fixed)
}

/// Places the free points by the harmonic map with equal weights, and gives all points the size that the target has there beside the
/// source: that of the rings' edges, spread the same way.
pub(super) fn harmonic(mesh: &mut Mesh, rings: &[usize]) -> Result<(), SolverError> {
    let free = mesh.source.len() - mesh.fixed;
    mesh.sizes = vec![0.0; mesh.source.len()];
    let mut first = 0;
    for &count in rings {
        for i in 0..count {
            let beside = [first + (i + 1) % count, first + (i + count - 1) % count];
            let length = |points: &[DVec2]| -> f64 {
                let lengths = beside.map(|j| points[j].distance(points[first + i]));
                lengths.iter().sum()
            };
            mesh.sizes[first + i] = (length(&mesh.target) / length(&mesh.source)).ln();
        }
        first += count;
    }
    let mean = mesh.sizes[..first].iter().sum::<f64>() / first.max(1) as f64;
    mesh.sizes[first..].fill(mean);
    if free == 0 {
        return Ok(());
    }
    let unknown = unknowns(mesh);
    let (mut entries, mut values) = (Vec::new(), Vec::new());
    let mut right = [vec![0.0; free], vec![0.0; free], vec![0.0; free]];
    for triangle in &mesh.triangles {
        for side in 0..3 {
            let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
            for (here, there) in [(a, b), (b, a)] {
                let Some(row) = unknown(here) else { continue };
                entries.push((row, row));
                values.push(0.5);
                match unknown(there) {
                    // Both ends come by; the pattern holds a pair once.
                    Some(column) => {
                        entries.push((row, column));
                        values.push(-0.25);
                    }
                    None => {
                        let place = mesh.target[there as usize];
                        right[0][row] += 0.5 * place.x;
                        right[1][row] += 0.5 * place.y;
                        right[2][row] += 0.5 * mesh.sizes[there as usize];
                    }
                }
            }
        }
    }
    let pattern = Pattern::of_entries(free, &entries)?;
    let matrix = pattern.assemble(&values)?;
    let symbolic = Symbolic::of(pattern, Arithmetic::Reproducible, MOST_ENTRIES)?;
    let mut factor = Factor::of(symbolic, &matrix)?;
    for right in &mut right {
        factor.solve_in_place(right)?;
    }
    let [across, down, size] = right;
    for (place, (x, y)) in mesh.target[mesh.fixed..]
        .iter_mut()
        .zip(across.into_iter().zip(down))
    {
        *place = DVec2::new(x, y);
    }
    mesh.sizes[mesh.fixed..].copy_from_slice(&size);
    Ok(())
}

/// A triangle of the source.
struct Element {
    corners: [u32; 3],
    /// Gradients of the barycentric coordinates in the source, enlarged to the size of the target there.
    gradients: [DVec2; 3],
}

/// What the energy is made of at a triangle.
struct Local {
    jacobian: DMat2,
    det: f64,
    chi: f64,
    root: f64,
    sum: f64,
}

impl Element {
    fn at(&self, target: &[DVec2], epsilon: f64) -> Local {
        let mut jacobian = DMat2::ZERO;
        for (&corner, gradient) in self.corners.iter().zip(&self.gradients) {
            let p = target[corner as usize];
            jacobian += DMat2::from_cols(p * gradient.x, p * gradient.y);
        }
        let det = jacobian.determinant();
        let root = (epsilon * epsilon + det * det).sqrt();
        // Without cancellation where it is negative.
        let chi = if det > 0.0 {
            0.5 * (det + root)
        } else {
            0.5 * epsilon * epsilon / (root - det)
        };
        let (x, y) = (jacobian.x_axis, jacobian.y_axis);
        let sum = x.length_squared() + y.length_squared() + LAMBDA * (1.0 + det * det);
        Local {
            jacobian,
            det,
            chi,
            root,
            sum,
        }
    }
}

fn energy(elements: &[Element], target: &[DVec2], epsilon: f64) -> (f64, f64) {
    let (mut total, mut least) = (0.0, f64::INFINITY);
    for element in elements {
        let local = element.at(target, epsilon);
        total += local.sum / local.chi;
        least = least.min(local.det);
    }
    (total, least)
}

/// Unfolds as much as can be, in the mesh's target.
pub(super) fn unfold(mesh: &mut Mesh) -> Result<(), SolverError> {
    let free = mesh.source.len() - mesh.fixed;
    if free == 0 {
        return Ok(());
    }
    let unknown = unknowns(mesh);
    let elements: Vec<Element> = mesh
        .triangles
        .iter()
        .map(|t| {
            let size = t.iter().map(|&i| mesh.sizes[i as usize]).sum::<f64>() / 3.0;
            let places = t.map(|i| mesh.source[i as usize] * size.exp());
            let twice = (places[1] - places[0]).perp_dot(places[2] - places[0]);
            let gradient = |i: usize| (places[(i + 2) % 3] - places[(i + 1) % 3]).perp() / twice;
            Element {
                corners: *t,
                gradients: [gradient(0), gradient(1), gradient(2)],
            }
        })
        .collect();
    // Six by six a triangle; what is held takes no part.
    let mut entries = Vec::new();
    for element in &elements {
        for (i, &a) in element.corners.iter().enumerate() {
            for &b in &element.corners[..=i] {
                if let (Some(a), Some(b)) = (unknown(a), unknown(b)) {
                    for row in 0..2 {
                        for column in 0..2 {
                            if a != b || column <= row {
                                entries.push((2 * a + row, 2 * b + column));
                            }
                        }
                    }
                }
            }
        }
    }
    let pattern = Pattern::of_entries(2 * free, &entries)?;
    let symbolic = Symbolic::of(pattern.clone(), Arithmetic::Reproducible, MOST_ENTRIES)?;
    let mut factor: Option<Factor> = None;
    let mut contributions = Vec::with_capacity(entries.len());
    let mut polish = 0;
    let (_, mut least) = energy(&elements, &mesh.target, 1.0);
    let mut trial = mesh.target.clone();
    let (mut fewest, mut waited) = (usize::MAX, 0);
    for _ in 0..STEPS + POLISH {
        let unfolded = least > 0.0;
        if !unfolded {
            let folded = mesh.folded().len();
            waited += 1;
            if folded < fewest {
                (fewest, waited) = (folded, 0);
            }
            if waited > PATIENCE {
                break;
            }
        }
        if unfolded {
            polish += 1;
            if polish > POLISH {
                break;
            }
        }
        let epsilon = if unfolded {
            1e-12
        } else {
            (1e-10 + 0.04 * least * least).sqrt()
        };
        contributions.clear();
        let mut right = vec![0.0; 2 * free];
        for element in &elements {
            let local = element.at(&mesh.target, epsilon);
            let (x, y) = (local.jacobian.x_axis, local.jacobian.y_axis);
            // Derivative of the determinant by the Jacobian.
            let cofactor = DMat2::from_cols(DVec2::new(y.y, -y.x), DVec2::new(-x.y, x.x));
            let Local {
                det,
                chi,
                root,
                sum,
                ..
            } = local;
            let by_size = 1.0 / chi;
            let by_det = 2.0 * LAMBDA * det / chi - sum / (chi * root);
            let curve = 2.0 * LAMBDA / chi - 4.0 * LAMBDA * det / (chi * root)
                + sum / (chi * root * root) * (1.0 + det / root);
            let curve = curve.max(0.0);
            let turned = element.gradients.map(|g| cofactor * g);
            for (i, &a) in element.corners.iter().enumerate() {
                let Some(row) = unknown(a) else { continue };
                let slope =
                    2.0 * by_size * (local.jacobian * element.gradients[i]) + by_det * turned[i];
                right[2 * row] -= slope.x;
                right[2 * row + 1] -= slope.y;
                for (j, &b) in element.corners[..=i].iter().enumerate() {
                    if unknown(b).is_none() {
                        continue;
                    }
                    let straight = 2.0 * by_size * element.gradients[i].dot(element.gradients[j]);
                    for r in 0..2 {
                        for c in 0..2 {
                            if i != j || c <= r {
                                let same = if r == c { straight } else { 0.0 };
                                contributions.push(same + curve * turned[i][r] * turned[j][c]);
                            }
                        }
                    }
                }
            }
        }
        let values = pattern.assemble(&contributions)?;
        let solved = match &mut factor {
            Some(factor) => factor.renew(&values),
            None => match Factor::of(symbolic.clone(), &values) {
                Ok(made) => {
                    factor = Some(made);
                    Ok(())
                }
                Err(error) => Err(error),
            },
        };
        let step = match (solved, &mut factor) {
            (Ok(()), Some(factor)) => {
                let mut step = right.clone();
                factor.solve_in_place(&mut step).map(|()| step)
            }
            (Err(error), _) => Err(error),
            (Ok(()), None) => break,
        };
        // Numbers beyond all bounds: what has been reached counts.
        let Ok(step) = step else { break };
        let (before, _) = energy(&elements, &mesh.target, epsilon);
        let slope: f64 = step.iter().zip(&right).map(|(s, r)| s * r).sum();
        let mut length = 1.0;
        let mut moved = false;
        for _ in 0..40 {
            for (i, place) in trial[mesh.fixed..].iter_mut().enumerate() {
                let way = DVec2::new(step[2 * i], step[2 * i + 1]);
                *place = mesh.target[mesh.fixed + i] + length * way;
            }
            let (after, lowest) = energy(&elements, &trial, epsilon);
            let falls = after <= before - 1e-4 * length * slope;
            if falls && (!unfolded || lowest > 0.0) {
                core::mem::swap(&mut mesh.target, &mut trial);
                least = lowest;
                // What is folded may have to creep.
                moved = !unfolded || (before - after) > 1e-5 * before;
                break;
            }
            length *= 0.5;
        }
        if !moved {
            break;
        }
    }
    Ok(())
}
