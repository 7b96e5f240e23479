//! Bindings: a warp's fields evaluated once on the rest model and kept.
//!
//! *Source*: Milliron et al. 2002, §7.1 and §7.4 (precomputed field values); errata, *Binding*. A bound warp is a sparse
//! weighted sum that any new targets can use. Direct and bound evaluation share [`Warp::combine`], so that they agree
//! bit for bit.

use crate::{Influence, Influences, Site, Space, Unmapped, Warp};

/// The influences of every site of one model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Binding {
    /// Start of each site's influences in `influences`, and one past the last.
    offsets: Vec<usize>,
    influences: Vec<Influence>,
    /// Per site, see [`Influences::log_scale`]; empty when all are 0.
    log_scales: Vec<f64>,
}

impl Binding {
    /// Binds a warp to a model's rest points, indices from 0.
    pub fn new<S: Space, W: Warp<S> + ?Sized>(warp: &W, rest: &[S]) -> Self {
        let mut binding = Self {
            offsets: vec![0],
            influences: Vec::new(),
            log_scales: vec![0.0; rest.len()],
        };
        let mut list = Influences::default();
        for (index, &point) in rest.iter().enumerate() {
            list.clear();
            warp.influences(&Site::new(index, point), &mut list);
            binding.influences.extend_from_slice(&list.list);
            binding.offsets.push(binding.influences.len());
            binding.log_scales[index] = list.log_scale;
        }
        if binding.log_scales.iter().all(|&l| l == 0.0) {
            binding.log_scales = Vec::new();
        }
        binding
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
        self.influences.len()
    }
    /// The influences of one site; none beyond the last.
    pub fn site(&self, index: usize) -> &[Influence] {
        match (self.offsets.get(index), self.offsets.get(index + 1)) {
            (Some(&from), Some(&to)) => &self.influences[from..to],
            _ => &[],
        }
    }

    /// Moves points, which stand at the indices they were bound with, by `warp`, whose targets and transformations may
    /// have changed since. Points beyond the bound ones stay and are named.
    pub fn map_points<S: Space, W: Warp<S> + ?Sized>(
        &self,
        warp: &W,
        first: usize,
        points: &mut [S],
    ) -> Unmapped {
        let mut list = Influences::default();
        let mut unmapped = Unmapped::none();
        for (i, point) in points.iter_mut().enumerate() {
            let index = first + i;
            if index >= self.len() {
                unmapped.push(index);
                continue;
            }
            list.clear();
            list.list.extend_from_slice(self.site(index));
            list.log_scale = self.log_scales.get(index).copied().unwrap_or(0.0);
            *point = warp.combine(*point, &list);
        }
        unmapped
    }
}
