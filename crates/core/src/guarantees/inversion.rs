//! Invertibility: whether no two places have the same image.
//!
//! Proved by declared facts ([`Facts::one_to_one`](crate::Facts::one_to_one)); refuted by two places with one image, which are searched
//! for where the map folds, and by whether the inverse leads back to where it came from.
//!
//! *Source*: Milliron et al. 2002, §7.4; errata F16 (inverted transformations with the same fields are no inverse in general).

use super::{Guarantee, Property, Verdict, Witness, rounded};
use crate::{Deformation, Inverse, Site, Space};

/// Points that are sent there and back, at most.
const TRIED: usize = 400;
/// Points that do not come back, after which no more are tried: their searches are long.
const LOST: usize = 4;

/// Whether a deformation has an inverse. `fold` is where it folds, if it does; `points` are those of a model of size `size`.
pub fn invertibility<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    fold: Option<Witness<S>>,
    points: &[S],
    size: f64,
) -> Guarantee<S> {
    let guarantee = |verdict, statement: String, witness| {
        Guarantee::new(Property::Invertibility, verdict, statement, witness)
    };
    if points.is_empty() {
        return guarantee(
            Verdict::Unknown,
            "not examined: no points were given".to_owned(),
            None,
        );
    }
    if let Some(why) = deformation.facts().one_to_one() {
        return guarantee(Verdict::Proved, why, None);
    }
    let inverse = Inverse::new(deformation, size);
    let apart = 1e-6 * size;
    let same = |place: S, index: usize| {
        let image = deformation.map(&Site::new(index, place));
        if !image.is_finite() {
            return None;
        }
        let found = inverse.find(&Site::new(index, image));
        let met = found.residual <= inverse.tolerance(image);
        Some((met, found.place))
    };
    let two = |place: S, other: S| {
        guarantee(
            Verdict::Refuted,
            "two places have the same image".to_owned(),
            Some(Witness {
                place,
                value: place.distance(other),
                other: Some(other),
            }),
        )
    };
    if let Some(fold) = fold {
        // Beside a fold another sheet lies over it: look from there, and from places around it.
        for ring in [0.0, 0.01, 0.03, 0.1, 0.3] {
            for corner in 0..2 * S::DIM {
                let sign = if corner % 2 == 0 { 1.0 } else { -1.0 };
                let place = fold.place + S::unit(corner / 2) * (ring * size * sign);
                if let Some((true, other)) = same(place, 0)
                    && other.distance(place) > apart
                {
                    return two(place, other);
                }
            }
        }
    }
    let step = points.len().div_ceil(TRIED).max(1);
    let (mut tried, mut lost, mut worst) = (0_usize, 0, 0.0_f64);
    for (index, &place) in points.iter().enumerate().step_by(step) {
        let Some((met, back)) = same(place, index) else {
            continue;
        };
        let off = back.distance(place);
        if met && off > apart && deformation.domain() == crate::Domain::Space {
            return two(place, back);
        }
        if met {
            tried += 1;
            worst = worst.max(off);
        } else {
            lost += 1;
            if lost >= LOST {
                break;
            }
        }
    }
    let statement = if fold.is_some() {
        "it folds, but no two places with the same image were found".to_owned()
    } else if lost > 0 {
        "no two places with the same image were found, but some points do not come back".to_owned()
    } else {
        format!(
            "no two places with the same image were found; {tried} points come back to within {}",
            rounded(worst)
        )
    };
    guarantee(Verdict::Unknown, statement, None)
}
