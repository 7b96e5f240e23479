//! Warps: deformations with terms, and the engine that evaluates them.
//!
//! Computes eq. (3), `D(u) = Σ ŵ_i(u) (s_i(u)·T_i)`, as an average of displacements
//! `p̃ = p + Σ ŵ_i ((s_i·T_i)⟨p⟩ − p)`.
//!
//! *Source*: Milliron et al. 2002, eqs. (3) and (4), §3.2–3.5; errata F4 (no weight: stay), F5 (displacements), F6 and
//! F9 (infinite weights decide alone; weights finished from the displacement).

use crate::{Affine, Deformation, Linear, Site, Space, Unmapped};

/// Where on which feature a term sits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Address {
    /// Number of the feature.
    pub feature: u32,
    /// Parameter on the feature (a curve's `v`, an axis coordinate); 0 for features without extent.
    pub at: f64,
}

impl Address {
    /// The address of a feature without extent.
    pub fn of(feature: u32) -> Self {
        Self { feature, at: 0.0 }
    }
}

/// One term's share at a site, from the source side alone: it does not depend on targets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// Which transformation.
    pub address: Address,
    /// Strength `s` at the site.
    pub strength: f64,
    /// Weight `w` at the site, not negative, `+∞` allowed, to be multiplied by `exp(log_scale)` of the list.
    pub weight: f64,
}

/// The influences at one site.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Influences {
    /// The terms, in the order of the features.
    pub list: Vec<Influence>,
    /// Logarithm of a common factor of all weights. A warp whose weights over- or underflow divides the largest out and
    /// leaves its logarithm here (errata F6), so that an ambient weight still compares with them.
    pub log_scale: f64,
}

impl Influences {
    /// Empties the list for the next site.
    pub fn clear(&mut self) {
        self.list.clear();
        self.log_scale = 0.0;
    }
    /// Adds a term.
    #[inline]
    pub fn push(&mut self, address: Address, strength: f64, weight: f64) {
        self.list.push(Influence {
            address,
            strength,
            weight,
        });
    }
}

/// How weighted displacements become one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Average {
    /// Weights are normalized by their sum; where all vanish the point stays (eq. (3), note 6).
    Weights,
    /// As [`Average::Weights`], with an identity term of this weight added once to the denominator (errata F4): restores
    /// continuity at the edge of a support and costs exactness.
    Ambient(f64),
    /// A plain sum, no normalization (radial basis functions, Scodef).
    Plain,
}

/// A deformation with terms `(T, s, w)`.
///
/// Implementors write [`Warp::influences`] and [`Warp::scaled`]; their [`Deformation::map`] is [`evaluate`] and their
/// [`Deformation::map_points`] either [`evaluate_points`] or a kernel that equals it.
pub trait Warp<S: Space>: Deformation<S> {
    /// Appends the site's influences to an empty list. Reads the source side only.
    fn influences(&self, site: &Site<S>, out: &mut Influences);

    /// The transformation at an address multiplied by a strength, `s·T`.
    fn scaled(&self, address: Address, strength: f64) -> Affine<S>;

    /// What [`Warp::scaled`] multiplies strengths at an address by, beside the influence's own: a constant strength, or how much of a
    /// feature is in force.
    fn factor(&self, address: Address) -> f64 {
        let _ = address;
        1.0
    }

    /// The weight as finished by the displacement `(s·T)⟨p⟩ − p` (errata F9). By default the influence's own.
    fn weight(&self, influence: &Influence, displacement: S) -> f64 {
        let _ = displacement;
        influence.weight
    }

    /// How the weighted displacements are averaged.
    fn average(&self) -> Average {
        Average::Weights
    }

    /// Pairs of points that the warp is meant to carry from source to target, for the interpolation verdict.
    fn conditions(&self) -> Vec<Condition<S>> {
        Vec::new()
    }

    /// Eq. (3) from given influences: the image of `point`. Provided; one virtual call a site.
    fn combine(&self, point: S, influences: &Influences) -> S {
        combine(self, point, influences)
    }
}

/// One interpolation condition: this source point should land on that target point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition<S> {
    /// Number of the feature.
    pub feature: u32,
    /// A point of the source feature.
    pub source: S,
    /// Where the feature says it goes.
    pub target: S,
}

/// Eq. (3) at one site: the image of the site's point.
pub fn evaluate<S: Space, W: Warp<S> + ?Sized>(warp: &W, site: &Site<S>) -> S {
    let mut influences = Influences::default();
    warp.influences(site, &mut influences);
    warp.combine(site.point, &influences)
}

/// Eq. (3) over a run of points, reusing one list of influences.
pub fn evaluate_points<S: Space, W: Warp<S> + ?Sized>(
    warp: &W,
    first: usize,
    points: &mut [S],
) -> Unmapped {
    let mut influences = Influences::default();
    for (i, point) in points.iter_mut().enumerate() {
        influences.clear();
        warp.influences(&Site::new(first + i, *point), &mut influences);
        *point = warp.combine(*point, &influences);
    }
    Unmapped::none()
}

/// Share of a term in the average: computed once from all weights.
struct Shares {
    /// Multiplies each weight; 0 when only infinite weights count.
    factor: f64,
    /// The share of each infinite weight; 0 when there is none.
    infinite: f64,
}

impl Shares {
    fn of(weight: f64, shares: &Self) -> f64 {
        if weight == f64::INFINITY {
            shares.infinite
        } else {
            weight * shares.factor
        }
    }

    /// From the sum of finite weights, the number of infinite ones and the kind of average.
    fn new(total: f64, infinite: u32, average: Average, log_scale: f64) -> Option<Self> {
        match average {
            Average::Plain => {
                // A sum without normalization has no use for an infinite weight; let it decide alone all the same.
                if infinite > 0 {
                    return Some(Self {
                        factor: 0.0,
                        infinite: 1.0 / f64::from(infinite),
                    });
                }
                Some(Self {
                    factor: crate::math::exp(log_scale),
                    infinite: 0.0,
                })
            }
            Average::Weights | Average::Ambient(_) => {
                if infinite > 0 {
                    return Some(Self {
                        factor: 0.0,
                        infinite: 1.0 / f64::from(infinite),
                    });
                }
                let ambient = match average {
                    Average::Ambient(weight) if log_scale == 0.0 => weight,
                    Average::Ambient(weight) => weight * crate::math::exp(-log_scale),
                    _ => 0.0,
                };
                let denominator = total + ambient;
                (total > 0.0).then_some(Self {
                    factor: 1.0 / denominator,
                    infinite: 0.0,
                })
            }
        }
    }
}

/// Weights above this are scaled down before they are summed.
const LARGE: f64 = 1e290;
/// A sum of weights below this is scaled up, because its reciprocal would overflow or lose digits.
const SMALL: f64 = 1e-290;

/// Finishes all weights and turns them into shares. Calls `term(influence, affine, share)` in order for every term that counts.
pub(crate) fn for_each_share<S: Space, W: Warp<S> + ?Sized>(
    warp: &W,
    point: S,
    influences: &Influences,
    mut term: impl FnMut(&Influence, &Affine<S>, f64),
) {
    let average = warp.average();
    let one_pass = |i: &Influence| {
        let affine = warp.scaled(i.address, i.strength);
        let weight = warp.weight(i, affine.displacement(point));
        (affine, if weight > 0.0 { weight } else { 0.0 })
    };
    let (mut total, mut infinite, mut largest) = (0.0_f64, 0_u32, 0.0_f64);
    for influence in &influences.list {
        let (_, weight) = one_pass(influence);
        if weight == f64::INFINITY {
            infinite += 1;
        } else {
            total += weight;
            largest = largest.max(weight);
        }
    }
    // Rescale extreme weights by a power of two, which changes no digit of the shares.
    let (mut rescale, mut log_scale) = (1.0, influences.log_scale);
    if infinite == 0
        && average != Average::Plain
        && largest > 0.0
        && !(SMALL..LARGE).contains(&largest)
    {
        rescale = if largest >= LARGE {
            1.0 / crate::math::powi(2.0, 900)
        } else {
            crate::math::powi(2.0, 900)
        };
        log_scale -= crate::math::ln(rescale);
        total = influences
            .list
            .iter()
            .fold(0.0, |sum, i| sum + one_pass(i).1 * rescale);
    }
    let Some(shares) = Shares::new(total, infinite, average, log_scale) else {
        return;
    };
    for influence in &influences.list {
        let (affine, weight) = one_pass(influence);
        let weight = if weight == f64::INFINITY {
            weight
        } else {
            weight * rescale
        };
        let share = Shares::of(weight, &shares);
        if share != 0.0 {
            term(influence, &affine, share);
        }
    }
}

/// The sums of eq. (3) in one pass.
pub(crate) struct Sums<S> {
    moved: S,
    total: f64,
    largest: f64,
}

impl<S: Space> Sums<S> {
    pub(crate) const ZERO: Self = Self {
        moved: S::ZERO,
        total: 0.0,
        largest: 0.0,
    };

    /// Adds a term of positive weight.
    #[inline(always)]
    pub(crate) fn add(&mut self, displacement: S, weight: f64) {
        self.moved += displacement * weight;
        self.total += weight;
        self.largest = self.largest.max(weight);
    }

    /// The averaged displacement; none where a weight is infinite or beyond ordinary size, which takes more care.
    #[inline]
    pub(crate) fn displacement(self, average: Average, log_scale: f64) -> Option<S> {
        if self.largest == 0.0 {
            return Some(S::ZERO);
        }
        let exp = crate::math::exp;
        (SMALL..LARGE)
            .contains(&self.largest)
            .then(|| match (average, log_scale) {
                (Average::Weights, _) => self.moved / self.total,
                (Average::Plain, 0.0) => self.moved,
                (Average::Plain, log_scale) => self.moved * exp(log_scale),
                (Average::Ambient(ambient), 0.0) => self.moved / (self.total + ambient),
                (Average::Ambient(ambient), log_scale) => {
                    self.moved / (self.total + ambient * exp(-log_scale))
                }
            })
    }
}

/// Eq. (3) from given influences; see [`Warp::combine`].
pub fn combine<S: Space, W: Warp<S> + ?Sized>(warp: &W, point: S, influences: &Influences) -> S {
    // One pass for the common case: finite weights of ordinary size.
    let mut sums = Sums::ZERO;
    for influence in &influences.list {
        let displacement = warp
            .scaled(influence.address, influence.strength)
            .displacement(point);
        let weight = warp.weight(influence, displacement);
        if weight > 0.0 {
            sums.add(displacement, weight);
        }
    }
    if let Some(displacement) = sums.displacement(warp.average(), influences.log_scale) {
        return point.moved_by(displacement);
    }
    let mut moved = S::ZERO;
    for_each_share(warp, point, influences, |_, affine, share| {
        moved += affine.displacement(point) * share;
    });
    point.moved_by(moved)
}

/// The deforming function `D(u)` as an affine map: `I + Σ ŵ_i (A_i − I)`.
pub fn deforming_function<S: Space, W: Warp<S> + ?Sized>(warp: &W, site: &Site<S>) -> Affine<S> {
    let mut influences = Influences::default();
    warp.influences(site, &mut influences);
    deforming_function_of(warp, site.point, &influences)
}

/// What is in force at a site: the averaged strength `Σ ŵ_i s_i`, and the sum of the weights before they are normalized.
pub fn in_force<S: Space, W: Warp<S> + ?Sized>(warp: &W, site: &Site<S>) -> (f64, f64) {
    let mut influences = Influences::default();
    warp.influences(site, &mut influences);
    let (mut strength, mut weight) = (0.0, 0.0);
    for influence in &influences.list {
        let affine = warp.scaled(influence.address, influence.strength);
        weight += warp
            .weight(influence, affine.displacement(site.point))
            .max(0.0);
    }
    for_each_share(warp, site.point, &influences, |influence, _, share| {
        strength += share * influence.strength * warp.factor(influence.address);
    });
    if influences.log_scale != 0.0 {
        weight *= crate::math::exp(influences.log_scale);
    }
    (strength, weight)
}

/// The deforming function from given influences.
pub(crate) fn deforming_function_of<S: Space, W: Warp<S> + ?Sized>(
    warp: &W,
    point: S,
    influences: &Influences,
) -> Affine<S> {
    let (mut linear, mut translation) = (S::Linear::ZERO, S::ZERO);
    for_each_share(warp, point, influences, |_, affine, share| {
        linear = linear + (affine.linear - S::Linear::IDENTITY) * share;
        translation += affine.translation * share;
    });
    Affine::new(S::Linear::IDENTITY + linear, translation)
}

macro_rules! forward_warp {
    ($($pointer:ty),*) => {$(
        impl<S: Space, W: Warp<S> + ?Sized> Warp<S> for $pointer {
            fn influences(&self, site: &Site<S>, out: &mut Influences) { (**self).influences(site, out) }
            fn scaled(&self, address: Address, strength: f64) -> Affine<S> { (**self).scaled(address, strength) }
            fn factor(&self, address: Address) -> f64 { (**self).factor(address) }
            fn weight(&self, influence: &Influence, displacement: S) -> f64 { (**self).weight(influence, displacement) }
            fn average(&self) -> Average { (**self).average() }
            fn conditions(&self) -> Vec<Condition<S>> { (**self).conditions() }
            fn combine(&self, point: S, influences: &Influences) -> S { (**self).combine(point, influences) }
        }
    )*};
}
forward_warp!(&W, Box<W>, std::sync::Arc<W>);
