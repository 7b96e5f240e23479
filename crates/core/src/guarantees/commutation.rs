//! Commutation: whether two deformations may change places.
//!
//! *Source*: Milliron et al. 2002, §7.1: warps commute when their fields evaluate alike before and after each other and their
//! transformations commute. Proved here where that is certain: one moves nothing; both move everything alike; or both are one-to-one and
//! continuous with bounded supports that do not meet, so that each maps its support onto itself. Refuted by a point that ends up in two
//! places.

use super::{Guarantee, Property, Verdict, Witness, rounded};
use crate::{Deformation, Site, Smoothness, Space, Support};

/// Whether the order of two deformations matters to a model of size `size` with these points.
pub fn commutation<S: Space>(
    first: &dyn Deformation<S>,
    second: &dyn Deformation<S>,
    points: &[S],
    size: f64,
) -> Guarantee<S> {
    let guarantee = |verdict, statement: String, witness| {
        Guarantee::new(Property::Commutation, verdict, statement, witness)
    };
    let (a, b) = (first.facts(), second.facts());
    if a.support == Support::Nowhere || b.support == Support::Nowhere {
        return guarantee(
            Verdict::Proved,
            "one of the two moves nothing".to_owned(),
            None,
        );
    }
    let continuous = |facts: &crate::Facts<S>| facts.smoothness() > Smoothness::Jump;
    if continuous(&a) && continuous(&b) && a.stretch() == Some(0.0) && b.stretch() == Some(0.0) {
        return guarantee(
            Verdict::Proved,
            "both move all of space alike".to_owned(),
            None,
        );
    }
    let whole = |facts: &crate::Facts<S>| continuous(facts) && facts.one_to_one().is_some();
    if apart(&a.support, &b.support) && whole(&a) && whole(&b) {
        return guarantee(
            Verdict::Proved,
            "their supports do not meet, and each maps its own onto itself".to_owned(),
            None,
        );
    }
    let mut worst: Option<Witness<S>> = None;
    for (index, &place) in points.iter().enumerate() {
        let through = |one: &dyn Deformation<S>, two: &dyn Deformation<S>| {
            let between = one.map(&Site::new(index, place));
            two.map(&Site::new(index, between))
        };
        let (ab, ba) = (through(first, second), through(second, first));
        let value = ab.distance(ba);
        if worst.is_none_or(|w| value > w.value) {
            worst = Some(Witness::new(place, value));
        }
    }
    let bound = "bound to the model at rest, both are sums of displacements of the rest points, in any order";
    let sums = a.translations_only
        && b.translations_only
        && !a.weights_follow_targets
        && !b.weights_follow_targets;
    let found = match worst {
        None => guarantee(
            Verdict::Unknown,
            "not examined: no points were given".to_owned(),
            None,
        ),
        Some(w) if w.value > 1e-9 * size => guarantee(
            Verdict::Refuted,
            format!(
                "the order matters: a point ends up {} apart",
                rounded(w.value)
            ),
            Some(w),
        ),
        Some(w) => guarantee(
            Verdict::Unknown,
            format!(
                "no difference found: {} points agree to within {}",
                points.len(),
                rounded(w.value)
            ),
            Some(w),
        ),
    };
    if sums {
        found.with_detail("when bound", bound)
    } else {
        found
    }
}

/// Two deformations that are one and the same commute.
pub fn commutes_with_itself<S>() -> Guarantee<S> {
    let statement = "both are the same".to_owned();
    Guarantee::new(Property::Commutation, Verdict::Proved, statement, None)
}

/// Whether two bounded sets certainly have no point in common.
fn apart<S: Space>(a: &Support<S>, b: &Support<S>) -> bool {
    if let (
        Support::Ball { centre, radius },
        Support::Ball {
            centre: other,
            radius: reach,
        },
    ) = (a, b)
    {
        return centre.distance(*other) > radius + reach;
    }
    match (a.bounds(), b.bounds()) {
        (Some(a), Some(b)) => (0..S::DIM).any(|axis| {
            a.max.component(axis) < b.min.component(axis)
                || b.max.component(axis) < a.min.component(axis)
        }),
        _ => false,
    }
}
