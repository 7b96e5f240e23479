//! Radial basis functions: every source point is met, and between them the warp is as smooth as its kernel.
//!
//! Computes `p̃ = p + Σ_j c_j φ(‖p − P_j‖) + a_0 + Σ_k a_k p_k`, the coefficients from `p̃(P_j) = P*_j` and, if there is an
//! affine part, `Σ c_j = 0`, `Σ c_j P_j = 0`. As terms of eq. (3): the coefficients are translations, `φ` and the coordinates of
//! the affine part are their strengths, all weights are 1 and are summed without an average. A smoothing `λ` adds `±λ` to the
//! diagonal of the equations (in units of the kernel over the size of the points, or over its own length), which trades how
//! near the targets are met for how little the warp bends.
//!
//! *Source*: N. Arad, N. Dyn, D. Reisfeld, Y. Yeshurun, *Image Warping by Radial Basis Functions: Application to Facial
//! Expressions*, CVGIP 56(2), 1994; P. Litwinowicz, L. Williams, *Animating Images with Drawings*, SIGGRAPH 1994 (thin plates);
//! which kernels need the affine part is C. A. Micchelli's, *Interpolation of Scattered Data*, Constr. Approx. 2, 1986;
//! smoothing is G. Wahba's, *Spline Models for Observational Data*, SIAM 1990.

mod cells;
#[cfg(feature = "sparse")]
mod compact;
mod dense;
pub mod kernels;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
mod vectors;

use anamorph_core::simd::{Level, dispatch};
use anamorph_core::{
    Address, Affine, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark, Site, Space,
    Support, Unmapped, Warp,
};
use anamorph_features::PointPair;
use cells::Cells;
use dense::Symmetric;
pub use kernels::Kernel;
use kernels::{Formula, Profile, with_profile};

/// Most points of a warp whose kernel has no end: the equations of as many take 270 MB while they are solved.
pub const MOST_POINTS: usize = 4096;
/// Most points of a warp whose kernel ends at a radius, with the feature `sparse`.
pub const MOST_COMPACT_POINTS: usize = 200_000;
/// Points are met to this share of their size, or the warp is refused.
const MET: f64 = 1e-9;
/// Points that are nearer to a line or plane than this share of their size lie on it.
const FLAT: f64 = 1e-10;

/// What is wrong with a warp by radial basis functions.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RadialError {
    /// No point.
    #[error("there is no point")]
    NoPoint,
    /// A point that is not finite.
    #[error("point {point} has a coordinate that is not finite; give finite numbers")]
    NotFinite {
        /// Number of the point.
        point: usize,
    },
    /// More points than the equations are solved for.
    #[error(
        "there are {points} points, and at most {most} are served with this kernel; leave some out"
    )]
    TooMany {
        /// How many.
        points: usize,
        /// How many are served.
        most: usize,
    },
    /// Too many points within each other's radius.
    #[error(
        "within the radius {radius} the {points} points have too many neighbours: their equations would take {entries} numbers, and at most \
         {most} are served; take a smaller radius, or fewer points"
    )]
    TooDense {
        /// The radius in scene units.
        radius: f64,
        /// How many points.
        points: usize,
        /// How many numbers, at least.
        entries: usize,
        /// How many are served.
        most: usize,
    },
    /// A width or radius that is not positive.
    #[error("the {what} of the kernel is {value}, and must be greater than 0")]
    Length {
        /// `width` or `radius`.
        what: &'static str,
        /// The number given.
        value: f64,
    },
    /// A smoothing that is negative or not finite.
    #[error("the smoothing is {smoothing}, and must be a number that is not negative")]
    Smoothing {
        /// The number given.
        smoothing: f64,
    },
    /// A kernel whose equations are open without an affine part.
    #[error(
        "the kernel {kernel} needs an affine part: without one its equations may have no solution"
    )]
    NeedsAffine {
        /// The kernel.
        kernel: &'static str,
    },
    /// Two sources in one place with different targets.
    #[error(
        "points {first} and {second} have the same source and different targets; remove one, or allow for a smoothing"
    )]
    Coincident {
        /// The one.
        first: usize,
        /// The other.
        second: usize,
    },
    /// Sources that do not determine an affine part.
    #[error("{0}")]
    Dependent(Dependence),
    /// Equations that cannot be solved to the digits needed.
    #[error(
        "the equations of the points are too near to singular (condition number {condition:.1e}): point {point} is missed by {miss:.1e}; \
         the nearest two are {first} and {second}; move or remove one of them, take a smaller width or another kernel, or allow for a \
         smoothing"
    )]
    IllConditioned {
        /// An estimate; infinite where no solution was found.
        condition: f64,
        /// The point that is missed by most.
        point: usize,
        /// By how much, in scene units.
        miss: f64,
        /// One of the two points that are nearest to each other.
        first: usize,
        /// The other.
        second: usize,
    },
}

/// Points that lie in too few dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// How many places there are.
    pub places: usize,
    /// How many are needed: one more than the axes of the space.
    pub needed: usize,
    /// Numbers of points that span what all lie on.
    pub span: Vec<usize>,
    /// The size of the points over the farthest distance from what they span; infinite if they lie on it exactly.
    pub condition: f64,
}

impl core::fmt::Display for Dependence {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let names = |list: &[usize]| {
            let names: Vec<String> = list.iter().map(usize::to_string).collect();
            names.join(", ")
        };
        if self.places < self.needed {
            let (places, needed) = (self.places, self.needed);
            let places = if places == 1 {
                "1 place".to_owned()
            } else {
                format!("{places} different places")
            };
            write!(
                f,
                "the points have {places} (those of points {}), and an affine part takes at least {needed}",
                names(&self.span)
            )?;
        } else {
            let what = ["one place", "a line", "a plane"][self.span.len().clamp(1, 3) - 1];
            write!(
                f,
                "all {} source points lie on {what}, that of points {} (condition number {:.1e}), and do not determine an affine part",
                self.places,
                names(&self.span),
                self.condition
            )?;
        }
        write!(
            f,
            "; add points off it, or take a kernel that needs none and no affine part"
        )
    }
}

/// A warp by radial basis functions.
#[derive(Debug, Clone, PartialEq)]
pub struct RadialWarp<S: Space> {
    pairs: Vec<PointPair<S>>,
    kernel: Kernel,
    formula: Formula,
    smoothing: f64,
    condition: f64,
    terms: Terms<S>,
}

/// What is evaluated.
#[derive(Debug, Clone, PartialEq)]
struct Terms<S> {
    /// Places are `(p − centre) · scale`.
    centre: S,
    scale: f64,
    /// Places of the points that are no repetitions.
    places: Vec<S>,
    /// A coefficient for each.
    coefficients: Vec<S>,
    /// Those of 1 and of each coordinate of the place; empty without an affine part.
    affine: Vec<S>,
    /// The points by place, where the kernel ends at 1 and they are many.
    cells: Option<Cells>,
}

impl<S: Space> Terms<S> {
    #[inline(always)]
    fn place(&self, p: S) -> S {
        (p - self.centre) * self.scale
    }
}

/// Squared distance, its terms in order.
#[inline(always)]
fn squared<S: Space>(a: S, b: S) -> f64 {
    let d = a - b;
    let mut sum = d.component(0) * d.component(0);
    for axis in 1..S::DIM {
        sum += d.component(axis) * d.component(axis);
    }
    sum
}

impl<S: Space> RadialWarp<S> {
    /// The warp that carries the source of every pair to its target. With a `smoothing` above 0 it only comes near.
    ///
    /// # Errors
    /// [`RadialError`] for numbers out of range, sources in one place with different targets, sources that do not determine the
    /// affine part, and equations that floating-point numbers cannot solve.
    pub fn construct(
        pairs: Vec<PointPair<S>>,
        kernel: Kernel,
        affine: bool,
        smoothing: f64,
    ) -> Result<Self, RadialError> {
        let kept = check(&pairs, kernel, affine, smoothing)?;
        let sources: Vec<S> = kept.iter().map(|&i| pairs[i].source).collect();
        let bounds = Bounds::of(&sources).ok_or(RadialError::NoPoint)?;
        if affine {
            independent(&sources, &kept)?;
        }
        // A kernel without a length takes any unit.
        let unit = match (kernel.length(), bounds.diagonal()) {
            (Some(length), _) => length,
            (None, size) if size > 0.0 => size,
            _ => 1.0,
        };
        let mut terms = Terms {
            centre: bounds.centre(),
            scale: 1.0 / unit,
            places: Vec::new(),
            coefficients: Vec::new(),
            affine: Vec::new(),
            cells: None,
        };
        terms.places = sources.iter().map(|&p| terms.place(p)).collect();
        let formula = kernel.formula::<S>();
        if kernel.is_compact() && sources.len() >= cells::WORTHWHILE {
            terms.cells = Some(Cells::new(&terms.places));
        }
        let moves: Vec<S> = kept
            .iter()
            .map(|&i| pairs[i].target - pairs[i].source)
            .collect();
        #[cfg(feature = "sparse")]
        let condition = if kernel.is_compact() && sources.len() >= compact::WORTHWHILE {
            compact::solve(&mut terms, &moves, affine, smoothing)?
        } else {
            with_profile!(formula, P => solve::<P, S>(&mut terms, &moves, affine, smoothing))
        };
        #[cfg(not(feature = "sparse"))]
        let condition =
            with_profile!(formula, P => solve::<P, S>(&mut terms, &moves, affine, smoothing));
        if let Some(cells) = &mut terms.cells {
            cells.set(&terms.coefficients);
        }
        let warp = Self {
            pairs,
            kernel,
            formula,
            smoothing,
            condition: condition.unwrap_or(f64::INFINITY),
            terms,
        };
        warp.check_met(&kept, condition.is_some())?;
        Ok(warp)
    }

    /// Refuses a solution that misses the targets.
    fn check_met(&self, kept: &[usize], solved: bool) -> Result<(), RadialError> {
        let all = self
            .pairs
            .iter()
            .flat_map(|pair| [pair.source, pair.target]);
        let size = Bounds::of(&all.collect::<Vec<S>>()).map_or(0.0, |bounds| bounds.diagonal());
        let (mut point, mut worst) = (kept[0], 0.0_f64);
        if self.smoothing == 0.0 || !solved {
            let mut moved: Vec<S> = self.pairs.iter().map(|pair| pair.source).collect();
            self.map_points(0, &mut moved);
            for (i, (pair, moved)) in self.pairs.iter().zip(moved).enumerate() {
                let miss = moved.distance(pair.target);
                if miss > worst || miss.is_nan() {
                    (point, worst) = (i, miss);
                }
            }
        }
        if solved && worst <= MET * size {
            return Ok(());
        }
        let places = &self.terms.places;
        let mut nearest = (f64::INFINITY, 0, 0);
        for i in 0..places.len() {
            // Points farther than the radius from all others are no trouble.
            self.terms.in_reach(places[i], |j| {
                let q = squared(places[i], places[j]);
                if j < i && q < nearest.0 {
                    nearest = (q, j, i);
                }
            });
        }
        Err(RadialError::IllConditioned {
            condition: self.condition,
            point,
            miss: worst,
            first: kept[nearest.1],
            second: kept[nearest.2],
        })
    }

    /// The pairs.
    pub fn pairs(&self) -> &[PointPair<S>] {
        &self.pairs
    }

    /// An estimate of the condition number of the equations.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Points and arrows for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        self.pairs.iter().flat_map(PointPair::<S>::marks).collect()
    }

    /// A bound of `‖J − I‖`: the sum of those of the terms.
    fn stretch<P: Profile>(&self) -> Option<f64> {
        let steepest = P::STEEPEST?;
        let kernels: f64 = self
            .terms
            .coefficients
            .iter()
            .map(|c| c.length() * steepest)
            .sum();
        let affine: f64 = self.terms.affine.iter().skip(1).map(|a| a.dot(*a)).sum();
        Some((kernels + affine.sqrt()) * self.terms.scale * (1.0 + 1e-12))
    }
}

/// Numbers of the points that count: of several in one place the first. Refuses what is no input.
fn check<S: Space>(
    pairs: &[PointPair<S>],
    kernel: Kernel,
    affine: bool,
    smoothing: f64,
) -> Result<Vec<usize>, RadialError> {
    if pairs.is_empty() {
        return Err(RadialError::NoPoint);
    }
    let finite = |pair: &PointPair<S>| pair.source.is_finite() && pair.target.is_finite();
    if let Some(point) = pairs.iter().position(|pair| !finite(pair)) {
        return Err(RadialError::NotFinite { point });
    }
    let most = if kernel.is_compact() && cfg!(feature = "sparse") {
        MOST_COMPACT_POINTS
    } else {
        MOST_POINTS
    };
    if pairs.len() > most {
        let points = pairs.len();
        return Err(RadialError::TooMany { points, most });
    }
    if let Some(value) = kernel.length().filter(|l| !(*l > 0.0 && l.is_finite())) {
        let what = if matches!(kernel, Kernel::Wendland { .. }) {
            "radius"
        } else {
            "width"
        };
        return Err(RadialError::Length { what, value });
    }
    if !(smoothing >= 0.0 && smoothing.is_finite()) {
        return Err(RadialError::Smoothing { smoothing });
    }
    if kernel.needs_affine() && !affine {
        return Err(RadialError::NeedsAffine {
            kernel: kernel.name(),
        });
    }
    if smoothing > 0.0 {
        return Ok((0..pairs.len()).collect());
    }
    distinct(pairs).map_err(|(first, second)| RadialError::Coincident { first, second })
}

/// Of several pairs with the same source the first; two of them with different targets are an error.
pub(crate) fn distinct<S: Space>(pairs: &[PointPair<S>]) -> Result<Vec<usize>, (usize, usize)> {
    let key = |i: usize| pairs[i].source;
    let order = |&i: &usize, &j: &usize| {
        let axes = (0..S::DIM).map(|axis| (key(i).component(axis), key(j).component(axis)));
        // 0 and −0 are one place.
        let mut unequal = axes.filter_map(|(a, b)| a.partial_cmp(&b).filter(|o| o.is_ne()));
        unequal.next().unwrap_or_else(|| i.cmp(&j))
    };
    let mut sorted: Vec<usize> = (0..pairs.len()).collect();
    sorted.sort_by(order);
    let mut kept = Vec::new();
    for run in sorted.chunk_by(|&i, &j| key(i) == key(j)) {
        let first = run[0];
        if let Some(&second) = run
            .iter()
            .find(|&&i| pairs[i].target != pairs[first].target)
        {
            return Err((first, second));
        }
        kept.push(first);
    }
    kept.sort_unstable();
    Ok(kept)
}

/// Refuses points that lie on a line or a plane.
fn independent<S: Space>(sources: &[S], kept: &[usize]) -> Result<(), RadialError> {
    let dependent = |span: Vec<usize>, condition: f64| {
        Err(RadialError::Dependent(Dependence {
            places: sources.len(),
            needed: S::DIM + 1,
            span: span.iter().map(|&i| kept[i]).collect(),
            condition,
        }))
    };
    if sources.len() <= S::DIM {
        return dependent((0..sources.len()).collect(), f64::INFINITY);
    }
    // Greedily: the point that is farthest from what those before it span.
    let mut span = vec![0];
    let mut rest: Vec<S> = sources.iter().map(|&p| p - sources[0]).collect();
    let mut size = 0.0_f64;
    for _ in 0..S::DIM {
        let lengths = rest.iter().map(|r| r.length()).enumerate();
        let far = lengths.max_by(|a, b| a.1.total_cmp(&b.1));
        let (farthest, length) = far.unwrap_or((0, 0.0));
        size = size.max(length);
        if length <= FLAT * size {
            return dependent(span, size / length);
        }
        let Some(direction) = rest[farthest].normalized() else {
            return dependent(span, f64::INFINITY);
        };
        span.push(farthest);
        for r in &mut rest {
            *r = *r - direction * direction.dot(*r);
        }
    }
    Ok(())
}

/// Fills in the coefficients; the condition number, or `None` if there is no solution.
fn solve<P: Profile, S: Space>(
    terms: &mut Terms<S>,
    moves: &[S],
    affine: bool,
    smoothing: f64,
) -> Option<f64> {
    let n = moves.len();
    let extra = if affine { S::DIM + 1 } else { 0 };
    let size = n + extra;
    let mut matrix = vec![0.0; size * size];
    for i in 0..n {
        let row = &mut matrix[i * size..][..size];
        for (entry, &place) in row.iter_mut().zip(&terms.places) {
            *entry = P::value(squared(terms.places[i], place));
        }
        row[i] += P::SIGN * smoothing;
        for k in 0..extra {
            let value = if k == 0 {
                1.0
            } else {
                terms.places[i].component(k - 1)
            };
            matrix[i * size + n + k] = value;
            matrix[(n + k) * size + i] = value;
        }
    }
    let zero = || (vec![S::ZERO; n], vec![S::ZERO; extra]);
    (terms.coefficients, terms.affine) = zero();
    let system = Symmetric::new(size, matrix)?;
    let mut right = vec![0.0; size];
    let columns: Vec<Vec<f64>> = (0..S::DIM)
        .map(|axis| {
            for (r, d) in right.iter_mut().zip(moves) {
                *r = d.component(axis);
            }
            system.solve(&right)
        })
        .collect();
    let row = |i: usize| S::from_fn(|axis| columns[axis][i]);
    let all = (0..size).map(row).collect::<Vec<S>>();
    if !all.iter().all(|c| c.is_finite()) {
        return None;
    }
    terms.affine = all[n..].to_vec();
    terms.coefficients = all[..n].to_vec();
    Some(system.condition())
}

impl<S: Space> Deformation<S> for RadialWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        if self.terms.cells.is_some() {
            let mut point = [site.point];
            self.map_points(site.index, &mut point);
            return point[0];
        }
        with_profile!(self.formula, P => vectors::one::<P, S>(&self.terms, site.point))
    }

    fn map_points(&self, _: usize, points: &mut [S]) -> Unmapped {
        let terms = &self.terms;
        if let Some(cells) = &terms.cells {
            dispatch!(Level::new(), v => cells::run::<_, kernels::Wendland, S>(v, terms, cells, points));
            return Unmapped::none();
        }
        with_profile!(self.formula, P => {
            dispatch!(Level::new(), v => vectors::run::<_, P, S>(v, terms, points));
        });
        Unmapped::none()
    }

    fn facts(&self) -> Facts<S> {
        if self.pairs.iter().all(|pair| pair.source == pair.target) {
            return Facts::identity();
        }
        let (class, compact) = with_profile!(self.formula, P => (P::CLASS, P::COMPACT));
        let mut support = Support::Everywhere;
        if compact && self.terms.affine.is_empty() {
            let radius = 1.0 / self.terms.scale;
            let balls = self.pairs.iter().map(|pair| Support::Ball {
                centre: pair.source,
                radius,
            });
            support = balls.fold(Support::Nowhere, Support::union);
        }
        // The kernel has the tip of a cone at each centre.
        let mut kinks = Vec::new();
        if class < anamorph_core::Smoothness::C(1) {
            kinks.extend(self.pairs.iter().map(|pair| pair.source));
        }
        Facts {
            support,
            inside: class,
            edge: class,
            kinks,
            stretch: with_profile!(self.formula, P => self.stretch::<P>()),
            ..Facts::identity()
        }
    }

    /// `J = I + Σ c_j ∇φ_jᵀ + A`.
    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let terms = &self.terms;
        let place = terms.place(site.point);
        let mut sum = S::Linear::ZERO;
        if let [_, columns @ ..] = terms.affine.as_slice() {
            sum = S::Linear::from_columns(|axis| columns[axis]);
        }
        terms.in_reach(place, |j| {
            let at = terms.places[j];
            let slope = with_profile!(self.formula, P => P::slope(squared(place, at)));
            sum = sum + S::Linear::outer(terms.coefficients[j], (place - at) * slope);
        });
        Some(S::Linear::IDENTITY + sum * terms.scale)
    }
}

impl<S: Space> Warp<S> for RadialWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let terms = &self.terms;
        let place = terms.place(site.point);
        let mut push = |feature: usize, strength: f64| {
            if strength != 0.0 {
                let address = Address::of(u32::try_from(feature).unwrap_or(u32::MAX));
                out.push(address, strength, 1.0);
            }
        };
        let mut near = Vec::new();
        terms.in_reach(place, |j| near.push(j));
        // In the order of the points, not of their cells.
        near.sort_unstable();
        for j in near {
            let q = squared(place, terms.places[j]);
            push(j, with_profile!(self.formula, P => P::value(q)));
        }
        for k in 0..terms.affine.len() {
            let strength = if k == 0 { 1.0 } else { place.component(k - 1) };
            push(terms.places.len() + k, strength);
        }
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let (terms, feature) = (&self.terms, address.feature as usize);
        let affine = || terms.affine.get(feature.checked_sub(terms.places.len())?);
        let coefficient = terms.coefficients.get(feature).or_else(affine);
        Affine::translation(coefficient.copied().unwrap_or(S::ZERO) * strength)
    }

    fn average(&self) -> anamorph_core::Average {
        anamorph_core::Average::Plain
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
