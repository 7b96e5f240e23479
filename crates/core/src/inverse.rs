//! The inverse of a deformation is a deformation.
//!
//! Solves `D(p) = q` for `p`: in closed form where a deformation offers one ([`Deformation::inverse_at`]), part by part where it
//! is a stack, else by Newton's method with the Jacobian, damped after Levenberg and Marquardt. Where the plain start `p = q` leads
//! nowhere, the image is led from `D(q)` to `q` in steps and `p` follows (continuation), and then other starts around `q` are tried.
//! A place is an answer only if its image *is* `q` to the tolerance: the residual is measured, not trusted.
//!
//! *Source*: Milliron et al. 2002, §7.4; errata F16 (the paper's theorem on inverted transformations is false in general, so
//! that the map itself is inverted, and a bound warp by `D(u)⁻¹` where weights ignore targets). J. Nocedal and S. Wright, *Numerical
//! Optimization*, 2nd ed., 2006, §10.3 (Levenberg–Marquardt), §11.3 (continuation).

use core::cell::Cell;

use crate::{
    Deformation, Domain, Facts, Linear, Site, Smoothness, Space, Support, Unmapped, difference_step,
};

/// Newton steps from one start at most.
const STEPS: usize = 40;
/// Steps across creases from one place at most.
const CROSSINGS: usize = 12;
/// The shortest step of the continuation, as a share of the way: beyond is a cliff.
const SHORTEST: f64 = 1e-4;
/// Steps of the continuation at most.
const WAY: usize = 400;

/// Places whose image is computed for one question, at most, and stage of a stack: a point that has no inverse is given up then.
const TRIES: u32 = 60_000;

/// A place whose image was asked for, and how well it was met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inversion<S> {
    /// The place.
    pub place: S,
    /// The distance of its image from the one asked for, in scene units.
    pub residual: f64,
}

/// The inverse of a deformation.
pub struct Inverse<D> {
    deformation: D,
    size: f64,
}

impl<D> Inverse<D> {
    /// The inverse of `deformation` for models of size `size` (the diagonal of their bounds, in scene units). Residuals up to
    /// 1e-12 of it, or of the distance from the origin, are taken as none.
    pub fn new(deformation: D, size: f64) -> Self {
        let size = if size > 0.0 && size.is_finite() {
            size
        } else {
            1.0
        };
        Self { deformation, size }
    }

    /// The deformation that is inverted.
    pub fn forward(&self) -> &D {
        &self.deformation
    }

    /// The residual up to which an image counts as met near `p`.
    pub fn tolerance<S: Space>(&self, p: S) -> f64 {
        1e-12 * self.size.max(1e-2 * p.largest())
    }
}

impl<D> Inverse<D> {
    /// The place of index `image.index` that is moved to `image.point`, or the best that was found, with the distance that its image
    /// is off. It is found if that is at most [`Inverse::tolerance`].
    pub fn find<S: Space>(&self, image: &Site<S>) -> Inversion<S>
    where
        D: Deformation<S>,
    {
        self.find_in(&self.deformation, image)
    }

    fn find_in<S: Space>(&self, deformation: &dyn Deformation<S>, image: &Site<S>) -> Inversion<S> {
        let judge = |place: S| Inversion {
            place,
            residual: finite(
                deformation
                    .map(&Site::new(image.index, place))
                    .distance(image.point),
            ),
        };
        let tolerance = self.tolerance(image.point);
        let tries = Cell::new(TRIES);
        let mut best = judge(image.point);
        if best.residual == 0.0 {
            return best;
        }
        let mut consider = |found: Inversion<S>| {
            if found.residual < best.residual {
                best = found;
            }
            best.residual <= tolerance
        };
        if let Some(place) = deformation.inverse_at(image)
            && consider(judge(place))
        {
            return best;
        }
        let stages = deformation.stages();
        if stages.len() > 1 {
            let mut here = *image;
            for stage in stages.iter().rev() {
                here.point = self.find_in(stage, &here).place;
            }
            // Rounding of the stages adds up; a last step on the whole takes it away.
            if consider(self.newton(deformation, image, here.point, &tries)) {
                return best;
            }
        }
        if consider(self.newton(deformation, image, image.point, &tries)) {
            return best;
        }
        if let Some(place) = self.continued(deformation, image, &tries)
            && consider(self.newton(deformation, image, place, &tries))
        {
            return best;
        }
        // Around the image, as far as the deformation moves things there, and further.
        let here = Site::new(image.index, image.point);
        let reach = deformation.map(&here).distance(image.point);
        let reach = if reach.is_finite() && reach > 0.0 {
            reach
        } else {
            self.size
        };
        for ring in [0.5, 1.0, 2.0] {
            for corner in 0..(2 * S::DIM + (1 << S::DIM)) {
                let direction = direction::<S>(corner);
                let start = image.point + direction * (reach * ring);
                if consider(self.newton(deformation, image, start, &tries)) {
                    return best;
                }
            }
        }
        best
    }

    /// Newton's method from one start.
    fn newton<S: Space>(
        &self,
        deformation: &dyn Deformation<S>,
        image: &Site<S>,
        start: S,
        tries: &Cell<u32>,
    ) -> Inversion<S> {
        let tolerance = 0.1 * self.tolerance(image.point);
        let at = |place: S| {
            tries.set(tries.get().saturating_sub(1));
            let off = deformation.map(&Site::new(image.index, place)) - image.point;
            (off, finite(off.length()))
        };
        let mut place = start;
        let (mut off, mut residual) = at(place);
        let mut damping = 0.0;
        for _ in 0..STEPS {
            if residual <= tolerance || residual == f64::INFINITY || tries.get() == 0 {
                break;
            }
            // A Jacobian may be made of as many images.
            tries.set(tries.get().saturating_sub(jacobian_cost::<S>()));
            let site = Site::new(image.index, place);
            let jacobian = jacobian_here(deformation, &site, self.size);
            let transposed = jacobian.transposed();
            let square = transposed.after(&jacobian);
            let trace: f64 = (0..S::DIM).map(|i| square.entry(i, i)).sum();
            let slope = transposed.apply(off);
            let mut improved = false;
            for _ in 0..12 {
                let step = if damping == 0.0 {
                    jacobian.inverted().map(|inverse| inverse.apply(off))
                } else {
                    let damped = square + S::Linear::IDENTITY * (damping * trace.max(1e-30));
                    damped.inverted().map(|inverse| inverse.apply(slope))
                };
                let next = step.map(|step| place - step).filter(|p| p.is_finite());
                if let Some(next) = next {
                    let (there, left) = at(next);
                    if left < residual {
                        (place, off, residual) = (next, there, left);
                        damping = if damping < 1e-6 { 0.0 } else { damping * 0.1 };
                        improved = true;
                        break;
                    }
                }
                damping = if damping == 0.0 { 1e-4 } else { damping * 10.0 };
            }
            if !improved {
                break;
            }
        }
        if residual <= tolerance || tries.get() == 0 {
            return Inversion { place, residual };
        }
        self.through_creases(deformation, image, Inversion { place, residual }, tries)
    }

    /// Newton's method without looking at whether steps help: at a crease, where every short step does harm, long ones may land on the
    /// right side. Ends with the best place seen.
    fn through_creases<S: Space>(
        &self,
        deformation: &dyn Deformation<S>,
        image: &Site<S>,
        start: Inversion<S>,
        tries: &Cell<u32>,
    ) -> Inversion<S> {
        let tolerance = 0.1 * self.tolerance(image.point);
        let (mut best, mut place) = (start, start.place);
        for _ in 0..CROSSINGS {
            tries.set(tries.get().saturating_sub(1 + jacobian_cost::<S>()));
            let site = Site::new(image.index, place);
            let off = deformation.map(&site) - image.point;
            let residual = finite(off.length());
            if residual < best.residual {
                best = Inversion { place, residual };
            }
            if best.residual <= tolerance {
                break;
            }
            let jacobian = jacobian_here(deformation, &site, self.size);
            let step = jacobian.inverted().map(|inverse| inverse.apply(off));
            match step.map(|step| place - step).filter(|p| p.is_finite()) {
                Some(next) => place = next,
                None => break,
            }
        }
        best
    }

    /// Leads the image from `D(q)`, whose place is known, to `q`.
    fn continued<S: Space>(
        &self,
        deformation: &dyn Deformation<S>,
        image: &Site<S>,
        tries: &Cell<u32>,
    ) -> Option<S> {
        let from = deformation.map(&Site::new(image.index, image.point));
        if !from.is_finite() {
            return None;
        }
        let (mut place, mut done, mut step) = (image.point, 0.0, 0.25);
        for _ in 0..WAY {
            let next: f64 = f64::min(1.0, done + step);
            let between = from + (image.point - from) * next;
            let found = self.newton(deformation, &Site::new(image.index, between), place, tries);
            if found.residual <= self.tolerance(between).max(1e-9 * self.size) {
                (place, done) = (found.place, next);
                if done >= 1.0 {
                    return Some(place);
                }
                step *= 1.5;
            } else {
                step *= 0.5;
                if step < SHORTEST || tries.get() == 0 {
                    return None;
                }
            }
        }
        None
    }
}

/// Images that a Jacobian by differences takes.
fn jacobian_cost<S: Space>() -> u32 {
    if S::DIM == 2 { 4 } else { 6 }
}

/// A distance that orders: what is not a number is as far as can be.
fn finite(distance: f64) -> f64 {
    if distance.is_nan() {
        f64::INFINITY
    } else {
        distance
    }
}

/// Along the axes, both ways, then to the corners of a cube.
fn direction<S: Space>(number: usize) -> S {
    if number < 2 * S::DIM {
        let unit = S::unit(number / 2);
        return if number.is_multiple_of(2) {
            unit
        } else {
            -unit
        };
    }
    let corner = number - 2 * S::DIM;
    let sign = |axis: usize| {
        if corner >> axis & 1 == 1 { 1.0 } else { -1.0 }
    };
    S::from_fn(sign).normalized().unwrap_or(S::ZERO)
}

/// The Jacobian by the point, the index kept: also where the deformation reads fields of the model.
fn jacobian_here<S: Space>(
    deformation: &dyn Deformation<S>,
    site: &Site<S>,
    size: f64,
) -> S::Linear {
    if let Some(jacobian) = deformation.jacobian(site, size) {
        return jacobian;
    }
    let step = difference_step(site.point, size);
    S::Linear::from_columns(|i| {
        let at = |step: f64| Site::new(site.index, site.point + S::unit(i) * step);
        (deformation.map(&at(step)) - deformation.map(&at(-step))) / (2.0 * step)
    })
}

impl<S: Space, D: Deformation<S>> Deformation<S> for Inverse<D> {
    /// The place that is moved to the site's point; the point itself where none was found. [`Inverse::find`] tells which.
    fn map(&self, site: &Site<S>) -> S {
        let found = self.find(site);
        if found.residual <= self.accepted(site.point) {
            found.place
        } else {
            site.point
        }
    }

    fn facts(&self) -> Facts<S> {
        let forward = self.deformation.facts();
        let known = forward.one_to_one();
        // Of a map that moves nothing outside a set, neither does the inverse, if there is one.
        let support = if known.is_some() && forward.smoothness() > Smoothness::Jump {
            forward.support
        } else {
            match forward.support {
                Support::Nowhere => Support::Nowhere,
                _ => Support::Everywhere,
            }
        };
        let smooth = forward.upright().is_some() && known.is_some();
        let class = |class: Smoothness| if smooth { class } else { Smoothness::Jump };
        let notes = if known.is_none() {
            vec!["an inverse by search: points without one stay, and are named".to_owned()]
        } else {
            Vec::new()
        };
        // What is a kink there is one where it is taken to. Of a stack those of each part, by it and by the parts after it.
        let parts = self.deformation.stages();
        let mut kinks = Vec::new();
        if parts.is_empty() {
            kinks = forward.kinks;
            for kink in &mut kinks {
                *kink = self.deformation.map(&Site::anywhere(*kink));
            }
        }
        for part in parts {
            kinks.extend(part.facts().kinks);
            for kink in &mut kinks {
                *kink = part.map(&Site::anywhere(*kink));
            }
        }
        Facts {
            support,
            inside: class(forward.inside),
            edge: class(forward.edge),
            translations_only: false,
            strength_blends: false,
            upright: smooth
                .then(|| "the inverse of a map that turns nothing inside out".to_owned()),
            one_to_one: known.map(|_| "the inverse of a map".to_owned()),
            kinks,
            notes,
            ..Facts::identity()
        }
    }

    fn domain(&self) -> Domain {
        self.deformation.domain()
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        let mut unmapped = Unmapped::none();
        for (i, point) in points.iter_mut().enumerate() {
            if !point.is_finite() {
                unmapped.push(first + i);
                continue;
            }
            let found = self.find(&Site::new(first + i, *point));
            if found.residual <= self.accepted(*point) {
                *point = found.place;
            } else {
                unmapped.push(first + i);
            }
        }
        unmapped
    }

    fn keeps_finite(&self) -> bool {
        true
    }

    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        Some(self.deformation.map(image))
    }

    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        let place = self.map(site);
        let forward = self
            .deformation
            .jacobian(&Site::new(site.index, place), size)?;
        forward.inverted()
    }
}

impl<D> Inverse<D> {
    /// The residual up to which a place is taken: what steep maps leave of rounding.
    fn accepted<S: Space>(&self, p: S) -> f64 {
        1e3 * self.tolerance(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Affine, Masked, Solid, Stack, Term, Terms};
    use glam::{DMat3, dvec3};

    /// A swirl of `angle` radians about z that fades with the distance.
    struct Swirl(f64);
    impl Deformation<Solid> for Swirl {
        fn map(&self, site: &Site<Solid>) -> Solid {
            let p = site.point;
            let angle = self.0 * crate::math::exp(-Space::dot(p, p));
            DMat3::from_rotation_z(angle) * p
        }
        fn facts(&self) -> Facts<Solid> {
            Facts {
                support: Support::Everywhere,
                ..Facts::identity()
            }
        }
    }

    /// Folds along x.
    struct Fold;
    impl Deformation<Solid> for Fold {
        fn map(&self, site: &Site<Solid>) -> Solid {
            let p = site.point;
            dvec3(p.x * p.x, p.y, p.z)
        }
        fn facts(&self) -> Facts<Solid> {
            Facts {
                support: Support::Everywhere,
                ..Facts::identity()
            }
        }
    }

    fn places() -> Vec<Solid> {
        let mut state = 1_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..500)
            .map(|_| dvec3(unit() * 4.0 - 2.0, unit() * 4.0 - 2.0, unit() * 4.0 - 2.0))
            .collect()
    }

    #[test]
    fn a_wild_swirl_is_undone() {
        // Three full turns at the centre: the Newton iteration from the image alone does not get there.
        for angle in [0.5, 3.0, 19.0] {
            let inverse = Inverse::new(Swirl(angle), 7.0);
            for p in places() {
                let image = Swirl(angle).map(&Site::anywhere(p));
                let found = inverse.find(&Site::anywhere(image));
                assert!(found.residual <= inverse.tolerance(image), "{angle} {p}");
                assert!(
                    found.place.distance(p) < 1e-9,
                    "{angle} {p} {}",
                    found.place
                );
            }
        }
    }

    #[test]
    fn a_stack_is_undone_part_by_part_and_affine_maps_in_closed_form() {
        let affine = Affine::new(
            DMat3::from_cols(
                dvec3(2.0, 0.1, 0.0),
                dvec3(0.0, 1.0, 0.3),
                dvec3(-0.2, 0.0, 0.5),
            ),
            dvec3(1.0, 2.0, 3.0),
        );
        let stack: Stack<Solid> = Stack::new(vec![
            Box::new(Swirl(4.0)),
            Box::new(affine),
            Box::new(Swirl(-2.0)),
        ]);
        let inverse = Inverse::new(&stack, 7.0);
        for p in places() {
            let image = stack.map(&Site::anywhere(p));
            assert!(inverse.map(&Site::anywhere(image)).distance(p) < 1e-9);
        }
        assert_eq!(
            affine.inverse_at(&Site::anywhere(dvec3(1.0, 2.0, 3.0))),
            Some(Solid::ZERO)
        );
    }

    #[test]
    fn points_without_a_place_stay_and_are_named() {
        let inverse = Inverse::new(Fold, 2.0);
        let mut points = [dvec3(0.25, 1.0, 2.0), dvec3(-1.0, 0.0, 0.0), Solid::NAN];
        let unmapped = inverse.map_points(10, &mut points);
        assert_eq!(unmapped.indices(), [11, 12]);
        assert!((points[0].x.abs() - 0.5).abs() < 1e-9);
        assert_eq!(points[1], dvec3(-1.0, 0.0, 0.0));
    }

    #[test]
    fn the_jacobian_is_the_inverse_of_the_forward_one() {
        let inverse = Inverse::new(Swirl(1.0), 4.0);
        for p in places().into_iter().take(20) {
            let site = Site::anywhere(p);
            let direct = inverse.jacobian(&site, 4.0).unwrap();
            let plain = crate::difference_jacobian(&inverse, &site, 4.0).unwrap();
            for i in 0..3 {
                assert!((direct.col(i) - plain.col(i)).length() < 1e-6);
            }
        }
    }

    #[test]
    fn creases_are_crossed() {
        // Slopes 1/4 on one side and 4 on the other, tilted against the axes.
        struct Crease;
        impl Deformation<Solid> for Crease {
            fn map(&self, site: &Site<Solid>) -> Solid {
                let p = site.point;
                let along = p.x + 0.7 * p.y - 0.2;
                let by = if along > 0.0 {
                    3.0 * along
                } else {
                    -0.5 * along
                };
                p + dvec3(0.6, 0.4, 0.3) * by
            }
            fn facts(&self) -> Facts<Solid> {
                Facts {
                    support: Support::Everywhere,
                    ..Facts::identity()
                }
            }
        }
        let inverse = Inverse::new(Crease, 7.0);
        for p in places() {
            let image = Crease.map(&Site::anywhere(p));
            let found = inverse.find(&Site::anywhere(image));
            assert!(found.place.distance(p) < 1e-9, "{p} {found:?}");
        }
    }

    #[test]
    fn masks_and_terms_are_undone() {
        let terms = Terms::new(vec![Term::new(
            Affine::translation(dvec3(0.3, 0.0, 0.0)),
            1.0,
            1.0,
        )]);
        let masked = Masked::new(Box::new(terms), Box::new(0.5));
        let inverse = Inverse::new(masked, 1.0);
        let back = inverse.map(&Site::anywhere(dvec3(0.15, 1.0, 1.0)));
        assert!(back.distance(dvec3(0.0, 1.0, 1.0)) < 1e-12);
    }
}
