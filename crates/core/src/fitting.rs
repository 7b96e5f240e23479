//! Fitting: the targets of a warp from where places are to go.
//!
//! Computes the changes `δ` of a warp's targets that minimize `Σ_k ω_k ‖p̃_k + Σ_j a_kj δ_j − q_k‖² + λ Σ_j ‖δ_j‖²`: pins
//! `p_k ↦ q_k` with weights `ω`, stiffness `λ`, and `a_kj = Σ ŵ s` over the terms of feature `j` at `p_k`, which is how far
//! the image moves with a target where transformations are translations. With `λ = 0` it is the least change of those that
//! bring the pins nearest.
//!
//! The solver is LSQR with its shorter basis kept orthogonal, which ends after as many steps as the problem has independent
//! rows or columns, whatever they are like, and asks for products with sparse rows only.
//!
//! *Source*: W. M. Hsu, J. F. Hughes, H. Kaufman, *Direct Manipulation of Free-Form Deformations*, SIGGRAPH 1992 (the
//! pseudo-inverse of a lattice's weights), with the weights of Milliron et al. 2002, eq. (3); C. C. Paige, M. A. Saunders,
//! *LSQR*, ACM TOMS 8, 1982; H. D. Simon, H. Zha, *Low-Rank Matrix Approximation Using the Lanczos Bidiagonalization Process*,
//! SIAM J. Sci. Comput. 21, 2000 (orthogonality of one side suffices).

use crate::warp::for_each_share;
use crate::{
    Address, Affine, Average, Condition, Deformation, Domain, Facts, Influence, Influences, Site,
    Space, Unmapped, Warp,
};

/// A place and where it is to go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin<S> {
    /// The place on the model.
    pub source: S,
    /// Where it is to go.
    pub target: S,
    /// How much it counts among the others; greater than 0.
    pub weight: f64,
}

/// What is wrong with pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FitError {
    /// There is none.
    NoPins,
    /// A place, target or weight that is not finite, or a weight that is not positive.
    Number {
        /// Number of the pin.
        pin: usize,
    },
    /// A stiffness that is negative or not finite.
    Stiffness {
        /// The number given.
        stiffness: f64,
    },
    /// A place that no feature of the warp moves, and that is to go elsewhere.
    OutOfReach {
        /// Number of the pin.
        pin: usize,
    },
    /// A warp whose weights follow its targets: its images are not linear in them.
    NotLinear,
}

impl core::fmt::Display for FitError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoPins => write!(f, "there is no pin; give one place and its target at least"),
            Self::Number { pin } => write!(
                f,
                "pin {pin} is not finite, or its weight not greater than 0"
            ),
            Self::Stiffness { stiffness } => write!(
                f,
                "the stiffness is {stiffness}, and must be a number that is not negative"
            ),
            Self::OutOfReach { pin } => write!(
                f,
                "no feature of this warp has a say at pin {pin}, which is to move"
            ),
            Self::NotLinear => write!(
                f,
                "the weights of this warp follow its targets, so that it cannot be fitted"
            ),
        }
    }
}

impl core::error::Error for FitError {}

/// Numbers of the vectors that are kept for orthogonality, at most: beyond, it is an iteration like any other.
const KEPT: usize = 1 << 21;
/// Steps of the iteration at most.
const STEPS: usize = 2048;
/// The iteration ends where what is left has become this share of what there was.
const ENOUGH: f64 = 1e-15;
/// A vector that is this share of the matrix is what orthogonalization leaves of nothing.
const ROUNDING: f64 = 1e-14;

/// The rows of a sparse matrix.
type Rows = Vec<Vec<(u32, f64)>>;

/// How far the image of a site moves with the target of each feature: eq. (3) where transformations are translations.
fn row<S: Space, W: Warp<S> + ?Sized>(warp: &W, site: &Site<S>) -> Vec<(u32, f64)> {
    let mut influences = Influences::default();
    warp.influences(site, &mut influences);
    let mut row: Vec<(u32, f64)> = Vec::new();
    for_each_share(warp, site.point, &influences, |influence, _, share| {
        let feature = influence.address.feature;
        let coefficient = share * influence.strength * warp.factor(influence.address);
        if coefficient != 0.0 {
            match row.iter_mut().find(|(known, _)| *known == feature) {
                Some((_, sum)) => *sum += coefficient,
                None => row.push((feature, coefficient)),
            }
        }
    });
    row
}

/// The changes of the targets of `warp`, one for each of `features`, that bring the pins where they are to go; see the module. The warp's
/// transformations must be translations, displacement by displacement.
///
/// # Errors
/// [`FitError`].
pub fn fit<S: Space, W: Warp<S> + ?Sized>(
    warp: &W,
    features: usize,
    pins: &[Pin<S>],
    stiffness: f64,
) -> Result<Vec<S>, FitError> {
    if pins.is_empty() {
        return Err(FitError::NoPins);
    }
    if !(stiffness >= 0.0 && stiffness.is_finite()) {
        return Err(FitError::Stiffness { stiffness });
    }
    if warp.facts().weights_follow_targets {
        return Err(FitError::NotLinear);
    }
    let mut rows: Rows = Vec::with_capacity(pins.len());
    let mut missing = Vec::with_capacity(pins.len());
    for (number, pin) in pins.iter().enumerate() {
        let finite = pin.source.is_finite() && pin.target.is_finite() && pin.weight.is_finite();
        if !(finite && pin.weight > 0.0) {
            return Err(FitError::Number { pin: number });
        }
        let site = Site::anywhere(pin.source);
        let miss = pin.target - warp.map(&site);
        let mut row = row(warp, &site);
        row.retain(|(feature, _)| (*feature as usize) < features);
        if row.is_empty() && miss != S::ZERO {
            return Err(FitError::OutOfReach { pin: number });
        }
        let root = pin.weight.sqrt();
        row.iter_mut().for_each(|(_, a)| *a *= root);
        rows.push(row);
        missing.push(miss * root);
    }
    let mut changes = vec![S::ZERO; features];
    for axis in 0..S::DIM {
        let wanted: Vec<f64> = missing.iter().map(|m| m.component(axis)).collect();
        let solved = least_squares(&rows, features, &wanted, stiffness.sqrt());
        for (change, value) in changes.iter_mut().zip(solved) {
            *change += S::unit(axis) * value;
        }
    }
    Ok(changes)
}

fn norm(v: &[f64]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest
        * v.iter()
            .map(|x| (x / largest) * (x / largest))
            .sum::<f64>()
            .sqrt()
}

/// Divides by the norm and returns it; a vector that is but rounding beside `scale` becomes nothing.
fn normalize(v: &mut [f64], scale: f64) -> f64 {
    let length = norm(v);
    if length <= scale * ROUNDING {
        v.fill(0.0);
        return 0.0;
    }
    v.iter_mut().for_each(|x| *x /= length);
    length
}

/// Takes from `v` what it has of the vectors before it; twice is enough (W. Kahan).
fn orthogonalize(v: &mut [f64], before: &[Vec<f64>]) {
    for _ in 0..2 {
        for other in before {
            let share: f64 = v.iter().zip(other).map(|(a, b)| a * b).sum();
            v.iter_mut().zip(other).for_each(|(a, b)| *a -= share * b);
        }
    }
}

/// `√(a² + b²)` of numbers of ordinary size.
fn root(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// The `x` of least length that minimizes `‖A x − b‖² + damp² ‖x‖²`: LSQR, in the notation of its authors.
fn least_squares(rows: &Rows, columns: usize, wanted: &[f64], damp: f64) -> Vec<f64> {
    let mut x = vec![0.0; columns];
    let mut u = wanted.to_vec();
    let mut v = vec![0.0; columns];
    let beta = normalize(&mut u, 0.0);
    if beta == 0.0 {
        return x;
    }
    // A v − α u, in place of u.
    let forward = |v: &[f64], u: &mut [f64], alpha: f64| {
        for (row, u) in rows.iter().zip(u) {
            *u = row.iter().map(|&(j, a)| a * v[j as usize]).sum::<f64>() - alpha * *u;
        }
    };
    // Aᵀ u − β v, in place of v.
    let backward = |u: &[f64], v: &mut [f64], beta: f64| {
        v.iter_mut().for_each(|v| *v *= -beta);
        for (row, u) in rows.iter().zip(u) {
            row.iter().for_each(|&(j, a)| v[j as usize] += a * u);
        }
    };
    let squares: f64 = rows.iter().flatten().map(|(_, a)| a * a).sum();
    let scale = root(squares.sqrt(), damp);
    backward(&u, &mut v, 0.0);
    let mut alpha = normalize(&mut v, scale);
    let mut w = v.clone();
    let (mut phi_bar, mut rho_bar, mut damping) = (beta, alpha, 0.0_f64);
    let short = rows.len() <= columns;
    let mut kept = vec![if short { u.clone() } else { v.clone() }];
    // Without rounding it ends by itself; beyond what is kept it may need longer.
    let steps = (4 * rows.len().min(columns) + 16).min(STEPS);
    let most = KEPT / rows.len().min(columns).max(1);
    for _ in 0..steps {
        if alpha == 0.0 {
            break;
        }
        forward(&v, &mut u, alpha);
        if short {
            orthogonalize(&mut u, &kept);
        }
        let beta = normalize(&mut u, scale);
        alpha = 0.0;
        if beta > 0.0 {
            backward(&u, &mut v, beta);
            if !short {
                orthogonalize(&mut v, &kept);
            }
            alpha = normalize(&mut v, scale);
        }
        if kept.len() < most {
            kept.push(if short { u.clone() } else { v.clone() });
        }
        // One rotation takes the damping in, the other the next row.
        let damped = root(rho_bar, damp);
        damping = root(damping, damp / damped * phi_bar);
        phi_bar *= rho_bar / damped;
        let rho = root(damped, beta);
        let (cos, sin) = (damped / rho, beta / rho);
        let phi = cos * phi_bar;
        phi_bar *= sin;
        let (step, turn) = (phi / rho, sin * alpha / rho);
        for ((x, w), v) in x.iter_mut().zip(&mut w).zip(&v) {
            *x += step * *w;
            *w = v - turn * *w;
        }
        rho_bar = -cos * alpha;
        // Nothing is missed any more, or nothing that a change would mend.
        let left = root(phi_bar, damping);
        if phi_bar.abs() <= ENOUGH * norm(wanted) && damp == 0.0
            || alpha * (sin * phi).abs() <= ENOUGH * scale * left
        {
            break;
        }
    }
    x
}

/// A fitted warp: it does what the warp does, and its conditions are the pins.
pub struct Fitted<W, S> {
    warp: W,
    pins: Vec<Pin<S>>,
    note: String,
}

impl<S: Space, W: Warp<S>> Fitted<W, S> {
    /// The warp, fitted to the pins as far as it could be.
    pub fn new(warp: W, pins: Vec<Pin<S>>) -> Self {
        let miss = |pin: &Pin<S>| warp.map(&Site::anywhere(pin.source)).distance(pin.target);
        let misses = pins.iter().map(miss).enumerate();
        let (worst, most) = misses.fold((0, 0.0), |(at, most), (number, miss)| {
            if miss > most {
                (number, miss)
            } else {
                (at, most)
            }
        });
        let count = match pins.len() {
            1 => "1 pin".to_owned(),
            count => format!("{count} pins"),
        };
        let note = if most == 0.0 {
            format!("fitted to {count}, without a miss")
        } else {
            format!("fitted to {count}; pin {worst} is missed most, by {most:.3e}")
        };
        Self { warp, pins, note }
    }
}

impl<W, S> Fitted<W, S> {
    /// The same with a sentence more for the report.
    #[must_use]
    pub fn with_note(mut self, sentence: &str) -> Self {
        self.note.push_str("; ");
        self.note.push_str(sentence);
        self
    }
}

impl<S: Space, W: Warp<S>> Deformation<S> for Fitted<W, S> {
    fn map(&self, site: &Site<S>) -> S {
        self.warp.map(site)
    }
    fn facts(&self) -> Facts<S> {
        self.warp.facts().with_note(self.note.clone())
    }
    fn domain(&self) -> Domain {
        self.warp.domain()
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        self.warp.map_points(first, points)
    }
    fn keeps_finite(&self) -> bool {
        self.warp.keeps_finite()
    }
    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        self.warp.inverse_at(image)
    }
    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        self.warp.jacobian(site, size)
    }
}

impl<S: Space, W: Warp<S>> Warp<S> for Fitted<W, S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.warp.influences(site, out);
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        self.warp.scaled(address, strength)
    }
    fn factor(&self, address: Address) -> f64 {
        self.warp.factor(address)
    }
    fn weight(&self, influence: &Influence, displacement: S) -> f64 {
        self.warp.weight(influence, displacement)
    }
    fn average(&self) -> Average {
        self.warp.average()
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let pins = self.pins.iter().enumerate();
        pins.map(|(number, pin)| Condition {
            feature: u32::try_from(number).unwrap_or(u32::MAX),
            source: pin.source,
            target: pin.target,
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Plane, Term, Terms, math};
    use glam::dvec2;

    struct Random(u64);
    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// More rows than columns and fewer, dependent ones and empty ones.
    #[test]
    fn least_squares_leaves_nothing_to_gain_and_changes_no_more_than_it_must() {
        let mut random = Random(42);
        for round in 0..60 {
            let (count, columns) = [(3, 40), (40, 3), (12, 12), (1, 1), (25, 30)][round % 5];
            let mut rows: Rows = (0..count)
                .map(|_| {
                    let entry = |j| (j, random.unit() - 0.5);
                    (0..columns).map(entry).collect()
                })
                .collect();
            if round % 3 == 0 && count > 2 {
                rows[1] = rows[0].clone();
                rows[2].iter_mut().for_each(|(_, a)| *a = 0.0);
            }
            let wanted: Vec<f64> = (0..count).map(|_| random.unit() - 0.5).collect();
            let damp = if round % 2 == 0 { 0.0 } else { 0.3 };
            let x = least_squares(&rows, columns as usize, &wanted, damp);
            // Nothing can be gained: Aᵀ(b − A x) = damp² x.
            let mut gradient: Vec<f64> = x.iter().map(|x| -damp * damp * x).collect();
            for (row, wanted) in rows.iter().zip(&wanted) {
                let image: f64 = row.iter().map(|&(j, a)| a * x[j as usize]).sum();
                let miss = wanted - image;
                row.iter()
                    .for_each(|&(j, a)| gradient[j as usize] += a * miss);
            }
            assert!(
                norm(&gradient) < 1e-12 * (1.0 + norm(&x)),
                "{round}: {gradient:?}"
            );
            // And nothing spared: what the rows do not ask for is not there.
            let mut basis: Vec<Vec<f64>> = Vec::new();
            for row in &rows {
                let mut row: Vec<f64> = row.iter().map(|r| r.1).collect();
                orthogonalize(&mut row, &basis);
                if normalize(&mut row, 1e3) > 0.0 {
                    basis.push(row);
                }
            }
            let (length, mut rest) = (norm(&x), x);
            orthogonalize(&mut rest, &basis);
            assert!(norm(&rest) < 1e-11 * (1.0 + length), "{round}: {rest:?}");
        }
    }

    fn near(centre: Plane) -> impl crate::Field<Plane> {
        struct Near(Plane);
        impl crate::Field<Plane> for Near {
            fn value(&self, site: &Site<Plane>) -> f64 {
                math::exp(-Space::distance(site.point, self.0))
            }
            fn support(&self) -> crate::Support<Plane> {
                crate::Support::Everywhere
            }
            fn smoothness(&self) -> crate::Smoothness {
                crate::Smoothness::C(0)
            }
        }
        Near(centre)
    }

    fn warp(moves: &[Plane]) -> Terms<Plane> {
        let places = (0..6_u8).map(|i| dvec2(f64::from(i % 3), f64::from(i / 3)));
        let term =
            |(place, by): (Plane, &Plane)| Term::new(Affine::translation(*by), 0.8, near(place));
        Terms::new(places.zip(moves).map(term).collect())
    }

    fn pin(source: Plane, target: Plane) -> Pin<Plane> {
        Pin {
            source,
            target,
            weight: 1.0,
        }
    }

    #[test]
    fn pins_are_met_and_stiffness_holds_back() {
        let start = vec![dvec2(0.1, -0.2); 6];
        let pins = [
            pin(dvec2(0.3, 0.2), dvec2(0.9, 0.1)),
            pin(dvec2(1.7, 0.9), dvec2(1.2, 1.9)),
            pin(dvec2(1.7, 0.9), dvec2(1.2, 1.9)),
        ];
        let moved = |stiffness| -> (f64, f64) {
            let changes = fit(&warp(&start), 6, &pins, stiffness).unwrap();
            let size = changes.iter().map(|c| c.length_squared()).sum();
            let moves: Vec<Plane> = start.iter().zip(changes).map(|(a, b)| *a + b).collect();
            let fitted = Fitted::new(warp(&moves), pins.to_vec());
            let miss = |c: &Condition<Plane>| {
                Space::distance(fitted.map(&Site::anywhere(c.source)), c.target)
            };
            let misses = fitted.conditions().iter().map(miss).fold(0.0, f64::max);
            (misses, size)
        };
        let (free, held, stiff) = (moved(0.0), moved(0.5), moved(1e6));
        assert!(free.0 < 1e-12, "{free:?}");
        assert!(held.0 > free.0 && held.1 < free.1);
        assert!(stiff.0 > held.0 && stiff.1 < 1e-9);
    }

    #[test]
    fn heavier_pins_are_missed_less() {
        let start = vec![Plane::ZERO; 6];
        let at = dvec2(0.5, 0.5);
        let two = |weight| {
            let mut pins = vec![pin(at, dvec2(1.5, 0.5)), pin(at, dvec2(0.5, 0.5))];
            pins[0].weight = weight;
            let changes = fit(&warp(&start), 6, &pins, 0.0).unwrap();
            warp(&changes).map(&Site::anywhere(at)).x
        };
        assert!((two(1.0) - 1.0).abs() < 1e-12);
        assert!((two(3.0) - 1.25).abs() < 1e-12);
    }

    #[test]
    fn impossible_pins_are_named() {
        let warp = warp(&[Plane::ZERO; 6]);
        let good = pin(Plane::ZERO, Plane::ONE);
        assert_eq!(fit(&warp, 6, &[], 0.0), Err(FitError::NoPins));
        let mut bad = good;
        bad.weight = 0.0;
        assert_eq!(
            fit(&warp, 6, &[good, bad], 0.0),
            Err(FitError::Number { pin: 1 })
        );
        assert!(matches!(
            fit(&warp, 6, &[good], -1.0),
            Err(FitError::Stiffness { .. })
        ));
        let nothing = Terms::<Plane>::new(Vec::new());
        assert_eq!(
            fit(&nothing, 0, &[good], 0.0),
            Err(FitError::OutOfReach { pin: 0 })
        );
    }
}
