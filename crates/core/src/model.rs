//! Models as point-valued functions, and the sites at which warps see them.
//!
//! *Source*: Milliron et al. 2002, §3.1: a model is a point-valued function `M(u)` on an index domain `U`; connectivity
//! is none of the engine's business.

use crate::Space;

/// One index `u` of a model together with its point `M(u)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site<S> {
    /// The index `u`: the number of a vertex, pixel or sample. Fields that live on a model read it.
    pub index: usize,
    /// The point `M(u)` in scene units.
    pub point: S,
}

impl<S> Site<S> {
    /// The site of index `index` at `point`.
    pub fn new(index: usize, point: S) -> Self {
        Self { index, point }
    }
    /// A place in space that belongs to no model (index 0), for warps whose fields live in space.
    pub fn anywhere(point: S) -> Self {
        Self { index: 0, point }
    }
}

/// An axis-parallel box, the bounds of a set of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<S> {
    /// The corner with the smallest coordinates.
    pub min: S,
    /// The corner with the largest coordinates.
    pub max: S,
}

impl<S: Space> Bounds<S> {
    /// The box between two opposite corners, in any order.
    pub fn new(a: S, b: S) -> Self {
        Self {
            min: a.min(b),
            max: a.max(b),
        }
    }

    /// The bounds of the finite points among `points`; `None` if there are none.
    pub fn of(points: &[S]) -> Option<Self> {
        let mut bounds: Option<Self> = None;
        for &p in points.iter().filter(|p| p.is_finite()) {
            bounds = Some(match bounds {
                None => Self { min: p, max: p },
                Some(b) => Self {
                    min: b.min.min(p),
                    max: b.max.max(p),
                },
            });
        }
        bounds
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Edge lengths.
    pub fn size(&self) -> S {
        self.max - self.min
    }

    /// Length of the diagonal: what "the model's size" means wherever a tolerance or a step is relative.
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// The middle.
    pub fn centre(&self) -> S {
        self.min * 0.5 + self.max * 0.5
    }

    /// The point at the given fractions of the edges: all 0 is `min`, all 1 is `max`.
    pub fn at(&self, fraction: S) -> S {
        // Written so that 0 and 1 give the corners exactly.
        S::from_fn(|i| {
            let f = fraction.component(i);
            self.min.component(i) * (1.0 - f) + self.max.component(i) * f
        })
    }

    /// Whether the closed box contains `p`.
    pub fn contains(&self, p: S) -> bool {
        (0..S::DIM).all(|i| {
            self.min.component(i) <= p.component(i) && p.component(i) <= self.max.component(i)
        })
    }
}
