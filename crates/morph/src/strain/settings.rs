//! What can be chosen about in-betweens, by name where there are several of a kind.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004; errata S5, S7, S8, S9 and S11.

use super::schemes::{self, Scheme};
use crate::names::{self, Named, UnknownName};

/// What `γ²` counts in the energy (errata S11).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Shear {
    /// ½: the norm of the tensor, which no rotation changes.
    #[default]
    Tensor,
    /// 1: as eq. (4) is printed.
    Printed,
}

const SHEARS: &[Named<Shear>] = &[
    (
        Shear::Tensor,
        "tensor",
        "½ γ², the norm that no rotation changes",
    ),
    (Shear::Printed, "printed", "γ², as the equation is printed"),
];

/// How a frame's places are found (errata S5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Solver {
    /// Newton's steps with the true Hessian where that is positive definite and a positive one elsewhere, which never turn an element over.
    #[default]
    Projected,
    /// Newton's steps as they come, eq. (11), from the same guess.
    Newton,
    /// The paper's chain of frames: each begins at the one before, eq. (12), then eq. (11).
    Continuation,
}

const SOLVERS: &[Named<Solver>] = &[
    (
        Solver::Projected,
        "projected",
        "Newton's steps that never turn an element over",
    ),
    (Solver::Newton, "newton", "Newton's steps as they come"),
    (
        Solver::Continuation,
        "continuation",
        "a chain of frames, each from the one before",
    ),
];

/// What the points of as-rigid-as-possible in-betweens count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Weight {
    /// All elements alike, as published.
    #[default]
    None,
    /// Elements by their area in the source.
    Area,
}

const WEIGHTS: &[Named<Weight>] = &[
    (Weight::None, "none", "all elements alike"),
    (Weight::Area, "area", "elements by their area in the source"),
];

macro_rules! named {
    ($kind:ident, $table:ident, $what:literal) => {
        impl $kind {
            /// All of them, the default first.
            pub fn all() -> impl Iterator<Item = Self> {
                $table.iter().map(|row| row.0)
            }
            /// Its name.
            pub fn name(self) -> &'static str {
                names::row_of($table, self).0
            }
            /// What it is, in a few words.
            pub fn title(self) -> &'static str {
                names::row_of($table, self).1
            }
            /// The one of that name.
            ///
            /// # Errors
            /// [`UnknownName`], which lists the names there are.
            pub fn by_name(name: &str) -> Result<Self, UnknownName> {
                names::by_name($what, $table, name)
            }
        }
    };
}
named!(Shear, SHEARS, "weight of the shear");
named!(Solver, SOLVERS, "solver");
named!(Weight, WEIGHTS, "weight of elements");

impl Shear {
    pub(crate) fn weight(self) -> f64 {
        match self {
            Self::Tensor => 0.5,
            Self::Printed => 1.0,
        }
    }
}

/// How shapes move and turn as wholes, which strains do not say (errata S7 and S8).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Rigid {
    /// The mean of the elements' unwound rotations, by area, goes evenly; the centroid of the frame's own area goes straight.
    #[default]
    Best,
    /// The first vertex goes straight, and the direction to the second turns evenly. Parts without them move by [`Rigid::Best`].
    Anchors(usize, usize),
}

/// The choices of a morph. Those that a method has no use for it does not look at.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The weight of the shear.
    pub shear: Shear,
    /// How frames are found.
    pub solver: Solver,
    /// Whether the energies of both domains are taken, each divided by its own area, so that A to B is the same as B to A.
    pub symmetric: bool,
    /// How wholes move.
    pub rigid: Rigid,
    /// Whole turns beside the shorter way, counterclockwise.
    pub turns: i32,
    /// A step of Newton that is shorter than this, in units of the root of the area, ends the search.
    pub tolerance: f64,
    /// Whether frames may have elements that are turned over.
    pub allow_flips: bool,
    /// Frames of the chain of [`Solver::Continuation`].
    pub chain: usize,
    /// `N` of eq. (12): the steps from a frame to the next before those of eq. (11).
    pub stages: usize,
    /// The vertex that as-rigid-as-possible in-betweens move straight.
    pub pinned: usize,
    /// What its elements count.
    pub weight: Weight,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            shear: Shear::default(),
            solver: Solver::default(),
            symmetric: false,
            rigid: Rigid::default(),
            turns: 0,
            tolerance: 1e-7,
            allow_flips: false,
            chain: 30,
            stages: 6,
            pinned: 0,
            weight: Weight::default(),
        }
    }
}

/// The scheme that is taken where none is named.
pub fn default_scheme() -> &'static dyn Scheme {
    &schemes::Indifferent
}
