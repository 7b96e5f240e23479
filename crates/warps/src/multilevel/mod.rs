//! Multilevel free-form deformation: a hierarchy of cubic B-spline lattices, each of which fits what those before it leave.
//!
//! Computes `p̃ = p + Σ_k Σ_ij N_ij(p) φ_ij^k` in a box, level `k` with twice as many spans along each axis as the one before. The
//! displacements `φ^k` of its control points are a local formula of what the points still miss: of all that would meet a point alone the
//! smallest, averaged by the squares of the bases where points share control points. A level that does not lessen the misses (in the
//! mean square) adds nothing. As lattices nest, the sum is kept as one lattice of the finest level, and costs one spline to evaluate.
//! Levels go no finer than needed: up to the first at which no control point is shared by two points, where all are met. That is said
//! by the sources alone, so that a binding serves other targets.
//!
//! `one_to_one` composes levels instead: `p̃ = f_k(… f_1(p))`, every `f` a lattice whose control points move less than 0.48 of their
//! spacing along each axis (0.40 in space) and not at all next to the faces of the box, so that no two places meet. A level
//! is repeated while its moves are cut short and the misses fall.
//!
//! *Source*: S. Lee, K.-Y. Chwa, S. Y. Shin, *Image Metamorphosis Using Snakes and Free-Form Deformations*, SIGGRAPH 1995 (levels
//! composed, moves cut at 0.48); S. Lee, G. Wolberg, S. Y. Shin, *Scattered Data Interpolation with Multilevel B-Splines*, IEEE TVCG 3(3),
//! 1997 (levels summed, and refined into one); the bounds are Y. Choi and S. Lee's, *Injectivity Conditions of 2D and 3D Uniform Cubic
//! B-Spline Functions*, Graphical Models 62, 2000. Decisions: what a level may not do to the misses, and where levels end.

mod levels;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;

use crate::cages::MOST_CONTROL_POINTS;
use crate::lattices::bspline::{BsplineLattice, Knots};
use crate::lattices::{LatticeError, PointLattice};
use crate::radial::distinct;
use anamorph_core::{
    Address, Affine, Average, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark,
    Role, Shape, Site, Smoothness, Space, Unmapped, Warp,
};
use anamorph_features::PointPair;
use levels::{Level, coarsest, shape};
use std::sync::Arc;

/// Most levels of a hierarchy.
pub const MOST_LEVELS: usize = 16;
/// How often a level of a composition is repeated, at most; all its lattices together have no more than [`MOST_CONTROL_POINTS`].
const MOST_PASSES: usize = 24;
/// Of the spacing: how far control points of a composition move along an axis, in the plane and in space; a little below the bounds
/// of Choi and Lee.
const FARTHEST: [f64; 2] = [0.48, 0.40];
/// A pass that lessens the misses to more than this share is the last of its level.
const SLOW: f64 = 0.9;
/// Misses below this share of the size of the points count as none.
const MET: f64 = 1e-14;

/// What is wrong with a multilevel deformation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MultilevelError {
    /// No point.
    #[error("there is no point")]
    NoPoint,
    /// A point that is not finite.
    #[error("point {point} has a coordinate that is not finite; give finite numbers")]
    NotFinite {
        /// Number of the point.
        point: usize,
    },
    /// Two sources in one place with different targets.
    #[error("points {first} and {second} have the same source and different targets; remove one")]
    Coincident {
        /// The one.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A source outside the box, or a target that a one-to-one deformation of the box cannot reach.
    #[error("the {what} of point {point} is outside the box; give a larger box or margin")]
    Outside {
        /// `source` or `target`.
        what: &'static str,
        /// Number of the point.
        point: usize,
    },
    /// A number of levels out of range.
    #[error("there are {levels} levels, and must be 1 to {MOST_LEVELS}")]
    Levels {
        /// The number given.
        levels: usize,
    },
    /// A level with too many control points.
    #[error(
        "level {level} would have {points} control points, and at most {MOST_CONTROL_POINTS} are served; ask for fewer levels"
    )]
    TooFine {
        /// Which level, from 1.
        level: usize,
        /// How many control points.
        points: usize,
    },
    /// A tolerance that is negative or not finite.
    #[error("the tolerance is {tolerance}, and must be a length that is not negative")]
    Tolerance {
        /// The number given.
        tolerance: f64,
    },
    /// A box without volume or beyond the range of numbers.
    #[error(transparent)]
    Box(#[from] LatticeError),
}

/// How a hierarchy is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hierarchy {
    /// How many levels at most, 1 to [`MOST_LEVELS`]; `None` for up to 8 in the plane and 7 in space, as far as
    /// [`MOST_CONTROL_POINTS`] allow.
    pub levels: Option<usize>,
    /// How far points may be missed, in scene units: when no point is farther from its target, levels end.
    pub tolerance: f64,
    /// Whether the faces of the box stay, with two derivatives. Points so near to a face that no free control point reaches them are
    /// then missed.
    pub still_faces: bool,
    /// Whether levels are composed, each of them one to one. Faces then stay.
    pub one_to_one: bool,
}

impl Default for Hierarchy {
    fn default() -> Self {
        Self {
            levels: None,
            tolerance: 0.0,
            still_faces: false,
            one_to_one: false,
        }
    }
}

/// What a level has left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Spans of the level along each axis; 1 for an axis the space lacks.
    pub spans: [usize; 3],
    /// How many lattices of these spans there are: 0 where one would not have lessened the misses, 1, or more in a composition.
    pub passes: usize,
    /// The largest distance of a point from its target after this level, in scene units.
    pub largest: f64,
    /// The root of the mean square of the distances.
    pub root_mean_square: f64,
}

/// A multilevel free-form deformation.
pub struct Multilevel<S: Space> {
    pairs: Vec<PointPair<S>>,
    bounds: Bounds<S>,
    /// Applied one after the other; a sum is a single one.
    steps: Vec<Arc<BsplineLattice<S>>>,
    /// The same where there are several.
    stages: Vec<Box<dyn Deformation<S>>>,
    before: Residual,
    residuals: Vec<Residual>,
    composed: bool,
    facts: Facts<S>,
}

/// How far points are from their targets.
fn missed<S: Space>(level: &Level<S>, passes: usize, rest: &[S]) -> Residual {
    let largest = rest.iter().map(|r| r.length()).fold(0.0, f64::max);
    // In units of the largest, so that squares neither vanish nor overflow.
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let squares: f64 = rest.iter().map(|&r| (r / unit).dot(r / unit)).sum();
    #[allow(clippy::cast_precision_loss)]
    let mean = squares / rest.len().max(1) as f64;
    Residual {
        spans: level.spans,
        passes,
        largest,
        root_mean_square: unit * mean.sqrt(),
    }
}

impl<S: Space> Multilevel<S> {
    /// The deformation of the box `bounds` that brings the source of every pair near to its target. An axis along which the box has no
    /// extent gets that of its diagonal.
    ///
    /// # Errors
    /// [`MultilevelError`] for numbers out of range, points outside the box, and sources in one place with different targets.
    pub fn construct(
        pairs: Vec<PointPair<S>>,
        bounds: Bounds<S>,
        hierarchy: Hierarchy,
    ) -> Result<Self, MultilevelError> {
        let kept = check(&pairs, hierarchy)?;
        let still = hierarchy.still_faces || hierarchy.one_to_one;
        let spans = coarsest(bounds, still);
        let count = count_of_levels::<S>(spans, hierarchy.levels)?;
        let level = |number: usize| {
            let spans = core::array::from_fn(|axis| {
                if axis < S::DIM {
                    spans[axis] << number
                } else {
                    1
                }
            });
            Level::new(bounds, spans, still)
        };
        let first = level(0)?;
        let sources: Vec<S> = kept.iter().map(|&i| pairs[i].source).collect();
        let targets: Vec<S> = kept.iter().map(|&i| pairs[i].target).collect();
        for (what, points) in [("source", &sources), ("target", &targets)] {
            let outside = points.iter().position(|&p| first.grid.local(p).is_none());
            if let Some(at) = outside.filter(|_| what == "source" || hierarchy.one_to_one) {
                let point = kept[at];
                return Err(MultilevelError::Outside { what, point });
            }
        }
        let size = Bounds::of(&[sources.as_slice(), &targets].concat())
            .map_or(0.0, |bounds| bounds.diagonal());
        let tolerance = hierarchy.tolerance.max(MET * size);
        let rest: Vec<S> = targets.iter().zip(&sources).map(|(&t, &s)| t - s).collect();
        let mut made = Made {
            steps: Vec::new(),
            before: missed(&first, 0, &rest),
            residuals: Vec::new(),
        };
        if hierarchy.one_to_one {
            made.compose(&sources, &targets, tolerance, count, &level)?;
        } else {
            made.sum(&sources, rest, tolerance, count, &level)?;
        }
        Ok(made.finish(pairs, bounds, hierarchy))
    }

    /// The pairs.
    pub fn pairs(&self) -> &[PointPair<S>] {
        &self.pairs
    }

    /// The box; outside of it nothing moves.
    pub fn bounds(&self) -> Bounds<S> {
        self.bounds
    }

    /// What every level left, the coarsest first, as far as levels were needed.
    pub fn residuals(&self) -> &[Residual] {
        &self.residuals
    }

    /// How far points are from their targets before the first level.
    pub fn before(&self) -> Residual {
        self.before
    }

    /// The lattices that are applied one after the other: a single one for a sum, in which all levels are refined into one.
    pub fn lattices(&self) -> impl ExactSizeIterator<Item = &BsplineLattice<S>> {
        self.steps.iter().map(Arc::as_ref)
    }

    /// Points and arrows and the box for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let mut marks: Vec<Mark<S>> = self.pairs.iter().flat_map(PointPair::<S>::marks).collect();
        let corner = |number: usize| {
            self.bounds.at(S::from_fn(
                |axis| {
                    if number >> axis & 1 == 1 { 1.0 } else { 0.0 }
                },
            ))
        };
        for number in 0..1_usize << S::DIM {
            for axis in (0..S::DIM).filter(|axis| number >> axis & 1 == 0) {
                let edge = vec![corner(number), corner(number | 1 << axis)];
                marks.push(Mark::new(Role::SourceGuide, Shape::Polyline(edge)));
            }
        }
        marks
    }

    /// Calls with address and share of every control point that has one in the move of a point, step by step.
    fn shares(&self, p: S, mut with: impl FnMut(usize, f64)) {
        let (mut here, mut from) = (p, 0);
        for (number, step) in self.steps.iter().enumerate() {
            step.shares(here, |flat, share| with(from + flat, share));
            from += step.displacements().len();
            if number + 1 < self.steps.len() {
                here = step.map(&Site::anywhere(here));
            }
        }
    }
}

/// Refuses what is no input; numbers of the pairs that count.
fn check<S: Space>(
    pairs: &[PointPair<S>],
    hierarchy: Hierarchy,
) -> Result<Vec<usize>, MultilevelError> {
    if pairs.is_empty() {
        return Err(MultilevelError::NoPoint);
    }
    let finite = |pair: &PointPair<S>| {
        let all = [pair.source, pair.target, pair.target - pair.source];
        all.iter().all(|p| p.is_finite())
    };
    if let Some(point) = pairs.iter().position(|pair| !finite(pair)) {
        return Err(MultilevelError::NotFinite { point });
    }
    let tolerance = hierarchy.tolerance;
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(MultilevelError::Tolerance { tolerance });
    }
    distinct(pairs).map_err(|(first, second)| MultilevelError::Coincident { first, second })
}

/// How many levels there may be.
fn count_of_levels<S: Space>(
    spans: [usize; 3],
    asked: Option<usize>,
) -> Result<usize, MultilevelError> {
    let points = |number: usize| {
        let spans = core::array::from_fn(|axis| spans[axis] << number);
        shape::<S>(spans).iter().product::<usize>()
    };
    let most = (0..MOST_LEVELS).take_while(|&number| points(number) <= MOST_CONTROL_POINTS);
    let most = most.count();
    match asked {
        Some(levels) if !(1..=MOST_LEVELS).contains(&levels) => {
            Err(MultilevelError::Levels { levels })
        }
        Some(levels) if levels > most => Err(MultilevelError::TooFine {
            level: most + 1,
            points: points(most),
        }),
        Some(levels) => Ok(levels),
        None => Ok(most.min(if S::DIM == 2 { 8 } else { 7 })),
    }
}

/// A hierarchy while it is made.
struct Made<S: Space> {
    steps: Vec<BsplineLattice<S>>,
    before: Residual,
    residuals: Vec<Residual>,
}

type LevelOf<'a, S> = dyn Fn(usize) -> Result<Level<S>, LatticeError> + 'a;

impl<S: Space> Made<S> {
    /// Levels that are summed, as one lattice.
    fn sum(
        &mut self,
        sources: &[S],
        mut rest: Vec<S>,
        tolerance: f64,
        count: usize,
        level: &LevelOf<'_, S>,
    ) -> Result<(), LatticeError> {
        let mut last = self.before;
        let mut here = level(0)?;
        let mut control = vec![S::ZERO; here.grid.len()];
        for number in 0..count {
            if number > 0 {
                control = here.refined(&control);
                here = level(number)?;
            }
            // A level that is not needed for these targets may be for others, and a binding has to fit.
            if last.largest > tolerance {
                let change = here.fit(sources, &rest);
                let sum: Vec<S> = control.iter().zip(&change).map(|(&c, &d)| c + d).collect();
                let after = sources.iter().zip(&rest);
                let after: Vec<S> = after
                    .map(|(&p, &r)| r - here.displacement(&change, p))
                    .collect();
                let mut now = missed(&here, 1, &after);
                if now.root_mean_square < last.root_mean_square {
                    (control, rest) = (sum, after);
                } else {
                    now = Residual {
                        spans: here.spans,
                        passes: 0,
                        ..last
                    };
                }
                self.residuals.push(now);
                last = now;
            }
            if here.separates(sources) {
                break;
            }
        }
        let lattice = BsplineLattice::construct(here.grid, 3, Knots::Uniform, control)?;
        self.steps.push(lattice);
        Ok(())
    }

    /// Levels that are composed.
    fn compose(
        &mut self,
        sources: &[S],
        targets: &[S],
        tolerance: f64,
        count: usize,
        level: &LevelOf<'_, S>,
    ) -> Result<(), LatticeError> {
        let mut last = self.before;
        let mut points = sources.to_vec();
        for number in 0..count {
            if last.largest <= tolerance {
                break;
            }
            let here = level(number)?;
            let mut passes = 0;
            let made: usize = self.steps.iter().map(|s| s.displacements().len()).sum();
            let room = MOST_CONTROL_POINTS.saturating_sub(made) / here.grid.len();
            while passes < room.min(MOST_PASSES) && last.largest > tolerance {
                let rest: Vec<S> = targets.iter().zip(&points).map(|(&t, &p)| t - p).collect();
                let mut control = here.fit(&points, &rest);
                let cut = cut_short(&here, &mut control);
                let grid = here.grid.clone();
                let lattice = BsplineLattice::construct(grid, 3, Knots::Uniform, control)?;
                let mut moved = points.clone();
                lattice.map_points(0, &mut moved);
                let left: Vec<S> = targets.iter().zip(&moved).map(|(&t, &p)| t - p).collect();
                let now = missed(&here, passes + 1, &left);
                let ratio = now.root_mean_square / last.root_mean_square;
                if ratio.is_nan() || ratio >= 1.0 {
                    break;
                }
                self.steps.push(lattice);
                (points, passes, last) = (moved, passes + 1, now);
                if !cut || ratio > SLOW {
                    break;
                }
            }
            self.residuals.push(Residual {
                spans: here.spans,
                passes,
                ..last
            });
        }
        if self.steps.is_empty() {
            let grid = level(0)?.grid;
            let still = vec![S::ZERO; grid.len()];
            let lattice = BsplineLattice::construct(grid, 3, Knots::Uniform, still)?;
            self.steps.push(lattice);
        }
        Ok(())
    }

    fn finish(
        self,
        pairs: Vec<PointPair<S>>,
        bounds: Bounds<S>,
        hierarchy: Hierarchy,
    ) -> Multilevel<S> {
        let facts = self.facts(hierarchy);
        let steps: Vec<_> = self.steps.into_iter().map(Arc::new).collect();
        let mut stages: Vec<Box<dyn Deformation<S>>> = Vec::new();
        if steps.len() > 1 {
            for step in &steps {
                stages.push(Box::new(Arc::clone(step)));
            }
        }
        Multilevel {
            pairs,
            bounds: steps.first().map_or(bounds, |step| step.grid().bounds()),
            steps,
            stages,
            before: self.before,
            residuals: self.residuals,
            composed: hierarchy.one_to_one,
            facts,
        }
    }

    fn facts(&self, hierarchy: Hierarchy) -> Facts<S> {
        let mut all = self.steps.iter().map(Deformation::facts);
        let Some(mut facts) = all.next() else {
            return Facts::identity();
        };
        let mut count = 1;
        for next in all {
            count += 1;
            facts.edge = facts.edge.min(next.edge);
            facts.inside = facts.inside.min(next.inside);
            facts.support = facts.support.union(next.support);
            facts.stretch = facts.stretch.zip(next.stretch).map(|(a, b)| a + b + a * b);
            facts.upright = facts.upright.and(next.upright);
            facts.one_to_one = facts.one_to_one.and(next.one_to_one);
        }
        if count > 1 {
            let each = |why: String| format!("in each of {count} lattices {why}");
            facts.upright = facts.upright.map(each);
            facts.one_to_one = facts.one_to_one.map(each);
        }
        facts.weights_follow_targets = hierarchy.one_to_one;
        facts.notes = vec![self.told()];
        if facts.edge == Smoothness::Jump {
            facts = facts.with_note(
                "what is outside the box stays: the warp jumps at its faces (a model inside the box does not see it); `faces = \"still\"` \
                 holds them",
            );
        }
        facts
    }

    /// The misses of the levels, in a sentence.
    fn told(&self) -> String {
        let list: Vec<String> = self
            .residuals
            .iter()
            .map(|residual| format!("{:.2e}", residual.largest))
            .collect();
        if list.is_empty() {
            return "every target is where its source is".to_owned();
        }
        format!(
            "points are missed by at most {:.2e} before the first level, and after each by {}",
            self.before.largest,
            list.join(", ")
        )
    }
}

/// Shortens the moves of control points to what keeps a lattice one to one; whether any was.
fn cut_short<S: Space>(level: &Level<S>, control: &mut [S]) -> bool {
    let farthest = FARTHEST[usize::from(S::DIM == 3)];
    let edges = level.grid.edges();
    let spacing = S::from_fn(|axis| {
        #[allow(clippy::cast_precision_loss)]
        let spans = level.spans[axis] as f64;
        edges.column(axis).component(axis) / spans
    });
    let mut cut = false;
    for d in control {
        let shares = (0..S::DIM).map(|axis| d.component(axis).abs() / spacing.component(axis));
        let most = shares.fold(0.0, f64::max);
        if most > farthest {
            *d = *d * (farthest / most);
            cut = true;
        }
    }
    cut
}

impl<S: Space> Deformation<S> for Multilevel<S> {
    fn map(&self, site: &Site<S>) -> S {
        let steps = self.steps.iter();
        steps.fold(site.point, |p, step| step.map(&Site::new(site.index, p)))
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        for step in &self.steps {
            step.map_points(first, points);
        }
        Unmapped::none()
    }

    fn stages(&self) -> &[Box<dyn Deformation<S>>] {
        &self.stages
    }

    fn facts(&self) -> Facts<S> {
        self.facts.clone()
    }

    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        let mut here = *site;
        let mut product = S::Linear::IDENTITY;
        for step in &self.steps {
            product = step.jacobian(&here, size)?.after(&product);
            here.point = step.map(&here);
        }
        Some(product)
    }
}

impl<S: Space> Warp<S> for Multilevel<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.shares(site.point, |number, share| {
            let address = Address::of(u32::try_from(number).unwrap_or(u32::MAX));
            if self.composed {
                out.push(address, share, 1.0);
            } else {
                out.push(address, 1.0, share);
            }
        });
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let mut number = address.feature as usize;
        for step in &self.steps {
            if let Some(&d) = step.displacements().get(number) {
                return Affine::translation(d * strength);
            }
            number -= step.displacements().len();
        }
        Affine::IDENTITY
    }

    fn average(&self) -> Average {
        if self.composed {
            Average::Plain
        } else {
            Average::Weights
        }
    }

    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.pairs.iter().enumerate();
        all.map(|(feature, pair)| Condition {
            feature: u32::try_from(feature).unwrap_or(u32::MAX),
            source: pair.source,
            target: pair.target,
        })
        .collect()
    }
}
