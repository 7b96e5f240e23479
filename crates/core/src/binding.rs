//! Bindings: a warp's fields evaluated once on the rest model and kept.
//!
//! *Source*: Milliron et al. 2002, §7.1 and §7.4 (precomputed field values); errata, *Binding*. A bound warp is a sparse
//! weighted sum that any new targets can use. Direct and bound evaluation share [`Warp::combine`], so that they agree
//! bit for bit.

use crate::{
    Address, Average, Deformation, Domain, Facts, Influence, Influences, Linear, Site, Smoothness,
    Space, Unmapped, Warp, warp::Sums,
};

/// Sites at which a binding is compared with a warp, at most.
const COMPARED: usize = 256;
/// Sites from which the size of a binding is estimated, at most.
const WEIGHED: usize = 1024;

/// The influences of every site of one model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Binding {
    /// Start of each site's influences in `features` and `weights`, and one past the last.
    offsets: Vec<usize>,
    features: Vec<u32>,
    weights: Vec<f64>,
    /// Where on its feature each influence sits, and its strength; empty when these are 0 and 1 throughout.
    places: Vec<(f64, f64)>,
    /// Per site, see [`Influences::log_scale`]; empty when all are 0.
    log_scales: Vec<f64>,
}

/// Place and strength of influences that say nothing of theirs.
const USUAL: (f64, f64) = (0.0, 1.0);

/// Whether these are place and strength that are not stored: bit for bit, as -0 is not 0 in a file.
fn is_usual(place: (f64, f64)) -> bool {
    place.0.to_bits() == USUAL.0.to_bits() && place.1 == USUAL.1
}

impl Binding {
    /// Binds a warp to a model's rest points, indices from 0.
    pub fn new<S: Space, W: Warp<S> + ?Sized>(warp: &W, rest: &[S]) -> Self {
        Self::of_run(warp, 0, rest)
    }

    /// Binds a warp to a run of a model's rest points, the first of which has the index `first`. Runs are joined by
    /// [`Binding::append`].
    pub fn of_run<S: Space, W: Warp<S> + ?Sized>(warp: &W, first: usize, rest: &[S]) -> Self {
        let mut binding = Self {
            offsets: vec![0],
            log_scales: vec![0.0; rest.len()],
            ..Self::default()
        };
        let mut list = Influences::default();
        for (index, &point) in rest.iter().enumerate() {
            list.clear();
            warp.influences(&Site::new(first + index, point), &mut list);
            list.list
                .iter()
                .for_each(|influence| binding.push(influence));
            binding.offsets.push(binding.features.len());
            binding.log_scales[index] = list.log_scale;
        }
        if binding.log_scales.iter().all(|&l| l == 0.0) {
            binding.log_scales = Vec::new();
        }
        binding
    }

    /// Adds an influence to the last site.
    fn push(&mut self, influence: &Influence) {
        let place = (influence.address.at, influence.strength);
        if !(self.places.is_empty() && is_usual(place)) {
            self.places.resize(self.features.len(), USUAL);
            self.places.push(place);
        }
        self.features.push(influence.address.feature);
        self.weights.push(influence.weight);
    }

    /// Adds the sites of the run that comes next.
    pub fn append(&mut self, next: &Self) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        let (sites, kept) = (self.len(), self.features.len());
        if !(self.log_scales.is_empty() && next.log_scales.is_empty()) {
            self.log_scales.resize(sites, 0.0);
            self.log_scales.extend_from_slice(&next.log_scales);
            self.log_scales.resize(sites + next.len(), 0.0);
        }
        if !(self.places.is_empty() && next.places.is_empty()) {
            self.places.resize(kept, USUAL);
            self.places.extend_from_slice(&next.places);
            self.places.resize(kept + next.features.len(), USUAL);
        }
        self.offsets
            .extend(next.offsets.iter().skip(1).map(|offset| kept + offset));
        self.features.extend_from_slice(&next.features);
        self.weights.extend_from_slice(&next.weights);
    }

    /// Number of sites.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }
    /// Whether no site is bound.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Number of influences kept over all sites.
    pub fn influence_count(&self) -> usize {
        self.features.len()
    }
    /// The influence of a number, counted over all sites.
    fn influence(&self, number: usize) -> Influence {
        let (at, strength) = self.places.get(number).copied().unwrap_or(USUAL);
        let feature = self.features[number];
        Influence {
            address: Address { feature, at },
            strength,
            weight: self.weights[number],
        }
    }
    /// Where the influences of a site lie; nowhere beyond the last.
    fn range(&self, index: usize) -> core::ops::Range<usize> {
        match (self.offsets.get(index), self.offsets.get(index + 1)) {
            (Some(&from), Some(&to)) => from..to,
            _ => 0..0,
        }
    }
    /// The influences of one site; none beyond the last.
    pub fn site(&self, index: usize) -> impl ExactSizeIterator<Item = Influence> + Clone + '_ {
        self.range(index).map(|number| self.influence(number))
    }

    /// The influences of all sites, one site after the other.
    pub fn influences(&self) -> impl ExactSizeIterator<Item = Influence> + Clone + '_ {
        (0..self.features.len()).map(|number| self.influence(number))
    }
    /// The logarithmic scale of a site's weights, see [`Influences::log_scale`].
    pub fn log_scale(&self, index: usize) -> f64 {
        self.log_scales.get(index).copied().unwrap_or(0.0)
    }

    /// A binding from what [`Binding::site`], [`Binding::influences`] and [`Binding::log_scale`] told of another: how many influences
    /// each site has, all of them, and the scales (one a site, or none). `None` where the numbers do not fit together.
    pub fn from_parts(
        counts: &[u32],
        influences: impl IntoIterator<Item = Influence>,
        log_scales: Vec<f64>,
    ) -> Option<Self> {
        if !(log_scales.is_empty() || log_scales.len() == counts.len()) {
            return None;
        }
        let mut binding = Self {
            offsets: Vec::with_capacity(counts.len() + 1),
            log_scales,
            ..Self::default()
        };
        let mut end = 0_usize;
        binding.offsets.push(end);
        for &count in counts {
            end = end.checked_add(count as usize)?;
            binding.offsets.push(end);
        }
        influences
            .into_iter()
            .for_each(|influence| binding.push(&influence));
        (end == binding.features.len()).then_some(binding)
    }

    /// Bytes of memory that a binding of a warp to these points takes for each, estimated from some of them.
    pub fn bytes_per_point<S: Space, W: Warp<S> + ?Sized>(warp: &W, rest: &[S]) -> f64 {
        let step = rest.len().div_ceil(WEIGHED).max(1);
        let mut list = Influences::default();
        let (mut count, mut sites, mut placed) = (0_usize, 0_usize, false);
        for (index, &point) in rest.iter().enumerate().step_by(step) {
            list.clear();
            warp.influences(&Site::new(index, point), &mut list);
            count += list.list.len();
            sites += 1;
            let mut all = list.list.iter();
            placed |= all.any(|i| !is_usual((i.address.at, i.strength)));
        }
        #[allow(clippy::cast_precision_loss)]
        let each = count as f64 / sites.max(1) as f64;
        #[allow(clippy::cast_precision_loss)]
        let (influence, offset) = (
            (size_of::<u32>() + size_of::<f64>() * if placed { 3 } else { 1 }) as f64,
            size_of::<usize>() as f64,
        );
        each * influence + offset
    }

    /// The first site, of some that are spread over the model and some near each feature, whose influences are no longer those that were
    /// bound: then the sources or fields of the warp have changed, or the model has. `dropped` tells whether some influences were left
    /// out; else there must be no others.
    pub fn outdated<S: Space, W: Warp<S> + ?Sized>(
        &self,
        warp: &W,
        rest: &[S],
        dropped: bool,
    ) -> Option<usize> {
        if rest.len() != self.len() {
            return Some(rest.len().min(self.len()));
        }
        let step = rest.len().div_ceil(COMPARED).max(1);
        let mut list = Influences::default();
        let mut sites: Vec<usize> = (0..rest.len()).step_by(step).collect();
        sites.extend(self.ends());
        sites.sort_unstable();
        sites.dedup();
        sites.into_iter().find(|&index| {
            list.clear();
            warp.influences(&Site::new(index, rest[index]), &mut list);
            !self.agrees(index, &list, dropped)
        })
    }

    /// The first and the last site that feel each feature, of so many features.
    fn ends(&self) -> Vec<usize> {
        let mut ends: std::collections::BTreeMap<u32, (usize, usize)> =
            std::collections::BTreeMap::new();
        for site in 0..self.len() {
            for feature in &self.features[self.range(site)] {
                if let Some((_, last)) = ends.get_mut(feature) {
                    *last = site;
                } else if ends.len() < COMPARED {
                    ends.insert(*feature, (site, site));
                }
            }
        }
        ends.into_values().flat_map(|(a, b)| [a, b]).collect()
    }

    /// Whether a site has these influences, but for such as were dropped.
    fn agrees(&self, index: usize, list: &Influences, dropped: bool) -> bool {
        let mut all = list.list.iter();
        list.log_scale.to_bits() == self.log_scale(index).to_bits()
            && (dropped || list.list.len() == self.range(index).len())
            && self
                .site(index)
                .all(|kept| all.any(|influence| *influence == kept))
    }

    /// Without those influences whose share of their site's weight is less than `share`. Only of warps whose weights ignore the targets,
    /// and are normalized; of others nothing is dropped. A site keeps at least its largest.
    #[must_use]
    pub fn without_shares_below<S: Space, W: Warp<S> + ?Sized>(self, warp: &W, share: f64) -> Self {
        if warp.facts().weights_follow_targets || warp.average() == Average::Plain {
            return self;
        }
        let mut kept = Self {
            offsets: vec![0],
            log_scales: self.log_scales.clone(),
            ..Self::default()
        };
        for index in 0..self.len() {
            let site = self.site(index);
            let total: f64 = site.clone().map(|i| i.weight).sum();
            let largest = site.clone().map(|i| i.weight).fold(0.0, f64::max);
            site.filter(|i| !total.is_finite() || i.weight >= share * total || i.weight == largest)
                .for_each(|influence| kept.push(&influence));
            kept.offsets.push(kept.features.len());
        }
        kept
    }

    /// The displacements of the features, `(L − I, t)` each, where a table of them serves all sites: every influence takes the whole of
    /// its feature at full strength, and weights ignore the targets. Empty otherwise.
    fn table<S: Space, W: Warp<S> + ?Sized>(&self, warp: &W) -> Table<S> {
        let last = self.features.iter().max();
        let serves = self.places.is_empty() && !warp.facts().weights_follow_targets;
        let Some(&last) = last.filter(|_| serves) else {
            return Vec::new();
        };
        // A number without a feature, as a damaged file may have, must not ask for a table of its size.
        if last as usize > self.features.len().max(FEATURES) {
            return Vec::new();
        }
        let mut used = vec![false; last as usize + 1];
        self.features.iter().for_each(|&f| used[f as usize] = true);
        let displacement = |feature: u32| {
            if !used[feature as usize] {
                return (S::Linear::ZERO, S::ZERO);
            }
            let affine = warp.scaled(Address::of(feature), 1.0);
            (affine.linear - S::Linear::IDENTITY, affine.translation)
        };
        (0..=last).map(displacement).collect()
    }

    /// Moves points, which stand at the indices they were bound with, by `warp`, whose targets and transformations may
    /// have changed since. Points beyond the bound ones stay and are named.
    pub fn map_points<S: Space, W: Warp<S> + ?Sized>(
        &self,
        warp: &W,
        first: usize,
        points: &mut [S],
    ) -> Unmapped {
        self.map_points_by(warp, &self.table(warp), first, points)
    }

    fn map_points_by<S: Space, W: Warp<S> + ?Sized>(
        &self,
        warp: &W,
        table: &[(S::Linear, S)],
        first: usize,
        points: &mut [S],
    ) -> Unmapped {
        let mut list = Influences::default();
        let mut unmapped = Unmapped::none();
        let average = warp.average();
        for (i, point) in points.iter_mut().enumerate() {
            let index = first + i;
            if index >= self.len() {
                unmapped.push(index);
                continue;
            }
            if !table.is_empty() {
                let sums = self.sums(table, index, *point);
                if let Some(displacement) = sums.displacement(average, self.log_scale(index)) {
                    *point = point.moved_by(displacement);
                    continue;
                }
            }
            list.clear();
            list.list.extend(self.site(index));
            list.log_scale = self.log_scale(index);
            *point = warp.combine(*point, &list);
        }
        unmapped
    }

    /// The sums of eq. (3) at one site, displacements from a table.
    #[inline]
    fn sums<S: Space>(&self, table: &[(S::Linear, S)], index: usize, point: S) -> Sums<S> {
        let mut sums = Sums::ZERO;
        let range = self.range(index);
        let terms = self.features[range.clone()]
            .iter()
            .zip(&self.weights[range]);
        for (&feature, &weight) in terms {
            let (linear, translation) = &table[feature as usize];
            if weight > 0.0 {
                sums.add(linear.apply(point) + *translation, weight);
            }
        }
        sums
    }
}

/// The displacement of each feature as `(L − I, t)`.
type Table<S> = Vec<(<S as Space>::Linear, S)>;

/// Tables of up to this many features are made whatever the number of influences.
const FEATURES: usize = 1 << 16;

/// A warp bound to a model: a deformation that moves the model's points, at the indices they were bound with, by the saved influences
/// and the warp's present targets.
pub struct Bound<S: Space, W> {
    warp: W,
    binding: Binding,
    /// See [`Binding::table`].
    table: Table<S>,
}

impl<S: Space, W: Warp<S>> Bound<S, W> {
    /// The warp with its binding.
    pub fn new(warp: W, binding: Binding) -> Self {
        let table = binding.table(&warp);
        Self {
            warp,
            binding,
            table,
        }
    }
    /// The binding.
    pub fn binding(&self) -> &Binding {
        &self.binding
    }
}

impl<S: Space, W: Warp<S>> Deformation<S> for Bound<S, W> {
    fn map(&self, site: &Site<S>) -> S {
        let mut point = [site.point];
        let _ = self.map_points(site.index, &mut point);
        point[0]
    }

    fn facts(&self) -> Facts<S> {
        // Influences live on the model: as functions of space nothing is known of them.
        let facts = self.warp.facts();
        Facts {
            inside: Smoothness::Jump,
            edge: Smoothness::Jump,
            stretch: None,
            upright: None,
            one_to_one: None,
            ..facts
        }
    }

    fn domain(&self) -> Domain {
        Domain::Model
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        self.binding
            .map_points_by(&self.warp, &self.table, first, points)
    }

    /// `D(u)⁻¹` where weights ignore the targets (errata F16); `None` where `D(u)` is singular, or where weights follow targets.
    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        if self.warp.facts().weights_follow_targets {
            return None;
        }
        let influences = Influences {
            list: self.binding.site(image.index).collect(),
            log_scale: self.binding.log_scale(image.index),
        };
        let forward = crate::warp::deforming_function_of(&self.warp, image.point, &influences);
        forward.inverted().map(|inverse| inverse.apply(image.point))
    }
}

/// What tells models apart: a number made of all coordinates and their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fingerprint(pub u64);

impl Fingerprint {
    /// The fingerprint of a model's points: FNV-1a (Fowler, Noll and Vo) over the number of points and the bits of their coordinates.
    pub fn of<S: Space>(points: &[S]) -> Self {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut add = |word: u64| {
            for byte in word.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        add(points.len() as u64);
        for point in points {
            for axis in 0..S::DIM {
                add(point.component(axis).to_bits());
            }
        }
        Self(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Affine, Solid, Term, Terms, map_all};
    use glam::dvec3;

    struct Near(Solid);
    impl crate::Field<Solid> for Near {
        fn value(&self, site: &Site<Solid>) -> f64 {
            1.0 / (0.1 + Space::distance(site.point, self.0))
        }
        fn support(&self) -> crate::Support<Solid> {
            crate::Support::Everywhere
        }
        fn smoothness(&self) -> Smoothness {
            Smoothness::C(0)
        }
    }

    fn warp(by: f64) -> Terms<Solid> {
        let term = |centre: Solid, by: Solid| Term::new(Affine::translation(by), 1.0, Near(centre));
        Terms::new(vec![
            term(Solid::ZERO, dvec3(by, 0.0, 0.0)),
            term(Solid::ONE, dvec3(0.0, by, 0.0)),
            term(Solid::X * 100.0, dvec3(0.0, 0.0, by)),
        ])
    }

    fn rest() -> Vec<Solid> {
        (0..50)
            .map(|i| dvec3(f64::from(i) * 0.1, f64::from(i % 7), f64::from(i % 3) - 1.0))
            .collect()
    }

    #[test]
    fn bound_is_direct_for_new_targets_too() {
        let binding = Binding::new(&warp(1.0), &rest());
        for by in [1.0, -3.5] {
            let (mut direct, mut bound) = (rest(), rest());
            let _ = map_all(&warp(by), &mut direct);
            let _ = map_all(&Bound::new(warp(by), binding.clone()), &mut bound);
            assert_eq!(direct, bound);
        }
        assert_eq!(binding.outdated(&warp(2.0), &rest(), false), None);
        let mut other = rest();
        other[49].x += 1e-9;
        assert_eq!(binding.outdated(&warp(2.0), &other, false), Some(49));
        assert_eq!(binding.outdated(&warp(2.0), &other[..7], false), Some(7));
        assert_ne!(Fingerprint::of(&rest()), Fingerprint::of(&other));
        assert_eq!(Fingerprint::of(&rest()), Fingerprint::of(&rest()));
    }

    #[test]
    fn runs_are_joined() {
        let whole = Binding::new(&warp(1.0), &rest());
        let mut joined = Binding::default();
        for (run, points) in rest().chunks(7).enumerate() {
            joined.append(&Binding::of_run(&warp(1.0), 7 * run, points));
        }
        assert_eq!(joined, whole);
    }

    #[test]
    fn a_binding_is_made_again_from_its_parts() {
        let binding = Binding::new(&warp(1.0), &rest());
        let counts: Vec<u32> = (0..binding.len())
            .map(|i| u32::try_from(binding.site(i).len()).unwrap())
            .collect();
        let again = Binding::from_parts(&counts, binding.influences(), Vec::new());
        assert_eq!(again, Some(binding.clone()));
        assert_eq!(
            Binding::from_parts(&counts[1..], binding.influences(), Vec::new()),
            None
        );
        assert_eq!(
            Binding::from_parts(&counts, binding.influences(), vec![0.0]),
            None
        );
    }

    #[test]
    fn small_shares_are_dropped_and_change_little() {
        let binding = Binding::new(&warp(1.0), &rest());
        let all = binding.influence_count();
        let fewer = binding
            .clone()
            .without_shares_below::<Solid, _>(&warp(1.0), 0.05);
        assert!(fewer.influence_count() < all);
        assert!(fewer.influence_count() >= rest().len());
        assert_eq!(fewer.outdated(&warp(1.0), &rest(), true), None);
        let (mut direct, mut bound) = (rest(), rest());
        let _ = map_all(&warp(1.0), &mut direct);
        let _ = map_all(&Bound::new(warp(1.0), fewer), &mut bound);
        let worst = direct
            .iter()
            .zip(&bound)
            .map(|(a, b)| a.distance(*b))
            .fold(0.0, f64::max);
        assert!(worst > 0.0 && worst < 0.15, "{worst}");
    }

    #[test]
    fn a_bound_warp_is_undone_by_its_deforming_function() {
        let bound = Bound::new(warp(0.7), Binding::new(&warp(0.7), &rest()));
        for (index, &p) in rest().iter().enumerate() {
            let image = bound.map(&Site::new(index, p));
            let back = bound.inverse_at(&Site::new(index, image)).unwrap();
            assert!(back.distance(p) < 1e-12);
        }
    }
}
