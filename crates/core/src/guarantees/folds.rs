//! Fold-over: where the Jacobian determinant is not positive, and how strong a warp may be before it is.
//!
//! Declared facts prove its absence ([`Facts::upright`](crate::Facts::upright)); a search refutes it: determinants at the points of a
//! model, then a pattern search downhill from the worst of them, inside the model's bounds. A determinant counts as a witness only if a
//! difference quotient with another step agrees: across a jump, quotients say nothing.
//!
//! *Source*: Milliron et al. 2002, §7.4; Y. Choi and S. Lee, *Injectivity conditions of 2D and 3D uniform cubic B-spline functions*,
//! Graphical Models 62, 2000, for what lattices declare; R. Hooke and T. Jeeves, *Direct search*, JACM 8(2), 1961.

use super::{Guarantee, Property, Verdict, Witness, rounded};
use crate::{Bounds, Deformation, Linear, Modulated, Site, Space, Warp};

/// The detail of a fold that says what it does to the model itself.
pub const ON_THE_MODEL: &str = "on the model";
/// Determinants within this share of what they could be are rounding.
const FLAT: f64 = 1e-9;
/// Places from which the search goes downhill.
const STARTS: usize = 8;
/// Halvings of the search's step.
const HALVINGS: usize = 10;
/// Strengths are found to this.
const STRENGTH: f64 = 1e-4;
/// Places at which a strength is tried, at most.
const TRIED: usize = 256;

/// The determinant at a place; nothing where there is no Jacobian, or where quotients of two steps disagree.
fn determinant<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    site: &Site<S>,
    size: f64,
) -> Option<f64> {
    let value = deformation.jacobian(site, size)?.determinant();
    if value > 0.0 {
        return Some(value);
    }
    // Analytic Jacobians do not depend on the step and agree with themselves.
    let again = deformation.jacobian(site, size / 16.0)?.determinant();
    let near = (value - again).abs() <= 0.05 * value.abs().max(again.abs()) + 1e-6;
    (near && again <= 0.0).then_some(value)
}

/// Whether a deformation turns anything inside out. `points` are those of a model of size `size` (in scene units).
pub fn no_fold<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &[S],
    size: f64,
) -> Guarantee<S> {
    let unknown =
        |statement: &str| Guarantee::new(Property::NoFold, Verdict::Unknown, statement, None);
    if points.is_empty() {
        return unknown("not examined: no points were given");
    }
    if deformation.domain() == crate::Domain::Model {
        return unknown("depends on a field that lives on the model: there is no Jacobian");
    }
    let proof = deformation.facts().upright();
    let (worst, turned) = worst(deformation, points, size);
    let Some(at_worst) = worst.first().copied() else {
        return unknown("no Jacobian could be measured");
    };
    if at_worst.value <= 0.0 {
        let statement = if is_flat(deformation, at_worst, size) {
            "presses flat: the Jacobian determinant is 0 but for rounding".to_owned()
        } else {
            let value = rounded(at_worst.value);
            format!("folds: the Jacobian determinant is {value}")
        };
        let on_the_model = match turned {
            0 => format!(
                "none of the {} points looked at is turned over",
                points.len()
            ),
            1 => format!("1 of the {} points looked at is turned over", points.len()),
            turned => format!(
                "{turned} of the {} points looked at are turned over",
                points.len()
            ),
        };
        return Guarantee::new(
            Property::NoFold,
            Verdict::Refuted,
            statement,
            Some(at_worst),
        )
        .with_detail(ON_THE_MODEL, on_the_model);
    }
    let smallest = rounded(at_worst.value);
    match proof {
        Some(why) => Guarantee::new(
            Property::NoFold,
            Verdict::Proved,
            format!("{why} (smallest determinant found: {smallest})"),
            Some(at_worst),
        ),
        None => Guarantee::new(
            Property::NoFold,
            Verdict::Unknown,
            format!("none found: the smallest determinant in the model's bounds is {smallest}"),
            Some(at_worst),
        ),
    }
}

/// Whether a determinant that is not positive is nothing but rounding of a map that presses space flat.
fn is_flat<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    at: Witness<S>,
    size: f64,
) -> bool {
    let jacobian = deformation.jacobian(&Site::anywhere(at.place), size);
    jacobian.is_some_and(|j| {
        let volume: f64 = (0..S::DIM).map(|i| j.column(i).length()).product();
        at.value.abs() <= FLAT * volume
    })
}

/// The places with the smallest determinants, the smallest first, after a search downhill, and how many of the points
/// themselves are turned over.
fn worst<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &[S],
    size: f64,
) -> (Vec<Witness<S>>, usize) {
    let mut found: Vec<Witness<S>> = points
        .iter()
        .enumerate()
        .filter_map(|(index, &place)| {
            let value = determinant(deformation, &Site::new(index, place), size)?;
            (!value.is_nan()).then(|| Witness::new(place, value))
        })
        .collect();
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    let turned = found.partition_point(|w| w.value <= 0.0);
    found.truncate(STARTS);
    let Some(bounds) = Bounds::of(points) else {
        return (found, turned);
    };
    // About the distance between neighbours among the points.
    #[allow(clippy::cast_precision_loss)]
    let spacing = bounds.diagonal() / (points.len() as f64).powf(1.0 / S::DIM as f64);
    for start in &mut found {
        let mut step = spacing;
        for _ in 0..HALVINGS {
            let mut moved = false;
            for axis in 0..S::DIM {
                for sign in [1.0, -1.0] {
                    let place = start.place + S::unit(axis) * (step * sign);
                    if !bounds.contains(place) {
                        continue;
                    }
                    let value = determinant(deformation, &Site::anywhere(place), size);
                    if let Some(value) = value.filter(|v| *v < start.value) {
                        *start = Witness::new(place, value);
                        moved = true;
                    }
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
    }
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    (found, turned)
}

/// The strength, from 0 to 1, up to which no fold was found when all strengths of a warp are multiplied by it; `None` where even the
/// warp as it is does not fold. Tried at those points of the model where it folds, or folds most: a measurement, not a proof.
pub fn safe_strength<S: Space, W: Warp<S> + Clone + 'static>(
    warp: &W,
    points: &[S],
    size: f64,
) -> Option<f64> {
    let (mut places, _) = worst(warp, points, size);
    if places
        .first()
        .is_none_or(|w| w.value > 0.0 || is_flat(warp, *w, size))
    {
        return None;
    }
    // At a smaller strength another place may be the worst: try many.
    let step = points.len().div_ceil(TRIED).max(1);
    places.extend(
        points
            .iter()
            .step_by(step)
            .map(|&place| Witness::new(place, 1.0)),
    );
    let folds = |strength: f64| {
        let weaker = Modulated::new(Box::new(warp.clone())).with_strength(Box::new(strength));
        places
            .iter()
            .any(|w| determinant(&weaker, &Site::anywhere(w.place), size).is_some_and(|d| d <= 0.0))
    };
    // A fold at a strength need not stay at a larger one: go up from nothing.
    const STEPS: u32 = 32;
    let mut safe = 0.0;
    let mut unsafe_from = 1.0;
    for step in 1..=STEPS {
        let strength = f64::from(step) / f64::from(STEPS);
        if folds(strength) {
            unsafe_from = strength;
            break;
        }
        safe = strength;
    }
    while unsafe_from - safe > STRENGTH {
        let middle = 0.5 * (safe + unsafe_from);
        if folds(middle) {
            unsafe_from = middle;
        } else {
            safe = middle;
        }
    }
    Some(safe)
}
