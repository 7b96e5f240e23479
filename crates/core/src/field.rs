//! Scalar fields at sites: strengths, weights and masks.
//!
//! *Source*: Milliron et al. 2002, §3.2 (strength and weighting fields) and §7.3 (their continuity bounds the warp's).
//! A field declares two small facts, its support and its continuity class; culling and guarantees live on them.

use crate::{Bounds, Site, Space};

/// Continuity class of a function of space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Smoothness {
    /// It jumps somewhere.
    Jump,
    /// Derivatives up to this order exist and are continuous; `C(0)` is merely continuous.
    C(u8),
    /// All derivatives exist (C^∞).
    Smooth,
}

impl core::fmt::Display for Smoothness {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Jump => f.write_str("discontinuous"),
            Self::C(order) => write!(f, "C{order}"),
            Self::Smooth => f.write_str("C∞"),
        }
    }
}

/// Whether something is a function of space or of one model's indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Domain {
    /// A function of the point alone: it has a value everywhere and spatial derivatives.
    Space,
    /// Read from one model by index (attributes, geodesic distance): no value off that model, no spatial derivative.
    Model,
}

/// Where something can differ from nothing (a closed set; outside a field is exactly 0, a warp exactly the identity).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support<S> {
    /// Nowhere.
    Nowhere,
    /// Possibly everywhere.
    Everywhere,
    /// Inside a ball.
    Ball {
        /// Centre of the ball.
        centre: S,
        /// Radius of the ball, not negative.
        radius: f64,
    },
    /// Inside an axis-parallel box.
    Box(Bounds<S>),
}

impl<S: Space> Support<S> {
    /// Whether the support contains `p`.
    pub fn contains(&self, p: S) -> bool {
        match self {
            Self::Nowhere => false,
            Self::Everywhere => true,
            Self::Ball { centre, radius } => centre.distance(p) <= *radius,
            Self::Box(bounds) => bounds.contains(p),
        }
    }

    /// A box around the support; `None` if there is no bounded one (or the support is empty).
    pub fn bounds(&self) -> Option<Bounds<S>> {
        match self {
            Self::Nowhere | Self::Everywhere => None,
            Self::Ball { centre, radius } => {
                let r = S::splat(*radius);
                Some(Bounds {
                    min: *centre - r,
                    max: *centre + r,
                })
            }
            Self::Box(bounds) => Some(*bounds),
        }
    }

    /// A support that contains both.
    pub fn union(self, other: Self) -> Self {
        match (self, other) {
            (Self::Nowhere, s) | (s, Self::Nowhere) => s,
            (Self::Everywhere, _) | (_, Self::Everywhere) => Self::Everywhere,
            (a, b) if a == b => a,
            (a, b) => match (a.bounds(), b.bounds()) {
                (Some(a), Some(b)) => Self::Box(a.union(b)),
                _ => Self::Everywhere,
            },
        }
    }

    /// Whether this contains all of `other`, as far as balls and boxes tell: `false` may mean unknown.
    pub fn covers(&self, other: &Self) -> bool {
        match (self, other) {
            (_, Self::Nowhere) | (Self::Everywhere, _) => true,
            (Self::Nowhere, _) | (_, Self::Everywhere) => false,
            (
                Self::Ball { centre, radius },
                Self::Ball {
                    centre: inner,
                    radius: reach,
                },
            ) => centre.distance(*inner) + reach <= *radius,
            (Self::Ball { .. }, Self::Box(b)) => (0..1_usize << S::DIM).all(|corner| {
                self.contains(S::from_fn(|axis| {
                    let end = if corner >> axis & 1 == 1 {
                        b.max
                    } else {
                        b.min
                    };
                    end.component(axis)
                }))
            }),
            (Self::Box(outer), inner) => inner
                .bounds()
                .is_some_and(|b| outer.contains(b.min) && outer.contains(b.max)),
        }
    }

    /// A support that contains what both contain.
    pub fn intersection(self, other: Self) -> Self {
        match (self, other) {
            (Self::Nowhere, _) | (_, Self::Nowhere) => Self::Nowhere,
            (Self::Everywhere, s) | (s, Self::Everywhere) => s,
            (a, b) => match (a.bounds(), b.bounds()) {
                (Some(p), Some(q)) => {
                    let both = Bounds {
                        min: p.min.max(q.min),
                        max: p.max.min(q.max),
                    };
                    if (0..S::DIM).any(|i| both.min.component(i) > both.max.component(i)) {
                        Self::Nowhere
                    } else if a == b {
                        a
                    } else {
                        Self::Box(both)
                    }
                }
                _ => a,
            },
        }
    }
}

/// A scalar at every site.
///
/// Strength fields and masks are finite, usually in [0, 1]. Weight fields are not negative and may be `+∞`: an infinite
/// weight decides alone (errata F6, F9). Never NaN.
pub trait Field<S: Space>: Send + Sync {
    /// The value at a site.
    fn value(&self, site: &Site<S>) -> f64;
    /// Where the value can differ from 0.
    fn support(&self) -> Support<S>;
    /// Continuity as a function of space, edge of the support included.
    fn smoothness(&self) -> Smoothness;

    /// Whether the field is a function of space or of one model.
    fn domain(&self) -> Domain {
        Domain::Space
    }
    /// Whether the value is known to be greater than 0 at every inner point of the support, as a weight must be for its
    /// support to tell where it vanishes (errata F4). `false` may mean unknown.
    fn positive(&self) -> bool {
        self.constant().is_some_and(|value| value > 0.0)
    }
    /// The value, if it is the same everywhere.
    fn constant(&self) -> Option<f64> {
        None
    }
    /// Values at a run of points with indices `first`, `first + 1`, …; `values` is as long as `points`.
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        for (i, (value, &point)) in values.iter_mut().zip(points).enumerate() {
            *value = self.value(&Site::new(first + i, point));
        }
    }
    /// The spatial gradient; by default central differences with a step relative to the model's size `size` (in scene
    /// units). `None` if the field lives on a model.
    fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> {
        if self.domain() == Domain::Model {
            return None;
        }
        let step = crate::difference_step(site.point, size);
        Some(S::from_fn(|i| {
            let (fore, aft) = (
                site.point + S::unit(i) * step,
                site.point - S::unit(i) * step,
            );
            let width = fore.component(i) - aft.component(i);
            (self.value(&Site::new(site.index, fore)) - self.value(&Site::new(site.index, aft)))
                / width
        }))
    }
}

/// A number is the field with that value everywhere.
impl<S: Space> Field<S> for f64 {
    fn value(&self, _: &Site<S>) -> f64 {
        *self
    }
    fn support(&self) -> Support<S> {
        if *self == 0.0 {
            Support::Nowhere
        } else {
            Support::Everywhere
        }
    }
    fn smoothness(&self) -> Smoothness {
        Smoothness::Smooth
    }
    fn constant(&self) -> Option<f64> {
        Some(*self)
    }
    fn values(&self, _: usize, _: &[S], values: &mut [f64]) {
        values.fill(*self);
    }
    fn gradient(&self, _: &Site<S>, _: f64) -> Option<S> {
        Some(S::ZERO)
    }
}

macro_rules! forward_field {
    ($($pointer:ty),*) => {$(
        impl<S: Space, F: Field<S> + ?Sized> Field<S> for $pointer {
            fn value(&self, site: &Site<S>) -> f64 { (**self).value(site) }
            fn support(&self) -> Support<S> { (**self).support() }
            fn smoothness(&self) -> Smoothness { (**self).smoothness() }
            fn domain(&self) -> Domain { (**self).domain() }
            fn positive(&self) -> bool { (**self).positive() }
            fn constant(&self) -> Option<f64> { (**self).constant() }
            fn values(&self, first: usize, points: &[S], values: &mut [f64]) { (**self).values(first, points, values) }
            fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> { (**self).gradient(site, size) }
        }
    )*};
}
forward_field!(&F, Box<F>, std::sync::Arc<F>);
