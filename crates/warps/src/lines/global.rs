//! Global feature lines: as feature lines, but each line goes across as the lines about it turn.
//!
//! Computes the target's direction across line `i` as `Σ_j ŵ_ij R_j N_i`, `R_j` the rotation of line `j`, with
//! `w_ij = (length_j^p / ((a + dist_ij)(a + |cos θ_ij| √(length_i length_j))))^b`: near lines count more, and lines across
//! more than lines alongside. Two lines that shear the plane then agree on a shear, where each by itself would turn its
//! surroundings rigidly and the two would fold what lies between.
//!
//! *Source*: Milliron et al. 2002, §5.2, Fig. 15. Errata F7: the absolute cosine and both summands scaled as lengths; with
//! `a = 0` the line itself is left out; what is left of the average must have length.

use super::elements::ElementWarp;
use super::local::check_lines;
use super::{ElementError, WeightConstants};
use anamorph_core::{Plane, Scaling, Space, math};
use anamorph_features::{Element, ElementPair};

/// The averaged unit vector across must keep this share of its length: less would press the model a thousandfold.
pub const LEAST_NORMAL: f64 = 1e-3;

/// Cosines below this are those of perpendicular lines, and distances below it relative to the coordinates those of lines
/// that touch: rounding leaves no less.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The warp that carries every source line to its target, each turned across by what all of them do.
///
/// # Errors
/// As [`local::construct`](super::local::construct), and [`ElementError::ShortNormal`] where rotations cancel.
pub fn construct(
    lines: &[(ElementPair<Plane>, WeightConstants)],
    scaling: Scaling,
) -> Result<ElementWarp<Plane>, ElementError> {
    check_lines(lines)?;
    for (feature, (_, constants)) in lines.iter().enumerate() {
        constants.check(feature)?;
    }
    let with_maps = (0..lines.len()).map(|feature| {
        let (pair, constants) = lines[feature];
        let affine = match pair.source.normal() {
            None => pair.affine(),
            Some(normal) => pair.affine_across(across(lines, feature, normal)?),
        };
        let affine = affine.map_err(|error| ElementError::Feature { feature, error })?;
        Ok((pair, constants, affine))
    });
    ElementWarp::with_maps(with_maps.collect::<Result<_, _>>()?, scaling)
}

/// Sine and cosine of the rotation of a line; none for a line without length, whose direction is anyone's guess.
fn rotation(pair: &ElementPair<Plane>) -> (f64, f64) {
    let (from, to) = (pair.source.direction(0), pair.target.direction(0));
    if to == Plane::ZERO || from == to {
        return (0.0, 1.0);
    }
    (from.perp_dot(to), from.dot(to))
}

/// The target's direction across line `i`.
fn across(
    lines: &[(ElementPair<Plane>, WeightConstants)],
    i: usize,
    normal: Plane,
) -> Result<Plane, ElementError> {
    let (own, own_constants) = &lines[i];
    let mut logs: Vec<(usize, f64)> = Vec::new();
    let mut steepest: Option<f64> = None;
    for (j, (pair, constants)) in lines.iter().enumerate() {
        let weight = constants.of_size(pair.source.size());
        let itself = i == j;
        // A point has no direction, and no opinion on rotations.
        if itself && own_constants.a == 0.0 || pair.source.normal().is_none() || weight.vanishes() {
            continue;
        }
        let (dist, cosine) = if itself {
            (0.0, 1.0)
        } else {
            between(&own.source, &pair.source)
        };
        let both = own.source.length(0).sqrt() * pair.source.length(0).sqrt();
        let alongside = constants.a + cosine * both;
        if (constants.a + dist == 0.0 || alongside == 0.0) && constants.b > 0.0 {
            steepest = Some(steepest.map_or(constants.b, |s| s.max(constants.b)));
            logs.push((j, f64::INFINITY));
        } else {
            // The second factor joins the logarithm of the first.
            let log = weight.log(dist) - constants.b * math::ln(alongside);
            logs.push((j, if constants.b == 0.0 { 0.0 } else { log }));
        }
    }
    if let Some(steepest) = steepest {
        logs.retain(|&(j, log)| log == f64::INFINITY && lines[j].1.b == steepest);
    }
    let most = logs.iter().fold(f64::NEG_INFINITY, |m, l| m.max(l.1));
    let (mut change, mut total) = (Plane::ZERO, 0.0);
    for &(j, log) in &logs {
        let share = if log == most {
            1.0
        } else {
            math::exp(log - most)
        };
        let (sin, cos) = rotation(&lines[j].0);
        // As a change of the normal, so that lines that do not turn leave it as it is.
        change += (normal * (cos - 1.0) + normal.perp() * sin) * share;
        total += share;
    }
    if total == 0.0 {
        let (sin, cos) = rotation(own);
        return Ok(normal * cos + normal.perp() * sin);
    }
    let averaged = normal + change / total;
    let length = averaged.length();
    if length < LEAST_NORMAL {
        return Err(ElementError::ShortNormal {
            feature: i,
            length,
            least: LEAST_NORMAL,
        });
    }
    Ok(averaged)
}

/// Distance between two segments and the absolute cosine of their angle; 0 where only rounding is left.
fn between(one: &Element<Plane>, other: &Element<Plane>) -> (f64, f64) {
    let cosine = one.direction(0).dot(other.direction(0)).abs();
    let cosine = if cosine <= ROUNDING { 0.0 } else { cosine };
    let (a, b) = (one.corners(), other.corners());
    let size = a.iter().chain(&b).fold(0.0_f64, |m, p| m.max(p.largest()));
    // Each on both sides of the other.
    let parted = |line: &Element<Plane>, ends: &[Plane]| {
        let side = |p: Plane| line.direction(0).perp_dot(p - line.corner());
        let sides = (side(ends[0]), side(ends[1]));
        sides.0 <= 0.0 && sides.1 >= 0.0 || sides.0 >= 0.0 && sides.1 <= 0.0
    };
    let ends = |line: &Element<Plane>, ends: &[Plane]| {
        let distances = ends.iter().map(|&p| line.distance(p));
        distances.fold(f64::INFINITY, f64::min)
    };
    let nearest = ends(one, &b).min(ends(other, &a));
    let parallel = one.direction(0).perp_dot(other.direction(0)) == 0.0;
    let crossing = !parallel && parted(one, &b) && parted(other, &a);
    if crossing || nearest <= ROUNDING * size {
        (0.0, cosine)
    } else {
        (nearest, cosine)
    }
}
