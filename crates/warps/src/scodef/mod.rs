//! Simple constrained deformations (Scodef): points with displacements, and a function about each that ends at its radius.
//!
//! Computes `p̃ = p + M f(p)`, `f` the functions about the points ([`Basis`]), `M = D F⁺` with the displacements `D` and the matrix
//! `F_ij = f_i(P_j)`. Where the constraints are independent each is met; where they are not, `F⁺` makes the sum of the squares of
//! what is missed as small as possible, by the smallest `M`. As terms of eq. (3): the columns of `M` are translations, the `f_i`
//! their strengths, all weights are 1 and are summed without an average. Points that are not within each other's reach, not even
//! by way of others, are solved for by themselves.
//!
//! Decision: two points in one place with different targets are an error that names both, not a mean of the two.
//!
//! *Source*: P. Borrel, A. Rappoport, *Simple Constrained Deformations for Geometric Modeling and Interactive Design*, ACM TOG
//! 13(2), 1994; P. Borrel, D. Bechmann, *Deformation of N-dimensional Objects*, Symposium on Solid Modeling, 1991; D. Bechmann,
//! *Space Deformation Models Survey*, Computers & Graphics 18(4), 1994.

mod basis;
mod least_squares;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
#[cfg(test)]
mod tests;

use crate::radial::distinct;
use anamorph_core::{
    Address, Affine, Average, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark,
    Site, Smoothness, Space, Support, Warp,
};
use anamorph_features::PointPair;
pub use basis::Basis;
use least_squares::PseudoInverse;

/// Most points of a warp: if all reach each other, their equations take 400 MB while they are solved.
pub const MOST_POINTS: usize = 4096;
/// A constraint is met if it is to this share of the size of all points.
const MET: f64 = 1e-9;
/// Constraints of which the others leave no more than this share count as dependent. Coefficients are at most about its inverse times
/// the displacements, and lose as many digits: a smaller share would make noise of points that nearly coincide.
const DEPENDENT: f64 = 1e-10;

/// A point, where it goes, and the function about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint<S: Space> {
    /// The point and its target.
    pub pair: PointPair<S>,
    /// How its influence falls off.
    pub basis: Basis<S>,
}

/// What is wrong with constraints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScodefError {
    /// No point.
    #[error("there is no point")]
    NoPoint,
    /// A point that is not finite.
    #[error("point {point} has a coordinate that is not finite; give finite numbers")]
    NotFinite {
        /// Number of the point.
        point: usize,
    },
    /// A radius that is not positive.
    #[error("the radius of point {point} is {radius}, and must be greater than 0")]
    Radius {
        /// Number of the point.
        point: usize,
        /// The number given.
        radius: f64,
    },
    /// More points than the equations are solved for.
    #[error("there are {points} points, and at most {most} are served; leave some out")]
    TooMany {
        /// How many.
        points: usize,
        /// How many are served.
        most: usize,
    },
    /// Two sources in one place with different targets.
    #[error(
        "points {first} and {second} have the same source and different targets; remove one, or move it"
    )]
    Coincident {
        /// The one.
        first: usize,
        /// The other.
        second: usize,
    },
    /// Displacements beyond the range of numbers.
    #[error(
        "the displacement of point {point} leaves the range of numbers; scale the model down, or move it less"
    )]
    Overflow {
        /// Number of the point.
        point: usize,
    },
}

/// The constraint that is missed by most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss {
    /// Its number.
    pub point: usize,
    /// By how much, in scene units.
    pub distance: f64,
}

/// A warp by constraints of points.
#[derive(Debug, Clone, PartialEq)]
pub struct ScodefWarp<S: Space> {
    constraints: Vec<Constraint<S>>,
    /// The columns of `M`, one for each constraint.
    coefficients: Vec<S>,
    rank: usize,
    missed: Option<Miss>,
    stretch: Option<f64>,
}

impl<S: Space> ScodefWarp<S> {
    /// The warp that carries the source of every constraint to its target, as near as constraints that depend on each other allow.
    ///
    /// # Errors
    /// [`ScodefError`] for numbers out of range, too many points, and sources in one place with different targets.
    pub fn construct(constraints: Vec<Constraint<S>>) -> Result<Self, ScodefError> {
        check(&constraints)?;
        let (coefficients, rank) = solve(&constraints);
        let mut warp = Self {
            constraints,
            coefficients,
            rank,
            missed: None,
            stretch: None,
        };
        let flaw = warp.coefficients.iter().position(|c| !c.is_finite());
        if let Some(point) = flaw {
            return Err(ScodefError::Overflow { point });
        }
        warp.missed = warp.miss();
        warp.stretch = warp.steepest();
        Ok(warp)
    }

    /// The constraints.
    pub fn constraints(&self) -> &[Constraint<S>] {
        &self.constraints
    }

    /// The columns of `M`: how far each constraint's function moves what it is 1 at.
    pub fn coefficients(&self) -> &[S] {
        &self.coefficients
    }

    /// How many constraints are independent. If not all are, some may be missed.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The constraint that is missed by most, if one is missed by more than a billionth of the size of all.
    pub fn missed(&self) -> Option<Miss> {
        self.missed
    }

    /// Points and arrows for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let pairs = self.constraints.iter().map(|constraint| constraint.pair);
        pairs.flat_map(|pair| pair.marks()).collect()
    }

    /// Calls with the number and the value of each function that is not 0 at a place.
    #[inline]
    fn strengths(&self, p: S, mut each: impl FnMut(usize, f64)) {
        for (i, constraint) in self.constraints.iter().enumerate() {
            let strength = constraint.basis.value(p - constraint.pair.source);
            if strength != 0.0 {
                each(i, strength);
            }
        }
    }

    fn miss(&self) -> Option<Miss> {
        let pairs = || self.constraints.iter().map(|constraint| constraint.pair);
        let all: Vec<S> = pairs()
            .flat_map(|pair| [pair.source, pair.target])
            .collect();
        let size = Bounds::of(&all).map_or(0.0, |bounds| bounds.diagonal());
        let mut worst: Option<Miss> = None;
        for (point, pair) in pairs().enumerate() {
            let distance = self.map(&Site::anywhere(pair.source)).distance(pair.target);
            let more = distance > worst.map_or(MET * size, |miss| miss.distance);
            if more || distance.is_nan() {
                worst = Some(Miss { point, distance });
            }
        }
        worst
    }

    /// A bound of `‖J − I‖`: where a function is not 0, none is but those whose reach meets its own.
    fn steepest(&self) -> Option<f64> {
        let steepness: Vec<f64> = self
            .constraints
            .iter()
            .zip(&self.coefficients)
            .map(|(constraint, c)| constraint.basis.steepest() * c.length())
            .collect();
        let meet = |a: &Constraint<S>, b: &Constraint<S>| {
            let apart = a.pair.source - b.pair.source;
            let reach = a.basis.extents() + b.basis.extents();
            (0..S::DIM).all(|axis| apart.component(axis).abs() < reach.component(axis))
        };
        let mut bound = 0.0_f64;
        for one in &self.constraints {
            let near = self.constraints.iter().zip(&steepness);
            let sum: f64 = near
                .filter(|(other, _)| meet(one, other))
                .map(|(_, steepness)| steepness)
                .sum();
            bound = bound.max(sum);
        }
        let bound = bound * (1.0 + 1e-12);
        bound.is_finite().then_some(bound)
    }
}

/// Refuses what is no input.
fn check<S: Space>(constraints: &[Constraint<S>]) -> Result<(), ScodefError> {
    if constraints.is_empty() {
        return Err(ScodefError::NoPoint);
    }
    if constraints.len() > MOST_POINTS {
        return Err(ScodefError::TooMany {
            points: constraints.len(),
            most: MOST_POINTS,
        });
    }
    for (point, Constraint { pair, basis }) in constraints.iter().enumerate() {
        if !(pair.source.is_finite() && pair.target.is_finite()) {
            return Err(ScodefError::NotFinite { point });
        }
        if let Some(radius) = basis.flaw() {
            return Err(ScodefError::Radius { point, radius });
        }
        if !(pair.target - pair.source).is_finite() {
            return Err(ScodefError::Overflow { point });
        }
    }
    let pairs: Vec<PointPair<S>> = constraints.iter().map(|c| c.pair).collect();
    distinct(&pairs)
        .map(|_| ())
        .map_err(|(first, second)| ScodefError::Coincident { first, second })
}

/// Constraints that reach each other, also by way of others, in order of the first of each group.
fn groups<S: Space>(constraints: &[Constraint<S>]) -> Vec<Vec<usize>> {
    let count = constraints.len();
    let mut group = vec![usize::MAX; count];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for start in 0..count {
        if group[start] != usize::MAX {
            continue;
        }
        group[start] = groups.len();
        let mut members = vec![start];
        let mut next = 0;
        while let Some(&i) = members.get(next) {
            next += 1;
            for (j, other) in constraints.iter().enumerate() {
                let from_i = other.pair.source - constraints[i].pair.source;
                let joined = group[j] == usize::MAX
                    && (constraints[i].basis.value(from_i) != 0.0
                        || other.basis.value(-from_i) != 0.0);
                if joined {
                    group[j] = groups.len();
                    members.push(j);
                }
            }
        }
        members.sort_unstable();
        groups.push(members);
    }
    groups
}

/// The columns of `M`, and how many constraints are independent.
fn solve<S: Space>(constraints: &[Constraint<S>]) -> (Vec<S>, usize) {
    let mut coefficients = vec![S::ZERO; constraints.len()];
    let mut rank = 0;
    for members in groups(constraints) {
        let size = members.len();
        let mut matrix = Vec::with_capacity(size * size);
        for &i in &members {
            let Constraint { pair, basis } = constraints[i];
            let at = |j: &usize| basis.value(constraints[*j].pair.source - pair.source);
            matrix.extend(members.iter().map(at));
        }
        let inverse = PseudoInverse::new(size, matrix, DEPENDENT);
        rank += inverse.rank();
        let columns: Vec<Vec<f64>> = (0..S::DIM)
            .map(|axis| {
                let moves = members.iter().map(|&j| {
                    let pair = constraints[j].pair;
                    (pair.target - pair.source).component(axis)
                });
                inverse.solve(&moves.collect::<Vec<f64>>())
            })
            .collect();
        for (row, &i) in members.iter().enumerate() {
            coefficients[i] = S::from_fn(|axis| columns[axis][row]);
        }
    }
    (coefficients, rank)
}

impl<S: Space> Deformation<S> for ScodefWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        let mut moved = S::ZERO;
        self.strengths(site.point, |i, strength| {
            moved += self.coefficients[i] * strength;
        });
        site.point.moved_by(moved)
    }

    fn facts(&self) -> Facts<S> {
        let acting = self.constraints.iter().zip(&self.coefficients);
        let support = acting
            .filter(|(_, c)| **c != S::ZERO)
            .map(|(constraint, _)| constraint.basis.support(constraint.pair.source))
            .fold(Support::Nowhere, Support::union);
        let mut facts = Facts::identity();
        if support != Support::Nowhere {
            facts.support = support;
            facts.inside = Smoothness::C(2);
            facts.edge = Smoothness::C(2);
            facts.stretch = self.stretch;
        }
        let Some(Miss { point, distance }) = self.missed else {
            return facts;
        };
        facts.with_note(format!(
            "the constraints depend on each other (rank {} of {}) and are met as nearly as possible, point {point} least: it is missed by \
             {distance:.1e}; take smaller radii, or move points apart that are too near to each other",
            self.rank,
            self.constraints.len()
        ))
    }

    /// `J = I + Σ c_i ∇f_iᵀ`.
    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let mut sum = S::Linear::IDENTITY;
        for (Constraint { pair, basis }, &c) in self.constraints.iter().zip(&self.coefficients) {
            let gradient = basis.gradient(site.point - pair.source);
            if gradient != S::ZERO {
                sum = sum + S::Linear::outer(c, gradient);
            }
        }
        Some(sum)
    }
}

impl<S: Space> Warp<S> for ScodefWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.strengths(site.point, |i, strength| {
            let address = Address::of(u32::try_from(i).unwrap_or(u32::MAX));
            out.push(address, strength, 1.0);
        });
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let coefficient = self.coefficients.get(address.feature as usize);
        Affine::translation(coefficient.copied().unwrap_or(S::ZERO) * strength)
    }

    fn average(&self) -> Average {
        Average::Plain
    }

    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.constraints.iter().enumerate();
        all.map(|(feature, Constraint { pair, .. })| Condition {
            feature: u32::try_from(feature).unwrap_or(u32::MAX),
            source: pair.source,
            target: pair.target,
        })
        .collect()
    }
}
