//! How well a recipe was undone, for the summary and the report of `warp --invert`.

use crate::error::say;
use crate::files;
use crate::model::ModelSpace;
use anamorph_core::{Deformation, map_all_parallel};

/// How well a recipe was undone.
pub(crate) struct Undone {
    /// The largest distance between a point and where the recipe moves the place that was found for it.
    pub(crate) residual: f64,
    /// Points for which no place was found; they stay.
    pub(crate) stayed: Vec<usize>,
}

impl Undone {
    pub(crate) fn measure<S: ModelSpace>(
        forward: &dyn Deformation<S>,
        rest: &[S],
        moved: &[S],
        stayed: &[usize],
    ) -> Self {
        let mut again = moved.to_vec();
        let _ = map_all_parallel(forward, &mut again, &|_| {});
        let apart = again.iter().zip(rest).enumerate();
        let residual = apart
            .filter(|(index, _)| stayed.binary_search(index).is_err())
            .map(|(_, (a, b))| a.distance(*b))
            .filter(|d| d.is_finite())
            .fold(0.0, f64::max);
        Self {
            residual,
            stayed: stayed.to_vec(),
        }
    }

    pub(crate) fn print(&self) {
        const NAMED: usize = 8;
        say!(
            "  undone: the recipe brings every place back to within {}",
            files::short(self.residual)
        );
        if self.stayed.is_empty() {
            return;
        }
        let named: Vec<String> = self
            .stayed
            .iter()
            .take(NAMED)
            .map(|index| (index + 1).to_string())
            .collect();
        let more = self.stayed.len().saturating_sub(NAMED);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        say!(
            "  warning: nothing that the recipe moves lands on these points, or the search did not find it; they stay: {}{more}",
            named.join(", ")
        );
    }
}
