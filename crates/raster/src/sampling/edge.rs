//! What stands beyond a raster.

use super::filter::unknown;
use crate::RasterError;

/// How a raster goes on beyond its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Edge {
    /// The outermost pixels go on.
    Clamp,
    /// The raster is repeated.
    Wrap,
    /// The raster is repeated, every other time mirrored, the outermost pixels twice.
    Mirror,
    /// Zeros: nothing in premultiplied light with coverage.
    #[default]
    Transparent,
}

/// Name, further name and meaning of each.
const EDGES: [(Edge, &str, &str, &str); 4] = [
    (
        Edge::Clamp,
        "clamp",
        "replicate",
        "the outermost pixels go on",
    ),
    (Edge::Wrap, "wrap", "repeat", "the raster is repeated"),
    (
        Edge::Mirror,
        "mirror",
        "reflect",
        "repeated, every other time mirrored",
    ),
    (Edge::Transparent, "transparent", "zero", "zeros"),
];

impl Edge {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        EDGES.iter().map(|row| row.0)
    }

    fn row(self) -> (Self, &'static str, &'static str, &'static str) {
        let found = EDGES.into_iter().find(|row| row.0 == self);
        found.unwrap_or(EDGES[3])
    }
    /// Its name in recipes and lists.
    pub fn name(self) -> &'static str {
        self.row().1
    }
    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        self.row().3
    }

    /// The one of that name or alias.
    ///
    /// # Errors
    /// [`RasterError::UnknownName`], which lists the names there are.
    pub fn by_name(name: &str) -> Result<Self, RasterError> {
        let found = EDGES.iter().find(|row| row.1 == name || row.2 == name);
        found
            .map(|row| row.0)
            .ok_or_else(|| unknown("edge", name, EDGES.iter().map(|row| row.1)))
    }

    /// The pixel of `size` (at least 1) that stands at `index`; none where nothing does.
    #[inline]
    pub fn pixel(self, index: i64, size: usize) -> Option<usize> {
        let length = size as i64;
        if (0..length).contains(&index) {
            return Some(index as usize);
        }
        match self {
            Self::Clamp => Some(index.clamp(0, length - 1) as usize),
            Self::Wrap => Some(index.rem_euclid(length) as usize),
            Self::Mirror => {
                let there = index.rem_euclid(2 * length);
                Some(there.min(2 * length - 1 - there) as usize)
            }
            Self::Transparent => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_beyond_the_ends() {
        let row =
            |edge: Edge| -> Vec<Option<usize>> { (-4..7).map(|i| edge.pixel(i, 3)).collect() };
        let all = |list: [usize; 11]| list.map(Some).to_vec();
        assert_eq!(row(Edge::Clamp), all([0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]));
        assert_eq!(row(Edge::Wrap), all([2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]));
        assert_eq!(row(Edge::Mirror), all([2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]));
        assert_eq!(
            row(Edge::Transparent)[3..8],
            [None, Some(0), Some(1), Some(2), None]
        );
        for edge in Edge::all() {
            for index in [i64::MIN / 2, i64::MAX / 2] {
                assert!(edge.pixel(index, 1).is_none_or(|p| p == 0));
            }
        }
    }

    #[test]
    fn names_are_found_and_others_listed() {
        for edge in Edge::all() {
            assert_eq!(Edge::by_name(edge.name()), Ok(edge));
        }
        assert_eq!(Edge::by_name("repeat"), Ok(Edge::Wrap));
        let message = Edge::by_name("torus").unwrap_err().to_string();
        assert!(
            message.contains("clamp, wrap, mirror, transparent"),
            "{message}"
        );
    }
}
