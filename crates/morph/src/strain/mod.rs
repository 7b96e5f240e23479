//! Shapes that become one another by their strains: they bend and grow, and are not squeezed on the way.
//!
//! A [`Pair`] is a mesh in two places. Its strain, eq. (1), says what the elements suffer and nothing of how they turn and move; a [`schemes::Scheme`]
//! says which strains to have between; and a frame has the places whose strains come nearest to these, eq. (4). Turns and moves of the whole
//! are given back by rule ([`Rigid`]). Everything that makes in-betweens of a pair is an [`InBetween`] with a row in [`METHODS`].
//!
//! - [`StrainMorph`]: by the schemes `indifferent`, `linear`, `modified` and `log`;
//! - [`VertexLinear`] and [`AsRigidAsPossible`]: what these are measured against;
//! - [`metrics`]: what a morph is like, frame by frame and over time.
//!
//! ```
//! use anamorph_core::glam::dvec2;
//! use anamorph_morph::strain::{InBetween, Pair, Settings, method};
//!
//! // A square of two triangles is turned by a right angle and drawn out to twice its length.
//! let source = vec![dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(1.0, 1.0), dvec2(0.0, 1.0)];
//! let target = vec![dvec2(0.0, 0.0), dvec2(0.0, 2.0), dvec2(-1.0, 2.0), dvec2(-1.0, 0.0)];
//! let pair = Pair::new(source, target, vec![[0, 1, 2].into(), [0, 2, 3].into()])?;
//! let morph = method("indifferent")?.prepare(&pair, &Settings::default())?;
//! let frame = morph.at(0.5)?;
//! // Half way it is half as much longer, and as wide as it was.
//! assert!((frame.positions[0].distance(frame.positions[1]) - 1.5).abs() < 1e-9);
//! assert!((frame.positions[1].distance(frame.positions[2]) - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004; errata S1 to S13.

mod baselines;
mod body;
mod cells;
mod crossings;
mod energy;
pub mod metrics;
mod morph;
mod newton;
mod pair;
mod placement;
mod rotations;
pub mod schemes;
mod series;
mod settings;
mod stitching;
mod system;
mod tensor;
mod untangle;

pub use baselines::{AsRigidAsPossible, VertexLinear};
pub use crossings::crossings;
pub use energy_of::Energy;
pub use morph::StrainMorph;
pub use pair::{Element, Pair, PairError, Side};
pub use series::{StrainSeries, strains};
pub use settings::{Rigid, Settings, Shear, Solver, Weight, default_scheme};
pub use tensor::Strain;

mod energy_of;

use crate::names::UnknownName;
use anamorph_core::glam::DVec2;
use anamorph_solvers::SolverError;

/// How a frame was found. Of several parts: the sums, and the largest residual.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Solution {
    /// Newton's steps, each with a factor of its own.
    pub steps: usize,
    /// Steps with a factor that was there already.
    pub corrections: usize,
    /// Newton's steps whose Hessian had to be made positive.
    pub projected: usize,
    /// In how many pieces of time the frame was reached, 0 if at once.
    pub subdivisions: usize,
    /// Elements that would have vanished and were held up.
    pub held_up: usize,
    /// Parts whose search came to no end: what is between is the least energy that was found, with nothing turned over.
    pub unfinished: usize,
    /// The energy that is left, eq. (4); of the symmetric energy, divided by the areas.
    pub energy: f64,
    /// The largest component of the energy's gradient, in units of the root of the area; near 0 unless elements were held up, or the search came to no end.
    pub residual: f64,
}

impl Solution {
    fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.corrections += other.corrections;
        self.projected += other.projected;
        self.subdivisions += other.subdivisions;
        self.held_up += other.held_up;
        self.unfinished += other.unfinished;
        self.energy += other.energy;
        self.residual = self.residual.max(other.residual);
    }
}

/// A shape between.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// When, from 0 (the source) to 1 (the target).
    pub time: f64,
    /// Where the vertices are.
    pub positions: Vec<DVec2>,
    /// How that was found.
    pub solution: Solution,
}

/// Why a morph cannot be prepared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// A number that makes no sense.
    #[error("`{name}` is {value}; it has to be {range}")]
    OutOfRange {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// An anchor or pinned vertex that no element has.
    #[error("vertex {vertex} belongs to no element; name one that does, counted from 0")]
    NoAnchor {
        /// The vertex.
        vertex: usize,
    },
    /// Anchors between which there is no direction.
    #[error("the anchors {first} and {second} are at the same place; choose two that are apart")]
    AnchorsTogether {
        /// The vertex that goes straight.
        first: usize,
        /// The vertex that the direction leads to.
        second: usize,
    },
    /// Anchors of different parts.
    #[error(
        "the anchors {first} and {second} are on parts that nothing connects; choose two of one part"
    )]
    AnchorsApart {
        /// The vertex that goes straight.
        first: usize,
        /// The vertex that the direction leads to.
        second: usize,
    },
    /// An element without area in the target.
    #[error(
        "element {element} has no area in the target, which this scheme or the symmetric energy cannot do with; take the scheme `indifferent`"
    )]
    Vanishing {
        /// The element.
        element: usize,
    },
    /// The equations are too large, or cannot be solved.
    #[error("the equations of the mesh cannot be set up: {0}")]
    Solver(#[from] SolverError),
}

/// Why there is no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// A time outside.
    #[error("the time {time} lies outside of 0 to 1")]
    Time {
        /// The time.
        time: f64,
    },
    /// The search came to no end.
    #[error(
        "no frame was found at t = {time}: a residual of {residual:e} is left, element {element} is nearly without area; try another scheme or a better mesh"
    )]
    Stalled {
        /// The time.
        time: f64,
        /// What is left of the gradient.
        residual: f64,
        /// The element of the smallest determinant.
        element: usize,
    },
    /// Newton's plain steps met a Hessian that is not positive definite.
    #[error("the Hessian at t = {time} is not positive definite; take the solver `projected`")]
    Indefinite {
        /// The time.
        time: f64,
    },
    /// An element is turned over.
    #[error(
        "element {element} is turned over at t = {time}; take the solver `projected`, or allow flips"
    )]
    Flipped {
        /// The time.
        time: f64,
        /// The element.
        element: usize,
    },
    /// The equations could not be solved.
    #[error("the equations at t = {time} cannot be solved: {error}")]
    Solver {
        /// The time.
        time: f64,
        /// Why.
        error: SolverError,
    },
}

/// In-betweens of a pair, prepared.
pub trait InBetween: Send + Sync {
    /// The name of the method.
    fn name(&self) -> &'static str;

    /// The shape at `t`, from 0 to 1: the same whatever was asked before.
    ///
    /// # Errors
    /// [`FrameError`].
    fn at(&self, t: f64) -> Result<Frame, FrameError>;

    /// The shapes at many times, in any order, on all cores (feature `parallel`); those of [`InBetween::at`], bit for bit.
    ///
    /// # Errors
    /// [`FrameError`], that of the first time in the list that has one.
    fn frames(&self, times: &[f64]) -> Result<Vec<Frame>, FrameError>;

    /// The strain that is wanted at `t` where the target has the strain `target`, of methods that want one.
    fn wanted(&self, target: Strain, t: f64) -> Option<Strain> {
        let _ = (target, t);
        None
    }
}

fn check_time(time: f64) -> Result<(), FrameError> {
    if (0.0..=1.0).contains(&time) {
        Ok(())
    } else {
        Err(FrameError::Time { time })
    }
}

/// Each time for itself, on all cores.
fn each_alone(method: &dyn InBetween, times: &[f64]) -> Result<Vec<Frame>, FrameError> {
    let mut found: Vec<Option<Result<Frame, FrameError>>> = times.iter().map(|_| None).collect();
    anamorph_raster::parallel::chunks(&mut found, 1, |number, out| {
        if let (Some(out), Some(&time)) = (out.first_mut(), times.get(number)) {
            *out = Some(method.at(time));
        }
    });
    found.into_iter().flatten().collect()
}

type Prepare = fn(&Pair, &Settings) -> Result<Box<dyn InBetween>, PrepareError>;

/// A way to make in-betweens, by name.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    prepare: Prepare,
}

impl Method {
    /// Prepares the in-betweens of a pair.
    ///
    /// # Errors
    /// [`PrepareError`].
    pub fn prepare(
        &self,
        pair: &Pair,
        settings: &Settings,
    ) -> Result<Box<dyn InBetween>, PrepareError> {
        (self.prepare)(pair, settings)
    }
}

macro_rules! by_strain {
    ($name:literal, $title:literal, $scheme:ident) => {
        Method {
            name: $name,
            title: $title,
            prepare: |pair, settings| {
                Ok(Box::new(StrainMorph::new(
                    pair,
                    &schemes::$scheme,
                    settings,
                )?))
            },
        }
    };
}

/// All ways to make in-betweens, the default first.
pub const METHODS: &[Method] = &[
    by_strain!(
        "indifferent",
        "principal stretches go evenly, whatever the axes",
        Indifferent
    ),
    by_strain!(
        "linear",
        "strains, and with them squared lengths, go evenly",
        Linear
    ),
    by_strain!(
        "modified",
        "lengths along the axes go evenly; depends on where the axes lie",
        Modified
    ),
    by_strain!(
        "log",
        "ratios of lengths go evenly; areas are monotone",
        Log
    ),
    Method {
        name: "vertex-linear",
        title: "every vertex goes straight",
        prepare: |pair, _| Ok(Box::new(VertexLinear::new(pair))),
    },
    Method {
        name: "as-rigid-as-possible",
        title: "elements turn and stretch evenly and are stitched together",
        prepare: |pair, settings| Ok(Box::new(AsRigidAsPossible::new(pair, settings)?)),
    },
];

/// The method of that name.
///
/// # Errors
/// [`UnknownName`], which lists the names there are.
pub fn method(name: &str) -> Result<Method, UnknownName> {
    let found = METHODS.iter().find(|method| method.name == name);
    found.copied().ok_or_else(|| UnknownName {
        what: "method of in-betweens",
        name: name.to_owned(),
        known: METHODS
            .iter()
            .map(|method| method.name)
            .collect::<Vec<_>>()
            .join(", "),
    })
}
