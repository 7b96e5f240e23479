//! The box of a lattice and its local coordinates, shared by all lattice warps.
//!
//! *Source*: T. W. Sederberg and S. R. Parry, *Free-Form Deformation of Solid Geometric Models*, SIGGRAPH 1986 (local
//! coordinates of a parallelepiped); errata F3 (the closed box and its faces).

use anamorph_core::simd::{self, Simd, f64x8, mask64x8, prelude::*};
use anamorph_core::{Bounds, Linear, Mark, Role, Shape, Site, Smoothness, Space, Support};

/// A local coordinate this far outside [0, 1] still counts as on the face: it absorbs the rounding of the change of
/// coordinates when a model touches its lattice box.
pub(crate) const FACE_TOLERANCE: f64 = 1e-12;

/// What is wrong with a lattice.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The edges of the box are null or dependent.
    #[error(
        "the lattice box has no volume: its edges are null or dependent; give it edges in independent directions"
    )]
    Flat,
    /// The box, or its edges, are beyond the range of numbers.
    #[error(
        "the lattice box overflows the range of numbers; scale the model down, or give a smaller box"
    )]
    Overflow,
    /// An axis with too few or too many control points.
    #[error("{points} control points along axis {axis}; {need}")]
    Shape {
        /// Which axis, from 0.
        axis: usize,
        /// How many points were asked for.
        points: usize,
        /// What is allowed.
        need: String,
    },
    /// A list of displacements or frames of the wrong length.
    #[error(
        "{found} entries for {expected} control points; give one for each, the last index fastest"
    )]
    Count {
        /// Number of control points.
        expected: usize,
        /// Length of the list.
        found: usize,
    },
    /// A displacement or frame that is not finite.
    #[error(
        "control point {index} moves to a place that is not finite; move it less, or scale the model down"
    )]
    NotFinite {
        /// Flat index of the control point.
        index: usize,
    },
}

/// The box of a lattice and the number of its control points.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<S: Space> {
    origin: S,
    edges: S::Linear,
    to_local: S::Linear,
    shape: [usize; 3],
}

impl<S: Space> Grid<S> {
    /// The box with a corner at `origin` and the columns of `edges` as edges; `shape` counts control points along each
    /// axis of the space (entries beyond the space's dimension are not read).
    ///
    /// # Errors
    /// [`LatticeError::Overflow`] if anything is not finite, [`LatticeError::Flat`] if the edges are dependent.
    pub fn new(origin: S, edges: S::Linear, shape: &[usize]) -> Result<Self, LatticeError> {
        let finite = (0..S::DIM).all(|axis| edges.column(axis).is_finite());
        if !(finite && origin.is_finite()) {
            return Err(LatticeError::Overflow);
        }
        let to_local = edges.inverted().ok_or(LatticeError::Flat)?;
        let shape = core::array::from_fn(|axis| {
            if axis < S::DIM {
                shape.get(axis).copied().unwrap_or(0)
            } else {
                1
            }
        });
        Ok(Self {
            origin,
            edges,
            to_local,
            shape,
        })
    }

    /// A bound of the norm of the displacement's derivative by the point, from bounds of the lengths of its derivatives by each
    /// local coordinate: they are the columns of a matrix whose rows are turned and scaled by the local coordinates' gradients.
    pub(crate) fn stretch(&self, by_local: [f64; 3]) -> f64 {
        let gradients = self.local_gradients();
        let lengths = (0..S::DIM).map(|axis| by_local[axis] * gradients.column(axis).length());
        let square = (0..S::DIM).all(|a| {
            (0..a).all(|b| {
                let (a, b) = (gradients.column(a), gradients.column(b));
                a.dot(b).abs() <= 1e-12 * a.length() * b.length()
            })
        });
        // Along orthogonal gradients lengths add as sides of a right angle; a little more for rounding.
        let bound = if square {
            lengths.map(|l| l * l).sum::<f64>().sqrt()
        } else {
            lengths.sum()
        };
        bound * (1.0 + 1e-9)
    }

    /// The largest distance between the displacements of neighbours along an axis, each divided by `spacing(index)` of the first.
    pub(crate) fn steepest(
        &self,
        axis: usize,
        displacement: impl Fn(usize) -> S,
        spacing: impl Fn(usize) -> f64,
    ) -> f64 {
        (0..self.len())
            .filter_map(|flat| {
                let triple = self.triple(flat);
                if triple[axis] + 1 >= self.shape[axis] {
                    return None;
                }
                let mut next = triple;
                next[axis] += 1;
                let apart = displacement(self.flat(next)).distance(displacement(flat));
                Some(apart / spacing(triple[axis]))
            })
            .fold(0.0, f64::max)
    }

    /// An axis-parallel box. An axis without extent (a flat model) gets an edge of the length of the diagonal, centred,
    /// so that every model has a lattice around it.
    ///
    /// # Errors
    /// [`LatticeError::Flat`] if the bounds have no extent at all, [`LatticeError::Overflow`] if their size is not finite.
    pub fn around(bounds: Bounds<S>, shape: &[usize]) -> Result<Self, LatticeError> {
        let (size, diagonal) = (bounds.size(), bounds.diagonal());
        if !diagonal.is_finite() {
            return Err(LatticeError::Overflow);
        }
        let thick = |axis: usize| size.component(axis) > 1e-9 * diagonal;
        let min = S::from_fn(|axis| {
            let low = bounds.min.component(axis);
            if thick(axis) {
                low
            } else {
                low - 0.5 * diagonal
            }
        });
        let edges = S::Linear::from_columns(|axis| {
            S::unit(axis)
                * if thick(axis) {
                    size.component(axis)
                } else {
                    diagonal
                }
        });
        Self::new(min, edges, shape)
    }

    /// As [`Grid::around`], with the bounds grown by `margin` on all sides.
    ///
    /// # Errors
    /// As [`Grid::around`].
    pub fn around_with_margin(
        bounds: Bounds<S>,
        margin: f64,
        shape: &[usize],
    ) -> Result<Self, LatticeError> {
        let margin = S::splat(margin);
        let grown = Bounds {
            min: bounds.min - margin,
            max: bounds.max + margin,
        };
        Self::around(grown, shape)
    }

    /// The box from 0 to 1 along every axis.
    #[cfg(feature = "recipe")]
    pub(crate) fn unit(shape: &[usize]) -> Result<Self, LatticeError> {
        Self::new(S::ZERO, S::Linear::IDENTITY, shape)
    }

    /// Corner with all local coordinates 0.
    pub fn origin(&self) -> S {
        self.origin
    }
    /// Edges of the box, as columns.
    pub fn edges(&self) -> &S::Linear {
        &self.edges
    }
    /// Number of control points along each axis; 1 for an axis the space does not have.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }
    /// Number of control points.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }
    /// Whether there is no control point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Flat index of a control point, last index fastest.
    pub fn flat(&self, index: [usize; 3]) -> usize {
        (index[0] * self.shape[1] + index[1]) * self.shape[2] + index[2]
    }
    /// The triple index of a flat one.
    pub fn triple(&self, flat: usize) -> [usize; 3] {
        let (rest, k) = (flat / self.shape[2], flat % self.shape[2]);
        [rest / self.shape[1], rest % self.shape[1], k]
    }

    /// The point with the given local coordinates.
    pub fn place(&self, local: S) -> S {
        self.origin + self.edges.apply(local)
    }

    /// Local coordinates of a point, clamped to the closed box, or `None` outside it.
    #[inline]
    pub fn local(&self, p: S) -> Option<S> {
        let t = self.to_local.apply(p - self.origin);
        let mut clamped = [0.0; 3];
        for (axis, clamped) in clamped.iter_mut().enumerate().take(S::DIM) {
            let t = t.component(axis);
            if !(-FACE_TOLERANCE..=1.0 + FACE_TOLERANCE).contains(&t) {
                return None;
            }
            *clamped = t.clamp(0.0, 1.0);
        }
        Some(S::from_fn(|axis| clamped[axis]))
    }

    /// Local coordinates of eight points, clamped, and which of them are inside; the same operations as
    /// [`Grid::local`].
    #[inline(always)]
    pub(crate) fn local_block<V: Simd>(
        &self,
        v: V,
        block: &simd::Block<V>,
    ) -> ([f64x8<V>; 3], mask64x8<V>) {
        let zero = simd::splat(v, 0.0);
        let one = simd::splat(v, 1.0);
        let (low, high) = (
            simd::splat(v, -FACE_TOLERANCE),
            simd::splat(v, 1.0 + FACE_TOLERANCE),
        );
        let mut q = [zero; 3];
        for axis in 0..S::DIM {
            q[axis] = block[axis] - simd::splat(v, self.origin.component(axis));
        }
        let mut inside = zero.simd_ge(zero);
        let mut local = [zero; 3];
        for (row, local) in local.iter_mut().enumerate().take(S::DIM) {
            let mut t = simd::splat(v, self.to_local.entry(row, 0)) * q[0];
            for (column, q) in q.iter().enumerate().take(S::DIM).skip(1) {
                t += simd::splat(v, self.to_local.entry(row, column)) * *q;
            }
            inside = inside & t.simd_ge(low) & t.simd_le(high);
            // Numbers that are none are outside, so that it does not matter what becomes of them.
            *local = t.max(zero).min(one);
        }
        (local, inside)
    }

    /// The axis-parallel bounds of the box.
    pub fn bounds(&self) -> Bounds<S> {
        let mut bounds = Bounds {
            min: self.origin,
            max: self.origin,
        };
        for corner in 0..1_usize << S::DIM {
            let p = self.place(S::from_fn(
                |axis| if corner >> axis & 1 == 1 { 1.0 } else { 0.0 },
            ));
            bounds = bounds.union(Bounds { min: p, max: p });
        }
        bounds
    }

    /// Where a lattice can move points: the bounds of the box, grown by the tolerance of its faces and by rounding.
    pub(crate) fn support(&self) -> Support<S> {
        let bounds = self.bounds();
        let corner = bounds.min.largest().max(bounds.max.largest());
        let rim = S::from_fn(|axis| {
            let edges: f64 = (0..S::DIM).map(|i| self.edges.entry(axis, i).abs()).sum();
            2.0 * FACE_TOLERANCE * edges + 4.0 * f64::EPSILON * corner
        });
        Support::Box(Bounds {
            min: bounds.min - rim,
            max: bounds.max + rim,
        })
    }

    /// Derivative of the local coordinates by the point, transposed: column `i` is the gradient of coordinate `i`.
    pub(crate) fn local_gradients(&self) -> S::Linear {
        self.to_local.transposed()
    }

    /// Lines and points of the cage through the given control points.
    pub(crate) fn cage(&self, points: &[S], moved: &[bool], target: bool) -> Vec<Mark<S>> {
        let (guide, feature) = if target {
            (Role::TargetGuide, Role::Target)
        } else {
            (Role::SourceGuide, Role::Source)
        };
        let mut marks = Vec::new();
        for axis in 0..S::DIM {
            for start in 0..self.len() {
                let triple = self.triple(start);
                if triple[axis] != 0 || self.shape[axis] < 2 {
                    continue;
                }
                let line = (0..self.shape[axis]).map(|step| {
                    let mut index = triple;
                    index[axis] = step;
                    points[self.flat(index)]
                });
                marks.push(Mark::new(guide, Shape::Polyline(line.collect())));
            }
        }
        // Thousands of dots would hide the model; the cage's crossings tell where they are.
        let many = self.len() > 512;
        for (point, &moved) in points.iter().zip(moved) {
            if moved || !many {
                marks.push(Mark::new(
                    if moved { feature } else { guide },
                    Shape::Point(*point),
                ));
            }
        }
        marks
    }
}

/// The continuity class with which displacements vanish at the faces of the box: derivatives up to that order of
/// `Σ B_i(t) d_i` along the face's normal are zero there. `derivative(axis, order, end)` gives the basis derivatives of
/// that order at `t = 0` (`end` false) or `t = 1`; `value(flat)` is the size of a control point's move, component by
/// component.
///
/// *Source*: errata F3, with the derivation of Sederberg and Parry 1986, §3: the tangential basis functions are
/// independent, so that every line of control points must vanish on its own.
pub(crate) fn face_smoothness<S: Space>(
    grid: &Grid<S>,
    best: Smoothness,
    scale: f64,
    derivative: impl Fn(usize, u8, bool) -> Vec<f64>,
    moves: &dyn Fn(usize) -> Vec<f64>,
) -> Smoothness {
    const HIGHEST: u8 = 31;
    let mut class = best;
    for axis in 0..S::DIM {
        for end in [false, true] {
            let mut vanishing = None;
            for order in 0..=HIGHEST {
                let basis = derivative(axis, order, end);
                if basis.is_empty() {
                    // Every derivative of a polynomial of lower degree: the whole line is still.
                    vanishing = Some(Smoothness::Smooth);
                    break;
                }
                let size = basis.iter().fold(0.0_f64, |m, b| m.max(b.abs())).max(1.0);
                let still = (0..grid.len()).all(|start| {
                    let triple = grid.triple(start);
                    if triple[axis] != 0 {
                        return true;
                    }
                    let mut sum: Vec<f64> = Vec::new();
                    for (step, &b) in basis.iter().enumerate() {
                        let mut index = triple;
                        index[axis] = step;
                        let part = moves(grid.flat(index));
                        sum.resize(part.len(), 0.0);
                        for (s, part) in sum.iter_mut().zip(part) {
                            *s += b * part;
                        }
                    }
                    sum.iter().all(|s| s.abs() <= 1e-12 * size * scale)
                });
                if !still {
                    break;
                }
                vanishing = Some(Smoothness::C(order));
            }
            class = class.min(vanishing.unwrap_or(Smoothness::Jump));
        }
    }
    class
}

/// The value of a site's point as a one-point run of a kernel, so that single sites and runs agree bit for bit.
#[inline]
pub(crate) fn one<S: Space>(site: &Site<S>, kernel: impl FnOnce(&mut [S])) -> S {
    let mut point = [site.point];
    kernel(&mut point);
    point[0]
}
